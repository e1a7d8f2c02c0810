//! Keeps the picture going: begins frames, sends their work in slices, and knows when there is nothing left to do.

use std::time::{Duration, Instant};

use glam::DVec2;

use super::document::Document;
use super::lab::Governor;
use super::statistics::Statistics;
use super::truth::{CompareJob, Outcome, Truths, Wishes};
use super::whole::{WholeCloud, whole_cloud};
use crate::gpu::{Gpu, Texture};
use crate::plan::{Forced, FramePlan, Integrator};
use crate::render::probe::Probe;
use crate::render::{LightHistogram, Progress, RenderError, Renderer};
use crate::scene::{DomainKind, Frame, MapEdge, Output, Projection, Quality, Scene, UpdateFraction, Window};
use crate::ui::{LabState, Picked, Readout};

/// Work sent to the device at a time. The panels' frame comes after at most one of these.
const SLICE: Duration = Duration::from_millis(30);
/// A picture whose inputs have changed may go on for this long: a slow one is begun anew instead.
const PATIENCE: Duration = Duration::from_millis(400);
/// How often a frame that waits for its shaders is begun anew.
const COMPILE_POLL: Duration = Duration::from_millis(60);
/// Inputs that have kept still for this long count as settled; during a drag pictures are finished, late as they are.
const SETTLED: Duration = Duration::from_millis(150);

/// Everything a picture depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Inputs {
    pub(super) scene: Scene,
    pub(super) quality: Quality,
    pub(super) size: [u32; 2],
    pub(super) time_secs: f64,
    pub(super) forced: Forced,
    /// The part of the picture that is drawn.
    pub(super) window: Option<Window>,
}

impl Inputs {
    fn frame(&self) -> Frame<'_> {
        let Self { scene, quality, size, time_secs, window, .. } = self;
        Frame { scene, quality, size: *size, time_secs: *time_secs, output: Output::Display, window: *window }
    }
}

/// Pictures after which their values are looked at again; that takes a read of each texel.
const PICTURES_UNWATCHED: u32 = 64;

/// What a step of the viewport led to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Nothing is left to do.
    Idle,
    /// Work is under way or waits for the next step.
    Busy,
    /// A new picture is there.
    Finished,
}

/// The renderer, and what it is busy with.
#[derive(Debug)]
pub(super) struct Viewport {
    renderer: Renderer,
    /// What the frame under way, or else the last, was begun with.
    begun: Option<Inputs>,
    /// When the frame under way was begun.
    since: Option<Instant>,
    /// The inputs of the last step, and since when they have been the same.
    seen: Option<(Inputs, Instant)>,
    /// Pictures until the update cycle has visited every pixel since the last change.
    left: u32,
    /// Inputs that the renderer refused; not tried again until they change.
    refused: Option<Inputs>,
    compiling: bool,
    pub(super) statistics: Statistics,
    pub(super) truths: Truths,
    /// Whether what the truths were made from has changed since it was last asked.
    has_moved_on: bool,
    governor: Governor,
    /// Pictures since values were looked at last.
    unwatched: u32,
    /// What was found that is no light, until somebody takes it.
    broken: Option<String>,
    /// Frame time that the governor holds, in milliseconds, while it is on.
    budget_ms: Option<f64>,
}

/// A region, left, top, right and bottom as shares of a picture, in whole pixels: offset and size.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "pixels of a picture")]
pub(super) fn pixels_of(region: [f32; 4], size: [u32; 2]) -> [[u32; 2]; 2] {
    let edge = |share: f32, side: u32| (f64::from(share.clamp(0.0, 1.0)) * f64::from(side)).round() as u32;
    let offset = [0, 1].map(|axis| edge(region[axis], size[axis]).min(size[axis].saturating_sub(1)));
    let part = [0, 1].map(|axis| edge(region[axis + 2], size[axis]).saturating_sub(offset[axis]).max(1));
    [offset, part]
}

