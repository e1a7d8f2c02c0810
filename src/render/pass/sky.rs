//! The clear sky: six small tables from which every pass takes the light and the transparency of the air.
//!
//! After S. Hillaire, *A Scalable and Production Ready Sky and Atmosphere Rendering Technique*, EGSR 2020, with the moon,
//! the full azimuth, the ground in every order of scattering, and an exact horizon at every altitude of the eye.

use glam::Vec3;

use crate::gpu::{Gpu, GpuError, Job, ProgramCache, ProgramKey, Texture};
use crate::render::uniforms::air::{
    AirUniforms, DISC_RADIUS_DEG, MIE_ABSORPTION_PER_M, MIE_SCATTERING_PER_M, MIE_SPECTRUM, OZONE_PER_M,
    RAYLEIGH_PER_M, SUN_ILLUMINANCE_LX, TOP_OF_AIR_M, solar_tint,
};

const TRANSMITTANCE_SIZE: [u32; 2] = [256, 128];
const MULTISCATTER_SIZE: [u32; 2] = [64, 32];
const VIEW_SIZE: [u32; 2] = [256, 144];
const AERIAL_SIZE: [u32; 3] = [48, 40, 32];

/// Everything the clear sky depends on; equal inputs make equal tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyInputs {
    /// Radius of the planet in metres.
    pub planet_radius_m: f32,
    /// Amount of aerosol, 1 on a clear day; 0 to 20.
    pub haze: f32,
    /// Amount of air molecules, 1 on Earth; 0 to 10.
    pub molecules: f32,
    /// Amount of ozone, 1 on Earth; 0 to 10.
    pub ozone: f32,
    /// Diffuse albedo of the ground, 0 to 1.
    pub ground_albedo: Vec3,
    /// Unit vector towards the sun.
    pub towards_sun: Vec3,
    /// Unit vector towards the moon.
    pub towards_moon: Vec3,
    /// Illuminance of the sun above the air in working units (lux divided by the frame's `candela_per_unit`).
    pub sun_illuminance: Vec3,
    /// The same of the moon; zero leaves it out.
    pub moon_illuminance: Vec3,
    /// Half the angle the sun subtends, in radians.
    pub sun_angular_radius: f32,
    /// Half the angle the moon subtends, in radians.
    pub moon_angular_radius: f32,
    /// Radiance of airglow and starlight at the zenith in working units.
    pub night_glow: Vec3,
    /// Altitude of the eye in metres, −10 to 60,000.
    pub eye_altitude_m: f32,
    /// Altitude of the clouds in metres, for which ambient light is computed.
    pub cloud_altitude_m: f32,
    /// Which tables are made, and whether the air scatters moonlight.
    pub parts: SkyParts,
}

/// What of the sky a scene calls for beside its light in all directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkyParts {
    /// The table of the air before every distance.
    pub air: bool,
    /// The table of mean radiances.
    pub light: bool,
    /// Whether the air scatters moonlight.
    pub moonlit: bool,
}

impl SkyParts {
    /// Everything.
    pub const ALL: Self = Self { air: true, light: true, moonlit: true };
}

impl Default for SkyInputs {
    /// A clear noon on Earth without a moon; one working unit is 10,000 cd/m².
    fn default() -> Self {
        Self {
            planet_radius_m: 6_360_000.0,
            haze: 1.0,
            molecules: 1.0,
            ozone: 1.0,
            ground_albedo: Vec3::splat(0.2),
            towards_sun: Vec3::Y,
            towards_moon: Vec3::NEG_Y,
            sun_illuminance: solar_tint() * SUN_ILLUMINANCE_LX * 1e-4,
            moon_illuminance: Vec3::ZERO,
            sun_angular_radius: DISC_RADIUS_DEG.to_radians(),
            moon_angular_radius: DISC_RADIUS_DEG.to_radians(),
            night_glow: Vec3::ZERO,
            eye_altitude_m: 2.0,
            cloud_altitude_m: 1500.0,
            parts: SkyParts::ALL,
        }
    }
}

/// The eye's altitude in steps of a quarter of √metre, which moves the true horizon by less than 0.1 mrad a step.
fn altitude_step(altitude_m: f32) -> f32 {
    let root = (altitude_m.clamp(0.0, TOP_OF_AIR_M).sqrt() * 4.0).round() * 0.25;
    root * root
}

/// A unit vector, whatever was given.
fn unit(direction: Vec3) -> Vec3 {
    direction.normalize_or(Vec3::Y)
}

