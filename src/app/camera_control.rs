//! Flying and orbiting. Positions are metres, east, up and south; angles degrees, heading clockwise from north.

use glam::{DVec3, Vec2};

use crate::scene::{Camera, FARTHEST_M, direction};

/// Which way a fly key pushes: right, up, forward; each −1, 0 or 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// D minus A.
    pub right: f64,
    /// E minus Q.
    pub up: f64,
    /// W minus S.
    pub forward: f64,
}

/// Slowest and fastest flight, in m/s.
const SPEED_RANGE_MPS: std::ops::RangeInclusive<f64> = 1.0..=20_000.0;
/// Turn per pixel of mouse movement, at any frame rate and window size.
const DEGREES_PER_PIXEL: f32 = 0.12;
/// Distance of the point that the camera orbits, until it is moved towards it or away.
const PIVOT_M: f64 = 4000.0;
/// How near and how far that point may be.
const PIVOT_RANGE_M: std::ops::RangeInclusive<f64> = 50.0..=100_000.0;
/// Share of the way to that point that a pixel of movement goes.
const DOLLY_PER_PIXEL: f64 = 0.004;
/// One notch of the wheel changes the speed by this factor; four make an octave.
const SPEED_STEP: f64 = 1.189_207_115;

/// Moves a camera as the user's hands ask.
#[derive(Clone, Debug)]
pub struct CameraControl {
    speed_mps: f64,
    /// Distance of the point that the camera orbits.
    pivot_m: f64,
}

impl Default for CameraControl {
    fn default() -> Self {
        Self { speed_mps: 120.0, pivot_m: PIVOT_M }
    }
}

impl CameraControl {
    /// Speed of flight without a modifier, in m/s.
    pub fn speed_mps(&self) -> f64 {
        self.speed_mps
    }

    /// Changes the speed by notches of the wheel.
    pub fn change_speed(&mut self, notches: f64) {
        let speed = self.speed_mps * SPEED_STEP.powf(notches);
        self.speed_mps = speed.clamp(*SPEED_RANGE_MPS.start(), *SPEED_RANGE_MPS.end());
    }

    /// Turns the view by a movement of the mouse in pixels.
    pub fn look(&self, camera: &mut Camera, pixels: Vec2) {
        camera.heading_deg = (camera.heading_deg + pixels.x * DEGREES_PER_PIXEL).rem_euclid(360.0);
        camera.pitch_deg = (camera.pitch_deg - pixels.y * DEGREES_PER_PIXEL).clamp(-90.0, 90.0);
    }

    /// Flies for `seconds` with `factor` times the speed. The way is speed × time, whatever the frame rate.
    pub fn fly(&self, camera: &mut Camera, push: Push, factor: f64, seconds: f64) {
        let forward = direction(camera.pitch_deg, camera.heading_deg).as_dvec3();
        let right = direction(0.0, camera.heading_deg + 90.0).as_dvec3();
        let wish = right * push.right + DVec3::Y * push.up + forward * push.forward;
        let step = wish.normalize_or_zero() * self.speed_mps * factor * seconds;
        place(camera, position(camera) + step);
    }

    /// Swings round the point ahead by a drag in pixels, and keeps looking at it.
    pub fn orbit(&self, camera: &mut Camera, pixels: Vec2) {
        let ahead = |camera: &Camera| direction(camera.pitch_deg, camera.heading_deg).as_dvec3();
        let centre = position(camera) + ahead(camera) * self.pivot_m;
        let before = camera.clone();
        camera.heading_deg = (camera.heading_deg + pixels.x * DEGREES_PER_PIXEL * 2.0).rem_euclid(360.0);
        camera.pitch_deg = (camera.pitch_deg + pixels.y * DEGREES_PER_PIXEL * 2.0).clamp(-89.0, 89.0);
        let target = centre - ahead(camera) * self.pivot_m;
        if target.y < HEIGHT_RANGE_M.0 {
            // Below the ground there is nothing to see: swing sideways only.
            camera.pitch_deg = before.pitch_deg;
        }
        let target = centre - ahead(camera) * self.pivot_m;
        place(camera, target);
    }

    /// Shifts the camera across the view by a drag in pixels, so that the point ahead stays under the pointer.
    pub fn pan(&self, camera: &mut Camera, pixels: Vec2, size_px: [u32; 2]) {
        let [_, right, up] = camera.axes();
        let size_px = size_px.map(|side| side.max(1));
        let per_pixel = 2.0 * f64::from(camera.half_tangents(size_px)[1]) * self.pivot_m / f64::from(size_px[1].max(1));
        let step = up.as_dvec3() * f64::from(pixels.y) - right.as_dvec3() * f64::from(pixels.x);
        place(camera, position(camera) + step * per_pixel);
    }

    /// Moves towards the point ahead by a drag in pixels, a share of the way for each, and away from it below 0.
    pub fn dolly(&mut self, camera: &mut Camera, pixels: f32) {
        let left = self.pivot_m * (-DOLLY_PER_PIXEL * f64::from(pixels)).exp();
        let ahead = direction(camera.pitch_deg, camera.heading_deg).as_dvec3();
        place(camera, position(camera) + ahead * (self.pivot_m - left));
        self.pivot_m = left.clamp(*PIVOT_RANGE_M.start(), *PIVOT_RANGE_M.end());
    }

