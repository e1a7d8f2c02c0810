//! The editor's panels driven as a user would, through their accessible names; no window, no device.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use egui_kittest::Harness;
use egui_kittest::kittest::{Queryable as _, by};
use nephoscope::app::action::{Action, Lab, Order, Request};
use nephoscope::app::{Document, Folders, Session};
use nephoscope::lab::metrics::{Errors, Estimate};
use nephoscope::plan::Integrator;
use nephoscope::scene::{CloudLayer, Preset, Quality, QualityLevel, Scene};
use nephoscope::ui::{Comparison, Dialog, LabView, Measured, Phase, Picture, Readout, Refined, Refinement, TruthState};

mod ui {
    mod studio;
    mod time;
    mod view;
}

/// The panels with a session, and what was left for the window to do.
struct Editor {
    harness: Harness<'static, Session>,
    requests: Rc<RefCell<Vec<Request>>>,
    _folder: tempfile::TempDir,
}

impl Editor {
    fn sized(size: [f32; 2]) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let document = Document::new(Preset::new("Test sky", Scene::default()), Quality::default());
        let session = Session::new(document, Folders::below(folder.path()));
        let requests = Rc::new(RefCell::new(Vec::new()));
        let left = Rc::clone(&requests);
        let harness = Harness::builder().with_size(size).with_context_setup(nephoscope::ui::style).build_ui_state(
            move |ui, session: &mut Session| {
                let requests = session.frame(ui, &Readout::default());
                left.borrow_mut().extend(requests);
            },
            session,
        );
        Self { harness, requests, _folder: folder }
    }

    fn new() -> Self {
        Self::sized([1280.0, 900.0])
    }

    fn document(&self) -> &Document {
        &self.harness.state().document
    }

    fn scene(&self) -> &Scene {
        &self.document().preset().scene
    }

    /// The widget of a parameter, by its key; scrolls to it as a user would.
    fn reach(&mut self, key: &str) {
        self.with_key(key).scroll_to_me();
        self.harness.run();
    }

    fn with_key<'e>(&'e self, key: &'e str) -> egui_kittest::Node<'e> {
        self.harness.get(by().predicate(move |node| node.author_id() == Some(key)))
    }

    fn click(&mut self, key: &str) {
        self.reach(key);
        self.with_key(key).click();
        self.harness.run();
    }

    fn click_label(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.harness.run();
    }

    fn click_label_contains(&mut self, label: &str) {
        let found = self.harness.query_all_by_label_contains(label).next();
        found.unwrap_or_else(|| panic!("nothing says {label}")).click();
        self.harness.run();
    }

    /// Types into the number field of a parameter.
    fn type_number(&mut self, key: &str, text: &str) {
        let field = format!("{key}.value");
        self.reach(&field);
        self.with_key(&field).click();
        self.harness.run();
        self.harness.key_combination_modifiers(egui::Modifiers::COMMAND, &[egui::Key::A]);
        self.harness.run();
        self.harness.event(egui::Event::Text(text.to_owned()));
        self.harness.run();
        self.harness.key_press(egui::Key::Enter);
        self.harness.run();
    }

    fn is_disabled(&self, key: &str) -> bool {
        self.harness.query(by().predicate(|node| node.author_id() == Some(key) && node.is_disabled())).is_some()
    }

    fn truth(&mut self) -> &mut TruthState {
        &mut self.harness.state_mut().ui.truth
    }

    fn press(&mut self, key: egui::Key) {
        self.harness.key_press(key);
        self.harness.run();
    }

    fn toasts(&self) -> Vec<String> {
        self.harness.state().ui.toasts.texts().map(str::to_owned).collect()
    }

    fn has_label(&self, text: &str) -> bool {
        self.harness.query_all_by_label_contains(text).next().is_some()
    }
}

