//! The plan in words.

/// One line of the plan for people: what runs or does not, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reason {
    /// The effect.
    pub effect: &'static str,
    /// Whether this frame runs it.
    pub runs: bool,
    /// Why, in words.
    pub because: String,
}

/// Reasons while a plan is made.
#[derive(Debug, Default)]
pub(super) struct Reasons(pub(super) Vec<Reason>);

impl Reasons {
    pub(super) fn yes(&mut self, effect: &'static str, because: impl Into<String>) {
        self.0.push(Reason { effect, runs: true, because: because.into() });
    }

    pub(super) fn no(&mut self, effect: &'static str, because: impl Into<String>) {
        self.0.push(Reason { effect, runs: false, because: because.into() });
    }

    pub(super) fn either(
        &mut self,
        runs: bool,
        effect: &'static str,
        if_so: impl Into<String>,
        if_not: impl Into<String>,
    ) {
        if runs { self.yes(effect, if_so) } else { self.no(effect, if_not) }
    }
}
