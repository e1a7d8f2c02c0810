//! The grid of the sun's optical depth: against closed forms, and the march that takes all steps.

use nephoscope::render::LinearImage;
use nephoscope::render::tables::TableKind;
use nephoscope::scene::{CloudLayer, DensityModel, DomainKind, Frame, Output, Quality, Scene, UpdateFraction, Wind};

use crate::common::sky::{frame, quick, render, renderer};

const ACROSS: u32 = 40;

/// One uniform layer over a flat world.
fn slab(elevation_deg: f32) -> Scene {
    let mut scene = Scene::default();
    scene.domain.kind = DomainKind::Flat;
    (scene.weather.coverage, scene.sun.elevation_deg) = (1.0, elevation_deg);
    scene.camera.pitch_deg = 30.0;
    scene.layers.truncate(1);
    scene.layers[0] = CloudLayer {
        model: DensityModel::Uniform,
        base_m: 1000.0,
        top_m: 3000.0,
        scattering_per_m: 1e-4,
        ..scene.layers[0].clone()
    };
    scene
}

#[test]
fn a_uniform_slab_is_as_deep_as_the_way_through_it() {
    let quality = Quality { light_grid: ACROSS, light_reach_m: 500_000.0, ..quick() };
    // High light is swept downwards from node to node, low light sideways between them, where the mean of two logarithms
    // is a little less than what lies in the middle.
    for (elevation_deg, within) in [(90.0, 2e-3), (50.0, 2e-3), (21.0, 2e-3), (12.0, 0.03), (4.0, 0.1)] {
        let scene = slab(elevation_deg);
        let frame = frame(&scene, &quality, [32, 18], Output::Linear);
        let grid = renderer().table(&frame, TableKind::SunDepths).expect("it is made").expect("the sky has a grid");
        let [across, all] = grid.size.map(|side| side as usize);
        let (upwards, sine) = (all / across, elevation_deg.to_radians().sin());
        assert_eq!((across, upwards), (ACROSS as usize, 8), "a slab as thin as that needs few nodes upwards");
        let layer = &scene.layers[0];
        let full = layer.extinction_per_m() * layer.density * layer.shadow_extinction_scale * 2000.0 / sine;
        for (index, rgba) in grid.rgba.iter().enumerate() {
            let above = 1.0 - ((index / across) % upwards) as f32 / (upwards - 1) as f32;
            let (seen, expected) = (rgba[0].exp() - 1.0, full * above);
            assert!(
                (seen - expected).abs() <= within * (0.1 + expected),
                "node {index} at {elevation_deg}°: {seen} instead of {expected}"
            );
        }
    }
}

/// How far two pictures of the clouds are apart on average, and at a pixel (root of the mean square), relative to their mean.
fn apart(a: &LinearImage, b: &LinearImage) -> [f64; 2] {
    let light = |rgba: &[f32; 4]| f64::from(rgba[0] + rgba[1] + rgba[2]);
    let count = a.rgba.len() as f64;
    let mean = b.rgba.iter().map(light).sum::<f64>() / count;
    let bias = a.rgba.iter().map(light).sum::<f64>() / count / mean - 1.0;
    let squares: f64 = a.rgba.iter().zip(&b.rgba).map(|(a, b)| (light(a) - light(b)).powi(2)).sum();
    [bias, (squares / count).sqrt() / mean]
}

fn picture(scene: &Scene, quality: &Quality) -> LinearImage {
    let mut renderer = renderer();
    render(&mut renderer, &frame(scene, quality, [64, 36], Output::CloudsAlone));
    renderer.linear().expect("it can be read")
}

#[test]
fn the_grid_stands_for_the_steps_it_saves() {
    let all = Quality { light_grid: 0, light_steps: 96, light_detail_steps: 96, ..quick() };
    let grid = Quality { light_grid: 192, light_steps: 24, light_detail_steps: 24, ..all.clone() };
    // Low light crosses many planes; read linearly they would be blurred more and more, to 0.06 and 0.33 at 8°.
    for (elevation_deg, least) in
        [(60.0, [0.01, 0.04]), (25.0, [0.01, 0.11]), (8.0, [0.055, 0.31]), (1.0, [0.03, 0.22])]
    {
        let mut scene = Scene::default();
        scene.sun.elevation_deg = elevation_deg;
        let [bias, rms] = apart(&picture(&scene, &grid), &picture(&scene, &all));
        println!("at {elevation_deg}°: bias {bias:.3}, rms {rms:.3}");
        assert!(bias.abs() < least[0] && rms < least[1], "at {elevation_deg}°: bias {bias:.3}, rms {rms:.3}");
    }
}

#[test]
fn a_picture_does_not_depend_on_where_the_eye_came_from() {
    let quality = Quality { light_grid: 64, light_steps: 8, ..quick() };
    let mut scene = Scene::default();
    let here = picture(&scene, &quality);
    scene.camera.east_m = 9000.0;
    let there = picture(&scene, &quality);
    assert!(apart(&here, &there)[1] > 0.1, "other clouds");
    scene.camera.east_m = 0.0;
    assert_eq!(picture(&scene, &quality).rgba, here.rgba);
}

#[test]
fn moving_pictures_make_the_grid_anew_when_clouds_have_moved_and_stills_always() {
    let quality = Quality { light_grid: 64, update: UpdateFraction::Quarter, ..quick() };
    let scene = Scene::default();
    let calm = Scene { wind: Wind { speed_mps: 0.0, ..scene.wind.clone() }, ..scene.clone() };
    let seconds_for = |metres: f64| metres / f64::from(scene.wind.speed_mps);
    let mut renderer = renderer();
    let mut sweeps = |scene: &Scene, time_secs: f64, output: Output| {
        let frame = Frame { time_secs, ..frame(scene, &quality, [32, 18], output) };
        render(&mut renderer, &frame).passes.iter().any(|pass| pass.pass == "sun_sweep")
    };
    sweeps(&scene, 0.0, Output::Linear);
    assert!(!sweeps(&scene, 0.0, Output::Display), "it is there");
    assert!(!sweeps(&scene, seconds_for(20.0), Output::Display), "a fraction of a cell");
    assert!(sweeps(&scene, seconds_for(20.0), Output::Linear), "a file is exact");
    assert!(!sweeps(&scene, seconds_for(20.0), Output::Linear), "and once it is");
    assert!(sweeps(&scene, seconds_for(900.0), Output::Display), "several cells");
    sweeps(&calm, 0.0, Output::Display);
    assert!(!sweeps(&calm, 5.0, Output::Display), "a moment without wind");
    assert!(sweeps(&calm, 60.0, Output::Display), "clouds change without wind as well");
}
