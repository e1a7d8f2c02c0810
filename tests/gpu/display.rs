//! The light meter and the false colours, against the same sums on the processor.

use nephoscope::render::LightHistogram;
use nephoscope::scene::builtin::BUILTINS;
use nephoscope::scene::{FALSE_COLOURS, Frame, Output, ToneMap, UpdateFraction};

use crate::common::sky::{frame, quick, render, renderer};

fn luminance([red, green, blue, _]: [f32; 4]) -> f32 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

#[test]
fn the_meter_counts_the_light_of_the_picture() {
    for name in ["fair_weather", "broken_sunset", "moonlit"] {
        let builtin = BUILTINS.iter().find(|builtin| builtin.name == name).expect("it is built in");
        let scene = builtin.preset().expect("it is sound").scene;
        for update in [UpdateFraction::Full, UpdateFraction::Quarter] {
            let quality = nephoscope::scene::Quality { update, ..quick() };
            let mut renderer = renderer();
            render(&mut renderer, &frame(&scene, &quality, [61, 35], Output::Linear));
            let linear = renderer.linear().expect("it can be read");
            let measured = std::iter::from_fn(|| Some(renderer.light_histogram().expect("it can be measured")));
            let measured = measured.flatten().next().expect("compiled in the end");
            assert_eq!(measured.total(), 61 * 35, "{name}: every pixel once");
            let mut expected = vec![0_i64; measured.bins.len()];
            for light in &linear.rgba {
                let ev = f64::from(luminance(*light) * linear.candela_per_unit * 8.0).log2();
                let bin = ((ev - measured.lowest_ev) / LightHistogram::BIN_EV).clamp(0.0, 319.0);
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bin")]
                let bin = bin as usize;
                expected[bin] += 1;
            }
            // What lies on the edge of two bins may be counted in either.
            let gap: i64 = measured.bins.iter().zip(&expected).map(|(seen, own)| (i64::from(*seen) - own).abs()).sum();
            assert!(gap <= 8, "{name}, {update:?}: {gap} of {} pixels in other bins", measured.total());
            let exposure = measured.exposure_ev().expect("there is light");
            let chosen = f64::from(scene.display.exposure_ev);
            assert!((exposure - chosen).abs() < 3.0, "{name}: metered {exposure}, chosen by its author {chosen}");
        }
    }
}

#[test]
fn false_colours_are_those_of_the_table() {
    let mut scene = BUILTINS[0].preset().expect("it is sound").scene;
    scene.display.tone_map = ToneMap::FalseColour;
    scene.display.white_kelvin = 6504.0;
    let quality = quick();
    let mut renderer = renderer();
    let mut seen = std::collections::BTreeSet::new();
    for exposure_ev in [3.0, 10.0, 13.0, 16.0, 20.0] {
        scene.display.exposure_ev = exposure_ev;
        let frame = Frame { output: Output::Display, ..frame(&scene, &quality, [48, 27], Output::Display) };
        render(&mut renderer, &frame);
        let (_, pixels) = renderer.display_rgba8().expect("it can be read");
        for pixel in pixels.chunks_exact(4) {
            // Dither moves a value by less than one.
            let near = |colour: &[u8; 3]| colour.iter().zip(pixel).all(|(own, seen)| own.abs_diff(*seen) <= 1);
            let band = FALSE_COLOURS.iter().position(|(_, colour)| near(colour));
            seen.insert(band.unwrap_or_else(|| panic!("{pixel:?} is no false colour")));
        }
    }
    assert!(seen.len() >= 9, "only bands {seen:?} were seen");
}

/// Stephen Hill's fit as published, by a matrix library instead of the shader's arithmetic.
fn aces(light: [f32; 3]) -> [f32; 3] {
    use glam::{DMat3, DVec3};
    let into = DMat3::from_cols_array_2d(&[
        [0.59719, 0.076, 0.0284],
        [0.35458, 0.90834, 0.13383],
        [0.04823, 0.01566, 0.83777],
    ]);
    let back = DMat3::from_cols_array_2d(&[
        [1.60475, -0.10208, -0.00327],
        [-0.53108, 1.10813, -0.07276],
        [-0.07367, -0.00605, 1.07602],
    ]);
    let v = into * (DVec3::from_array(light.map(f64::from)) / 0.6);
    let curve = (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081);
    (back * curve).clamp(DVec3::ZERO, DVec3::ONE).as_vec3().to_array()
}

