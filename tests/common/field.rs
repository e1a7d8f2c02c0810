//! Textures of the density field, baked by the production passes, and the sampler that reads them.

use std::sync::OnceLock;

use nephoscope::gpu::{Program, ProgramKey, Texture, job, readback};
use nephoscope::render::uniforms::other::{MapUniforms, ReliefUniforms};
use nephoscope::render::uniforms::scene::BandUniforms;

use wgpu::util::DeviceExt as _;

use super::{Case, gpu, programs};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Resources by name, as programs take them.
pub(crate) type Bound<'a> = Vec<(&'static str, wgpu::BindingResource<'a>)>;

/// A whole texture as a resource.
pub(crate) fn view_of(texture: &Texture) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&texture.view)
}

/// Runs a program over the invocations and waits for it; `band` covers all rows.
pub(crate) fn run(key: &ProgramKey, bound: &Bound<'_>, invocations: [u32; 3]) {
    let program: std::sync::Arc<Program> = programs().get(key).unwrap_or_else(|error| panic!("{key}: {error}"));
    let rows = if invocations[2] > 1 { invocations[2] } else { invocations[1] };
    let band = gpu().uniform("band", bytemuck::bytes_of(&BandUniforms { first_row: 0, rows, pad0: 0, pad1: 0 }));
    let mut bound = bound.clone();
    bound.push(("band", band.as_entire_binding()));
    let group = if invocations[2] > 1 { [4, 4, 4] } else { [8, 8, 1] };
    let grid = [0, 1, 2].map(|axis| invocations[axis].div_ceil(group[axis]));
    let job = program.job(gpu(), "test", &bound, grid).unwrap_or_else(|error| panic!("{key}: {error}"));
    job::run(gpu(), &[job]).unwrap_or_else(|error| panic!("{key}: {error}"));
}

/// A cube of noise, finest level only.
fn cube(file: &'static str, side: u32) -> Texture {
    let texture = Texture::new_3d(gpu(), file, [side; 3], (1, FORMAT));
    run(&ProgramKey::plain(file), &vec![("noise_out", view_of(&texture))], [side; 3]);
    texture
}

/// A weather map of the production's side.
pub(crate) fn weather_map(map: &MapUniforms) -> Texture {
    let texture = Texture::new_2d(gpu(), "weather map", [512; 2], FORMAT).expect("a map fits");
    let map = gpu().uniform("map", bytemuck::bytes_of(map));
    let bound = vec![("map", map.as_entire_binding()), ("map_out", view_of(&texture))];
    run(&ProgramKey::plain("pass/weather_map.wgsl"), &bound, [512, 512, 1]);
    texture
}

/// What the default map layer is made of.
pub(crate) fn map_uniforms(seed: u32) -> MapUniforms {
    MapUniforms {
        seed,
        large_cells: 8,
        small_share: 0.5,
        fray: 0.35,
        contrast: 0.35,
        cumulus: 1.0,
        stratus: 0.3,
        stratocumulus: 0.3,
        phase: 0.0,
        is_weather_texture: 0,
        pad1: 0.0,
        pad2: 0.0,
    }
}

/// Everything the density models read.
pub(crate) struct Field {
    pub(crate) shape: Texture,
    pub(crate) worley: Texture,
    pub(crate) octave: Texture,
    pub(crate) detail: Texture,
    pub(crate) curl: Texture,
    pub(crate) map: Texture,
    pub(crate) relief: Texture,
}