#[test]
fn an_edit_reaches_the_document_and_marks_it() {
    let mut editor = Editor::new();
    assert!(editor.has_label("Test sky"), "the name is shown");
    editor.type_number("weather.coverage", "0.8");
    assert_eq!(editor.scene().weather.coverage, 0.8);
    assert!(editor.document().is_modified() && editor.has_label("Test sky*"), "the unsaved mark is shown");
}

#[test]
fn sliders_are_draggable() {
    let mut editor = Editor::new();
    let rect = editor.with_key("weather.coverage").rect();
    editor.harness.drag_at(rect.center());
    editor.harness.run();
    editor.harness.hover_at(rect.right_center());
    editor.harness.run();
    editor.harness.drop_at(rect.right_center());
    editor.harness.run();
    assert!(editor.scene().weather.coverage > 0.9, "{}", editor.scene().weather.coverage);
}

#[test]
fn typed_nonsense_and_values_out_of_range_do_no_harm() {
    let mut editor = Editor::new();
    for text in ["NaN", "inf", "cloudy"] {
        editor.type_number("weather.coverage", text);
        assert_eq!(editor.scene(), &Scene::default(), "after {text}");
    }
    editor.type_number("weather.coverage", "7");
    assert_eq!(editor.scene().weather.coverage, 1.0, "the end of the range");
}

#[test]
fn rows_reset_to_their_default() {
    let mut editor = Editor::new();
    assert!(editor.is_disabled("weather.coverage.reset"), "nothing to reset");
    editor.type_number("weather.coverage", "0.8");
    editor.click("weather.coverage.reset");
    assert_eq!(editor.scene(), &Scene::default());
    assert!(!editor.document().is_modified(), "and the mark is gone");
}

#[test]
fn sections_fold_and_reset() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.8");
    editor.type_number("weather.size_m", "5000 m");
    assert_eq!(editor.scene().weather.size_m, 5000.0, "units may be typed");
    editor.click("weather.reset");
    assert_eq!(editor.scene(), &Scene::default());
    editor.click("weather");
    assert!(editor.harness.query(by().predicate(|node| node.author_id() == Some("weather.coverage"))).is_none());
    editor.click("weather");
    editor.reach("weather.coverage");
}

#[test]
fn the_filter_shows_what_matches_wherever_it_is_folded() {
    let mut editor = Editor::new();
    let g = "layers.0.phase.g";
    let is_g = |node: &egui_kittest::kittest::AccessKitNode<'_>| node.author_id() == Some(g);
    assert!(editor.harness.query(by().predicate(is_g)).is_none(), "folded");
    editor.with_key("filter").focus();
    editor.harness.run();
    editor.harness.event(egui::Event::Text("anisotropy".to_owned()));
    editor.harness.run();
    assert!(editor.harness.query(by().predicate(is_g)).is_some(), "found by its help text");
    assert!(
        editor.harness.query(by().predicate(|node| node.author_id() == Some("weather.coverage"))).is_none(),
        "what does not match is hidden"
    );
    editor.click("filter.clear");
    assert!(editor.harness.query(by().predicate(is_g)).is_none(), "folded again");
}

#[test]
fn layers_are_added_duplicated_and_removed() {
    let mut editor = Editor::new();
    editor.reach("layers.0");
    editor.click_label("+ Add cloud layer");
    assert_eq!(editor.scene().layers.len(), 2);
    editor.click("layers.1.remove");
    assert_eq!(editor.scene().layers, vec![CloudLayer::default()]);
    editor.click("layers.0.duplicate");
    editor.click("layers.0.duplicate");
    editor.click("layers.0.duplicate");
    assert_eq!(editor.scene().layers.len(), 4);
    assert!(!editor.has_label("+ Add cloud layer"), "no more than the march takes");
}

#[test]
fn quality_levels_and_rows_change_quality_alone() {
    let mut editor = Editor::new();
    editor.click("quality");
    editor.click_label("Draft");
    assert_eq!(editor.document().quality_level(), Some(QualityLevel::Draft));
    editor.type_number("quality.view_steps", "77");
    assert_eq!(editor.document().quality().view_steps, 77);
    assert!(!editor.document().is_modified(), "quality belongs to the user, not to the preset");
}

