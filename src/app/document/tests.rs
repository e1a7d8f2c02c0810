use super::*;
use crate::scene::{Camera, Scene};

fn document() -> Document {
    Document::new(Preset::default(), Quality::default())
}

#[test]
fn an_edit_marks_and_its_undoing_clears_the_mark() {
    let mut document = document();
    assert!(!document.is_modified(), "fresh");
    let before = document.preset().scene.clone();
    let mut edited = before.clone();
    edited.weather.coverage = 0.9;
    document.apply(&Action::EditScene { key: "weather.coverage".to_owned(), scene: Box::new(edited) });
    assert!(document.is_modified() && document.title().ends_with('*'), "{}", document.title());
    document.apply(&Action::EditScene { key: "weather.coverage".to_owned(), scene: Box::new(before) });
    assert!(!document.is_modified(), "back to what is saved");
}

fn edit(document: &mut Document, coverage: f32) {
    let mut scene = document.preset().scene.clone();
    scene.weather.coverage = coverage;
    document.apply(&Action::EditScene { key: "weather.coverage".to_owned(), scene: Box::new(scene) });
}

fn coverage(document: &Document) -> f32 {
    document.preset().scene.weather.coverage
}

#[test]
fn one_drag_is_one_step_and_flights_have_their_own() {
    let mut document = document();
    let begun = coverage(&document);
    for coverages in [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]] {
        document.hold(true);
        for value in coverages {
            edit(&mut document, value);
        }
        document.hold(false);
    }
    let far = Camera { east_m: 777.0, ..document.preset().scene.camera.clone() };
    document.apply(&Action::MoveCamera(far.clone()));
    assert_eq!(document.steps(), (vec!["edit weather.coverage"; 2], vec![]));
    document.apply(&Action::Undo);
    assert_eq!(coverage(&document), 0.3, "the second drag");
    assert_eq!(document.preset().scene.camera, far, "the camera stays");
    document.apply(&Action::Undo);
    assert_eq!(coverage(&document), begun, "the first");
    document.apply(&Action::Undo);
    assert_eq!(coverage(&document), begun, "nothing before it");
    document.apply(&Action::TravelHistory(2));
    assert_eq!((coverage(&document), document.steps().1.len()), (0.6, 0), "both again");
    document.apply(&Action::ViewBack);
    assert_eq!(document.preset().scene.camera.east_m, 0.0, "back from the flight");
    document.apply(&Action::ViewForth);
    assert_eq!(document.preset().scene.camera, far, "and there again");
    document.apply(&Action::Undo);
    edit(&mut document, 0.9);
    document.apply(&Action::Redo);
    assert_eq!(coverage(&document), 0.9, "what was undone is forgotten after another edit");
}

#[test]
fn another_document_can_be_undone_with_its_file() {
    let mut document = document();
    edit(&mut document, 0.25);
    let other = Document::from_file(Preset::new("Other", Scene::default()), Quality::default(), "o.ron".into());
    document.replace_by(other, "open Other");
    assert_eq!((document.name(), document.is_modified()), ("Other", false));
    document.apply(&Action::Undo);
    assert_eq!((coverage(&document), document.path(), document.is_modified()), (0.25, None, true));
    document.apply(&Action::Redo);
    assert_eq!((document.name(), document.path().is_some()), ("Other", true));
}

#[test]
fn a_step_that_moves_the_camera_brings_it_back() {
    let mut document = document();
    let begun = document.preset().scene.camera.clone();
    let mut scene = document.preset().scene.clone();
    scene.camera.height_m += 500.0;
    document.apply(&Action::EditScene { key: "Camera of Stormy".to_owned(), scene: Box::new(scene) });
    document.apply(&Action::Undo);
    assert_eq!(document.preset().scene.camera, begun, "whatever the step is called");
}

