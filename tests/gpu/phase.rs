//! `cloud/phase.wgsl`: closed forms, normalisation, mean cosine, extremes.

use std::f64::consts::PI;

use glam::Vec3;
use nephoscope::reference::phase::{self, KIND_NAMES, PhaseShape};

use crate::common::{Case, Random, bits3, bits4, eval, exact_direction};

fn case(shape: PhaseShape, scale: f32, view_dir: Vec3, towards_sun: Vec3) -> Case {
    let [g, back_g, back_mix] = [shape.g, shape.back_g, shape.back_mix].map(|v| nearest(v).to_bits());
    let sun = bits4([towards_sun.x, towards_sun.y, towards_sun.z, scale]);
    [bits3(view_dir), sun, [g, back_g, back_mix, shape.kind], [0; 4]]
}

/// The nearest f32, so that shader and twin start from the same numbers.
#[expect(clippy::cast_possible_truncation, reason = "the shader's input is f32")]
fn nearest(v: f64) -> f32 {
    v as f32
}

fn shape(kind: u32, g: f32) -> PhaseShape {
    PhaseShape { kind, g: f64::from(g), back_g: f64::from(-0.25_f32), back_mix: f64::from(0.3_f32) }
}

fn kinds() -> impl Iterator<Item = u32> {
    (0..).zip(KIND_NAMES).map(|(kind, _)| kind)
}

#[test]
fn values_follow_the_twin_up_to_the_sun() {
    let mut random = Random::new(4);
    let mut inputs = Vec::new();
    for kind in kinds() {
        for _ in 0..3000 {
            let g = random.pick(&[-1.0, -0.99, -0.5, 0.0, 1e-4, 0.5, 0.85, 0.9, 0.99, 1.0]);
            let sun = random.direction();
            // Half of the directions crowd around the sun and the point opposite to it.
            let spread = random.pick(&[1e-5, 1e-3, 0.03, 10.0, 10.0, 10.0]);
            let side = random.pick(&[-1.0, 1.0]);
            let view = (sun * side + random.direction() * spread).normalize();
            inputs.push((shape(kind, g), random.pick(&[1.0, 0.55, 0.0]), view, sun));
        }
    }
    let cases: Vec<Case> = inputs.iter().map(|(shape, scale, v, s)| case(*shape, *scale, *v, *s)).collect();
    for ((shape, scale, view, sun), result) in inputs.iter().zip(eval("phase", "eval_phase", &cases)) {
        let cosine = exact_direction(*view).dot(exact_direction(*sun)).clamp(-1.0, 1.0);
        for (value, scale) in [(result[0], 1.0), (result[1], f64::from(*scale))] {
            let expected = phase::phase_scaled(*shape, scale, cosine);
            let error = (f64::from(value) - expected).abs() / expected;
            assert!(error < 2e-5, "{shape:?} x {scale} at cosine {cosine}: {value}, not {expected}");
        }
    }
}

#[test]
fn every_kind_integrates_to_one_with_its_mean_cosine() {
    const STEPS: u32 = 8192;
    let sun = Vec3::new(0.3, 0.5, -0.81).normalize();
    let side = sun.cross(Vec3::Y).normalize();
    let angle = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS) * PI;
    for kind in kinds() {
        for g in [-0.75_f32, 0.0, 0.5, 0.9, 0.99] {
            let shape = shape(kind, g);
            let view = |step| (sun.as_dvec3() * angle(step).cos() + side.as_dvec3() * angle(step).sin()).as_vec3();
            let cases: Vec<Case> = (0..STEPS).map(|step| case(shape, 1.0, view(step), sun)).collect();
            let (mut total, mut mean) = (0.0, 0.0);
            for (step, result) in (0..STEPS).zip(eval("phase", "eval_phase", &cases)) {
                let solid_angle = 2.0 * PI * angle(step).sin() * PI / f64::from(STEPS);
                total += f64::from(result[0]) * solid_angle;
                mean += f64::from(result[0]) * solid_angle * angle(step).cos();
            }
            let name = KIND_NAMES[kind as usize];
            assert!((total - 1.0).abs() < 1e-4, "{name} at g = {g} integrates to {total}");
            let expected = phase::mean_cosine(shape);
            assert!((mean - expected).abs() < 1e-4, "{name} at g = {g} has mean cosine {mean}, not {expected}");
        }
    }
}

#[test]
fn looking_at_the_sun_is_the_forward_peak_and_stays_finite() {
    let mut cases = Vec::new();
    let suns = [Vec3::Y, Vec3::new(0.6, 0.0, 0.8), Vec3::new(1.0, 1e-7, 0.0), Vec3::splat(0.577_350_3)];
    for kind in kinds() {
        for g in [-1.0_f32, 0.85, 0.99, 1.0] {
            for sun in suns {
                cases.extend([case(shape(kind, g), 1.0, sun, sun), case(shape(kind, g), 1.0, -sun, sun)]);
            }
        }
    }
    for (pair, case) in eval("phase", "eval_phase", &cases).chunks(2).zip(cases.chunks(2)) {
        let (ahead, behind) = (pair[0][0], pair[1][0]);
        assert!(ahead.is_finite() && behind.is_finite() && ahead > 0.0 && behind > 0.0, "{ahead} {behind} {case:?}");
        let g = f32::from_bits(case[0][2][0]);
        if [phase::HENYEY_GREENSTEIN, phase::CORNETTE_SHANKS, phase::SCHLICK].contains(&case[0][2][3]) {
            assert_eq!(ahead > 10.0 * behind, g > 0.0, "g = {g}: {ahead} ahead, {behind} behind");
        }
    }
}
