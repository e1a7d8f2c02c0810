//! Sweeps and suites under way: they can be left after each step, read at any time, and go on.

use nephoscope::lab::accuracy::{Axis, settings};
use nephoscope::lab::bench::{Case, Measurement, Rounds};
use nephoscope::lab::sweep::{At, Plan, Sweep};
use nephoscope::plan::Forced;
use nephoscope::plan::Integrator;
use nephoscope::render::truth::Goal;
use nephoscope::scene::{Quality, Scene};

use crate::common::sky::{quick, renderer};

fn small_sweep(rounds: u32) -> Sweep {
    let axis = Axis::parse("quality.light_steps=1,8").expect("an axis");
    let goals = vec![
        Goal::Converged { tolerance: 0.02, levels: 4 },
        Goal::PathTraced { tolerance: 0.5, samples: 8, scatterings: None, seed: 1 },
    ];
    let settings = settings(&quick(), &[axis]).expect("settings");
    let mut scene = Scene::default();
    scene.camera.pitch_deg = 25.0;
    Sweep::new(Plan { scene, size: [24, 14], settings, goals, rounds, seeds: 2 })
}

#[test]
fn a_sweep_finds_truths_then_errors_then_times_a_step_at_a_time() {
    let mut renderer = renderer();
    let mut sweep = small_sweep(2);
    let mut kinds = Vec::new();
    assert!(sweep.title("Sky").ends_with("PARTIAL"), "nothing is measured yet");
    loop {
        let kind = match sweep.at() {
            At::Truth(Goal::Converged { .. }, _) => "converged",
            At::Truth(Goal::PathTraced { .. }, _) => "path traced",
            At::Comparing(_) => "errors",
            At::Timing(..) => "times",
            At::Done => "done",
        };
        if kinds.last() != Some(&kind) {
            kinds.push(kind);
        }
        if sweep.at() == At::Timing(4, 6) {
            let timed: Vec<usize> = sweep.rows().iter().map(|row| row.march_ms.len()).collect();
            assert_eq!(timed, [2, 1, 1], "in turns");
            assert!(sweep.title("Sky").ends_with("PARTIAL"), "whoever leaves it here says so");
        }
        if sweep.advance(&mut renderer).expect("it goes on") {
            break;
        }
    }
    assert_eq!(kinds, ["converged", "path traced", "errors", "times"]);
    assert_eq!(sweep.title("Sky"), "Sky, 24×14, 2 rounds");
    assert_eq!(sweep.rows().len(), 3, "the setting in use, and two others");
    let error = |row: usize| sweep.rows()[row].error(Integrator::Converged).expect("measured").value;
    let split = sweep.rows()[0].against[0].split.expect("two seeds");
    assert!(split.variance.value > 0.0 && split.seeds == 2, "jitter is noise: {split:?}");
    assert!(error(1) > error(2), "one light step is worse than eight: {} {}", error(1), error(2));
    assert!(sweep.advance(&mut renderer).expect("nothing happens"), "the end is the end");
}

#[test]
fn a_measurement_goes_on_where_it_was_left() {
    let mut renderer = renderer();
    let case = |name: &str, light_steps: u32| Case {
        name: name.to_owned(),
        scene: Scene::default(),
        quality: Quality { light_steps, ..quick() },
        size: [16, 9],
        forced: Forced::default(),
    };
    let cases = vec![case("a", 1), case("b", 2)];
    let mut measurement = Measurement::new(cases, Rounds { warm_up: 1, rounds: 2, frames: 1 });
    assert_eq!(measurement.turns(), (0, 6));
    for _ in 0..3 {
        assert!(!measurement.advance(&mut renderer).expect("it goes on"), "there is more");
    }
    assert_eq!(measurement.next_turn().as_deref(), Some("round 1: b 16×9"));
    let counts =
        |measurement: &Measurement| -> Vec<usize> { measurement.rows().iter().map(|row| row.total.len()).collect() };
    assert_eq!(counts(&measurement), [1, 0], "readable half way");
    let mut later = measurement.clone();
    while !later.advance(&mut renderer).expect("it goes on") {}
    assert_eq!((counts(&later), later.next_turn(), later.turns()), (vec![2, 2], None, (6, 6)));
    assert!(later.rows()[1].median("march").is_some(), "passes have times");
}
