//! What the clear air is made of and what lights it, as shaders take it.

use glam::{Vec3, dvec3};

use crate::gpu_struct;

/// Rayleigh scattering at sea level in the bands of linear Rec.709, 1/m.
///
/// The spectrum of Bruneton (2017), 1.24062e-6 λ⁻⁴ with λ in µm, weighted by sunlight and the Rec.709 matching functions
/// (negative lobes included), and fitted over 1 to 25 air masses. The usual triple for 680, 550 and 440 nm is the same spectrum at three single wavelengths,
/// which are not those of the primaries: it makes noon a fifth too saturated.
pub const RAYLEIGH_PER_M: Vec3 = Vec3::new(7.15e-6, 14.1e-6, 32.5e-6);
/// Scattering of clear-weather aerosol at sea level and 550 nm, 1/m; `haze` multiplies it.
pub const MIE_SCATTERING_PER_M: f32 = 3.996e-6;
/// Absorption of clear-weather aerosol at sea level and 550 nm, 1/m; `haze` multiplies it.
pub const MIE_ABSORPTION_PER_M: f32 = 4.4e-7;
/// Absorption at the centre of the ozone layer in the bands of linear Rec.709, 1/m; `ozone` multiplies it.
///
/// The cross-sections of Bruneton (2017) for 300 Dobson units, weighted as [`RAYLEIGH_PER_M`]. Ozone absorbs most about
/// 600 nm, inside the red band; sampled at 680 nm the red comes out four times too low and twilight turns purple.
pub const OZONE_PER_M: Vec3 = Vec3::new(2.465e-6, 1.785e-6, 0.02e-6);
/// Altitude at which the air ends, in metres.
pub const TOP_OF_AIR_M: f32 = 100_000.0;
/// Aerosol in the three bands over its value at 550 nm: λ to the power −0.8 (Ångström's exponent of clear continental air).
pub const MIE_SPECTRUM: Vec3 = Vec3::new(0.88, 1.01, 1.19);
/// Illuminance of the sun above the air, in lux.
pub const SUN_ILLUMINANCE_LX: f32 = 128_000.0;
/// Half the angle that the sun, or the moon, subtends, in degrees.
pub const DISC_RADIUS_DEG: f32 = 0.2667;

/// The colour of sunlight above the air in linear Rec.709, of luminance 1: half way from the true one, (1, 0.89, 0.87) for
/// D65 as white, to a camera balanced for daylight; a neutral sun leaves a green cast over low suns.
pub fn solar_tint() -> Vec3 {
    let tint = dvec3(1.0, 0.955, 0.92);
    (tint / tint.dot(dvec3(0.2126, 0.7152, 0.0722))).as_vec3()
}

gpu_struct! {
    /// Constants of the air, the lights, and the altitudes the tables are made for. Lengths in metres, angles in radians,
    /// illuminances and radiances in working units.
    pub struct AirUniforms {
        /// Rayleigh scattering at sea level, 1/m.
        pub rayleigh_scattering_per_m: Vec3,
        /// Height over which Rayleigh scattering falls to 1/e.
        pub rayleigh_scale_height_m: f32,
        /// Absorption at the centre of the ozone layer, 1/m.
        pub ozone_absorption_per_m: Vec3,
        /// Altitude that the view and aerial tables are seen from.
        pub eye_altitude_m: f32,
        /// Aerosol scattering at sea level, 1/m.
        pub mie_scattering_per_m: Vec3,
        /// Altitude that the first two ambient means are taken at.
        pub cloud_altitude_m: f32,
        /// Aerosol absorption at sea level, 1/m.
        pub mie_absorption_per_m: Vec3,
        /// Azimuth, clockwise from north, of the light that matters most.
        pub main_azimuth: f32,
        /// Illuminance of the sun above the air on a surface facing it.
        pub sun_illuminance: Vec3,
        /// Share of the aerosol's broad lobe, 0 to 1.
        pub mie_broad_share: f32,
        /// The same of the moon.
        pub moon_illuminance: Vec3,
        /// Height over which aerosol falls to 1/e.
        pub mie_scale_height_m: f32,
        /// Unit vector.
        pub towards_sun: Vec3,
        /// Half the angle the sun subtends.
        pub sun_angular_radius: f32,
        /// Unit vector.
        pub towards_moon: Vec3,
        /// Half the angle the moon subtends.
        pub moon_angular_radius: f32,
        /// Radiance of airglow and starlight at the zenith, above the air.
        pub night_glow: Vec3,
        /// Radius of the planet at sea level.
        pub planet_radius_m: f32,
        /// Diffuse albedo of the ground, 0 to 1.
        pub ground_albedo: Vec3,
        /// Altitude at which the air ends.
        pub top_altitude_m: f32,
        /// Asymmetry of the aerosol's narrow lobe (Cornette and Shanks).
        pub mie_anisotropy: f32,
        /// Asymmetry of its broad lobe (Henyey and Greenstein).
        pub mie_broad_anisotropy: f32,
        /// Altitude of most ozone.
        pub ozone_centre_m: f32,
        /// Height above and below that at which ozone ends.
        pub ozone_half_width_m: f32,
    }
}
