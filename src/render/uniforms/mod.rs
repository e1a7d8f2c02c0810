//! What shaders are told, and the only place where units are converted.
#![allow(
    clippy::cast_possible_truncation,
    reason = "places and times are kept in f64 up to here, and shaders compute in f32"
)]

pub mod air;
mod camera;
mod clouds;
mod ground;
mod living;
pub mod other;
pub mod scene;
mod shapes;

pub(super) use camera::{Eye, camera_uniforms};
pub use clouds::map_place;
pub(crate) use clouds::{density_rounds, wind_mps};
pub(super) use clouds::{edge_index, field_uniforms, plain_sky, scene_uniforms};
pub(super) use ground::ground_uniforms;
pub use living::automaton_uniforms;
pub(super) use shapes::shapes_uniforms;

use super::pass::sky::{SkyInputs, SkyParts};
use crate::plan::{Lighting, SkyPlan};
use crate::scene::Scene;
use other::{DisplayUniforms, GlowUniforms, ShaftUniforms};

/// The key light as artists' effects have it, in working units. Low light crosses more haze and is redder; the sky tables know by
/// how much, this only follows the trend.
fn warm_key(lighting: &Lighting) -> glam::Vec3 {
    let low = (1.0 - lighting.towards_key.y.clamp(0.0, 0.5) * 2.0).powi(2);
    lighting.key_lux / lighting.candela_per_unit * glam::Vec3::new(1.0, 1.0 - 0.35 * low, 1.0 - 0.65 * low)
}

/// The artists' glow: light of a white wall that the key light falls on, about it.
pub(super) fn glow_uniforms(scene: &Scene, lighting: &Lighting) -> GlowUniforms {
    let scattering = &scene.scattering;
    let white = warm_key(lighting) / std::f32::consts::PI;
    GlowUniforms {
        towards_light: lighting.towards_key,
        range: scattering.glow_deg.to_radians(),
        radiance: white * scattering.glow * lighting.streak_share(),
        width: scattering.glow_width,
    }
}

/// What the sky tables are made from.
pub(super) fn sky_inputs(scene: &Scene, plan: SkyPlan, lighting: &Lighting) -> SkyInputs {
    let per_unit = 1.0 / lighting.candela_per_unit;
    let clouds = scene.visible_layers().next();
    let glow = glam::Vec3::new(0.75, 0.95, 1.3) * scene.moon.night_glow;
    SkyInputs {
        planet_radius_m: scene.domain.planet_radius_m,
        haze: scene.air.haze,
        molecules: scene.air.molecules,
        ozone: scene.air.ozone,
        ground_albedo: scene.ground.albedo.vec(),
        towards_sun: lighting.towards_sun,
        towards_moon: lighting.towards_moon,
        sun_illuminance: lighting.sun_lux * per_unit,
        moon_illuminance: lighting.moon_lux * per_unit,
        sun_angular_radius: if scene.sun.disc { scene.sun.radius_deg.to_radians() } else { 0.0 },
        moon_angular_radius: scene.moon.radius_deg.to_radians(),
        night_glow: glow * per_unit,
        eye_altitude_m: scene.camera.height_m,
        cloud_altitude_m: clouds.map_or(1500.0, |layer| layer.base_m),
        parts: SkyParts { air: plan.air, light: plan.light, moonlit: plan.moonlit },
    }
}

/// Exposure as photographers count it: EV 0 renders 1.2 cd/m² at the sensor's full scale.
pub(super) fn display_uniforms(scene: &Scene, lighting: &Lighting) -> DisplayUniforms {
    let full_scale = 1.2 * f64::from(scene.display.exposure_ev).exp2();
    let exposure = (f64::from(lighting.candela_per_unit) / full_scale) as f32;
    DisplayUniforms {
        exposure: white_gains(scene.display.white_kelvin) * exposure,
        contrast: scene.display.contrast,
        saturation: scene.display.saturation,
        pad0: 0.0,
        pad1: 0.0,
        pad2: 0.0,
    }
}

/// Factors that turn light of a colour temperature into white, keeping its luminance.
fn white_gains(kelvin: f32) -> glam::Vec3 {
    let gains = black_body(6504.0) / black_body(f64::from(kelvin));
    let luminance = gains.dot(glam::DVec3::new(0.2126, 0.7152, 0.0722));
    (gains / luminance).as_vec3()
}

/// Linear Rec.709 of a black body of luminance 1. Chromaticity by Kim et al. 2002 (US patent 7,024,034), 1667 K to
/// 25,000 K.
fn black_body(kelvin: f64) -> glam::DVec3 {
    let t = 1e3 / kelvin.clamp(1667.0, 25_000.0);
    let x = if kelvin < 4000.0 {
        -0.266_123_9 * t.powi(3) - 0.234_358_9 * t.powi(2) + 0.877_695_6 * t + 0.179_910
    } else {
        -3.025_846_9 * t.powi(3) + 2.107_037_9 * t.powi(2) + 0.222_634_7 * t + 0.240_390
    };
    let y = if kelvin < 2222.0 {
        -1.106_381_4 * x.powi(3) - 1.348_110_2 * x.powi(2) + 2.185_558_3 * x - 0.202_196_8
    } else if kelvin < 4000.0 {
        -0.954_947_6 * x.powi(3) - 1.374_185_9 * x.powi(2) + 2.091_370_2 * x - 0.167_488_7
    } else {
        3.081_758_0 * x.powi(3) - 5.873_386_7 * x.powi(2) + 3.751_129_9 * x - 0.370_014_8
    };
    let (cap_x, cap_z) = (x / y, (1.0 - x - y) / y);
    glam::DVec3::new(
        3.240_97 * cap_x - 1.537_38 - 0.498_61 * cap_z,
        -0.969_24 * cap_x + 1.875_97 + 0.041_56 * cap_z,
        0.055_63 * cap_x - 0.203_98 + 1.056_97 * cap_z,
    )
    .max(glam::DVec3::splat(1e-3))
}

/// Streaks of light: as bright as haze lit by the key light.
pub(super) fn shaft_uniforms(scene: &Scene, lighting: &Lighting, samples: u32) -> ShaftUniforms {
    let light = warm_key(lighting) * scene.sunshafts.tint.vec();
    ShaftUniforms {
        towards_light: lighting.towards_key,
        length_rad: scene.sunshafts.length_deg.to_radians(),
        light: light * scene.sunshafts.strength * 0.035 * lighting.streak_share(),
        samples,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn daylight_is_white_and_a_lamp_is_not() {
        assert!((white_gains(6504.0) - glam::Vec3::ONE).length() < 1e-5, "{}", white_gains(6504.0));
        let lamp = white_gains(3000.0);
        assert!(lamp.x < 0.8 && lamp.z > 1.8, "a lamp's light needs more blue: {lamp}");
    }
}
