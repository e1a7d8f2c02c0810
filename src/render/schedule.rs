//! One frame from top to bottom.

use std::time::Instant;

use glam::{UVec2, Vec2, Vec3};

use super::context::{Bound, Context};
use super::pass::sky::SkyTables;
use super::passes::{FrameBuffers, Passes};
use super::samples::jitter_shift;
use super::sun_grid::SunGrid;
use super::targets::{Targets, ray_count};
use super::uniforms::other::PlainUniforms;
use super::uniforms::scene::ViewUniforms;
use super::uniforms::{self, Eye};
use super::{History, Pending, RenderError, Renderer};
use crate::gpu::Job;
use crate::plan::{Effect, FramePlan, HistoryKey, Lighting};
use crate::scene::{Frame, Projection, direction};

/// Beyond this the picture before shows nothing of this one.
const CUT_DISTANCE_M: f64 = 1500.0;
/// The same as an angle, by its cosine.
const CUT_COSINE: f32 = 0.7;
/// The same for clouds that the wind has carried away.
const CUT_WIND_M: f64 = 400.0;

impl Renderer {
    /// The frame, top to bottom: bakes, cloud shadows, background, march, temporal, sunshafts, tonemap. Returns its jobs
    /// and how many of them make bakes, and leaves it pending.
    pub(super) fn schedule(
        &mut self,
        frame: &Frame<'_>,
        plan: FramePlan,
        slice_ms: Option<f64>,
        counters: Option<&wgpu::Buffer>,
    ) -> Result<(Vec<Job>, usize), RenderError> {
        let mut jobs = self.schedule_bakes(frame, &plan, slice_ms)?;
        let bake_jobs = jobs.len();
        match self.schedule_passes(frame, plan, slice_ms, counters) {
            Ok(passes) => {
                jobs.extend(passes);
                Ok((jobs, bake_jobs))
            }
            Err(error) => {
                self.keep_bakes(jobs);
                Err(error)
            }
        }
    }

    /// What was scheduled counts as made: jobs of a frame that comes to nothing are sent before those of the next.
    fn keep_bakes(&mut self, jobs: Vec<Job>) {
        self.bake_jobs += jobs.len();
        self.queue.extend(jobs);
    }

    /// The passes of a frame, whose bakes are scheduled.
    fn schedule_passes(
        &mut self,
        frame: &Frame<'_>,
        plan: FramePlan,
        slice_ms: Option<f64>,
        counters: Option<&wgpu::Buffer>,
    ) -> Result<Vec<Job>, RenderError> {
        let lighting = Lighting::new(frame.scene);
        let eye = Eye::new(&frame.scene.camera);
        let size = frame.render_size();
        let context = Context { gpu: &self.gpu, programs: &self.programs, pace: &self.pace, slice_ms };
        let (targets, is_new) = Targets::fitting(self.targets.take(), &self.gpu, &plan, size)?;
        let key = HistoryKey::new(frame);
        let usable = self.history.take().filter(|history| !is_new && is_continued(history, &key, frame, &eye));
        let phase = next_phase(usable.as_ref());
        let mut view = view_uniforms(frame, &plan, &eye, usable.as_ref(), &lighting);
        view.jitter.y = jitter_shift(self.jitter_seed);
        let buffers = frame_buffers(&context, frame, &plan, (&view, &self.sun_grid));
        let shared = self.shared_resources();
        let display = &targets.display[self.display_side];
        let mut passes =
            Passes { context: &context, plan: &plan, targets: &targets, shared, buffers: &buffers, jobs: Vec::new() };
        passes.cloud_shadow()?;
        passes.background()?;
        let marched = passes.march(counters)?;
        let mut cloud = marched.map(|marched| &marched.light);
        let mut side = 0;
        if let (Some(fresh), Some(history)) = (marched, &targets.history) {
            side = usable.as_ref().map_or(0, |usable| 1 - usable.side);
            passes.temporal(fresh, usable.as_ref().map(|usable| &history[usable.side]), &history[side])?;
            cloud = Some(&history[side]);
        }
        passes.sunshafts(cloud)?;
        passes.finish(cloud, display, 0)?;

        let jobs = std::mem::take(&mut passes.jobs);
        let history = plan.temporal.map(|_| History { key, eye, time_secs: frame.time_secs, phase, side });
        let display = display.clone();
        self.targets = Some(targets);
        self.pending = Some(Pending { plan, history, display, started: Instant::now(), times: Vec::new() });
        self.candela_per_unit = lighting.candela_per_unit;
        Ok(jobs)
    }