#[test]
fn unsaved_changes_are_asked_about_before_another_sky_opens() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.8");
    let other = editor.harness.state().ui.library.builtin[1].name.clone();
    editor.click_label(&other);
    assert!(editor.has_label("Save changes?"), "asked");
    editor.click_label("Cancel");
    assert_eq!(editor.scene().weather.coverage, 0.8, "cancel keeps");
    editor.click_label(&other);
    editor.click_label("Discard");
    assert_eq!(editor.document().preset().name, other);
    assert!(!editor.document().is_modified(), "a fresh preset");
}

#[test]
fn saving_first_goes_on_only_when_it_worked() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.8");
    editor.harness.key_combination_modifiers(egui::Modifiers::COMMAND, &[egui::Key::N]);
    editor.harness.run();
    editor.click_label("Save");
    assert!(matches!(editor.harness.state().ui.dialog, Some(Dialog::SaveAs { .. })), "asks where");
    set_path(&mut editor, Path::new("/no/such/folder/sky.ron"));
    editor.click_label("Save");
    assert!(editor.toasts().iter().any(|text| text.contains("/no/such/folder")), "{:?}", editor.toasts());
    assert_eq!(editor.scene().weather.coverage, 0.8, "nothing was lost");
    assert!(editor.document().is_modified(), "and it still counts as unsaved");
}

fn set_path(editor: &mut Editor, path: &Path) {
    match &mut editor.harness.state_mut().ui.dialog {
        Some(dialog) => dialog.set_path(path.display().to_string()),
        None => panic!("no dialog is open"),
    }
    editor.harness.run();
}

#[test]
fn what_is_saved_opens_again() {
    let mut editor = Editor::new();
    editor.type_number("weather.coverage", "0.8");
    let path = editor.harness.state().folders.presets.join("mine.ron");
    editor.harness.key_combination_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, &[egui::Key::S]);
    editor.harness.run();
    set_path(&mut editor, &path);
    editor.click_label("Save");
    assert!(!editor.document().is_modified(), "{:?}", editor.toasts());
    assert_eq!(editor.harness.state().ui.library.user.len(), 1, "listed among the user's");
    editor.harness.key_combination_modifiers(egui::Modifiers::COMMAND, &[egui::Key::N]);
    editor.harness.run();
    assert_eq!(editor.scene(), &Scene::default(), "nothing to ask");
    editor.harness.state_mut().open(&path);
    assert_eq!(editor.scene().weather.coverage, 0.8);
}

#[test]
fn broken_files_leave_the_document_and_say_where() {
    let mut editor = Editor::new();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cases = [
        ("broken.ron", "(version: 2, scene: (".as_bytes()),
        ("unknown.ron", "(version: 2, scene: (weather: (coverag: 0.5)))".as_bytes()),
        ("range.ron", "(version: 2, scene: (weather: (coverage: 7.0)))".as_bytes()),
        ("nan.ron", "(version: 2, scene: (weather: (coverage: NaN)))".as_bytes()),
        ("type.ron", "(version: 2, scene: (weather: (coverage: \"much\")))".as_bytes()),
        ("binary.ron", &[0xff, 0xfe, 0x00]),
        ("picture.exr", b"not an image"),
    ];
    let before = editor.document().preset().clone();
    for (name, contents) in cases {
        let path = folder.path().join(name);
        std::fs::write(&path, contents).expect("the folder is writable");
        editor.harness.state_mut().open(&path);
        editor.harness.run();
        let toasts = editor.toasts();
        assert!(toasts.last().is_some_and(|text| text.contains(name)), "{name}: {toasts:?}");
        assert_eq!(editor.document().preset(), &before, "{name}");
    }
    editor.harness.state_mut().open(&folder.path().join("missing.ron"));
    assert!(editor.toasts().last().is_some_and(|text| text.contains("missing.ron")), "{:?}", editor.toasts());
}

