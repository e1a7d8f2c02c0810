//! Noises and relief: made once, and again when what they are made from changes. Allocated when first called for.

use super::blue_noise;
use super::context::{Bound, Context, Extent};
use super::uniforms::other::ReliefUniforms;
use super::{flow, grown, weather};
use crate::gpu::{Gpu, GpuError, Job, ProgramKey, Texture};
use crate::plan::{FramePlan, MarchVariant};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const SHAPE_SIDE: u32 = 128;
const WORLEY_SIDE: u32 = 64;
const OCTAVE_SIDE: u32 = 64;
const DETAIL_SIDE: u32 = 32;
const CURL_SIDE: u32 = 128;
const RELIEF_SIDE: u32 = 512;

/// Textures that do not depend on the size of the picture.
#[derive(Debug)]
pub(super) struct Bakes {
    blue_noise: Texture,
    linear_repeat: wgpu::Sampler,
    linear_clamp: wgpu::Sampler,
    shape: Option<Texture>,
    worley: Option<Texture>,
    octave: Option<Texture>,
    detail: Option<Texture>,
    curl: Option<Texture>,
    /// The relief and the seed it was made from.
    relief: Option<(u32, Texture)>,
}

impl Bakes {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let side = blue_noise::SIDE_PX;
        let blue_noise = Texture::new_2d(gpu, "blue_noise", [side, side], wgpu::TextureFormat::R32Float)?;
        gpu.queue.write_texture(
            blue_noise.texture.as_image_copy(),
            bytemuck::cast_slice(&blue_noise::values()),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(side * 4), rows_per_image: None },
            blue_noise.texture.size(),
        );
        Ok(Self {
            blue_noise,
            linear_repeat: sampler(gpu, "linear_repeat", wgpu::AddressMode::Repeat),
            linear_clamp: sampler(gpu, "linear_clamp", wgpu::AddressMode::ClampToEdge),
            shape: None,
            worley: None,
            octave: None,
            detail: None,
            curl: None,
            relief: None,
        })
    }

    /// Appends the jobs that make what the plan calls for and is not there yet; lets go of what it does not call for.
    pub(super) fn update(
        &mut self,
        context: &Context<'_>,
        plan: &FramePlan,
        relief_seed: u32,
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        let march = plan.march;
        let wants = |test: fn(MarchVariant) -> bool| march.is_some_and(test);
        // Clouds that are out of view come back.
        let kept = march.is_none() && plan.holds_clouds;
        noise_3d(context, &mut self.shape, (wants(MarchVariant::reads_shape), kept), &SHAPE, jobs)?;
        noise_3d(context, &mut self.worley, (wants(|march| march.thesis), kept), &WORLEY, jobs)?;
        noise_3d(context, &mut self.octave, (wants(|march| march.product), kept), &OCTAVE, jobs)?;
        noise_3d(context, &mut self.detail, (wants(|march| march.detail), kept), &DETAIL, jobs)?;
        if !wants(|march| march.curl) {
            self.curl = self.curl.take().filter(|_| kept);
        } else if self.curl.is_none() {
            let texture = Texture::new_2d(context.gpu, "curl_noise", [CURL_SIDE; 2], FORMAT)?;
            let bound = vec![("noise_out", wgpu::BindingResource::TextureView(&texture.view))];
            let key = ProgramKey::plain("pass/bake_curl.wgsl");
            jobs.push(context.whole("bake_curl", &key, &bound, Extent::image([CURL_SIDE; 2]))?);
            self.curl = Some(texture);
        }
        self.update_relief(context, plan.ground.is_some_and(|ground| ground.terrain), relief_seed, jobs)
    }

    fn update_relief(
        &mut self,
        context: &Context<'_>,
        wanted: bool,
        seed: u32,
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        if !wanted {
            self.relief = None;
            return Ok(());
        }
        if self.relief.as_ref().is_some_and(|(made_from, _)| *made_from == seed) {
            return Ok(());
        }
        let texture = Texture::new_2d(context.gpu, "terrain_map", [RELIEF_SIDE; 2], FORMAT)?;
        let relief = ReliefUniforms { seed, pad0: 0, pad1: 0, pad2: 0 };
        let buffer = context.gpu.uniform("relief", bytemuck::bytes_of(&relief));
        let bound = vec![
            ("relief_out", wgpu::BindingResource::TextureView(&texture.view)),
            ("relief", buffer.as_entire_binding()),
        ];
        let key = ProgramKey::plain("pass/bake_terrain.wgsl");
        jobs.extend(context.banded("bake_terrain", &key, &bound, Extent::image([RELIEF_SIDE; 2]))?);
        self.relief = Some((seed, texture));
        Ok(())
    }

    /// Noises and relief with the pass that makes each.
    pub(super) fn textures(&self) -> impl Iterator<Item = (&'static str, &Texture)> {
        let optional = [
            ("bake_shape", self.shape.as_ref()),
            ("bake_worley", self.worley.as_ref()),
            ("bake_octave", self.octave.as_ref()),
            ("bake_detail", self.detail.as_ref()),
            ("bake_curl", self.curl.as_ref()),
            ("bake_terrain", self.relief.as_ref().map(|(_, texture)| texture)),
        ];
        optional.into_iter().filter_map(|(pass, texture)| Some((pass, texture?)))
    }

    /// Everything that exists, by the name shaders give it.
    pub(super) fn resources(&self) -> Bound<'_> {
        let mut bound: Bound<'_> = vec![
            ("blue_noise", wgpu::BindingResource::TextureView(&self.blue_noise.view)),
            ("linear_repeat", wgpu::BindingResource::Sampler(&self.linear_repeat)),
            ("linear_clamp", wgpu::BindingResource::Sampler(&self.linear_clamp)),
        ];
        let optional = [
            ("shape_noise", self.shape.as_ref()),
            ("worley_noise", self.worley.as_ref()),
            ("octave_noise", self.octave.as_ref()),
            ("detail_noise", self.detail.as_ref()),
            ("curl_noise", self.curl.as_ref()),
            ("terrain_map", self.relief.as_ref().map(|(_, texture)| texture)),
        ];
        for (name, texture) in optional {
            if let Some(texture) = texture {
                bound.push((name, wgpu::BindingResource::TextureView(&texture.view)));
            }
        }
        bound
    }

    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let [shape, worley, octave] = [self.shape.as_ref(), self.worley.as_ref(), self.octave.as_ref()];
        let optional = [shape, worley, octave, self.detail.as_ref(), self.curl.as_ref()];
        let relief = self.relief.as_ref().map(|(_, texture)| texture);
        self.blue_noise.bytes() + optional.into_iter().chain([relief]).flatten().map(Texture::bytes).sum::<u64>()
    }
}