    /// The jobs that make the sky tables, noises, relief and weather map a frame needs and has not got.
    pub(super) fn schedule_bakes(
        &mut self,
        frame: &Frame<'_>,
        plan: &FramePlan,
        slice_ms: Option<f64>,
    ) -> Result<Vec<Job>, RenderError> {
        let mut jobs = Vec::new();
        match self.schedule_bakes_into(frame, plan, slice_ms, &mut jobs) {
            Ok(()) => Ok(jobs),
            Err(error) => {
                self.keep_bakes(jobs);
                Err(error)
            }
        }
    }

    fn schedule_bakes_into(
        &mut self,
        frame: &Frame<'_>,
        plan: &FramePlan,
        slice_ms: Option<f64>,
        jobs: &mut Vec<Job>,
    ) -> Result<(), RenderError> {
        let scene = frame.scene;
        let context = Context { gpu: &self.gpu, programs: &self.programs, pace: &self.pace, slice_ms };
        self.voxels.read(&self.gpu, scene, plan)?;
        match plan.sky {
            Some(parts) => {
                let inputs = uniforms::sky_inputs(scene, parts, &Lighting::new(scene));
                let sky = match &mut self.sky {
                    Some(sky) => sky,
                    none => none.insert(SkyTables::new(&self.gpu)?),
                };
                sky.update(&self.gpu, &self.programs, &inputs, jobs)?;
            }
            None => self.sky = None,
        }
        self.bakes.update(&context, plan, scene.ground.seed, jobs)?;
        self.living.update(&context, (frame, plan), jobs)?;
        match plan.march.filter(|march| !march.mapless) {
            Some(march) => {
                let runs = (plan.runs(Effect::Painting), plan.map_layers.flow);
                self.weather.update(&context, (&scene.weather, frame.time_secs), runs, jobs)?;
                let tracks = plan.tracks && march.baked.is_none();
                self.weather.update_bounds(&context, tracks, jobs)?;
                // Shadows alone need no clear ways; a view that turns back does.
                if march.skip || plan.has_clouds() {
                    self.clearance.update(&context, (frame, march), (&self.weather, &self.living), jobs)?;
                }
            }
            None if plan.march.is_none() && plan.holds_clouds => {}
            None => {
                self.weather.clear();
                self.clearance.clear();
            }
        }
        let mut read_by_bake = self.bakes.resources();
        read_by_bake.extend(self.weather.resources());
        read_by_bake.extend(self.living.resources());
        let counts = [self.weather.count(), self.living.count()];
        self.voxels.update(&context, (frame, plan), (&read_by_bake, counts), jobs)?;
        match plan.march {
            Some(_) if plan.has_clouds() => {
                read_by_bake.extend(self.voxels.resources());
                let read = (read_by_bake, counts);
                self.sun_grid.update(&context, (frame, plan), read, jobs)?;
            }
            _ if plan.holds_clouds => {}
            _ => self.sun_grid.clear(),
        }
        Ok(())
    }

    /// Bakes, sky tables and weather map by the names that shaders give them.
    pub(super) fn shared_resources(&self) -> Bound<'_> {
        let mut shared = self.bakes.resources();
        shared.extend(self.sky.iter().flat_map(SkyTables::resources));
        shared.extend(self.weather.resources());
        shared.extend(self.living.resources());
        shared.extend(self.clearance.resources());
        shared.extend(self.sun_grid.resources());
        shared.extend(self.voxels.resources());
        shared
    }
}

