//! Pictures that converge: the same frame by a reference integrator, refined until it is good enough.
//!
//! A [`Truth`] holds what is kept between dispatches and works in slices, each bounded in time: [`Truth::advance`] takes
//! as many as fit a budget, [`Truth::picture`] shows how far it is. It has targets and buffers of its own, so that the
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
use super::still::{Apart, read_back};
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
    /// Share of the work of the present level or of all samples, 0 to 1.
    pub share: f32,
    /// Level of the ladder, or samples of each pixel, that are finished; `None` before the first.
    pub finished: Option<u32>,
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
    /// Sky, ground and shadows, still to be made.
    prepare: VecDeque<Job>,
    /// From the buffers to the finished picture.
    finish: Vec<Job>,
    variance: Option<Texture>,
    progress: Convergence,
    /// The finished picture of the level before.
    before: Option<Vec<[f32; 4]>>,
}

impl Renderer {
    /// Starts a frame that converges. Its output should be one for a file: half floats hide small differences.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn begin_truth(&mut self, frame: &Frame<'_>, goal: Goal) -> Result<Truth, RenderError> {
        let integrator = goal.integrator();
        let plan = FramePlan::for_truth(frame, integrator);
        let Apart { targets, buffers, candela_per_unit } = self.begin_apart(frame, &plan)?;
        let context = self.context_apart();
        let shared = self.shared_resources();
        let mut passes =
            Passes { context: &context, plan: &plan, targets: &targets, shared, buffers: &buffers, jobs: Vec::new() };
        passes.cloud_shadow()?;
        passes.background()?;
        let prepare = std::mem::take(&mut passes.jobs).into();
        let cloud = targets.marched.as_ref().map(|marched| &marched.light);
        passes.sunshafts(cloud)?;
        passes.finish(cloud, &targets.display[0])?;
        let after = std::mem::take(&mut passes.jobs);
        let mut truth = Truth {
            integrator,
            goal,
            candela_per_unit,
            tiles: None,
            prepare,
            finish: Vec::new(),
            variance: None,
            progress: Convergence {
                is_done: plan.march.is_none(),
                share: 0.0,
                finished: None,
                error: None,
                counts: TruthCounts::default(),
                spent_secs: 0.0,
            },
            before: None,
            plan,
            targets,
        };
        if let Some(march) = truth.plan.march {
            let inputs = uniforms::sky_inputs(frame.scene, &Lighting::new(frame.scene));
            self.add_clouds(&mut truth, march, &buffers, &inputs)?;
        }
        truth.finish.extend(after);
        Ok(truth)
    }

    /// The part of a truth that finds clouds: its tiles, and the jobs that resolve them.
    fn add_clouds(
        &self,
        truth: &mut Truth,
        march: MarchVariant,
        buffers: &FrameBuffers,
        sky: &SkyInputs,
    ) -> Result<(), RenderError> {
        let gpu = &self.gpu;
        let mut bound = self.shared_resources();
        bound.extend(buffers.resources());
        let mut seen = None;
        if truth.integrator == Integrator::PathTraced {
            let (view, air, job) = self.sky.seen_from(gpu, &self.programs, sky, sky.cloud_altitude_m)?;
            truth.prepare.push_back(job);
            truth.variance =
                Some(Texture::new_2d(gpu, "variance", truth.targets.size(), wgpu::TextureFormat::Rgba32Float)?);
            seen = Some((view, air));
        }
        if let Some((view, air)) = &seen {
            bound.push(("cloud_sky_view", view_of(view)));
            bound.push(("cloud_air", air.as_entire_binding()));
        }
        if let Some(distance) = &truth.targets.ground_distance {
            bound.push(("ground_distance", view_of(distance)));
        }
        let resolved = truth.targets.marched.as_ref().map(|cloud| (&cloud.light, &cloud.distance));
        let mut outputs = vec![("background", view_of(&truth.targets.background))];
        if let Some((light, distance)) = resolved {
            outputs.extend([("cloud_out", view_of(light)), ("distance_out", view_of(distance))]);
        }
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
        };
        let (tiles, resolve) = Tiles::new(&stage, truth.goal, march)?;
        truth.tiles = Some(tiles);
        truth.finish.extend(resolve);
        Ok(())
    }
}