/// The programs that make what a plan calls for.
pub(super) fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    let march = plan.march;
    let wants = |test: fn(MarchVariant) -> bool| march.is_some_and(test);
    let all = [
        (SHAPE.file, wants(MarchVariant::reads_shape)),
        (WORLEY.file, wants(|march| march.thesis)),
        (OCTAVE.file, wants(|march| march.product)),
        (DETAIL.file, wants(|march| march.detail)),
        ("pass/bake_curl.wgsl", wants(|march| march.curl)),
        ("pass/bake_mip.wgsl", wants(|march| march.reads_shape() || march.thesis || march.product || march.detail)),
        ("pass/bake_terrain.wgsl", plan.ground.is_some_and(|ground| ground.terrain)),
        ("pass/weather_map.wgsl", wants(|march| !march.mapless)),
        ("pass/weather_blend.wgsl", wants(|march| !march.mapless)),
        (
            "pass/weather_bound.wgsl",
            plan.tracks && plan.has_clouds() && wants(|march| !march.mapless && march.baked.is_none()),
        ),
    ];
    let all = all.into_iter().filter(|(_, wanted)| *wanted).map(|(file, _)| ProgramKey::plain(file));
    let maps = plan.map_layers;
    let of_map = [(maps.joined, weather::joining_key()), (maps.grown, grown::key()), (maps.flow, flow::key())];
    let of_map = of_map.into_iter().filter(|(wanted, _)| *wanted && wants(|march| !march.mapless));
    all.chain(of_map.map(|(_, key)| key)).collect()
}

/// A 3D noise: its pass, its shader, its size.
struct Noise {
    pass: &'static str,
    file: &'static str,
    side: u32,
    levels: u32,
}

const SHAPE: Noise = Noise { pass: "bake_shape", file: "pass/bake_shape.wgsl", side: SHAPE_SIDE, levels: 5 };
const WORLEY: Noise = Noise { pass: "bake_worley", file: "pass/bake_worley.wgsl", side: WORLEY_SIDE, levels: 4 };
const OCTAVE: Noise = Noise { pass: "bake_octave", file: "pass/bake_octave.wgsl", side: OCTAVE_SIDE, levels: 4 };
const DETAIL: Noise = Noise { pass: "bake_detail", file: "pass/bake_detail.wgsl", side: DETAIL_SIDE, levels: 4 };

fn noise_3d(
    context: &Context<'_>,
    slot: &mut Option<Texture>,
    (wanted, kept): (bool, bool),
    noise: &Noise,
    jobs: &mut Vec<Job>,
) -> Result<(), GpuError> {
    if !wanted {
        *slot = slot.take().filter(|_| kept);
        return Ok(());
    }
    if slot.is_some() {
        return Ok(());
    }
    let texture = Texture::new_3d(context.gpu, noise.pass, [noise.side; 3], (noise.levels, FORMAT));
    let finest = texture.level_view(0);
    let bound = vec![("noise_out", wgpu::BindingResource::TextureView(&finest))];
    jobs.extend(context.banded(noise.pass, &ProgramKey::plain(noise.file), &bound, Extent::cube(noise.side))?);
    for level in 1..noise.levels {
        let (finer, coarser) = (texture.level_view(level - 1), texture.level_view(level));
        let bound = vec![
            ("finer", wgpu::BindingResource::TextureView(&finer)),
            ("noise_out", wgpu::BindingResource::TextureView(&coarser)),
        ];
        let key = ProgramKey::plain("pass/bake_mip.wgsl");
        jobs.push(context.whole("bake_mip", &key, &bound, Extent::cube(noise.side >> level))?);
    }
    *slot = Some(texture);
    Ok(())
}

fn sampler(gpu: &Gpu, label: &str, address: wgpu::AddressMode) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some(label),
        address_mode_u: address,
        address_mode_v: address,
        address_mode_w: address,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Nearest,
        ..Default::default()
    })
}
