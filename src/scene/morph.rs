//! Skies between two skies.

use std::collections::VecDeque;

use super::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Unit, Visitor};
use super::{CloudLayer, Scene, Shape};

/// The sky a share of the way from one to the other: 0 is the first, 1 the second, bit for bit.
///
/// Numbers go evenly over their sliders, directions take the shorter way round, and what has nothing in between changes half
/// way. A cloud layer that only one of them has comes or goes by its density, a shape by its size.
pub fn morph(from: &Scene, to: &Scene, share: f32) -> Scene {
    if share.is_nan() || share <= 0.0 {
        return from.clone();
    }
    if share >= 1.0 {
        return to.clone();
    }
    let (mut begin, mut end) = (from.clone(), to.clone());
    let thin = |layer: &CloudLayer| CloudLayer { density: 0.0, ..layer.clone() };
    complete(&mut begin.layers, &end.layers, thin);
    complete(&mut end.layers, &begin.layers, thin);
    let small = |shape: &Shape| Shape { width_m: 0.0, length_m: 0.0, tall_m: 0.0, blend_m: 0.0, ..shape.clone() };
    complete(&mut begin.shapes, &end.shapes, small);
    complete(&mut end.shapes, &begin.shapes, small);
    if begin.weather.layers.len() != end.weather.layers.len() {
        let nearer = if share < 0.5 { &begin.weather.layers } else { &end.weather.layers }.clone();
        begin.weather.layers.clone_from(&nearer);
        end.weather.layers = nearer;
    }
    // Where extinction comes from different things on the two sides, it goes from the one value to the other.
    for (from, to) in begin.layers.iter_mut().zip(&mut end.layers).filter(|(from, to)| from.optics != to.optics) {
        (*from, *to) = (from.with_given_optics(), to.with_given_optics());
    }
    let mut values = Values::default();
    end.visit(&mut values);
    begin.visit(&mut Towards { values, share });
    begin.mend();
    begin
}

/// Gives `items` those of `others` that it lacks, as nothing.
fn complete<T>(items: &mut Vec<T>, others: &[T], as_nothing: impl Fn(&T) -> T) {
    items.extend(others.iter().skip(items.len()).map(as_nothing));
}

/// A value of any type.
#[derive(Clone, Debug)]
enum Any {
    Float(f32),
    Count(u32),
    Switch(bool),
    Choice(usize),
    Colour(Colour),
    File(FileName),
}

/// All values of a group in the order of their declaration.
#[derive(Clone, Debug, Default)]
pub struct Values(VecDeque<Any>);

impl Values {
    /// Writes the values into a group of the same shape.
    pub fn write(self, visit: impl FnOnce(&mut dyn Visitor)) {
        visit(&mut Towards { values: self, share: 1.0 });
    }
}

impl Visitor for Values {
    fn float(&mut self, _: &Info<f32>, value: &mut f32) {
        self.0.push_back(Any::Float(*value));
    }

    fn count(&mut self, _: &Info<u32>, value: &mut u32) {
        self.0.push_back(Any::Count(*value));
    }

    fn switch(&mut self, _: &Info<bool>, value: &mut bool) {
        self.0.push_back(Any::Switch(*value));
    }

    fn choice(&mut self, _: &ChoiceInfo, index: &mut usize) {
        self.0.push_back(Any::Choice(*index));
    }

    fn colour(&mut self, _: &Info<Colour>, value: &mut Colour) {
        self.0.push_back(Any::Colour(*value));
    }

    fn file(&mut self, _: &Info<FileName>, value: &mut FileName) {
        self.0.push_back(Any::File(value.clone()));
    }

    fn group(&mut self, _: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        children(self);
    }

    fn list(&mut self, _: &GroupInfo, list: &mut dyn List) {
        for index in 0..list.count() {
            list.visit_item(index, self);
        }
    }
}

/// Moves values a share of the way to others.
struct Towards {
    values: Values,
    share: f32,
}

impl Towards {
    fn next(&mut self) -> Option<Any> {
        self.values.0.pop_front()
    }

