//! What artists expect of a studio: undo, clipboard, snapshots, less to look at, random skies, presets.

use nephoscope::app::action::{Shape, Steering};

use crate::*;

#[test]
fn steps_are_undone_redone_and_listed() {
    let mut editor = Editor::new();
    let begun = editor.scene().clone();
    editor.type_number("weather.coverage", "0.7");
    editor.type_number("sun.elevation_deg", "pi/6 rad");
    assert!((editor.scene().sun.elevation_deg - 30.0).abs() < 1e-3, "{}", editor.scene().sun.elevation_deg);
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    editor.harness.run();
    assert_eq!((editor.scene().weather.coverage, editor.scene().sun.elevation_deg), (0.7, begun.sun.elevation_deg));
    editor.press(egui::Key::F8);
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Y);
    editor.harness.run();
    assert_ne!(editor.scene().sun.elevation_deg, begun.sun.elevation_deg, "the key of other programs");
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    editor.harness.run();
    assert!(editor.has_label("edit weather.coverage"), "the list of steps");
    editor.click("history.0");
    assert_eq!(*editor.scene(), begun, "the beginning");
    let redo = egui::Modifiers::COMMAND | egui::Modifiers::SHIFT;
    editor.harness.key_press_modifiers(redo, egui::Key::Z);
    editor.harness.run();
    assert_eq!(editor.scene().weather.coverage, 0.7, "the first step again");
    editor.click("history.2");
    assert!((editor.scene().sun.elevation_deg - 30.0).abs() < 1e-3, "and the second");
}

#[test]
fn an_opened_sky_is_undone_like_any_step() {
    let mut editor = Editor::new();
    editor.harness.state_mut().perform(Action::Ask(Request::Open("stormy".into())));
    editor.harness.run();
    assert_eq!(editor.document().name(), "Stormy");
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    editor.harness.run();
    assert_eq!(editor.document().name(), "Test sky");
}

#[test]
fn values_and_sections_are_copied_and_pasted_where_the_pointer_is() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.7");
    let hover = |editor: &mut Editor, key: &str| {
        editor.reach(key);
        editor.with_key(key).hover();
        editor.harness.run();
        // The field that was typed into keeps no focus.
        editor.press(egui::Key::Escape);
    };
    hover(&mut editor, "weather.coverage");
    editor.harness.event(egui::Event::Copy);
    editor.harness.step();
    let copied = editor.harness.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    assert_eq!(copied.as_deref(), Some("weather.coverage=0.7\n"));
    hover(&mut editor, "sun.azimuth_deg");
    editor.harness.event(egui::Event::Paste("12.5".to_owned()));
    editor.harness.run();
    assert_eq!(editor.scene().sun.azimuth_deg, 12.5);
    editor.harness.event(egui::Event::Paste("fast".to_owned()));
    editor.harness.run();
    assert_eq!(editor.scene().sun.azimuth_deg, 12.5);
    assert!(editor.toasts().iter().any(|text| text.contains("Nothing was pasted")), "{:?}", editor.toasts());
    editor.press(egui::Key::Backspace);
    assert_eq!(editor.scene().sun.azimuth_deg, Scene::default().sun.azimuth_deg, "reset");
    hover(&mut editor, "layers.0");
    editor.harness.event(egui::Event::Paste("# layers.7\nbase_m=900\nphase.g=0.5\n".to_owned()));
    editor.harness.run();
    assert_eq!((editor.scene().layers[0].base_m, editor.scene().layers[0].phase.g), (900.0, 0.5));
}