#[test]
fn a_restored_snapshot_belongs_to_its_own_file() {
    let mut document = document();
    document.mark_saved("a.ron".into());
    let snapshot = Action::Restore {
        name: "restore".to_owned(),
        preset: Box::new(document.preset().clone()),
        quality: Box::new(document.quality().clone()),
        path: document.path().cloned(),
        saved: Box::new(document.saved().clone()),
        time_secs: 0.0,
    };
    let other = Document::from_file(Preset::new("B", Scene::default()), Quality::default(), "b.ron".into());
    document.replace_by(other, "open B");
    document.apply(&snapshot);
    assert_eq!(document.path(), Some(&"a.ron".into()), "saving must not overwrite the other sky");
    document.apply(&Action::Undo);
    assert_eq!((document.name(), document.path()), ("B", Some(&"b.ron".into())));
}

#[test]
fn edits_can_be_saved_and_opened_again() {
    let mut document = document();
    let mut scene = document.preset().scene.clone();
    scene.layers[0].top_m = scene.layers[0].base_m - 300.0;
    document.apply(&Action::EditScene { key: "layers.0.top_m".to_owned(), scene: Box::new(scene) });
    assert!(Preset::from_ron(&document.preset().to_ron(), "saved").is_ok(), "the top is above the base");
}

#[test]
fn saving_is_not_undone() {
    let mut document = document();
    edit(&mut document, 0.25);
    document.mark_saved("here.ron".into());
    document.apply(&Action::Undo);
    assert!(document.is_modified(), "what is saved has the edit");
    document.apply(&Action::Redo);
    assert!(!document.is_modified(), "now it is as saved");
}

#[test]
fn time_runs_only_while_playing_and_by_its_factor() {
    let mut document = document();
    document.advance_clock(2.0);
    assert_eq!(document.time_secs(), 0.0);
    document.apply(&Action::Play(true));
    document.apply(&Action::SetSpeed(10.0));
    document.advance_clock(2.0);
    assert_eq!(document.time_secs(), 20.0);
    document.apply(&Action::ResetTime);
    assert_eq!(document.time_secs(), 0.0);
}

#[test]
fn a_dragged_sun_starts_from_where_the_hour_put_it() {
    let mut document = document();
    let mut scene = document.preset().scene.clone();
    scene.sun.placement = SunPlacement::Hour;
    document.apply(&Action::EditScene { key: "sun.placement".to_owned(), scene: Box::new(scene) });
    let before = document.preset().scene.towards_sun();
    document.apply(&Action::TurnSun { elevation_deg: 0.0, azimuth_deg: 0.0 });
    let after = document.preset().scene.towards_sun();
    assert!(before.abs_diff_eq(after, 1e-4), "{before} became {after}");
}

#[test]
fn what_has_keys_is_edited_by_keys_and_undone_with_them() {
    let mut document = document();
    let begun = document.preset().clone();
    let key = "weather.coverage".to_owned();
    edit(&mut document, 0.2);
    document.apply(&Action::SetKey(key.clone()));
    document.apply(&Action::Seek(10.0));
    edit(&mut document, 0.8);
    assert_eq!(document.animation().tracks[0].keys.len(), 2, "the edit became a key");
    document.apply(&Action::Seek(5.0));
    assert!((coverage(&document) - 0.5).abs() < 1e-6, "half way: {}", coverage(&document));
    document.mark_saved("moving.ron".into());
    document.apply(&Action::Seek(7.0));
    assert!(!document.is_modified(), "time alone leaves nothing to save");
    assert_eq!(document.steps().0.len(), 3, "{:?}", document.steps().0);
    document.apply(&Action::Undo);
    assert!((coverage(&document) - 0.2).abs() < 1e-6, "one key is left, at any time");
    document.apply(&Action::TravelHistory(-2));
    assert_eq!(*document.preset(), begun, "as it began");
    document.apply(&Action::TravelHistory(3));
    document.apply(&Action::Seek(10.0));
    assert_eq!(coverage(&document), 0.8, "and all of it again");
    let mut scene = document.preset().scene.clone();
    scene.layers.push(scene.layers[0].clone());
    document.apply(&Action::EditScene { key: "layers".to_owned(), scene: Box::new(scene.clone()) });
    document.apply(&Action::SetKey("layers.1.density".to_owned()));
    scene.layers.remove(0);
    scene.layers[0].density = 0.123;
    document.apply(&Action::EditScene { key: "layers".to_owned(), scene: Box::new(scene) });
    assert!(document.animation().tracks.iter().all(|track| track.key != "layers.1.density"), "there is one layer");
}

