//! Twins of `noise/*.wgsl`, in `f32` with the same hashes. Positions are in tiles: `p` and `p + 1` give the same value.

use glam::{IVec2, IVec3, Vec2, Vec3};

use super::random::{hash_cell, hash_cell_bits, unit_from_bits};

/// The cell of a lattice that repeats after `period` cells.
#[must_use]
pub fn wrap_cell(cell: IVec3, period: i32) -> IVec3 {
    cell.rem_euclid(IVec3::splat(period))
}

fn lerp(a: f32, b: f32, t: f32) -> f32 {
    a * (1.0 - t) + b * t
}

/// Gradient noise with `period` lattice cells per tile; within −1..1.
#[must_use]
pub fn perlin(p: Vec3, period: i32, seed: u32) -> f32 {
    let q = p * period as f32;
    let cell = q.floor().as_ivec3();
    let f = q - q.floor();
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let corner = |x: i32, y: i32, z: i32| {
        let corner = IVec3::new(x, y, z);
        let gradient = hash_cell(wrap_cell(cell + corner, period), seed) * 2.0 - 1.0;
        gradient.dot(f - corner.as_vec3())
    };
    let low = lerp(lerp(corner(0, 0, 0), corner(1, 0, 0), w.x), lerp(corner(0, 1, 0), corner(1, 1, 0), w.x), w.y);
    let high = lerp(lerp(corner(0, 0, 1), corner(1, 0, 1), w.x), lerp(corner(0, 1, 1), corner(1, 1, 1), w.x), w.y);
    lerp(low, high, w.z)
}

/// What [`worley_cell`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorleyCell {
    /// Distance to the nearest point, in lattice cells.
    pub f1: f32,
    /// Distance to the second nearest point among the 27 cells, in lattice cells.
    pub f2: f32,
    /// Random bits of the nearest point's cell.
    pub id: u32,
}

/// The two nearest of the points in the 27 cells around `p` (Worley 1996), one point anywhere in each cell.
#[must_use]
pub fn worley_cell(p: Vec3, period: i32, seed: u32) -> WorleyCell {
    let q = p * period as f32;
    let cell = q.floor().as_ivec3();
    let f = q - q.floor();
    let (mut nearest, mut second, mut id) = (1e9_f32, 1e9_f32, 0);
    for i in 0..27 {
        let step = IVec3::new(i % 3, (i / 3) % 3, i / 9) - 1;
        let bits = hash_cell_bits(wrap_cell(cell + step, period), seed);
        let jitter = Vec3::from_array(bits.to_array().map(unit_from_bits));
        let squared = (step.as_vec3() + jitter - f).length_squared();
        second = second.min(nearest.max(squared));
        if squared < nearest {
            (nearest, id) = (squared, bits.x);
        }
    }
    WorleyCell { f1: nearest.sqrt(), f2: second.sqrt(), id }
}

/// 1 at the points, 0 far from them; clamped.
#[must_use]
pub fn worley(p: Vec3, period: i32, seed: u32) -> f32 {
    (1.0 - worley_cell(p, period, seed).f1).clamp(0.0, 1.0)
}

/// Octaves of [`perlin`] with halving amplitudes, normalised by their sum; within −1..1.
#[must_use]
pub fn perlin_fbm(p: Vec3, period: i32, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut weight, mut amplitude) = (0.0, 0.0_f32, 1.0);
    for octave in 0..octaves {
        sum += amplitude * perlin(p, period << octave, seed.wrapping_add(octave));
        weight += amplitude;
        amplitude *= 0.5;
    }
    sum / weight.max(1e-4)
}

/// Three octaves of [`worley`] with the weights of Schneider (2015); 0..1.
#[must_use]
pub fn worley_fbm(p: Vec3, period: i32, seed: u32) -> f32 {
    worley(p, period, seed) * 0.625
        + worley(p, period * 2, seed.wrapping_add(1)) * 0.25
        + worley(p, period * 4, seed.wrapping_add(2)) * 0.125
}