#[test]
fn snapshots_restore_and_are_held_beside_the_picture() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.2");
    let shot = |editor: &mut Editor, grey: u8| {
        let context = editor.harness.ctx.clone();
        let session = editor.harness.state_mut();
        session.ui.viewport.picture = Some(picture(1));
        let pixels = [grey, grey, grey, 255].repeat(16 * 9);
        session.ui.snapshots.add(&context, &session.document, ([16, 9], pixels));
        editor.harness.run();
    };
    editor.press(egui::Key::F7);
    assert_eq!(editor.requests.borrow().last(), Some(&Request::Snapshot));
    shot(&mut editor, 100);
    editor.type_number("weather.coverage", "0.8");
    shot(&mut editor, 110);
    editor.click("snapshots.0");
    editor.click("snapshots.Wipe");
    assert!(editor.harness.query_by_label("Divider between snapshot and picture").is_some());
    editor.click("snapshots.Difference");
    assert!(editor.harness.state().ui.snapshots.wants_difference());
    // A picture of another size than the snapshot's.
    let context = editor.harness.ctx.clone();
    editor.harness.state_mut().ui.snapshots.show_difference(&context, ([4, 3], &[103; 48]));
    editor.harness.run();
    editor.harness.state_mut().ui.snapshots.show_difference(&context, ([4, 3], &[]));
    editor.with_key("snapshots.0").click_secondary();
    editor.harness.run();
    editor.click_label("Restore");
    assert_eq!(editor.scene().weather.coverage, 0.2);
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    editor.harness.run();
    assert_eq!(editor.scene().weather.coverage, 0.8, "restoring is undone");
}

#[test]
fn the_panel_shows_what_is_modified_or_little() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.7");
    editor.click("filter.modified");
    assert!(editor.harness.query(by().predicate(|node| node.author_id() == Some("weather.coverage"))).is_some());
    assert!(editor.harness.query(by().predicate(|node| node.author_id() == Some("sun.elevation_deg"))).is_none());
    editor.click("filter.modified");
    editor.click("filter.simple");
    for key in ["weather.coverage", "sun.elevation_deg", "layers.0.base_m", "display.exposure_ev"] {
        editor.reach(key);
    }
    assert!(editor.harness.query(by().predicate(|node| node.author_id() == Some("layers.0.phase.g"))).is_none());
}

#[test]
fn a_varied_sky_starts_from_the_same_one_and_keeps_what_is_ticked() {
    let mut editor = Editor::new();
    let begun = editor.scene().clone();
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::R);
    editor.harness.run();
    editor.click("vary.keep.sun");
    editor.click_label("Vary");
    let first = editor.scene().clone();
    assert_ne!(first, begun, "it is another sky");
    assert_eq!((&first.sun, &first.camera), (&begun.sun, &begun.camera), "but for what is kept");
    editor.click_label("Another");
    assert_ne!(*editor.scene(), first, "another seed");
    while editor.document().can_undo() {
        editor.harness.state_mut().perform(Action::Undo);
    }
    assert_eq!(*editor.scene(), begun, "back to the beginning");
}

#[test]
fn panels_keep_their_width() {
    let mut editor = Editor::new();
    let width = |editor: &Editor| editor.harness.state().ui.viewport.rect.width();
    let begun = width(&editor);
    assert!(begun > 700.0, "{begun}");
    for _ in 0..100 {
        editor.harness.step();
    }
    assert_eq!(width(&editor), begun, "no row makes its panel wider");
}

