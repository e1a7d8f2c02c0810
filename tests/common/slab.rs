//! Clouds of the tests' own, sent through the production march: `pass/march.wgsl` with no sky, no air and no ground.

use bytemuck::Zeroable as _;
use glam::{UVec2, Vec2, Vec3, Vec4};
use nephoscope::gpu::{ProgramKey, Texture, readback};
use nephoscope::render::uniforms::air::AirUniforms;
use nephoscope::render::uniforms::scene::{LayerUniforms, SceneUniforms, ViewUniforms};

use super::field::{Field, linear_repeat, plain, run, scalars, view_of};
use super::gpu;

pub(crate) const SHELL: u32 = 0;
pub(crate) const FLAT: u32 = 1;
pub(crate) const BOX: u32 = 2;
pub(crate) const PROFILE: u32 = 0;
pub(crate) const THESIS: u32 = 1;
pub(crate) const UNIFORM: u32 = 2;
pub(crate) const PRODUCT: u32 = 5;
pub(crate) const RADIUS_M: f32 = 6.36e6;
/// All rays of one march take the same direction; each has a jitter of its own.
const SIDE: u32 = 8;

/// One march.
pub(crate) struct March {
    pub(crate) scene: SceneUniforms,
    pub(crate) eye: Vec3,
    pub(crate) dir: Vec3,
    /// Tangent of half the angle that the picture spans; at 0 all rays take the same direction.
    pub(crate) spread: f32,
    /// Whether each ray has its own offset; all are read in the middle of their cells otherwise.
    pub(crate) jittered: bool,
    pub(crate) domain: u32,
    pub(crate) layers: u32,
    pub(crate) flags: Vec<&'static str>,
    /// The field's own map, or one of body 1.
    pub(crate) mapped: bool,
}

/// What the rays see: light and transmittance, and distance.
pub(crate) struct Seen {
    pub(crate) rgba: Vec<[f32; 4]>,
    pub(crate) distance_m: Vec<f32>,
}

/// A layer of the uniform model that fills base to top with extinction.
pub(crate) fn uniform_layer(base_m: f32, top_m: f32, extinction_per_m: f32) -> LayerUniforms {
    LayerUniforms {
        // The map is the same everywhere, so its bound holds however far.
        lean: Vec4::new(0.0, 0.0, 2000.0, 0.0),
        base_m,
        per_thickness: 1.0 / (top_m - base_m),
        body_bias: 1.0,
        body_bias_beyond: 1.0,
        density_scale: 1.0,
        extinction_per_m,
        albedo: 1.0,
        shadow_extinction_scale: 1.0,
        sun_gain: 1.0,
        ambient_gain: 1.0,
        step_scale: 1.0,
        light_steps_share: 1.0,
        model: UNIFORM,
        ..LayerUniforms::zeroed()
    }
}

/// A layer of a noisy model with about the program's defaults.
pub(crate) fn noisy_layer(model: u32, base_m: f32, top_m: f32, coverage: f32) -> LayerUniforms {
    let softness = 0.26;
    LayerUniforms {
        map_from_world: Vec4::new(0.1, 0.2, 1.0 / 24_000.0, 0.0),
        shape_from_world: Vec4::new(0.3, 0.0, 0.7, 1.0 / 2800.0),
        detail_from_world: Vec4::new(0.0, 0.5, 0.0, 1.0 / 600.0),
        curl_from_world: Vec4::new(0.0, 0.0, 1.0 / 1500.0, 0.1),
        lean: Vec4::new(300.0, 0.0, 150.0, 0.0),
        base_ramp: 0.06,
        top_variation: 0.6,
        body_scale: 1.0 / softness,
        body_bias: -(1.0 - coverage * (1.0 + softness)) / softness,
        anvil: 0.2,
        shape_strength: 1.0,
        detail_strength: 0.9,
        wispiness: 0.2,
        sharpness: 1.0,
        model,
        ..uniform_layer(base_m, top_m, 0.04)
    }
}

/// The same with octaves of Perlin and Voronoi noise, whose cells are 900 m wide.
pub(crate) fn of_octaves(layer: LayerUniforms) -> LayerUniforms {
    let from_world = Vec4::new(0.0, 0.0, 0.0, 1.0 / (8.0 * 900.0));
    LayerUniforms {
        perlin_from_world: from_world,
        perlin_octaves: Vec4::new(3.0, 0.5, 2.0, 0.3),
        voronoi_from_world: from_world,
        voronoi_octaves: Vec4::new(3.0, 0.4, 2.0, 0.25),
        product_gain: Vec4::new(4.0, 0.0, 0.0, 0.0),
        ..layer
    }
}

/// The uniform of air that is not there.
pub(crate) fn no_air() -> AirUniforms {
    AirUniforms { planet_radius_m: RADIUS_M, top_altitude_m: 1e5, sun_angular_radius: 0.0047, ..AirUniforms::zeroed() }
}

