//! Copy and paste of parameters and sections: by the pointer and the usual keys, or by a menu on their names.

use egui::{Event, Id, Key, Modifiers, Response, Ui};

use crate::app::action::{Action, Request};
use crate::scene::clip;
use crate::scene::{Quality, Scene};

/// What a menu wants done to the parameter or section with a key.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
enum Wish {
    #[default]
    Nothing,
    Copy(String),
    PasteCopied(String),
    SetKey(String),
}

fn wish_id() -> Id {
    Id::unique("clipboard wish")
}

fn pointed_id() -> Id {
    Id::unique("parameter under the pointer")
}

/// Remembers which parameter or section the pointer is on; the innermost comes last.
pub(super) fn note_pointed(ui: &Ui, key: &str) {
    ui.data_mut(|data| data.insert_temp(pointed_id(), key.to_owned()));
}

/// Whether a key names a parameter of the sky, rather than a section or a setting of quality.
fn can_move(key: &str, scene: &Scene) -> bool {
    crate::scene::edit::keys(scene).iter().any(|entry| entry.key == key && crate::scene::can_move(entry))
}

/// Whether Backspace was pressed and nobody is typing.
pub(super) fn is_reset_pressed(ui: &Ui) -> bool {
    !ui.ctx().egui_wants_keyboard_input() && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Backspace))
}

/// The menu on the name of a parameter or section; only a parameter of the sky can have keys.
pub(super) fn menu(name: &Response, key: &str, title: &str, (modified, can_move): (bool, bool), reset: &mut bool) {
    super::menu::on(name, |ui| {
        ui.set_min_width(150.0);
        let wish = |ui: &Ui, wish: Wish| ui.data_mut(|data| data.insert_temp(wish_id(), wish));
        if ui.button(format!("Copy {title}")).clicked() {
            wish(ui, Wish::Copy(key.to_owned()));
            ui.close();
        }
        if ui.button("Paste what was copied").clicked() {
            wish(ui, Wish::PasteCopied(key.to_owned()));
            ui.close();
        }
        if ui.add_enabled(modified, egui::Button::new(format!("Reset {title}"))).clicked() {
            *reset = true;
            ui.close();
        }
        if can_move && ui.add(egui::Button::new("Set a key here").shortcut_text("K")).clicked() {
            wish(ui, Wish::SetKey(key.to_owned()));
            ui.close();
        }
    });
}

/// Does what menus and keys wanted since the last frame. `copied` is the last text that was copied here, as no program may
/// look into the system's clipboard unasked.
/// Nothing is done by keys while something is asked.
pub(super) fn take(
    ui: &Ui,
    (copied, is_asking): (&mut String, bool),
    (scene, quality): (&Scene, &Quality),
    actions: &mut Vec<Action>,
) {
    let pointed: Option<String> = ui.data_mut(|data| data.remove_temp(pointed_id()));
    let wish: Wish = ui.data_mut(|data| data.remove_temp(wish_id())).unwrap_or_default();
    let copy = |copied: &mut String, key: &str| {
        let text = match key.strip_prefix("quality") {
            Some(rest) => clip::copy(quality, rest.trim_start_matches('.')),
            None => clip::copy(scene, key),
        };
        if !text.is_empty() {
            ui.ctx().copy_text(text.clone());
            *copied = text;
        }
    };
    match &wish {
        Wish::Copy(key) => copy(copied, key),
        Wish::PasteCopied(key) => {
            actions.push(Action::Ask(Request::Paste { key: Some(key.clone()), text: copied.clone() }));
        }
        Wish::SetKey(key) => actions.push(Action::SetKey(key.clone())),
        Wish::Nothing => {}
    }
    if ui.ctx().egui_wants_keyboard_input() || is_asking {
        return;
    }
    let (is_copied, pasted) = ui.input(|input| {
        let pasted = input.events.iter().find_map(|event| match event {
            Event::Paste(text) => Some(text.clone()),
            _ => None,
        });
        (input.events.contains(&Event::Copy), pasted)
    });
    if let Some(key) = pointed.as_ref().filter(|key| can_move(key, scene))
        && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::K))
    {
        actions.push(Action::SetKey(key.clone()));
    }
    match &pointed {
        Some(key) if is_copied => copy(copied, key),
        None if is_copied => actions.push(Action::Ask(Request::CopyPicture)),
        _ => {}
    }
    if let Some(text) = pasted {
        actions.push(Action::Ask(Request::Paste { key: pointed, text }));
    }
}
