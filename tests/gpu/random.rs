//! `common/random.wgsl` against its twin, bit by bit.

use glam::{IVec3, UVec3};
use nephoscope::reference::random::{hash_cell, pcg3d, unit_from_bits};

use crate::common::{Case, Random, eval, eval_bits};

fn cases() -> Vec<Case> {
    let mut random = Random::new(3);
    let edges = [0, 1, u32::MAX, 1 << 31, 0x7fff_ffff];
    let mut inputs: Vec<[u32; 4]> = edges.into_iter().map(|v| [v, v.wrapping_add(1), 0, v]).collect();
    inputs.extend((0..4096).map(|_| std::array::from_fn(|_| random.bits())));
    inputs.into_iter().map(|v| [v, [0; 4], [0; 4], [0; 4]]).collect()
}

#[test]
fn pcg3d_gives_the_same_bits() {
    let cases = cases();
    for (case, result) in cases.iter().zip(eval_bits("random", "eval_pcg3d", &cases)) {
        let [x, y, z, _] = case[0];
        assert_eq!(result[..3], pcg3d(UVec3::new(x, y, z)).to_array(), "pcg3d({x}, {y}, {z})");
    }
}

#[test]
fn hash_cell_gives_the_same_floats() {
    let cases = cases();
    for (case, result) in cases.iter().zip(eval("random", "eval_hash_cell", &cases)) {
        let [x, y, z, seed] = case[0];
        let cell = IVec3::from_array([x, y, z].map(u32::cast_signed));
        assert_eq!(result[..3], hash_cell(cell, seed).to_array(), "hash_cell({cell}, {seed})");
        assert_eq!(result[3], unit_from_bits(seed), "unit_from_bits({seed})");
        assert!(result.iter().all(|u| (0.0..1.0).contains(u)), "{result:?} is not in [0, 1)");
    }
}
