//! `noise/*.wgsl`: against the twins, across the seams, and the flow's divergence.

use glam::Vec3;
use nephoscope::reference::noise;

use crate::common::{Case, Random, bits3, eval, eval_bits};

#[derive(Clone, Copy, Debug)]
struct Input {
    p: Vec3,
    period: u16,
    octaves: u32,
    seed: u32,
}

impl Input {
    fn random(random: &mut Random) -> Self {
        let p = Vec3::from_array(std::array::from_fn(|_| random.between(-2.0, 3.0)));
        let period = random.pick(&[1, 2, 3, 4, 5, 7, 9, 20, 43]);
        Self { p, period, octaves: random.pick(&[1, 2, 3, 5]), seed: random.pick(&[0, 1, 2, 77, u32::MAX]) }
    }

    fn case(self) -> Case {
        [bits3(self.p), [u32::from(self.period), self.octaves, self.seed, 0], [0; 4], [0; 4]]
    }
}

fn inputs(seed: u32, count: usize) -> Vec<Input> {
    let mut random = Random::new(seed);
    (0..count).map(|_| Input::random(&mut random)).collect()
}

fn cases(inputs: &[Input]) -> Vec<Case> {
    inputs.iter().map(|input| input.case()).collect()
}

/// All values of all noises at the inputs.
fn all_noises(inputs: &[Input]) -> Vec<[f32; 7]> {
    let cases = cases(inputs);
    let single = eval("noise", "eval_single", &cases);
    let fractal = eval("noise", "eval_fractal", &cases);
    single.iter().zip(&fractal).map(|(s, f)| [s[0], s[1], s[2], s[3], f[0], f[1], f[2]]).collect()
}

const NAMES: [&str; 7] = ["perlin", "worley", "curl2.x", "curl2.y", "perlin_fbm", "worley_fbm", "perlin_worley"];

#[test]
fn noises_follow_their_twins() {
    let inputs = inputs(5, 3000);
    for (input, result) in inputs.iter().zip(all_noises(&inputs)) {
        let Input { p, period, octaves, seed } = *input;
        let period = i32::from(period);
        // A hundredth of a cell: small enough for the quotient's error, large enough for f32.
        let flow = noise::curl2(p.truncate(), period, seed, 0.01 / input.period as f32);
        let expected = [
            noise::perlin(p, period, seed),
            noise::worley(p, period, seed),
            flow.x,
            flow.y,
            noise::perlin_fbm(p, period, octaves, seed),
            noise::worley_fbm(p, period, seed),
            noise::perlin_worley(p, seed),
        ];
        // The flow's twin is a difference quotient, all others take the same steps.
        let tolerances = [2e-6, 2e-6, 5e-3, 5e-3, 2e-6, 2e-6, 2e-6];
        for i in 0..7 {
            let (value, expected) = (result[i], expected[i]);
            assert!((value - expected).abs() <= tolerances[i], "{} {input:?}: {value}, not {expected}", NAMES[i]);
        }
    }
}

#[test]
fn worley_cells_follow_their_twin() {
    let inputs = inputs(6, 3000);
    for (input, bits) in inputs.iter().zip(eval_bits("noise", "eval_worley_cell", &cases(&inputs))) {
        let expected = noise::worley_cell(input.p, i32::from(input.period), input.seed);
        let (f1, f2) = (f32::from_bits(bits[0]), f32::from_bits(bits[1]));
        let error = (f1 - expected.f1).abs().max((f2 - expected.f2).abs());
        assert!(error <= 2e-6, "{input:?}: {f1} {f2}, not {expected:?}");
        // Between two points at the same distance either may be the nearest.
        assert!(bits[2] == expected.id || f2 - f1 < 1e-5, "{input:?}: id {}, not {expected:?}", bits[2]);
    }
}

