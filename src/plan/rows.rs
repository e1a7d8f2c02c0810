//! Which rows of a picture lie wholly above the ground, and which miss all clouds.

use std::ops::Range;

use glam::DVec2;

use super::view::dip_rad;
use crate::scene::{DomainKind, Frame, Ground, Projection};

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
    let [ranges, hills] = Ground::RELIEF_BOUND;
    let out = f64::from(camera.east_m).hypot(camera.south_m.into());
    let height = |out: f64| {
        f64::from(ranges * ground.mountains_m) * smoothstep(PLAIN_M, RANGES_FROM_M, out)
            + f64::from(hills * ground.hills_m) * smoothstep(PLAIN_M, HILLS_FROM_M, out)
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

/// Room for what rounding does to the elevation of a ray.
const MARGIN_RAD: f64 = 1e-3;

/// Elevations of the rays of each row.
struct Elevations<'a> {
    frame: &'a Frame<'a>,
    axes: [glam::DVec3; 3],
    half: [f64; 2],
}

impl<'a> Elevations<'a> {
    fn new(frame: &'a Frame<'a>) -> Self {
        let camera = &frame.scene.camera;
        let half = camera.half_tangents(frame.whole_size()).map(f64::from);
        Self { frame, axes: camera.axes().map(|axis| axis.as_dvec3()), half }
    }

    /// Lowest and highest elevation in a row, whose samples lie anywhere in its pixels.
    fn of_row(&self, row: u32) -> [f64; 2] {
        let height = f64::from(self.frame.render_size()[1]);
        let (offset, size) = self.frame.window_shares();
        let edges = [row + 1, row].map(|edge| self.of_line(offset[1] + size[1] * f64::from(edge) / height));
        [edges[0][0].min(edges[1][0]), edges[0][1].max(edges[1][1])]
    }

    /// The same along a line across the whole picture: 0 is its upper edge, 1 its lower one.
    fn of_line(&self, v: f64) -> [f64; 2] {
        let elevation = match self.frame.scene.camera.projection {
            Projection::Perspective => return self.of_flat_line(v),
            Projection::Equirect => (0.5 - v) * std::f64::consts::PI,
            Projection::Dome => (0.5 - 0.5 * v) * std::f64::consts::PI,
        };
        [elevation; 2]
    }

    fn of_flat_line(&self, v: f64) -> [f64; 2] {
        let [forward, right, up] = self.axes;
        let [across, half] = self.half;
        let middle = forward - up * half * (2.0 * v - 1.0);
        let at = |s: f64| (middle + right * s).normalize().y.asin();
        // Where the elevation turns along the line, if that is in the picture; else it is greatest and least at the ends.
        let turn = right.y * middle.length_squared() / middle.y;
        let turn = if turn.is_finite() { turn.clamp(-across, across) } else { 0.0 };
        let all = [at(-across), at(across), at(turn)];
        [all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max)]
    }
}

/// Rows from the top of the picture in which no ray can meet the ground.
pub(super) fn open_rows(frame: &Frame<'_>) -> u32 {
    let limit = highest_ground(frame).atan();
    let elevations = Elevations::new(frame);
    let is_open = |row: &u32| elevations.of_row(*row)[0] > limit;
    u32::try_from((0..frame.render_size()[1]).take_while(is_open).count()).unwrap_or(0)
}

/// Rows of the picture that may hold cloud: none, or those from the first to the last that may.
pub(super) fn cloud_rows(frame: &Frame<'_>) -> Range<u32> {
    let elevations = Elevations::new(frame);
    let space = CloudSpace::new(frame);
    let may_hold = |row: &u32| space.is_met(elevations.of_row(*row));
    let rows = frame.render_size()[1];
    match ((0..rows).find(may_hold), (0..rows).rev().find(may_hold)) {
        (Some(first), Some(last)) => first..last + 1,
        _ => 0..0,
    }
}

/// The space that clouds can be in, as the eye sees it.
struct CloudSpace<'a> {
    frame: &'a Frame<'a>,
    eye_m: f64,
    base_m: f64,
    top_m: f64,
    reach_m: f64,
}

impl<'a> CloudSpace<'a> {
    fn new(frame: &'a Frame<'a>) -> Self {
        let layers = || frame.scene.visible_layers();
        Self {
            frame,
            eye_m: f64::from(frame.scene.camera.height_m),
            base_m: layers().map(|layer| f64::from(layer.base_m)).fold(f64::INFINITY, f64::min),
            top_m: layers().map(|layer| f64::from(layer.top_m)).fold(0.0, f64::max),
            reach_m: f64::from(frame.quality.max_distance_m),
        }
    }

