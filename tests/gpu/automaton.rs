//! The cellular automaton: against its twin, from any time to any other, and as clouds.

use std::time::Duration;

use nephoscope::reference::automaton::{Cells, favour};
use nephoscope::render::Renderer;
use nephoscope::render::tables::{Table, TableKind};
use nephoscope::render::truth::Goal;
use nephoscope::render::uniforms::automaton_uniforms;
use nephoscope::scene::{Automaton, DensityModel, EPOCH, Frame, Generation, HAND_OVER, Output, Quality, Scene};

use crate::common::gpu;
use crate::common::sky::table;

/// When another run takes over, in generations.
const NEXT_EPOCH: f64 = (EPOCH - HAND_OVER) as f64;

/// A sky of one small automaton.
fn sky(automaton: Automaton) -> Scene {
    let mut scene = Scene::default();
    scene.layers[0].model = DensityModel::Automaton;
    scene.layers[0].automaton = automaton;
    (scene.weather.coverage, scene.camera.pitch_deg) = (1.0, 30.0);
    scene
}

fn small() -> Automaton {
    Automaton { cells: 24, levels: 12, patches: 3, coverage: 0.6, generation_secs: 1.0, ..Automaton::default() }
}

fn density(renderer: &mut Renderer, scene: &Scene, time_secs: f64) -> Table {
    table(renderer, scene, time_secs, TableKind::Automaton)
}

fn renderer() -> Renderer {
    Renderer::new(gpu()).expect("it fits")
}

#[test]
fn the_automaton_is_its_twin_cell_by_cell() {
    let sheared = Automaton { shear: -0.7, levels: 40, cells: 20, activation: 0.1, ..small() };
    for (automaton, time) in [(small(), 20.0), (sheared, -3.0), (Automaton { change: 4.0, seed: 77, ..small() }, 3e8)] {
        let scene = sky(automaton.clone());
        let shown = density(&mut renderer(), &scene, time);
        let moment = automaton.at(time);
        let wind = (automaton.shear != 0.0).then_some(&scene.wind);
        let of = |index| automaton_uniforms(&automaton, wind, Generation { index, ..moment.now });
        let mut cells = Cells::clear(&of(1));
        let mut known = (u32::MAX, Vec::new());
        for index in 1..=moment.now.index {
            let uniforms = of(index);
            if known.0 != uniforms.phase {
                known = (uniforms.phase, favour(&uniforms));
            }
            cells = cells.next(&uniforms, &known.1);
        }
        let (across, levels) = (automaton.cells, automaton.levels);
        let mut cloudy = 0;
        for (index, texel) in shown.rgba.iter().enumerate() {
            let index = u32::try_from(index).expect("few cells");
            let [x, z, y] = [index % across, index / across % levels, index / across / levels];
            let place = glam::UVec3::new(x, y, z).as_ivec3();
            let own = cells.density(place);
            // Drivers round half floats as they like; densities lie a 729th apart.
            let is_same = (texel[0] - own).abs() < 1e-3 * own.max(1e-6);
            assert!(is_same, "at {place} of {automaton:?}, time {time}: {}, by the twin {own}", texel[0]);
            cloudy += u32::from(own > 0.5);
        }
        let all = across * across * levels;
        assert!(cloudy * 20 > all && cloudy * 2 < all, "{cloudy} of {all} cells hold cloud");
    }
}

#[test]
fn every_way_to_a_time_leads_to_the_same_clouds() {
    let scene = sky(Automaton { shear: 0.5, change: 3.0, ..small() });
    let times: Vec<f64> = (0..20).map(|step| NEXT_EPOCH - 12.0 + 1.4 * f64::from(step)).collect();
    let mut forwards = renderer();
    let seen: Vec<Table> = times.iter().map(|time| density(&mut forwards, &scene, *time)).collect();
    let mut backwards = renderer();
    for (time, seen) in times.iter().zip(&seen).rev() {
        assert!(density(&mut backwards, &scene, *time) == *seen, "backwards to {time}");
    }
    for step in [2, 11, 8, 19, 0] {
        backwards.forget_everything().expect("nothing is under way");
        assert!(density(&mut backwards, &scene, times[step]) == seen[step], "straight to {}", times[step]);
        assert!(density(&mut forwards, &scene, times[step]) == seen[step], "back to {}", times[step]);
    }
    assert!(seen[0] != seen[15], "it lives");
}

#[test]
fn playing_shows_no_step() {
    // Over the end of an epoch, where another run takes over.
    let scene = sky(Automaton { change: 2.0, ..small() });
    let automaton = &scene.layers[0].automaton;
    let mut renderer = renderer();
    let mut before: Option<Vec<f32>> = None;
    let mut greatest = 0.0_f32;
    let step = 0.05;
    for index in 0..500 {
        let time = NEXT_EPOCH - 2.0 + step * f64::from(index);
        let shares = automaton.at(time).shares;
        let shown: Vec<f32> = density(&mut renderer, &scene, time)
            .rgba
            .iter()
            .map(|texel| texel.iter().zip(shares).map(|(value, share)| value * share).sum())
            .collect();
        if let Some(before) = &before {
            let steps = shown.iter().zip(before).map(|(now, before)| (now - before).abs());
            greatest = steps.fold(greatest, f32::max);
        }
        before = Some(shown);
    }
    // A cell cannot change by more than the share of a generation that has passed, and the hand-over adds 1.5 of its own.
    assert!(greatest > 0.0 && greatest < 0.05 * (1.0 + 1.5 / 16.0) * 1.01, "{greatest} in a frame");
}

#[test]
fn no_path_finds_more_than_the_bound() {
    let mut scene = sky(Automaton { cells: 48, levels: 24, patches: 5, ..small() });
    scene.weather.size_m = 12_000.0;
    let quality = Quality::default();
    for time_secs in [5.0, NEXT_EPOCH + 4.5] {
        let frame =
            Frame { scene: &scene, quality: &quality, size: [48, 27], time_secs, output: Output::Linear, window: None };
        let mut renderer = renderer();
        let second = Duration::from_secs(1);
        let goal = Goal::PathTraced { tolerance: 0.0, samples: 8, scatterings: Some(6), seed: 1 };
        let mut truth = renderer.begin_truth(&frame, goal, 1).expect("it begins");
        while !truth.advance(&renderer, second, second).expect("it goes on").is_done {}
        let counts = truth.progress().counts;
        assert_eq!((counts.exceeded, counts.cut), (0, 0), "at {time_secs}: {counts:?}");
        assert!(counts.steps > 50_000, "paths meet cloud: {counts:?}");
    }
}

#[test]
fn coverage_has_both_ends() {
    let cloud = |coverage: f32| {
        let scene = sky(Automaton { coverage, ..small() });
        let table = density(&mut renderer(), &scene, 10.0);
        table.rgba.iter().filter(|texel| texel[0] > 0.3).count() as f64 / table.rgba.len() as f64
    };
    let covered = [0.0, 0.3, 0.7, 1.0].map(cloud);
    assert_eq!(covered[0], 0.0, "none");
    assert!(covered[1] > 0.01 && covered.is_sorted() && covered[3] > 0.5, "{covered:?}");
}
