//! The panel with every parameter: one visitor draws a row for each, whatever the scene grows.

use egui::collapsing_header::CollapsingState;
use egui::{RichText, Ui};

use super::probe::{Filter, Probe, Reset, duplicate_last_from};
use super::{clipboard, row};
use crate::app::action::{Action, Browse, Request};
use crate::scene::param::{Choice, ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Visitor};
use crate::scene::{Quality, QualityLevel, Scene, Strokes, edit, most_of};

/// Sections that are unfolded when the program starts for the first time.
const OPEN_AT_FIRST: [&str; 2] = ["weather", "sun"];

/// What the panel remembers between frames.
#[derive(Clone, Debug, Default)]
pub struct PanelState {
    /// Text that a row's name, key or documentation must contain.
    pub filter: String,
    /// Whether only what differs from its default is shown.
    pub modified_only: bool,
    /// Whether only the few parameters are shown that make most of a sky.
    pub simple: bool,
    /// What was copied here last.
    pub(super) copied: String,
}

/// Draws the panel for a copy of the scene and the quality, and returns what the user did to them.
pub(super) fn show(ui: &mut Ui, state: &mut PanelState, scene: &Scene, quality: &Quality) -> Vec<Action> {
    let mut actions = Vec::new();
    filter_row(ui, state);
    let text = state.filter.trim().to_lowercase();
    let filter = Filter { text: &text, modified: state.modified_only, simple: state.simple };
    egui::ScrollArea::vertical().id_salt("parameters").auto_shrink([false; 2]).show(ui, |ui| {
        quality_section(ui, filter, quality, &mut actions);
        let mut scene = scene.clone();
        if text.is_empty() && !filter.modified {
            own_section(ui, &SUNDIAL, &mut scene, &mut actions);
            own_section(ui, &GENERA, &mut scene, &mut actions);
        }
        let mut rows = Rows::new(ui, filter, String::new());
        scene.visit(&mut rows);
        let (edited, browse, shown) = (rows.edit, rows.browse, rows.shown);
        if let Some(key) = edited {
            edit::follow_edit(&mut scene, &key);
            actions.push(Action::EditScene { key, scene: Box::new(scene) });
        }
        if let Some(key) = browse {
            actions.push(Action::Ask(Request::Browse(Browse::Parameter(key))));
        }
        if !shown && filter.hides() && !quality_matches(quality, filter) {
            ui.add_space(8.0);
            let which = match (state.modified_only, text.is_empty()) {
                (true, true) => "No parameter differs from its default.".to_owned(),
                (true, false) => format!("No modified parameter matches “{}”.", state.filter.trim()),
                _ => format!("No parameter matches “{}”.", state.filter.trim()),
            };
            ui.weak(which);
        }
        ui.add_space(12.0);
    });
    actions
}

fn filter_row(ui: &mut Ui, state: &mut PanelState) {
    let height = ui.spacing().interact_size.y;
    let whole = egui::vec2(ui.available_width(), height);
    ui.allocate_ui_with_layout(whole, egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let simple = ui.selectable_label(state.simple, "Simple");
        let simple = simple.on_hover_text("Shows only the few parameters that make most of a sky");
        row::name(ui, &simple, "Simple view", "filter.simple");
        state.simple ^= simple.clicked();
        let modified = ui.selectable_label(state.modified_only, "≠");
        let modified = modified.on_hover_text("Shows only what differs from its default");
        row::name(ui, &modified, "Modified only", "filter.modified");
        state.modified_only ^= modified.clicked();
        let clear = ui.add_enabled(!state.filter.is_empty(), egui::Button::new("×")).on_hover_text("Clear the filter");
        row::name(ui, &clear, "Clear filter", "filter.clear");
        if clear.clicked() {
            state.filter.clear();
        }
        // What is left, whatever the buttons took.
        let edit = egui::TextEdit::singleline(&mut state.filter).hint_text("Filter parameters");
        let response = ui.add(edit.desired_width(ui.available_width() - 8.0));
        let response = response.on_hover_text("Shows only parameters whose name, key or help contains this (Ctrl+F)");
        row::name(ui, &response, "Filter parameters", "filter");
        if ui.input_mut(|input| input.consume_key(egui::Modifiers::COMMAND, egui::Key::F)) {
            response.request_focus();
        }
    });
    ui.add_space(2.0);
}

