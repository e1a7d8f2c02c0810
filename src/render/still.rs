//! A whole picture beside the frames of a window, every pixel marched afresh and several times. It has targets of its own,
//! so that the window's frames keep their history, and runs job by job, so that panels stay quick.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::context::Context;
use super::passes::{FrameBuffers, Passes};
use super::samples::PixelSamples;
use super::schedule::{frame_buffers, view_uniforms};
use super::targets::Targets;
use super::truth::{self, TruthPicture};
use super::uniforms::Eye;
use super::{LinearImage, RenderError, Renderer};
use crate::gpu::{Job, PassTime, Texture, TimingSource, job, readback};
use crate::plan::{FramePlan, Integrator, Lighting};
use crate::scene::Frame;

/// Longest job of a still or of what a truth needs first, in milliseconds.
pub(super) const JOB_MS: f64 = 20.0;

/// A still under way, or finished.
#[derive(Debug)]
pub struct Still {
    targets: Targets,
    candela_per_unit: f32,
    samples: PixelSamples,
    /// What each sample takes up to its light, and from there into either mean.
    each: Vec<Job>,
    finish: [Vec<Job>; 2],
    /// What is left of the present one.
    jobs: VecDeque<Job>,
    finished: u32,
    /// Whether no sample is begun any more.
    ends: bool,
    times: Vec<PassTime>,
    source: TimingSource,
}

/// What becomes of a picture that takes its time, as whoever waits for it says while it is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proceed {
    /// It is made to its end.
    On,
    /// It ends with the samples of each pixel that it has, at least one.
    WithWhatIsDone,
    /// It is given up.
    No,
}

/// How often it is looked whether shaders have been compiled, and whether a still is still wanted.
const COMPILE_POLL: Duration = Duration::from_millis(50);
const PROCEED_EVERY: Duration = Duration::from_millis(150);

/// What a picture beside the window's frames has to itself.
pub(super) struct Apart {
    pub(super) targets: Targets,
    pub(super) buffers: FrameBuffers,
    pub(super) samples: PixelSamples,
    pub(super) candela_per_unit: f32,
}

impl Renderer {
    /// Whether [`Self::begin_still`] ([`Integrator::Realtime`]) or [`Self::begin_truth`] finds its shaders ready, with so
    /// many samples of each pixel. Those that are not are compiled on other threads.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if a shader does not compile.
    pub fn still_is_ready(
        &self,
        frame: &Frame<'_>,
        integrator: Integrator,
        pixel_samples: u32,
    ) -> Result<bool, RenderError> {
        let plan = FramePlan::for_still(frame, (integrator, pixel_samples), self.forced);
        let mut is_ready = true;
        for key in super::programs(&plan).iter().chain(&truth::programs_of(&plan, integrator)) {
            is_ready &= self.programs.ready_or_start(key)?;
        }
        Ok(is_ready)
    }

