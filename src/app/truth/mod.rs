//! Pictures that converge, beside the window's own: when they are worked on, and what is kept of them.

mod at_rest;
mod compare;
mod schedule;
mod slot;

pub(super) use compare::{Compared, Job as CompareJob};
pub(super) use schedule::{Task, Turn, Wishes};

use std::time::{Duration, Instant};

use super::viewport::Inputs;
use crate::gpu::Texture;
use crate::plan::Integrator;
use crate::render::truth::{Convergence, Goal, Truth};
use crate::render::{RenderError, Renderer, Still};
use crate::scene::{Frame, Output, Quality, UpdateFraction};
use crate::ui::{Figures, Picture, Refined, Refinement};
use at_rest::{AtRest, Worked};
use compare::Linear;
use schedule::Schedule;
use slot::Slot;

/// Work between two turns of the event loop.
const SLICE: Duration = Duration::from_millis(20);
/// How often it is looked whether shaders have been compiled.
const COMPILE_POLL: Duration = Duration::from_millis(60);
/// Where a truth is good enough: 1 %.
const TOLERANCE: f32 = 0.01;
/// Levels of the ladder, and paths of each pixel, at most.
const LEVELS: u32 = 7;
const PATHS: u32 = 4096;

/// What a turn led to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Outcome {
    /// When the next turn is due; `None` if something has to happen first.
    pub(super) wake: Option<Instant>,
    /// Whether something was worked on.
    pub(super) has_worked: bool,
    /// Whether a picture is new.
    pub(super) has_picture: bool,
}

/// A truth, and what is remembered of it.
#[derive(Debug)]
struct Kept {
    truth: Truth,
    /// Level or samples of the picture that is shown.
    finished: Option<u32>,
    /// The same of the picture that was compared last.
    compared: Option<u32>,
}

/// All that belongs to one moment of the scene.
#[derive(Debug, Default)]
struct Moment {
    /// What is shown at rest.
    at_rest: AtRest,
    /// What is compared.
    still: Slot<Still>,
    converged: Option<Kept>,
    traced: Option<Kept>,
    /// The still's light, once it was read back.
    linear: Option<std::sync::Arc<Linear>>,
    figures: Figures,
    /// Difference maps by reference, and the end of their scale.
    maps: [Option<(Difference, f32)>; 2],
}

/// Two colour maps on the device: signed, and absolute.
struct Difference([egui::TextureHandle; 2], [u32; 2]);

impl std::fmt::Debug for Difference {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_tuple("Difference").field(&self.1).finish()
    }
}

/// The truths of what the window shows, from when it comes to rest until something changes.
#[derive(Debug)]
pub(super) struct Truths {
    schedule: Schedule,
    inputs: Option<Inputs>,
    quality: Quality,
    /// Counts the moments, so that late comparisons can be told.
    generation: u64,
    moment: Moment,
    is_comparing: bool,
    /// What the last turn was about.
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    Compiling,
    At(Task),
}

impl Truths {
    pub(super) fn new() -> Self {
        Self {
            schedule: Schedule::new(Instant::now()),
            inputs: None,
            quality: Quality::default(),
            generation: 0,
            moment: Moment::default(),
            is_comparing: false,
            state: State::Idle,
        }
    }

    /// Takes note of what the picture depends on; returns whether that is something new, for which nothing is left.
    pub(super) fn follow(&mut self, inputs: &Inputs, now: Instant) -> bool {
        if self.inputs.as_ref() == Some(inputs) {
            return false;
        }
        self.quality = Quality { update: UpdateFraction::Full, resolution_scale: 1.0, ..inputs.quality.clone() };
        self.inputs = Some(inputs.clone());
        self.moment = Moment::default();
        self.generation += 1;
        self.is_comparing = false;
        self.schedule.restart(now);
        if self.quality.pixel_samples == 1 && self.quality.of_still() == self.quality {
            // The window's own frame is that picture.
            self.schedule.finished(Task::Smooth);
        }
        self.state = State::Idle;
        true
    }

    /// Takes note that something was touched.
    pub(super) fn touch(&mut self, now: Instant) {
        self.schedule.touch(now);
    }

    /// When something was touched or changed last.
    pub(super) fn disturbed(&self) -> Instant {
        self.schedule.disturbed()
    }

