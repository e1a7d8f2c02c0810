//! Stills: several samples of each pixel, in light for files and on the screen.

use std::time::Duration;

use nephoscope::export::exr::{ExrDepth, ExrOptions};
use nephoscope::files::{About, Content, StillFile};
use nephoscope::gpu::readback;
use nephoscope::render::truth::Goal;
use nephoscope::render::{Proceed, Renderer};
use nephoscope::scene::{Frame, Output, Preset, Projection, Quality, Scene, Window};

use crate::common::gpu;
use crate::common::sky::{frame, quick, render, renderer};

/// Clear sky and the sun, whose disc is ten pixels wide.
fn sun_in_view() -> Scene {
    let mut scene = Scene::default();
    scene.layers.clear();
    scene.ground.visible = false;
    scene.sunshafts.strength = 0.0;
    (scene.sun.elevation_deg, scene.camera.pitch_deg) = (30.0, 30.0);
    scene.camera.heading_deg = scene.sun.azimuth_deg;
    scene.camera.field_of_view_deg = 2.0;
    // The disc is white on the screen, and the sky is not.
    scene.display.exposure_ev = 16.0;
    scene
}

const SMALL: [u32; 2] = [40, 40];

/// Linear light and display of a finished still.
fn still(scene: &Scene, pixel_samples: u32, size: [u32; 2]) -> (Vec<[f32; 4]>, Vec<u8>) {
    let mut renderer = renderer();
    let quality = Quality { pixel_samples, still_step: 1.0, ..quick() };
    let still = renderer.still(&frame(scene, &quality, size, Output::Linear)).expect("it can be rendered");
    assert_eq!(still.pixel_samples(), (pixel_samples, pixel_samples), "all are finished");
    let light = still.picture(&renderer).expect("it can be read").image.rgba;
    (light, readback::texture(gpu(), &still.into_display()).expect("it can be read"))
}

