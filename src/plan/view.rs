//! Where things lie to the view.

use glam::Vec3;

use super::Lighting;
use crate::scene::{Frame, Projection, Scene};

/// Room for what rounding does to an angle, and for the soft edge of a disc.
pub(super) const MARGIN_DEG: f32 = 0.1;

/// Half the angle across the picture's diagonal.
pub(super) fn half_diagonal_deg(frame: &Frame<'_>) -> f32 {
    let [across, up] = frame.scene.camera.half_tangents(frame.whole_size());
    across.hypot(up).atan().to_degrees()
}

/// Angle between a direction and the middle of the picture.
pub(super) fn angle_off_view_deg(scene: &Scene, towards: Vec3) -> f32 {
    let forward = crate::scene::direction(scene.camera.pitch_deg, scene.camera.heading_deg);
    forward.dot(towards).clamp(-1.0, 1.0).acos().to_degrees()
}

/// Whether no part of a disc can be in the picture.
pub(super) fn is_out_of_view(frame: &Frame<'_>, towards: Vec3, radius_deg: f32) -> bool {
    // A pixel has a soft edge of its own size.
    let [across, up] = frame.scene.camera.half_tangents(frame.whole_size());
    let [width, height] = frame.whole_size();
    let pixel_deg = (2.0 * (across / width as f32).max(up / height as f32)).atan().to_degrees();
    frame.scene.camera.projection == Projection::Perspective
        && angle_off_view_deg(frame.scene, towards) > half_diagonal_deg(frame) + radius_deg + pixel_deg + MARGIN_DEG
}

/// Angle by which the horizon lies below the horizontal, at a height over the sea.
pub(super) fn dip_rad(height_m: f32, planet_radius_m: f32) -> f64 {
    let (height, radius) = (f64::from(height_m).max(0.0), f64::from(planet_radius_m));
    // The cosine is radius / (radius + height); the sine of half the angle does not cancel.
    2.0 * (0.5 * height / (radius + height)).sqrt().asin()
}

/// Whether all of a disc is below the horizon of the eye, wherever relief may have lifted it.
pub(super) fn is_below_eye_horizon(frame: &Frame<'_>, towards: Vec3, radius_deg: f32) -> bool {
    let scene = frame.scene;
    let relief_m = scene.ground.highest_m();
    let dip = dip_rad(scene.camera.height_m.max(relief_m), scene.domain.planet_radius_m);
    let top_deg = f64::from(towards.y).clamp(-1.0, 1.0).asin().to_degrees() + f64::from(radius_deg + MARGIN_DEG);
    top_deg + dip.to_degrees() < 0.0
}

/// Whether the key light is below the horizon of every place in the clouds that the march comes to.
pub(super) fn is_below_all_horizons(frame: &Frame<'_>, lighting: &Lighting) -> bool {
    let scene = frame.scene;
    let radius_m = f64::from(scene.domain.planet_radius_m);
    let highest_m = scene.visible_layers().map(|layer| layer.top_m).fold(0.0, f32::max);
    let turned = f64::from(frame.quality.max_distance_m.max(0.0)) / radius_m;
    let disc_deg = f64::from(scene.sun.radius_deg.max(scene.moon.radius_deg) + MARGIN_DEG);
    let elevation_deg = f64::from(lighting.towards_key.y).clamp(-1.0, 1.0).asin().to_degrees();
    elevation_deg + disc_deg + (dip_rad(highest_m, scene.domain.planet_radius_m) + turned).to_degrees() < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dip_is_that_of_the_sphere() {
        for height_m in [1.0_f32, 2000.0, 400_000.0] {
            let exact = (6.36e6 / (6.36e6 + f64::from(height_m))).acos();
            assert!((dip_rad(height_m, 6.36e6) / exact - 1.0).abs() < 1e-4, "{height_m} m");
        }
        assert_eq!(dip_rad(-5.0, 6.36e6), 0.0, "below the sea there is none");
    }
}