#[test]
fn presets_are_starred_searched_taken_over_in_part_and_morphed() {
    let mut editor = Editor::new();
    let begun = editor.scene().clone();
    let menu = |editor: &mut Editor, entry: &str| {
        editor.reach(entry);
        editor.with_key(entry).click_secondary();
        editor.harness.run();
    };
    menu(&mut editor, "preset.stormy");
    editor.click_label("Star");
    assert!(editor.has_label("Starred"), "stars come first");
    menu(&mut editor, "preset.stormy");
    editor.harness.get_by_label_contains("Take over only").click();
    editor.harness.run();
    editor.click_label("Clouds");
    let stormy = Preset::from_ron(include_str!("../../presets/stormy.ron"), "stormy").expect("sound").scene;
    assert_eq!((&editor.scene().layers, &editor.scene().sun), (&stormy.layers, &begun.sun), "the clouds alone");
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    editor.harness.run();
    menu(&mut editor, "preset.stormy");
    editor.click_label("Morph towards it");
    editor.harness.state_mut().ui.library.search = "no such sky".to_owned();
    editor.harness.run();
    assert!(editor.harness.query_by_label("Thesis").is_none(), "the search hides it");
    let slider = editor.with_key("presets.morph").rect();
    editor.harness.hover_at(slider.left_center() + egui::vec2(4.0, 0.0));
    editor.harness.drag_at(slider.left_center() + egui::vec2(4.0, 0.0));
    editor.harness.run();
    editor.harness.hover_at(slider.right_center());
    editor.harness.drop_at(slider.right_center());
    editor.harness.run();
    assert_eq!((&editor.scene().layers, &editor.scene().sun), (&stormy.layers, &stormy.sun), "all the way");
    assert_eq!(editor.scene().camera, begun.camera, "the camera stays");
    editor.click("presets.morph.done");
    assert!(editor.harness.query_by_label("Morph").is_none());
}

#[test]
fn recent_files_and_favourites_come_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a sky with\nlines and spaces.ron");
    let document = || Document::new(Preset::new("Kept", Scene::default()), Quality::default());
    let mut session = Session::new(document(), Folders::below(folder.path()));
    session.perform(Action::Ask(Request::SaveAs(path.clone())));
    session.preferences.toggle_favourite(Path::new("thesis"));
    let mut harness = Harness::builder().with_context_setup(nephoscope::ui::style).build_ui_state(
        |ui, session: &mut Session| {
            session.frame(ui, &Readout::default());
        },
        session,
    );
    harness.run();
    let again = Session::new(document(), Folders::below(folder.path()));
    assert_eq!(again.preferences.recent, [path]);
    assert!(again.preferences.favourites.contains(Path::new("thesis")));
}

#[test]
fn a_dropped_picture_becomes_the_weather_map() {
    let mut editor = Editor::new();
    let map = editor._folder.path().join("map.png");
    let broken = editor._folder.path().join("broken.png");
    std::fs::write(&broken, &include_bytes!("../../thumbnails/thesis.png")[..60]).expect("written");
    editor.harness.state_mut().drop_file(&broken);
    assert_eq!(editor.scene().weather.layers[0].image.0, "", "a damaged file is no map");
    assert!(!editor.toasts().is_empty(), "and that is said");
    image::RgbImage::from_pixel(8, 8, image::Rgb([90, 0, 0])).save(&map).expect("written");
    editor.harness.state_mut().drop_file(&map);
    assert_eq!(editor.scene().weather.layers[0].image.0, map.display().to_string());
    editor.harness.state_mut().drop_file(Path::new("stormy"));
    editor.harness.run();
    assert!(editor.harness.state().ui.dialog.is_some(), "unsaved changes are asked about");
}

#[test]
fn the_palette_finds_commands_presets_and_parameters() {
    let mut editor = Editor::new();
    let search = |editor: &mut Editor, text: &str| {
        editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::P);
        editor.harness.run();
        editor.harness.event(egui::Event::Text(text.to_owned()));
        editor.harness.run();
    };
    search(&mut editor, "timing over");
    editor.press(egui::Key::Enter);
    assert!(editor.harness.state().ui.show_overlay, "a command");
    search(&mut editor, "open stormy");
    editor.press(egui::Key::Enter);
    assert_eq!(editor.document().name(), "Stormy", "a sky");
    search(&mut editor, "azimuth");
    editor.press(egui::Key::ArrowDown);
    editor.press(egui::Key::Enter);
    assert_eq!(editor.harness.state().ui.panel.filter, "moon.azimuth_deg", "a parameter");
    search(&mut editor, "no such thing at all");
    editor.press(egui::Key::Enter);
    assert!(editor.has_label("Nothing is called that"));
    editor.press(egui::Key::Escape);
    assert!(!editor.harness.state().ui.palette.is_open);
}