impl SkyInputs {
    /// The same with the eye's altitude on its step: what tables are baked for and compared by.
    fn quantised(&self) -> Self {
        Self {
            eye_altitude_m: altitude_step(self.eye_altitude_m),
            towards_sun: unit(self.towards_sun),
            towards_moon: unit(self.towards_moon),
            ..*self
        }
    }

    /// Azimuth of the light that the air shows most: the sun until it is 9° below the horizon or there is no moon.
    fn main_azimuth(&self) -> f32 {
        let sun_leads = self.towards_sun.y > -0.16 || self.moon_illuminance == Vec3::ZERO;
        let main = if sun_leads { self.towards_sun } else { self.towards_moon };
        if main.x == 0.0 && main.z == 0.0 { 0.0 } else { main.x.atan2(-main.z) }
    }

    /// The uniform that goes with the tables made from these inputs.
    pub fn uniforms(&self) -> AirUniforms {
        let inputs = self.quantised();
        AirUniforms {
            rayleigh_scattering_per_m: RAYLEIGH_PER_M * inputs.molecules.max(0.0),
            rayleigh_scale_height_m: 8000.0,
            ozone_absorption_per_m: OZONE_PER_M * inputs.ozone.max(0.0),
            mie_scattering_per_m: MIE_SPECTRUM * MIE_SCATTERING_PER_M * inputs.haze.max(0.0),
            sun_illuminance: inputs.sun_illuminance,
            mie_absorption_per_m: MIE_SPECTRUM * MIE_ABSORPTION_PER_M * inputs.haze.max(0.0),
            moon_illuminance: inputs.moon_illuminance,
            mie_scale_height_m: 1200.0,
            towards_sun: inputs.towards_sun,
            sun_angular_radius: inputs.sun_angular_radius,
            towards_moon: inputs.towards_moon,
            moon_angular_radius: inputs.moon_angular_radius,
            night_glow: inputs.night_glow,
            planet_radius_m: inputs.planet_radius_m,
            ground_albedo: inputs.ground_albedo.clamp(Vec3::ZERO, Vec3::ONE),
            top_altitude_m: TOP_OF_AIR_M,
            eye_altitude_m: inputs.eye_altitude_m,
            cloud_altitude_m: inputs.cloud_altitude_m.max(0.0),
            mie_anisotropy: 0.8,
            mie_broad_anisotropy: 0.35,
            mie_broad_share: 0.35,
            ozone_centre_m: 25_000.0,
            ozone_half_width_m: 15_000.0,
            main_azimuth: inputs.main_azimuth(),
        }
    }

    fn same_air(&self, other: &Self) -> bool {
        let key = |inputs: &Self| [inputs.planet_radius_m, inputs.haze, inputs.molecules, inputs.ozone];
        key(self) == key(other)
    }

    fn same_multiscatter(&self, other: &Self) -> bool {
        self.same_air(other)
            && self.ground_albedo == other.ground_albedo
            && self.sun_angular_radius == other.sun_angular_radius
    }

    fn same_view(&self, other: &Self) -> bool {
        let parts = SkyParts { moonlit: other.parts.moonlit, ..self.parts };
        *self == Self { cloud_altitude_m: self.cloud_altitude_m, parts, ..*other }
    }
}

/// The shaders of this pass, in the order they run.
pub fn programs(parts: SkyParts) -> Vec<ProgramKey> {
    BAKES.iter().filter(|bake| (bake.is_wanted)(parts)).map(|bake| bake.key(parts)).collect()
}

/// One table: its pass name, its shader, how many workgroups fill it.
struct Bake {
    pass: &'static str,
    file: &'static str,
    grid: [u32; 3],
    /// Whether what it was made from is unchanged.
    is_current: fn(&SkyInputs, &SkyInputs) -> bool,
    is_wanted: fn(SkyParts) -> bool,
    /// Whether it sums light of sun and moon.
    is_lit: bool,
}

impl Bake {
    fn key(&self, parts: SkyParts) -> ProgramKey {
        ProgramKey::plain(self.file).with_flags((self.is_lit && parts.moonlit).then_some("MOONLIT"))
    }
}

const fn tiles([width, height]: [u32; 2]) -> [u32; 3] {
    [width.div_ceil(8), height.div_ceil(8), 1]
}

