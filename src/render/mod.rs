//! Turns a [`Frame`] into a picture.
//!
//! [`Renderer`] owns everything on the device. A frame is scheduled as a list of jobs by one straight function,
//! `schedule`; then it is run at once ([`Renderer::render`]) or in slices beside a window ([`Renderer::begin`] and
//! [`Renderer::advance`]).

mod automaton;
mod bakes;
mod blue_noise;
mod clearance;
mod context;
mod flow;
mod grown;
mod interactive;
mod layers;
pub mod map_view;
pub mod meter;
mod output;
mod paint;
pub mod pass;
mod passes;
pub mod probe;
mod samples;
mod schedule;
pub mod shaders;
mod still;
mod sun_grid;
pub mod tables;
mod targets;
pub mod truth;
pub mod uniforms;
mod voxels;
pub mod watch;
mod weather;

use std::collections::VecDeque;
use std::time::Instant;

use crate::gpu::{Gpu, GpuError, Job, PassTime, ProgramCache, ProgramKey, Texture, TimingSource, job};
use crate::plan::{Forced, FramePlan, HistoryKey, SkyPlan};
use crate::scene::Frame;

use automaton::Living;
use bakes::Bakes;
use clearance::Clearance;
use context::Pace;
use pass::sky::{SkyParts, SkyTables};
use sun_grid::SunGrid;
use targets::Targets;
use uniforms::Eye;
use voxels::Voxels;
use weather::WeatherMap;

pub use layers::Layers;
pub use meter::LightHistogram;
pub use output::{Counts, LinearImage};
pub use still::{Proceed, Still};

/// Every program that a frame of this plan may ask for, bakes and the clear sky included.
pub fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    let parts = |sky: SkyPlan| SkyParts { air: sky.air, light: sky.light, moonlit: sky.moonlit };
    let sky = plan.sky.map_or_else(Vec::new, |sky| pass::sky::programs(parts(sky)));
    sky.into_iter()
        .chain(bakes::programs(plan))
        .chain(voxels::programs(plan))
        .chain(automaton::programs(plan))
        .chain(paint::programs(plan))
        .chain(clearance::programs(plan))
        .chain(sun_grid::programs(plan))
        .chain(passes::programs(plan, true))
        .collect()
}

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The device or a shader failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The voxels that the scene names cannot be used.
    #[error("layers.{layer}.grid: {message}")]
    Grid {
        /// Index of the cloud layer.
        layer: usize,
        /// What is wrong and what to do.
        message: String,
    },
    /// An image that the scene names cannot be used.
    #[error("weather.layers.{layer}.image: {message}")]
    Map {
        /// Index of the map layer.
        layer: usize,
        /// What is wrong and what to do.
        message: String,
    },
}

/// What one finished frame did and what it cost.
#[derive(Clone, Debug)]
pub struct FrameReport {
    /// What ran, and why.
    pub plan: FramePlan,
    /// Time of each pass, in order.
    pub passes: Vec<PassTime>,
    /// Where the times come from.
    pub source: TimingSource,
    /// Time from the first job to the last, in milliseconds.
    pub total_ms: f64,
}

/// How far a frame begun with [`Renderer::begin`] has come.
#[derive(Debug)]
pub enum Progress {
    /// Nothing is under way.
    Idle,
    /// Its shaders are being compiled on another thread; the last picture stays. Begin it again in a moment.
    Compiling,
    /// Some of its work is done or under way.
    Working,
    /// It has just been finished; [`Renderer::display`] shows it.
    Finished(Box<FrameReport>),
}

/// The picture that the next one may take over from.
#[derive(Clone, Debug)]
struct History {
    key: HistoryKey,
    eye: Eye,
    time_secs: f64,
    /// Which phase of the update pattern it computed.
    phase: u32,
    /// Which of the two history targets holds it.
    side: usize,
}

/// A frame that was scheduled and is not finished.
#[derive(Debug)]
struct Pending {
    plan: FramePlan,
    history: Option<History>,
    display: Texture,
    started: Instant,
    times: Vec<PassTime>,
}

/// Owns everything on the device.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    programs: ProgramCache,
    pace: Pace,
    /// Tables of the sky, unless the light is plain.
    sky: Option<SkyTables>,
    bakes: Bakes,
    weather: WeatherMap,
    clearance: Clearance,
    sun_grid: SunGrid,
    map_view: map_view::MapView,
    voxels: Voxels,
    living: Living,
    targets: Option<Targets>,
    history: Option<History>,
    /// The last finished picture.
    shown: Option<Texture>,
    /// Which display target the next picture goes to.
    display_side: usize,
    /// Shift of the march's jitter, in turns of the golden ratio.
    jitter_seed: u32,
    candela_per_unit: f32,
    /// Interactive work: jobs to do, the slice under way, and the frame they belong to.
    queue: VecDeque<Job>,
    /// How many jobs at the front of the queue make bakes, which must not be dropped.
    bake_jobs: usize,
    slice: Option<interactive::Slice>,
    pending: Option<Pending>,
    is_compiling: bool,
    last_plan: Option<FramePlan>,
    /// What runs, or does not, whatever a scene calls for.
    forced: Forced,
}

