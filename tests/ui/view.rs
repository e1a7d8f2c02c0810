//! The picture and the camera: habits of the mouse, kept cameras, guides, preferences, first steps.

use egui::{Modifiers, PointerButton, Pos2};
use nephoscope::app::preferences::Habit;
use nephoscope::ui::Gesture;

use crate::*;

fn drag(editor: &mut Editor, button: PointerButton, modifiers: Modifiers) -> Vec<Gesture> {
    let at = editor.with_key("viewport").rect().center();
    editor.harness.state_mut().ui.viewport.gestures.clear();
    let press = |pressed| egui::Event::PointerButton { pos: at, button, pressed, modifiers };
    editor.harness.event(egui::Event::ModifiersChanged(modifiers));
    editor.harness.event(egui::Event::PointerMoved(at));
    editor.harness.event(press(true));
    editor.harness.step();
    for step in 1..=3 {
        editor.harness.event(egui::Event::PointerMoved(Pos2::new(at.x, at.y - 20.0 * step as f32)));
        editor.harness.step();
    }
    editor.harness.event(press(false));
    editor.harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    editor.harness.run();
    editor.harness.state().ui.viewport.gestures.clone()
}

#[test]
fn the_mouse_follows_the_habit_that_was_chosen() {
    use PointerButton::{Middle, Primary, Secondary};
    let mut editor = Editor::new();
    let (none, alt, shift) = (Modifiers::NONE, Modifiers::ALT, Modifiers::SHIFT);
    type Is = fn(&Gesture) -> bool;
    let orbits: Is = |gesture| matches!(gesture, Gesture::Orbit(_));
    let pans: Is = |gesture| matches!(gesture, Gesture::Pan(_));
    let nears: Is = |gesture| matches!(gesture, Gesture::Dolly(way) if *way > 0.0);
    let looks: Is = |gesture| matches!(gesture, Gesture::StartLook);
    let walks: Is = |gesture| matches!(gesture, Gesture::Walk(_));
    for (habit, button, modifiers, is) in [
        (Habit::Blender, Middle, none, orbits),
        (Habit::Blender, Middle, shift, pans),
        (Habit::Blender, Middle, Modifiers::COMMAND, nears),
        (Habit::Blender, Primary, shift, orbits),
        (Habit::Blender, Secondary, none, looks),
        (Habit::Maya, Primary, alt, orbits),
        (Habit::Maya, Middle, alt, pans),
        (Habit::Maya, Secondary, alt, nears),
        (Habit::Maya, Secondary, none, looks),
        (Habit::Unreal, Middle, none, pans),
        (Habit::Unreal, Primary, none, walks),
        (Habit::Unreal, Secondary, alt, nears),
    ] {
        editor.harness.state_mut().preferences.habit = habit;
        let seen = drag(&mut editor, button, modifiers);
        assert!(!seen.is_empty() && seen.iter().all(is), "{habit:?}, {button:?} with {modifiers:?}: {seen:?}");
    }
    editor.harness.state_mut().preferences.habit = Habit::Maya;
    assert_eq!(drag(&mut editor, Middle, none), [], "Maya wants Alt");
}

#[test]
fn cameras_are_kept_named_gone_to_and_forgotten() {
    let mut editor = Editor::new();
    let begun = editor.scene().camera.clone();
    editor.harness.key_press_modifiers(Modifiers::COMMAND, egui::Key::K);
    editor.harness.run();
    let far = nephoscope::scene::Camera { east_m: 900.0, ..begun.clone() };
    editor.harness.state_mut().perform(Action::MoveCamera(far.clone()));
    editor.harness.key_press_modifiers(Modifiers::COMMAND, egui::Key::K);
    editor.harness.run();
    editor.press(egui::Key::Num1);
    assert_eq!(editor.scene().camera, begun, "1 goes to the first");
    editor.press(egui::Key::Num2);
    assert_eq!(editor.scene().camera, far, "2 to the second");
    editor.press(egui::Key::Num3);
    assert_eq!(editor.scene().camera, far, "there is no third");
    editor.harness.key_press_modifiers(Modifiers::ALT, egui::Key::ArrowLeft);
    editor.harness.run();
    assert_eq!(editor.scene().camera, begun, "a jump is gone back from");
    editor.click_label("View");
    editor.click_label_contains("Cameras");
    editor.with_key("cameras.1.name").click();
    editor.harness.run();
    editor.harness.key_combination_modifiers(Modifiers::COMMAND, &[egui::Key::A]);
    editor.harness.event(egui::Event::Text("From afar".to_owned()));
    editor.harness.run();
    editor.with_key("cameras.0.remove").click();
    editor.harness.run();
    let kept = &editor.document().preset().cameras;
    assert_eq!((kept.len(), kept[0].name.as_str(), &kept[0].camera), (1, "From afar", &far));
    editor.press(egui::Key::Escape);
    editor.harness.key_press_modifiers(Modifiers::COMMAND, egui::Key::Z);
    editor.harness.run();
    assert_eq!(editor.document().preset().cameras.len(), 2, "forgetting is undone");
    assert_eq!(editor.scene().camera, begun, "and the camera stays");
}