/// The program of an integrator.
fn program(integrator: Integrator, march: MarchVariant) -> ProgramKey {
    let flags = march.flags().filter(|flag| !matches!(*flag, "FLOAT" | "SKIP"));
    if integrator == Integrator::PathTraced {
        field_key("pass/path_trace.wgsl", march).with_flags(flags).with_flags(["EARTH"])
    } else {
        field_key("pass/converged.wgsl", march).with_flags(flags).with_constant("OCTAVES", march.octaves)
    }
}

fn resolve_program(integrator: Integrator, march: MarchVariant) -> ProgramKey {
    ProgramKey::plain("pass/truth_resolve.wgsl")
        .with_flags(march.float.then_some("FLOAT"))
        .with_flags((integrator == Integrator::PathTraced).then_some("PATHS"))
}

/// Every program that the truths of this plan ask for beyond those of the plan itself.
pub fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    [Integrator::Converged, Integrator::PathTraced].into_iter().flat_map(|which| programs_of(plan, which)).collect()
}

/// The same for one integrator; none for the march itself.
pub(super) fn programs_of(plan: &FramePlan, integrator: Integrator) -> Vec<ProgramKey> {
    let march = plan.march.filter(|_| integrator != Integrator::Realtime);
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
        while let Some(next) = self.prepare.pop_front() {
            job::submit(gpu, &[next]);
            gpu.wait()?;
            if started.elapsed() >= budget {
                self.progress.spent_secs += started.elapsed().as_secs_f64();
                return Ok(self.progress);
            }
        }
        while !self.progress.is_done && started.elapsed() < budget {
            let Some(tiles) = &mut self.tiles else { break };
            let is_complete = tiles.run_slice(gpu, slice)?;
            self.progress.counts = tiles.counts();
            self.progress.share = tiles.share();
            if is_complete {
                self.complete_level(renderer)?;
            }
        }
        self.progress.spent_secs += started.elapsed().as_secs_f64();
        Ok(self.progress)
    }

    /// Takes stock after a level or a batch of samples, and starts the next.
    fn complete_level(&mut self, renderer: &Renderer) -> Result<(), RenderError> {
        let Some(tiles) = &mut self.tiles else { return Ok(()) };
        self.progress.finished = Some(tiles.finished());
        job::submit(&renderer.gpu, &self.finish);
        let Some(cloud) = &self.targets.marched else { return Ok(()) };
        let clouds = readback::rgba(&renderer.gpu, &cloud.light)?;
        let background = readback::rgba(&renderer.gpu, &self.targets.background)?;
        let composed = composed(&clouds, &background);
        match self.goal {
            Goal::Converged { tolerance, .. } => {
                let moved = self.before.as_ref().map(|before| change(before, &composed));
                // Steps of half the length leave a quarter of the error, so a third of the change is left; the whole
                // change is the cautious estimate.
                self.progress.error = moved;
                self.progress.is_done =
                    moved.is_some_and(|moved| moved <= tolerance) || !tiles.next_level(&renderer.gpu);
            }
            Goal::PathTraced { tolerance, .. } => {
                if let Some(variance) = &self.variance {
                    let variance = readback::rgba(&renderer.gpu, variance)?;
                    self.progress.error = Some(settings::standard_error(&composed, &variance));
                }
                let is_good = self.progress.finished >= Some(LEAST_SAMPLES)
                    && self.progress.error.is_some_and(|error| error <= tolerance);
                self.progress.is_done = is_good || !tiles.next_level(&renderer.gpu);
            }
        }
        self.before = Some(composed);
        self.progress.share = if self.progress.is_done { 1.0 } else { 0.0 };
        Ok(())
    }

    /// The finished light of what was found so far, read back.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn picture(&mut self, renderer: &Renderer) -> Result<TruthPicture, RenderError> {
        let gpu = &renderer.gpu;
        job::submit(gpu, self.prepare.make_contiguous());
        self.prepare.clear();
        job::submit(gpu, &self.finish);
        self.finished_picture(renderer)
    }

    /// The light of the last finished level or batch of samples, read back, whatever was begun since.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn finished_picture(&self, renderer: &Renderer) -> Result<TruthPicture, RenderError> {
        let picture = read_back(&self.targets, renderer, self.candela_per_unit)?;
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
        self.before.as_ref().filter(|_| self.progress.is_done || !is_coarse).map(|_| &self.targets.display[0])
    }

    /// The picture as it is shown, after [`Self::picture`] or a finished level: size, then red, green, blue and 255.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn display_rgba8(&self, renderer: &Renderer) -> Result<([u32; 2], Vec<u8>), RenderError> {
        let display = &self.targets.display[0];
        Ok((display.size(), readback::texture(&renderer.gpu, display)?))
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
