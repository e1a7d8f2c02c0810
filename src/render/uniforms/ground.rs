//! The ground as shaders take it.

use glam::{Vec2, Vec4};

use super::camera::Eye;
use super::other::GroundUniforms;
use crate::plan::Lighting;
use crate::scene::{Scene, ShapeRole};

/// Half the edge of the square that cloud shadows are mapped on.
const SHADOW_REACH_M: f64 = 26_000.0;

/// Ranges across one tile of the relief.
pub(crate) const fn tiles_across_relief() -> f64 {
    7.0
}

/// Everything the ground's shaders are told; the shadow map's texels stay put in the world while the eye moves.
pub(crate) fn ground_uniforms(scene: &Scene, lighting: &Lighting, eye: &Eye, shadow_px: u32) -> GroundUniforms {
    let ground = &scene.ground;
    let tile_m = f64::from(ground.mountain_size_m) * tiles_across_relief();
    let tile = |metres: f64| (metres / tile_m - (metres / tile_m).floor()) as f32;
    let texel_m = 2.0 * SHADOW_REACH_M / f64::from(shadow_px.max(1));
    let snapped = |metres: f64| (metres / texel_m).round() * texel_m - metres;
    let shadow = |metres: f64| (0.5 - snapped(metres) / (2.0 * SHADOW_REACH_M)) as f32;
    GroundUniforms {
        albedo: ground.albedo.vec(),
        planet_radius_m: scene.domain.planet_radius_m,
        rock: ground.rock.vec(),
        mountains_m: ground.mountains_m,
        towards_light: lighting.towards_key,
        hills_m: ground.hills_m,
        light_illuminance: lighting.key_lux / lighting.candela_per_unit,
        highest_m: ground.highest_m(),
        tile_from_world: Vec4::new(tile(eye.position.x), tile(eye.position.z), (1.0 / tile_m) as f32, 0.0),
        shadow_from_world: Vec4::new(
            shadow(eye.position.x),
            shadow(eye.position.z),
            (0.5 / SHADOW_REACH_M) as f32,
            0.0,
        ),
        plain_at: Vec2::new(-eye.position.x as f32, -eye.position.z as f32),
        mean_shadow: 1.0 - 0.55 * scene.weather.coverage,
        shadow_strength: ground.cloud_shadows,
        reach_m: 70_000.0,
        receiver_m: receiver_m(scene),
        pad1: 0.0,
        pad2: 0.0,
    }
}

/// Height that no solid thing exceeds by much; 0 where there is none.
fn receiver_m(scene: &Scene) -> f32 {
    let solid = scene.shapes.iter().filter(|shape| shape.role == ShapeRole::Solid);
    solid.map(|shape| shape.height_m + 0.5 * shape.tall_m).fold(0.0, f32::max)
}