fn quality_matches(quality: &Quality, filter: Filter<'_>) -> bool {
    let mut probe = Probe::new(filter, "quality");
    quality.clone().visit(&mut probe);
    probe.matches > 0
}

/// Quality stands above the scene: level buttons, then its rows.
fn quality_section(ui: &mut Ui, filter: Filter<'_>, quality: &Quality, actions: &mut Vec<Action>) {
    if filter.hides() && !filter.simple && !quality_matches(quality, filter) {
        return;
    }
    let mut edited = quality.clone();
    let mut level = None;
    let heading = Heading { title: "Quality", doc: Quality::DOC };
    let mut edit = None;
    let mut outer = Rows::new(ui, filter, String::new());
    outer.section(heading, "quality", None, &mut |ui, key| {
        ui.horizontal_wrapped(|ui| {
            for option in QualityLevel::ALL {
                let chosen = Quality::level(*option) == *quality;
                if ui.selectable_label(chosen, option.title()).on_hover_text(option.doc()).clicked() {
                    level = Some(*option);
                }
            }
        });
        let mut rows = Rows::new(ui, filter, format!("{key}."));
        edited.visit(&mut rows);
        edit = rows.edit;
    });
    if let Some(level) = level {
        actions.push(Action::SetQualityLevel(level));
    } else if let Some(key) = edit {
        let key = key.trim_start_matches("quality.").to_owned();
        actions.push(Action::EditQuality { key, quality: Box::new(edited) });
    }
}

/// A section above all rows that is no group of parameters.
struct OwnSection {
    key: &'static str,
    heading: Heading<'static>,
    /// Draws it, and returns the key of what was changed in the scene.
    show: fn(&mut Ui, &mut Scene) -> Option<&'static str>,
}

const SUNDIAL: OwnSection = OwnSection {
    key: "sundial.section",
    heading: Heading { title: "Sundial", doc: "The sun’s place by a drag, by the hour, or by a city." },
    show: super::sundial::show,
};
const GENERA: OwnSection = OwnSection {
    key: "genera.section",
    heading: Heading { title: "Genera", doc: "The ten genera of clouds, by name and by their water." },
    show: super::genera::show,
};

fn own_section(ui: &mut Ui, section: &OwnSection, scene: &mut Scene, actions: &mut Vec<Action>) {
    let mut changed = None;
    let mut outer = Rows::new(ui, Filter::default(), String::new());
    outer.section(section.heading, section.key, None, &mut |ui, _| changed = (section.show)(ui, scene));
    if let Some(key) = changed {
        actions.push(Action::EditScene { key: key.to_owned(), scene: Box::new(scene.clone()) });
    }
}

/// What a section's header offers beside folding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum HeaderButton {
    Reset,
    Duplicate,
    Remove,
}

/// What a section's header says.
#[derive(Clone, Copy, Debug)]
struct Heading<'t> {
    title: &'t str,
    doc: &'t str,
}

/// Draws a row per parameter.
struct Rows<'u> {
    ui: &'u mut Ui,
    filter: Filter<'u>,
    /// Key of the group the next parameters belong to, with a dot at its end.
    prefix: String,
    /// Key of the parameter that was edited, if any was.
    edit: Option<String>,
    /// Key of the file parameter for which a dialog is wanted.
    browse: Option<String>,
    /// Whether anything was drawn.
    shown: bool,
}

impl<'u> Rows<'u> {
    fn new(ui: &'u mut Ui, filter: Filter<'u>, prefix: String) -> Self {
        Self { ui, filter, prefix, edit: None, browse: None, shown: false }
    }

