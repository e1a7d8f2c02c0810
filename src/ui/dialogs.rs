//! Questions: unsaved changes, paths, stills, recovery; and the sheet of shortcuts.

use std::path::PathBuf;
use std::time::Duration;

use egui::{Grid, Id, Key, Modal, RichText, Ui};

use super::command::GESTURES;
use super::export_form::{self, ExportForm};
use super::{Command, Library, State, row};
use crate::app::action::{Action, Answer, Browse, Request};
use crate::app::document::Document;
use crate::app::preferences::{Habit, Preferences, Units};
use crate::scene::file_stem;
use crate::scene::param::Choice as _;

/// How to work with the program.
const HELP: &str = include_str!("../../docs/help.md");

/// The question on the screen.
#[derive(Clone, Debug, PartialEq)]
pub enum Dialog {
    /// Whether to save before something that would lose changes; holds what that is.
    Unsaved {
        /// What comes after, as a phrase: "open another preset".
        before: String,
    },
    /// A path to open.
    Open {
        /// As typed.
        path: String,
    },
    /// Name and path to save under.
    SaveAs {
        /// Name of the preset.
        name: String,
        /// As typed.
        path: String,
    },
    /// What still to render.
    Export(ExportForm),
    /// Whether to take what a crash left behind.
    Recover {
        /// Names of what was being edited and how long ago that was kept, newest first.
        copies: Vec<(String, Duration)>,
        /// Which of them is taken.
        chosen: usize,
    },
    /// The sheet of shortcuts.
    Shortcuts,
    /// How to work with the program.
    Help,
    /// What the user likes.
    Preferences,
}

impl Dialog {
    /// The save-as dialog with a path that suits the document.
    pub fn save_as(document: &Document, library: &Library) -> Self {
        let path = document.path().cloned();
        let path = path.unwrap_or_else(|| library.folder.join(format!("{}.ron", file_stem(document.name()))));
        Self::SaveAs { name: document.preset().name.clone(), path: path.display().to_string() }
    }

    /// Takes over a path from the system's file dialog.
    pub fn set_path(&mut self, chosen: String) {
        match self {
            Self::Open { path } | Self::SaveAs { path, .. } => *path = chosen,
            Self::Export(form) => form.path = chosen,
            Self::Unsaved { .. } | Self::Recover { .. } | Self::Shortcuts | Self::Help | Self::Preferences => {}
        }
    }
}

/// Whether the dialog stays.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    Stays,
    Closes,
}

/// Draws the question, if there is one.
pub(super) fn show(
    context: &egui::Context,
    state: &mut State,
    (document, preferences): (&Document, &mut Preferences),
    actions: &mut Vec<Action>,
) {
    let Some(mut dialog) = state.dialog.take() else { return };
    let screen = context.content_rect();
    let width = match dialog {
        Dialog::Shortcuts => 440.0_f32,
        Dialog::Help => 620.0,
        _ => 460.0,
    };
    let modal = Modal::new(Id::unique("dialog")).show(context, |ui| {
        ui.set_width(width.min(screen.width() - 60.0));
        match &mut dialog {
            Dialog::Unsaved { before } => unsaved(ui, document, before, actions),
            Dialog::Open { path } => open(ui, path, actions),
            Dialog::SaveAs { name, path } => save_as(ui, name, path, (document, actions)),
            Dialog::Export(form) => export_form::show(ui, form, actions),
            Dialog::Recover { copies, chosen } => recover(ui, copies, chosen, actions),
            Dialog::Shortcuts => shortcuts(ui, screen.height() - 130.0),
            Dialog::Help => help(ui, screen.height() - 130.0),
            Dialog::Preferences => liked(ui, preferences),
        }
    });
    let escaped = context.input(|input| input.key_pressed(Key::Escape));
    if (escaped || modal.backdrop_response.clicked()) && modal.inner == Fate::Stays {
        match dialog {
            Dialog::Unsaved { .. } => actions.push(Action::Ask(Request::Answer(Answer::Cancel))),
            // What a crash left is only thrown away when somebody says so.
            Dialog::Recover { .. } => state.dialog = Some(dialog),
            _ => {}
        }
    } else if modal.inner == Fate::Stays {
        state.dialog = Some(dialog);
    }
}