/// Each table reads only those above it.
const BAKES: [Bake; 5] = [
    Bake {
        pass: "sky_transmittance",
        file: "pass/sky_transmittance.wgsl",
        grid: tiles(TRANSMITTANCE_SIZE),
        is_current: SkyInputs::same_air,
        is_wanted: |_| true,
        is_lit: false,
    },
    Bake {
        pass: "sky_multiscatter",
        file: "pass/sky_multiscatter.wgsl",
        grid: tiles(MULTISCATTER_SIZE),
        is_current: SkyInputs::same_multiscatter,
        is_wanted: |_| true,
        is_lit: false,
    },
    Bake {
        pass: "sky_view",
        file: "pass/sky_view.wgsl",
        grid: tiles(VIEW_SIZE),
        is_current: SkyInputs::same_view,
        is_wanted: |_| true,
        is_lit: true,
    },
    Bake {
        pass: "sky_aerial",
        file: "pass/sky_aerial.wgsl",
        grid: tiles([AERIAL_SIZE[0], AERIAL_SIZE[1]]),
        is_current: SkyInputs::same_view,
        is_wanted: |parts| parts.air,
        is_lit: true,
    },
    Bake {
        pass: "sky_ambient",
        file: "pass/sky_ambient.wgsl",
        grid: [1, 1, 1],
        is_current: |baked, wanted| {
            let parts = SkyParts { air: wanted.parts.air, ..baked.parts };
            SkyInputs { parts, ..*baked } == *wanted
        },
        is_wanted: |parts| parts.light,
        is_lit: true,
    },
];

/// The tables of the clear sky and what they were made from.
#[derive(Clone, Debug)]
pub struct SkyTables {
    /// Optical depth to the top of the air; 256×128.
    pub transmittance: Texture,
    /// Binary logarithm, shifted, of the multiply scattered radiance per unit illuminance; 64×32.
    pub multiscatter: Texture,
    /// Radiance of the sky in all directions; 256×144.
    pub view: Texture,
    /// Light and transmittance of the air in front of a distance, where they are called for; 48×40×32.
    pub aerial: Option<[Texture; 2]>,
    /// Four mean radiances, where they are called for; 4×1, see `shaders/pass/sky_ambient.wgsl`.
    pub ambient: Option<Texture>,
    air: wgpu::Buffer,
    linear_repeat: wgpu::Sampler,
    baked: Option<SkyInputs>,
}

