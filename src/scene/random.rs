//! Random values for every parameter, the same for the same seed.

use super::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Visitor};

/// Gives every parameter of `root` a value from its range; file names stay. The same seed gives the same values.
pub fn randomise(root: &mut impl Params, seed: u32) {
    root.visit(&mut Random { stream: Stream::new(seed.into()) });
}

/// A sequence of numbers, the same for the same seed (`SplitMix64`; Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub struct Stream {
    state: u64,
}

impl Stream {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Uniform in 0 ..= 1.
    pub fn unit(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / ((1_u64 << 53) - 1) as f64
    }

    /// An index below `count`; 0 where there is none.
    pub fn below(&mut self, count: usize) -> usize {
        let index = self.unit() * count as f64;
        // Truncation is meant: `index` lies in 0 ..= count.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ..= count")]
        let index = index as usize;
        index.min(count.saturating_sub(1))
    }
}

struct Random {
    stream: Stream,
}

/// The nearest number of single precision.
#[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
fn narrow(number: f64) -> f32 {
    number as f32
}

/// The number at a place of its range, 0 to 1, as a slider has it; `None` without a range.
pub fn between(info: &Info<f32>, at: f64) -> Option<f32> {
    let range = info.range.as_ref()?;
    let (low, high) = (f64::from(*range.start()), f64::from(*range.end()));
    let drawn = if info.logarithmic && low > 0.0 { low * (high / low).powf(at) } else { low + (high - low) * at };
    Some(narrow(drawn).clamp(*range.start(), *range.end()))
}

impl Visitor for Random {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        if info.range.is_some() {
            *value = between(info, self.stream.unit()).unwrap_or(*value);
        }
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        let Some(range) = &info.range else { return };
        let span = (range.end() - range.start()) as usize + 1;
        *value = range.start() + u32::try_from(self.stream.below(span)).unwrap_or(0);
    }

    fn switch(&mut self, _: &Info<bool>, value: &mut bool) {
        *value = self.stream.unit() < 0.5;
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        *index = self.stream.below(info.options.len());
    }

    fn colour(&mut self, _: &Info<Colour>, value: &mut Colour) {
        let mut part = || narrow(self.stream.unit());
        *value = Colour(part(), part(), part());
    }

    fn file(&mut self, _: &Info<FileName>, _: &mut FileName) {}

    fn group(&mut self, _: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        children(self);
    }

    fn list(&mut self, _: &GroupInfo, list: &mut dyn List) {
        while list.count() > 1 {
            list.remove(list.count() - 1);
        }
        for index in 0..=self.stream.below(super::MAX_LAYERS) {
            if list.count() <= index {
                list.append();
            }
            list.visit_item(index, self);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Scene, edit::faults};
    use super::*;

    #[test]
    fn a_seed_gives_one_scene_in_range() {
        let draw = |seed| {
            let mut scene = Scene::default();
            randomise(&mut scene, seed);
            scene
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        for seed in 0..50 {
            assert!(faults(&draw(seed)).is_empty(), "seed {seed}: {:?}", faults(&draw(seed)));
        }
    }
}
