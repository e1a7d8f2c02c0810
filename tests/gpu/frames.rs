//! Whole frames: the same twice, the same in slices, without a seam, and finite under any settings.

use std::time::{Duration, Instant};

use nephoscope::render::Progress;
use nephoscope::scene::builtin::BUILTINS;
use nephoscope::scene::random::randomise;
use nephoscope::scene::{
    DensityModel, DomainKind, Frame, MapSource, Output, Projection, Quality, Scene, UpdateFraction,
};

use crate::common::Random;
use crate::common::sky::{frame, linear, quick, render, renderer};
use crate::common::thorough;

fn bits(rgba: &[[f32; 4]]) -> Vec<[u32; 4]> {
    rgba.iter().map(|texel| texel.map(f32::to_bits)).collect()
}

#[test]
fn the_same_frame_twice_is_the_same_to_the_byte() {
    for builtin in [&BUILTINS[0], &BUILTINS[6]] {
        let scene = builtin.preset().unwrap_or_else(|error| panic!("{error}")).scene;
        let quality = quick();
        let take = || {
            let light = linear(&scene, &quality, [48, 27]);
            let mut renderer = renderer();
            render(&mut renderer, &frame(&scene, &quality, [48, 27], Output::Display));
            (bits(&light.rgba), renderer.display_rgba8().expect("it can be read"))
        };
        assert_eq!(take(), take(), "{}", builtin.name);
    }
}

#[test]
fn slices_make_the_picture_that_a_whole_frame_makes() {
    let scene = Scene::default();
    for update in [UpdateFraction::Full, UpdateFraction::Quarter] {
        let quality = Quality { update, ..quick() };
        let frame = frame(&scene, &quality, [80, 45], Output::Display);
        let mut renderer = renderer();
        let mut whole = Vec::new();
        for _ in 0..2 {
            render(&mut renderer, &frame);
            whole.push((
                renderer.display_rgba8().expect("it can be read"),
                renderer.clouds().expect("they can be read"),
            ));
        }
        // Another picture in the same targets, so that nothing is right by being left over.
        let mut other = scene.clone();
        other.weather.coverage = 0.8;
        render(&mut renderer, &Frame { scene: &other, ..frame });
        renderer.forget_history();
        for (index, expected) in whole.into_iter().enumerate() {
            renderer.begin(&frame).unwrap_or_else(|error| panic!("{error}"));
            let (started, mut slices) = (Instant::now(), 0);
            loop {
                match renderer.advance(Duration::from_millis(2)).unwrap_or_else(|error| panic!("{error}")) {
                    Progress::Finished(report) => {
                        assert!(report.passes.iter().any(|time| time.pass == "march"), "the march ran in slices");
                        break;
                    }
                    Progress::Compiling => renderer.begin(&frame).unwrap_or_else(|error| panic!("{error}")),
                    Progress::Working => slices += 1,
                    Progress::Idle => panic!("the frame was lost"),
                }
                assert!(started.elapsed() < Duration::from_secs(60), "the frame never ended");
                std::thread::yield_now();
            }
            assert!(slices > 2, "{slices} slices are no slices");
            let display = renderer.display_rgba8().expect("it can be read");
            assert!(display == expected.0, "{update:?}, frame {index}: the display differs");
            assert_eq!(renderer.clouds().expect("they can be read"), expected.1, "{update:?}, frame {index}: clouds");
        }
    }
}

#[test]
fn a_panorama_has_no_seam_where_its_ends_meet() {
    // Half a turn moves the picture by half its width, a whole number of tiles of the jitter; so what was at the seam
    // is in the middle, and must look the same.
    let mut scene = Scene::default();
    scene.camera.projection = Projection::Equirect;
    scene.weather.coverage = 0.6;
    scene.ground.visible = false;
    let picture = |heading_deg: f32| {
        let mut scene = scene.clone();
        scene.camera.heading_deg = heading_deg;
        linear(&scene, &quick(), [128, 24]).rgba
    };
    let (ahead, behind) = (picture(40.0), picture(220.0));
    let brightest = ahead.iter().take(128 * 12).fold(0.0_f32, |most, texel| most.max(texel[1].min(50.0)));
    let mut worst = 0.0_f32;
    let mut sum = 0.0;
    for row in 0..12 {
        for column in 0..128 {
            let (a, b) = (ahead[row * 128 + column], behind[row * 128 + (column + 64) % 128]);
            let error = (a[1].min(50.0) - b[1].min(50.0)).abs() / brightest;
            sum += error;
            if column == 0 || column == 127 {
                worst = worst.max(error);
            }
        }
    }
    let mean = sum / (12.0 * 128.0);
    assert!(mean < 2e-3, "the turned panorama differs by {mean} on average");
    assert!(worst < 2e-2, "the seam differs by {worst}");
}

fn is_light(texel: &[f32; 4]) -> bool {
    texel.iter().all(|value| value.is_finite() && *value >= 0.0) && texel[3] <= 1.0
}

