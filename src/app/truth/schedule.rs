//! When truths are worked on: after half a second without a change, one thing after the other, until all that is wished
//! for is finished. No device here, and the clock is the caller's.

use std::time::{Duration, Instant};

use crate::plan::Integrator;

/// How long nothing must have happened.
const QUIET: Duration = Duration::from_millis(500);

/// One piece of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Task {
    /// The realtime picture with several samples of each pixel.
    Smooth,
    /// The same, converged.
    Converged,
    /// The realtime picture of all pixels, to compare.
    Still,
    /// A truth to compare it with.
    Truth(Integrator),
}

impl Task {
    /// Whether its light is measured, rather than shown alone.
    pub(super) fn is_measured(self) -> bool {
        matches!(self, Self::Still | Self::Truth(_))
    }
}

/// What the user wants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Wishes {
    /// Whether the picture refines at rest.
    pub(crate) refines: bool,
    /// What the realtime picture is compared with, if it is.
    pub(crate) compare: Option<Integrator>,
    /// Whether truths stay as they are.
    pub(crate) is_kept: bool,
    /// Whether time runs or the camera flies.
    pub(crate) moves: bool,
}

/// What to do now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// Nothing, until something happens.
    Rest,
    /// Nothing before then.
    WaitUntil(Instant),
    /// This, for one slice.
    Work(Task),
}

/// What is finished of the present picture, and when it was last disturbed.
#[derive(Debug)]
pub(super) struct Schedule {
    disturbed: Instant,
    finished: Vec<Task>,
}

impl Schedule {
    pub(super) fn new(now: Instant) -> Self {
        Self { disturbed: now, finished: Vec::new() }
    }

    /// Something was touched that changes no picture: work waits.
    pub(super) fn touch(&mut self, now: Instant) {
        self.disturbed = now;
    }

    /// When something was touched or changed last.
    pub(super) fn disturbed(&self) -> Instant {
        self.disturbed
    }

    /// The picture has changed: nothing of what was finished counts.
    pub(super) fn restart(&mut self, now: Instant) {
        self.disturbed = now;
        self.finished.clear();
    }

    /// A task has reached its end, or cannot get there.
    pub(super) fn finished(&mut self, task: Task) {
        self.finished.push(task);
    }

    /// What to do while the window's own picture is finished.
    pub(super) fn turn(&self, now: Instant, wishes: Wishes) -> Turn {
        let Some(task) = self.next(wishes) else { return Turn::Rest };
        if wishes.moves {
            return Turn::Rest;
        }
        match self.disturbed.checked_add(QUIET) {
            Some(quiet) if now < quiet => Turn::WaitUntil(quiet),
            _ => Turn::Work(task),
        }
    }

    fn next(&self, wishes: Wishes) -> Option<Task> {
        let tasks = match wishes.compare {
            Some(_) if wishes.is_kept => [Some(Task::Still), None],
            Some(reference) => [Some(Task::Still), Some(Task::Truth(reference))],
            None if wishes.refines && !wishes.is_kept => [Some(Task::Smooth), Some(Task::Converged)],
            None => [None, None],
        };
        tasks.into_iter().flatten().find(|task| !self.finished.contains(task))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRACED: Task = Task::Truth(Integrator::PathTraced);
    const REFINES: Wishes = Wishes { refines: true, compare: None, is_kept: false, moves: false };

    fn after(start: Instant, millis: u64) -> Instant {
        start + Duration::from_millis(millis)
    }

    #[test]
    fn rest_refines_input_suspends_and_the_goal_ends_it() {
        let start = Instant::now();
        let mut schedule = Schedule::new(start);
        assert_eq!(schedule.turn(after(start, 400), REFINES), Turn::WaitUntil(after(start, 500)), "not yet at rest");
        assert_eq!(schedule.turn(after(start, 500), REFINES), Turn::Work(Task::Smooth));
        schedule.finished(Task::Smooth);
        assert_eq!(schedule.turn(after(start, 600), REFINES), Turn::Work(Task::Converged));
        schedule.touch(after(start, 700));
        assert_eq!(schedule.turn(after(start, 700), REFINES), Turn::WaitUntil(after(start, 1200)), "suspended at once");
        assert_eq!(schedule.turn(after(start, 1200), REFINES), Turn::Work(Task::Converged), "and taken up again");
        schedule.finished(Task::Converged);
        assert_eq!(schedule.turn(after(start, 1300), REFINES), Turn::Rest, "within tolerance: no work, no wake-up");
        schedule.touch(after(start, 2000));
        assert_eq!(schedule.turn(after(start, 9000), REFINES), Turn::Rest, "a mouse that moves begins nothing");
    }

    #[test]
    fn an_edit_begins_anew() {
        let start = Instant::now();
        let mut schedule = Schedule::new(start);
        schedule.finished(Task::Smooth);
        schedule.restart(after(start, 1000));
        assert_eq!(schedule.turn(after(start, 1001), REFINES), Turn::WaitUntil(after(start, 1500)));
        assert_eq!(schedule.turn(after(start, 1500), REFINES), Turn::Work(Task::Smooth));
    }

    #[test]
    fn nothing_is_done_when_off_or_while_time_runs() {
        let start = Instant::now();
        let schedule = Schedule::new(start);
        assert_eq!(schedule.turn(after(start, 900), Wishes { refines: false, ..REFINES }), Turn::Rest);
        assert_eq!(schedule.turn(after(start, 900), Wishes { moves: true, ..REFINES }), Turn::Rest);
    }

    #[test]
    fn comparing_needs_both_pictures_even_with_refinement_off() {
        let start = Instant::now();
        let mut schedule = Schedule::new(start);
        let wishes = Wishes { refines: false, compare: Some(Integrator::PathTraced), ..REFINES };
        let now = after(start, 900);
        assert_eq!(schedule.turn(now, wishes), Turn::Work(Task::Still));
        schedule.finished(Task::Still);
        assert_eq!(schedule.turn(now, wishes), Turn::Work(TRACED));
        schedule.finished(TRACED);
        assert_eq!(schedule.turn(now, wishes), Turn::Rest);
        assert_eq!(schedule.turn(now, Wishes { refines: true, ..wishes }), Turn::Rest, "what nobody sees waits");
        assert_eq!(schedule.turn(now, REFINES), Turn::Work(Task::Smooth));
    }

    #[test]
    fn what_is_kept_is_not_worked_on() {
        let start = Instant::now();
        let schedule = Schedule::new(start);
        let now = after(start, 900);
        let kept = Wishes { is_kept: true, ..REFINES };
        assert_eq!(schedule.turn(now, kept), Turn::Rest);
        assert_eq!(schedule.turn(now, REFINES), Turn::Work(Task::Smooth), "and goes on afterwards");
        let compared = Wishes { compare: Some(Integrator::Converged), ..kept };
        assert_eq!(schedule.turn(now, compared), Turn::Work(Task::Still), "there must be something to compare");
    }
}
