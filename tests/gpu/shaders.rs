//! Every shader in every form that any sky can ask for composes and is valid; nothing here needs a device.

use std::collections::{BTreeMap, BTreeSet};

use nephoscope::gpu::ProgramKey;
use nephoscope::plan::FramePlan;
use nephoscope::render::{map_view, meter, probe, programs, shaders::TABLE, truth, watch};
use nephoscope::scene::builtin::BUILTINS;
use nephoscope::scene::edit;
use nephoscope::scene::random::randomise;
use nephoscope::scene::{
    DensityModel, DomainKind, Frame, MapLayer, MapSource, Output, Quality, Scene, Strokes, ToneMap, UpdateFraction,
};
use nephoscope::shader::{FILES, compose, validate};

#[test]
fn every_function_file_and_test_shader_is_valid() {
    let mut failures = Vec::new();
    for (path, _) in FILES.iter().filter(|(path, _)| !path.starts_with("pass/")) {
        let result = compose(path, &BTreeSet::new(), TABLE.flags, TABLE.structs).and_then(|source| validate(&source));
        if let Err(error) = result {
            failures.push(error.to_string());
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A painted layer of the map.
fn painted() -> MapLayer {
    let stroke = |brush| format!("{brush} Cumulus radius 0.1 strength 1 softness 1 amount 1 at 0.5,0.5").parse();
    let strokes = ["Add", "Smooth"].map(|brush| std::sync::Arc::new(stroke(brush).expect("a stroke")));
    let strokes = Strokes(strokes.to_vec());
    MapLayer { source: MapSource::Painted, strokes, ..MapLayer::default() }
}

type Change = fn(&mut Scene, &mut Quality);

/// Everything the plan may decide, switched one at a time on every preset.
const CHANGES: [Change; 25] = [
    |_, _| {},
    |scene, _| scene.weather.coverage = 0.0,
    |scene, _| scene.layers.iter_mut().for_each(|layer| layer.model = DensityModel::Profile),
    |scene, _| scene.layers.iter_mut().for_each(|layer| layer.model = DensityModel::Thesis),
    |scene, _| scene.layers.iter_mut().for_each(|layer| layer.model = DensityModel::Uniform),
    |scene, _| scene.layers.push(scene.layers[0].clone()),
    |scene, _| scene.layers.iter_mut().for_each(|layer| layer.detail_strength = 0.0),
    |scene, _| scene.layers.iter_mut().for_each(|layer| layer.curl_m = 0.0),
    |scene, _| (scene.weather.coverage_changes, scene.weather.coverage_change_to) = (true, 0.123),
    |scene, _| scene.air.aerial_perspective = false,
    |scene, _| scene.ground.visible = false,
    |scene, _| (scene.ground.hills_m, scene.ground.mountains_m) = (0.0, 0.0),
    |scene, _| scene.ground.cloud_shadows = 0.0,
    |scene, _| scene.weather.layers = vec![painted()],
    |scene, _| scene.weather.layers.push(painted()),
    |scene, _| (scene.sun.elevation_deg, scene.sunshafts.strength) = (-40.0, 1.0),
    |scene, _| (scene.sun.elevation_deg, scene.moon.enabled) = (-40.0, false),
    |scene, _| (scene.sun.elevation_deg, scene.sunshafts.strength, scene.camera.pitch_deg) = (5.0, 1.0, 80.0),
    |scene, _| (scene.domain.kind, scene.sunshafts.strength) = (DomainKind::Flat, 1.0),
    |scene, _| scene.domain.kind = DomainKind::Box,
    |scene, _| scene.display.tone_map = ToneMap::Neutral,
    |scene, _| scene.display.tone_map = ToneMap::Linear,
    |scene, _| scene.display.tone_map = ToneMap::Aces,
    |_, quality| quality.octaves = 0,
    |_, quality| quality.update = UpdateFraction::Full,
];

/// The programs of all presets with every change, of random scenes, and those that no plan lists.
fn reachable() -> BTreeMap<String, ProgramKey> {
    let mut scenes: Vec<(Scene, Quality)> = Vec::new();
    for builtin in BUILTINS {
        let scene = builtin.preset().unwrap_or_else(|error| panic!("{error}")).scene;
        for change in CHANGES {
            let (mut scene, mut quality) = (scene.clone(), Quality::default());
            change(&mut scene, &mut quality);
            scenes.push((scene, quality));
        }
    }
    for seed in 0..150 {
        let (mut scene, mut quality) = (Scene::default(), Quality::default());
        randomise(&mut scene, seed);
        randomise(&mut quality, seed);
        scenes.push((scene, quality));
    }
    let mut keys = vec![
        ProgramKey::plain("pass/weather_blend.wgsl").with_flags(["BELOW"]),
        ProgramKey::plain("pass/weather_grow.wgsl"),
        ProgramKey::plain("pass/weather_flow.wgsl"),
    ];
    keys.extend(watch::programs());
    for (scene, quality) in &scenes {
        for output in [Output::Display, Output::Linear, Output::CloudsAlone] {
            let plan = FramePlan::new(&Frame { scene, quality, size: [64, 36], time_secs: 0.0, output, window: None });
            keys.extend(programs(&plan));
            keys.extend(map_view::programs());
            keys.extend(meter::programs(&plan));
            keys.extend(probe::programs(&plan));
            keys.extend(truth::programs(&plan));
            keys.extend(programs(&FramePlan { tracks: true, ..plan }));
        }
    }
    let counted = keys.iter().filter(|key| key.file == "pass/march.wgsl").map(|key| key.clone().with_flags(["COUNT"]));
    let counted: Vec<ProgramKey> = counted.collect();
    // What is overridden is not composed: one of each text is enough.
    let text = |key: ProgramKey| (ProgramKey { constants: Vec::new(), ..key.clone() }.to_string(), key);
    keys.into_iter().chain(counted).map(text).collect()
}

#[test]
fn every_pass_in_every_form_that_a_sky_can_ask_for_is_valid() {
    let keys = reachable();
    let failures: Vec<String> =
        keys.iter().filter_map(|(name, key)| Some(format!("{name}: {}", TABLE.compose(key).err()?))).collect();
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), keys.len(), failures.join("\n"));
    assert!(keys.len() > 100, "only {} forms were found", keys.len());
    let is_function_file = |path: &str| !keys.values().any(|key| key.file == path);
    let never: Vec<&str> = FILES
        .iter()
        .filter(|(path, text)| path.starts_with("pass/") && text.contains("@compute") && is_function_file(path))
        .map(|(path, _)| *path)
        .collect();
    assert!(never.is_empty(), "no sky asks for {never:?}");
}

/// Programs are compiled as they are asked for, so there must not be too many: of all built-in skies as they are, and with
/// any one parameter at 0, at its ends, switched, or with another choice.
#[test]
fn one_edit_reaches_few_programs() {
    let quality = Quality::default();
    let programs_of = |scene: &Scene| -> Vec<String> {
        let frame =
            Frame { scene, quality: &quality, size: [64, 36], time_secs: 0.0, output: Output::Display, window: None };
        programs(&FramePlan::new(&frame)).iter().map(ToString::to_string).collect()
    };
    let (mut as_they_are, mut edited) = (BTreeSet::new(), BTreeSet::new());
    for builtin in BUILTINS {
        let scene = builtin.preset().unwrap_or_else(|error| panic!("{error}")).scene;
        as_they_are.extend(programs_of(&scene));
        for entry in edit::keys(&scene) {
            let ends = entry.allowed.split(|c: char| !(c.is_alphanumeric() || "+-.".contains(c)));
            for value in ends.chain(["0", "true", "false"]).filter(|value| !value.is_empty()) {
                let mut changed = scene.clone();
                if edit::set(&mut changed, &entry.key, value).is_ok() && changed.problems().is_empty() {
                    edited.extend(programs_of(&changed));
                }
            }
        }
    }
    println!("{} programs, {} with one edit", as_they_are.len(), edited.len());
    assert!(as_they_are.len() <= 95 && edited.len() > as_they_are.len(), "{} programs", as_they_are.len());
    assert!(edited.len() <= 500, "{} programs with one edit", edited.len());
}

#[test]
fn no_flag_is_known_that_no_shader_asks_for() {
    for flag in TABLE.flags {
        let asked = format!("#if {flag}");
        assert!(
            FILES.iter().any(|(_, text)| text.lines().any(|line| line.trim() == asked)),
            "{flag} is never asked for"
        );
    }
}
