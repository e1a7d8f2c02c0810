//! Each rule of the plan as a row of a table.

use super::*;
use crate::scene::{DensityModel, Projection, Quality, Scene};

fn plan_of(change: impl FnOnce(&mut Scene, &mut Quality)) -> FramePlan {
    plan_for(Output::Display, change)
}

fn plan_for(output: Output, change: impl FnOnce(&mut Scene, &mut Quality)) -> FramePlan {
    let (mut scene, mut quality) = (Scene::default(), Quality::default());
    change(&mut scene, &mut quality);
    FramePlan::new(&Frame { scene: &scene, quality: &quality, size: [160, 90], time_secs: 0.0, output, window: None })
}

fn because(plan: &FramePlan, effect: Effect) -> &str {
    &plan.verdict(effect).because
}

#[test]
fn the_default_sky_calls_for_clouds_ground_shadows_and_history() {
    let plan = plan_of(|_, _| {});
    let march = plan.march.expect("clouds");
    assert!(march.profile && march.detail && march.curl && march.air && march.ground, "{march:?}");
    assert!(!march.thesis && !march.uniform && !march.front && !march.float, "{march:?}");
    assert!(plan.ground.is_some_and(|ground| ground.terrain && ground.shadow_px.is_some()), "{:?}", plan.ground);
    assert_eq!(plan.temporal.map(UpdatePattern::phases), Some(16));
    assert_eq!((plan.sunshafts, plan.key), (None, KeyLight::Sun));
    assert!(plan.sky.is_some_and(|sky| !sky.stars && !sky.sun_disc && !sky.moonlit), "{:?}", plan.sky);
}

#[test]
fn strength_zero_leaves_no_trace() {
    let march = |change: fn(&mut Scene)| plan_of(|scene, _| change(scene)).march.expect("clouds");
    assert!(
        !march(|scene| scene.layers[0].detail_strength = 0.0).flags().any(|flag| flag == "DETAIL" || flag == "CURL")
    );
    assert!(!march(|scene| scene.layers[0].curl_m = 0.0).curl);
    assert!(!march(|scene| scene.air.aerial_perspective = false).air);
    assert!(march(|scene| scene.weather.coverage_changes = true).front);
    let ground = |change: fn(&mut Scene)| plan_of(|scene, _| change(scene)).ground;
    assert!(ground(|scene| scene.ground.cloud_shadows = 0.0).is_some_and(|ground| ground.shadow_px.is_none()));
    assert!(ground(|scene| scene.ground.hills_m = 0.0).is_some_and(|ground| !ground.terrain));
    assert_eq!(ground(|scene| scene.ground.visible = false), None);
}

#[test]
fn no_cloud_no_march_no_history_no_shadow() {
    for (change, word) in [
        ((|scene: &mut Scene| scene.weather.coverage = 0.0) as fn(&mut Scene), "coverage"),
        (|scene| scene.layers[0].enabled = false, "switched off"),
        (|scene| scene.layers[0].density = 0.0, "density"),
        (|scene| scene.layers[0].top_m = scene.layers[0].base_m, "thickness"),
    ] {
        let plan = plan_of(|scene, _| change(scene));
        assert_eq!((plan.march, plan.temporal), (None, None));
        assert!(plan.ground.is_some_and(|ground| ground.shadow_px.is_none()), "no shadow without cloud");
        assert!(because(&plan, Effect::Clouds).contains(word), "{}", because(&plan, Effect::Clouds));
    }
}

#[test]
fn the_models_in_use_decide_which_noise_is_bound() {
    let plan = plan_of(|scene, _| {
        scene.layers[0].model = DensityModel::Thesis;
        scene.layers.push(scene.layers[0].clone());
        scene.layers[1].model = DensityModel::Uniform;
    });
    let march = plan.march.expect("clouds");
    assert_eq!((march.layers, march.profile, march.thesis, march.uniform), (2, false, true, true));
}

#[test]
fn looking_up_leaves_the_ground_out() {
    let plan = plan_of(|scene, _| scene.camera.pitch_deg = 89.0);
    assert_eq!(plan.ground, None, "{}", because(&plan, Effect::Ground));
    assert!(plan_of(|scene, _| scene.camera.projection = Projection::Equirect).ground.is_some());
}

#[test]
fn sunshafts_need_a_light_near_the_view() {
    let shafts = |elevation, azimuth| {
        plan_of(|scene, _| {
            scene.sunshafts.strength = 1.0;
            scene.sun.elevation_deg = elevation;
            scene.sun.azimuth_deg = azimuth;
        })
        .sunshafts
    };
    assert!(shafts(10.0, 0.0).is_some());
    assert_eq!(shafts(10.0, 180.0), None, "behind the camera");
    assert!(plan_of(|scene, _| scene.sun.azimuth_deg = 0.0).sunshafts.is_none(), "strength 0");
}

#[test]
fn night_has_stars_and_a_moon() {
    let plan = plan_of(|scene, _| scene.sun.elevation_deg = -20.0);
    assert_eq!((plan.sky.map(|sky| sky.stars), plan.key), (Some(true), KeyLight::Moon));
}

