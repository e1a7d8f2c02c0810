//! The sun's optical depth on a grid about the eye: what far steps towards the light are read from.
//!
//! The grid is swept plane by plane from the side of the light (`pass/sun_sweep.wgsl`), about a middle that the eye drags
//! along in jumps, so that the same place is always seen through the same nodes.

use glam::{DVec2, DVec3, Vec2, Vec3, Vec4};

use super::context::{Bound, Context, Extent};
use super::passes::{field_key, view_of};
use super::uniforms::other::ShapesUniforms;
use super::uniforms::scene::{BandUniforms, SceneUniforms};
use super::uniforms::{Eye, field_uniforms, scene_uniforms, shapes_uniforms, wind_mps};
use crate::gpu::{GpuError, Job, ProgramKey, Texture};
use crate::plan::{FramePlan, Lighting, MarchVariant, SunGridPlan};
use crate::scene::{Automaton, Frame, MapSource, Scene, Weather};

/// Size of the region about the middle in which cells are of nearly the same size, and of all of the grid.
const CORE_M: f32 = 5000.0;
const REACH_M: f32 = 60_000.0;
/// Fewest and most nodes upwards; between these their cells are as high as the finest are wide.
const UPWARDS: [u32; 2] = [8, 48];
/// The eye moves the middle in jumps of so many of its finest cells.
const JUMP_CELLS: f64 = 8.0;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// While pictures move, clouds may have gone this part of a finest cell since the grid was made, or changed for so long where
/// there is no wind, and the light may have turned by this angle.
const STALE_CELLS: f64 = 0.4;
const STALE_SECS: f64 = 10.0;
const STALE_RAD: f32 = 0.002;

/// What the grid depends on, apart from when it is.
#[derive(Clone, Debug, PartialEq)]
struct From {
    weather: Weather,
    /// What the automaton lives by, where there is one.
    automata: Vec<Automaton>,
    field: SceneUniforms,
    shapes: Option<Box<ShapesUniforms>>,
    nodes: [u32; 2],
    reach_m: f32,
    middle: DVec2,
    program: ProgramKey,
}

#[derive(Debug)]
struct Made {
    from: From,
    /// Which weather map, and which of the automaton's densities.
    counts: [u64; 2],
    time_secs: f64,
    towards_light: Vec3,
    depths: Texture,
}

/// The grid, where marches read it.
#[derive(Debug, Default)]
pub(super) struct SunGrid {
    made: Option<Made>,
}

impl SunGrid {
    /// Appends the jobs that make the grid, where a march reads it and it is not as it should be. In moving pictures, each of
    /// which takes over from the one before, one that is a little behind will do.
    pub(super) fn update(
        &mut self,
        context: &Context<'_>,
        (frame, plan): (&Frame<'_>, &FramePlan),
        (shared, counts): (Bound<'_>, [u64; 2]),
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        let grid = plan.march.and_then(|march| Some((march, march.sun_grid?)));
        let Some((march, SunGridPlan { nodes, is_low })) = grid else {
            self.made = None;
            return Ok(());
        };
        let lighting = Lighting::new(frame.scene);
        let towards = lighting.towards_key;
        let middle = middle(frame, nodes);
        let field_at = |time_secs: f64| field_uniforms(&Frame { time_secs, ..*frame });
        let automata = || frame.scene.visible_layers().filter(|_| march.automaton).map(|layer| layer.automaton.clone());
        let from_of = |field: SceneUniforms| From {
            weather: frame.scene.weather.clone(),
            automata: automata().collect(),
            shapes: march.shapes.then(|| Box::new(shapes_uniforms(frame.scene, &lighting, &about(frame, middle)))),
            nodes: [nodes, upwards(nodes, field.highest_m - field.lowest_m)],
            field,
            reach_m: frame.quality.light_reach_m,
            middle,
            program: key(march),
        };
        if let Some(made) = &self.made {
            let scales = frame.scene.visible_layers().map(|layer| f64::from(layer.wind_scale.abs()));
            let elapsed = (frame.time_secs - made.time_secs).abs();
            let speed_mps =
                wind_mps(&frame.scene.wind).length() * scales.fold(0.0, f64::max) + fastest_flow(frame.scene);
            let behind = speed_mps * elapsed;
            let is_near = plan.temporal.is_some()
                && elapsed <= STALE_SECS
                && behind <= STALE_CELLS * f64::from(finest_m(nodes))
                && made.towards_light.angle_between(towards) <= STALE_RAD;
            let is_same = made.time_secs == frame.time_secs && made.towards_light == towards && made.counts == counts;
            if (is_same || is_near) && made.from == from_of(field_at(made.time_secs)) {
                return Ok(());
            }
        }
        let from = from_of(field_at(frame.time_secs));
        self.made = None;
        let depths = sweep(context, frame, (&lighting, is_low), (&from, &shared), jobs)?;
        self.made = Some(Made { from, counts, time_secs: frame.time_secs, towards_light: towards, depths });
        Ok(())
    }

    /// The grid, by the name shaders give it.
    pub(super) fn resources(&self) -> Bound<'_> {
        self.made.iter().map(|made| ("sun_depths", view_of(&made.depths))).collect()
    }

    /// The grid itself.
    pub(super) fn texture(&self) -> Option<&Texture> {
        self.made.as_ref().map(|made| &made.depths)
    }

    /// What the scene's shaders are told, with where this grid lies. The lowest clouds take it along with their wind.
    #[allow(clippy::cast_possible_truncation, reason = "ways near the eye are short enough for f32")]
    pub(super) fn placed(&self, frame: &Frame<'_>, scene: SceneUniforms) -> SceneUniforms {
        let Some(made) = &self.made else { return scene };
        let camera = &frame.scene.camera;
        let wind_scale = frame.scene.visible_layers().next().map_or(1.0, |layer| f64::from(layer.wind_scale));
        let carried = wind_mps(&frame.scene.wind) * wind_scale * (frame.time_secs - made.time_secs);
        let eye = DVec2::new(camera.east_m.into(), camera.south_m.into());
        let place = (made.from.middle + carried - eye).as_vec2();
        let azimuth = azimuth(made.towards_light);
        SceneUniforms {
            sun_grid_place: Vec4::new(place.x, place.y, azimuth.x, azimuth.y),
            sun_grid_form: form(made.from.nodes),
            // What long ways need more steps for is read from the grid.
            light_steps: scene.light_steps.min(frame.quality.light_steps),
            ..scene
        }
    }

    /// Forgets everything, as when no cloud is drawn.
    pub(super) fn clear(&mut self) {
        self.made = None;
    }

    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.made.as_ref().map_or(0, |made| made.depths.bytes())
    }
}

