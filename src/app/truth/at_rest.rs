//! The window's picture at rest: the realtime one with several samples of each pixel, then the converged one with as many.

use super::slot::Slot;
use super::{LEVELS, SLICE, TOLERANCE};
use crate::gpu::Texture;
use crate::render::truth::{Convergence, Goal, Truth};
use crate::render::{RenderError, Renderer, Still};
use crate::scene::Frame;

/// What a slice of work led to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Worked {
    pub(super) is_done: bool,
    pub(super) has_picture: bool,
}

/// The picture at rest of one moment.
#[derive(Debug, Default)]
pub(super) struct AtRest {
    smooth: Slot<Still>,
    smooth_samples: (u32, u32),
    converged: Slot<Truth>,
    progress: Option<Convergence>,
    has_cloud: bool,
}

impl AtRest {
    pub(super) fn has_begun_smooth(&self) -> bool {
        self.smooth.is_begun()
    }

    pub(super) fn begin_smooth(&mut self, renderer: &mut Renderer, frame: &Frame<'_>) -> Result<(), RenderError> {
        let quality = frame.quality.of_still();
        let still = renderer.begin_still(&Frame { quality: &quality, ..*frame }, quality.pixel_samples)?;
        self.smooth_samples = still.pixel_samples();
        self.smooth = Slot::Working(Box::new(still));
        Ok(())
    }

    /// A slice of the smooth picture.
    pub(super) fn work_on_smooth(&mut self, renderer: &Renderer) -> Result<Worked, RenderError> {
        let Slot::Working(still) = &mut self.smooth else { return Ok(Worked { is_done: true, has_picture: false }) };
        let is_done = still.advance(renderer, SLICE)?;
        let samples = still.pixel_samples();
        let has_picture = samples != self.smooth_samples;
        self.smooth_samples = samples;
        if is_done {
            self.smooth.finish(Still::into_display);
        }
        Ok(Worked { is_done, has_picture })
    }

    pub(super) fn has_begun_converged(&self) -> bool {
        self.converged.is_begun()
    }

    pub(super) fn begin_converged(&mut self, renderer: &mut Renderer, frame: &Frame<'_>) -> Result<(), RenderError> {
        let goal = Goal::Converged { tolerance: TOLERANCE, levels: LEVELS };
        let truth = renderer.begin_truth(frame, goal, frame.quality.pixel_samples)?;
        self.progress = Some(truth.progress());
        self.has_cloud = truth.plan().has_clouds();
        self.converged = Slot::Working(Box::new(truth));
        Ok(())
    }

    /// A slice of the converged picture.
    pub(super) fn work_on_converged(&mut self, renderer: &Renderer) -> Result<Worked, RenderError> {
        let Slot::Working(truth) = &mut self.converged else { return Ok(Worked { is_done: true, has_picture: false }) };
        // Half a slice: what is begun before it is over runs for a whole one.
        let progress = truth.advance(renderer, SLICE / 2, SLICE)?;
        let stage = |progress: Convergence| (progress.finished, progress.pixel_samples);
        let has_picture = self.progress.is_none_or(|before| stage(before) != stage(progress));
        self.progress = Some(progress);
        if progress.is_done {
            self.converged.finish(Truth::into_display);
            self.smooth = Slot::Empty;
        }
        Ok(Worked { is_done: progress.is_done, has_picture })
    }

    /// The best picture so far. Before it has all its samples, a converged one has rougher edges than the smooth one.
    pub(super) fn display(&self) -> Option<&Texture> {
        let smooth = self.smooth.display(Still::display);
        match &self.converged {
            Slot::Working(_) if smooth.is_some() => smooth,
            converged => converged.display(Truth::display).or(smooth),
        }
    }

    /// Samples of each pixel of the smooth picture: finished, and in the end.
    pub(super) fn smooth_samples(&self) -> (u32, u32) {
        self.smooth_samples
    }

    /// How far the converged picture is, once it has been begun.
    pub(super) fn progress(&self) -> Option<Convergence> {
        self.progress
    }

    /// Whether there is cloud to converge, once that has been begun.
    pub(super) fn has_cloud(&self) -> bool {
        self.has_cloud
    }

    /// Device memory held, in bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.smooth.bytes(Still::bytes) + self.converged.bytes(Truth::bytes)
    }
}
