//! Random values for every parameter, the same for the same seed.

use super::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Visitor};

/// Gives every parameter of `root` a value from its range; file names stay. The same seed gives the same values.
pub fn randomise(root: &mut impl Params, seed: u32) {
    root.visit(&mut Random { stream: Stream::new(seed.into()) });
}

/// Moves the parameters of `root` by up to so much of themselves, 0 to 1, and draws seeds anew; choices, switches and files
/// stay, and so do parameters and groups whose key is `kept`. The same seed gives the same values.
pub fn vary(root: &mut impl Params, seed: u32, amount: f32, kept: &dyn Fn(&str) -> bool) {
    let stream = Stream::new(u64::from(seed) ^ 0x6e65_7068_6f73);
    root.visit(&mut Vary {
        stream,
        amount: f64::from(amount.clamp(0.0, 1.0)),
        kept,
        is_frozen: false,
        prefix: String::new(),
    });
}

/// Moves values near where they are: those of logarithmic parameters by a factor of up to four, others by up to half of
/// themselves and no less than a twentieth of their range.
struct Vary<'k> {
    stream: Stream,
    amount: f64,
    kept: &'k dyn Fn(&str) -> bool,
    /// Within a group that is kept: values are drawn all the same, so that keeping one changes no other.
    is_frozen: bool,
    prefix: String,
}

impl Vary<'_> {
    fn key(&self, name: &str) -> String {
        format!("{}{name}", self.prefix)
    }

    fn below(&mut self, name: &str, visit: &mut dyn FnMut(&mut dyn Visitor)) {
        let key = self.key(name);
        let is_frozen = self.is_frozen || (self.kept)(&key);
        let outer =
            (std::mem::replace(&mut self.prefix, format!("{key}.")), std::mem::replace(&mut self.is_frozen, is_frozen));
        visit(self);
        (self.prefix, self.is_frozen) = outer;
    }

    fn moves(&self, name: &str) -> bool {
        !self.is_frozen && !(self.kept)(&self.key(name))
    }
}

impl Visitor for Vary<'_> {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        let drawn = (2.0 * self.stream.unit() - 1.0) * self.amount;
        let Some(range) = info.range.as_ref().filter(|_| self.moves(info.name)) else { return };
        let (low, high, now) = (f64::from(*range.start()), f64::from(*range.end()), f64::from(*value));
        let moved = if info.logarithmic {
            now * 4.0_f64.powf(drawn)
        } else {
            now + drawn * (0.5 * now.abs()).max(0.05 * (high - low)).min(0.25 * (high - low))
        };
        *value = narrow(moved).clamp(*range.start(), *range.end());
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        let drawn = self.stream.below(1 << 20);
        let is_seed = info.name.ends_with("seed") && self.amount > 0.0;
        let Some(range) = info.range.as_ref().filter(|_| is_seed && self.moves(info.name)) else { return };
        *value = u32::try_from(drawn).unwrap_or(0).clamp(*range.start(), *range.end());
    }

    fn switch(&mut self, _: &Info<bool>, _: &mut bool) {}

    fn choice(&mut self, _: &ChoiceInfo, _: &mut usize) {}

    fn colour(&mut self, _: &Info<Colour>, _: &mut Colour) {}

    fn file(&mut self, _: &Info<FileName>, _: &mut FileName) {}

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        self.below(info.name, children);
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        for index in 0..list.count() {
            self.below(&format!("{}.{index}", info.name), &mut |visitor| list.visit_item(index, visitor));
        }
    }
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
    fn varied_skies_stay_near_and_keep_what_is_locked() {
        let begun = Scene::default();
        let varied = |seed, amount: f32| {
            let mut scene = begun.clone();
            vary(&mut scene, seed, amount, &|key| key == "camera" || key == "weather.coverage");
            scene
        };
        assert_eq!(varied(1, 0.0), begun, "by nothing");
        for seed in 0..20 {
            let scene = varied(seed, 1.0);
            assert_eq!((&scene.camera, scene.weather.coverage), (&begun.camera, begun.weather.coverage), "locked");
            assert_ne!(scene.sun, begun.sun, "not locked");
            assert!(faults(&scene).is_empty(), "{:?}", faults(&scene));
            let ratio = scene.layers[0].shape_size_m / begun.layers[0].shape_size_m;
            assert!((0.25..=4.0).contains(&ratio), "{ratio}");
        }
        let mut all = begun.clone();
        vary(&mut all, 7, 0.3, &|_| false);
        assert_eq!(varied(7, 0.3).display, all.display, "keeping one section changes no other");
        assert_eq!(varied(7, 0.3), varied(7, 0.3), "the same seed");
        assert_ne!(varied(7, 0.3), varied(8, 0.3), "another seed");
    }

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