    /// Draws one row unless the filter hides it; `draw` returns whether the value changed.
    fn row(&mut self, (name, doc): (&str, &str), modified: bool, draw: impl FnOnce(&mut Ui, &str) -> bool) {
        let key = format!("{}{name}", self.prefix);
        if !self.filter.fits(&key, doc, modified) {
            return;
        }
        self.shown = true;
        if draw(self.ui, &key) {
            self.edit = Some(key);
        }
    }

    /// Draws a foldable section; returns the button of its header that was pressed.
    fn section(
        &mut self,
        heading: Heading<'_>,
        key: &str,
        buttons: Option<(&[HeaderButton], bool)>,
        body: &mut dyn FnMut(&mut Ui, &str),
    ) -> Option<HeaderButton> {
        self.shown = true;
        let id = self.ui.make_persistent_id(("section", key));
        let open = OPEN_AT_FIRST.contains(&key) || key.ends_with(".0") && key.starts_with("weather");
        let mut state = CollapsingState::load_with_default_open(self.ui.ctx(), id, open);
        let filtering = self.filter.hides();
        if filtering && !state.is_open() {
            state.set_open(true);
        }
        let mut pressed = None;
        let mut toggle = false;
        let header = state.show_header(self.ui, |ui| {
            let title = egui::Button::new(RichText::new(heading.title).strong()).frame(false);
            let response = ui.add(title).on_hover_text(format!("{}\n\nKey: {key}", heading.doc.trim()));
            row::name(ui, &response, &format!("{} section", heading.title), key);
            toggle = response.clicked();
            let mut reset = false;
            if ![SUNDIAL.key, GENERA.key].contains(&key) {
                let modified = buttons.is_some_and(|(_, modified)| modified);
                clipboard::menu(&response, key, heading.title, (modified, false), &mut reset);
                if response.contains_pointer() {
                    clipboard::note_pointed(ui, key);
                }
            }
            pressed = reset.then_some(HeaderButton::Reset);
            let Some((buttons, modified)) = buttons else { return };
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                for button in buttons {
                    if header_button(ui, *button, heading.title, (key, modified)) {
                        pressed = Some(*button);
                    }
                }
            });
        });
        let mut header = header;
        if toggle && !filtering {
            header.toggle();
        }
        header.body(|ui| body(ui, key));
        if filtering {
            // What the filter unfolded folds again when it is cleared.
            let mut state = CollapsingState::load_with_default_open(self.ui.ctx(), id, open);
            state.set_open(open);
            state.store(self.ui.ctx());
        }
        pressed
    }
}

fn header_button(ui: &mut Ui, button: HeaderButton, title: &str, (key, modified): (&str, bool)) -> bool {
    let (icon, verb, enabled) = match button {
        HeaderButton::Reset => ("↺", "Reset", modified),
        HeaderButton::Duplicate => ("⊕", "Duplicate", true),
        HeaderButton::Remove => ("×", "Remove", true),
    };
    let response = ui.add_enabled(enabled, egui::Button::new(icon).frame(false)).on_hover_text(match button {
        HeaderButton::Reset => format!("Reset everything in {title} to its default"),
        HeaderButton::Duplicate => format!("Add a copy of {title}"),
        HeaderButton::Remove => format!("Remove {title}"),
    });
    row::name(ui, &response, &format!("{verb} {title}"), &format!("{key}.{}", verb.to_lowercase()));
    response.clicked()
}

