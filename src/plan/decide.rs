//! Verdicts: for each effect whether it runs, and why, in words.

use super::effect::{Effect, Forced};

/// What the scene makes of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// The picture is another one without it.
    Needed,
    /// It would change nothing.
    Needless,
    /// It would change something, but the user has left it out.
    Unwanted,
    /// It cannot run here.
    Impossible,
}

/// One line of the plan: what runs or does not, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// The effect.
    pub effect: Effect,
    /// Whether this frame runs it.
    pub runs: bool,
    /// What the scene makes of it.
    pub need: Need,
    /// Why, in words.
    pub because: String,
}

impl Verdict {
    /// Whether it runs, or does not, because it was forced to.
    pub fn is_forced(&self) -> bool {
        self.runs != (self.need == Need::Needed)
    }

    /// Whether forcing it the other way does anything.
    pub fn can_be_forced(&self) -> bool {
        match self.need {
            Need::Needed => self.effect.info().can_be_off,
            Need::Needless | Need::Unwanted => true,
            Need::Impossible => false,
        }
    }

    /// Its line in a list.
    pub fn line(&self) -> String {
        let mark = if self.runs { "●" } else { "–" };
        let forced = match (self.is_forced(), self.runs) {
            (true, true) => " (forced on)",
            (true, false) => " (forced off)",
            _ => "",
        };
        format!("{mark} {}{forced}: {}", self.effect.info().name, self.because)
    }
}

/// Verdicts while a plan is made.
#[derive(Debug)]
pub(super) struct Verdicts {
    forced: Forced,
    all: Vec<Verdict>,
}

impl Verdicts {
    pub(super) fn new(forced: Forced) -> Self {
        Self { forced, all: Vec::with_capacity(Effect::ALL.len()) }
    }

    /// Takes note of a verdict and says whether the effect runs.
    pub(super) fn decide(&mut self, effect: Effect, need: Need, because: impl Into<String>) -> bool {
        let is_needed = need == Need::Needed;
        let verdict = Verdict { effect, runs: is_needed, need, because: because.into() };
        let runs = match self.forced.get(effect) {
            Some(wanted) if verdict.can_be_forced() => wanted,
            _ => is_needed,
        };
        self.all.push(Verdict { runs, ..verdict });
        runs
    }

    /// [`Self::decide`] for what is needed, with one reason, or changes nothing, with the other.
    pub(super) fn needed_if(
        &mut self,
        is_needed: bool,
        effect: Effect,
        if_so: impl Into<String>,
        if_not: impl Into<String>,
    ) -> bool {
        if is_needed { self.decide(effect, Need::Needed, if_so) } else { self.decide(effect, Need::Needless, if_not) }
    }

    /// Several reasons for which an effect does not run, the first that applies, or why it does.
    pub(super) fn unless(
        &mut self,
        effect: Effect,
        obstacles: &[(bool, Need, &str)],
        otherwise: impl Into<String>,
    ) -> bool {
        match obstacles.iter().find(|(applies, ..)| *applies) {
            Some((_, need, because)) => self.decide(effect, *need, *because),
            None => self.decide(effect, Need::Needed, otherwise),
        }
    }

    /// All verdicts in the order of the effects. What nobody asked about belongs to something that does not run.
    pub(super) fn complete(mut self) -> Vec<Verdict> {
        for effect in Effect::ALL {
            if !self.all.iter().any(|verdict| verdict.effect == *effect) {
                self.decide(*effect, Need::Impossible, "nothing that it belongs to is drawn");
            }
        }
        self.all.sort_by_key(|verdict| verdict.effect);
        self.all
    }
}