impl March {
    /// A flat homogeneous slab from the ground up, seen along `dir` from its edge, without light.
    pub(crate) fn slab(thickness_m: f32, extinction_per_m: f32, dir: Vec3) -> Self {
        let mut scene = SceneUniforms {
            towards_light: Vec3::Y,
            planet_radius_m: RADIUS_M,
            highest_m: thickness_m,
            ambient_base_share: 1.0,
            octave_extinction: 1.0,
            octave_energy: 1.0,
            octave_anisotropy: 1.0,
            view_steps: 20_000,
            step_m: 10.0,
            // Equal steps: none is cut short by its optical depth.
            step_depth: 1e30,
            empty_stride: 1.0,
            light_steps: 8,
            light_reach_m: 1e6,
            opaque_sun_depth: 600.0,
            detail_distance_m: 1e6,
            max_distance_m: 1e6,
            ..SceneUniforms::zeroed()
        };
        scene.layers[0] = uniform_layer(0.0, thickness_m, extinction_per_m);
        let eye = if dir.y < 0.0 { Vec3::Y * thickness_m } else { Vec3::ZERO };
        Self {
            scene,
            eye,
            dir,
            spread: 0.0,
            jittered: false,
            domain: FLAT,
            layers: 1,
            flags: vec!["UNIFORM"],
            mapped: false,
        }
    }

    /// Light from all around that every sample sends on whole.
    pub(crate) fn in_a_furnace(mut self) -> Self {
        self.scene.ambient_top = Vec3::ONE;
        self.scene.ambient_bottom = Vec3::ZERO;
        self.scene.ambient_base_share = 1.0;
        self.scene.ambient_occlusion = 0.0;
        self
    }

    pub(crate) fn view(&self, side: u32) -> ViewUniforms {
        let mut view = ViewUniforms::zeroed();
        view.camera.eye = self.eye;
        view.camera.forward = self.dir;
        let right = self.dir.cross(Vec3::Y).normalize_or(Vec3::X);
        view.camera.right = right * self.spread;
        view.camera.up = right.cross(self.dir) * self.spread;
        view.size = UVec2::splat(side);
        view.ray_count = view.size;
        view.update_block = UVec2::ONE;
        view.jitter = if self.jittered { Vec2::new(1.0, 0.0) } else { Vec2::new(0.0, 0.5) };
        view
    }

    /// Runs it.
    pub(crate) fn run(&self) -> Seen {
        let uniform = |label, bytes| gpu().uniform(label, bytes);
        let (view, scene) = (self.view(SIDE), self.scene);
        let (view, scene) = (uniform("view", bytemuck::bytes_of(&view)), uniform("scene", bytemuck::bytes_of(&scene)));
        let air = uniform("air", bytemuck::bytes_of(&no_air()));
        let offsets: Vec<f32> = (0..SIDE * SIDE).map(|at| (at as f32 + 0.5) / (SIDE * SIDE) as f32).collect();
        let blue_noise = scalars([SIDE; 2], &offsets);
        // No air: an optical depth of 0 everywhere. Ambient light of radiance 1.
        let (clear, ambient) = (plain([4, 4], [0.0; 4]), plain([4, 1], [1.0; 4]));
        let body_of_one = plain([4, 4], [1.0, 0.0, 0.0, 0.5]);
        let light = Texture::new_2d(gpu(), "light", [SIDE; 2], wgpu::TextureFormat::Rgba32Float).expect("it fits");
        let distance = scalars([SIDE; 2], &[0.0; (SIDE * SIDE) as usize]);
        let map = if self.mapped { &Field::baked().map } else { &body_of_one };
        let mut bound = vec![
            ("view", view.as_entire_binding()),
            ("scene", scene.as_entire_binding()),
            ("air", air.as_entire_binding()),
            ("blue_noise", view_of(&blue_noise)),
            ("sky_transmittance", view_of(&clear)),
            ("sky_ambient", view_of(&ambient)),
            ("weather_map", view_of(map)),
            ("linear_repeat", wgpu::BindingResource::Sampler(linear_repeat())),
            ("cloud_out", view_of(&light)),
            ("distance_out", view_of(&distance)),
        ];
        if self.mapped {
            bound.extend(Field::baked().noises());
        }
        let key = ProgramKey::plain("pass/march.wgsl")
            .with_flags(self.flags.iter().copied().chain(["FLOAT", "DISTANCE"]).chain(LIGHT_FLAGS))
            .with_constant("DOMAIN", self.domain)
            .with_constant("LAYERS", self.layers)
            .with_constant("OCTAVES", 0);
        run(&key, &bound, [SIDE, SIDE, 1]);
        Seen {
            rgba: readback::rgba(gpu(), &light).expect("it can be read"),
            distance_m: readback::scalars(gpu(), &distance).expect("it can be read"),
        }
    }
}

/// All light there is, scattered by any phase function.
pub(crate) const LIGHT_FLAGS: [&str; 7] =
    ["LIT", "AMBIENT", "PHASE_ONE_LOBE", "PHASE_TWO_LOBES", "PHASE_CORNETTE_SHANKS", "PHASE_SCHLICK", "PHASE_RAYLEIGH"];

/// Closed form S9 of a slab cut into equal cells that are read in their middle, for isotropic light of irradiance 4π.
pub(crate) fn slab_light(tau: f64, cells: u32, (mu, mu0): (f64, f64), up: bool) -> f64 {
    let count = f64::from(cells);
    let (x, y) = (tau / (mu * count), tau / (mu0 * count));
    // Looking up, the light's way through the slab shortens along the ray.
    let (rate, first) = if up { (x - y, tau / mu0 - y / 2.0) } else { (x + y, y / 2.0) };
    let sum = if rate.abs() < 1e-12 { count } else { (-count * rate).exp_m1() / (-rate).exp_m1() };
    -(-x).exp_m1() * (-first).exp() * sum
}
