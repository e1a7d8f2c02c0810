//! Twins of `common/random.wgsl`: the same bits.

use glam::{IVec3, UVec3, Vec3};

/// pcg3d of Jarzynski & Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
#[must_use]
pub fn pcg3d(seed: UVec3) -> UVec3 {
    let mix = |v: [u32; 3]| {
        let [mut x, mut y, mut z] = v;
        x = x.wrapping_add(y.wrapping_mul(z));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        [x, y, z]
    };
    let v = seed.to_array().map(|v| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    UVec3::from_array(mix(mix(v).map(|v| v ^ (v >> 16))))
}

/// Uniform in [0, 1) from the upper 24 bits.
#[must_use]
pub fn unit_from_bits(bits: u32) -> f32 {
    (bits >> 8) as f32 * (-24f32).exp2()
}

/// The random bits of a lattice cell.
#[must_use]
pub fn hash_cell_bits(cell: IVec3, seed: u32) -> UVec3 {
    let step = [0x9e37_79b9_u32, 0x85eb_ca6b, 0xc2b2_ae35].map(|odd| seed.wrapping_mul(odd));
    let [x, y, z] = cell.to_array().map(i32::cast_unsigned);
    pcg3d(UVec3::new(x.wrapping_add(step[0]), y.wrapping_add(step[1]), z.wrapping_add(step[2])))
}

/// Three independent numbers in [0, 1) for a lattice cell.
#[must_use]
pub fn hash_cell(cell: IVec3, seed: u32) -> Vec3 {
    Vec3::from_array(hash_cell_bits(cell, seed).to_array().map(unit_from_bits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pcg3d_gives_the_bits_of_an_independent_evaluation() {
        let table = [
            ([0, 0, 0], [0x9baf_d7c6, 0xa8e8_8a6b, 0x3f15_482c]),
            ([1, 2, 3], [0xfa9f_79a6, 0x48f2_f44c, 0x596f_5ab1]),
            ([u32::MAX, 1 << 31, 12345], [0xae60_5acb, 0xc61a_bbd5, 0x00d0_6099]),
        ];
        for (seed, expected) in table {
            assert_eq!(pcg3d(UVec3::from_array(seed)).to_array(), expected, "pcg3d{seed:?}");
        }
    }

    #[test]
    fn units_are_below_one_and_even() {
        assert!(unit_from_bits(u32::MAX) < 1.0, "the largest bits stay below 1");
        assert_eq!((unit_from_bits(0), unit_from_bits(1 << 31)), (0.0, 0.5));
        let mut sum = Vec3::ZERO;
        for x in 0..32 {
            for y in 0..32 {
                sum += hash_cell(IVec3::new(x, y, -3), 7);
            }
        }
        let mean = sum / 1024.0;
        assert!((mean - 0.5).abs().max_element() < 0.04, "the mean of 1024 cells is 1/2 within 4 sigma, not {mean}");
    }
}