    /// Takes a turn, once the window's own picture is finished.
    pub(super) fn turn(&mut self, renderer: &mut Renderer, wishes: Wishes) -> Result<Outcome, RenderError> {
        let now = Instant::now();
        let task = match self.schedule.turn(now, wishes) {
            Turn::Rest => {
                self.state = State::Idle;
                return Ok(Outcome::default());
            }
            Turn::WaitUntil(when) => {
                self.state = State::Idle;
                return Ok(Outcome { wake: Some(when), ..Outcome::default() });
            }
            Turn::Work(task) => task,
        };
        let outcome = self.work(task, renderer);
        if outcome.is_err() {
            // What failed once is not tried again for the same picture.
            self.schedule.finished(task);
        }
        outcome
    }

    fn work(&mut self, task: Task, renderer: &mut Renderer) -> Result<Outcome, RenderError> {
        if !self.begin(task, renderer)? {
            self.state = State::Compiling;
            return Ok(Outcome { wake: Some(Instant::now() + COMPILE_POLL), has_worked: true, has_picture: false });
        }
        self.state = State::At(task);
        let Worked { is_done, has_picture } = match task {
            Task::Smooth => self.moment.at_rest.work_on_smooth(renderer)?,
            Task::Converged => self.moment.at_rest.work_on_converged(renderer)?,
            Task::Still => self.moment.work_on_still(renderer)?,
            Task::Truth(integrator) => self.moment.work_on_truth(integrator, renderer)?,
        };
        if is_done {
            self.schedule.finished(task);
        }
        Ok(Outcome { wake: Some(Instant::now()), has_worked: true, has_picture })
    }

    /// Begins what a task needs; `false` while shaders are compiled for it.
    fn begin(&mut self, task: Task, renderer: &mut Renderer) -> Result<bool, RenderError> {
        let Some(inputs) = &self.inputs else { return Ok(false) };
        // What is compared with reads the clouds themselves, not their voxels.
        let grid_voxels = if matches!(task, Task::Truth(_)) { 0 } else { self.quality.grid_voxels };
        let quality = Quality { grid_voxels, ..self.quality.clone() };
        let frame = Frame {
            scene: &inputs.scene,
            quality: &quality,
            size: inputs.size,
            time_secs: inputs.time_secs,
            output: if task.is_measured() { Output::Linear } else { Output::Display },
            window: inputs.window,
        };
        let (is_there, integrator) = match task {
            Task::Smooth => (self.moment.at_rest.has_begun_smooth(), Integrator::Realtime),
            Task::Converged => (self.moment.at_rest.has_begun_converged(), Integrator::Converged),
            Task::Still => (self.moment.still.is_begun(), Integrator::Realtime),
            Task::Truth(integrator) => (self.moment.kept(integrator).is_some(), integrator),
        };
        if is_there {
            return Ok(true);
        }
        // What is measured looks through the middle of each pixel, as the frames of a flight do.
        let pixel_samples = if task.is_measured() { 1 } else { self.quality.pixel_samples };
        if !renderer.still_is_ready(&frame, integrator, pixel_samples)? {
            return Ok(false);
        }
        match task {
            Task::Smooth => self.moment.at_rest.begin_smooth(renderer, &frame)?,
            Task::Converged => self.moment.at_rest.begin_converged(renderer, &frame)?,
            Task::Still => self.moment.still = Slot::Working(Box::new(renderer.begin_still(&frame, pixel_samples)?)),
            Task::Truth(_) => {
                let truth = renderer.begin_truth(&frame, goal(integrator), pixel_samples)?;
                *self.moment.slot(integrator) = Some(Kept { truth, finished: None, compared: None });
            }
        }
        Ok(true)
    }

    /// What is compared next, if there is anything new to compare and nothing is being compared.
    pub(super) fn comparison(&mut self, renderer: &Renderer) -> Result<Option<CompareJob>, RenderError> {
        let (Some(inputs), false) = (&self.inputs, self.is_comparing) else { return Ok(None) };
        if self.still().is_none() {
            return Ok(None);
        }
        let is_new = |kept: &Kept| kept.finished.is_some() && kept.finished != kept.compared;
        let all = [Integrator::Converged, Integrator::PathTraced];
        let Some(integrator) = all.into_iter().find(|which| self.moment.kept(*which).is_some_and(is_new)) else {
            return Ok(None);
        };
        if let Slot::Working(still) = &self.moment.still {
            self.moment.linear = Some(std::sync::Arc::new(Linear::new(&still.picture(renderer)?)));
            self.moment.still.finish(Still::into_display);
        }
        let Some(linear) = self.moment.linear.clone() else { return Ok(None) };
        let (scene, size) = (inputs.scene.clone(), inputs.size);
        let Some(kept) = self.moment.kept_mut(integrator) else { return Ok(None) };
        kept.compared = kept.finished;
        let truth = kept.truth.picture(renderer)?;
        self.is_comparing = true;
        Ok(Some(CompareJob { generation: self.generation, integrator, scene, size, still: linear, truth }))
    }

