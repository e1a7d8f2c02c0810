//! Skies that change: no step between two frames is much greater than the others.

use nephoscope::scene::builtin::BUILTINS;
use nephoscope::scene::{Output, Quality, Scene, UpdateFraction, morph};

use crate::common::sky::{frame, render, renderer};
use crate::common::thorough;

const SIZE: [u32; 2] = [32, 18];

/// Mean change of the displayed light between consecutive pictures.
fn steps(sky: &dyn Fn(f32) -> Scene) -> Vec<f64> {
    let quality = Quality {
        update: UpdateFraction::Full,
        pixel_samples: 1,
        shadow_map_px: 64,
        light_grid: 48,
        ..Quality::default()
    };
    let frames = if thorough() { 60 } else { 40 };
    let mut renderer = renderer();
    let pictures: Vec<Vec<u8>> = (0..=frames)
        .map(|index| {
            let scene = sky(index as f32 / frames as f32);
            renderer.forget_history();
            render(&mut renderer, &frame(&scene, &quality, SIZE, Output::Display));
            renderer.display_rgba8().expect("it can be read").1
        })
        .collect();
    let change = |pair: &[Vec<u8>]| {
        let differences = pair[0].iter().zip(&pair[1]).map(|(a, b)| f64::from(a.abs_diff(*b)));
        differences.sum::<f64>() / pair[0].len() as f64
    };
    pictures.windows(2).map(change).collect()
}

/// No step is more than twice those beside it, apart from a few levels of noise.
fn seamless(name: &str, sky: &dyn Fn(f32) -> Scene) {
    const NOISE: f64 = 1.0;
    let steps = steps(sky);
    let all: f64 = steps.iter().sum();
    assert!(all > 10.0, "{name} changes the picture: {all} levels");
    for (index, step) in steps.iter().enumerate() {
        let beside = [index.checked_sub(1), Some(index + 1)];
        let beside = beside.into_iter().flatten().filter_map(|index| steps.get(index)).copied().fold(0.0, f64::max);
        assert!(*step < 2.0 * beside + NOISE, "{name}: {step:.2} levels in frame {index}, beside at most {beside:.2}");
    }
    let greatest = steps.iter().copied().fold(0.0, f64::max);
    println!("{name}: at most {greatest:.2} levels in one of {} frames, {all:.1} in all", steps.len());
}

fn builtin(name: &str) -> Scene {
    let found = BUILTINS.iter().find(|builtin| builtin.name == name).expect("a built-in sky");
    found.preset().expect("it is sound").scene
}

#[test]
fn coverage_type_and_time_of_day_change_without_a_step() {
    let base = builtin("fair_weather");
    let coverage = |share: f32| {
        let mut scene = base.clone();
        scene.weather.coverage = 0.2 + 0.4 * share;
        scene
    };
    seamless("coverage", &coverage);
    let day = |share: f32| {
        let mut scene = base.clone();
        scene.sun.elevation_deg = 60.0 * share - 6.0;
        scene
    };
    seamless("the sun's way", &day);
    let deck = Scene { camera: base.camera.clone(), ..builtin("stratocumulus") };
    let kind = |share: f32| {
        let mut scene = base.clone();
        scene.layers = morph::morph(&base, &deck, share).layers;
        scene
    };
    seamless("type", &kind);
}

#[test]
fn whole_skies_change_without_a_step() {
    let from = builtin("fair_weather");
    let others: &[&str] = if thorough() { &["towering", "cirrus", "living_cumulus"] } else { &["towering"] };
    for name in others {
        let to = Scene { camera: from.camera.clone(), ..builtin(name) };
        seamless(name, &|share| morph::morph(&from, &to, share));
    }
}