#[test]
fn every_noise_is_the_same_on_both_sides_of_every_seam() {
    let mut near = Vec::new();
    let mut far = Vec::new();
    let mut random = Random::new(7);
    for axis in 0..3 {
        for _ in 0..800 {
            let mut input = Input::random(&mut random);
            input.p = Vec3::from_array(std::array::from_fn(|_| random.between(0.0, 1.0)));
            input.p[axis] = 0.0;
            near.push(input);
            input.p[axis] = 1.0;
            far.push(input);
        }
    }
    for ((input, a), b) in near.iter().zip(all_noises(&near)).zip(all_noises(&far)) {
        assert_eq!(a, b, "{NAMES:?} at {input:?} and one tile on");
    }
}

#[test]
fn every_noise_repeats_inside_the_tile_and_is_continuous_across_the_seam() {
    let here = inputs(8, 1500);
    let there: Vec<Input> =
        here.iter().map(|input| Input { p: input.p + Vec3::new(1.0, -1.0, 1.0), ..*input }).collect();
    for ((input, a), b) in here.iter().zip(all_noises(&here)).zip(all_noises(&there)) {
        for i in 0..7 {
            // p + 1 is rounded, by up to 1.2e-7 tiles, which the finest octave sees as cells; slopes are below 10.
            let tolerance = 1e-5 + 3e-6 * f32::from(input.period.max(16)) * 4.0;
            assert!((a[i] - b[i]).abs() <= tolerance, "{} {input:?}: {} and {}", NAMES[i], a[i], b[i]);
        }
    }
    let sides = [-1e-6_f32, 1e-6].map(|x| {
        let at = |input: &Input| Input { p: Vec3::new(x, input.p.y, input.p.z), ..*input };
        all_noises(&here.iter().map(at).collect::<Vec<_>>())
    });
    for (input, (a, b)) in here.iter().zip(sides[0].iter().zip(&sides[1])) {
        for i in 0..7 {
            let tolerance = 1e-5 + 2e-6 * f32::from(input.period.max(16)) * 10.0;
            assert!((a[i] - b[i]).abs() <= tolerance, "{} jumps at {input:?}: {} and {}", NAMES[i], a[i], b[i]);
        }
    }
}

#[test]
fn the_flow_has_no_divergence() {
    const STEP_CELLS: f32 = 0.01;
    let mut random = Random::new(9);
    let centres: Vec<Input> = (0..500)
        .map(|_| {
            let mut input = Input::random(&mut random);
            // Inside a cell: the noise's third derivative jumps at its sides.
            let cell = Vec3::from_array(std::array::from_fn(|_| random.between(0.0, 8.0).floor()));
            let inside = Vec3::from_array(std::array::from_fn(|_| random.between(0.05, 0.95)));
            input.p = (cell + inside) / f32::from(input.period);
            input
        })
        .collect();
    let flow = |offset_cells: Vec3| {
        let moved = |input: &Input| Input { p: input.p + offset_cells / f32::from(input.period), ..*input };
        let inputs: Vec<Input> = centres.iter().map(moved).collect();
        eval("noise", "eval_single", &cases(&inputs))
    };
    let (east, west) = (flow(Vec3::X * STEP_CELLS), flow(Vec3::NEG_X * STEP_CELLS));
    let (north, south) = (flow(Vec3::Y * STEP_CELLS), flow(Vec3::NEG_Y * STEP_CELLS));
    let mut fastest = 0.0_f32;
    for i in 0..centres.len() {
        let along_x = (east[i][2] - west[i][2]) / (2.0 * STEP_CELLS);
        let along_y = (north[i][3] - south[i][3]) / (2.0 * STEP_CELLS);
        assert!((along_x + along_y).abs() < 0.05, "{:?}: {along_x} + {along_y}", centres[i]);
        fastest = fastest.max(east[i][2].hypot(east[i][3]));
    }
    assert!((0.5..3.0).contains(&fastest), "the flow's greatest speed is {fastest}");
}