fn unsaved(ui: &mut Ui, document: &Document, before: &str, actions: &mut Vec<Action>) -> Fate {
    ui.heading("Save changes?");
    ui.label(format!("“{}” has changes that are not saved. Save them before you {before}?", document.name()));
    let mut answer = None;
    ui.add_space(8.0);
    ui.horizontal_wrapped(|ui| {
        for (title, choice) in [("Save", Answer::Save), ("Discard", Answer::Discard), ("Cancel", Answer::Cancel)] {
            if ui.button(title).clicked() {
                answer = Some(choice);
            }
        }
    });
    let Some(answer) = answer else { return Fate::Stays };
    actions.push(Action::Ask(Request::Answer(answer)));
    Fate::Closes
}

/// Gives a field the focus while nothing has it, so that a form can be filled in by the keyboard at once.
fn take_focus(ui: &Ui, field: &egui::Response) {
    // Enter takes the focus away, and means the whole form.
    if !field.lost_focus() && ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
}

/// A path with a button for the system's dialog; returns whether Enter was pressed in it.
pub(super) fn path_field(ui: &mut Ui, path: &mut String, browse: Browse, actions: &mut Vec<Action>) -> bool {
    ui.label("Path");
    ui.horizontal(|ui| {
        let width = ui.available_width() - 84.0;
        let response = ui.add(egui::TextEdit::singleline(path).desired_width(width).hint_text("path of the file"));
        row::name(ui, &response, "Path", "dialog.path");
        take_focus(ui, &response);
        if ui.button("Browse…").clicked() {
            actions.push(Action::Ask(Request::Browse(browse)));
        }
        response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
    })
    .inner
}

/// The row of buttons under a form; `None` while neither was pressed.
pub(super) fn confirm(ui: &mut Ui, verb: &str, enabled: bool) -> Option<bool> {
    let mut answer = None;
    ui.add_space(8.0);
    ui.horizontal(|ui| {
        if ui.add_enabled(enabled, egui::Button::new(verb)).clicked() {
            answer = Some(true);
        }
        if ui.button("Cancel").clicked() {
            answer = Some(false);
        }
    });
    answer
}

fn open(ui: &mut Ui, path: &mut String, actions: &mut Vec<Action>) -> Fate {
    ui.heading("Open");
    ui.label("A preset (.ron), or an exported EXR or PNG, which holds the sky it was made from.");
    let entered = path_field(ui, path, Browse::Open, actions);
    let ready = !path.trim().is_empty();
    match confirm(ui, "Open", ready).or((entered && ready).then_some(true)) {
        None => Fate::Stays,
        Some(confirmed) => {
            if confirmed {
                actions.push(Action::Ask(Request::Open(PathBuf::from(path.trim()))));
            }
            Fate::Closes
        }
    }
}

fn save_as(
    ui: &mut Ui,
    name: &mut String,
    path: &mut String,
    (document, actions): (&Document, &mut Vec<Action>),
) -> Fate {
    ui.heading("Save as");
    ui.label("Name");
    let response = ui.add(egui::TextEdit::singleline(name).desired_width(f32::INFINITY).hint_text("Untitled"));
    row::name(ui, &response, "Name", "dialog.name");
    take_focus(ui, &response);
    let entered = path_field(ui, path, Browse::SaveAs, actions);
    let ready = !path.trim().is_empty();
    match confirm(ui, "Save", ready).or((entered && ready).then_some(true)) {
        None => Fate::Stays,
        Some(confirmed) => {
            if confirmed {
                if *name != document.preset().name {
                    actions.push(Action::Rename(name.clone()));
                }
                let mut path = PathBuf::from(path.trim());
                if path.extension().is_none() {
                    path.set_extension("ron");
                }
                actions.push(Action::Ask(Request::SaveAs(path)));
            }
            Fate::Closes
        }
    }
}

