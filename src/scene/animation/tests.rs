use super::super::preset::Preset;
use super::*;

fn key(time_secs: f64, value: &str, ease: Ease) -> Keyframe {
    Keyframe { time_secs, value: value.to_owned(), ease }
}

type Keys<'a> = &'a [(f64, &'a str, Ease)];

fn animation(tracks: &[(&str, Keys<'_>)]) -> Animation {
    let tracks = tracks.iter().map(|(name, keys)| {
        let keys = keys.iter().map(|(time, value, ease)| key(*time, value, *ease)).collect();
        Track { key: (*name).to_owned(), keys }
    });
    Animation { tracks: tracks.collect(), ..Animation::default() }
}

fn at(animation: &Animation, time_secs: f64) -> Scene {
    let mut scene = Scene::default();
    animation.play(&mut scene, time_secs);
    scene
}

#[test]
fn values_go_from_key_to_key_as_their_kind_can() {
    use Ease::{Hold, Linear};
    let moving = animation(&[
        ("weather.coverage", &[(2.0, "0.2", Linear), (4.0, "0.6", Hold), (6.0, "1.0", Linear)]),
        ("sun.azimuth_deg", &[(0.0, "350.0", Linear), (10.0, "20.0", Linear)]),
        ("layers.0.phase.kind", &[(0.0, "Schlick", Linear), (5.0, "Rayleigh", Linear)]),
        ("ground.visible", &[(0.0, "true", Linear), (5.0, "false", Linear)]),
        ("ground.albedo", &[(0.0, "(0.0, 0.5, 1.0)", Linear), (10.0, "(1.0, 0.5, 0.0)", Linear)]),
        ("ground.seed", &[(0.0, "1", Linear), (10.0, "9", Linear)]),
    ]);
    assert_eq!(moving.fault(&Scene::default()), None);
    for (time, coverage) in [(0.0, 0.2), (2.0, 0.2), (3.0, 0.4), (4.0, 0.6), (5.99, 0.6), (6.0, 1.0), (99.0, 1.0)] {
        let seen = at(&moving, time).weather.coverage;
        assert!((seen - coverage).abs() < 1e-6, "coverage {seen} at {time} s, expected {coverage}");
    }
    let middle = at(&moving, 5.0);
    assert!((middle.sun.azimuth_deg - 5.0).abs() < 1e-3, "the shorter way: {}", middle.sun.azimuth_deg);
    assert!(!middle.ground.visible && at(&moving, 4.99).ground.visible, "a switch holds until its key");
    assert_eq!(middle.ground.albedo, Colour(0.5, 0.5, 0.5));
    assert_eq!(at(&moving, 9.9).ground.seed, 1, "a seed has nothing in between");
}

#[test]
fn smooth_ways_have_no_kink_and_never_overshoot() {
    let keys: &[(f64, &str, Ease)] = &[
        (0.0, "100", Ease::Smooth),
        (1.0, "200", Ease::Smooth),
        (4.0, "5000", Ease::Smooth),
        (5.0, "300", Ease::Smooth),
    ];
    let moving = animation(&[
        ("camera.height_m", keys),
        ("wind.from_deg", &[(0.0, "300", Ease::Smooth), (5.0, "40", Ease::Smooth)]),
    ]);
    let height = |time: f64| f64::from(at(&moving, time).camera.height_m);
    let h = 1e-3;
    for (time, value, _) in keys {
        let value: f64 = value.parse().expect("a number");
        assert!((height(*time) / value - 1.0).abs() < 1e-4, "{} at {time}", height(*time));
        let slopes = [(height(*time) - height(time - h)) / h, (height(time + h) - height(*time)) / h];
        // A kink there would be one of thousands of metres a second.
        assert!((slopes[0] - slopes[1]).abs() < 100.0, "{slopes:?} at {time}");
    }
    for step in 0..500 {
        let time = f64::from(step) * 0.01;
        let last = keys.iter().rposition(|key| key.0 <= time).expect("after the first").min(keys.len() - 2);
        let ends = [keys[last].1, keys[last + 1].1].map(|text| text.parse::<f64>().expect("a number"));
        let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        assert!(
            (low * 0.9999..=high * 1.0001).contains(&height(time)),
            "{} at {time} leaves {low} to {high}",
            height(time)
        );
        let from = at(&moving, time).wind.from_deg;
        assert!(from >= 300.0 || from <= 40.0, "the wind turns through north: {from}");
    }
    let middle = height(2.5);
    assert!((500.0..2000.0).contains(&middle), "between 200 and 5000 on a logarithmic slider: {middle}");
}

#[test]
fn edits_of_what_has_keys_become_keys() {
    let mut moving = animation(&[("weather.coverage", &[(0.0, "0.2", Ease::Linear), (10.0, "0.6", Ease::Linear)])]);
    let mut scene = at(&moving, 5.0);
    moving.absorb(&scene, 5.0);
    assert_eq!(moving.tracks[0].keys.len(), 2, "nothing was edited");
    scene.weather.coverage = 0.9;
    scene.ground.seed = 77;
    moving.absorb(&scene, 5.0);
    assert_eq!(moving.tracks.len(), 1, "the seed has no keys");
    assert_eq!(moving.tracks[0].keys[1], key(5.0, "0.9", Ease::Linear), "as linear as the key before");
    assert_eq!(at(&moving, 5.0).weather.coverage, 0.9);
    scene.weather.coverage = 0.8;
    moving.absorb(&scene, 5.0);
    assert_eq!(moving.tracks[0].keys.len(), 3, "one key at one time");
    moving.set_key(&scene, "wind.speed_mps", 1.0);
    moving.set_key(&scene, "wind.nothing", 1.0);
    assert_eq!(moving.tracks.len(), 2);
    moving.move_key("weather.coverage", 1, 99.0);
    assert!(moving.tracks[0].keys[1].time_secs < 10.0, "not past its neighbour");
    moving.remove_key("wind.speed_mps", 0);
    assert_eq!(moving.tracks.len(), 1, "a track without keys is gone");
}

#[test]
fn tracks_stay_with_their_layers() {
    let begun = animation(&[
        ("layers.0.density", &[(0.0, "0.1", Ease::Linear)]),
        ("layers.1.density", &[(0.0, "0.2", Ease::Linear)]),
        ("wind.speed_mps", &[(0.0, "3", Ease::Linear)]),
    ]);
    let names = |animation: &Animation| animation.tracks.iter().map(|track| track.key.clone()).collect::<Vec<_>>();
    let mut without = begun.clone();
    without.follow("layers", "layers", &["a", "b"], &["b"]);
    assert_eq!(names(&without), ["layers.0.density", "wind.speed_mps"]);
    assert_eq!(without.tracks[0].keys[0].value, "0.2", "the track of the second layer");
    let mut with = begun.clone();
    with.follow("layers", "layers", &["a", "b"], &["a", "a", "b"]);
    assert_eq!(names(&with), ["layers.0.density", "layers.2.density", "wind.speed_mps"]);
    let mut first_twin = begun.clone();
    first_twin.follow("layers.0", "layers", &["a", "a"], &["a"]);
    assert_eq!(first_twin.tracks[0].keys[0].value, "0.2", "the first of two twins was taken");
    let mut same = begun.clone();
    same.follow("layers", "layers", &["a", "b"], &["a", "c"]);
    assert_eq!(same, begun, "an edited layer is still that layer");
}

#[test]
fn what_has_no_keys_does_not_depend_on_the_times_that_were_shown() {
    let moving = animation(&[("layers.0.base_m", &[(0.0, "1000", Ease::Linear), (10.0, "9000", Ease::Linear)])]);
    let begun = Scene::default();
    let mut scene = begun.clone();
    moving.play(&mut scene, 10.0);
    assert!(scene.problems().is_empty() && scene.layers[0].top_m == begun.layers[0].top_m, "{:?}", scene.layers[0]);
    moving.play(&mut scene, 0.0);
    assert_eq!(scene.layers[0].base_m, 1000.0, "and back");
}

#[test]
fn a_film_is_long_enough_for_its_keys_and_recording_does_not_fill_it() {
    let mut moving = animation(&[("weather.coverage", &[(0.0, "0.2", Ease::Linear)])]);
    let mut scene = Scene::default();
    moving.set_key(&scene, "wind.speed_mps", 45.0);
    assert_eq!(moving.duration_secs, 45.0);
    for tick in 0..1000 {
        let time = 50.0 + f64::from(tick) * 0.005;
        moving.play(&mut scene, time);
        scene.weather.coverage = 0.5 + 0.0004 * f32::from(u16::try_from(tick).expect("small"));
        moving.absorb(&scene, time);
    }
    let keys = moving.track("weather.coverage").expect("it has keys").keys.len();
    assert!((50..=140).contains(&keys), "five seconds of recording made {keys} keys");
    assert_eq!(moving.fault(&Scene::default()), None);
    let mut one_layer = Scene::default();
    moving.set_key(
        &Scene { layers: vec![one_layer.layers[0].clone(); 3], ..Scene::default() },
        "layers.2.density",
        0.0,
    );
    one_layer.layers.truncate(1);
    moving.keep_only_what_is_in(&one_layer);
    assert_eq!(moving.fault(&one_layer), None, "a layer that is gone takes its keys along");
    moving.override_by(["weather"]);
    assert!(moving.track("weather.coverage").is_none() && moving.track("wind.speed_mps").is_some());
}

#[test]
fn time_repeats_or_stops() {
    let mut moving = animation(&[("wind.speed_mps", &[(0.0, "3", Ease::Linear)])]);
    (moving.duration_secs, moving.speed) = (10.0, 2.0);
    assert_eq!(moving.after(8.0, 2.0), (2.0, false));
    moving.repeats = false;
    assert_eq!(moving.after(8.0, 2.0), (10.0, true));
    moving.tracks.clear();
    assert_eq!(moving.after(8.0, 2.0), (12.0, false), "wind alone has no end");
}

#[test]
fn a_day_goes_from_dawn_to_dusk() {
    let mut sun = Sun { day: 172, latitude_deg: 50.0, ..Sun::default() };
    let day = Animation::default().day(&sun, 20.0, 30.0).expect("the sun rises in Prague");
    assert_eq!((day.duration_secs, day.speed), (600.0, 30.0));
    assert_eq!(day.fault(&Scene::default()), None);
    let hour = |time| at(&day, time).sun.hour_h;
    assert!((hour(300.0) - 12.0).abs() < 2.0 && hour(0.0) < 5.0 && hour(600.0) > 19.0, "{} {}", hour(0.0), hour(600.0));
    let (early, late) = (hour(150.0), hour(450.0));
    assert!(((late - early) / (hour(600.0) - hour(0.0)) - 0.5).abs() < 1e-3, "evenly");
    sun.latitude_deg = 64.0;
    assert!(Animation::default().day(&sun, 20.0, 30.0).is_some(), "a night as bright as twilight");
    sun.latitude_deg = 85.0;
    assert!(Animation::default().day(&sun, 20.0, 30.0).is_some(), "midsummer at the pole");
    sun.day = 355;
    assert_eq!(Animation::default().day(&sun, 20.0, 30.0), None, "midwinter at the pole");
}

#[test]
fn presets_keep_their_keys_and_faults_are_named_with_their_place() {
    let mut preset = Preset::new("Moving", Scene::default());
    preset.animation = animation(&[("weather.coverage", &[(0.0, "0.2", Ease::Linear), (10.0, "0.6", Ease::Smooth)])]);
    preset.animation.repeats = false;
    preset.play(4.0);
    let text = preset.to_ron();
    let read = Preset::from_ron(&text, "moving.ron").expect("it was just written");
    assert_eq!(read.animation, preset.animation);
    assert_eq!(read.scene.weather.coverage, 0.2, "a file holds the sky at time 0");
    assert_eq!(read.to_ron(), text);
    for (from, to, says) in [
        ("weather.coverage", "weather.covrage", "weather.coverage"),
        ("\"0.6\"", "\"1.6\"", "1.6"),
        ("\"0.6\"", "\"much\"", "a number"),
        ("10.0", "-1.0", "-1"),
        ("10.0", "0.0", "order them by time"),
        ("ease: Smooth", "ease: Wild", "Wild"),
        ("repeats: false", "duration_secs: 0.0", "duration_secs"),
        ("weather.coverage", "weather", "weather.coverage"),
        ("weather.coverage", "weather.layers.0.image", "is a file"),
    ] {
        let broken = text.replacen(from, to, 1);
        assert_ne!(broken, text, "{from}");
        let error = Preset::from_ron(&broken, "moving.ron").expect_err(says).to_string();
        assert!(error.contains(says) && error.starts_with("moving.ron:"), "{from} → {to}: {error}");
    }
}
