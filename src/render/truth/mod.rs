//! Pictures that converge: the same frame by a reference integrator, refined until it is good enough.
//!
//! A [`Truth`] holds what is kept between dispatches and works in slices, each bounded in time: [`Truth::advance`] takes
//! as many as fit a budget, [`Truth::display`] shows how far it is. It has targets and buffers of its own, so that the
//! frames beside it keep their history.
//!
//! [`Integrator::Converged`] goes up a ladder: each level has half the steps of the one before, and the change between
//! the last two says how much is left. [`Integrator::PathTraced`] adds samples, and the spread of each pixel's samples
//! says how far its mean may be off.

mod settings;
mod tile;

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::pass::sky::SkyInputs;
use super::passes::{FrameBuffers, Passes, field_key, view_of};
use super::samples::PixelSamples;
use super::still::{Apart, read_back};
use super::targets::CloudTarget;
use super::targets::Targets;
use super::uniforms;
use super::{LinearImage, RenderError, Renderer};
use crate::gpu::{Job, ProgramKey, Texture, job, readback};
use crate::plan::{FramePlan, Integrator, Lighting, MarchVariant};
use crate::scene::Frame;

use settings::change;
pub use settings::{Goal, Level};
use tile::{Stage, Tiles};

/// Paths of each pixel below which their spread says too little to stop by.
const LEAST_SAMPLES: u32 = 8;

/// Work done so far, counted in the shaders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TruthCounts {
    /// Steps along rays, or tracking events along paths.
    pub steps: u64,
    /// Steps towards the light; 0 for paths, whose events are all counted together.
    pub light_steps: u64,
    /// Places where the density exceeded its majorant. Anything but 0 is a fault of the bound.
    pub exceeded: u64,
    /// Rays or paths that were cut short. Anything but 0 is a fault.
    pub cut: u64,
}

/// How far a truth is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// Whether it has reached its goal, or cannot get nearer.
    pub is_done: bool,
    /// Share of the work of the present level, of a further sample of each pixel on the last one, or of all paths, 0 to 1.
    pub share: f32,
    /// Level of the ladder, or samples of each pixel, that are finished; `None` before the first.
    pub finished: Option<u32>,
    /// Samples of each pixel that are finished on the last level; 0 before the end of the ladder.
    pub pixel_samples: u32,
    /// Estimated relative error of the finished picture, root mean square over pixels with cloud; `None` before the
    /// first estimate.
    pub error: Option<f32>,
    /// Work so far.
    pub counts: TruthCounts,
    /// Time spent so far, in seconds.
    pub spent_secs: f64,
}

/// What a truth has found, read back.
#[derive(Clone, Debug)]
pub struct TruthPicture {
    /// The finished light, as [`Renderer::linear`] gives it for a march.
    pub image: LinearImage,
    /// Light and transmittance of the clouds alone.
    pub clouds: Vec<[f32; 4]>,
    /// Variance of the mean of each pixel's finished light, and of its opacity; empty for a march.
    pub variance: Vec<[f32; 4]>,
}

/// One frame on its way to the truth.
#[derive(Debug)]
pub struct Truth {
    integrator: Integrator,
    goal: Goal,
    plan: FramePlan,
    targets: Targets,
    candela_per_unit: f32,
    tiles: Option<Tiles>,
    samples: PixelSamples,
    /// Sky, ground and shadows, still to be made.
    prepare: VecDeque<Job>,
    /// What of it each sample of the pixels makes anew.
    each: Vec<Job>,
    /// From the buffers to the clouds' light, and from there to the finished picture, into either mean.
    resolve: Vec<Job>,
    finish: [Vec<Job>; 2],
    variance: Option<Texture>,
    progress: Convergence,
    has_picture: bool,
    /// The finished picture of the level before.
    before: Option<Vec<[f32; 4]>>,
}

