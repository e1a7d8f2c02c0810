//! The weather map of the moment, from its layers: generated states that evolve, images, and image sequences.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::RenderError;
use super::context::{Bound, Context, Extent};
use super::flow;
use super::grown::Example;
use super::paint::{Painting, blend_key};
use super::uniforms::edge_index;
use super::uniforms::other::{BlendUniforms, FlowUniforms, MapUniforms};
use crate::gpu::{Gpu, GpuError, Job, ProgramKey, Texture};
use crate::images::map::{MapImage, read_map_image};
use crate::images::pattern::FramePattern;
use crate::scene::{MapBlend, MapEdge, MapLayer, MapSource, Strokes, Weather};

/// Edge length of the map.
pub(super) const SIDE: u32 = 512;
/// Cells across the map that a layer's reach is that of.
pub(super) const CELLS: u32 = 64;
/// Cells across the map for which tracking knows its greatest field, by the names that shaders give them.
const TRACKING_CELLS: [(&str, u32); 4] =
    [("bound_of_32", 32), ("bound_of_64", 64), ("bound_of_128", 128), ("bound_of_256", 256)];
/// Largest user image.
const LARGEST_IMAGE: u32 = 4096;
/// States of a map in the time in which it becomes another; between two of them it is blended.
pub(super) const STATES: i64 = 16;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What one layer looks like at a state of its evolution.
#[derive(Clone, Debug, PartialEq)]
enum StateKey {
    Generated { layer: Box<MapLayer>, state: i64 },
    Image(PathBuf),
    Grown { layer: Box<MapLayer>, state: i64 },
}

/// How a layer joins those below it, and how much of it counts.
type Joining = (MapBlend, f32);

/// What one layer is at a time.
#[derive(Clone, Debug, PartialEq)]
enum LayerKey {
    /// Between two states, by the share of the later one, and how it joins those below it.
    Between([StateKey; 2], f32, Joining),
    /// How much of it counts, and what lies beyond the map's edge.
    Painted(Strokes, f32, MapEdge),
    /// What a flow has done.
    Flow(FlowUniforms),
}

#[derive(Debug)]
struct State {
    key: StateKey,
    texture: Texture,
}

/// The map and what it was made from.
#[derive(Debug)]
pub(super) struct WeatherMap {
    states: Vec<State>,
    /// Images that maps grow from.
    examples: Vec<Example>,
    /// The joined map of each layer over those below it, or a clear one; the last is the map.
    joined: Vec<Texture>,
    /// The greatest field of the map around each of its cells, by name, where paths track by it.
    bounds: Vec<(&'static str, Texture)>,
    /// What each joined map was made from.
    made_from: Vec<LayerKey>,
    /// What is painted, by the layer.
    paintings: BTreeMap<usize, Painting>,
    /// Maps joined so far.
    count: u64,
}

impl WeatherMap {
    pub(super) fn new() -> Self {
        Self {
            states: Vec::new(),
            examples: Vec::new(),
            joined: Vec::new(),
            bounds: Vec::new(),
            made_from: Vec::new(),
            paintings: BTreeMap::new(),
            count: 0,
        }
    }

