//! What a sky does not call for is absent: no flag, no binding, no pass; and leaving it out changes no bit.

use std::collections::BTreeSet;

use nephoscope::plan::{FramePlan, GroundPlan};
use nephoscope::render::{programs, shaders::TABLE};
use nephoscope::scene::{DensityModel, Frame, Output, Projection, Quality, Scene, UpdateFraction};

use crate::common::Random;
use crate::common::sky::{frame, linear, quick, render, renderer};

type Change = fn(&mut Setup);
/// Gives an effect a strength.
type Strength = fn(&mut Scene, f32);

/// A sky that calls for everything one sky can call for.
#[derive(Clone)]
struct Setup {
    scene: Scene,
    quality: Quality,
    output: Output,
}

impl Setup {
    fn full() -> Self {
        let mut scene = Scene::default();
        scene.layers.push(scene.layers[0].clone());
        scene.layers[1].model = DensityModel::Thesis;
        (scene.weather.coverage_changes, scene.weather.coverage_change_to) = (true, 0.9);
        // The moon lights the clouds, so that stars and shafts are there together.
        (scene.sun.elevation_deg, scene.moon.elevation_deg, scene.moon.azimuth_deg) = (-30.0, 15.0, 0.0);
        scene.sunshafts.strength = 1.0;
        let quality = Quality { update: UpdateFraction::Quarter, ..quick() };
        Self { scene, quality, output: Output::Display }
    }

    fn with(change: Change) -> Self {
        let mut setup = Self::full();
        change(&mut setup);
        setup
    }

    fn plan(&self) -> FramePlan {
        FramePlan::new(&frame(&self.scene, &self.quality, [32, 18], self.output))
    }
}

/// An effect: what switches it off, and its traces.
struct Effect {
    name: &'static str,
    off: Change,
    flag: Option<&'static str>,
    binding: Option<&'static str>,
    pass: Option<&'static str>,
}

const fn effect(name: &'static str, off: Change, traces: [Option<&'static str>; 3]) -> Effect {
    let [flag, binding, pass] = traces;
    Effect { name, off, flag, binding, pass }
}

const EFFECTS: [Effect; 14] = [
    effect("clouds", |s| s.scene.layers.clear(), [Some("CLOUDS"), Some("weather_map"), Some("march")]),
    effect(
        "detail",
        |s| s.scene.layers.iter_mut().for_each(|layer| layer.detail_strength = 0.0),
        [Some("DETAIL"), Some("detail_noise"), None],
    ),
    effect(
        "curl",
        |s| s.scene.layers.iter_mut().for_each(|layer| layer.curl_m = 0.0),
        [Some("CURL"), Some("curl_noise"), None],
    ),
    effect("profile model", |s| _ = s.scene.layers.remove(0), [Some("PROFILE"), Some("shape_noise"), None]),
    effect("thesis model", |s| s.scene.layers.truncate(1), [Some("THESIS"), Some("worley_noise"), None]),
    effect("front", |s| s.scene.weather.coverage_changes = false, [Some("FRONT"), None, None]),
    effect("air", |s| s.scene.air.aerial_perspective = false, [Some("AIR"), None, None]),
    effect("ground", |s| s.scene.ground.visible = false, [Some("GROUND"), Some("ground_distance"), None]),
    effect(
        "terrain",
        |s| (s.scene.ground.hills_m, s.scene.ground.mountains_m) = (0.0, 0.0),
        [Some("TERRAIN"), Some("terrain_map"), None],
    ),
    effect(
        "cloud shadows",
        |s| s.scene.ground.cloud_shadows = 0.0,
        [Some("SHADOW"), Some("cloud_shadow"), Some("cloud_shadow")],
    ),
    effect("stars", |s| s.scene.sun.elevation_deg = 30.0, [Some("STARS"), None, None]),
    effect(
        "sunshafts",
        |s| s.scene.sunshafts.strength = 0.0,
        [Some("SHAFTS"), Some("shafts_light"), Some("sunshafts")],
    ),
    effect(
        "temporal reprojection",
        |s| s.quality.update = UpdateFraction::Full,
        [Some("HISTORY"), Some("history_cloud"), Some("temporal")],
    ),
    effect("display's precision", |s| s.output = Output::Linear, [None, None, Some("temporal")]),
];

/// All flags and all bindings of the programs a plan may ask for.
fn traces(plan: &FramePlan) -> (BTreeSet<String>, BTreeSet<String>) {
    let (mut flags, mut bindings) = (BTreeSet::new(), BTreeSet::new());
    for key in programs(plan) {
        flags.extend(key.flags.iter().map(|flag| (*flag).to_owned()));
        let (_, used) = TABLE.compose(&key).unwrap_or_else(|error| panic!("{key}: {error}"));
        bindings.extend(used.into_iter().map(|binding| binding.name));
    }
    (flags, bindings)
}