/// The angle that a pixel spans in the middle of a picture so many pixels high, in degrees.
fn pixel_deg(scene: &Scene, height_px: u32) -> f32 {
    let height = height_px.max(1) as f32;
    match scene.camera.projection {
        Projection::Perspective => {
            (2.0 * scene.camera.half_tangents([height_px.max(1); 2])[1] / height).atan().to_degrees()
        }
        Projection::Equirect => 180.0 / height,
        Projection::Dome => 90.0 / height,
    }
}

/// Height above the sea of a place whose height over the plane below the eye is known, so far from the eye's vertical.
#[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
fn altitude(scene: &Scene, up_m: f32, away_m: f32) -> f32 {
    if scene.domain.kind != DomainKind::Shell {
        return up_m;
    }
    let radius = f64::from(scene.domain.planet_radius_m);
    ((radius + f64::from(up_m)).hypot(f64::from(away_m)) - radius) as f32
}

impl Viewport {
    /// A viewport without a picture.
    pub(super) fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        Ok(Self {
            renderer: Renderer::new(gpu)?,
            begun: None,
            since: None,
            seen: None,
            left: 0,
            refused: None,
            compiling: false,
            statistics: Statistics::default(),
            truths: Truths::new(),
            has_moved_on: false,
            governor: Governor::default(),
            unwatched: 0,
            broken: None,
            budget_ms: None,
        })
    }

    /// The renderer.
    pub(super) fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Follows what the lab says of the governor; returns what the governor says of itself.
    pub(super) fn govern(&mut self, lab: &LabState) -> Option<String> {
        self.governor.follow(&lab.view);
        self.budget_ms = lab.governs.then_some(lab.frame_budget_ms);
        self.budget_ms.and_then(|_| self.governor.said())
    }

    /// The direction that a point of the picture shows; `None` before there is any.
    pub(super) fn towards(&self, at: [f32; 2]) -> Option<glam::Vec3> {
        let inputs = self.begun.as_ref()?;
        let (offset, share) = inputs.frame().window_shares();
        #[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
        let in_whole = [0, 1].map(|axis| (offset[axis] + share[axis] * f64::from(at[axis])) as f32);
        Some(inputs.scene.camera.direction_through(in_whole, inputs.frame().whole_size()))
    }

    /// What one point of the picture is, in numbers; the point is 0 to 1 from the top left. `None` while shaders are compiled.
    pub(super) fn pick(&mut self, at: [f32; 2]) -> Result<Option<Picked>, RenderError> {
        let (Some(inputs), Some(towards)) = (&self.begun, self.towards(at)) else { return Ok(None) };
        let mut scene = inputs.scene.clone();
        let whole = inputs.frame().whole_size();
        let eye = [scene.camera.east_m, scene.camera.height_m, scene.camera.south_m];
        let up = if towards.y.abs() > 0.99 { glam::Vec3::X } else { glam::Vec3::Y };
        scene.camera.look(towards, up);
        scene.camera.projection = Projection::Perspective;
        scene.camera.field_of_view_deg = pixel_deg(&inputs.scene, whole[1]);
        // A point has no neighbours that could throw streaks on it.
        scene.sunshafts.strength = 0.0;
        let own = inputs.quality.clone();
        let quality = Quality { update: UpdateFraction::Full, pixel_samples: 1, resolution_scale: 1.0, ..own };
        let point = Frame {
            scene: &scene,
            quality: &quality,
            size: [1, 1],
            time_secs: inputs.time_secs,
            output: Output::Linear,
            window: None,
        };
        if !self.renderer.still_is_ready(&point, Integrator::Realtime, 1)? {
            return Ok(None);
        }
        self.begin_anew();
        let mut still = self.renderer.begin_still(&point, 1)?;
        still.advance(&self.renderer, Duration::MAX)?;
        let picture = still.picture(&self.renderer)?;
        let scale = picture.image.candela_per_unit;
        let light = picture.image.rgba.first().map_or([0.0; 3], |[r, g, b, _]| [r * scale, g * scale, b * scale]);
        let distance_m = picture.image.distance_m.first().copied().filter(|distance| *distance > 0.0);
        let mut probe = None;
        if let Some(far) = distance_m {
            let place = [far * towards.x, eye[1] + far * towards.y, far * towards.z];
            let Some(found) = self.renderer.probe(&point, place)? else { return Ok(None) };
            // As the panel numbers them.
            let mut densities = [0.0; 4];
            for ((index, _), density) in scene.numbered_layers().zip(found.densities) {
                densities[index] = density;
            }
            probe = Some(Probe { densities, ..found });
        }
        Ok(Some(Picked {
            at,
            direction_deg: [
                towards.y.clamp(-1.0, 1.0).asin().to_degrees(),
                towards.x.atan2(-towards.z).to_degrees().rem_euclid(360.0),
            ],
            light,
            display: None,
            transmittance: picture.clouds.first().map_or(1.0, |cloud| cloud[3]),
            distance_m,
            probe,
            position_m: distance_m.map(|far| {
                let [east, up, south] = std::array::from_fn(|axis| eye[axis] + far * towards[axis]);
                [east, altitude(&scene, up, far * towards.x.hypot(towards.z)), south]
            }),
        }))
    }

    /// Begins a frame if one is due, and sends the next slice of work. Of a picture of that size only the region is drawn, if
    /// there is one.
    pub(super) fn step(
        &mut self,
        document: &Document,
        (size, region): ([u32; 2], Option<[f32; 4]>),
        forced: Forced,
    ) -> Result<Step, RenderError> {
        let (window, size) = match region {
            Some(region) => {
                let [offset, part] = pixels_of(region, size);
                (Some(Window { offset, whole: size }), part)
            }
            None => (None, size),
        };
        let own = Inputs {
            scene: document.preset().scene.clone(),
            quality: document.quality().clone(),
            size,
            time_secs: document.time_secs(),
            forced,
            window,
        };
        // What is shown at rest and what is compared has the document's own quality.
        self.has_moved_on |= self.truths.follow(&own, Instant::now());
        let inputs = match self.budget_ms {
            Some(_) => Inputs { quality: self.governor.quality(&own.quality), ..own },
            None => own,
        };
        if self.refused.as_ref() == Some(&inputs) {
            return Ok(Step::Idle);
        }
        let outcome = self.step_with(&inputs);
        if outcome.is_err() {
            self.refused = Some(inputs);
            self.since = None;
            self.left = 0;
        }
        outcome
    }

    fn step_with(&mut self, inputs: &Inputs) -> Result<Step, RenderError> {
        let kept_still = match &self.seen {
            Some((seen, since)) if seen == inputs => since.elapsed(),
            _ => {
                self.seen = Some((inputs.clone(), Instant::now()));
                Duration::ZERO
            }
        };
        let changed = self.begun.as_ref() != Some(inputs);
        if changed {
            self.left = pictures_per_cycle(inputs.quality.update);
        }
        let due = match self.since {
            None => self.left > 0,
            Some(since) => changed && since.elapsed() > PATIENCE && kept_still > SETTLED,
        };
        if due {
            self.renderer.force(inputs.forced);
            self.renderer.begin(&inputs.frame())?;
            self.begun = Some(inputs.clone());
            self.since = Some(Instant::now());
        }
        if self.since.is_none() {
            return Ok(Step::Idle);
        }
        match self.renderer.advance(SLICE)? {
            Progress::Idle => {
                self.since = None;
                self.left = 0;
                Ok(Step::Idle)
            }
            Progress::Compiling => {
                self.compiling = true;
                // Whoever waits for a shader begins again: it may be there, and the inputs may be others.
                if self.since.is_some_and(|since| since.elapsed() > COMPILE_POLL) {
                    self.since = None;
                    self.left = self.left.max(1);
                }
                Ok(Step::Busy)
            }
            Progress::Working => {
                self.compiling = false;
                Ok(Step::Busy)
            }
            Progress::Finished(report) => {
                self.compiling = false;
                self.since = None;
                // A picture drawn as the one before was planned, while its own shaders compile, does not count.
                let planned = report.plan == FramePlan::forced(&inputs.frame(), inputs.forced);
                self.left = if planned { self.left.saturating_sub(1) } else { self.left.max(1) };
                self.refused = None;
                if let Some(budget_ms) = self.budget_ms.filter(|_| planned) {
                    self.governor.frame(report.total_ms, budget_ms);
                }
                self.statistics.add(*report);
                self.watch()?;
                Ok(Step::Finished)
            }
        }
    }

    /// Looks for values that are not finite, now and then.
    fn watch(&mut self) -> Result<(), RenderError> {
        self.unwatched += 1;
        if self.unwatched >= PICTURES_UNWATCHED {
            self.unwatched = 0;
            let first = self.renderer.find_broken()?.into_iter().next();
            self.broken = first.map(|broken| format!("{broken}; `nephoscope verify` says whether it is the driver"));
        }
        Ok(())
    }

    /// How much of the last picture has which luminance; `None` while there is none, or another is under way.
    pub(super) fn light_histogram(&mut self) -> Result<Option<LightHistogram>, RenderError> {
        self.renderer.light_histogram()
    }

    /// The weather map from above; a frame behind while pictures are under way.
    pub(super) fn map_view(&mut self) -> Result<Option<&Texture>, RenderError> {
        let Some(inputs) = &self.begun else { return Ok(None) };
        self.renderer.map_view(&inputs.frame())
    }

    /// The cloud at a place on a scene's weather map, as a layer of all reads it.
    pub(super) fn whole_cloud(
        &mut self,
        (scene, time_secs): (&Scene, f64),
        layer: usize,
        at: DVec2,
    ) -> Result<Option<WholeCloud>, RenderError> {
        let quality = Quality::default();
        let frame = Frame { scene, quality: &quality, size: [1, 1], time_secs, output: Output::Linear, window: None };
        self.begin_anew();
        let bodies = self.renderer.map_bodies(&frame, layer)?;
        Ok(bodies.and_then(|bodies| whole_cloud(&bodies, at, scene.weather.edge == MapEdge::Repeat)))
    }

    /// What is rendered beside the picture ends one that is under way: it has to be begun again.
    fn begin_anew(&mut self) {
        if self.since.take().is_some() {
            self.left = self.left.max(1);
        }
    }

    /// Lets go of it.
    pub(super) fn close_map(&mut self) {
        self.renderer.close_map_view();
    }

    /// What was found broken since this was asked before.
    pub(super) fn take_broken(&mut self) -> Option<String> {
        self.broken.take()
    }

    /// Lets the truths take a turn, after a step that left nothing to do.
    pub(super) fn refine(&mut self, wishes: Wishes) -> Result<Outcome, RenderError> {
        if self.left > 0 || self.refused.is_some() || self.renderer.display().is_none() {
            return Ok(Outcome::default());
        }
        self.truths.turn(&mut self.renderer, wishes)
    }

    /// The next pictures to compare, if there are new ones.
    pub(super) fn comparison(&mut self) -> Result<Option<CompareJob>, RenderError> {
        self.truths.comparison(&self.renderer)
    }

    /// Whether the picture depends on something else than when this was asked before.
    pub(super) fn has_moved_on(&mut self) -> bool {
        std::mem::take(&mut self.has_moved_on)
    }

    /// Whether shaders are being compiled.
    pub(super) fn is_compiling(&self) -> bool {
        self.compiling
    }

    /// What the overlay shows.
    pub(super) fn readout(&self) -> Readout {
        Readout {
            adapter: self.renderer.gpu().description(),
            size: self.renderer.display().map(Texture::size).unwrap_or_default(),
            memory_bytes: self.renderer.memory_bytes() + self.truths.bytes(),
            ..self.statistics.readout()
        }
    }
}

/// Pictures after which every pixel has been computed at least once.
fn pictures_per_cycle(update: UpdateFraction) -> u32 {
    match update {
        UpdateFraction::Full => 1,
        UpdateFraction::Half => 2,
        UpdateFraction::Quarter => 4,
        UpdateFraction::Sixteenth => 16,
    }
}
