//! What shaders are told, and the only place where units are converted.

pub mod air;
mod camera;
mod clouds;
mod ground;
pub mod other;
pub mod scene;

pub(super) use camera::{Eye, camera_uniforms};
pub(super) use clouds::{scene_uniforms, wind_mps};
pub(super) use ground::ground_uniforms;

use super::pass::sky::SkyInputs;
use crate::plan::Lighting;
use crate::scene::Scene;
use other::{DisplayUniforms, ShaftUniforms};

/// What the sky tables are made from.
pub(super) fn sky_inputs(scene: &Scene, lighting: &Lighting) -> SkyInputs {
    let per_unit = 1.0 / lighting.candela_per_unit;
    let clouds = scene.visible_layers().next();
    let glow = glam::Vec3::new(0.75, 0.95, 1.3) * scene.moon.night_glow;
    SkyInputs {
        planet_radius_m: scene.domain.planet_radius_m,
        haze: scene.air.haze,
        molecules: scene.air.molecules,
        ozone: scene.air.ozone,
        ground_albedo: scene.ground.albedo.vec() * 1.6,
        towards_sun: lighting.towards_sun,
        towards_moon: lighting.towards_moon,
        sun_illuminance: lighting.sun_lux * per_unit,
        moon_illuminance: lighting.moon_lux * per_unit,
        sun_angular_radius: if scene.sun.disc { scene.sun.radius_deg.to_radians() } else { 0.0 },
        moon_angular_radius: scene.moon.radius_deg.to_radians(),
        night_glow: glow * per_unit,
        eye_altitude_m: scene.camera.height_m,
        cloud_altitude_m: clouds.map_or(1500.0, |layer| layer.base_m),
    }
}

/// Exposure as photographers count it: EV 0 renders 1.2 cd/m² at the sensor's full scale.
pub(super) fn display_uniforms(scene: &Scene, lighting: &Lighting) -> DisplayUniforms {
    let full_scale = 1.2 * f64::from(scene.display.exposure_ev).exp2();
    DisplayUniforms {
        exposure: (f64::from(lighting.candela_per_unit) / full_scale) as f32,
        contrast: scene.display.contrast,
        saturation: scene.display.saturation,
        pad0: 0.0,
    }
}

/// Streaks of light: as bright as haze lit by the key light.
pub(super) fn shaft_uniforms(scene: &Scene, lighting: &Lighting, samples: u32) -> ShaftUniforms {
    let light = lighting.key_lux / lighting.candela_per_unit * scene.sunshafts.tint.vec();
    // Low light crosses more haze and is redder; the sky tables know by how much, this only follows the trend.
    let low = (1.0 - lighting.towards_key.y.clamp(0.0, 0.5) * 2.0).powi(2);
    let warm = glam::Vec3::new(1.0, 1.0 - 0.35 * low, 1.0 - 0.65 * low);
    ShaftUniforms {
        towards_light: lighting.towards_key,
        length_rad: scene.sunshafts.length_deg.to_radians(),
        light: light * warm * scene.sunshafts.strength * 0.035,
        samples,
    }
}