impl Renderer {
    /// Starts a frame that converges, with so many samples of each pixel on the last level of its ladder. If it is to be
    /// measured, its output has to be one for a file: half floats hide small differences.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn begin_truth(&mut self, frame: &Frame<'_>, goal: Goal, pixel_samples: u32) -> Result<Truth, RenderError> {
        let integrator = goal.integrator();
        let plan = FramePlan::for_still(frame, (integrator, pixel_samples), self.forced);
        let Apart { targets, buffers, samples, candela_per_unit } = self.begin_apart(frame, &plan)?;
        let context = self.context_apart();
        let shared = self.shared_resources();
        let mut passes =
            Passes { context: &context, plan: &plan, targets: &targets, shared, buffers: &buffers, jobs: Vec::new() };
        passes.cloud_shadow()?;
        let mut prepare: VecDeque<Job> = std::mem::take(&mut passes.jobs).into();
        passes.background()?;
        let each = std::mem::take(&mut passes.jobs);
        prepare.extend(each.iter().cloned());
        let cloud = targets.marched.as_ref().map(|marched| &marched.light);
        passes.sunshafts(cloud)?;
        let resolve = std::mem::take(&mut passes.jobs);
        let finish = passes.finish_into_either(cloud)?;
        let mut truth = Truth {
            integrator,
            goal,
            candela_per_unit,
            tiles: None,
            samples,
            prepare,
            each,
            resolve,
            finish,
            variance: None,
            progress: Convergence {
                is_done: false,
                share: 0.0,
                finished: None,
                pixel_samples: 0,
                error: None,
                counts: TruthCounts::default(),
                spent_secs: 0.0,
            },
            has_picture: false,
            before: None,
            plan,
            targets,
        };
        if let Some(march) = truth.plan.march.filter(|_| truth.plan.has_clouds()) {
            let sky = truth.plan.sky.map(|sky| uniforms::sky_inputs(frame.scene, sky, &Lighting::new(frame.scene)));
            let rounds = if march.baked.is_some() { 1 } else { uniforms::density_rounds(frame.scene) };
            self.add_clouds(&mut truth, (march, rounds), &buffers, sky.as_ref())?;
        }
        Ok(truth)
    }

    /// The part of a truth that finds clouds: its tiles, and the jobs that resolve them. `rounds` are those of loops in one
    /// density.
    fn add_clouds(
        &self,
        truth: &mut Truth,
        (march, rounds): (MarchVariant, u32),
        buffers: &FrameBuffers,
        sky: Option<&SkyInputs>,
    ) -> Result<(), RenderError> {
        let gpu = &self.gpu;
        let mut bound = self.shared_resources();
        bound.extend(buffers.resources());
        let mut seen = None;
        if truth.integrator == Integrator::PathTraced {
            truth.variance =
                Some(Texture::new_2d(gpu, "variance", truth.targets.size(), wgpu::TextureFormat::Rgba32Float)?);
            if let (Some(tables), Some(sky)) = (&self.sky, sky) {
                let (view, air, job) = tables.seen_from(gpu, &self.programs, sky, sky.cloud_altitude_m)?;
                truth.prepare.push_back(job);
                seen = Some((view, air));
            }
        }
        if let Some((view, air)) = &seen {
            bound.push(("cloud_sky_view", view_of(view)));
            bound.push(("cloud_air", air.as_entire_binding()));
        }
        if let Some(distance) = &truth.targets.ground_distance {
            bound.push(("ground_distance", view_of(distance)));
        }
        let mut outputs = vec![("background", view_of(&truth.targets.background))];
        outputs.extend(truth.targets.marched.iter().flat_map(CloudTarget::outputs));
        if let Some(variance) = &truth.variance {
            outputs.push(("variance_out", view_of(variance)));
        }
        let stage = Stage {
            gpu,
            programs: &self.programs,
            key: program(truth.integrator, march),
            resolve: resolve_program(truth.integrator, march),
            bound,
            outputs,
            size: truth.targets.size(),
            rounds,
        };
        let (tiles, resolve) = Tiles::new(&stage, truth.goal, march)?;
        truth.tiles = Some(tiles);
        truth.resolve.splice(0..0, resolve);
        Ok(())
    }
}

/// The program of an integrator.
fn program(integrator: Integrator, march: MarchVariant) -> ProgramKey {
    let flags = march.flags().filter(|flag| !matches!(*flag, "FLOAT" | "SKIP" | "DISTANCE" | "SUN_GRID"));
    if integrator == Integrator::PathTraced {
        field_key("pass/path_trace.wgsl", march).with_flags(flags).with_flags((!march.plain).then_some("EARTH"))
    } else {
        field_key("pass/converged.wgsl", march).with_flags(flags).with_constant("OCTAVES", march.octaves)
    }
}

fn resolve_program(integrator: Integrator, march: MarchVariant) -> ProgramKey {
    ProgramKey::plain("pass/truth_resolve.wgsl")
        .with_flags(march.flags().filter(|flag| matches!(*flag, "FLOAT" | "DISTANCE")))
        .with_flags((integrator == Integrator::PathTraced).then_some("PATHS"))
}

/// Every program that the truths of this plan ask for beyond those of the plan itself.
pub fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    [Integrator::Converged, Integrator::PathTraced].into_iter().flat_map(|which| programs_of(plan, which)).collect()
}

/// The same for one integrator; none for the march itself.
pub(super) fn programs_of(plan: &FramePlan, integrator: Integrator) -> Vec<ProgramKey> {
    let march = plan.march.filter(|_| integrator != Integrator::Realtime && plan.has_clouds());
    march.map_or_else(Vec::new, |march| vec![program(integrator, march), resolve_program(integrator, march)])
}

impl Truth {
    /// Which integrator it uses.
    pub fn integrator(&self) -> Integrator {
        self.integrator
    }

    /// How far it is.
    pub fn progress(&self) -> Convergence {
        self.progress
    }

    /// Whether any level or batch of samples is finished.
    pub fn has_picture(&self) -> bool {
        self.has_picture
    }

