//! Clouds as voxels: those of a file, and those that all layers of a scene are baked into.

use std::path::{Path, PathBuf};

use super::context::{Bound, Context, Extent};
use super::passes::{field_key, view_of};
use super::uniforms::other::ShapesUniforms;
use super::uniforms::scene::SceneUniforms;
use super::uniforms::{Eye, field_uniforms, shapes_uniforms};
use super::{RenderError, Renderer};
use crate::gpu::{Gpu, GpuError, Job, ProgramKey, Texture, job, readback};
use crate::images::voxels::{Bounds, VoxelGrid};
use crate::plan::{FramePlan, Lighting, MarchVariant};
use crate::scene::{Camera, CloudLayer, DensityModel, Frame, Scene};

/// Voxels along each edge of a cell whose greatest value is known; as `cloud/voxels.wgsl` has it.
const PER_CELL: u32 = 8;

/// A file as it was when it was read: another time or length makes it another.
#[derive(Clone, Debug, PartialEq)]
struct FileState {
    path: PathBuf,
    modified: Option<std::time::SystemTime>,
    bytes: u64,
}

impl FileState {
    fn of(path: &Path) -> Self {
        let metadata = std::fs::metadata(path).ok();
        let modified = metadata.as_ref().and_then(|metadata| metadata.modified().ok());
        Self { path: path.to_owned(), modified, bytes: metadata.map_or(0, |metadata| metadata.len()) }
    }
}

/// One grid on the device, and what it was made from.
#[derive(Debug)]
struct Made<K> {
    from: K,
    values: Texture,
    /// The greatest value in each cell, where clouds are tracked.
    bound: Option<Texture>,
}

/// What baked voxels depend on.
#[derive(Debug, PartialEq)]
struct BakedFrom {
    field: SceneUniforms,
    /// The shapes, where a layer is of them.
    shapes: Option<Box<ShapesUniforms>>,
    /// Which of the weather maps and of the automaton's densities it was, by their counts.
    counts: [u64; 2],
    file: Option<FileState>,
    variant: MarchVariant,
}

/// The grids of a scene.
#[derive(Debug, Default)]
pub(super) struct Voxels {
    file: Option<Made<FileState>>,
    baked: Option<Made<BakedFrom>>,
}

impl Voxels {
    /// Reads the file that the plan calls for, if it is not there; lets go of another.
    pub(super) fn read(&mut self, gpu: &Gpu, scene: &Scene, plan: &FramePlan) -> Result<(), RenderError> {
        if plan.march.is_none() && plan.holds_clouds {
            return Ok(());
        }
        self.update_file(gpu, scene, plan.march.is_some_and(|march| march.grid))
    }