#[test]
fn files_are_marched_whole_in_float() {
    let plan = plan_for(Output::Linear, |_, _| {});
    assert_eq!((plan.float, plan.temporal), (true, None));
    let plan = plan_for(Output::CloudsAlone, |_, _| {});
    assert!(plan.alone && plan.march.is_some_and(|march| !march.air && march.float), "clouds alone have no air");
}

#[test]
fn there_is_a_verdict_on_every_effect() {
    for change in [(|_| ()) as fn(&mut Scene), |scene| scene.layers.clear(), |scene| scene.plain_light.enabled = true] {
        let plan = plan_of(|scene, _| change(scene));
        let effects: Vec<Effect> = plan.verdicts.iter().map(|verdict| verdict.effect).collect();
        assert_eq!(effects, Effect::ALL, "one each, in order");
        assert!(plan.verdicts.iter().all(|verdict| verdict.because.len() > 6), "{:?}", plan.verdicts);
    }
}

#[test]
fn what_is_forced_runs_or_not_unless_it_cannot() {
    let forced = |effect, wanted, change: fn(&mut Scene)| {
        let (mut scene, quality) = (Scene::default(), Quality::default());
        change(&mut scene);
        let frame = Frame {
            scene: &scene,
            quality: &quality,
            size: [160, 90],
            time_secs: 0.0,
            output: Output::Display,
            window: None,
        };
        FramePlan::forced(&frame, Forced::default().with(effect, Some(wanted)))
    };
    assert!(forced(Effect::Sunshafts, true, |_| ()).sunshafts.is_some(), "strength is 0");
    assert!(forced(Effect::Detail, false, |_| ()).march.is_some_and(|march| !march.detail && !march.curl));
    let plan = forced(Effect::Curl, true, |scene| scene.layers[0].detail_strength = 0.0);
    assert!(!plan.runs(Effect::Curl), "nothing reads it");
    let plan = forced(Effect::SkyTables, false, |_| ());
    assert!(plan.runs(Effect::SkyTables) && !plan.verdict(Effect::SkyTables).is_forced(), "everything is lit by it");
    let plan = forced(Effect::Stars, true, |_| ());
    assert!(plan.verdict(Effect::Stars).is_forced() && plan.verdict(Effect::Stars).line().contains("forced on"));
}

#[test]
fn clouds_that_the_view_misses_are_not_marched() {
    let rows = |change: fn(&mut Scene)| plan_of(|scene, _| change(scene)).cloud_rows;
    let level = rows(|scene| scene.camera.pitch_deg = 0.0);
    assert!(level.start == 0 && (45..50).contains(&level.end), "down to the horizon: {level:?}");
    assert_eq!(rows(|scene| scene.camera.pitch_deg = -80.0), 0..0, "straight down from below them");
    let above = rows(|scene| (scene.camera.height_m, scene.camera.pitch_deg) = (9000.0, 0.0));
    assert!((46..54).contains(&above.start) && above.end == 90, "from above: {above:?}");
    assert_eq!(rows(|scene| (scene.camera.height_m, scene.camera.pitch_deg) = (2000.0, 89.0)), 0..90, "from within");
    let plan = plan_of(|scene, _| scene.camera.pitch_deg = -80.0);
    assert!(plan.march.is_some_and(|march| !march.lit && !march.skip), "their shadows are still there");
    assert_eq!((plan.temporal, plan.has_clouds()), (None, false));
    let bare = plan_of(|scene, _| (scene.camera.pitch_deg, scene.ground.cloud_shadows) = (-80.0, 0.0));
    assert_eq!(bare.march, None);
}

#[test]
fn stills_march_all_pixels_several_times_and_paths_have_samples_of_their_own() {
    let (scene, quality) = (Scene::default(), Quality::default());
    let frame = Frame {
        scene: &scene,
        quality: &quality,
        size: [160, 90],
        time_secs: 0.0,
        output: Output::Display,
        window: None,
    };
    assert_eq!(FramePlan::new(&frame).pixel_samples, 1, "a moving picture has one");
    let still = FramePlan::for_still(&frame, (Integrator::Realtime, 4), Forced::default());
    assert_eq!((still.temporal, still.pixel_samples, still.tracks), (None, 4, false));
    let traced = FramePlan::for_still(&frame, (Integrator::PathTraced, 4), Forced::default());
    assert_eq!((traced.pixel_samples, traced.tracks), (1, true));
}

#[test]
fn truths_look_farther_than_the_march_is_allowed_to() {
    let mut scene = Scene::default();
    (scene.layers[0].base_m, scene.layers[0].top_m) = (8000.0, 9000.0);
    (scene.camera.pitch_deg, scene.camera.field_of_view_deg, scene.camera.height_m) = (1.0, 2.0, 20.0);
    let quality = Quality { max_distance_m: 20_000.0, ..Quality::default() };
    let frame = Frame {
        scene: &scene,
        quality: &quality,
        size: [160, 90],
        time_secs: 0.0,
        output: Output::Display,
        window: None,
    };
    assert!(!FramePlan::new(&frame).has_clouds(), "the march sees none so far away");
    for integrator in [Integrator::Converged, Integrator::PathTraced] {
        let plan = FramePlan::for_still(&frame, (integrator, 1), Forced::default());
        assert!(plan.has_clouds() && plan.march.is_some_and(|march| march.lit), "{integrator:?}");
    }
}