    /// What runs for it, and why.
    pub fn plan(&self) -> &FramePlan {
        &self.plan
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        let variance = self.variance.as_ref().map_or(0, Texture::bytes);
        self.targets.bytes() + variance + self.tiles.as_ref().map_or(0, Tiles::bytes)
    }

    /// Works for about `budget` in slices of about `slice`, and waits for each.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn advance(
        &mut self,
        renderer: &Renderer,
        budget: Duration,
        slice: Duration,
    ) -> Result<Convergence, RenderError> {
        let started = Instant::now();
        let gpu = &renderer.gpu;
        while !self.progress.is_done && started.elapsed() < budget {
            if let Some(next) = self.prepare.pop_front() {
                job::submit(gpu, &[next]);
                gpu.wait()?;
                continue;
            }
            let is_complete = match &mut self.tiles {
                Some(tiles) => {
                    let is_complete = tiles.run_slice(gpu, slice)?;
                    self.progress.counts = tiles.counts();
                    self.progress.share = tiles.share();
                    is_complete
                }
                None => true,
            };
            if is_complete {
                self.complete(renderer)?;
            }
        }
        self.progress.spent_secs += started.elapsed().as_secs_f64();
        Ok(self.progress)
    }

    /// Takes stock after a level, a batch of paths or a further sample of each pixel, and starts the next.
    fn complete(&mut self, renderer: &Renderer) -> Result<(), RenderError> {
        let gpu = &renderer.gpu;
        job::submit(gpu, &self.resolve);
        job::submit(gpu, &self.finish[self.samples.side()]);
        self.has_picture = true;
        self.progress.share = 0.0;
        if self.progress.pixel_samples > 0 || self.has_reached_goal(renderer)? {
            self.before = None;
            self.progress.pixel_samples += 1;
            if self.samples.next(gpu) {
                self.prepare.extend(self.each.iter().cloned());
                self.tiles.iter_mut().for_each(|tiles| tiles.begin_again(gpu));
            } else {
                self.progress.is_done = true;
                self.progress.share = 1.0;
            }
        }
        Ok(())
    }

    /// Whether the level or batch just finished is good enough; if it is not, the next one is begun, unless it was the
    /// last.
    fn has_reached_goal(&mut self, renderer: &Renderer) -> Result<bool, RenderError> {
        let (Some(tiles), Some(cloud)) = (&mut self.tiles, &self.targets.marched) else { return Ok(true) };
        self.progress.finished = Some(tiles.finished());
        let clouds = readback::rgba(&renderer.gpu, &cloud.light)?;
        let background = readback::rgba(&renderer.gpu, &self.targets.background)?;
        let composed = composed(&clouds, &background);
        let is_good = match self.goal {
            Goal::Converged { tolerance, .. } => {
                let moved = self.before.as_ref().map(|before| change(before, &composed));
                // Steps of half the length leave a quarter of the error, so a third of the change is left; the whole
                // change is the cautious estimate.
                self.progress.error = moved;
                moved.is_some_and(|moved| moved <= tolerance)
            }
            Goal::PathTraced { tolerance, .. } => {
                if let Some(variance) = &self.variance {
                    let variance = readback::rgba(&renderer.gpu, variance)?;
                    self.progress.error = Some(settings::standard_error(&composed, &variance));
                }
                self.progress.finished >= Some(LEAST_SAMPLES)
                    && self.progress.error.is_some_and(|error| error <= tolerance)
            }
        };
        self.before = Some(composed);
        Ok(is_good || !tiles.next_level(&renderer.gpu))
    }

    /// The light of the last finished level or batch of samples, read back, whatever was begun since.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn picture(&self, renderer: &Renderer) -> Result<TruthPicture, RenderError> {
        let picture = read_back(&self.targets, renderer, (self.samples.side(), self.candela_per_unit))?;
        let variance = match &self.variance {
            Some(variance) => readback::rgba(&renderer.gpu, variance)?,
            None => Vec::new(),
        };
        Ok(TruthPicture { variance, ..picture })
    }

    /// The picture as it is shown, once a level or a batch of samples is finished that is worth it: `Rgba8Unorm`,
    /// display-encoded. The first two levels of a march show their steps as rings.
    pub fn display(&self) -> Option<&Texture> {
        let is_coarse = self.integrator == Integrator::Converged && self.progress.finished < Some(2);
        let is_worth_it = self.progress.pixel_samples > 0 || !is_coarse;
        (self.has_picture && is_worth_it).then_some(&self.targets.display[0])
    }

    /// The same, with everything else let go.
    pub fn into_display(self) -> Texture {
        let [display, _] = self.targets.display;
        display
    }
}

/// Clouds before their background, with the clouds' opacity.
fn composed(clouds: &[[f32; 4]], background: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let over = |(cloud, behind): (&[f32; 4], &[f32; 4])| {
        let light = |channel: usize| cloud[channel] + cloud[3] * behind[channel];
        [light(0), light(1), light(2), 1.0 - cloud[3]]
    };
    clouds.iter().zip(background).map(over).collect()
}