    /// Bakes the layers that the plan calls for, as far as they are not there; lets go of the others.
    /// A bake reads `inputs`: noises, weather map and automaton, of which they are the ones of these counts.
    pub(super) fn update(
        &mut self,
        context: &Context<'_>,
        (frame, plan): (&Frame<'_>, &FramePlan),
        (inputs, counts): (&Bound<'_>, [u64; 2]),
        jobs: &mut Vec<Job>,
    ) -> Result<(), RenderError> {
        let Some(march) = plan.march else {
            self.baked = self.baked.take().filter(|_| plan.holds_clouds);
            return Ok(());
        };
        self.update_baked(context, (frame, march), (inputs, counts), jobs)?;
        let tracked = march.baked.is_none();
        if let Some(file) = &mut self.file {
            file.update_bound(context, plan.tracks && tracked, jobs)?;
        }
        if let Some(baked) = &mut self.baked {
            baked.update_bound(context, plan.tracks, jobs)?;
        }
        Ok(())
    }

    fn update_file(&mut self, gpu: &Gpu, scene: &Scene, wanted: bool) -> Result<(), RenderError> {
        let Some((index, layer)) = file_layer(scene).filter(|_| wanted) else {
            self.file = None;
            return Ok(());
        };
        let path = Path::new(&layer.grid.0);
        let state = FileState::of(path);
        if self.file.as_ref().is_some_and(|file| file.from == state) {
            return Ok(());
        }
        // Two grids at once may be more than there is memory for.
        self.file = None;
        let refused = |message: String| RenderError::Grid { layer: index, message };
        if layer.grid.0.is_empty() {
            return Err(refused("no file is named; give the path of an .npy or a .vol".to_owned()));
        }
        let (grid, _) = VoxelGrid::read(path).map_err(|error| refused(error.to_string()))?;
        let values = upload(gpu, &grid);
        self.file = Some(Made { from: state, values, bound: None });
        Ok(())
    }

    fn update_baked(
        &mut self,
        context: &Context<'_>,
        (frame, march): (&Frame<'_>, MarchVariant),
        (inputs, counts): (&Bound<'_>, [u64; 2]),
        jobs: &mut Vec<Job>,
    ) -> Result<(), RenderError> {
        let Some(across) = march.baked else {
            self.baked = None;
            return Ok(());
        };
        let from = BakedFrom {
            field: field_uniforms(frame),
            shapes: march.shapes.then(|| {
                let origin = Eye::new(&Camera::default());
                Box::new(shapes_uniforms(frame.scene, &Lighting::new(frame.scene), &origin))
            }),
            counts,
            file: self.file.as_ref().map(|file| file.from.clone()),
            variant: march.field_alone(),
        };
        if self.baked.as_ref().is_some_and(|baked| baked.from == from) {
            return Ok(());
        }
        self.baked = None;
        let size = [across, across.div_ceil(2), across];
        let values = Texture::new_3d(context.gpu, "baked_voxels", size, (1, format(march.layers)));
        let scene = context.gpu.uniform("scene", bytemuck::bytes_of(&from.field));
        let mut bound = inputs.clone();
        bound.push(("scene", scene.as_entire_binding()));
        let shapes = from.shapes.as_ref().map(|shapes| context.gpu.uniform("shapes", bytemuck::bytes_of(&**shapes)));
        bound.extend(shapes.iter().map(|shapes| ("shapes", shapes.as_entire_binding())));
        bound.push(("voxels_out", view_of(&values)));
        if let Some(file) = &self.file {
            bound.push(("voxels", view_of(&file.values)));
        }
        jobs.extend(context.banded("bake_voxels", &bake_key(march), &bound, Extent::solid(size))?);
        self.baked = Some(Made { from, values, bound: None });
        Ok(())
    }

    /// The voxels themselves with the pass that made them.
    pub(super) fn textures(&self) -> impl Iterator<Item = (&'static str, &Texture)> {
        let file = self.file.iter().map(|file| ("voxels of a file", &file.values));
        file.chain(self.baked.iter().map(|baked| ("bake_voxels", &baked.values)))
    }

    /// Whichever voxels are marched, by the names shaders give them.
    pub(super) fn resources(&self) -> Bound<'_> {
        let marched = match (&self.baked, &self.file) {
            (Some(baked), _) => Some((&baked.values, &baked.bound)),
            (None, Some(file)) => Some((&file.values, &file.bound)),
            (None, None) => None,
        };
        let Some((values, bound)) = marched else { return Vec::new() };
        let bound = bound.as_ref().map(|bound| ("voxel_bound", view_of(bound)));
        [("voxels", view_of(values))].into_iter().chain(bound).collect()
    }

    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let file = self.file.iter().map(|file| (&file.values, &file.bound));
        let all = file.chain(self.baked.iter().map(|baked| (&baked.values, &baked.bound)));
        all.map(|(values, bound)| values.bytes() + bound.as_ref().map_or(0, Texture::bytes)).sum()
    }
}

impl<K> Made<K> {
    fn update_bound(&mut self, context: &Context<'_>, wanted: bool, jobs: &mut Vec<Job>) -> Result<(), GpuError> {
        if !wanted {
            self.bound = None;
        } else if self.bound.is_none() {
            let [width, height] = self.values.size();
            let depth = self.values.texture.depth_or_array_layers();
            let cells = [width, height, depth].map(|side| side.div_ceil(PER_CELL));
            let format = self.values.texture.format();
            let texture = Texture::new_3d(context.gpu, "voxel_bound", cells, (1, format));
            let bound = vec![("voxels", view_of(&self.values)), ("bound_out", view_of(&texture))];
            let key = bound_key(format == wgpu::TextureFormat::R32Float);
            jobs.push(context.whole("voxel_bound", &key, &bound, Extent::solid(cells))?);
            self.bound = Some(texture);
        }
        Ok(())
    }
}

impl Renderer {
    /// Bakes the clouds of a frame whose quality asks for it, and reads back the extinction of all layers, in 1/m, with the
    /// lower and upper corner of its box in the world. `None` where there is nothing to bake.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn bake_extinction(&mut self, frame: &Frame<'_>) -> Result<Option<(VoxelGrid, Bounds)>, RenderError> {
        self.finish_interactive()?;
        let plan = FramePlan::of_clouds(frame);
        let jobs = self.schedule_bakes(frame, &plan, None)?;
        job::run(&self.gpu, &jobs)?;
        let Some(baked) = &self.voxels.baked else { return Ok(None) };
        let [width, height] = baked.values.size();
        let size = [width, height, baked.values.texture.depth_or_array_layers()];
        let field = &baked.from.field;
        let extinction = field.layers.map(|layer| layer.extinction_per_m);
        let values = if baked.values.texture.format() == wgpu::TextureFormat::R32Float {
            readback::scalars(&self.gpu, &baked.values)?.iter().map(|density| density * extinction[0]).collect()
        } else {
            let densities = readback::rgba(&self.gpu, &baked.values)?;
            let all = densities.iter().map(|densities| densities.iter().zip(extinction).map(|(a, b)| a * b).sum());
            all.collect()
        };
        // The eye of the field's uniforms stands at the world's origin.
        let bounds = [field.box_min.to_array(), field.box_max.to_array()];
        Ok(VoxelGrid::new(size, values).map(|grid| (grid, bounds)))
    }
}

/// Full precision for one layer, half of it for several.
fn format(layers: u32) -> wgpu::TextureFormat {
    if layers == 1 { wgpu::TextureFormat::R32Float } else { wgpu::TextureFormat::Rgba16Float }
}

/// The layer that is a file, and its index.
fn file_layer(scene: &Scene) -> Option<(usize, &CloudLayer)> {
    let mut layers = scene.layers.iter().enumerate();
    layers.find(|(_, layer)| layer.model == DensityModel::Grid && layer.is_visible())
}

fn bake_key(march: MarchVariant) -> ProgramKey {
    let single = (march.layers == 1).then_some("SINGLE");
    field_key("pass/bake_voxels.wgsl", march.to_bake()).with_flags(single)
}

fn bound_key(is_single: bool) -> ProgramKey {
    ProgramKey::plain("pass/voxel_bound.wgsl").with_flags(is_single.then_some("SINGLE"))
}

/// The programs that make what a plan calls for.
pub(super) fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    let Some(march) = plan.march.filter(|march| march.grid || march.baked.is_some()) else { return Vec::new() };
    let bake = march.baked.map(|_| bake_key(march));
    let bound = plan.tracks.then(|| bound_key(march.baked.is_none() || march.layers == 1));
    bake.into_iter().chain(bound).collect()
}

/// The voxels relative to the greatest one, as a texture.
fn upload(gpu: &Gpu, grid: &VoxelGrid) -> Texture {
    let [x, y, z] = grid.size();
    let texture = Texture::new_3d(gpu, "voxels", grid.size(), (1, wgpu::TextureFormat::R32Float));
    let greatest = grid.greatest();
    let relative = |value: &f32| value / greatest.max(f32::MIN_POSITIVE);
    for (index, slice) in grid.values().chunks_exact(x as usize * y as usize).enumerate() {
        let slice: Vec<f32> = slice.iter().map(relative).collect();
        let mut place = texture.texture.as_image_copy();
        place.origin.z = u32::try_from(index).unwrap_or(z);
        gpu.queue.write_texture(
            place,
            bytemuck::cast_slice(&slice),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(x * 4), rows_per_image: Some(y) },
            wgpu::Extent3d { width: x, height: y, depth_or_array_layers: 1 },
        );
    }
    texture
}