impl Field {
    /// The textures, baked once for all tests.
    pub(crate) fn baked() -> &'static Self {
        static FIELD: OnceLock<Field> = OnceLock::new();
        FIELD.get_or_init(|| {
            let flat = |label, side| Texture::new_2d(gpu(), label, [side; 2], FORMAT).expect("it fits");
            let (curl, relief) = (flat("curl", 128), flat("relief", 512));
            run(&ProgramKey::plain("pass/bake_curl.wgsl"), &vec![("noise_out", view_of(&curl))], [128, 128, 1]);
            let seed = ReliefUniforms { seed: 3, pad0: 0, pad1: 0, pad2: 0 };
            let seed = gpu().uniform("relief", bytemuck::bytes_of(&seed));
            let bound = vec![("relief", seed.as_entire_binding()), ("relief_out", view_of(&relief))];
            run(&ProgramKey::plain("pass/bake_terrain.wgsl"), &bound, [512, 512, 1]);
            Self {
                shape: cube("pass/bake_shape.wgsl", 128),
                worley: cube("pass/bake_worley.wgsl", 64),
                octave: cube("pass/bake_octave.wgsl", 64),
                detail: cube("pass/bake_detail.wgsl", 32),
                curl,
                map: weather_map(&map_uniforms(1)),
                relief,
            }
        })
    }

    /// All but the map, by the names shaders give them.
    pub(crate) fn noises(&self) -> Bound<'_> {
        vec![
            ("shape_noise", view_of(&self.shape)),
            ("worley_noise", view_of(&self.worley)),
            ("octave_noise", view_of(&self.octave)),
            ("detail_noise", view_of(&self.detail)),
            ("curl_noise", view_of(&self.curl)),
        ]
    }
}

/// The sampler that production reads the field with.
pub(crate) fn linear_repeat() -> &'static wgpu::Sampler {
    static SAMPLER: OnceLock<wgpu::Sampler> = OnceLock::new();
    SAMPLER.get_or_init(|| {
        gpu().device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("linear_repeat"),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            address_mode_w: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        })
    })
}

/// A four-channel texture with the same value everywhere.
pub(crate) fn plain(size: [u32; 2], rgba: [f32; 4]) -> Texture {
    image(size, &vec![rgba; (size[0] * size[1]) as usize])
}

/// A float texture of these texels.
pub(crate) fn image(size: [u32; 2], texels: &[[f32; 4]]) -> Texture {
    let texture = Texture::new_2d(gpu(), "image", size, FORMAT).expect("it fits");
    let halfs: Vec<[half::f16; 4]> = texels.iter().map(|texel| texel.map(half::f16::from_f32)).collect();
    write(&texture, bytemuck::cast_slice(&halfs), 8);
    texture
}

/// A one-channel float texture of these texels.
pub(crate) fn scalars(size: [u32; 2], texels: &[f32]) -> Texture {
    let texture = Texture::new_2d(gpu(), "scalars", size, wgpu::TextureFormat::R32Float).expect("it fits");
    write(&texture, bytemuck::cast_slice(texels), 4);
    texture
}

fn write(texture: &Texture, bytes: &[u8], texel: u32) {
    gpu().queue.write_texture(
        texture.texture.as_image_copy(),
        bytes,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(texture.size()[0] * texel), rows_per_image: None },
        texture.texture.size(),
    );
}

/// The texels of level 0.
pub(crate) fn read(texture: &Texture) -> Vec<[f32; 4]> {
    readback::rgba(gpu(), texture).expect("it can be read")
}

/// What a program of `shaders/test` makes of its cases, with what it reads besides.
pub(crate) fn evaluated(key: &ProgramKey, read: &Bound<'_>, cases: &[Case]) -> Vec<[f32; 4]> {
    let storage = |contents: &[u8], usage| {
        gpu().device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("cases"), contents, usage })
    };
    let input = storage(bytemuck::cast_slice(cases), wgpu::BufferUsages::STORAGE);
    let results = vec![0_u8; cases.len() * 16];
    let output = storage(&results, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let mut bound = read.clone();
    bound.extend([("cases", input.as_entire_binding()), ("results", output.as_entire_binding())]);
    run(key, &bound, [512, u32::try_from(cases.len().div_ceil(512)).expect("few cases"), 1]);
    let bytes = readback::buffer(gpu(), &output).expect("the results can be read");
    bytes.chunks_exact(16).map(bytemuck::pod_read_unaligned).collect()
}
