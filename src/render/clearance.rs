//! How far it is to cloud from every place over the weather map: what rays cross clear air by.

use super::automaton::Living;
use super::context::{Bound, Context, Extent};
use super::passes::{field_key, view_of};
use super::uniforms::field_uniforms;
use super::uniforms::scene::LayerUniforms;
use super::weather::WeatherMap;
use crate::gpu::{GpuError, Job, ProgramKey, Texture};
use crate::plan::{FramePlan, MarchVariant};
use crate::scene::{Frame, MAX_LAYERS};

/// Cells across the map, upwards through each layer, and across the map again.
const CELLS: [u32; 3] = [256, 16, 256];
/// Cells in a row that look round together: `TOGETHER` in `pass/clear_spread.wgsl`.
const TOGETHER: u32 = 4;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What the ways depend on.
#[derive(Clone, Debug, PartialEq)]
struct From {
    map: u64,
    /// Which of the automaton's densities.
    living: u64,
    layers: [LayerUniforms; MAX_LAYERS],
    march: [ProgramKey; 3],
}

/// The ways, where rays skip by them.
#[derive(Debug, Default)]
pub(super) struct Clearance {
    made: Option<(From, Texture)>,
}

impl Clearance {
    /// Appends the jobs that find the ways, where a march wants them and they are not known.
    pub(super) fn update(
        &mut self,
        context: &Context<'_>,
        (frame, march): (&Frame<'_>, MarchVariant),
        (weather, living): (&WeatherMap, &Living),
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        let Some(map) = weather.map().filter(|_| march.skip) else {
            self.made = None;
            return Ok(());
        };
        let field = field_uniforms(frame);
        let from = From {
            map: weather.count(),
            living: if march.automaton { living.count() } else { 0 },
            layers: field.layers.map(in_place),
            march: keys(march),
        };
        if self.made.as_ref().is_some_and(|(made, _)| *made == from) {
            return Ok(());
        }
        let scene = context.gpu.uniform("scene", bytemuck::bytes_of(&field));
        let [there, back] = [(); 2].map(|()| Texture::new_3d(context.gpu, "clear_ways", CELLS, (1, FORMAT)));
        let [cells, row, spread] = &from.march;
        let scene = || ("scene", scene.as_entire_binding());
        let mut bound = living.resources();
        bound.extend([scene(), ("weather_map", view_of(map)), ("ways_out", view_of(&there))]);
        jobs.extend(context.banded("clear_cells", cells, &bound, Extent::image([CELLS[0], CELLS[2]]))?);
        let between = |before, after| vec![scene(), ("ways_before", view_of(before)), ("ways_out", view_of(after))];
        for (is_back, bound) in [(0, between(&there, &back)), (1, between(&back, &there))] {
            let key = row.clone().with_constant("BACK", is_back);
            jobs.push(context.whole("clear_row", &key, &bound, Extent::image([CELLS[1], CELLS[2]]))?);
        }
        for (axis, bound) in [(1, between(&there, &back)), (2, between(&back, &there))] {
            let key = spread.clone().with_constant("AXIS", axis);
            jobs.extend(context.banded("clear_spread", &key, &bound, blocks_along(axis as usize))?);
        }
        self.made = Some((from, there));
        Ok(())
    }

    /// The ways, by the name shaders give them.
    pub(super) fn resources(&self) -> Bound<'_> {
        self.made.iter().map(|(_, ways)| ("clear_ways", view_of(ways))).collect()
    }

    /// The ways themselves.
    pub(super) fn texture(&self) -> Option<&Texture> {
        self.made.as_ref().map(|(_, ways)| ways)
    }

    /// Forgets everything, as when no cloud is drawn.
    pub(super) fn clear(&mut self) {
        self.made = None;
    }

    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.made.as_ref().map_or(0, |(_, ways)| ways.bytes())
    }
}

/// A layer without where it has drifted to: the ways drift with it.
fn in_place(layer: LayerUniforms) -> LayerUniforms {
    LayerUniforms {
        map_from_world: glam::Vec4::new(0.0, 0.0, layer.map_from_world.z, 0.0),
        shape_from_world: glam::Vec4::ZERO,
        detail_from_world: glam::Vec4::ZERO,
        curl_from_world: glam::Vec4::ZERO,
        perlin_from_world: glam::Vec4::ZERO,
        voronoi_from_world: glam::Vec4::ZERO,
        ..layer
    }
}

/// Blocks of cells along an axis, upwards or across: from west to east, in rows of the third axis for each block along the
/// axis, so that bands of rows are alike.
fn blocks_along(axis: usize) -> Extent {
    const { assert!(CELLS[1].is_multiple_of(TOGETHER) && CELLS[2].is_multiple_of(TOGETHER), "lines are whole blocks") };
    Extent::image([CELLS[0], CELLS[3 - axis] * (CELLS[axis] / TOGETHER)])
}

/// The programs that say which cells may hold cloud, and how far it is to them, along rows and across.
fn keys(march: MarchVariant) -> [ProgramKey; 3] {
    let spreading = |file| ProgramKey::plain(file).with_constant("LAYERS", march.layers);
    [
        field_key("pass/clear_cells.wgsl", march.to_bake().field_alone()),
        spreading("pass/clear_row.wgsl"),
        spreading("pass/clear_spread.wgsl"),
    ]
}

/// The programs that make what a plan calls for.
pub(super) fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    let Some(march) = plan.march.filter(|march| march.skip) else { return Vec::new() };
    let [cells, row, spread] = keys(march);
    let [along, back] = [0, 1].map(|is_back| row.clone().with_constant("BACK", is_back));
    let [up, across] = [1, 2].map(|axis| spread.clone().with_constant("AXIS", axis));
    vec![cells, along, back, up, across]
}
