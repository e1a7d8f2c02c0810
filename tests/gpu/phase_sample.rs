//! `cloud/phase_sample.wgsl`: what is drawn follows the phase function that it is drawn from.

use glam::Vec3;
use nephoscope::reference::phase::{self, KIND_NAMES, PhaseShape};

use crate::common::{Case, Random, bits3, eval};

const DRAWS: u32 = 200_000;
const CELLS: usize = 40;

fn drawn(shape: PhaseShape, view_dir: Vec3, seed: u32) -> Vec<[f32; 4]> {
    #[expect(clippy::cast_possible_truncation, reason = "the shader's input is f32")]
    let [g, back_g, back_mix] = [shape.g, shape.back_g, shape.back_mix].map(|v| (v as f32).to_bits());
    let cases: Vec<Case> = (0..DRAWS)
        .map(|index| [bits3(view_dir), [index, seed, 5, 0], [g, back_g, back_mix, shape.kind], [0; 4]])
        .collect();
    cases.chunks(50_000).flat_map(|cases| eval("phase_sample", "eval_phase_sample", cases)).collect()
}

/// Share of directions with a cosine below `cosine`, by Simpson's rule over the closed form.
fn share_below(shape: PhaseShape, cosine: f64) -> f64 {
    const STEPS: u32 = 4000;
    // Steps crowd at both ends, where lobes are.
    let at = |s: f64| -(std::f64::consts::PI * s).cos();
    let end = (-cosine).clamp(-1.0, 1.0).acos() / std::f64::consts::PI;
    let density = |s: f64| {
        let slope = std::f64::consts::PI * (std::f64::consts::PI * s).sin();
        2.0 * std::f64::consts::PI * phase::phase(shape, at(s)) * slope
    };
    let h = end / f64::from(STEPS);
    let sum: f64 = (0..STEPS)
        .map(|i| {
            let s = f64::from(i) * h;
            density(s) + 4.0 * density(s + h / 2.0) + density(s + h)
        })
        .sum();
    sum * h / 6.0
}

#[test]
fn drawn_cosines_follow_the_phase_function() {
    let mut random = Random::new(9);
    for kind in 0..u32::try_from(KIND_NAMES.len()).expect("few kinds") {
        for g in [-0.7, 0.0, 1e-3, 0.5, 0.85, 0.97] {
            let shape = PhaseShape { kind, g, back_g: -0.3, back_mix: 0.25 };
            let view_dir = random.direction();
            let draws = drawn(shape, view_dir, kind);
            // Cells of about equal chance, by the quantiles of the draws themselves at first, counted anew below.
            let mut cosines: Vec<f64> = draws.iter().map(|draw| f64::from(draw[3]).clamp(-1.0, 1.0)).collect();
            cosines.sort_by(f64::total_cmp);
            // Kolmogorov and Smirnov's greatest distance, at as many places as there are cells.
            let count = cosines.len() as f64;
            let worst = (1..CELLS)
                .map(|cell| {
                    let index = cell * cosines.len() / CELLS;
                    (share_below(shape, cosines[index]) - index as f64 / count).abs()
                })
                .fold(0.0, f64::max);
            // 1.95 / sqrt(n) is exceeded with a chance of 0.001.
            assert!(worst < 1.95 / count.sqrt(), "{} g {g}: off by {worst}", KIND_NAMES[kind as usize]);
            let mean = cosines.iter().sum::<f64>() / count;
            let expected = phase::mean_cosine(shape);
            assert!((mean - expected).abs() < 4.0 / count.sqrt(), "{} g {g}: mean {mean}", KIND_NAMES[kind as usize]);
        }
    }
}

#[test]
fn drawn_directions_are_unit_vectors_all_round_the_axis() {
    for axis in [Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::new(0.3, -0.9, -1e-4).normalize()] {
        let shape = PhaseShape { kind: phase::HENYEY_GREENSTEIN, g: 0.6, back_g: 0.0, back_mix: 0.0 };
        let draws = drawn(shape, axis, 3);
        let mut sideways = Vec3::ZERO;
        for [x, y, z, cosine] in &draws {
            let dir = Vec3::new(*x, *y, *z);
            assert!((dir.length() - 1.0).abs() < 1e-5, "{dir}");
            sideways += dir - axis * *cosine;
        }
        let mean = sideways / DRAWS as f32;
        assert!(mean.length() < 6.0 / (DRAWS as f32).sqrt(), "about {axis} directions lean to {mean}");
    }
}