#[test]
fn the_sundial_turns_the_sun_and_knows_hours_and_cities() {
    let mut editor = Editor::new();
    editor.click("sundial.section");
    let dial = editor.with_key("sundial").rect();
    // Half way from the middle to the horizon in the east: 90° − ½ · 90°.
    let at = dial.center() + egui::vec2((0.5 * dial.width() - 10.0) * 45.0 / 108.0, 0.0);
    editor.harness.hover_at(at);
    editor.harness.drag_at(at);
    editor.harness.run();
    editor.harness.drop_at(at);
    editor.harness.run();
    let sun = editor.scene().sun.clone();
    assert!((sun.elevation_deg - 45.0).abs() < 1.0 && (sun.azimuth_deg - 90.0).abs() < 1.0, "{sun:?}");
    editor.click_label("Sunset");
    let sun = editor.scene().sun.clone();
    assert!(sun.placement == nephoscope::scene::SunPlacement::Hour && sun.hour_h > 16.0, "{sun:?}");
    assert!(editor.scene().towards_sun().y.abs() < 0.05, "on the horizon");
    editor.click("sun.city");
    editor.click_label("Auckland");
    assert_eq!(editor.scene().sun.latitude_deg, -36.85);
    editor.type_number("sun.latitude_deg", "80");
    let sunset = by().predicate(|node| node.label().as_deref() == Some("Sunset") && node.is_disabled());
    assert!(editor.harness.query(sunset).is_some(), "midsummer night");
    editor.click_label("Now");
    assert!((1..=366).contains(&editor.scene().sun.day));
}

#[test]
fn what_a_crash_left_is_chosen_among_its_copies() {
    let mut editor = Editor::new();
    let copy = |name: &str| Preset { name: name.to_owned(), ..Default::default() };
    let secs = std::time::Duration::from_secs;
    let copies = vec![(copy("Newest"), secs(20)), (copy("Older"), secs(7400)), (copy("Oldest"), secs(200_000))];
    editor.harness.state_mut().offer_recovery(copies);
    editor.harness.run();
    assert!(editor.has_label("Newest, 20 s ago, the newest") && editor.has_label("Oldest, 2 days ago"));
    editor.click("recover.1");
    editor.click_label("Recover");
    assert_eq!(editor.requests.borrow().last(), Some(&Request::Recover(Some(1))));
    let session = editor.harness.state();
    assert!(session.document.preset().name == "Older" && session.document.is_modified(), "unsaved");
    assert!(!session.has_undecided_recovery());
}

#[test]
fn a_still_in_the_making_says_how_far_it_is_and_can_be_given_up() {
    let mut editor = Editor::new();
    editor.harness.state_mut().ui.busy = Some(nephoscope::ui::Busy {
        text: "Rendering a still".to_owned(),
        progress: Some((0.25, Some(75.0))),
        steering: Some(Steering::On),
        end: "Ends with what is done",
    });
    editor.harness.run();
    assert!(editor.has_label("25 % · 0:01:15"), "share and time left");
    let asks = |editor: &mut Editor, button: &str, wanted: Steering| {
        editor.click(button);
        assert_eq!(editor.requests.borrow().last(), Some(&Request::Steer(wanted)), "{button}");
    };
    asks(&mut editor, "busy.wait", Steering::Wait);
    asks(&mut editor, "busy.end", Steering::End);
    asks(&mut editor, "busy.cancel", Steering::GiveUp);
    editor.harness.state_mut().ui.busy.as_mut().expect("it is there").steering = Some(Steering::Wait);
    editor.harness.run();
    assert!(editor.has_label("25 % · waits"), "no guess of what is left");
    asks(&mut editor, "busy.wait", Steering::On);
}

#[test]
fn a_panorama_of_layers_is_asked_for_in_the_export_form() {
    let mut editor = Editor::new();
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::E);
    editor.harness.run();
    editor.click_label("EXR, layers of light");
    editor.click_label("Panorama");
    editor.click_label("4K");
    editor.click_label("Export");
    let requests = editor.requests.borrow();
    let Some(Request::Export(export)) = requests.last() else { panic!("{requests:?}") };
    assert!(export.shape == Shape::Panorama && export.size == [4096, 2048], "{export:?}");
    assert_eq!(export.still, nephoscope::app::action::Still::LayersExr);
}

