//! A sweep over settings of quality under way: truths first, then errors, then times, a short step at a time. It can be
//! left after each step, taken up again, and read whenever one likes.

use std::time::Duration;

use super::accuracy::{AccuracyError, Measured, Setting, TruthImage, begin_truth, compared, timed};
use crate::plan::Integrator;
use crate::render::Renderer;
use crate::render::truth::{Convergence, Goal, Truth};
use crate::scene::Scene;

/// Rounds that are enough for a setting whose march takes longer than [`SLOW_MS`].
const SLOW_ROUNDS: usize = 3;
const SLOW_MS: f64 = 2000.0;
/// Work on a truth in one step.
const STEP: Duration = Duration::from_millis(200);

/// The truths to measure against, until they are within a tolerance: the converged march, paths of at most so many
/// samples, or both.
pub fn goals(tolerance: f32, converged: bool, paths: Option<u32>) -> Vec<Goal> {
    let converged = converged.then_some(Goal::Converged { tolerance, levels: 8 });
    let traced = paths.map(|samples| Goal::PathTraced { tolerance, samples, scatterings: None, seed: 0 });
    converged.into_iter().chain(traced).collect()
}

/// What is measured.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The sky.
    pub scene: Scene,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The settings; the first is the one in use, which the truths are found for.
    pub settings: Vec<Setting>,
    /// Truths to measure against.
    pub goals: Vec<Goal>,
    /// Timed rounds over all settings.
    pub rounds: u32,
    /// Jitters of the march that each setting is compared with; 1 for the usual one alone.
    pub seeds: u32,
}

/// A sweep under way or finished.
#[derive(Debug)]
pub struct Sweep {
    plan: Plan,
    truths: Vec<TruthImage>,
    under_way: Option<Truth>,
    rows: Vec<Measured>,
    /// Timings taken.
    timings: usize,
}

/// Where a sweep is.
#[derive(Clone, Debug, PartialEq)]
pub enum At {
    /// A truth is being found; `None` before its first step.
    Truth(Goal, Option<Convergence>),
    /// So many settings are compared.
    Comparing(usize),
    /// So many timings are taken, of so many.
    Timing(usize, usize),
    /// At the end.
    Done,
}

impl Sweep {
    /// Nothing measured yet.
    pub fn new(plan: Plan) -> Self {
        Self { plan, truths: Vec::new(), under_way: None, rows: Vec::new(), timings: 0 }
    }

    /// Where it is.
    pub fn at(&self) -> At {
        let timings = self.plan.settings.len() * self.plan.rounds as usize;
        if let Some(goal) = self.plan.goals.get(self.truths.len()) {
            At::Truth(*goal, self.under_way.as_ref().map(Truth::progress))
        } else if self.rows.len() < self.plan.settings.len() {
            At::Comparing(self.rows.len())
        } else if self.timings < timings {
            At::Timing(self.timings, timings)
        } else {
            At::Done
        }
    }

    /// Takes the next step; returns whether all is measured.
    ///
    /// # Errors
    /// [`AccuracyError`] if a frame cannot be rendered or compared.
    pub fn advance(&mut self, renderer: &mut Renderer) -> Result<bool, AccuracyError> {
        let Plan { scene, size, settings, seeds, .. } = &self.plan;
        match self.at() {
            At::Truth(goal, _) => self.find(renderer, goal)?,
            At::Comparing(index) => {
                self.rows.push(compared(renderer, scene, &settings[index], (&self.truths, *size, *seeds))?);
            }
            At::Timing(taken, _) => {
                let row = &mut self.rows[taken % settings.len()];
                let is_slow = row.march_ms.first().is_some_and(|millis| *millis > SLOW_MS);
                if !is_slow || row.march_ms.len() < SLOW_ROUNDS {
                    timed(renderer, scene, row, *size)?;
                }
                self.timings += 1;
            }
            At::Done => {}
        }
        Ok(self.at() == At::Done)
    }

    fn find(&mut self, renderer: &mut Renderer, goal: Goal) -> Result<(), AccuracyError> {
        let Plan { scene, size, settings, .. } = &self.plan;
        let mut truth = match self.under_way.take() {
            Some(truth) => truth,
            None => begin_truth(renderer, (scene, &settings[0].quality), *size, goal)?,
        };
        if truth.advance(renderer, STEP, STEP)?.is_done {
            self.truths.push(TruthImage::of(renderer, truth, goal, *size)?);
        } else {
            self.under_way = Some(truth);
        }
        Ok(())
    }

    /// What is measured.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The truths that are found.
    pub fn truths(&self) -> &[TruthImage] {
        &self.truths
    }

    /// The integrators of all truths, found or not.
    pub fn integrators(&self) -> Vec<Integrator> {
        self.plan.goals.iter().map(|goal| goal.integrator()).collect()
    }

    /// What was measured so far.
    pub fn rows(&self) -> &[Measured] {
        &self.rows
    }

    /// Size and rounds in words, and whether it is at its end.
    pub fn title(&self, name: &str) -> String {
        let [width, height] = self.plan.size;
        let slow = self.rows.iter().filter(|row| row.march_ms.first().is_some_and(|millis| *millis > SLOW_MS)).count();
        let few = if slow > 0 && self.plan.rounds as usize > SLOW_ROUNDS {
            format!(", {SLOW_ROUNDS} for {slow} of over 2 s")
        } else {
            String::new()
        };
        let partial = if self.at() == At::Done { "" } else { ", PARTIAL" };
        format!("{name}, {width}×{height}, {} rounds{few}{partial}", self.plan.rounds)
    }
}