    /// Whether a ray between two elevations may meet it.
    fn is_met(&self, [lowest, highest]: [f64; 2]) -> bool {
        let (lowest, highest) = (lowest - MARGIN_RAD, highest + MARGIN_RAD);
        match self.frame.scene.domain.kind {
            DomainKind::Shell => self.is_shell_met(lowest, highest),
            DomainKind::Flat => self.is_slab_met(lowest, highest),
            DomainKind::Box => self.is_box_met(lowest, highest),
        }
    }

    /// Distance to a sphere of a height over the sea, the nearer crossing of it where `is_first`.
    fn to_sphere(&self, height_m: f64, elevation: f64, is_first: bool) -> f64 {
        let radius = f64::from(self.frame.scene.domain.planet_radius_m);
        let b = (radius + self.eye_m) * elevation.sin();
        let c = (self.eye_m - height_m) * (2.0 * radius + self.eye_m + height_m);
        let root = (b * b - c).max(0.0).sqrt();
        if is_first { -b - root } else { -b + root }
    }

    fn is_shell_met(&self, lowest: f64, highest: f64) -> bool {
        let radius_m = self.frame.scene.domain.planet_radius_m;
        // An eye inside of a hill sees from above it.
        let relief_m = self.frame.scene.ground.highest_m();
        if self.eye_m < self.base_m {
            // Rays below the horizon end in the sea before they meet any; those above it meet the base once, the steeper
            // the sooner.
            let horizon = -dip_rad(self.frame.scene.camera.height_m.max(relief_m), radius_m);
            let steepest = highest.min(std::f64::consts::FRAC_PI_2);
            return highest >= horizon && self.to_sphere(self.base_m, steepest.max(horizon), false) <= self.reach_m;
        }
        if self.eye_m <= self.top_m {
            return true;
        }
        #[allow(clippy::cast_possible_truncation, reason = "a height to single precision, with a margin")]
        let top_horizon = -dip_rad((self.eye_m - self.top_m) as f32, radius_m + self.top_m as f32);
        let steepest = lowest.max(-std::f64::consts::FRAC_PI_2);
        lowest <= top_horizon && self.to_sphere(self.top_m, steepest.min(top_horizon), true) <= self.reach_m
    }

    fn is_slab_met(&self, lowest: f64, highest: f64) -> bool {
        if self.eye_m < self.base_m {
            let sine = highest.min(std::f64::consts::FRAC_PI_2).sin();
            return sine > 0.0 && (self.base_m - self.eye_m) / sine <= self.reach_m;
        }
        if self.eye_m <= self.top_m {
            return true;
        }
        let sine = -lowest.max(-std::f64::consts::FRAC_PI_2).sin();
        sine > 0.0 && (self.eye_m - self.top_m) / sine <= self.reach_m
    }

    fn is_box_met(&self, lowest: f64, highest: f64) -> bool {
        let domain = &self.frame.scene.domain;
        let camera = &self.frame.scene.camera;
        let half = 0.5 * DVec2::new(domain.box_width_m.into(), domain.box_length_m.into());
        let eye = DVec2::new(camera.east_m.into(), camera.south_m.into());
        let off = (eye - DVec2::new(domain.box_east_m.into(), domain.box_south_m.into())).abs();
        let (nearest, farthest) = ((off - half).max(DVec2::ZERO).length(), (off + half).length());
        let tangent = |height: f64, out: f64| (height - self.eye_m).atan2(out.max(1e-9));
        // What is above the eye is seen highest from near, what is below it lowest.
        let top = tangent(self.top_m, if self.top_m > self.eye_m { nearest } else { farthest });
        let base = tangent(self.base_m, if self.base_m > self.eye_m { farthest } else { nearest });
        lowest <= top && highest >= base
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Output, Quality, Scene};

    fn rows(change: impl Fn(&mut Scene)) -> u32 {
        let (mut scene, quality) = (Scene::default(), Quality::default());
        scene.camera.pitch_deg = 0.0;
        change(&mut scene);
        open_rows(&Frame {
            scene: &scene,
            quality: &quality,
            size: [160, 90],
            time_secs: 0.0,
            output: Output::Display,
            window: None,
        })
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
