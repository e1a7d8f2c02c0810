//! Twins of `common/shell.wgsl`, in `f64`, planet-centred: what the shader avoids in `f32` is exact enough here.
//!
//! Metres relative to the sea-level point under the world's origin: x east, y up, z south; the planet's centre is
//! (0, −radius, 0). Directions are unit vectors.

use glam::{DVec2, DVec3};

/// "Without end" for flat domains, in metres.
pub const FAR_M: f64 = 1e12;

/// Up to two stretches (start, end) of a ray; empty when the end is not beyond the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Segments {
    /// The nearer stretch.
    pub first: DVec2,
    /// The farther stretch, empty whenever the first is.
    pub second: DVec2,
}

impl Segments {
    /// The stretches that are not empty, moved to the front.
    #[must_use]
    pub fn ordered(first: DVec2, second: DVec2) -> Self {
        let mut full = [first, second].into_iter().filter(|stretch| stretch.y > stretch.x);
        Self { first: full.next().unwrap_or_default(), second: full.next().unwrap_or_default() }
    }

    /// Whether the distance lies in one of the stretches.
    #[must_use]
    pub fn contains(&self, distance_m: f64) -> bool {
        [self.first, self.second].iter().any(|stretch| stretch.x <= distance_m && distance_m < stretch.y)
    }
}

fn from_centre(p: DVec3, radius_m: f64) -> DVec3 {
    p + DVec3::Y * radius_m
}

/// Altitude above sea level in metres.
#[must_use]
pub fn altitude_at(p: DVec3, radius_m: f64) -> f64 {
    from_centre(p, radius_m).length() - radius_m
}

/// Distances (near, far) to the sphere at an altitude, negative behind `p`; (−1, −1) for a miss.
#[must_use]
pub fn shell_roots(p: DVec3, dir: DVec3, layer_altitude_m: f64, radius_m: f64) -> DVec2 {
    let centre = from_centre(p, radius_m);
    let b = centre.dot(dir);
    let c = (centre.length() - radius_m - layer_altitude_m) * (centre.length() + radius_m + layer_altitude_m);
    let discriminant = b * b - c;
    if discriminant < 0.0 {
        return DVec2::splat(-1.0);
    }
    DVec2::new(-b - discriminant.sqrt(), -b + discriminant.sqrt())
}

/// Where the ray is between two altitudes, up to where it meets the ground.
#[must_use]
pub fn shell_segments(p: DVec3, dir: DVec3, base_m: f64, top_m: f64, radius_m: f64) -> Segments {
    let outer = shell_roots(p, dir, top_m, radius_m);
    if top_m <= base_m || outer.y <= 0.0 {
        return Segments::default();
    }
    let ground = shell_roots(p, dir, 0.0, radius_m);
    let descends = from_centre(p, radius_m).dot(dir) < 0.0;
    let end = if descends && ground.y > 0.0 { outer.y.min(ground.x.max(0.0)) } else { outer.y };
    let start = outer.x.max(0.0);
    let inner = shell_roots(p, dir, base_m, radius_m);
    if inner.y <= 0.0 {
        return Segments::ordered(DVec2::new(start, end), DVec2::ZERO);
    }
    Segments::ordered(DVec2::new(start, end.min(inner.x)), DVec2::new(inner.y, end))
}

/// Where the ray is inside the box; the second stretch is empty.
#[must_use]
pub fn box_segments(p: DVec3, dir: DVec3, box_min_m: DVec3, box_max_m: DVec3) -> Segments {
    let mut stretch = DVec2::new(0.0, FAR_M);
    for axis in 0..3 {
        if dir[axis] == 0.0 {
            if p[axis] < box_min_m[axis] || p[axis] >= box_max_m[axis] {
                return Segments::default();
            }
            continue;
        }
        let (a, b) = ((box_min_m[axis] - p[axis]) / dir[axis], (box_max_m[axis] - p[axis]) / dir[axis]);
        stretch = DVec2::new(stretch.x.max(a.min(b)), stretch.y.min(a.max(b)));
    }
    Segments::ordered(stretch, DVec2::ZERO)
}

/// Where the ray is between two heights over a flat world.
#[must_use]
pub fn slab_segments(p: DVec3, dir: DVec3, base_m: f64, top_m: f64) -> Segments {
    if top_m <= base_m {
        return Segments::default();
    }
    let far = DVec3::splat(1e30);
    box_segments(p, dir, (-far).with_y(base_m), far.with_y(top_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS_M: f64 = 6.36e6;

    #[test]
    fn segments_agree_with_sampled_altitudes() {
        for altitude in [2.0, 1400.0, 1500.0, 1501.0, 3000.0, 9000.0] {
            for elevation in [-1.2_f64, -0.05, -0.02, 0.0, 0.02, 0.7] {
                let (p, dir) = (DVec3::Y * altitude, DVec3::new(elevation.cos(), elevation.sin(), 0.0));
                let segments = shell_segments(p, dir, 1500.0, 4000.0, RADIUS_M);
                let mut above_ground = true;
                for step in 0..4000 {
                    let distance = (f64::from(step) + 0.37) * 150.0;
                    let here = altitude_at(p + dir * distance, RADIUS_M);
                    above_ground &= here > 0.0;
                    let inside = above_ground && (1500.0..4000.0).contains(&here);
                    assert_eq!(segments.contains(distance), inside, "{altitude} m, {elevation} rad, {distance} m");
                }
            }
        }
    }
}