/// A time that has passed, in words.
fn ago(passed: Duration) -> String {
    let secs = passed.as_secs();
    match secs {
        0..120 => format!("{secs} s ago"),
        120..7200 => format!("{} min ago", secs / 60),
        7200..172_800 => format!("{} h ago", secs / 3600),
        _ => format!("{} days ago", secs / 86_400),
    }
}

fn recover(ui: &mut Ui, copies: &[(String, Duration)], chosen: &mut usize, actions: &mut Vec<Action>) -> Fate {
    ui.heading("Recover unsaved work?");
    let name = copies.get(*chosen).map_or("", |(name, _)| name);
    ui.label(format!("The program ended without saving “{name}”. Its last states were kept."));
    if copies.len() > 1 {
        for (index, (name, age)) in copies.iter().enumerate() {
            let newest = if index == 0 { ", the newest" } else { "" };
            let text = format!("{name}, {}{newest}", ago(*age));
            let choice = ui.radio_value(chosen, index, &text);
            row::name(ui, &choice, &text, &format!("recover.{index}"));
        }
    }
    let mut taken = None;
    ui.add_space(8.0);
    ui.horizontal(|ui| {
        if ui.button("Recover").clicked() {
            taken = Some(Some(*chosen));
        }
        if ui.button("Discard").clicked() {
            taken = Some(None);
        }
    });
    let Some(taken) = taken else { return Fate::Stays };
    actions.push(Action::Ask(Request::Recover(taken)));
    Fate::Closes
}

fn shortcuts(ui: &mut Ui, height: f32) -> Fate {
    ui.heading("Shortcuts");
    let height = height.max(80.0);
    egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        Grid::new("shortcuts").num_columns(2).spacing([24.0, 3.0]).show(ui, |ui| {
            for (keys, what) in GESTURES {
                ui.label(RichText::new(keys).strong());
                ui.label(what);
                ui.end_row();
            }
            for command in Command::all() {
                ui.label(RichText::new(command.keys(ui.ctx())).strong());
                ui.label(command.title());
                ui.end_row();
            }
        });
    });
    ui.add_space(6.0);
    if ui.button("Close").clicked() { Fate::Closes } else { Fate::Stays }
}

/// The help page: paragraphs below headings.
fn help(ui: &mut Ui, height: f32) -> Fate {
    let height = height.max(80.0);
    egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        for line in HELP.lines() {
            match line.strip_prefix("# ") {
                Some(heading) => drop(ui.heading(heading)),
                None if line.is_empty() => ui.add_space(8.0),
                None => drop(ui.label(line)),
            }
        }
    });
    ui.add_space(6.0);
    if ui.button("Close").clicked() { Fate::Closes } else { Fate::Stays }
}

fn liked(ui: &mut Ui, preferences: &mut Preferences) -> Fate {
    ui.heading("Preferences");
    Grid::new("preferences").num_columns(2).spacing([18.0, 8.0]).show(ui, |ui| {
        ui.label("Theme and size");
        ui.vertical(super::top_bar::theme_and_scale);
        ui.end_row();
        ui.label("Mouse over the picture");
        ui.horizontal(|ui| {
            for habit in Habit::ALL {
                let chosen = preferences.habit == *habit;
                if ui.selectable_label(chosen, habit.title()).on_hover_text(habit.doc().trim()).clicked() {
                    preferences.habit = *habit;
                }
            }
        });
        ui.end_row();
        ui.label("Lengths and speeds");
        ui.horizontal(|ui| {
            for units in Units::ALL {
                let chosen = preferences.units == *units;
                if ui.selectable_label(chosen, units.title()).on_hover_text(units.doc().trim()).clicked() {
                    preferences.units = *units;
                }
            }
        });
        ui.end_row();
        ui.label("First steps");
        let mut shows = !preferences.is_introduced;
        if ui.checkbox(&mut shows, "Show them over the picture").changed() {
            preferences.is_introduced = !shows;
        }
        ui.end_row();
    });
    ui.weak(format!("{}: {}", preferences.habit.title(), preferences.habit.doc().trim()));
    ui.add_space(6.0);
    if ui.button("Close").clicked() { Fate::Closes } else { Fate::Stays }
}