#[test]
fn a_preset_that_others_have_changed_is_not_overwritten_unasked() {
    let mut editor = Editor::new();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("shared.ron");
    editor.document().preset().save(&path).expect("the folder is writable");
    editor.harness.state_mut().open(&path);
    editor.type_number("weather.coverage", "0.8");
    let mut theirs = editor.document().saved().clone();
    theirs.name = "Theirs".to_owned();
    theirs.save(&path).expect("the folder is writable");
    let save = |editor: &mut Editor| {
        editor.harness.key_combination_modifiers(egui::Modifiers::COMMAND, &[egui::Key::S]);
        editor.harness.run();
    };
    let on_disk = || Preset::load(&path).expect("it is a preset");
    save(&mut editor);
    assert!(editor.toasts().last().is_some_and(|text| text.contains("shared.ron")), "{:?}", editor.toasts());
    assert_eq!((on_disk().name.as_str(), editor.document().is_modified()), ("Theirs", true));
    save(&mut editor);
    assert_eq!((on_disk().scene.weather.coverage, editor.document().is_modified()), (0.8, false), "asked for twice");
    editor.type_number("weather.coverage", "0.7");
    save(&mut editor);
    assert_eq!(on_disk().scene.weather.coverage, 0.7, "nobody else has changed it since");
}

#[test]
fn closing_with_changes_asks_and_without_quits() {
    let mut editor = Editor::new();
    let quit = |editor: &mut Editor| {
        editor.harness.key_combination_modifiers(egui::Modifiers::COMMAND, &[egui::Key::Q]);
        editor.harness.run();
    };
    editor.type_number("weather.coverage", "0.8");
    quit(&mut editor);
    assert!(editor.has_label("before you quit"), "asked");
    assert!(editor.requests.borrow().is_empty(), "still open");
    editor.click_label("Discard");
    assert_eq!(*editor.requests.borrow(), vec![Request::Quit]);
}

#[test]
fn the_theme_and_the_panels_toggle() {
    let mut editor = Editor::new();
    let before = editor.harness.ctx.theme();
    editor.harness.key_combination_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, &[egui::Key::L]);
    editor.harness.run();
    assert_ne!(editor.harness.ctx.theme(), before);
    editor.harness.key_press(egui::Key::F10);
    editor.harness.run();
    assert!(editor.has_label("Time per picture"), "the overlay");
    assert!(editor.has_label("n/a"), "what was not measured is no number");
    editor.harness.key_press(egui::Key::F1);
    editor.harness.run();
    assert!(editor.has_label("Go to a kept camera"), "the sheet");
    editor.harness.key_press(egui::Key::F1);
    editor.harness.run();
    editor.harness.key_press(egui::Key::Tab);
    editor.harness.run();
    assert!(!editor.has_label("Parameters") && editor.harness.query_by_label("File").is_none(), "only the picture");
    editor.harness.key_press(egui::Key::Tab);
    editor.harness.run();
    assert!(editor.harness.query_by_label("File").is_some(), "and back");
}

#[test]
fn every_widget_has_a_name_and_nothing_leaves_a_small_window() {
    // The harness itself fails on widgets without accessible names.
    let mut editor = Editor::sized([800.0, 600.0]);
    for key in ["quality", "layers.0", "wind", "moon", "scattering", "air", "ground", "domain", "camera", "display"] {
        editor.click(key);
    }
    editor.click("layers.0.phase");
    editor.click("weather.layers.0");
    let screen = editor.harness.ctx.content_rect();
    let buttons = editor.harness.query_all(by().predicate(|node| node.author_id().is_some()));
    let mut seen = 0;
    for node in buttons {
        let rect = node.rect();
        assert!(rect.min.x >= screen.min.x - 0.5 && rect.max.x <= screen.max.x + 0.5, "{node:?} at {rect:?}");
        seen += 1;
    }
    assert!(seen > 150, "only {seen} widgets were looked at");
}