    /// Starts a still of the frame with so many samples of each pixel. If it is to be measured, its output has to be one
    /// for a file.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn begin_still(&mut self, frame: &Frame<'_>, pixel_samples: u32) -> Result<Still, RenderError> {
        let plan = FramePlan::for_still(frame, (Integrator::Realtime, pixel_samples), self.forced);
        let Apart { targets, buffers, samples, candela_per_unit } = self.begin_apart(frame, &plan)?;
        let context = self.context_apart();
        let shared = self.shared_resources();
        let mut passes =
            Passes { context: &context, plan: &plan, targets: &targets, shared, buffers: &buffers, jobs: Vec::new() };
        passes.cloud_shadow()?;
        let first = std::mem::take(&mut passes.jobs);
        passes.background()?;
        let cloud = passes.march(None)?.map(|marched| &marched.light);
        passes.sunshafts(cloud)?;
        let each = std::mem::take(&mut passes.jobs);
        let finish = passes.finish_into_either(cloud)?;
        let jobs = first.iter().chain(&each).chain(&finish[0]).cloned().collect();
        let (source, times) = (TimingSource::of(&self.gpu), Vec::new());
        Ok(Still { targets, candela_per_unit, samples, each, finish, jobs, finished: 0, ends: false, times, source })
    }

    /// A finished still as the frame's quality has it: with its samples of each pixel, and its shorter steps.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn still(&mut self, frame: &Frame<'_>) -> Result<Still, RenderError> {
        let still = self.still_while(frame, &mut |_| Proceed::On)?;
        Ok(still.unwrap_or_else(|| unreachable!("nobody stops it")))
    }

    /// The same in slices: `proceed` hears the share of the work that is done several times a second, and
    /// says what becomes of the still. Shaders are compiled on other threads meanwhile.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn still_while(
        &mut self,
        frame: &Frame<'_>,
        proceed: &mut dyn FnMut(f32) -> Proceed,
    ) -> Result<Option<Still>, RenderError> {
        let quality = frame.quality.of_still();
        let frame = Frame { quality: &quality, ..*frame };
        while !self.still_is_ready(&frame, Integrator::Realtime, quality.pixel_samples)? {
            if proceed(0.0) == Proceed::No {
                return Ok(None);
            }
            std::thread::sleep(COMPILE_POLL);
        }
        let mut still = self.begin_still(&frame, quality.pixel_samples)?;
        while !still.advance(self, PROCEED_EVERY)? {
            match proceed(still.share()) {
                Proceed::On => {}
                Proceed::WithWhatIsDone => still.end(),
                Proceed::No => return Ok(None),
            }
        }
        Ok(Some(still))
    }

    /// Makes what a picture beside the window's frames reads, and the targets and buffers of its own.
    pub(super) fn begin_apart(&mut self, frame: &Frame<'_>, plan: &FramePlan) -> Result<Apart, RenderError> {
        self.finish_interactive()?;
        // Whoever gives the picture up must not leave tables half made.
        let bakes = self.schedule_bakes(frame, plan, None)?;
        job::submit(&self.gpu, &bakes);
        let lighting = Lighting::new(frame.scene);
        let eye = Eye::new(&frame.scene.camera);
        let (targets, _) = Targets::fitting(None, &self.gpu, plan, frame.render_size())?;
        let view = view_uniforms(frame, plan, &eye, None, &lighting);
        let buffers = frame_buffers(&self.context_apart(), frame, plan, (&view, &self.sun_grid));
        let samples = PixelSamples::new(&self.gpu, &view, &buffers.view, plan.pixel_samples);
        Ok(Apart { targets, buffers, samples, candela_per_unit: lighting.candela_per_unit })
    }

    /// What its passes are given: jobs short enough for the panels beside it.
    pub(super) fn context_apart(&self) -> Context<'_> {
        Context { gpu: &self.gpu, programs: &self.programs, pace: &self.pace, slice_ms: Some(JOB_MS) }
    }
}

