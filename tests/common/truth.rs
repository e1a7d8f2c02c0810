//! Clouds of the tests' own, sent through the production reference integrators: `pass/converged.wgsl` and
//! `pass/path_trace.wgsl`, with no air and no ground.

use std::sync::OnceLock;

use bytemuck::Zeroable as _;
use nephoscope::gpu::{ProgramKey, Texture, readback};
use nephoscope::render::uniforms::other::TruthUniforms;

use super::field::{Bound, Field, linear_repeat, plain, run, scalars, view_of};
use super::gpu;
use super::slab::{LIGHT_FLAGS, March, no_air};

/// Pixels along each side. All rays of one run take the same direction.
pub(crate) const SIDE: u32 = 32;
const NAMES: [(&str, u32); 4] =
    [("bound_of_32", 32), ("bound_of_64", 64), ("bound_of_128", 128), ("bound_of_256", 256)];

/// Bounds of the baked map, made by the production pass.
pub(crate) fn baked_bounds() -> &'static [Texture; 4] {
    static BOUNDS: OnceLock<[Texture; 4]> = OnceLock::new();
    BOUNDS.get_or_init(|| {
        NAMES.map(|(_, cells)| {
            let bound = scalars([cells; 2], &vec![0.0; (cells * cells) as usize]);
            let bindings = vec![("weather_map", view_of(&Field::baked().map)), ("bound_out", view_of(&bound))];
            run(&ProgramKey::plain("pass/weather_bound.wgsl"), &bindings, [cells, cells, 1]);
            bound
        })
    })
}

/// Bounds that know nothing: the greatest field anywhere.
pub(crate) fn blind_bounds() -> [Texture; 4] {
    bounds_of(1.0)
}

/// Bounds that take the map's field for one value everywhere.
pub(crate) fn bounds_of(field: f32) -> [Texture; 4] {
    NAMES.map(|(_, cells)| scalars([cells; 2], &vec![field; (cells * cells) as usize]))
}

/// The bounds by the names that shaders give them.
pub(crate) fn named(bounds: &[Texture; 4]) -> Bound<'_> {
    NAMES.iter().zip(bounds).map(|((name, _), texture)| (*name, view_of(texture))).collect()
}

/// Mean and its standard error over all pixels, of light (one channel) and of opacity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mean {
    pub(crate) light: f64,
    pub(crate) light_error: f64,
    pub(crate) opacity: f64,
    pub(crate) opacity_error: f64,
}

/// What the shader counted: rays under way, work, places over the majorant (light steps of a march), paths cut short.
pub(crate) type Counters = [u32; 4];