#[test]
fn time_plays_and_returns() {
    let mut editor = Editor::new();
    editor.harness.key_press(egui::Key::Space);
    editor.harness.run();
    assert!(editor.document().is_playing(), "Space plays");
    editor.harness.state_mut().document.advance_clock(90.0);
    editor.harness.run();
    assert!(editor.has_label("0:01:30"), "the time is shown");
    editor.click("time.play");
    editor.click("time.reset");
    assert!(!editor.document().is_playing() && editor.document().time_secs() == 0.0);
}

fn picture(id: u64) -> Picture {
    Picture { texture: egui::TextureId::User(id), size: [640, 480] }
}

fn errors(rel_rmse: f64, std_error: f64) -> Errors {
    let figure = Estimate { value: rel_rmse, std_error: Some(std_error) };
    Errors {
        rel_mse: figure,
        rel_rmse: figure,
        bias: figure,
        mean_relative: figure,
        p95_relative: figure,
        reference_noise: None,
        pixels: 5120,
    }
}

#[test]
fn refinement_is_switched_by_its_key_and_in_the_menu() {
    let mut editor = Editor::new();
    assert!(editor.truth().refines, "on at first");
    editor.press(egui::Key::F4);
    assert!(!editor.truth().refines, "F4 switches it off");
    editor.click_label("View");
    editor.harness.get_by_label_contains("Refine the picture at rest").click();
    editor.harness.run();
    assert!(editor.truth().refines, "the menu switches it on");
    editor.press(egui::Key::F1);
    assert!(editor.has_label("Refine the picture at rest"), "and the sheet lists it");
}

#[test]
fn the_status_is_shown_while_there_is_one_and_faults_always() {
    let mut editor = Editor::new();
    assert!(!editor.has_label("refining"), "nothing is done");
    let refined = Refined {
        integrator: Integrator::Converged,
        finished: Some(1),
        pixel_samples: (0, 4),
        share: 0.4,
        error: Some(0.013),
        spent_secs: 12.0,
    };
    editor.truth().view.refinement = Refinement::Working(refined);
    editor.harness.run();
    assert!(editor.has_label("refining: level 2, 40 %, changed 1.3 % last"));
    editor.truth().view.refinement = Refinement::Working(Refined { pixel_samples: (1, 4), ..refined });
    editor.harness.run();
    assert!(editor.has_label("refining: sample 2 of 4 a pixel, 40 %"));
    editor.truth().view.refinement = Refinement::Smoothing { finished: 0, count: 4 };
    editor.harness.run();
    assert!(editor.has_label("smoothing: sample 1 of 4 a pixel"));
    editor.truth().view.refinement = Refinement::Done(Refined { error: Some(0.004), ..refined }, true);
    editor.truth().view.faults = vec!["Fault: 3 rays were cut short".to_owned()];
    editor.harness.run();
    assert!(editor.has_label("converged within 0.4 %, 12 s"));
    assert!(editor.has_label("Fault: 3 rays"), "faults are shown");
    editor.press(egui::Key::F5);
    assert!(editor.has_label("Fault: 3 rays"), "also while pictures are compared");
}

#[test]
fn the_comparison_is_chosen_in_the_menu_and_over_the_picture() {
    let mut editor = Editor::new();
    editor.click_label("View");
    editor.click_label("Compare: Difference");
    assert_eq!(editor.truth().comparison, Comparison::Difference);
    editor.press(egui::Key::Escape);
    editor.click_label("Absolute difference");
    assert!(!editor.truth().is_signed);
    editor.click("truth.reference.Path traced");
    assert_eq!(editor.truth().reference, Integrator::PathTraced);
    editor.click_label("Stop and keep");
    assert!(editor.truth().is_kept);
    editor.click_label("Continue");
    assert!(!editor.truth().is_kept);
    editor.press(egui::Key::F6);
    assert!(editor.truth().is_kept, "F6 keeps too");
    editor.press(egui::Key::F5);
    assert!(!editor.truth().compares() && !editor.has_label("Stop and keep"), "F5 ends it");
}