/// The mean of each 8×8 pixels.
fn reduced(large: &[f32]) -> Vec<f32> {
    let [width, height] = SMALL.map(|side| side as usize);
    let mean = |x: usize, y: usize| {
        let inside = (0..64).map(|at| large[(8 * y + at / 8) * 8 * width + 8 * x + at % 8]);
        inside.sum::<f32>() / 64.0
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect()
}

fn greatest_difference(seen: &[f32], expected: &[f32]) -> f32 {
    let greatest = expected.iter().copied().fold(0.0f32, f32::max);
    seen.iter().zip(expected).map(|(seen, expected)| (seen - expected).abs() / greatest).fold(0.0, f32::max)
}

fn display_light(bytes: &[u8]) -> Vec<f32> {
    let decoded = |byte: u8| {
        let c = f32::from(byte) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    bytes.chunks_exact(4).map(|pixel| decoded(pixel[1])).collect()
}

#[test]
fn samples_give_the_mean_over_the_pixel_in_light_and_on_the_screen() {
    let scene = sun_in_view();
    let green = |rgba: &[[f32; 4]]| -> Vec<f32> { rgba.iter().map(|light| light[1]).collect() };
    let (large, large_shown) = still(&scene, 1, SMALL.map(|side| 8 * side));
    let (expected, expected_shown) = (reduced(&green(&large)), reduced(&display_light(&large_shown)));
    let (many, many_shown) = still(&scene, 64, SMALL);
    let (one, one_shown) = still(&scene, 1, SMALL);
    for (name, many, one, expected, least) in [
        // In light the disc has a soft edge of its own.
        ("light", green(&many), green(&one), expected, 0.08),
        ("screen", display_light(&many_shown), display_light(&one_shown), expected_shown, 0.3),
    ] {
        let (smooth, rough) = (greatest_difference(&many, &expected), greatest_difference(&one, &expected));
        // Of 64 samples about three fall on the other side of an edge than 64 others do.
        assert!(smooth < 0.06, "{name}: {smooth} off");
        assert!(rough > least, "{name}: one sample has rough edges, {rough}");
    }
}

#[test]
fn a_still_of_one_sample_is_the_frame_bit_for_bit() {
    let scene = Scene::default();
    let (seen, seen_shown) = still(&scene, 1, SMALL);
    let mut renderer = renderer();
    render(&mut renderer, &frame(&scene, &quick(), SMALL, Output::Linear));
    let light = renderer.linear().expect("it can be read").rgba;
    let bits = |rgba: &[[f32; 4]]| -> Vec<[u32; 4]> { rgba.iter().map(|light| light.map(f32::to_bits)).collect() };
    assert_eq!(bits(&seen), bits(&light));
    assert_eq!(seen_shown, renderer.display_rgba8().expect("it can be read").1);
}

fn converged(renderer: &mut Renderer, scene: &Scene, pixel_samples: u32) -> Vec<[f32; 4]> {
    let quality = Quality { pixel_samples, ..quick() };
    let frame = frame(scene, &quality, SMALL, Output::Linear);
    let goal = Goal::Converged { tolerance: 0.9, levels: 2 };
    let mut truth = renderer.begin_truth(&frame, goal, pixel_samples).expect("it begins");
    let slice = Duration::from_millis(100);
    while !truth.advance(renderer, slice, slice).expect("it goes on").is_done {}
    assert_eq!(truth.progress().pixel_samples, pixel_samples, "all are finished");
    truth.picture(renderer).expect("it can be read").image.rgba
}

#[test]
fn converged_pictures_have_their_samples_too() {
    let scene = sun_in_view();
    let expected = still(&scene, 4, SMALL).0;
    assert_eq!(converged(&mut renderer(), &scene, 4), expected, "without cloud both are the same passes");

    let mut scene = Scene::default();
    scene.camera.pitch_deg = 25.0;
    let mean = |rgba: &[[f32; 4]]| rgba.iter().map(|light| f64::from(light[1])).sum::<f64>() / rgba.len() as f64;
    let mut renderer = renderer();
    let (one, several) = (converged(&mut renderer, &scene, 1), converged(&mut renderer, &scene, 3));
    assert_ne!(one, several, "other rays");
    let ratio = mean(&several) / mean(&one);
    assert!((ratio - 1.0).abs() < 0.02, "of the same sky: {ratio}");
}

#[test]
fn layers_sum_to_the_picture_and_follow_their_lights() {
    let mut scene = Scene::default();
    scene.sunshafts.strength = 0.8;
    scene.camera.heading_deg = scene.sun.azimuth_deg;
    scene.camera.pitch_deg = 30.0;
    scene.camera.field_of_view_deg = 70.0;
    scene.scattering.glow = 0.5;
    let quality = Quality { octaves: 3, pixel_samples: 2, still_step: 1.0, ..quick() };
    let mut renderer = renderer();
    let mut layers_of = |scene: &Scene| {
        let mut shares = Vec::new();
        let mut proceed = |share: f32| {
            shares.push(share);
            Proceed::On
        };
        let layers = renderer.layers(&frame(scene, &quality, [48, 27], Output::Linear), &mut proceed);
        let layers = layers.expect("it can be rendered").expect("it was wanted");
        assert!(shares.is_sorted() && shares.iter().all(|share| (0.0..=1.0).contains(share)), "{shares:?}");
        assert!(renderer.forced().is_empty(), "nothing stays forced");
        layers
    };
    let whole = layers_of(&scene);
    let names: Vec<&str> = whole.lights.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["shafts", "glow", "multiple", "direct", "bounce", "ambient", "air", "disc", "backdrop"]);
    let greatest = whole.beauty.rgba.iter().flat_map(|pixel| &pixel[..3]).copied().fold(0.0, f32::max);
    for (index, pixel) in whole.beauty.rgba.iter().enumerate() {
        for channel in 0..3 {
            let parts: Vec<f32> = whole.lights.iter().map(|(_, light)| light[index][channel]).collect();
            let sum: f32 = parts.iter().sum();
            assert!((sum - pixel[channel]).abs() <= 1e-6 * greatest, "{sum} for {} of {parts:?}", pixel[channel]);
            assert!(parts.iter().all(|part| *part >= -1e-5 * greatest), "no light takes any away: {parts:?}");
        }
    }
    let total = |layers: &nephoscope::render::Layers, wanted: &str| {
        let light = layers.lights.iter().find(|(name, _)| *name == wanted).map(|(_, light)| light);
        let sum: f32 = light.into_iter().flatten().flatten().sum();
        f64::from(sum) * f64::from(layers.beauty.candela_per_unit)
    };
    // Twice the sunlight is twice the light of it, and the sky is the sun's as well; no ambient light is none.
    let mut other = scene.clone();
    other.sun.illuminance_klx *= 2.0;
    let brighter = layers_of(&other);
    for name in ["direct", "multiple"] {
        let ratio = total(&brighter, name) / total(&whole, name);
        assert!((ratio - 2.0).abs() < 0.01, "{name}: {ratio}");
    }
    other.scattering.ambient = 0.0;
    let darker = layers_of(&other);
    assert_eq!((total(&darker, "ambient"), total(&darker, "bounce")), (0.0, 0.0));
    let ratio = total(&darker, "direct") / total(&brighter, "direct");
    assert!((ratio - 1.0).abs() < 1e-4, "the sun does not care: {ratio}");
}

#[test]
fn a_still_that_is_given_up_is_no_picture_and_the_next_one_is() {
    let (scene, quality) = (Scene::default(), Quality { pixel_samples: 64, still_step: 1.0, ..quick() });
    let mut renderer = renderer();
    let large = frame(&scene, &quality, [320, 180], Output::Linear);
    let given_up = renderer
        .still_while(&large, &mut |share| if share == 0.0 { Proceed::On } else { Proceed::No })
        .expect("nothing fails");
    assert!(given_up.is_none(), "it was not wanted any more");
    assert!(
        renderer.layers(&large, &mut |_| Proceed::No).expect("nothing fails").is_none() && renderer.forced().is_empty()
    );
    let one = Quality { pixel_samples: 1, ..quality.clone() };
    let small = frame(&scene, &one, [32, 18], Output::Linear);
    assert!(renderer.still_while(&small, &mut |_| Proceed::On).expect("nothing fails").is_some());
}

#[test]
fn a_still_that_ends_early_holds_the_samples_that_were_finished_and_nothing_of_the_next() {
    let (scene, quality) = (Scene::default(), quick());
    let mut renderer = renderer();
    let frame = frame(&scene, &quality, [48, 27], Output::Linear);
    let mut ended_after = |more_jobs: u32| {
        let mut still = renderer.begin_still(&frame, 8).expect("nothing fails");
        while still.pixel_samples().0 < 2 {
            assert!(!still.advance(&renderer, Duration::ZERO).expect("nothing fails"), "there are eight");
        }
        for _ in 0..more_jobs {
            still.advance(&renderer, Duration::ZERO).expect("nothing fails");
        }
        still.end();
        while !still.advance(&renderer, Duration::ZERO).expect("nothing fails") {}
        (still.pixel_samples().0, still.picture(&renderer).expect("nothing fails").image.rgba)
    };
    let (count, two) = ended_after(0);
    assert_eq!(count, 2);
    let (mut dropped, mut added) = (0, 0);
    for more_jobs in 1.. {
        let (count, picture) = ended_after(more_jobs);
        match count {
            2 => assert!(picture == two, "{more_jobs} jobs of the third left something behind"),
            _ => assert!(picture != two, "the third sample is in it"),
        }
        (dropped, added) = (dropped + u32::from(count == 2), added + u32::from(count == 3));
        if added > 1 {
            break;
        }
    }
    assert!(dropped > 0, "some were dropped");
}

#[test]
fn parts_of_a_picture_are_cut_from_the_whole() {
    let quality = Quality { pixel_samples: 2, ..quick() };
    for projection in [Projection::Perspective, Projection::Equirect] {
        let mut scene = Scene::default();
        scene.camera.projection = projection;
        scene.camera.roll_deg = 4.0;
        scene.sunshafts.strength = 0.0;
        let whole = [96, 160];
        let mut renderer = renderer();
        let mut take = |window: Option<Window>, size: [u32; 2]| {
            let frame = Frame { window, ..frame(&scene, &quality, size, Output::Linear) };
            let still = renderer.still(&frame).expect("it can be rendered");
            still.picture(&renderer).expect("it can be read").image.rgba
        };
        let expected = take(None, whole);
        // The jitter's pattern has 64 pixels: parts that begin with it have the same.
        for (offset, size) in [([0, 0], [96, 64]), ([0, 64], [96, 96]), ([64, 64], [32, 40])] {
            let part = take(Some(Window { offset, whole }), size);
            let gaps = part.iter().enumerate().map(|(index, seen)| {
                let index = u32::try_from(index).expect("a small picture");
                let (x, y) = (offset[0] + index % size[0], offset[1] + index / size[0]);
                let own = expected[(y * whole[0] + x) as usize];
                (seen[1] - own[1]).abs() / own[1].max(1e-4)
            });
            // Rounding of a direction may let a ray that grazes a cloud take another step.
            let gaps: Vec<f32> = gaps.collect();
            let (mean, far) =
                (gaps.iter().sum::<f32>() / gaps.len() as f32, gaps.iter().filter(|gap| **gap > 2e-3).count());
            assert!(mean < 2e-4, "{projection:?}: {mean} off in the mean");
            assert!(far * 100 <= gaps.len(), "{projection:?}: {far} of {} pixels differ", gaps.len());
        }
    }
}

#[test]
fn large_pictures_are_written_in_bands() {
    let quality = Quality { pixel_samples: 1, ..quick() };
    let mut preset = Preset::new("Large", Scene::default());
    preset.scene.camera.projection = Projection::Equirect;
    preset.scene.sunshafts.strength = 0.0;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut renderer = renderer();
    let mut write = |name: &str, content: Content, largest_whole: u64| {
        let path = folder.path().join(name);
        let about = About { preset: &preset, quality: &quality, time_secs: 0.0 };
        let file = StillFile {
            path: &path,
            content,
            size: [48, 160],
            cube: None,
            region: None,
            frame_secs: 0.1,
            brightest: None,
            largest_whole,
            about,
        };
        let mut shares = Vec::new();
        let written = file.render(&mut renderer, &mut |share| {
            shares.push(share);
            Proceed::On
        });
        assert!(written.expect("it can be rendered"), "nobody gave it up");
        assert!(shares.is_sorted() && shares.last() == Some(&1.0), "{shares:?}");
        path
    };
    let options = ExrOptions { depth: ExrDepth::Float, ..ExrOptions::default() };
    let light = |path: &std::path::Path| nephoscope::images::map::read_exr(path).expect("it is sound").rgba;
    let whole = light(&write("whole.exr", Content::Linear(options), u64::MAX));
    let bands = light(&write("bands.exr", Content::Linear(options), 48 * 100));
    assert_eq!(whole.len(), bands.len());
    let gap: f32 = whole.iter().zip(&bands).map(|(whole, band)| (whole[1] - band[1]).abs() / whole[1].max(1e-4)).sum();
    assert!(gap / (whole.len() as f32) < 2e-4, "{gap}");
    let shown = |path: &std::path::Path| image::open(path).expect("it is sound").to_rgb8();
    let whole = shown(&write("whole.png", Content::Display, u64::MAX));
    let bands = shown(&write("bands.png", Content::Display, 48 * 100));
    assert_eq!(whole.dimensions(), bands.dimensions());
    let far = whole.pixels().zip(bands.pixels()).filter(|(whole, band)| whole.0[1].abs_diff(band.0[1]) > 1).count();
    assert!(far < 77, "{far} of 7680 pixels differ");
}