    fn snap<T>(&self, value: &mut T, end: T) {
        if self.share >= 0.5 {
            *value = end;
        }
    }
}

/// A share of the way between two values of a parameter.
#[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
pub(super) fn between(info: &Info<f32>, (from, to): (f32, f32), share: f32) -> f32 {
    if share >= 1.0 || from == to {
        return to;
    }
    let range = info.range.as_ref().map(|range| (*range.start(), *range.end()));
    if let Some((low, high)) = range
        && info.unit == Unit::Degrees
        && high - low >= 360.0
    {
        let turn = (to - from + 180.0).rem_euclid(360.0) - 180.0;
        return low + (from + share * turn - low).rem_euclid(360.0);
    }
    if info.logarithmic && from > 0.0 && to > 0.0 {
        let (from, to) = (f64::from(from), f64::from(to));
        return (from * (to / from).powf(f64::from(share))) as f32;
    }
    from + share * (to - from)
}

impl Visitor for Towards {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        if let Some(Any::Float(end)) = self.next() {
            *value = between(info, (*value, end), self.share);
        }
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two counts")]
    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        if let Some(Any::Count(end)) = self.next() {
            if info.name.ends_with("seed") {
                self.snap(value, end);
            } else {
                let (from, to) = (f64::from(*value), f64::from(end));
                *value = (from + f64::from(self.share) * (to - from)).round() as u32;
            }
        }
    }

    fn switch(&mut self, _: &Info<bool>, value: &mut bool) {
        if let Some(Any::Switch(end)) = self.next() {
            self.snap(value, end);
        }
    }

    fn choice(&mut self, _: &ChoiceInfo, index: &mut usize) {
        if let Some(Any::Choice(end)) = self.next() {
            self.snap(index, end);
        }
    }

    fn colour(&mut self, _: &Info<Colour>, value: &mut Colour) {
        if let Some(Any::Colour(end)) = self.next() {
            // Of two that are equal, exactly that.
            let mixed = value.vec() + (end.vec() - value.vec()) * self.share;
            *value = Colour(mixed.x, mixed.y, mixed.z);
        }
    }

    fn file(&mut self, _: &Info<FileName>, value: &mut FileName) {
        if let Some(Any::File(end)) = self.next() {
            self.snap(value, end);
        }
    }

    fn group(&mut self, _: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        children(self);
    }

    fn list(&mut self, _: &GroupInfo, list: &mut dyn List) {
        for index in 0..list.count() {
            list.visit_item(index, self);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::builtin::BUILTINS;
    use super::super::edit::faults;
    use super::*;

    #[test]
    fn the_ends_are_the_skies_and_everything_between_is_sound() {
        let skies: Vec<Scene> = BUILTINS.iter().map(|builtin| builtin.preset().expect("it is sound").scene).collect();
        for from in &skies {
            for to in &skies {
                assert_eq!((&morph(from, to, 0.0), &morph(from, to, 1.0)), (from, to));
                for share in [0.001, 0.3, 0.5, 0.999, f32::NAN] {
                    let sky = morph(from, to, share);
                    assert!(faults(&sky).is_empty() && sky.problems().is_empty(), "{share}: {:?}", faults(&sky));
                }
            }
            assert_eq!(morph(from, from, 0.37), *from, "a sky between itself and itself");
        }
    }

    #[test]
    fn directions_take_the_shorter_way_and_layers_fade() {
        let (mut from, mut to) = (Scene::default(), Scene::default());
        (from.sun.azimuth_deg, to.sun.azimuth_deg) = (350.0, 20.0);
        to.layers.push(CloudLayer { density: 0.8, ..CloudLayer::default() });
        let middle = morph(&from, &to, 0.5);
        assert!((middle.sun.azimuth_deg - 5.0).abs() < 1e-3, "{}", middle.sun.azimuth_deg);
        assert!((middle.layers[1].density - 0.4).abs() < 1e-6, "{}", middle.layers[1].density);
    }
}