#[test]
fn the_read_out_says_how_far_and_what_it_costs() {
    let mut editor = Editor::sized([800.0, 600.0]);
    editor.press(egui::Key::F5);
    assert!(editor.has_label("Nothing was measured yet"), "no number is made up");
    let figures = &mut editor.truth().view.figures;
    figures.converged = Some(Ok(errors(0.032, 0.004)));
    figures.traced = Some(Ok(errors(0.041, 0.006)));
    (figures.cost_ms, figures.truth_secs, figures.source) = (Some(310.0), Some(12.4), "serialised host time");
    editor.harness.run();
    let text = "What you see is 3.2 ± 0.4 % from converged (4.1 ± 0.6 % from path traced); it costs 310 ms, \
                the truth 12 s (serialised host time).";
    assert!(editor.has_label(text));
    assert!(editor.has_label("over 5120 cloud pixels; the paths’ noise is subtracted"));
    let screen = editor.harness.ctx.content_rect();
    let place = editor.harness.get_by_label_contains("What you see").rect();
    assert!(screen.contains_rect(place), "{place:?} leaves the window");
}

#[test]
fn the_divider_is_dragged_without_turning_the_camera() {
    let mut editor = Editor::new();
    editor.press(egui::Key::F5);
    let without = editor.harness.query_by_label_contains("Divider").is_none();
    assert!(without, "there is nothing to divide yet");
    editor.harness.state_mut().ui.viewport.picture = Some(picture(1));
    (editor.truth().view.still, editor.truth().view.truth) = (Some(picture(2)), Some(picture(3)));
    editor.harness.run();
    let from = editor.with_key("truth.divider").rect().center();
    editor.harness.drag_at(from);
    editor.harness.run();
    let to = from - egui::vec2(100.0, 0.0);
    editor.harness.hover_at(to);
    editor.harness.run();
    editor.harness.drop_at(to);
    editor.harness.run();
    let divider = editor.truth().divider;
    assert!((0.2..0.45).contains(&divider), "{divider}");
    assert!(!editor.document().is_modified(), "the camera stays");
}

#[test]
fn the_lab_measures_and_what_it_found_can_be_used() {
    let mut editor = Editor::new();
    editor.press(egui::Key::F9);
    editor.click("lab.measure");
    let order = match editor.requests.borrow().as_slice() {
        [Request::Lab(Lab::Start(order))] => (**order).clone(),
        other => panic!("{other:?}"),
    };
    let Order::Sweep { settings, goals, rounds, .. } = order else { panic!("{order:?}") };
    assert!(settings.len() > 5 && settings[0].is_current && goals.len() == 1 && rounds == 15, "{goals:?}");
    let measured = |light_steps: u32, cost: f64, error: f64| Measured {
        name: format!("light_steps={light_steps}"),
        quality: Quality { light_steps, ..Quality::default() },
        cost_ms: Some(cost),
        error,
        std_error: None,
        reads: 50.0,
        is_on_front: true,
        is_current: false,
    };
    editor.harness.state_mut().ui.lab.view = LabView {
        name: "Test sky".to_owned(),
        phase: Phase::Running,
        settings: vec![measured(3, 20.0, 0.3), measured(21, 60.0, 0.05)],
        ..LabView::default()
    };
    editor.harness.run();
    assert!(editor.is_disabled("lab.measure"), "one thing at a time");
    editor.click("lab.pause");
    assert_eq!(editor.requests.borrow().last(), Some(&Request::Lab(Lab::Pause)));
    editor.click("lab.use.1");
    assert_eq!(editor.document().quality().light_steps, 21);
    editor.click("lab.most_accurate");
    assert_eq!(editor.document().quality().light_steps, 3, "within 50 ms");
    assert!(editor.has_label("In use: light_steps=3"), "it says so");
    editor.click("lab.governor");
    assert!(editor.harness.state().ui.lab.governs, "the front has two settings");
}