    /// Takes in what a comparison found, unless the scene has moved on.
    pub(super) fn take(&mut self, context: &egui::Context, compared: Compared) {
        if compared.generation != self.generation {
            return;
        }
        self.is_comparing = false;
        let traced = compared.integrator == Integrator::PathTraced;
        if let Some([signed, absolute]) = compared.maps {
            let texture = |name: &str, image| context.load_texture(name, image, egui::TextureOptions::LINEAR);
            let textures = [texture("signed difference", signed), texture("absolute difference", absolute)];
            let size = textures[0].size().map(|side| u32::try_from(side).unwrap_or(1));
            self.moment.maps[usize::from(traced)] = Some((Difference(textures, size), compared.limit));
        }
        let figures = &mut self.moment.figures;
        *(if traced { &mut figures.traced } else { &mut figures.converged }) = Some(compared.errors);
    }

    /// The picture at rest, once there is one that is better than the window's frame.
    pub(super) fn at_rest(&self) -> Option<&Texture> {
        self.moment.at_rest.display()
    }

    /// The picture of a truth, once there is one.
    pub(super) fn display(&self, integrator: Integrator) -> Option<&Texture> {
        self.moment.kept(integrator).and_then(|kept| kept.truth.display())
    }

    /// The realtime picture of all pixels, once it is finished.
    pub(super) fn still(&self) -> Option<&Texture> {
        self.moment.still.display(Still::display)
    }

    /// What was measured so far, with the time of the truth that it was measured against.
    pub(super) fn figures(&self, reference: Integrator) -> Figures {
        let is_traced = reference == Integrator::PathTraced && self.moment.figures.traced.is_some();
        let measured = if is_traced { Integrator::PathTraced } else { Integrator::Converged };
        let truth_secs = self.moment.kept(measured).map(|kept| kept.truth.progress().spent_secs);
        Figures { truth_secs, ..self.moment.figures.clone() }
    }

    /// The difference to a truth in colours, signed and absolute, and the end of their scale.
    pub(super) fn difference(&self, reference: Integrator) -> Option<([Picture; 2], f32)> {
        let map = &self.moment.maps[usize::from(reference == Integrator::PathTraced)];
        let (Difference(textures, size), limit) = map.as_ref()?;
        Some(([0, 1].map(|which| Picture { texture: textures[which].id(), size: *size }), *limit))
    }

    /// What is said of the work.
    pub(super) fn refinement(&self, wishes: Wishes) -> Refinement {
        let at_rest = &self.moment.at_rest;
        let (integrator, progress, has_cloud) = match wishes.compare {
            None => (Integrator::Converged, at_rest.progress(), at_rest.has_cloud()),
            Some(reference) => {
                let kept = self.moment.kept(reference);
                let has_cloud = kept.is_some_and(|kept| kept.truth.plan().has_clouds());
                (reference, kept.map(|kept| kept.truth.progress()), has_cloud)
            }
        };
        match (self.state, progress) {
            (State::Compiling, _) => Refinement::Compiling,
            (State::At(Task::Smooth), _) => {
                let (finished, count) = at_rest.smooth_samples();
                Refinement::Smoothing { finished, count }
            }
            (State::At(Task::Still), _) => Refinement::Still,
            (State::At(_), None) => Refinement::Compiling,
            (State::Idle, None) => Refinement::Idle,
            (_, Some(progress)) => {
                let pixel_samples = match wishes.compare {
                    None => (progress.pixel_samples, self.quality.pixel_samples),
                    Some(_) => (progress.pixel_samples, 1),
                };
                let refined = refined(integrator, pixel_samples, &progress);
                if matches!(self.state, State::At(_)) {
                    Refinement::Working(refined)
                } else if !progress.is_done {
                    Refinement::Halted(refined)
                } else if has_cloud {
                    let is_within = progress.error.is_some_and(|error| error <= TOLERANCE);
                    Refinement::Done(refined, is_within)
                } else {
                    Refinement::NoCloud
                }
            }
        }
    }

