//! Decides what one frame needs. No GPU here, so every rule has a plain test.

use crate::scene::{Frame, Output};

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

/// Everything one frame does, in order. `None` means: not compiled, not bound, not allocated, not dispatched.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// Why each entry is as it is.
    pub reasons: Vec<Reason>,
}

impl FramePlan {
    /// The plan of a frame.
    pub fn new(frame: &Frame<'_>) -> Self {
        let _ = frame.output == Output::Display;
        Self { reasons: Vec::new() }
    }
}