/// Any scene in range, and a quality that llvmpipe can afford.
fn random_sky(seed: u32) -> (Scene, Quality) {
    let (mut scene, mut quality) = (Scene::default(), quick());
    randomise(&mut scene, seed);
    for map in &mut scene.weather.layers {
        map.source = MapSource::Generated;
    }
    let mut random = Random::new(seed);
    quality.step_m = random.pick(&[1.0, 34.0, 1000.0]);
    quality.step_growth = random.pick(&[0.0, 0.006, 0.1]);
    quality.empty_stride = random.pick(&[1.0, 3.0, 8.0]);
    quality.light_growth = random.pick(&[1.0, 1.9, 4.0]);
    quality.light_reach_m = random.pick(&[50.0, 2600.0, 20_000.0]);
    quality.early_exit = random.pick(&[0.0, 0.01, 0.2]);
    quality.noise_level_bias = random.pick(&[-4.0, 0.0, 4.0]);
    // Values are random, forms of the shaders are few: each has to be compiled.
    // At night there are no octaves, which would double the forms of all the others.
    quality.octaves = if seed % 4 == 1 { 2 } else { 0 };
    scene.weather.coverage_changes = true;
    scene.air.aerial_perspective = true;
    (scene.ground.visible, scene.camera.pitch_deg) = (true, scene.camera.pitch_deg.min(20.0));
    let (domain, models): (DomainKind, &[DensityModel]) = match seed % 4 {
        0 => (DomainKind::Shell, &[DensityModel::Profile, DensityModel::Thesis]),
        1 => (DomainKind::Flat, &[DensityModel::Profile]),
        2 => (DomainKind::Box, &[DensityModel::Texture, DensityModel::Product, DensityModel::Grid]),
        _ => (DomainKind::Shell, &[DensityModel::Uniform]),
    };
    scene.domain.kind = domain;
    scene.plain_light.enabled = domain == DomainKind::Box;
    scene.layers.resize_with(models.len(), Default::default);
    for (layer, model) in scene.layers.iter_mut().zip(models) {
        (layer.enabled, layer.model) = (true, *model);
        layer.grid.0 = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/ball.npy").to_owned();
    }
    (scene, quality)
}

#[test]
fn any_sky_in_range_is_finite_light() {
    let (mut lit, draws) = (0, if thorough() { 40 } else { 16 });
    for seed in 0..draws {
        let (scene, quality) = random_sky(seed);
        let output = if seed % 8 == 1 { Output::CloudsAlone } else { Output::Linear };
        let mut renderer = renderer();
        render(&mut renderer, &frame(&scene, &quality, [32, 18], output));
        let image = renderer.linear().expect("it can be read");
        let bad = image.rgba.iter().position(|texel| !is_light(texel));
        assert_eq!(bad, None, "seed {seed}, {output:?}: {:?} in {scene:?}", bad.map(|at| image.rgba[at]));
        assert!(
            image.distance_m.iter().all(|distance| distance.is_finite() && *distance >= 0.0),
            "seed {seed}: distance"
        );
        assert!(output == Output::CloudsAlone || image.rgba.iter().all(|texel| texel[3] == 1.0), "seed {seed}: opaque");
        lit += u32::from(image.rgba.iter().any(|texel| texel[1] > 0.0));
    }
    assert!(lit * 8 > draws * 5, "only {lit} of {draws} pictures show anything");
}

#[test]
fn the_sun_goes_through_the_horizon_without_a_flash() {
    let mut scene = Scene::default();
    scene.weather.coverage = 0.6;
    scene.camera.heading_deg = scene.sun.azimuth_deg;
    let mut before: Option<f64> = None;
    for step in 0..=24 {
        scene.sun.elevation_deg = 3.0 - step as f32 * 0.25;
        let image = linear(&scene, &quick(), [32, 18]);
        let bad = image.rgba.iter().position(|texel| !is_light(texel));
        assert_eq!(bad, None, "sun at {}°: {:?}", scene.sun.elevation_deg, bad.map(|at| image.rgba[at]));
        // The upper rows hold no disc.
        let mean: f64 = image.rgba[..6 * 32].iter().map(|texel| f64::from(texel[1])).sum::<f64>() / 192.0;
        let candela = mean * f64::from(image.candela_per_unit);
        if let Some(before) = before {
            let change = (candela / before).ln();
            assert!(
                (-0.7..0.1).contains(&change),
                "sun at {}°: from {before} to {candela} cd/m²",
                scene.sun.elevation_deg
            );
        }
        before = Some(candela);
    }
}

#[test]
fn the_smallest_pictures_are_pictures() {
    for size in [[1, 1], [1, 7], [7, 1], [3, 5]] {
        let image = linear(&Scene::default(), &quick(), size);
        assert_eq!(image.rgba.len(), (size[0] * size[1]) as usize, "{size:?}");
        assert!(image.rgba.iter().all(is_light), "{size:?}: {:?}", image.rgba);
    }
}