impl Renderer {
    /// A renderer without a picture.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device cannot hold the sky tables.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        Ok(Self {
            gpu: gpu.clone(),
            programs: ProgramCache::new(gpu, shaders::TABLE),
            pace: Pace::default(),
            sky: None,
            bakes: Bakes::new(gpu)?,
            weather: WeatherMap::new(),
            clearance: Clearance::default(),
            sun_grid: SunGrid::default(),
            map_view: map_view::MapView::default(),
            voxels: Voxels::default(),
            living: Living::default(),
            targets: None,
            history: None,
            shown: None,
            display_side: 0,
            jitter_seed: 0,
            candela_per_unit: 1.0,
            queue: VecDeque::new(),
            bake_jobs: 0,
            slice: None,
            pending: None,
            is_compiling: false,
            last_plan: None,
            forced: Forced::default(),
        })
    }

    /// The device it renders on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Renders the frame whole and waits for it.
    ///
    /// # Errors
    /// [`RenderError`] if the device fails or an image of the weather map cannot be used.
    pub fn render(&mut self, frame: &Frame<'_>) -> Result<FrameReport, RenderError> {
        self.render_as_planned(frame, FramePlan::forced(frame, self.forced))
    }

    /// Renders the frame by a plan of one's own, to see what another one changes.
    ///
    /// # Errors
    /// As for [`Self::render`].
    pub fn render_as_planned(&mut self, frame: &Frame<'_>, plan: FramePlan) -> Result<FrameReport, RenderError> {
        self.finish_interactive()?;
        // Long jobs are cut so that no driver's watchdog ends them; software drivers have none.
        let slice_ms = if self.gpu.is_software() { None } else { Some(200.0) };
        let (jobs, _) = self.schedule(frame, plan, slice_ms, None)?;
        let started = Instant::now();
        let times = job::run(&self.gpu, &jobs)?;
        if let Some(pending) = &mut self.pending {
            pending.started = started;
            pending.times = times;
        }
        let mut report = self.complete().unwrap_or_else(|| unreachable!("schedule leaves a pending frame"));
        report.source = TimingSource::of(&self.gpu);
        Ok(report)
    }

    /// Makes the pending frame the last finished one.
    fn complete(&mut self) -> Option<FrameReport> {
        let pending = self.pending.take()?;
        self.history = pending.history;
        self.shown = Some(pending.display);
        self.display_side = 1 - self.display_side;
        self.last_plan = Some(pending.plan.clone());
        Some(FrameReport {
            plan: pending.plan,
            passes: pending.times,
            source: TimingSource::SerialisedHost,
            total_ms: pending.started.elapsed().as_secs_f64() * 1e3,
        })
    }

    /// Gives the frames from now on another jitter of the march, to tell its noise from its bias; 0 is the usual one.
    pub fn set_jitter_seed(&mut self, seed: u32) {
        self.jitter_seed = seed;
    }

    /// Forces effects on or off from now on, to see what they change and cost.
    pub fn force(&mut self, forced: Forced) {
        if forced != self.forced {
            self.forced = forced;
            self.history = None;
            // A moving picture would keep one that is a little behind.
            self.sun_grid.clear();
        }
    }

    /// What is forced.
    pub fn forced(&self) -> Forced {
        self.forced
    }

    /// Lets go of everything on the device but programs, as after an error that left it half made.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn forget_everything(&mut self) -> Result<(), RenderError> {
        self.finish_interactive()?;
        (self.sky, self.targets, self.history, self.shown, self.last_plan) = (None, None, None, None, None);
        self.bakes = Bakes::new(&self.gpu)?;
        (self.weather, self.clearance) = (WeatherMap::new(), Clearance::default());
        self.sun_grid.clear();
        (self.voxels, self.living) = (Voxels::default(), Living::default());
        Ok(())
    }

    /// Forgets the picture before, as after a cut.
    pub fn forget_history(&mut self) {
        self.history = None;
    }

    /// The last finished picture: `Rgba8Unorm`, display-encoded. `None` before the first.
    pub fn display(&self) -> Option<&Texture> {
        self.shown.as_ref()
    }

    /// Device memory held by textures, in bytes.
    pub fn memory_bytes(&self) -> u64 {
        let targets = self.targets.as_ref().map_or(0, Targets::bytes);
        self.bakes.bytes()
            + self.weather.bytes()
            + self.clearance.bytes()
            + self.sun_grid.bytes()
            + self.map_view.bytes()
            + self.voxels.bytes()
            + self.living.bytes()
            + self.sky.as_ref().map_or(0, SkyTables::bytes)
            + targets
    }
}