    /// Appends the jobs that bring the map to a time, with what is painted on it and flows if they run.
    pub(super) fn update(
        &mut self,
        context: &Context<'_>,
        (weather, time_secs): (&Weather, f64),
        (is_painted, flows): (bool, bool),
        jobs: &mut Vec<Job>,
    ) -> Result<(), RenderError> {
        let mut wanted = Vec::new();
        for (index, layer) in weather.layers.iter().enumerate() {
            // Without a layer below it a flow carries nothing.
            if layer.source == MapSource::Flow && (wanted.is_empty() || !flows) {
                continue;
            }
            let mut key =
                layer_at(layer, weather, time_secs).map_err(|message| RenderError::Map { layer: index, message })?;
            match &mut key {
                LayerKey::Between(states, ..) => {
                    for key in states {
                        if !self.states.iter().any(|state| state.key == *key) {
                            let texture = match key {
                                StateKey::Grown { layer, state } => self.grown(context, (layer, *state), jobs),
                                _ => make_state(context, key, jobs),
                            };
                            let texture = texture.map_err(|error| error.in_layer(index))?;
                            self.states.push(State { key: key.clone(), texture });
                        }
                    }
                }
                LayerKey::Painted(strokes, ..) if !is_painted => *strokes = Strokes::default(),
                LayerKey::Painted(..) | LayerKey::Flow(_) => {}
            }
            wanted.push(key);
        }
        let is_same = wanted == self.made_from && !self.joined.is_empty();
        let is_wanted = |state: &State| {
            wanted.iter().any(|layer| matches!(layer, LayerKey::Between(states, ..) if states.contains(&state.key)))
        };
        self.states.retain(is_wanted);
        let is_used = |example: &Example| {
            weather.layers.iter().any(|layer| layer.source == MapSource::Grown && layer.image.0 == example.name)
        };
        self.examples.retain(is_used);
        if is_same {
            return Ok(());
        }
        self.join(context, &wanted, jobs)?;
        self.count += 1;
        self.made_from = wanted;
        self.bounds.clear();
        Ok(())
    }

    /// Appends the jobs that find the greatest field around each cell of the map, where that is wanted and not known.
    pub(super) fn update_bounds(
        &mut self,
        context: &Context<'_>,
        tracks: bool,
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        if !tracks {
            self.bounds.clear();
        }
        let Some(map) = self.joined.last().filter(|_| tracks && self.bounds.is_empty()) else { return Ok(()) };
        for (name, cells) in TRACKING_CELLS {
            let texture = Texture::new_2d(context.gpu, name, [cells; 2], wgpu::TextureFormat::R32Float)?;
            let bound = vec![
                ("weather_map", wgpu::BindingResource::TextureView(&map.view)),
                ("bound_out", wgpu::BindingResource::TextureView(&texture.view)),
            ];
            let key = ProgramKey::plain("pass/weather_bound.wgsl");
            jobs.push(context.whole("weather_map", &key, &bound, Extent::image([cells; 2]))?);
            self.bounds.push((name, texture));
        }
        Ok(())
    }

    /// The map, where there is one.
    pub(super) fn map(&self) -> Option<&Texture> {
        self.joined.last()
    }

    /// Everything that exists, by the name shaders give it.
    pub(super) fn resources(&self) -> Bound<'_> {
        let map = self.joined.last().map(|map| ("weather_map", map));
        let all = map.into_iter().chain(self.bounds.iter().map(|(name, texture)| (*name, texture)));
        all.map(|(name, texture)| (name, wgpu::BindingResource::TextureView(&texture.view))).collect()
    }

    /// A map that grows out of an image, which is read once.
    fn grown(
        &mut self,
        context: &Context<'_>,
        (layer, state): (&MapLayer, i64),
        jobs: &mut Vec<Job>,
    ) -> Result<Texture, StateError> {
        let name = &layer.image.0;
        if !self.examples.iter().any(|example| example.name == *name) {
            let image = read(Path::new(name))?;
            self.examples.push(Example::new(context.gpu, name, &image)?);
        }
        let example = self.examples.iter().find(|example| example.name == *name);
        let example = example.ok_or_else(|| StateError::Image(format!("{name} is gone")))?;
        Ok(example.grown(context, (layer, state), &repeat_sampler(context.gpu), jobs)?)
    }