impl March {
    /// Everything both integrators read, and the buffers they keep.
    fn with_inputs<R>(&self, truth: &TruthUniforms, bounds: &[Texture; 4], go: impl FnOnce(&Bound<'_>) -> R) -> R {
        let view = gpu().uniform("view", bytemuck::bytes_of(&self.view(SIDE)));
        let scene = gpu().uniform("scene", bytemuck::bytes_of(&self.scene));
        let air = gpu().uniform("air", bytemuck::bytes_of(&no_air()));
        let truth = gpu().uniform("truth", bytemuck::bytes_of(truth));
        let (clear, ambient) = (plain([4, 4], [0.0; 4]), plain([4, 1], [1.0; 4]));
        // The same radiance from all around; the scene's ambient tint says how much of it counts.
        let sky = plain([256, 144], [1.0; 4]);
        let body_of_one = plain([4, 4], [1.0, 0.0, 0.0, 0.5]);
        let map = if self.mapped { &Field::baked().map } else { &body_of_one };
        let mut bound = vec![
            ("view", view.as_entire_binding()),
            ("scene", scene.as_entire_binding()),
            ("air", air.as_entire_binding()),
            ("cloud_air", air.as_entire_binding()),
            ("truth", truth.as_entire_binding()),
            ("sky_transmittance", view_of(&clear)),
            ("sky_ambient", view_of(&ambient)),
            ("cloud_sky_view", view_of(&sky)),
            ("weather_map", view_of(map)),
            ("linear_repeat", wgpu::BindingResource::Sampler(linear_repeat())),
        ];
        if self.mapped {
            bound.extend(Field::baked().noises());
        }
        bound.extend(named(bounds));
        go(&bound)
    }

    fn key(&self, file: &'static str) -> ProgramKey {
        ProgramKey::plain(file)
            .with_flags(self.flags.iter().copied().chain(LIGHT_FLAGS))
            .with_constant("DOMAIN", self.domain)
            .with_constant("LAYERS", self.layers)
    }

    /// Runs a program until no ray is under way; returns the state's bytes, the sums' bytes, and what was counted.
    fn until_done(&self, key: &ProgramKey, bound: &Bound<'_>, names: [&'static str; 2]) -> ([Vec<u8>; 2], Counters) {
        let storage = |size| {
            gpu().device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("truth"),
                size,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let pixels = u64::from(SIDE * SIDE);
        let (state, sums, counters) = (storage(pixels * 128), storage(pixels * 32), storage(16));
        let mut bound = bound.clone();
        bound.push((names[0], state.as_entire_binding()));
        bound.push((names[1], sums.as_entire_binding()));
        bound.push(("counters", counters.as_entire_binding()));
        let mut counted: Counters = [0; 4];
        for _ in 0..5000 {
            gpu().queue.write_buffer(&counters, 0, &[0; 16]);
            run(key, &bound, [SIDE, SIDE, 1]);
            let now: Counters =
                bytemuck::pod_read_unaligned(&readback::buffer(gpu(), &counters).expect("counters can be read"));
            for (sum, count) in counted.iter_mut().zip(now) {
                *sum += count;
            }
            if now[0] == 0 {
                let read = |buffer| readback::buffer(gpu(), buffer).expect("the buffer can be read");
                return ([read(&state), read(&sums)], counted);
            }
        }
        panic!("rays are still under way: {counted:?}");
    }

    /// The converged march: light and transmittance of each ray, and what was counted over all.
    pub(crate) fn converged(&self, view_step_m: f32, light_steps: u32, per_dispatch: u32) -> (Vec<[f32; 4]>, Counters) {
        let truth = TruthUniforms {
            per_dispatch,
            light_steps,
            view_step_m,
            furthest_m: 500_000.0,
            work_per_dispatch: u32::MAX,
            ..TruthUniforms::zeroed()
        };
        let key = self.key("pass/converged.wgsl").with_constant("OCTAVES", 0);
        let ([state, _], counted) =
            self.with_inputs(&truth, &blind_bounds(), |bound| self.until_done(&key, bound, ["marched_rays", "unused"]));
        let rays = state.chunks_exact(32).take((SIDE * SIDE) as usize).map(bytemuck::pod_read_unaligned::<[f32; 8]>);
        (rays.map(|ray| [ray[0], ray[1], ray[2], (-ray[3]).exp()]).collect(), counted)
    }

    /// Paths: the mean over all pixels, which look in the same direction.
    pub(crate) fn traced(&self, samples: u32, scattering_limit: u32, bounds: &[Texture; 4]) -> (Mean, Counters) {
        let truth = TruthUniforms {
            per_dispatch: 700,
            samples,
            scattering_limit,
            seed: 11,
            furthest_m: 500_000.0,
            work_per_dispatch: u32::MAX,
            ..TruthUniforms::zeroed()
        };
        let key = self.key("pass/path_trace.wgsl");
        let ([_, sums], counted) =
            self.with_inputs(&truth, bounds, |bound| self.until_done(&key, bound, ["paths", "path_sums"]));
        let count = f64::from(samples);
        let (mut light, mut opacity) = (Vec::new(), Vec::new());
        for pixel in sums.chunks_exact(32) {
            let pixel: [f32; 8] = bytemuck::pod_read_unaligned(pixel);
            light.push(f64::from(pixel[0]) / count);
            opacity.push(f64::from(pixel[3]) / count);
        }
        let ((light, light_error), (opacity, opacity_error)) = (mean_and_error(&light), mean_and_error(&opacity));
        (Mean { light, light_error, opacity, opacity_error }, counted)
    }
}

/// Mean of independent values and its standard error.
pub(crate) fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}
