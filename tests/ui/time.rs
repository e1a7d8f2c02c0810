//! Keys, the timeline, and films of a day.

use nephoscope::render::LightHistogram;

use crate::*;

const COMMAND: egui::Modifiers = egui::Modifiers::COMMAND;

fn point_at(editor: &mut Editor, key: &str) {
    editor.reach(key);
    editor.with_key(key).hover();
    editor.harness.run();
    editor.press(egui::Key::Escape);
}

fn seek(editor: &mut Editor, text: &str) {
    editor.click("timeline.time");
    editor.harness.key_combination_modifiers(COMMAND, &[egui::Key::A]);
    editor.harness.run();
    editor.harness.event(egui::Event::Text(text.to_owned()));
    editor.harness.run();
    editor.press(egui::Key::Enter);
}

#[test]
fn keys_are_set_moved_eased_and_deleted() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.2");
    point_at(&mut editor, "weather.coverage");
    editor.press(egui::Key::K);
    assert!(editor.has_label("Time ruler"), "the timeline opens with the first key");
    seek(&mut editor, "10");
    assert_eq!(editor.document().time_secs(), 10.0);
    editor.type_number("weather.coverage", "0.6");
    let values = |editor: &Editor| -> Vec<(f64, String)> {
        let track = editor.document().animation().track("weather.coverage").expect("it has keys");
        track.keys.iter().map(|key| (key.time_secs, key.value.clone())).collect()
    };
    assert_eq!(values(&editor), [(0.0, "0.2".to_owned()), (10.0, "0.6".to_owned())], "an edit is a key");
    seek(&mut editor, "0:05");
    seek(&mut editor, "5 s");
    assert!((editor.scene().weather.coverage - 0.4).abs() < 1e-6, "{}", editor.scene().weather.coverage);
    editor.click("weather.coverage.keys.1");
    assert_eq!(editor.document().time_secs(), 10.0, "a click on a key goes there");
    editor.press(egui::Key::ArrowRight);
    assert!((values(&editor)[1].0 - 10.3).abs() < 1e-9, "{:?}", values(&editor));
    editor.click_label("Hold");
    editor.click("weather.coverage.keys.0");
    editor.click_label("Hold");
    editor.harness.state_mut().perform(Action::Seek(5.0));
    assert_eq!(editor.scene().weather.coverage, 0.2, "held until the next key");
    editor.harness.key_press_modifiers(COMMAND, egui::Key::Z);
    editor.harness.run();
    assert!((editor.scene().weather.coverage - 0.4).abs() < 0.02, "undone: {}", editor.scene().weather.coverage);
    editor.click("weather.coverage.keys.1");
    editor.press(egui::Key::Delete);
    assert_eq!(values(&editor).len(), 1);
    editor.click("weather.coverage.keys.remove");
    assert!(!editor.document().animation().is_moving(), "no keys are left");
}

#[test]
fn a_day_is_three_clicks() {
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        let mut editor = Editor::new();
        editor.harness.ctx.set_theme(theme);
        editor.harness.run();
        editor.harness.state_mut().ui.timeline.is_open = true;
        editor.harness.run();
        editor.click_label("Time-lapse");
        editor.click_label("Dawn to dusk in 20 s, clouds ×30");
        assert!(editor.document().is_playing() && editor.document().animation().track("sun.hour_h").is_some());
        let dawn = editor.scene().sun.hour_h;
        editor.harness.state_mut().document.advance_clock(10.0);
        editor.harness.step();
        assert!(editor.scene().sun.hour_h > dawn + 3.0, "{dawn} {}", editor.scene().sun.hour_h);
        editor.harness.state_mut().perform(Action::Play(false));
        editor.harness.run();
    }
}