    fn join(&mut self, context: &Context<'_>, wanted: &[LayerKey], jobs: &mut Vec<Job>) -> Result<(), GpuError> {
        self.joined.truncate(wanted.len());
        // Without layers the map is clear, as textures begin.
        while self.joined.len() < wanted.len().max(1) {
            self.joined.push(Texture::new_2d(context.gpu, "weather_map", [SIDE; 2], FORMAT)?);
        }
        let linear_repeat = repeat_sampler(context.gpu);
        self.paintings.retain(|index, _| matches!(wanted.get(*index), Some(LayerKey::Painted(..))));
        // What lies below the first that has changed is as it was.
        let same = wanted.iter().zip(&self.made_from).take_while(|(wanted, made)| wanted == made).count();
        // Should one fail, those before it are known.
        self.made_from.truncate(same);
        for (index, layer) in wanted.iter().enumerate().skip(same) {
            let ([before, after], share, (mode, opacity)) = match layer {
                LayerKey::Between(states, share, joining) => (states, share, joining),
                LayerKey::Painted(strokes, opacity, edge) => {
                    self.lay_over(context, index, (strokes, *opacity, *edge), jobs)?;
                    continue;
                }
                LayerKey::Flow(uniforms) => {
                    self.carry(context, (index, &linear_repeat), uniforms, jobs)?;
                    continue;
                }
            };
            let find = |key: &StateKey| self.states.iter().find(|state| state.key == *key).map(|state| &state.texture);
            let (Some(before), Some(after)) = (find(before), find(after)) else {
                continue;
            };
            let blend = BlendUniforms { share: *share, mode: blend_index(*mode), opacity: *opacity, edge: 0 };
            let buffer = context.gpu.uniform("blend", bytemuck::bytes_of(&blend));
            let mut bound: Bound<'_> = vec![
                ("blend", buffer.as_entire_binding()),
                ("linear_repeat", wgpu::BindingResource::Sampler(&linear_repeat)),
                ("map_before", wgpu::BindingResource::TextureView(&before.view)),
                ("map_after", wgpu::BindingResource::TextureView(&after.view)),
                ("map_out", wgpu::BindingResource::TextureView(&self.joined[index].view)),
            ];
            let mut key = ProgramKey::plain("pass/weather_blend.wgsl");
            if index > 0 {
                key = joining_key();
                bound.push(("map_below", wgpu::BindingResource::TextureView(&self.joined[index - 1].view)));
            }
            jobs.push(context.whole("weather_map", &key, &bound, Extent::image([SIDE; 2]))?);
        }
        Ok(())
    }

    /// Lays a painted layer over the map below it.
    fn lay_over(
        &mut self,
        context: &Context<'_>,
        index: usize,
        (strokes, opacity, edge): (&Strokes, f32, MapEdge),
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        let painting = self.paintings.entry(index).or_insert_with(|| Painting::new(context.gpu, SIDE));
        painting.update(context, (strokes, edge), jobs)?;
        let blend = BlendUniforms { share: 0.0, mode: 0, opacity, edge: edge_index(edge) };
        let buffer = context.gpu.uniform("blend", bytemuck::bytes_of(&blend));
        let below = index.checked_sub(1).map(|below| &self.joined[below].view);
        let mut bound: Bound<'_> = vec![
            ("blend", buffer.as_entire_binding()),
            ("painted", painting.buffer().as_entire_binding()),
            ("map_out", wgpu::BindingResource::TextureView(&self.joined[index].view)),
        ];
        bound.extend(below.map(|below| ("map_below", wgpu::BindingResource::TextureView(below))));
        let key = blend_key(below.is_some());
        jobs.push(context.whole("weather_map", &key, &bound, Extent::image([SIDE; 2]))?);
        Ok(())
    }

    /// Carries the map below a flow.
    fn carry(
        &mut self,
        context: &Context<'_>,
        (index, sampler): (usize, &wgpu::Sampler),
        uniforms: &FlowUniforms,
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        let Some(below) = index.checked_sub(1).map(|below| &self.joined[below]) else { return Ok(()) };
        let buffer = context.gpu.uniform("flow", bytemuck::bytes_of(uniforms));
        let bound = vec![
            ("flow", buffer.as_entire_binding()),
            ("linear_repeat", wgpu::BindingResource::Sampler(sampler)),
            ("map_below", wgpu::BindingResource::TextureView(&below.view)),
            ("map_out", wgpu::BindingResource::TextureView(&self.joined[index].view)),
        ];
        jobs.push(context.whole("weather_flow", &flow::key(), &bound, Extent::image([SIDE; 2]))?);
        Ok(())
    }

    /// Forgets everything, as when no cloud is drawn.
    pub(super) fn clear(&mut self) {
        *self = Self { count: self.count, ..Self::new() };
    }

    /// Which of all maps made so far this one is.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let states = self.states.iter().map(|state| &state.texture);
        let painted = self.paintings.values().map(Painting::bytes).sum::<u64>();
        let textures = states.chain(&self.joined).chain(self.bounds.iter().map(|(_, bound)| bound));
        let examples = self.examples.iter().map(Example::bytes).sum::<u64>();
        painted + examples + textures.map(Texture::bytes).sum::<u64>()
    }
}