/// The jobs that sweep the grid, and what they fill.
fn sweep(
    context: &Context<'_>,
    frame: &Frame<'_>,
    (lighting, is_low): (&Lighting, bool),
    (from, shared): (&From, &Bound<'_>),
    jobs: &mut Vec<Job>,
) -> Result<Texture, GpuError> {
    let [across, upwards] = from.nodes;
    let azimuth = azimuth(lighting.towards_key);
    let scene = SceneUniforms {
        sun_grid_place: Vec4::new(0.0, 0.0, azimuth.x, azimuth.y),
        sun_grid_form: form(from.nodes),
        sun_grid_is_low: is_low.into(),
        ..scene_uniforms(frame, lighting, &about(frame, from.middle))
    };
    let scene = context.gpu.uniform("scene", bytemuck::bytes_of(&scene));
    let shapes = from.shapes.as_ref().map(|shapes| context.gpu.uniform("shapes", bytemuck::bytes_of(&**shapes)));
    let depths = Texture::new_3d(context.gpu, "sun_depths", [across, upwards, across], (1, FORMAT));
    let (planes, plane) = if is_low { (across, [across, upwards]) } else { (upwards, [across, across]) };
    let taking_turns = context.gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("sun_planes"),
        size: 2 * 4 * u64::from(plane[0]) * u64::from(plane[1]),
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    });
    for index in (0..planes).rev() {
        let band = BandUniforms { first_row: index, rows: 1, pad0: 0, pad1: 0 };
        let band = context.gpu.uniform("band", bytemuck::bytes_of(&band));
        let mut bound: Bound<'_> = shared.clone();
        bound.extend([
            ("scene", scene.as_entire_binding()),
            ("band", band.as_entire_binding()),
            ("planes", taking_turns.as_entire_binding()),
            ("sun_depths_out", view_of(&depths)),
        ]);
        bound.extend(shapes.iter().map(|shapes| ("shapes", shapes.as_entire_binding())));
        jobs.push(context.whole("sun_sweep", &from.program, &bound, Extent::image(plane))?.with_rows(1));
    }
    Ok(depths)
}

/// How fast flows of the map may carry clouds, in m/s.
fn fastest_flow(scene: &Scene) -> f64 {
    let flows = scene.weather.layers.iter().filter(|map| map.source == MapSource::Flow);
    let scales = scene.visible_layers().map(|layer| f64::from(layer.map_scale));
    flows.map(|map| f64::from(map.flow_mps.abs())).sum::<f64>() * scales.fold(0.0, f64::max)
}

/// An eye over the middle.
fn about(frame: &Frame<'_>, middle: DVec2) -> Eye {
    let eye = Eye::new(&frame.scene.camera);
    Eye { position: DVec3::new(middle.x, eye.position.y, middle.y), ..eye }
}

/// Nodes upwards for layers of a thickness in all.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, and clamped")]
fn upwards(across: u32, thickness_m: f32) -> u32 {
    ((thickness_m / finest_m(across)).ceil() as u32 + 1).clamp(UPWARDS[0], UPWARDS[1])
}

/// Hyperbolic angle of the grid's edge.
fn edge_angle() -> f32 {
    (REACH_M / CORE_M).asinh()
}

fn form([across, upwards]: [u32; 2]) -> Vec4 {
    Vec4::new(CORE_M, edge_angle(), across as f32, upwards as f32)
}

/// Side of the cells in the middle.
fn finest_m(across: u32) -> f32 {
    2.0 * CORE_M * edge_angle() / (across - 1) as f32
}

/// Where the grid's middle is when the eye is where it is.
fn middle(frame: &Frame<'_>, across: u32) -> DVec2 {
    let camera = &frame.scene.camera;
    let jump = JUMP_CELLS * f64::from(finest_m(across));
    (DVec2::new(camera.east_m.into(), camera.south_m.into()) / jump).round() * jump
}

fn azimuth(towards: Vec3) -> Vec2 {
    Vec2::new(towards.x, towards.z).try_normalize().unwrap_or(Vec2::X)
}

fn key(march: MarchVariant) -> ProgramKey {
    field_key("pass/sun_sweep.wgsl", march.field_alone())
}

/// The programs that make what a plan calls for.
pub(super) fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    plan.march.filter(|march| march.sun_grid.is_some()).map(key).into_iter().collect()
}
