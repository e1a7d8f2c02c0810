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