    /// Faults that the shaders counted, in words.
    pub(super) fn faults(&self) -> Vec<String> {
        let kept = [&self.moment.converged, &self.moment.traced].into_iter().flatten();
        let compared = kept.map(|kept| (kept.truth.integrator(), kept.truth.progress()));
        let at_rest = self.moment.at_rest.progress().map(|progress| (Integrator::Converged, progress));
        compared.chain(at_rest).flat_map(|(integrator, progress)| faults(integrator, &progress)).collect()
    }

    /// Device memory held, in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let kept = [&self.moment.converged, &self.moment.traced].into_iter().flatten();
        let compared = kept.map(|kept| kept.truth.bytes()).sum::<u64>();
        self.moment.at_rest.bytes() + compared + self.moment.still.bytes(Still::bytes)
    }
}

impl Moment {
    fn work_on_still(&mut self, renderer: &Renderer) -> Result<Worked, RenderError> {
        let Slot::Working(still) = &mut self.still else { return Ok(Worked { is_done: true, has_picture: false }) };
        let is_done = still.advance(renderer, SLICE)?;
        if is_done {
            self.figures.cost_ms = still.total_ms();
            self.figures.source = still.source().label();
        }
        Ok(Worked { is_done, has_picture: is_done })
    }

    fn work_on_truth(&mut self, integrator: Integrator, renderer: &Renderer) -> Result<Worked, RenderError> {
        let Some(kept) = self.kept_mut(integrator) else { return Ok(Worked::default()) };
        // Half a slice: what is begun before it is over runs for a whole one.
        let progress = kept.truth.advance(renderer, SLICE / 2, SLICE)?;
        let finished = kept.truth.display().and(progress.finished);
        let has_picture = finished != kept.finished;
        kept.finished = finished;
        Ok(Worked { is_done: progress.is_done, has_picture })
    }

    fn slot(&mut self, integrator: Integrator) -> &mut Option<Kept> {
        if integrator == Integrator::PathTraced { &mut self.traced } else { &mut self.converged }
    }

    fn kept(&self, integrator: Integrator) -> Option<&Kept> {
        if integrator == Integrator::PathTraced { self.traced.as_ref() } else { self.converged.as_ref() }
    }

    fn kept_mut(&mut self, integrator: Integrator) -> Option<&mut Kept> {
        self.slot(integrator).as_mut()
    }
}

fn goal(integrator: Integrator) -> Goal {
    match integrator {
        Integrator::PathTraced => Goal::PathTraced { tolerance: TOLERANCE, samples: PATHS, scatterings: None, seed: 0 },
        _ => Goal::Converged { tolerance: TOLERANCE, levels: LEVELS },
    }
}

fn refined(integrator: Integrator, pixel_samples: (u32, u32), progress: &Convergence) -> Refined {
    let Convergence { finished, share, error, spent_secs, .. } = *progress;
    // A broken pixel must not make a status that differs from itself.
    let error = error.filter(|error| error.is_finite());
    Refined { integrator, finished, pixel_samples, share, error, spent_secs }
}

/// What a count that should be 0 means.
fn faults(integrator: Integrator, progress: &Convergence) -> Vec<String> {
    let counts = progress.counts;
    let mut faults = Vec::new();
    if counts.exceeded > 0 {
        faults.push(format!("Fault: the density exceeded its bound in {} places", counts.exceeded));
    }
    if counts.cut > 0 {
        let what = if integrator == Integrator::PathTraced { "paths" } else { "rays" };
        faults.push(format!("Fault: {} {what} were cut short", counts.cut));
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::truth::TruthCounts;

    #[test]
    fn counts_that_should_be_0_are_named() {
        let progress = |exceeded, cut| Convergence {
            is_done: false,
            share: 0.0,
            finished: None,
            pixel_samples: 0,
            error: None,
            counts: TruthCounts { steps: 5, light_steps: 5, exceeded, cut },
            spent_secs: 0.0,
        };
        assert!(faults(Integrator::PathTraced, &progress(0, 0)).is_empty());
        let seen = faults(Integrator::PathTraced, &progress(3, 2));
        assert_eq!(seen, ["Fault: the density exceeded its bound in 3 places", "Fault: 2 paths were cut short"]);
        assert_eq!(faults(Integrator::Converged, &progress(0, 1)), ["Fault: 1 rays were cut short"]);
    }
}
