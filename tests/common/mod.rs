//! What the GPU tests share: the software device, clouds of their own for the march, and a runner for `shaders/test/eval_*.wgsl`.

pub(crate) mod field;
pub(crate) mod sky;
pub(crate) mod slab;
pub(crate) mod truth;

use std::collections::BTreeSet;
use std::sync::OnceLock;

use glam::{DVec3, UVec3, Vec3};
use nephoscope::gpu::{Gpu, ProgramCache};
use nephoscope::reference::random::{pcg3d, unit_from_bits};
use nephoscope::render::shaders::TABLE;
use nephoscope::shader::{compose, validate};
use wgpu::util::DeviceExt as _;

/// The software device, opened once. Fails loudly where llvmpipe is missing: a skipped test proves nothing.
pub(crate) fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::software().expect("llvmpipe is installed (mesa-vulkan-drivers)"))
}

/// The programs of tests that run a pass by itself, compiled once for all of them.
pub(crate) fn programs() -> &'static ProgramCache {
    static PROGRAMS: OnceLock<ProgramCache> = OnceLock::new();
    PROGRAMS.get_or_init(|| ProgramCache::new(gpu(), TABLE))
}

/// Whether to try all there is, as `scripts/nightly.sh` does, where a part is enough for every change.
pub(crate) fn thorough() -> bool {
    std::env::var_os("NEPHOSCOPE_THOROUGH").is_some()
}

/// One evaluation: four vectors of raw bits, as `Case` in `shaders/test/eval_io.wgsl`.
pub(crate) type Case = [[u32; 4]; 4];

/// Three floats as the first three components of a case's vector.
pub(crate) fn bits3(v: Vec3) -> [u32; 4] {
    [v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), 0]
}

/// Four floats as a case's vector.
pub(crate) fn bits4(v: [f32; 4]) -> [u32; 4] {
    v.map(f32::to_bits)
}

/// Runs `entry_point` of `shaders/test/eval_<file>.wgsl` over the cases; answers with raw bits.
pub(crate) fn eval_bits(file: &str, entry_point: &str, cases: &[Case]) -> Vec<[u32; 4]> {
    eval_with(file, entry_point, cases, &[])
}

/// As [`eval_bits`]; `more`, if there is any, is the storage buffer at binding 2.
pub(crate) fn eval_with(file: &str, entry_point: &str, cases: &[Case], more: &[u8]) -> Vec<[u32; 4]> {
    let Gpu { device, queue, .. } = gpu();
    let is_choice = |flag: &&str| flag.starts_with("PHASE_") || *flag == "GRADED";
    let flags: BTreeSet<&'static str> = TABLE.flags.iter().copied().filter(is_choice).collect();
    let source =
        compose(&format!("test/eval_{file}.wgsl"), &flags, TABLE.flags, TABLE.structs).expect("the shader composes");
    if let Err(error) = validate(&source) {
        panic!("{error}");
    }
    let source = wgpu::ShaderSource::Wgsl(source.code.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(file), source });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: None,
        module: &module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let input = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("cases"),
        contents: bytemuck::cast_slice(cases),
        usage: wgpu::BufferUsages::STORAGE,
    });
    let more = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("more"),
        contents: more,
        usage: wgpu::BufferUsages::STORAGE,
    });
    let size = (cases.len() * size_of::<[u32; 4]>()) as u64;
    let buffer = |label, usage| {
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
    };
    let output = buffer("results", wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let readback = buffer("readback", wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let mut entries = vec![
        wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
        wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
    ];
    if more.size() > 0 {
        entries.push(wgpu::BindGroupEntry { binding: 2, resource: more.as_entire_binding() });
    }
    let layout = pipeline.get_bind_group_layout(0);
    let descriptor = wgpu::BindGroupDescriptor { label: Some("eval"), layout: &layout, entries: &entries };
    let bindings = device.create_bind_group(&descriptor);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bindings, &[]);
        pass.dispatch_workgroups(u32::try_from(cases.len().div_ceil(64)).expect("few cases"), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &readback, 0, size);
    queue.submit([encoder.finish()]);
    readback.map_async(wgpu::MapMode::Read, .., |result| result.expect("the results map"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
    let view = readback.get_mapped_range(..).expect("the results are mapped");
    bytemuck::cast_slice(&view).to_vec()
}

/// As [`eval_bits`], with floats.
pub(crate) fn eval(file: &str, entry_point: &str, cases: &[Case]) -> Vec<[f32; 4]> {
    eval_bits(file, entry_point, cases).into_iter().map(|bits| bits.map(f32::from_bits)).collect()
}

/// A repeatable sequence of random numbers for test inputs.
pub(crate) struct Random(u32, u32);

impl Random {
    pub(crate) fn new(seed: u32) -> Self {
        Self(seed, 0)
    }

    pub(crate) fn bits(&mut self) -> u32 {
        self.1 += 1;
        pcg3d(UVec3::new(self.1, self.0, 17)).x
    }

    /// Uniform between `low` and `high`.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * unit_from_bits(self.bits())
    }

    /// One of the values.
    pub(crate) fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.bits() as usize % values.len()]
    }

    /// A unit vector, uniform over the sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        let y = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, std::f32::consts::TAU).sin_cos();
        let ring = (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(ring * cos, y, ring * sin).normalize()
    }
}

/// The direction that an f32 vector names, as a unit vector in f64.
pub(crate) fn exact_direction(dir: Vec3) -> DVec3 {
    dir.as_dvec3().normalize()
}