#[test]
fn the_clouds_are_looked_at_from_below_and_from_above() {
    let mut editor = Editor::new();
    for (height_m, looks_up) in [(20.0, true), (12_000.0, false)] {
        let begun = editor.scene().camera.clone();
        let camera = nephoscope::scene::Camera { height_m, roll_deg: 30.0, pitch_deg: 80.0, ..begun };
        editor.harness.state_mut().perform(Action::MoveCamera(camera.clone()));
        editor.press(egui::Key::F);
        let seen = &editor.scene().camera;
        assert_eq!((seen.pitch_deg > 0.0, seen.roll_deg, seen.height_m), (looks_up, 0.0, height_m));
        assert!(seen.pitch_deg.abs() < 75.0, "{}", seen.pitch_deg);
    }
}

#[test]
fn preferences_and_help_open_and_first_steps_are_told_once() {
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        let mut editor = Editor::sized([800.0, 600.0]);
        editor.harness.ctx.set_theme(theme);
        editor.harness.run();
        editor.click("first_steps.close");
        assert!(editor.harness.state().preferences.is_introduced);
        assert!(!editor.has_label("Got it"));
        editor.harness.key_press_modifiers(Modifiers::COMMAND, egui::Key::Comma);
        editor.harness.run();
        editor.click_label("Maya");
        assert_eq!(editor.harness.state().preferences.habit, Habit::Maya);
        editor.click_label("Feet and knots");
        editor.click_label("Close");
        editor.type_number("weather.size_m", "80000");
        assert!((editor.scene().weather.size_m - 24_384.0).abs() < 0.1, "feet: {}", editor.scene().weather.size_m);
        editor.type_number("weather.size_m", "30 km");
        assert!((editor.scene().weather.size_m - 30_000.0).abs() < 0.1, "named: {}", editor.scene().weather.size_m);
        editor.harness.key_press_modifiers(Modifiers::SHIFT, egui::Key::F1);
        editor.harness.run();
        assert_eq!(editor.harness.state().ui.dialog, Some(Dialog::Help));
        assert!(editor.has_label("Taking away"));
        editor.press(egui::Key::Escape);
        editor.press(egui::Key::G);
        assert!(editor.harness.state().ui.viewport.has_guides);
    }
}

#[test]
fn a_region_is_dragged_drawn_alone_and_exported() {
    let mut editor = Editor::new();
    editor.harness.state_mut().ui.viewport.picture = Some(picture(1));
    editor.harness.key_press_modifiers(Modifiers::COMMAND, egui::Key::B);
    editor.harness.run();
    let area = editor.with_key("viewport").rect();
    let at = |u: f32, v: f32| Pos2::new(area.left() + u * area.width(), area.top() + v * area.height());
    let button = |pressed, pos| egui::Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    editor.harness.event(egui::Event::PointerMoved(at(0.25, 0.5)));
    editor.harness.event(button(true, at(0.25, 0.5)));
    editor.harness.step();
    for share in [0.6, 0.7, 0.75] {
        editor.harness.event(egui::Event::PointerMoved(at(share, share)));
        editor.harness.step();
    }
    editor.harness.event(button(false, at(0.75, 0.75)));
    editor.harness.run();
    let region = editor.harness.state().ui.viewport.region.expect("it was dragged");
    for (seen, wanted) in region.into_iter().zip([0.25, 0.5, 0.75, 0.75]) {
        assert!((seen - wanted).abs() < 0.01, "{region:?}");
    }
    editor.harness.key_press_modifiers(Modifiers::COMMAND, egui::Key::E);
    editor.harness.run();
    editor.click_label("Export");
    let asked = editor.requests.borrow().last().cloned();
    let Some(Request::Export(export)) = asked else { panic!("{asked:?}") };
    // The still is wider than the viewport, and shows the same directions in its middle.
    let narrower = area.width() / area.height() / (1920.0 / 1080.0);
    let wanted = [0.5 - 0.25 * narrower, 0.5, 0.5 + 0.25 * narrower, 0.75];
    for (seen, wanted) in export.region.expect("it is asked for").into_iter().zip(wanted) {
        assert!((seen - wanted).abs() < 0.01, "{:?} instead of {wanted:?}", export.region);
    }
    editor.harness.key_press_modifiers(Modifiers::COMMAND, egui::Key::B);
    editor.harness.run();
    assert_eq!(editor.harness.state().ui.viewport.region, None, "all of it again");
}

#[test]
fn menus_open_by_the_keyboard() {
    let mut editor = Editor::new();
    editor.reach("weather.coverage.label");
    editor.with_key("weather.coverage.label").focus();
    editor.harness.run();
    editor.harness.key_press_modifiers(Modifiers::SHIFT, egui::Key::F10);
    editor.harness.run();
    editor.click_label("Copy Coverage");
    assert!(!editor.has_label("Copy Coverage"), "the menu closes");
}