impl Still {
    /// Works for about `budget` and waits for each job. Returns whether the picture is finished.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn advance(&mut self, renderer: &Renderer, budget: Duration) -> Result<bool, RenderError> {
        let started = Instant::now();
        while let Some(next) = self.jobs.pop_front() {
            for time in job::run(&renderer.gpu, std::slice::from_ref(&next))? {
                job::add(&mut self.times, time.pass, time.millis);
            }
            if self.jobs.is_empty() {
                self.finished += 1;
                if !self.ends && self.samples.next(&renderer.gpu) {
                    let finish = &self.finish[self.samples.side()];
                    self.jobs.extend(self.each.iter().chain(finish).cloned());
                }
            }
            if started.elapsed() >= budget {
                break;
            }
        }
        Ok(self.jobs.is_empty())
    }

    /// Begins no sample of the pixels any more. The one under way is dropped, unless it is the first, or about to be added to
    /// the mean.
    pub fn end(&mut self) {
        self.ends = true;
        if self.finished > 0 && self.jobs.len() > self.finish[0].len() {
            self.jobs.clear();
            self.samples.step_back();
        }
    }

    /// Share of the work that is done, 0 to 1.
    pub fn share(&self) -> f32 {
        let whole = (self.each.len() + self.finish[0].len()).max(1) as f32;
        let under_way = if self.jobs.is_empty() { 0.0 } else { 1.0 - (self.jobs.len() as f32 / whole).min(1.0) };
        ((self.finished as f32 + under_way) / self.samples.count().max(1) as f32).min(1.0)
    }

    /// Samples of each pixel that are finished, and how many there will be.
    pub fn pixel_samples(&self) -> (u32, u32) {
        (self.finished, self.samples.count())
    }

    /// The picture as it is shown, once a sample of each pixel is finished: `Rgba8Unorm`, display-encoded.
    pub fn display(&self) -> Option<&Texture> {
        (self.finished > 0).then_some(&self.targets.display[0])
    }

    /// The same, with everything else let go.
    pub fn into_display(self) -> Texture {
        let [display, _] = self.targets.display;
        display
    }

    /// The finished picture as it is shown, with 16 bits for each colour: of several samples a pixel, whose mean is kept as half
    /// floats of displayed light, 11 bits fine. One sample has the 8 bits of [`Self::display`].
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0 to 65535")]
    pub fn display16(&self, renderer: &Renderer) -> Result<([u32; 2], Vec<[u16; 3]>), RenderError> {
        let size = self.targets.size();
        let Some(means) = &self.targets.means else {
            let bytes = readback::texture(&renderer.gpu, &self.targets.display[0])?;
            let wide = |byte: u8| u16::from(byte) * 257;
            return Ok((size, bytes.chunks_exact(4).map(|p| [wide(p[0]), wide(p[1]), wide(p[2])]).collect()));
        };
        let shown = readback::rgba(&renderer.gpu, &means[self.samples.side()].shown)?;
        let encoded = |light: f32| {
            let light = light.clamp(0.0, 1.0);
            // IEC 61966-2-1.
            let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
            (value * 65_535.0 + 0.5) as u16
        };
        Ok((size, shown.iter().map(|[red, green, blue, _]| [encoded(*red), encoded(*green), encoded(*blue)]).collect()))
    }

    /// What the passes took together, in milliseconds; `None` where a pass could not be timed, or before the end.
    pub fn total_ms(&self) -> Option<f64> {
        let all = self.times.iter().map(|time| time.millis);
        if self.jobs.is_empty() { all.sum() } else { None }
    }

    /// Where [`Self::total_ms`] comes from.
    pub fn source(&self) -> TimingSource {
        self.source
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.targets.bytes()
    }

    /// The finished light, read back; a march has no variance.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn picture(&self, renderer: &Renderer) -> Result<TruthPicture, RenderError> {
        read_back(&self.targets, renderer, (self.samples.side(), self.candela_per_unit))
    }
}

/// Linear light and clouds of finished targets.
pub(super) fn read_back(
    targets: &Targets,
    renderer: &Renderer,
    (side, candela_per_unit): (usize, f32),
) -> Result<TruthPicture, RenderError> {
    let gpu = &renderer.gpu;
    let rgba = match targets.linear(side) {
        Some(linear) => readback::rgba(gpu, linear)?,
        None => Vec::new(),
    };
    let clouds = match &targets.marched {
        Some(cloud) => readback::rgba(gpu, &cloud.light)?,
        None => vec![[0.0, 0.0, 0.0, 1.0]; rgba.len()],
    };
    let distance_m = match targets.marched.as_ref().and_then(|cloud| cloud.distance.as_ref()) {
        Some(distance) => readback::scalars(gpu, distance)?,
        None => vec![0.0; rgba.len()],
    };
    let image = LinearImage { size: targets.size(), rgba, distance_m, candela_per_unit };
    Ok(TruthPicture { image, clouds, variance: Vec::new() })
}