    /// Walks level by a drag in pixels: up is forwards, sideways turns.
    pub fn walk(&self, camera: &mut Camera, pixels: Vec2) {
        camera.heading_deg = (camera.heading_deg + pixels.x * DEGREES_PER_PIXEL).rem_euclid(360.0);
        let ahead = direction(0.0, camera.heading_deg).as_dvec3();
        place(camera, position(camera) - ahead * (f64::from(pixels.y) * DOLLY_PER_PIXEL * self.pivot_m));
    }
}

/// The range of `camera.height_m`.
const HEIGHT_RANGE_M: (f64, f64) = (1.0, 60_000.0);

fn position(camera: &Camera) -> DVec3 {
    DVec3::new(f64::from(camera.east_m), f64::from(camera.height_m), f64::from(camera.south_m))
}

/// Puts the camera there, or at the nearest place its parameters allow.
#[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
fn place(camera: &mut Camera, position: DVec3) {
    let farthest_m = f64::from(FARTHEST_M);
    camera.east_m = position.x.clamp(-farthest_m, farthest_m) as f32;
    camera.height_m = position.y.clamp(HEIGHT_RANGE_M.0, HEIGHT_RANGE_M.1) as f32;
    camera.south_m = position.z.clamp(-farthest_m, farthest_m) as f32;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flight_does_not_depend_on_the_frame_rate() {
        let control = CameraControl::default();
        let push = Push { forward: 1.0, right: 1.0, up: 0.0 };
        let start = Camera { height_m: 500.0, pitch_deg: 0.0, ..Camera::default() };
        let (mut once, mut often) = (start.clone(), start);
        control.fly(&mut once, push, 5.0, 1.0);
        for _ in 0..50 {
            control.fly(&mut often, push, 5.0, 0.02);
        }
        let gap = position(&once).distance(position(&often));
        assert!(gap < 0.1, "{gap} m apart after 600 m");
        assert!((position(&once).with_y(0.0).length() - 600.0).abs() < 0.1, "diagonals are no faster");
    }

    #[test]
    fn forward_is_where_the_camera_looks() {
        let mut camera = Camera { heading_deg: 90.0, pitch_deg: 0.0, ..Camera::default() };
        CameraControl::default().fly(&mut camera, Push { forward: 1.0, ..Push::default() }, 1.0, 1.0);
        assert!(camera.east_m > 100.0 && camera.south_m.abs() < 1e-3, "{camera:?}");
    }

    #[test]
    fn cameras_stay_within_their_ranges() {
        let mut control = CameraControl::default();
        control.change_speed(1000.0);
        assert_eq!(control.speed_mps(), 20_000.0);
        let mut camera = Camera::default();
        for _ in 0..200 {
            control.fly(&mut camera, Push { up: -1.0, right: 1.0, forward: 0.0 }, 5.0, 1.0);
            control.look(&mut camera, Vec2::new(5000.0, -5000.0));
            control.orbit(&mut camera, Vec2::new(50.0, -500.0));
        }
        assert!((1.0..=60_000.0).contains(&camera.height_m), "{camera:?}");
        assert!(camera.east_m.abs() <= 1_000_000.0 && (0.0..=360.0).contains(&camera.heading_deg), "{camera:?}");
        assert!((-90.0..=90.0).contains(&camera.pitch_deg), "{camera:?}");
    }

    #[test]
    fn an_orbit_keeps_the_point_ahead() {
        let mut camera = Camera { height_m: 3000.0, pitch_deg: 0.0, ..Camera::default() };
        let ahead =
            |camera: &Camera| position(camera) + direction(camera.pitch_deg, camera.heading_deg).as_dvec3() * PIVOT_M;
        let before = ahead(&camera);
        CameraControl::default().orbit(&mut camera, Vec2::new(120.0, -40.0));
        assert!(before.distance(ahead(&camera)) < 1.0, "{camera:?}");
    }

    #[test]
    fn a_dolly_and_an_orbit_share_their_point_and_a_pan_follows_the_pointer() {
        let start = Camera { height_m: 3000.0, pitch_deg: 0.0, heading_deg: 30.0, ..Camera::default() };
        let point = position(&start) + direction(0.0, 30.0).as_dvec3() * PIVOT_M;
        let (mut control, mut camera) = (CameraControl::default(), start.clone());
        for _ in 0..20 {
            control.dolly(&mut camera, 10.0);
            control.orbit(&mut camera, Vec2::new(3.0, 0.0));
        }
        let left = position(&camera).distance(point);
        assert!((left - PIVOT_M * (-0.8_f64).exp()).abs() < 5.0, "{left} m away");
        control.dolly(&mut camera, -200.0);
        assert!((position(&camera).distance(point) - PIVOT_M).abs() < 5.0, "and back");
        let (control, mut camera) = (CameraControl::default(), start.clone());
        control.pan(&mut camera, Vec2::new(100.0, 50.0), [800, 500]);
        // The point was in the middle of the picture; now it is 100 pixels to the right and 50 below.
        let way = (point - position(&camera)).as_vec3();
        let [forward, right, up] = camera.axes();
        let tangent = camera.half_tangents([1, 1])[1];
        let pixels = |axis: glam::Vec3| way.dot(axis) / way.dot(forward) / tangent * 250.0;
        assert!(
            (pixels(right) - 100.0).abs() < 0.5 && (pixels(up) + 50.0).abs() < 0.5,
            "{} {}",
            pixels(right),
            pixels(up)
        );
        let mut camera = start;
        control.walk(&mut camera, Vec2::new(0.0, -10.0));
        assert!(camera.height_m == 3000.0 && position(&camera).distance(point) < PIVOT_M - 100.0, "forwards");
    }
}
