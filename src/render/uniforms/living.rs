//! The cellular automaton as shaders take it.

use glam::IVec2;

use super::clouds::wind_mps;
use super::other::AutomatonUniforms;
use crate::scene::{Automaton, CHAPTER, Generation, Wind};

/// Standard deviation of the broad noise about its mean, a half.
const DEVIATION: f32 = 0.121;

/// What the shaders are told of a generation of an automaton whose tops a wind carries on, or none.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers, clamped before")]
pub fn automaton_uniforms(automaton: &Automaton, shear: Option<&Wind>, generation: Generation) -> AutomatonUniforms {
    // In 65536ths of a cell.
    let shear = shear.map_or(IVec2::ZERO, |wind| {
        let way = wind_mps(&Wind { speed_mps: 1.0, ..wind.clone() }) * f64::from(automaton.shear) * 65_536.0;
        IVec2::new(way.x as i32, way.y as i32)
    });
    let chance = |chance: f32| (chance * 65_535.0).round() as u32;
    // How many deviations below the mean a share of a normal distribution begins: its logistic neighbour.
    let share = automaton.coverage.clamp(1e-3, 1.0 - 1e-3);
    let below = (share / (1.0 - share)).ln() / 1.702;
    let threshold = if automaton.coverage > 0.0 { 0.5 - DEVIATION * below } else { 2.0 };
    let patches = automaton.chapter(generation) as f64 * f64::from(automaton.change) * f64::from(CHAPTER) / 100.0;
    // The noise repeats after a million patches.
    let phase = (patches.rem_euclid(1_048_576.0) * 4096.0) as u64;
    AutomatonUniforms {
        shear,
        cells: automaton.cells,
        levels: automaton.levels,
        seed: automaton.seed,
        patches: automaton.patches,
        phase: phase as u32,
        threshold: (threshold * 65_536.0) as i32,
        gain: (256.0 / (2.0 * DEVIATION)) as i32,
        slope: (256.0 / automaton.height.max(0.01)) as i32,
        vapour: chance(automaton.vapour),
        activation: chance(automaton.activation),
        extinction: chance(automaton.extinction),
        dissolution: chance(automaton.extinction.max(1.0 / 3.0)),
        index: generation.index,
        run: run_bits(generation.epoch, automaton.seed),
    }
}

/// Random bits of a run: the finaliser of `SplitMix64` (Steele, Lea and Flood 2014).
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bits")]
fn run_bits(epoch: i64, seed: u32) -> u32 {
    let mut bits = (epoch as u64).wrapping_add(u64::from(seed)).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ u64::from(seed);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (bits >> 32) as u32
}
