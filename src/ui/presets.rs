//! The list of presets: the program's own, and those in the user's folder.

use std::path::PathBuf;

use egui::{RichText, ScrollArea, Ui};

use crate::app::action::{Action, Request};
use crate::app::document::Document;

/// One preset in the list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entry {
    /// Name for people.
    pub name: String,
    /// What one sees.
    pub description: String,
    /// The file, or the short name of a built-in one.
    pub source: PathBuf,
    /// Whether it is the program's own.
    pub is_builtin: bool,
}

/// What there is to choose from.
#[derive(Clone, Debug, Default)]
pub struct Library {
    /// The program's own presets.
    pub builtin: Vec<Entry>,
    /// Presets in the user's folder.
    pub user: Vec<Entry>,
    /// The user's folder.
    pub folder: PathBuf,
    /// What the user searches for.
    pub search: String,
}

/// Draws the list.
pub(super) fn show(ui: &mut Ui, library: &mut Library, document: &Document) -> Vec<Action> {
    let mut actions = Vec::new();
    ui.strong("Presets");
    let edit = egui::TextEdit::singleline(&mut library.search).hint_text("Search").desired_width(f32::INFINITY);
    let response = ui.add(edit);
    super::row::name(ui, &response, "Search presets", "presets.search");
    ui.add_space(2.0);
    ScrollArea::vertical().id_salt("preset list").auto_shrink([false; 2]).show(ui, |ui| {
        let search = library.search.trim().to_lowercase();
        entries(ui, &library.builtin, &search, document, &mut actions);
        ui.add_space(6.0);
        ui.label(RichText::new("Yours").strong()).on_hover_text(library.folder.display().to_string());
        if library.user.is_empty() {
            ui.weak("Presets that you save in your folder appear here.");
        }
        entries(ui, &library.user, &search, document, &mut actions);
    });
    actions
}

fn entries(ui: &mut Ui, entries: &[Entry], search: &str, document: &Document, actions: &mut Vec<Action>) {
    for entry in entries {
        let text = format!("{} {}", entry.name, entry.description).to_lowercase();
        if !text.contains(search) {
            continue;
        }
        let current = match document.path() {
            Some(path) => *path == entry.source,
            None => entry.is_builtin && document.preset().name == entry.name,
        };
        let button = egui::Button::selectable(current, entry.name.as_str())
            .truncate()
            .min_size([ui.available_width(), 0.0].into());
        let mut response = ui.add(button);
        if !entry.description.is_empty() {
            response = response.on_hover_text(entry.description.as_str());
        }
        if response.clicked() {
            actions.push(Action::Ask(Request::Open(entry.source.clone())));
        }
    }
}