#[test]
fn a_click_asks_for_a_point_only_while_points_are_inspected() {
    let mut editor = Editor::new();
    editor.harness.state_mut().ui.viewport.picture = Some(picture(1));
    editor.harness.run();
    let rect = editor.harness.state().ui.viewport.rect;
    let click = |editor: &mut Editor| {
        let at = rect.min + egui::vec2(0.25 * rect.width(), 0.75 * rect.height());
        editor.harness.hover_at(at);
        editor.harness.drag_at(at);
        editor.harness.drop_at(at);
        editor.harness.run();
    };
    click(&mut editor);
    assert_eq!(editor.harness.state().ui.inspector.wish, None, "not now");
    editor.press(egui::Key::I);
    click(&mut editor);
    let wish = editor.harness.state().ui.inspector.wish.expect("now");
    assert!((wish[0] - 0.25).abs() < 0.1 && (wish[1] - 0.75).abs() < 0.2, "{wish:?}");
    editor.press(egui::Key::I);
    assert!(!editor.harness.state().ui.inspector.is_on && editor.harness.state().ui.inspector.wish.is_none());
}

#[test]
fn a_pasted_sky_asks_before_work_is_lost_and_is_not_saved_yet() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.7");
    let text = Preset::new("From elsewhere", Scene::default()).to_ron();
    editor.harness.hover_at(editor.harness.state().ui.viewport.rect.center());
    editor.press(egui::Key::Escape);
    editor.harness.event(egui::Event::Paste(text));
    editor.harness.run();
    assert_eq!(editor.document().name(), "Test sky", "there is something to lose");
    editor.click_label("Discard");
    assert_eq!(editor.document().name(), "From elsewhere");
    assert!(editor.document().is_modified(), "no file holds it");
}

#[test]
fn a_stretch_of_work_goes_in_both_themes() {
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        let mut editor = Editor::new();
        editor.harness.ctx.set_theme(theme);
        editor.harness.run();
        // Search, edit, reset.
        editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::F);
        editor.harness.run();
        editor.harness.event(egui::Event::Text("coverage".to_owned()));
        editor.harness.run();
        editor.type_number("weather.coverage", "0.9");
        assert_eq!(editor.scene().weather.coverage, 0.9, "{theme:?}");
        editor.click("weather.coverage.reset");
        assert_eq!(editor.scene().weather.coverage, Scene::default().weather.coverage);
        // Undo both.
        for _ in 0..2 {
            editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
            editor.harness.run();
        }
        assert!(!editor.document().is_modified(), "{theme:?}");
        // A and B.
        let context = editor.harness.ctx.clone();
        let session = editor.harness.state_mut();
        session.ui.viewport.picture = Some(picture(1));
        session.ui.snapshots.add(&context, &session.document, ([16, 9], [90, 90, 90, 255].repeat(16 * 9)));
        editor.harness.run();
        editor.click("snapshots.0");
        editor.click("snapshots.Wipe");
        assert!(editor.harness.query_by_label("Divider between snapshot and picture").is_some(), "{theme:?}");
        // Keys.
        editor.harness.state_mut().perform(Action::SetKey("weather.coverage".to_owned()));
        editor.harness.state_mut().ui.timeline.is_open = true;
        editor.harness.run();
        editor.click("weather.coverage.keys.remove");
        assert!(!editor.document().animation().is_moving(), "{theme:?}");
    }
}

#[test]
fn text_has_its_own_undo() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.7");
    editor.click("filter");
    editor.harness.event(egui::Event::Text("sun".to_owned()));
    editor.harness.run();
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    editor.harness.run();
    assert_eq!(editor.scene().weather.coverage, 0.7, "the sky is as it was");
}

