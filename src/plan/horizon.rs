//! Which rows of a picture lie wholly above the ground.

use crate::scene::{Frame, Projection};

/// Distance from the world's origin at which relief begins, and by which ranges and hills have risen; as
/// `pass/terrain.wgsl` has them.
const PLAIN_M: f64 = 800.0;
const RANGES_FROM_M: f64 = 7000.0;
const HILLS_FROM_M: f64 = 24_000.0;
/// How far relief is looked for.
const REACH_M: f64 = 70_000.0;
/// A ray that passes the ground by less than this part of its way meets it.
const NEAR_MISS: f64 = 0.001;

fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Tangent of the greatest elevation at which the eye can see ground; infinite where it may stand inside of a hill.
fn highest_ground(frame: &Frame<'_>) -> f64 {
    let (ground, camera) = (&frame.scene.ground, &frame.scene.camera);
    let out = f64::from(camera.east_m).hypot(camera.south_m.into());
    let height = |out: f64| {
        1.25 * f64::from(ground.mountains_m) * smoothstep(PLAIN_M, RANGES_FROM_M, out)
            + 1.15 * f64::from(ground.hills_m) * smoothstep(PLAIN_M, HILLS_FROM_M, out)
    };
    let eye = f64::from(camera.height_m);
    if height(out) >= eye {
        return f64::INFINITY;
    }
    // The relief only rises on the way out, so the far end of each stretch bounds it, seen from the near end. That the
    // planet curves away from under it is left out.
    let growth: f64 = 1.05;
    let (mut near, mut greatest) = (1.0_f64, 0.0_f64);
    while near < REACH_M {
        let far = near * growth;
        greatest = greatest.max((height(out + far) - eye) / near);
        near = far;
    }
    greatest + NEAR_MISS
}

/// Rows from the top of the picture in which no ray can meet the ground.
pub(super) fn open_rows(frame: &Frame<'_>) -> u32 {
    let camera = &frame.scene.camera;
    let [width, height] = frame.render_size();
    let limit = highest_ground(frame).atan();
    let [across, half] = camera.half_tangents([width, height]).map(f64::from);
    let [forward, right, up] = camera.axes().map(|axis| axis.as_dvec3());
    // The lower end of a tilted row is the one on the side that the tilt lowers.
    let edge = right * across * if right.y > 0.0 { -1.0 } else { 1.0 };
    let lowest_elevation = |row: u32| {
        // At the lower edge of its pixels: samples lie anywhere in them.
        let v = f64::from(row + 1) / f64::from(height);
        match camera.projection {
            Projection::Perspective => {
                // In a row above the horizon rays at its ends are the lowest.
                (forward + edge - up * half * (2.0 * v - 1.0)).normalize().y.asin()
            }
            Projection::Equirect => (0.5 - v) * std::f64::consts::PI,
            Projection::Dome => (0.5 - 0.5 * v) * std::f64::consts::PI,
        }
    };
    let is_open = |row: &u32| lowest_elevation(*row) > limit;
    u32::try_from((0..height).take_while(is_open).count()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Output, Quality, Scene};

    fn rows(change: impl Fn(&mut Scene)) -> u32 {
        let (mut scene, quality) = (Scene::default(), Quality::default());
        scene.camera.pitch_deg = 0.0;
        change(&mut scene);
        open_rows(&Frame { scene: &scene, quality: &quality, size: [160, 90], time_secs: 0.0, output: Output::Display })
    }

    #[test]
    fn a_level_view_over_a_plain_is_open_down_to_the_horizon() {
        let plain = rows(|scene| (scene.ground.hills_m, scene.ground.mountains_m) = (0.0, 0.0));
        assert!((43..=45).contains(&plain), "{plain} of 90");
        let hills = rows(|scene| scene.ground.hills_m = 300.0);
        let ranges = rows(|scene| scene.ground.mountains_m = 700.0);
        assert!(
            plain > hills && hills > ranges && ranges > 0,
            "relief stands over the horizon: {plain} {hills} {ranges}"
        );
    }

    #[test]
    fn nothing_is_open_where_the_eye_may_stand_in_a_hill_or_looks_down() {
        assert_eq!(rows(|scene| (scene.camera.east_m, scene.ground.mountains_m) = (30_000.0, 3000.0)), 0);
        assert_eq!(rows(|scene| scene.camera.pitch_deg = -60.0), 0);
        assert_eq!(rows(|scene| scene.camera.pitch_deg = 60.0), 90, "and all of it where it looks up");
        let around = rows(|scene| {
            scene.camera.projection = Projection::Equirect;
            (scene.ground.hills_m, scene.ground.mountains_m) = (0.0, 0.0);
        });
        assert!((43..=45).contains(&around), "{around}");
    }
}
