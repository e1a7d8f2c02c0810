//! The command palette: whatever can be done or shown, found by a few letters.

use egui::{Id, Key, Modal, ScrollArea, Ui};

use super::{Command, State, row};
use crate::app::action::{Action, Request};
use crate::app::document::Document;
use crate::scene::edit;
use crate::scene::param::label;

/// What the palette remembers while it is open.
#[derive(Clone, Debug, Default)]
pub struct PaletteState {
    /// Whether it is there.
    pub is_open: bool,
    search: String,
    chosen: usize,
}

/// Something to choose.
#[derive(Clone, Debug)]
enum Choice {
    Command(Command),
    Preset(std::path::PathBuf),
    /// A parameter, which the panel then shows.
    Parameter(String),
}

/// Rows that are looked through at most; nobody reads more.
const MOST: usize = 60;

fn choices(state: &State, document: &Document) -> Vec<(String, String, Choice)> {
    let search = state.palette.search.trim().to_lowercase();
    let commands = Command::all().map(|command| (command.title().to_owned(), String::new(), Choice::Command(command)));
    let presets =
        state.library.builtin.iter().chain(&state.library.user).map(|entry| {
            (format!("Open {}", entry.name), entry.description.clone(), Choice::Preset(entry.source.clone()))
        });
    let keys = edit::keys(&document.preset().scene).into_iter();
    let keys = keys.chain(edit::keys(document.quality()).into_iter().map(|mut entry| {
        entry.key.insert_str(0, "quality.");
        entry
    }));
    let parameters = keys.map(|entry| {
        let name = label(entry.key.rsplit('.').next().unwrap_or_default());
        (format!("Show {name}"), entry.key.clone(), Choice::Parameter(entry.key))
    });
    let all = commands.chain(presets).chain(parameters);
    let wanted = all.filter(|(title, more, _)| {
        let text = format!("{title} {more}").to_lowercase();
        search.split_whitespace().all(|word| text.contains(word))
    });
    wanted.take(MOST).collect()
}

/// Draws the palette, and does what was chosen.
pub(super) fn show(ui: &Ui, state: &mut State, document: &Document, actions: &mut Vec<Action>) {
    if !state.palette.is_open {
        return;
    }
    let found = choices(state, document);
    let (up, down, enter) = ui.input_mut(|input| {
        let mut press = |key| input.consume_key(egui::Modifiers::NONE, key);
        (press(Key::ArrowUp), press(Key::ArrowDown), press(Key::Enter))
    });
    let palette = &mut state.palette;
    if down {
        palette.chosen += 1;
    }
    if up {
        palette.chosen = palette.chosen.saturating_sub(1);
    }
    palette.chosen = palette.chosen.min(found.len().saturating_sub(1));
    let mut taken = enter.then_some(palette.chosen);
    let height = (ui.ctx().content_rect().height() - 160.0).clamp(80.0, 360.0);
    let modal = Modal::new(Id::unique("palette")).show(ui.ctx(), |ui| {
        ui.set_width(420.0_f32.min(ui.ctx().content_rect().width() - 60.0));
        let edit = egui::TextEdit::singleline(&mut palette.search).hint_text("What do you want?");
        let response = ui.add(edit.desired_width(f32::INFINITY));
        row::name(ui, &response, "Search commands", "palette.search");
        if response.changed() {
            palette.chosen = 0;
        }
        response.request_focus();
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            for (index, (title, more, choice)) in found.iter().enumerate() {
                let keys = match choice {
                    Choice::Command(command) => command.keys(ui.ctx()),
                    Choice::Parameter(key) => key.clone(),
                    Choice::Preset(_) => String::new(),
                };
                let button = egui::Button::selectable(index == palette.chosen, title.as_str());
                let button = button.shortcut_text(keys).truncate().min_size([ui.available_width(), 0.0].into());
                let mut response = ui.add(button);
                row::name(ui, &response, title, &format!("palette.{index}"));
                if index == palette.chosen && (up || down) {
                    response.scroll_to_me(None);
                }
                if !more.is_empty() {
                    response = response.on_hover_text(more);
                }
                if response.clicked() {
                    taken = Some(index);
                }
            }
            if found.is_empty() {
                ui.weak("Nothing is called that.");
            }
        });
    });
    if modal.should_close() {
        state.palette = PaletteState::default();
        return;
    }
    let Some((.., choice)) = taken.and_then(|index| found.get(index)) else { return };
    state.palette = PaletteState::default();
    match choice {
        Choice::Command(command) => command.run(ui, state, document, actions),
        Choice::Preset(source) => actions.push(Action::Ask(Request::Open(source.clone()))),
        Choice::Parameter(key) => {
            (state.show_panel, state.hide_all) = (true, false);
            (state.panel.simple, state.panel.modified_only) = (false, false);
            state.panel.filter.clone_from(key);
        }
    }
}