#[test]
fn presets_that_others_put_into_the_folder_are_listed() {
    let mut editor = Editor::new();
    let folder = editor.harness.state().folders.presets.clone();
    assert!(!editor.has_label("From elsewhere"));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("elsewhere.ron");
    Preset::new("From elsewhere", Scene::default()).save(&path).expect("written");
    editor.harness.state_mut().notice_presets();
    let listed = |editor: &Editor| editor.harness.state().ui.library.user.iter().any(|entry| entry.source == path);
    assert!(listed(&editor), "it is there");
    let has_picture = |editor: &Editor| editor.harness.state().ui.library.user[0].thumbnail.is_some();
    assert!(!has_picture(&editor));
    editor.harness.state_mut().note_picture(&path, ([16, 9], &[120; 16 * 9 * 4]));
    editor.harness.run();
    assert!(has_picture(&editor), "a picture that was made later");
    std::fs::remove_file(&path).expect("removed");
    // File systems count time in steps.
    std::thread::sleep(std::time::Duration::from_millis(20));
    std::fs::write(folder.join("other.txt"), "").expect("written");
    editor.harness.state_mut().notice_presets();
    assert!(!listed(&editor), "it is gone");
}

#[test]
fn a_genus_comes_by_its_name_and_says_what_its_water_does() {
    let mut editor = Editor::new();
    let sun = editor.scene().sun.clone();
    editor.click("genera.section");
    editor.click("genus.Cirrus");
    editor.click_label("In place of these clouds");
    assert!(editor.scene().layers.len() == 1 && editor.scene().layers[0].base_m > 5000.0, "high");
    assert_eq!(editor.scene().sun, sun, "the light stays");
    let said = |editor: &Editor, start: &str| {
        let by = by().predicate(move |node| node.value().or(node.label()).is_some_and(|text| text.starts_with(start)));
        editor.harness.query_all(by).next().is_some()
    };
    assert!(said(&editor, "Layer 1: droplets of 24"), "crystals of 24 µm");
    editor.click("genus.Cumulus humilis");
    editor.click_label("Beside these clouds");
    assert_eq!(editor.scene().layers.len(), 2);
    assert!(said(&editor, "Layer 2: droplets of 5.9"), "water, not ice");
    editor.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    editor.harness.run();
    assert_eq!(editor.scene().layers.len(), 1, "one step");
}

#[test]
fn the_brush_touches_where_the_mouse_is_dragged_while_it_is_on() {
    let mut editor = Editor::new();
    editor.harness.state_mut().ui.viewport.picture = Some(picture(1));
    editor.harness.run();
    let rect = editor.harness.state().ui.viewport.rect;
    let at = |u: f32, v: f32| rect.min + egui::vec2(u * rect.width(), v * rect.height());
    let stroke = |editor: &mut Editor| {
        editor.harness.hover_at(at(0.3, 0.5));
        editor.harness.drag_at(at(0.3, 0.5));
        editor.harness.step();
        editor.harness.hover_at(at(0.5, 0.4));
        editor.harness.step();
        editor.harness.drop_at(at(0.5, 0.4));
        editor.harness.run();
    };
    stroke(&mut editor);
    assert!(editor.harness.state().ui.paint.touches.is_empty(), "not now");
    editor.press(egui::Key::P);
    assert!(editor.has_label("Brush"), "its controls");
    stroke(&mut editor);
    let touches = std::mem::take(&mut editor.harness.state_mut().ui.paint.touches);
    let begun = touches.iter().filter(|touch| touch.begins).count();
    assert!(begun == 1 && touches.len() >= 2 && touches[0].begins, "{touches:?}");
    let last = touches.last().expect("there are two").at;
    assert!((last[0] - 0.5).abs() < 0.1 && (last[1] - 0.4).abs() < 0.2, "{touches:?}");
    editor.press(egui::Key::I);
    assert!(!editor.harness.state().ui.paint.is_on, "a click cannot do both");
}