/// Which state a map is in that evolves, and the share of the next.
#[allow(clippy::cast_possible_truncation, reason = "counts of states are small; shares are in 0..1")]
fn evolution(weather: &Weather, time_secs: f64) -> (i64, f32) {
    let period = f64::from(weather.evolution_secs);
    let position = if period > 0.0 { time_secs / period * STATES as f64 } else { 0.0 };
    let state = position.floor();
    // The blend moves in steps of 1/64, below what can be seen, so that it need not run in every frame.
    (state as i64, (((position - state) * 64.0).floor() / 64.0) as f32)
}

/// What a layer is at a time.
#[allow(clippy::cast_possible_truncation, reason = "counts of states and images are small; shares are in 0..1")]
fn layer_at(layer: &MapLayer, weather: &Weather, time_secs: f64) -> Result<LayerKey, String> {
    let joining = (layer.blend, layer.opacity);
    // How it joins makes no other state of it.
    let layer = &MapLayer { blend: MapBlend::Densest, opacity: 1.0, ..layer.clone() };
    match layer.source {
        MapSource::Generated | MapSource::WeatherTexture => {
            let (state, share) = evolution(weather, time_secs);
            let key = |state| StateKey::Generated { layer: Box::new(layer.clone()), state };
            Ok(LayerKey::Between([key(state), key(state + i64::from(share > 0.0))], share, joining))
        }
        MapSource::Grown => {
            named(layer)?;
            let (state, share) = evolution(weather, time_secs);
            let key = |state| StateKey::Grown { layer: Box::new(layer.clone()), state };
            Ok(LayerKey::Between([key(state), key(state + i64::from(share > 0.0))], share, joining))
        }
        MapSource::Flow => Ok(LayerKey::Flow(flow::at(layer, weather, time_secs))),
        MapSource::Painted => Ok(LayerKey::Painted(layer.strokes.clone(), joining.1, weather.edge)),
        MapSource::Image => {
            let name = named(layer)?;
            Ok(LayerKey::Between([(); 2].map(|()| StateKey::Image(name.into())), 0.0, joining))
        }
        MapSource::Sequence => {
            let pattern = FramePattern::parse(Path::new(named(layer)?)).map_err(|error| error.to_string())?;
            let frames = pattern.existing_frames().map_err(|error| error.to_string())?;
            if frames.is_empty() {
                return Err(format!("no image fits the pattern {}; write # for each digit", layer.image.0));
            }
            let position = (time_secs * f64::from(layer.images_per_sec)).max(0.0);
            let at = |offset: usize| {
                let index = (position.floor() as usize + offset) % frames.len();
                StateKey::Image(frames[index].1.clone())
            };
            let share = ((position - position.floor()) * 16.0).floor() / 16.0;
            Ok(LayerKey::Between([at(0), at(usize::from(share > 0.0))], share as f32, joining))
        }
    }
}

/// The program that joins a layer to those below it.
pub(super) fn joining_key() -> ProgramKey {
    ProgramKey::plain("pass/weather_blend.wgsl").with_flags(["BELOW"])
}