impl SkyTables {
    /// Empty tables; [`Self::update`] fills them.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if the device cannot hold images of 256×144.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let half = wgpu::TextureFormat::Rgba16Float;
        Ok(Self {
            transmittance: Texture::new_2d(gpu, "sky_transmittance", TRANSMITTANCE_SIZE, half)?,
            multiscatter: Texture::new_2d(gpu, "sky_multiscatter", MULTISCATTER_SIZE, half)?,
            view: Texture::new_2d(gpu, "sky_view", VIEW_SIZE, half)?,
            aerial: None,
            ambient: None,
            air: gpu.uniform("air", bytemuck::bytes_of(&SkyInputs::default().uniforms())),
            linear_repeat: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("linear_repeat"),
                address_mode_u: wgpu::AddressMode::Repeat,
                address_mode_v: wgpu::AddressMode::Repeat,
                address_mode_w: wgpu::AddressMode::Repeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            baked: None,
        })
    }

    /// Appends the bakes that `inputs` call for: none when nothing changed, all five when the air did.
    ///
    /// The jobs have to run in order, and before the next call.
    ///
    /// # Errors
    /// [`GpuError`] if a shader does not compile.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        programs: &ProgramCache,
        inputs: &SkyInputs,
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        let wanted = inputs.quantised();
        if self.baked == Some(wanted) {
            return Ok(());
        }
        self.allocate(gpu, wanted.parts)?;
        // A new buffer, because jobs that were not submitted yet still hold the old one.
        self.air = gpu.uniform("air", bytemuck::bytes_of(&wanted.uniforms()));
        let mut bakes = Vec::new();
        for bake in BAKES.iter().filter(|bake| (bake.is_wanted)(wanted.parts)) {
            let was_wanted = self.baked.is_some_and(|baked| (bake.is_wanted)(baked.parts));
            if was_wanted && self.baked.is_some_and(|baked| (bake.is_current)(&baked, &wanted)) {
                continue;
            }
            let program = programs.get(&bake.key(wanted.parts))?;
            bakes.push(program.job(gpu, bake.pass, &self.bake_resources(), bake.grid)?);
        }
        jobs.append(&mut bakes);
        self.baked = Some(wanted);
        Ok(())
    }

    /// Holds what is called for and lets go of the rest.
    fn allocate(&mut self, gpu: &Gpu, parts: SkyParts) -> Result<(), GpuError> {
        let aerial = |label| Texture::new_3d(gpu, label, AERIAL_SIZE, (1, wgpu::TextureFormat::Rgba16Float));
        if !parts.air {
            self.aerial = None;
        } else if self.aerial.is_none() {
            self.aerial = Some(["sky_aerial_light", "sky_aerial_transmittance"].map(aerial));
        }
        if !parts.light {
            self.ambient = None;
        } else if self.ambient.is_none() {
            self.ambient = Some(Texture::new_2d(gpu, "sky_ambient", [4, 1], wgpu::TextureFormat::Rgba32Float)?);
        }
        Ok(())
    }

    /// The sky in all directions as it is seen from another altitude: its table, the uniform it is read with, and the
    /// job that makes it, which has to run after those of [`Self::update`].
    ///
    /// # Errors
    /// [`GpuError`] if a shader does not compile.
    pub fn seen_from(
        &self,
        gpu: &Gpu,
        programs: &ProgramCache,
        inputs: &SkyInputs,
        altitude_m: f32,
    ) -> Result<(Texture, wgpu::Buffer, Job), GpuError> {
        let inputs = SkyInputs { eye_altitude_m: altitude_m, ..*inputs };
        let air = gpu.uniform("cloud_air", bytemuck::bytes_of(&inputs.uniforms()));
        let view = Texture::new_2d(gpu, "cloud_sky_view", VIEW_SIZE, wgpu::TextureFormat::Rgba16Float)?;
        let mut resources = self.bake_resources();
        resources.retain(|(name, _)| !matches!(*name, "air" | "sky_view_out"));
        resources.push(("air", air.as_entire_binding()));
        resources.push(("sky_view_out", wgpu::BindingResource::TextureView(&view.view)));
        let moonlit = inputs.parts.moonlit.then_some("MOONLIT");
        let program = programs.get(&ProgramKey::plain("pass/sky_view.wgsl").with_flags(moonlit))?;
        let job = program.job(gpu, "sky_view", &resources, tiles(VIEW_SIZE))?;
        Ok((view, air, job))
    }

    /// Device memory in bytes.
    pub fn bytes(&self) -> u64 {
        let tables = [&self.transmittance, &self.multiscatter, &self.view];
        let optional = self.aerial.iter().flatten().chain(&self.ambient);
        tables.into_iter().chain(optional).map(Texture::bytes).sum()
    }

    /// The tables and the uniform `air` they go with, under the names that shaders give them.
    pub fn resources(&self) -> Vec<(&'static str, wgpu::BindingResource<'_>)> {
        let mut resources = vec![("air", self.air.as_entire_binding())];
        resources.extend(self.tables([
            "sky_transmittance",
            "sky_multiscatter",
            "sky_view",
            "sky_aerial_light",
            "sky_aerial_transmittance",
            "sky_ambient",
        ]));
        resources
    }

    /// The tables that exist, under names of one's own.
    fn tables<'a>(
        &'a self,
        names: [&'static str; 6],
    ) -> impl Iterator<Item = (&'static str, wgpu::BindingResource<'a>)> {
        let [light, transmittance] = match &self.aerial {
            Some([light, transmittance]) => [Some(light), Some(transmittance)],
            None => [None, None],
        };
        let always = [&self.transmittance, &self.multiscatter, &self.view].map(Some);
        let tables = always.into_iter().chain([light, transmittance, self.ambient.as_ref()]);
        names
            .into_iter()
            .zip(tables)
            .filter_map(|(name, table)| Some((name, wgpu::BindingResource::TextureView(&table?.view))))
    }

    /// What the bakes read and write. Each shader binds a table either as a texture or, as `…_out`, as storage.
    fn bake_resources(&self) -> Vec<(&'static str, wgpu::BindingResource<'_>)> {
        let mut resources = self.resources();
        resources.push(("linear_repeat", wgpu::BindingResource::Sampler(&self.linear_repeat)));
        resources.extend(self.tables([
            "sky_transmittance_out",
            "sky_multiscatter_out",
            "sky_view_out",
            "sky_aerial_light_out",
            "sky_aerial_transmittance_out",
            "sky_ambient_out",
        ]));
        resources
    }
}