/// The buffers that a frame's passes read.
pub(super) fn frame_buffers(
    context: &Context<'_>,
    frame: &Frame<'_>,
    plan: &FramePlan,
    (view, sun_grid): (&ViewUniforms, &SunGrid),
) -> FrameBuffers {
    let scene = frame.scene;
    let lighting = Lighting::new(scene);
    let eye = Eye::new(&scene.camera);
    let shadow_px = plan.ground.and_then(|ground| ground.shadow_px).unwrap_or(1);
    let uniform = |label, bytes| context.gpu.uniform(label, bytes);
    FrameBuffers {
        view: uniform("view", bytemuck::bytes_of(view)),
        scene: uniform(
            "scene",
            bytemuck::bytes_of(&sun_grid.placed(frame, uniforms::scene_uniforms(frame, &lighting, &eye))),
        ),
        ground: uniform("ground", bytemuck::bytes_of(&uniforms::ground_uniforms(scene, &lighting, &eye, shadow_px))),
        display: uniform("display", bytemuck::bytes_of(&uniforms::display_uniforms(scene, &lighting))),
        plain: uniforms::plain_sky(scene).map(|sky_radiance| {
            context.gpu.uniform("plain", bytemuck::bytes_of(&PlainUniforms { sky_radiance, pad0: 0.0 }))
        }),
        shafts: plan.sunshafts.map(|samples| {
            let shafts = uniforms::shaft_uniforms(scene, &lighting, samples);
            context.gpu.uniform("shafts", bytemuck::bytes_of(&shafts))
        }),
        glow: plan
            .glow
            .then(|| context.gpu.uniform("glow", bytemuck::bytes_of(&uniforms::glow_uniforms(scene, &lighting)))),
        shapes: (plan.march.is_some_and(|march| march.shapes) || plan.ground.is_some_and(|ground| ground.solids)).then(
            || {
                let shapes = uniforms::shapes_uniforms(scene, &lighting, &eye);
                context.gpu.uniform("shapes", bytemuck::bytes_of(&shapes))
            },
        ),
    }
}

/// Whether a picture still says anything about the next one.
fn is_continued(history: &History, key: &HistoryKey, frame: &Frame<'_>, eye: &Eye) -> bool {
    let looked = |eye: &Eye| direction(eye.turned_deg[1], eye.turned_deg[0]);
    let turned_too_far =
        looked(&history.eye).dot(looked(eye)) < CUT_COSINE && frame.scene.camera.projection == Projection::Perspective;
    let carried = uniforms::wind_mps(&frame.scene.wind).length() * (frame.time_secs - history.time_secs).abs();
    history.key == *key
        && history.eye.position.distance(eye.position) < CUT_DISTANCE_M
        && !turned_too_far
        && carried < CUT_WIND_M
        && frame.time_secs.is_finite()
}

/// Which phase of the update pattern comes next; a fresh picture begins with the first.
fn next_phase(history: Option<&History>) -> u32 {
    history.map_or(0, |history| history.phase.wrapping_add(1))
}

#[allow(clippy::cast_possible_truncation, reason = "the way of the wind between two frames is short enough for f32")]
pub(super) fn view_uniforms(
    frame: &Frame<'_>,
    plan: &FramePlan,
    eye: &Eye,
    history: Option<&History>,
    lighting: &Lighting,
) -> ViewUniforms {
    let scene = frame.scene;
    let size = frame.render_size();
    let before = history.map_or(*eye, |history| history.eye);
    let elapsed = history.map_or(0.0, |history| frame.time_secs - history.time_secs);
    let wind_scale = scene.visible_layers().next().map_or(1.0, |layer| f64::from(layer.wind_scale));
    let motion = uniforms::wind_mps(&scene.wind) * wind_scale * elapsed;
    let (block, offset, is_checkerboard) = plan.temporal.map_or(([1, 1], [0, 0], false), |pattern| {
        (pattern.block(), pattern.offset(next_phase(history)), pattern.is_checkerboard())
    });
    let whole = frame.whole_size();
    let height = whole[1] as f32;
    let pixel_angle = match scene.camera.projection {
        Projection::Perspective => 2.0 * scene.camera.half_tangents(whole)[1] / height,
        Projection::Equirect => std::f32::consts::PI / height,
        Projection::Dome => std::f32::consts::FRAC_PI_2 / height,
    };
    ViewUniforms {
        camera: uniforms::camera_uniforms(frame, eye, eye),
        previous: uniforms::camera_uniforms(frame, &before, eye),
        cloud_motion_m: Vec3::new(motion.x as f32, 0.0, motion.y as f32),
        is_still: u32::from(history.is_some() && before == *eye && elapsed == 0.0),
        size: UVec2::from_array(size),
        ray_count: UVec2::from_array(ray_count(plan, size)),
        update_block: UVec2::from_array(block),
        update_offset: UVec2::from_array(offset),
        jitter: Vec2::new(1.0, 0.0),
        pixel_point: Vec2::splat(0.5),
        update_checkerboard: u32::from(is_checkerboard),
        pixel_angle,
        star_radiance: 0.03 * lighting.star_share() / lighting.candela_per_unit,
        sample_share: 1.0,
        sample_angle: pixel_angle,
        pad0: 0.0,
        pad1: 0.0,
        pad2: 0.0,
    }
}