#[test]
fn where_the_sun_does_not_rise_it_is_said() {
    let mut editor = Editor::new();
    let mut scene = editor.scene().clone();
    (scene.sun.latitude_deg, scene.sun.day) = (89.0, 355);
    editor.harness.state_mut().perform(Action::EditScene { key: "sun".to_owned(), scene: Box::new(scene) });
    editor.harness.state_mut().perform(Action::DayLapse { film_secs: 10.0, speed: 1.0 });
    assert!(editor.toasts()[0].contains("does not come up"), "{:?}", editor.toasts());
    assert!(!editor.document().animation().is_moving());
}

#[test]
fn the_timeline_fits_a_small_window() {
    let mut editor = Editor::sized([800.0, 600.0]);
    editor.harness.state_mut().perform(Action::DayLapse { film_secs: 10.0, speed: 60.0 });
    editor.harness.state_mut().perform(Action::Play(false));
    editor.harness.key_press_modifiers(COMMAND, egui::Key::T);
    editor.harness.run();
    editor.click("sun.hour_h.keys.1");
    let screen = editor.harness.ctx.content_rect();
    let area = editor.with_key("viewport").rect();
    for key in ["timeline.ruler", "timeline.time", "timeline.duration", "sun.hour_h.keys.0", "sun.hour_h.keys.1"] {
        let rect = editor.with_key(key).rect();
        assert!(screen.expand(0.5).contains_rect(rect) && rect.top() >= area.bottom() - 0.5, "{key} at {rect:?}");
    }
}

#[test]
fn exposure_is_metered_and_false_colours_go_as_they_came() {
    let mut editor = Editor::new();
    editor.press(egui::Key::H);
    assert!(editor.has_label("Waiting for a picture") || editor.has_label("Histogram"));
    let mut bins = vec![0; 320];
    bins[160] = 1000;
    let light = LightHistogram { lowest_ev: -6.0, bins };
    let wanted = light.exposure_ev().expect("there is light");
    editor.harness.state_mut().ui.histogram.light = Some(light);
    editor.harness.run();
    editor.click_label("Expose");
    assert!((f64::from(editor.scene().display.exposure_ev) - wanted).abs() < 1e-4, "{wanted}");
    let curve = nephoscope::scene::ToneMap::Neutral;
    let mut scene = editor.scene().clone();
    scene.display.tone_map = curve;
    let edit = Action::EditScene { key: "display.tone_map".to_owned(), scene: Box::new(scene) };
    editor.harness.state_mut().perform(edit);
    editor.harness.run();
    assert!(!editor.harness.state().ui.forced().stripes);
    editor.click("histogram.stripes");
    assert!(editor.harness.state().ui.forced().stripes && editor.harness.state().ui.forced().is_empty());
    editor.click("histogram.false_colour");
    assert_eq!(editor.scene().display.tone_map, nephoscope::scene::ToneMap::FalseColour);
    editor.harness.key_press_modifiers(COMMAND | egui::Modifiers::SHIFT, egui::Key::E);
    editor.harness.run();
    assert_eq!(editor.scene().display.tone_map, curve, "as before");
    assert!(editor.harness.state().ui.dialog.is_none(), "the longer combination alone");
}

#[test]
fn a_sequence_is_asked_for_with_the_films_own_length() {
    let mut editor = Editor::new();
    editor.harness.state_mut().perform(Action::DayLapse { film_secs: 10.0, speed: 60.0 });
    editor.harness.state_mut().perform(Action::Play(false));
    editor.harness.key_press_modifiers(COMMAND, egui::Key::E);
    editor.harness.run();
    editor.click_label("PNG, 16 bits");
    editor.click_label("Sequence");
    editor.click_label("Export");
    let requests = editor.requests.borrow();
    let Some(Request::Export(export)) = requests.last() else { panic!("{requests:?}") };
    let frames = export.frames.expect("it is a sequence");
    assert_eq!((frames.first, frames.last, frames.step), (0, 239, 1), "ten seconds of 24 frames");
    assert!(export.path.display().to_string().ends_with(".####.png"), "{}", export.path.display());
}