/// Perlin-Worley of Schneider (2015); 0..1.
#[must_use]
pub fn perlin_worley(p: Vec3, seed: u32) -> f32 {
    let connected = (perlin_fbm(p, 4, 5, seed) * 0.9 + 0.5).clamp(0.0, 1.0);
    let billows = worley_fbm(p, 4, seed.wrapping_add(16));
    billows + connected * (1.0 - billows)
}

/// The potential whose curl is [`curl2`], in lattice cells.
#[must_use]
pub fn curl2_potential(p: Vec2, period: i32, seed: u32) -> f32 {
    let q = p * period as f32;
    let cell = q.floor().as_ivec2();
    let f = q - q.floor();
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let corner = |x: i32, y: i32| {
        let corner = IVec2::new(x, y);
        let gradient = hash_cell(wrap_cell((cell + corner).extend(0), period), seed).truncate() * 2.0 - 1.0;
        gradient.dot(f - corner.as_vec2())
    };
    lerp(lerp(corner(0, 0), corner(1, 0), w.x), lerp(corner(0, 1), corner(1, 1), w.x), w.y)
}

/// Divergence-free flow per lattice cell (Bridson et al. 2007): the curl of [`curl2_potential`], by central difference
/// over `step` tiles, an independent check of the shader's analytic derivative.
#[must_use]
pub fn curl2(p: Vec2, period: i32, seed: u32, step: f32) -> Vec2 {
    let span = 2.0 * step * period as f32;
    let slope =
        |along: Vec2| (curl2_potential(p + along, period, seed) - curl2_potential(p - along, period, seed)) / span;
    Vec2::new(slope(Vec2::Y * step), -slope(Vec2::X * step))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions spread over the tile (the R3 sequence).
    fn positions(count: u16) -> impl Iterator<Item = Vec3> {
        (0..count).map(|i| (Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5) * f32::from(i)).fract())
    }

    #[test]
    fn noises_stay_in_their_ranges_with_the_stated_deviation() {
        let (mut sum, mut squares) = (0.0, 0.0);
        for p in positions(4000) {
            let value = perlin(p, 8, 3);
            assert!(value.abs() < 1.0, "perlin({p}) = {value}");
            (sum, squares) = (sum + value, squares + value * value);
            let (fbm, pw) = (worley_fbm(p, 4, 19), perlin_worley(p, 3));
            assert!((0.0..=1.0).contains(&fbm) && (fbm..=1.0).contains(&pw), "worley_fbm {fbm}, perlin_worley {pw}");
            let cell = worley_cell(p, 5, 9);
            assert!(0.0 <= cell.f1 && cell.f1 <= cell.f2, "{cell:?}");
        }
        let (mean, deviation) = (sum / 4000.0, (squares / 4000.0).sqrt());
        assert!(mean.abs() < 0.02, "the mean of perlin is 0, not {mean}");
        assert!((0.15..0.25).contains(&deviation), "the deviation of perlin is about 0.2, not {deviation}");
    }

    #[test]
    fn the_flow_has_the_stated_speed() {
        let speeds: Vec<f32> = positions(4000).map(|p| curl2(p.truncate(), 8, 3, 1e-3).length()).collect();
        let mean = speeds.iter().sum::<f32>() / 4000.0;
        let fastest = speeds.iter().fold(0.0, |a: f32, b| a.max(*b));
        assert!((0.5..0.7).contains(&mean) && fastest < 3.0, "mean speed {mean}, greatest {fastest}");
    }

    #[test]
    fn seeds_are_not_shifts_of_each_other() {
        let differs = positions(200).filter(|p| (perlin(*p, 4, 1) - perlin(*p + 0.25, 4, 2)).abs() > 1e-3).count();
        assert!(differs > 180, "only {differs} of 200 values differ");
    }

    #[test]
    fn lattices_wrap_at_negative_cells_too() {
        assert_eq!(wrap_cell(IVec3::new(-1, -8, 9), 4), IVec3::new(3, 0, 1));
    }
}