/// As `pass/weather_blend.wgsl` numbers them.
fn blend_index(blend: MapBlend) -> u32 {
    match blend {
        MapBlend::Densest => 0,
        MapBlend::Replace => 1,
        MapBlend::Add => 2,
        MapBlend::Subtract => 3,
        MapBlend::Mask => 4,
    }
}

fn named(layer: &MapLayer) -> Result<&str, String> {
    if layer.image.0.is_empty() {
        return Err("no image is named; give the path of a square PNG or EXR".to_owned());
    }
    Ok(&layer.image.0)
}

/// What making a state can fail with, before it is known for which layer.
enum StateError {
    Gpu(GpuError),
    Image(String),
}

impl StateError {
    fn in_layer(self, layer: usize) -> RenderError {
        match self {
            Self::Gpu(error) => error.into(),
            Self::Image(message) => RenderError::Map { layer, message },
        }
    }
}

impl From<GpuError> for StateError {
    fn from(error: GpuError) -> Self {
        Self::Gpu(error)
    }
}

#[allow(clippy::cast_possible_truncation, reason = "a phase in 0..1")]
fn make_state(context: &Context<'_>, key: &StateKey, jobs: &mut Vec<Job>) -> Result<Texture, StateError> {
    match key {
        StateKey::Generated { layer, state } => {
            let texture = Texture::new_2d(context.gpu, "weather_state", [SIDE; 2], FORMAT)?;
            let cells = f64::from(layer.large_cells.max(1));
            // One large cell on the third axis in the time in which the map becomes another; whole tiles repeat.
            let phase = (*state as f64 / STATES as f64 / cells).rem_euclid(1.0);
            let map = MapUniforms {
                seed: layer.seed,
                large_cells: layer.large_cells,
                small_share: layer.small_share,
                fray: layer.fray,
                contrast: layer.contrast,
                cumulus: layer.cumulus,
                stratus: layer.stratus,
                stratocumulus: layer.stratocumulus,
                phase: phase as f32,
                is_weather_texture: u32::from(layer.source == MapSource::WeatherTexture),
                pad1: 0.0,
                pad2: 0.0,
            };
            let buffer = context.gpu.uniform("map", bytemuck::bytes_of(&map));
            let bound = vec![
                ("map", buffer.as_entire_binding()),
                ("map_out", wgpu::BindingResource::TextureView(&texture.view)),
            ];
            let key = ProgramKey::plain("pass/weather_map.wgsl");
            jobs.extend(context.banded("weather_map", &key, &bound, Extent::image([SIDE; 2]))?);
            Ok(texture)
        }
        StateKey::Image(path) => {
            let image = read(path)?;
            Ok(uploaded(context.gpu, ("weather_image", [image.width, image.height]), &image.rgba)?)
        }
        // Not without what it grows from.
        StateKey::Grown { layer, .. } => Err(StateError::Image(format!("{} is not at hand", layer.image.0))),
    }
}

fn read(path: &Path) -> Result<MapImage, StateError> {
    read_map_image(path, LARGEST_IMAGE).map_err(|error| StateError::Image(error.to_string()))
}

/// A texture of values in 0..1.
pub(super) fn uploaded(
    gpu: &Gpu,
    (label, size): (&'static str, [u32; 2]),
    rgba: &[[f32; 4]],
) -> Result<Texture, GpuError> {
    let texture = Texture::new_2d(gpu, label, size, FORMAT)?;
    let halfs: Vec<[half::f16; 4]> =
        rgba.iter().map(|texel| texel.map(|value| half::f16::from_f32(value.clamp(0.0, 1.0)))).collect();
    gpu.queue.write_texture(
        texture.texture.as_image_copy(),
        bytemuck::cast_slice(&halfs),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size[0] * 8), rows_per_image: None },
        texture.texture.size(),
    );
    Ok(texture)
}

fn repeat_sampler(gpu: &Gpu) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("weather_map"),
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}