fn encoded(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[test]
fn the_film_curve_is_the_published_fit_and_stripes_lie_over_what_clips_alone() {
    let mut scene = BUILTINS[0].preset().expect("it is sound").scene;
    scene.display.tone_map = ToneMap::Aces;
    (scene.display.contrast, scene.display.saturation, scene.display.white_kelvin) = (1.0, 1.0, 6504.0);
    let quality = quick();
    let mut renderer = renderer();
    for exposure_ev in [8.0_f32, 11.0, 14.0] {
        scene.display.exposure_ev = exposure_ev;
        let linear = frame(&scene, &quality, [48, 27], Output::Linear);
        render(&mut renderer, &linear);
        let light = renderer.linear().expect("it can be read");
        let shown = frame(&scene, &quality, [48, 27], Output::Display);
        let mut show = |stripes: bool| {
            let mut forced = renderer.forced();
            forced.stripes = stripes;
            renderer.force(forced);
            render(&mut renderer, &shown);
            renderer.display_rgba8().expect("it can be read").1
        };
        let (plain, striped) = (show(false), show(true));
        show(false);
        // Saturation-based: full scale is 1.2 times two to the exposure value, in candela per square metre.
        let scale = light.candela_per_unit / (1.2 * exposure_ev.exp2());
        let (mut clipped, mut bands) = (0, 0);
        for (index, rgba) in light.rgba.iter().enumerate() {
            let seen = &plain[4 * index..4 * index + 3];
            let own = aces([rgba[0] * scale, rgba[1] * scale, rgba[2] * scale]).map(|linear| 255.0 * encoded(linear));
            let near = own.iter().zip(seen).all(|(own, seen)| (own - f32::from(*seen)).abs() <= 2.5);
            assert!(near, "{exposure_ev} EV, pixel {index}: {seen:?}, by the formula {own:?}");
            let over = &striped[4 * index..4 * index + 3];
            let clips = own.iter().any(|own| *own > 254.9);
            clipped += u32::from(clips);
            bands += u32::from(over != seen);
            assert!(over == seen || own.iter().any(|own| *own > 254.0), "a stripe over {own:?}");
        }
        assert!(
            bands * 3 >= clipped && (clipped == 0 || bands < clipped + 9),
            "{bands} of {clipped} pixels are striped"
        );
        assert!(exposure_ev > 8.0 || clipped > 100, "something clips: {clipped}");
    }
}

#[test]
fn a_probe_finds_the_clouds_at_a_place() {
    use nephoscope::scene::{CloudLayer, DensityModel, Scene};
    let layer = |base_m: f32, top_m: f32, scattering_per_m: f32| CloudLayer {
        model: DensityModel::Uniform,
        base_m,
        top_m,
        scattering_per_m,
        density: 0.5,
        ..CloudLayer::default()
    };
    let mut scene =
        Scene { layers: vec![layer(1000.0, 2000.0, 0.02), layer(1500.0, 3000.0, 0.04)], ..Scene::default() };
    scene.weather.coverage = 1.0;
    let quality = quick();
    let mut renderer = renderer();
    let frame = frame(&scene, &quality, [1, 1], Output::Linear);
    let mut at = |place: [f32; 3]| {
        std::iter::from_fn(|| Some(renderer.probe(&frame, place).expect("it can look")))
            .flatten()
            .next()
            .expect("compiled")
    };
    for (height_m, densities, extinction) in
        [(900.0, [0.0, 0.0], 0.0), (1200.0, [0.5, 0.0], 0.01), (1700.0, [0.5, 0.5], 0.03), (2500.0, [0.0, 0.5], 0.02)]
    {
        let seen = at([300.0, height_m, -700.0]);
        assert_eq!(seen.densities, [densities[0], densities[1], 0.0, 0.0], "at {height_m} m");
        assert!((seen.extinction_per_m - extinction).abs() < 1e-6, "at {height_m} m: {}", seen.extinction_per_m);
    }
    let empty = Scene { layers: Vec::new(), ..Scene::default() };
    let nothing = renderer.probe(&Frame { scene: &empty, ..frame }, [0.0, 1500.0, 0.0]).expect("it can look");
    assert_eq!(nothing.expect("nothing is compiled").densities, [0.0; 4]);
}
