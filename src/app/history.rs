//! What can be undone: the document before each step, and cameras before each flight.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::scene::{Camera, Preset, Quality};

/// Older steps are forgotten.
const MOST_STEPS: usize = 300;
/// Changes of the same thing that follow each other faster are one step, such as turns of a wheel.
const ONE_STEP: Duration = Duration::from_millis(1000);

/// How much of the document a step brings back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// Sky and quality; the camera stays, as flights have a history of their own.
    Sky,
    /// Sky, quality and camera.
    Camera,
    /// Another document altogether, with its file.
    Document,
}

/// Everything a step may bring back.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) preset: Preset,
    pub(super) quality: Quality,
    pub(super) path: Option<PathBuf>,
    pub(super) saved: Preset,
    /// Seconds since the scene began, and whether time runs.
    pub(super) time: (f64, bool),
}

/// A step with the document on its other side: before it among those that can be undone, after it among the others.
#[derive(Clone, Debug)]
struct Step {
    name: String,
    scope: Scope,
    state: State,
}

/// Steps that can be undone and redone.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    past: Vec<Step>,
    future: Vec<Step>,
    /// Counts presses of the pointer: what happens while it is held is one step.
    gesture: u64,
    is_held: bool,
    /// Gesture and time of the last step.
    last: Option<(u64, Instant)>,
}

impl History {
    /// Says whether the pointer is held.
    pub(super) fn hold(&mut self, is_held: bool) {
        if is_held && !self.is_held {
            self.gesture += 1;
        }
        self.is_held = is_held;
    }

    /// Remembers a step by what the document was before it. What was undone is forgotten.
    pub(super) fn record(&mut self, name: String, scope: Scope, before: State) {
        let goes_on =
            self.last.is_some_and(|(gesture, at)| gesture == self.gesture && (self.is_held || at.elapsed() < ONE_STEP));
        let is_same = self.past.last().is_some_and(|step| step.name == name) && scope != Scope::Document;
        if !(goes_on && is_same && self.future.is_empty()) {
            self.past.push(Step { name, scope, state: before });
            self.past.drain(..self.past.len().saturating_sub(MOST_STEPS));
        }
        self.future.clear();
        self.last = Some((self.gesture, Instant::now()));
    }

    /// Takes a step back: what it brings back, given the document as it is.
    pub(super) fn undo(&mut self, now: State) -> Option<(Scope, State)> {
        Self::step(&mut self.past, &mut self.future, now, &mut self.last)
    }

    /// Takes it again.
    pub(super) fn redo(&mut self, now: State) -> Option<(Scope, State)> {
        Self::step(&mut self.future, &mut self.past, now, &mut self.last)
    }

    fn step(
        from: &mut Vec<Step>,
        to: &mut Vec<Step>,
        now: State,
        last: &mut Option<(u64, Instant)>,
    ) -> Option<(Scope, State)> {
        let step = from.pop()?;
        to.push(Step { name: step.name, scope: step.scope, state: now });
        *last = None;
        Some((step.scope, step.state))
    }

    /// Names of the steps that can be undone, the oldest first, and of those that can be redone, the next first.
    pub(super) fn names(&self) -> (Vec<&str>, Vec<&str>) {
        (
            self.past.iter().map(|step| step.name.as_str()).collect(),
            self.future.iter().rev().map(|step| step.name.as_str()).collect(),
        )
    }

    /// How many steps can be undone and redone.
    pub(super) fn depth(&self) -> (usize, usize) {
        (self.past.len(), self.future.len())
    }
}

/// Cameras to go back to and forth.
#[derive(Clone, Debug, Default)]
pub(super) struct Views {
    past: Vec<Camera>,
    future: Vec<Camera>,
    moved: Option<Instant>,
}

impl Views {
    /// Remembers a camera that is being left; a flight without a pause is one step, a jump is one of its own.
    pub(super) fn leave(&mut self, camera: &Camera, is_jump: bool) {
        let is_new = self.moved.is_none_or(|moved| moved.elapsed() >= ONE_STEP);
        if is_new || is_jump {
            self.past.push(camera.clone());
            self.past.drain(..self.past.len().saturating_sub(MOST_STEPS));
        }
        self.future.clear();
        self.moved = Some(Instant::now());
    }

    /// The camera before, given the one there is.
    pub(super) fn back(&mut self, now: &Camera) -> Option<Camera> {
        let camera = self.past.pop()?;
        self.future.push(now.clone());
        self.moved = None;
        Some(camera)
    }

    /// The camera after it.
    pub(super) fn forth(&mut self, now: &Camera) -> Option<Camera> {
        let camera = self.future.pop()?;
        self.past.push(now.clone());
        self.moved = None;
        Some(camera)
    }

    /// How many cameras there are to go back and forth to.
    pub(super) fn depth(&self) -> (usize, usize) {
        (self.past.len(), self.future.len())
    }
}
