//! `common/math.wgsl` against its twin.

use nephoscope::reference::math;

use crate::common::{Case, Random, bits4, eval};

fn cases(values: impl IntoIterator<Item = [f32; 4]>) -> Vec<Case> {
    values.into_iter().map(|v| [bits4(v), [0; 4], [0; 4], [0; 4]]).collect()
}

#[test]
fn absorption_is_accurate_from_nothing_to_opaque() {
    let mut depths: Vec<f32> = (0..=42_000).map(|i| 10f32.powf(-38.0 + i as f32 * 1e-3)).collect();
    depths.extend([0.0, f32::MIN_POSITIVE, 0.5, 0.499_999_97, 87.3, 88.8, 1e30, f32::MAX]);
    let results = eval("math", "eval_absorption", &cases(depths.iter().map(|x| [*x, 0.0, 0.0, 0.0])));
    for (x, [weight, share, ..]) in depths.iter().zip(results) {
        let exact = f64::from(*x);
        let expected = math::absorption_weight(exact);
        assert!((f64::from(weight) - expected).abs() <= 1e-6 * expected, "W({x:e}) = {weight:e}, not {expected:e}");
        let expected = math::absorbed(exact);
        // Denormal depths may be flushed to zero.
        let tolerance = (1e-6 * expected).max(1.2e-38);
        assert!((f64::from(share) - expected).abs() <= tolerance, "absorbed({x:e}) = {share:e}, not {expected:e}");
        assert!((0.0..=1.0).contains(&share), "absorbed({x:e}) = {share}");
    }
}

#[test]
fn remap01_follows_its_twin_and_survives_empty_ranges() {
    let mut random = Random::new(1);
    let mut inputs: Vec<[f32; 4]> = (0..2000).map(|_| std::array::from_fn(|_| random.between(-3.0, 3.0))).collect();
    inputs.extend([[1.0, 1.0, 1.0, 0.0], [2.0, 1.0, 1.0, 0.0], [0.0, 2.0, 1.0, 0.0], [9.0, 2.0, 1.0, 0.0]]);
    for (input, result) in inputs.iter().zip(eval("math", "eval_remap01", &cases(inputs.iter().copied()))) {
        let [x, a, b, _] = input.map(f64::from);
        let expected = math::remap01(x, a, b);
        // The difference b - a is what rounding acts on.
        let tolerance = 1e-6 + 1e-6 / (b - a).max(1e-4);
        assert!(
            (f64::from(result[0]) - expected).abs() <= tolerance,
            "remap01{input:?} = {}, not {expected}",
            result[0]
        );
    }
}

#[test]
fn sanitise_lets_nothing_bad_through() {
    let bad = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::from_bits(0x7f80_0001)];
    let good = [0.0, -0.0, -1.0, 1e-3, 1.0, 65504.0, 65505.0, 1e30, -1e30, f32::MAX];
    let mut inputs = Vec::new();
    for value in bad.into_iter().chain(good) {
        inputs.extend([[value, 1.0, 2.0, 3.0], [1.0, value, 2.0, 3.0], [1.0, 2.0, value, 3.0], [1.0, 2.0, 3.0, value]]);
    }
    for (input, result) in inputs.iter().zip(eval("math", "eval_sanitise", &cases(inputs.iter().copied()))) {
        for (x, y) in input.iter().zip(result) {
            assert_eq!(f64::from(y), math::sanitise(f64::from(*x)), "{input:?} became {result:?}");
        }
    }
}

#[test]
fn luminance_follows_its_twin() {
    let mut random = Random::new(2);
    let inputs: Vec<[f32; 4]> = (0..500).map(|_| std::array::from_fn(|_| random.between(0.0, 5e4))).collect();
    for (input, result) in inputs.iter().zip(eval("math", "eval_luminance709", &cases(inputs.iter().copied()))) {
        let [r, g, b, _] = input.map(f64::from);
        let expected = math::luminance709([r, g, b]);
        assert!((f64::from(result[0]) - expected).abs() <= 1e-6 * expected, "{input:?}: {} not {expected}", result[0]);
    }
}