#[test]
fn what_is_off_is_in_no_program() {
    let (flags, bindings) = traces(&Setup::full().plan());
    let mut failures = Vec::new();
    for effect in &EFFECTS {
        let (left_flags, left_bindings) = traces(&Setup::with(effect.off).plan());
        for (kind, trace, on, off) in
            [("flag", effect.flag, &flags, &left_flags), ("binding", effect.binding, &bindings, &left_bindings)]
        {
            let Some(trace) = trace else { continue };
            if !on.contains(trace) {
                failures.push(format!("{}: the full sky has no {kind} {trace}", effect.name));
            }
            if off.contains(trace) {
                failures.push(format!("{}: switched off, but {kind} {trace} is left", effect.name));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn air_that_is_off_is_not_read_by_the_march() {
    let bound = |setup: &Setup| {
        let keys = programs(&setup.plan());
        let march = keys.iter().find(|key| key.file == "pass/march.wgsl").expect("a march");
        TABLE.compose(march).unwrap_or_else(|error| panic!("{error}")).1.iter().any(|b| b.name == "sky_aerial_light")
    };
    assert!(bound(&Setup::full()), "the full sky reads the air before the clouds");
    assert!(!bound(&Setup::with(|setup| setup.scene.air.aerial_perspective = false)), "no air, no table of it");
}

fn passes(setup: &Setup) -> Vec<&'static str> {
    let mut renderer = renderer();
    let report = render(&mut renderer, &frame(&setup.scene, &setup.quality, [32, 18], setup.output));
    report.passes.iter().map(|time| time.pass).collect()
}

#[test]
fn what_is_off_does_not_run() {
    let full = passes(&Setup::full());
    for effect in &EFFECTS {
        let Some(pass) = effect.pass else { continue };
        assert!(full.contains(&pass), "{}: the full sky runs {full:?}", effect.name);
        let left = passes(&Setup::with(effect.off));
        assert!(!left.contains(&pass), "{}: switched off, but {left:?} ran", effect.name);
    }
}

#[test]
fn leaving_out_what_has_no_strength_changes_nothing() {
    // Each pair: compiled out, and compiled in with a strength below the last bit.
    const WHISPER: f32 = 1e-30;
    let cases: [(&str, Strength); 5] = [
        ("detail", |scene, strength| scene.layers[0].detail_strength = strength),
        ("curl", |scene, strength| scene.layers[0].curl_m = strength),
        ("cloud shadows", |scene, strength| scene.ground.cloud_shadows = strength),
        ("sunshafts", |scene, strength| scene.sunshafts.strength = strength),
        ("front", |scene, strength| {
            scene.weather.coverage_changes = strength > 0.0;
            (scene.weather.front_distance_m, scene.weather.front_width_m) = (300_000.0, 100.0);
        }),
    ];
    for (name, change) in cases {
        let take = |strength: f32| {
            let (mut scene, quality) = (Scene::default(), quick());
            scene.weather.coverage = 0.6;
            // Shafts need the sun near the picture.
            (scene.sun.elevation_deg, scene.camera.heading_deg) = (20.0, scene.sun.azimuth_deg);
            change(&mut scene, strength);
            let plan = FramePlan::new(&Frame {
                scene: &scene,
                quality: &quality,
                size: [48, 27],
                time_secs: 0.0,
                output: Output::Linear,
            });
            let texels = linear(&scene, &quality, [48, 27]).rgba;
            (plan.reasons, texels.iter().map(|texel| texel.map(f32::to_bits)).collect::<Vec<_>>())
        };
        let ((without, absent), (with, present)) = (take(0.0), take(WHISPER));
        let runs = |reasons: &[nephoscope::plan::Reason]| reasons.iter().filter(|reason| reason.runs).count();
        assert!(runs(&with) > runs(&without), "{name}: both pictures were planned alike");
        assert!(absent == present, "{name}: compiling it in changes the picture");
    }
}

#[test]
fn rows_above_the_ground_are_the_same_without_it() {
    let mut random = Random::new(31);
    let mut left_out = 0;
    for projection in [Projection::Perspective, Projection::Perspective, Projection::Equirect, Projection::Dome] {
        for relief_m in [[0.0, 0.0], [300.0, 0.0], [60.0, 2500.0]] {
            let (mut scene, quality) = (Scene::default(), quick());
            scene.weather.coverage = 0.0;
            [scene.ground.hills_m, scene.ground.mountains_m] = relief_m;
            let camera = &mut scene.camera;
            camera.projection = projection;
            (camera.heading_deg, camera.pitch_deg) = (random.between(0.0, 360.0), random.between(-30.0, 60.0));
            (camera.field_of_view_deg, camera.height_m) =
                (random.between(20.0, 110.0), random.pick(&[2.0, 40.0, 4000.0]));
            (camera.east_m, camera.south_m) = (random.pick(&[0.0, 500.0]), random.pick(&[0.0, -1500.0]));
            let frame = frame(&scene, &quality, [96, 54], Output::Linear);
            let planned = FramePlan::new(&frame);
            let Some(ground) = planned.ground else { continue };
            left_out += ground.open_rows;
            let everywhere = FramePlan { ground: Some(GroundPlan { open_rows: 0, ..ground }), ..planned.clone() };
            let mut renderer = renderer();
            let mut take = |plan| {
                renderer.render_as_planned(&frame, plan).unwrap_or_else(|error| panic!("{error}"));
                let rgba = renderer.linear().unwrap_or_else(|error| panic!("{error}")).rgba;
                rgba.iter().map(|texel| texel.map(f32::to_bits)).collect::<Vec<_>>()
            };
            let (with, without) = (take(everywhere), take(planned));
            assert!(with == without, "{:?}, relief {relief_m:?}: {} rows", scene.camera, ground.open_rows);
        }
    }
    assert!(left_out > 150, "ground was left out of {left_out} rows only");
}
