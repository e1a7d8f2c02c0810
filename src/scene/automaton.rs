//! Clouds that appear, merge, split and vanish by the rules of a cellular automaton (Dobashi et al., "A simple, efficient
//! method for realistic animation of clouds", 2000), and which of its generations a time asks for.
//!
//! A run of the automaton begins with clear air, and its state after n generations follows from the seed alone. So that any
//! time can be reached directly, runs are short: each serves an epoch of [`EPOCH`] generations, for which [`WARM_UP`] more
//! have gone before, and hands over to the next within [`HAND_OVER`] generations. Which air is favourable changes slowly and
//! steadily through all epochs, so that two runs have their clouds in the same places.

use crate::params;

params! {
    /// The cellular automaton that makes a layer's clouds, for that model only.
    pub struct Automaton ("Cellular automaton") {
        /// Seed of its chances.
        seed: u32 = 1, 0..=9999, None;
        /// Cells across the map's tile, from west to east and from north to south.
        cells: u32 = 128, 16..=256, None;
        /// Cells from base to top.
        levels: u32 = 32, 8..=64, None;
        /// Share of the air that is favourable to clouds. The weather map's coverage can only take from it.
        coverage: f32 = 0.45, 0.0..=1.0, None;
        /// Places across the map where air rises.
        patches: u32 = 9, 1..=64, None;
        /// How far favourable air reaches upwards from where there is little of it, as a part of the layer.
        height: f32 = 0.7, 0.05..=1.0, None;
        /// Chance of favourable air to become humid in a generation.
        vapour: f32 = 0.25, 0.0..=1.0, None;
        /// Chance of favourable air to begin to condense by itself; humid air beside it follows.
        activation: f32 = 0.03, 0.0..=1.0, None;
        /// Chance of cloud in favourable air to vanish in a generation. Elsewhere it is a third.
        extinction: f32 = 0.06, 0.0..=1.0, None;
        /// Time from one generation to the next.
        generation_secs: f32 = 20.0, 0.1..=3600.0, Seconds, logarithmic;
        /// How fast favourable air changes, in patches over a hundred generations.
        change: f32 = 0.6, 0.0..=10.0, None;
        /// How far the wind carries the tops on before the bases, in cells for each generation.
        shear: f32 = 0.0, -1.0..=1.0, None;
    }
}

/// Generations that a run serves.
pub const EPOCH: u32 = 128;
/// Generations from clear air until a run serves.
pub const WARM_UP: u32 = 48;
/// Generations within which a run hands over to the next.
pub const HAND_OVER: u32 = 16;
/// Generations for which the same air is favourable.
pub const CHAPTER: u32 = 16;

/// One generation of one run, and the one after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Generation {
    /// Which epoch the run is for.
    pub epoch: i64,
    /// Generations since its clear air.
    pub index: u32,
}

/// What a time shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutomatonMoment {
    /// The run that serves.
    pub now: Generation,
    /// The run that it takes over from.
    pub before: Option<Generation>,
    /// Shares of the density: of `now`, of the generation after it, and the same of `before`. Their sum is 1.
    pub shares: [f32; 4],
}

impl Automaton {
    /// What a time shows. Any time has its moment, long ago or ahead.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "generations since the epoch began")]
    pub fn at(&self, time_secs: f64) -> AutomatonMoment {
        // Farther off, generations are no longer told apart by a double.
        let generations = (time_secs / f64::from(self.generation_secs)).clamp(-1e13, 1e13);
        let generations = if generations.is_finite() { generations } else { 0.0 };
        // At time 0 a run has just taken over: two are more work than one.
        let generations = generations + f64::from(HAND_OVER);
        let epoch = (generations / f64::from(EPOCH)).floor();
        let since = generations - epoch * f64::from(EPOCH);
        let (whole, share) = (since.floor() as u32, (since - since.floor()) as f32);
        let epoch = epoch as i64;
        let now = Generation { epoch, index: whole + WARM_UP };
        let taken = (since / f64::from(HAND_OVER)).min(1.0) as f32;
        if taken >= 1.0 {
            return AutomatonMoment { now, before: None, shares: [1.0 - share, share, 0.0, 0.0] };
        }
        let taken = taken * taken * (3.0 - 2.0 * taken);
        let before = Generation { epoch: epoch - 1, index: whole + EPOCH + WARM_UP };
        let [kept, next] = [1.0 - share, share];
        let shares = [kept * taken, next * taken, kept * (1.0 - taken), next * (1.0 - taken)];
        AutomatonMoment { now, before: Some(before), shares }
    }

    /// The chapter of a generation: which air is favourable in it.
    pub fn chapter(&self, generation: Generation) -> i64 {
        if self.change <= 0.0 {
            return 0;
        }
        let since_zero = generation.epoch * i64::from(EPOCH) + i64::from(generation.index) - i64::from(WARM_UP);
        since_zero.div_euclid(i64::from(CHAPTER))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn density(moment: AutomatonMoment, of: impl Fn(Generation) -> f64) -> f64 {
        let next = |generation: Generation| Generation { index: generation.index + 1, ..generation };
        let before = moment.before.unwrap_or(moment.now);
        let all = [moment.now, next(moment.now), before, next(before)];
        all.into_iter().zip(moment.shares).map(|(generation, share)| of(generation) * f64::from(share)).sum()
    }

    #[test]
    fn shares_sum_to_one_and_nothing_pops() {
        let automaton = Automaton { generation_secs: 1.0, ..Automaton::default() };
        // Any numbers that differ from run to run and from generation to generation.
        let of = |g: Generation| ((g.epoch * 131 + i64::from(g.index) * 37).rem_euclid(97)) as f64 / 97.0;
        let mut last: Option<f64> = None;
        for step in -40_000..40_000 {
            let moment = automaton.at(f64::from(step) * 0.01);
            assert!((moment.shares.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{moment:?}");
            let shown = density(moment, of);
            assert!(last.is_none_or(|last| (shown - last).abs() < 0.02), "at {step}: {last:?} to {shown}");
            last = Some(shown);
        }
    }

    #[test]
    fn runs_are_short_at_any_time() {
        let automaton = Automaton::default();
        let million_years = 1e6 * 365.25 * 86_400.0;
        assert_eq!(automaton.at(0.0).before, None, "one run is enough to begin with");
        for time in [0.0, -1.0, 1e9, -million_years, million_years, f64::MAX, f64::MIN, f64::NAN] {
            let moment = automaton.at(time);
            for generation in [Some(moment.now), moment.before].into_iter().flatten() {
                assert!(generation.index < EPOCH + WARM_UP + HAND_OVER, "{time}: {moment:?}");
            }
            assert!(moment.shares.iter().all(|share| (0.0..=1.0).contains(share)), "{time}: {moment:?}");
        }
    }

    #[test]
    fn both_runs_of_a_hand_over_are_in_the_same_chapter() {
        let automaton = Automaton { generation_secs: 1.0, ..Automaton::default() };
        let moment = automaton.at(3.0 * f64::from(EPOCH) - f64::from(HAND_OVER) + 5.5);
        let before = moment.before.expect("it hands over");
        assert_eq!(automaton.chapter(moment.now), automaton.chapter(before));
        assert_eq!(automaton.chapter(moment.now), i64::from(3 * EPOCH / CHAPTER));
        let steady = Automaton { change: 0.0, ..automaton };
        assert_eq!(steady.chapter(moment.now), 0);
    }
}
