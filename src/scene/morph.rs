//! Skies between two skies.

use std::collections::VecDeque;

use super::paint::Strokes;
use super::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Unit, Visitor};
use super::{CloudLayer, DensityModel, MAX_LAYERS, MAX_SHAPES, MapBlend, MapLayer, Scene, Shape, ShapeJoin};

/// The sky a share of the way from one to the other: 0 is the first, 1 the second, bit for bit.
///
/// Numbers go evenly over their sliders, directions take the shorter way round, and what has nothing in between changes half
/// way. A cloud layer that only one of them has comes or goes by its density and coverage, a shape by its size; so do both where two differ in
/// what has nothing in between, such as their model or a seed, and the one weather map fades into the other, as far as there is room for both.
pub fn morph(from: &Scene, to: &Scene, share: f32) -> Scene {
    if share.is_nan() || share <= 0.0 {
        return from.clone();
    }
    if share >= 1.0 {
        return to.clone();
    }
    let (mut begin, mut end) = (from.clone(), to.clone());
    // Thick cloud is opaque long before its density is what it was: it has to shrink as well.
    let [coverage_before, coverage_after] = [&begin, &end].map(|sky| sky.weather.greatest_coverage());
    let thin =
        |layer: &CloudLayer, coverage: f32| CloudLayer { density: 0.0, coverage_offset: -coverage, ..layer.clone() };
    let as_nothing =
        (|layer: &CloudLayer| thin(layer, coverage_before), |layer: &CloudLayer| thin(layer, coverage_after));
    // Of these a sky has one at most.
    let is_single = |layer: &CloudLayer| matches!(layer.model, DensityModel::Grid | DensityModel::Automaton);
    let is_alone = |from: &CloudLayer, to: &CloudLayer| is_single(from) && from.model == to.model;
    for index in 0..begin.layers.len() {
        let Some(model) = begin.layers.get(index).filter(|layer| is_single(layer)).map(|layer| layer.model) else {
            continue;
        };
        // Whatever else they are, the two of its model go into each other.
        if let Some(other) = end.layers.iter().position(|layer| layer.model == model) {
            if index < end.layers.len() { end.layers.swap(index, other) } else { begin.layers.swap(index, other) }
        }
    }
    pair(&mut begin.layers, &mut end.layers, MAX_LAYERS, (as_nothing, is_alone));
    let size = |shape: &Shape, side: f32, tall_m: f32| Shape {
        width_m: side,
        length_m: side,
        tall_m,
        blend_m: 0.0,
        ..shape.clone()
    };
    // What cuts all others down to it changes nothing where it is large.
    let small = |shape: &Shape| match shape.join {
        ShapeJoin::Intersection => size(shape, Shape::WIDEST_M, Shape::TALLEST_M),
        _ => size(shape, 0.0, 0.0),
    };
    pair(&mut begin.shapes, &mut end.shapes, MAX_SHAPES, ((small, small), |_: &Shape, _: &Shape| false));
    if let ([from], [to]) = (&begin.weather.layers[..], &end.weather.layers[..])
        && !are_alike(from, to)
    {
        let over = |opacity: f32| MapLayer { blend: MapBlend::Replace, opacity, ..to.clone() };
        let both = [0.0, to.opacity].map(|opacity| vec![from.clone(), over(opacity)]);
        // The map below is in the way of one that is not opaque.
        if to.opacity >= 1.0 {
            [begin.weather.layers, end.weather.layers] = both;
        }
    } else if begin.weather.layers.len() != end.weather.layers.len() {
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

/// Gives both lists the same items in the same order: those that only one has, or that are not alike, beside nothing, which
/// is another before and after. Where that is more than `most`, or two cannot be side by side, unlike items stay a pair.
fn pair<T: Params + Clone>(
    from: &mut Vec<T>,
    to: &mut Vec<T>,
    most: usize,
    ((before, after), is_alone): ((impl Fn(&T) -> T, impl Fn(&T) -> T), impl Fn(&T, &T) -> bool),
) {
    let mut split = (Vec::new(), Vec::new());
    let mut together = (Vec::new(), Vec::new());
    for index in 0..from.len().max(to.len()) {
        match (from.get(index), to.get(index)) {
            (Some(old), Some(new)) => {
                if are_alike(old, new) || is_alone(old, new) {
                    split.0.push(old.clone());
                    split.1.push(new.clone());
                } else {
                    split.0.extend([old.clone(), before(new)]);
                    split.1.extend([after(old), new.clone()]);
                }
                together.0.push(old.clone());
                together.1.push(new.clone());
            }
            (Some(old), None) => {
                for lists in [&mut split, &mut together] {
                    lists.0.push(old.clone());
                    lists.1.push(after(old));
                }
            }
            (None, Some(new)) => {
                for lists in [&mut split, &mut together] {
                    lists.0.push(before(new));
                    lists.1.push(new.clone());
                }
            }
            (None, None) => {}
        }
    }
    (*from, *to) = if split.0.len() <= most { split } else { together };
}

/// Whether two items agree in everything that has nothing in between.
fn are_alike<T: Params + Clone>(one: &T, other: &T) -> bool {
    let steps = |item: &T| {
        let mut values = Values::default();
        item.clone().visit(&mut values);
        values.0.retain(|value| !matches!(value, Any::Float(_) | Any::Colour(_)));
        values.0
    };
    steps(one) == steps(other)
}

/// A value of any type.
#[derive(Clone, Debug, PartialEq)]
enum Any {
    Float(f32),
    Count(u32),
    Switch(bool),
    Choice(usize),
    Colour(Colour),
    File(FileName),
    Strokes(Strokes),
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

    fn strokes(&mut self, _: &Info<Strokes>, value: &mut Strokes) {
        self.0.push_back(Any::Strokes(value.clone()));
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

    fn strokes(&mut self, _: &Info<Strokes>, value: &mut Strokes) {
        if let Some(Any::Strokes(end)) = self.next() {
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

    #[test]
    fn what_has_nothing_in_between_fades() {
        let (mut from, mut to) = (Scene::default(), Scene::default());
        to.layers[0].model = DensityModel::Product;
        (from.weather.layers[0].seed, to.weather.layers[0].seed) = (1, 77);
        let at = |share| morph(&from, &to, share);
        let densities = |sky: &Scene| sky.layers.iter().map(|layer| (layer.model, layer.density)).collect::<Vec<_>>();
        let expected = [(DensityModel::Profile, 0.75), (DensityModel::Product, 0.25)];
        assert_eq!(densities(&at(0.25)), expected, "both are there");
        let maps = at(0.25).weather.layers;
        assert_eq!((maps.len(), maps[0].seed, maps[1].seed), (2, 1, 77));
        assert_eq!((maps[1].blend, maps[1].opacity), (MapBlend::Replace, 0.25));
        // Where there is no room they change half way.
        from.layers.resize(MAX_LAYERS, CloudLayer::default());
        to.layers.resize(MAX_LAYERS, to.layers[0].clone());
        let model = |share| morph(&from, &to, share).layers[0].model;
        assert_eq!((model(0.4), model(0.6)), (DensityModel::Profile, DensityModel::Product));
    }

    #[test]
    fn an_automaton_goes_on_wherever_it_stands() {
        let living = CloudLayer { model: DensityModel::Automaton, ..CloudLayer::default() };
        let (mut one, mut two) = (Scene::default(), Scene::default());
        one.layers = vec![living.clone()];
        two.layers = vec![CloudLayer { base_m: 6000.0, top_m: 7000.0, ..CloudLayer::default() }, living.clone()];
        for (from, to) in [(&one, &two), (&two, &one)] {
            for share in [0.01, 0.49, 0.51, 0.99] {
                let between = morph(from, to, share);
                let automata: Vec<_> =
                    between.layers.iter().filter(|layer| layer.model == DensityModel::Automaton).collect();
                assert_eq!(automata, [&living], "at {share}");
                assert_eq!(between.layers.len(), 2, "at {share}: the other comes or goes");
            }
        }
    }

    #[test]
    fn a_shape_that_cuts_all_others_to_itself_begins_as_large_as_can_be() {
        let mut cut = Scene::default();
        let shape = Shape::default();
        cut.shapes = vec![shape.clone(), Shape { join: ShapeJoin::Intersection, ..shape.clone() }];
        let whole = Scene { shapes: vec![shape.clone()], ..cut.clone() };
        let soon = morph(&whole, &cut, 0.001).shapes;
        assert!(soon[0] == shape && soon[1].width_m > 50_000.0, "{}", soon[1].width_m);
        assert!(morph(&whole, &cut, 0.999).shapes[1].width_m < 3000.0);
    }
}