#[test]
fn a_flight_with_keys_is_a_step() {
    let mut document = document();
    document.apply(&Action::SetKey("camera.east_m".to_owned()));
    document.apply(&Action::Seek(4.0));
    let far = Camera { east_m: 400.0, ..document.preset().scene.camera.clone() };
    document.apply(&Action::MoveCamera(far));
    document.apply(&Action::Seek(2.0));
    assert!((document.preset().scene.camera.east_m - 200.0).abs() < 1.0, "on the way");
    document.apply(&Action::Undo);
    document.apply(&Action::Seek(4.0));
    assert_eq!(document.preset().scene.camera.east_m, 0.0, "the flight is undone");
}

#[test]
fn a_day_plays_at_once_and_ends_where_it_should() {
    let mut document = document();
    document.apply(&Action::DayLapse { film_secs: 10.0, speed: 2.0 });
    assert!(document.is_playing() && document.time_secs() == 0.0);
    let dawn = document.preset().scene.towards_sun().y;
    document.advance_clock(5.0);
    assert!(document.preset().scene.towards_sun().y > dawn + 0.3, "noon");
    let once = Animation { repeats: false, ..document.animation().clone() };
    document.apply(&Action::EditAnimation { step: "once".to_owned(), animation: Box::new(once) });
    document.advance_clock(50.0);
    assert_eq!((document.time_secs(), document.is_playing()), (20.0, false));
}

#[test]
fn cameras_with_keys_go_back_as_a_step_and_layers_take_their_keys_along() {
    let mut document = document();
    let far = Camera { east_m: 400.0, ..document.preset().scene.camera.clone() };
    document.apply(&Action::MoveCamera(far));
    document.apply(&Action::SetKey("camera.east_m".to_owned()));
    document.apply(&Action::Seek(10.0));
    document.apply(&Action::ViewBack);
    assert_eq!(document.animation().tracks[0].keys.len(), 2, "the way back is a key");
    document.apply(&Action::Undo);
    assert_eq!(document.animation().tracks[0].keys.len(), 1, "and is undone");
    let mut scene = document.preset().scene.clone();
    scene.layers = vec![scene.layers[0].clone(); 3];
    let with = |scene: &Scene, key: &str| Action::EditScene { key: key.to_owned(), scene: Box::new(scene.clone()) };
    document.apply(&with(&scene, "layers"));
    document.apply(&Action::SetKey("layers.2.density".to_owned()));
    scene.layers.truncate(1);
    document.apply(&with(&scene, "Clouds of another"));
    let text = document.preset().to_ron();
    Preset::from_ron(&text, "saved.ron").expect("what is saved opens again");
}

#[test]
fn a_snapshot_brings_its_time_and_a_film_that_has_ended_begins_anew() {
    let mut document = document();
    document.apply(&Action::DayLapse { film_secs: 10.0, speed: 1.0 });
    document.apply(&Action::Seek(5.0));
    let noon = document.preset().scene.towards_sun().y;
    let snapshot = Action::Restore {
        name: "restore".to_owned(),
        preset: Box::new(document.preset().clone()),
        quality: Box::new(document.quality().clone()),
        path: None,
        saved: Box::new(document.saved().clone()),
        time_secs: document.time_secs(),
    };
    document.apply(&Action::Seek(0.0));
    document.apply(&snapshot);
    assert_eq!((document.time_secs(), document.preset().scene.towards_sun().y), (5.0, noon));
    let once = Animation { repeats: false, ..document.animation().clone() };
    document.apply(&Action::EditAnimation { step: "once".to_owned(), animation: Box::new(once) });
    document.advance_clock(100.0);
    document.apply(&Action::Play(true));
    assert!(document.is_playing() && document.time_secs() == 0.0, "from its beginning");
    document.apply(&Action::ChangeExposure(1.0));
    document.apply(&Action::Undo);
    document.apply(&Action::MeterExposure(0.5));
    document.apply(&Action::Redo);
    assert!(document.steps().1.is_empty(), "what is metered takes nothing from the steps");
}