impl Visitor for Rows<'_> {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        let modified = *value != info.default;
        self.row((info.name, info.doc), modified, |ui, key| row::float(ui, key, info, value));
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        let modified = *value != info.default;
        self.row((info.name, info.doc), modified, |ui, key| row::count(ui, key, info, value));
    }

    fn switch(&mut self, info: &Info<bool>, value: &mut bool) {
        let modified = *value != info.default;
        self.row((info.name, info.doc), modified, |ui, key| row::switch(ui, key, info, value));
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        let modified = *index != info.default;
        self.row((info.name, info.doc), modified, |ui, key| row::choice(ui, key, info, index));
    }

    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        let modified = *value != info.default;
        self.row((info.name, info.doc), modified, |ui, key| row::colour(ui, key, info, value));
    }

    fn file(&mut self, info: &Info<FileName>, value: &mut FileName) {
        let mut browse = false;
        let modified = *value != info.default;
        self.row((info.name, info.doc), modified, |ui, key| row::file(ui, key, (info, value), &mut browse));
        if browse {
            self.browse = Some(format!("{}{}", self.prefix, info.name));
        }
    }

    fn strokes(&mut self, info: &Info<Strokes>, value: &mut Strokes) {
        let modified = *value != info.default;
        self.row((info.name, info.doc), modified, |ui, key| row::strokes(ui, key, info, value));
    }

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        let key = format!("{}{}", self.prefix, info.name);
        let mut probe = Probe::new(self.filter, &key);
        children(&mut probe);
        let filter = self.filter.for_children(info.title);
        if filter.hides() && probe.matches == 0 {
            return;
        }
        let mut edit = None;
        let mut browse = None;
        let buttons = (&[HeaderButton::Reset][..], probe.modified > 0);
        let pressed =
            self.section(Heading { title: info.title, doc: info.doc }, &key, Some(buttons), &mut |ui, key| {
                let mut rows = Rows::new(ui, filter, format!("{key}."));
                children(&mut rows);
                edit = rows.edit.take();
                browse = rows.browse.take();
            });
        if pressed == Some(HeaderButton::Reset) {
            children(&mut Reset);
            edit = Some(key);
        }
        self.edit = edit.or(self.edit.take());
        self.browse = browse.or(self.browse.take());
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        let key = format!("{}{}", self.prefix, info.name);
        let mut press = None;
        for index in 0..list.count() {
            let item_key = format!("{key}.{index}");
            let title = format!("{} {}", info.title, index + 1);
            let mut probe = Probe::new(self.filter, &item_key);
            list.visit_item(index, &mut probe);
            let filter = self.filter.for_children(&title);
            if filter.hides() && probe.matches == 0 {
                continue;
            }
            let heading = Heading { title: &title, doc: info.doc };
            let full = list.count() >= most_of(info.name);
            let all = [HeaderButton::Remove, HeaderButton::Duplicate, HeaderButton::Reset];
            let without_duplicate = [HeaderButton::Remove, HeaderButton::Reset];
            let buttons: &[HeaderButton] = if full { &without_duplicate } else { &all };
            let mut edit = None;
            let mut browse = None;
            let pressed = self.section(heading, &item_key, Some((buttons, probe.modified > 0)), &mut |ui, key| {
                let mut rows = Rows::new(ui, filter, format!("{key}."));
                list.visit_item(index, &mut rows);
                edit = rows.edit.take();
                browse = rows.browse.take();
            });
            self.edit = edit.or(self.edit.take());
            self.browse = browse.or(self.browse.take());
            press = press.or(pressed.map(|button| (index, button)));
        }
        if !self.filter.hides() && list.count() < most_of(info.name) {
            let title = info.title.to_lowercase();
            let response = self.ui.button(format!("+ Add {title}")).on_hover_text(format!("Adds another {title}"));
            if response.clicked() {
                list.append();
                self.edit = Some(key.clone());
            }
        }
        let Some((index, button)) = press else { return };
        match button {
            HeaderButton::Reset => list.visit_item(index, &mut Reset),
            HeaderButton::Duplicate => duplicate_last_from(list, index),
            HeaderButton::Remove => {
                list.remove(index);
                // What follows the list has to know which.
                self.edit = Some(format!("{key}.{index}"));
                return;
            }
        }
        self.edit = Some(key);
    }
}
