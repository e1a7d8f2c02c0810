//! Kept cameras: a list in the menu, and the keys 1 to 9.

use egui::{Key, Modifiers, Ui};

use super::row;
use crate::app::action::Action;
use crate::app::document::Document;
use crate::scene::{Bookmark, Camera, MAX_BOOKMARKS};

/// How far ahead the clouds are that are looked at.
const AHEAD_M: f32 = 5000.0;

const KEYS: [Key; MAX_BOOKMARKS] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

/// The list, with a row for each camera and one that keeps another.
pub(super) fn menu(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    ui.set_min_width(230.0);
    let kept = &document.preset().cameras;
    let edit = |step, cameras| Action::EditCameras { step, cameras };
    for (index, bookmark) in kept.iter().enumerate() {
        ui.horizontal(|ui| {
            let number = (index + 1).to_string();
            let go = ui.button(&number).on_hover_text(format!("Go there (key {number})"));
            row::name(ui, &go, &format!("Go to camera {number}"), &format!("cameras.{index}.go"));
            if go.clicked() {
                actions.push(Action::GoToCamera(index));
                ui.close();
            }
            let mut name = bookmark.name.clone();
            let field = egui::TextEdit::singleline(&mut name).hint_text("name").desired_width(150.0).char_limit(80);
            let field = ui.add(field);
            row::name(ui, &field, &format!("Name of camera {number}"), &format!("cameras.{index}.name"));
            if field.changed() {
                let mut cameras = kept.clone();
                cameras[index].name = name;
                actions.push(edit("rename a camera", cameras));
            }
            let remove = ui.button("×").on_hover_text("Forget this camera");
            row::name(ui, &remove, &format!("Forget camera {number}"), &format!("cameras.{index}.remove"));
            if remove.clicked() {
                let mut cameras = kept.clone();
                cameras.remove(index);
                actions.push(edit("forget a camera", cameras));
            }
        });
    }
    let has_room = kept.len() < MAX_BOOKMARKS;
    let keep = egui::Button::new("Keep this camera").shortcut_text("Ctrl+K");
    let keep = ui.add_enabled(has_room, keep).on_hover_text("Saved with the sky");
    if keep.on_disabled_hover_text("Nine are kept; forget one first").clicked() {
        actions.extend(kept_with_this(document));
        ui.close();
    }
}

/// The camera where it is, level, and looking at the middle of what clouds there are, as they stand some way ahead.
pub(super) fn at_clouds(document: &Document) -> Camera {
    let scene = &document.preset().scene;
    let low = scene.visible_layers().map(|layer| layer.base_m).fold(f32::INFINITY, f32::min);
    let high = scene.visible_layers().map(|layer| layer.top_m).fold(0.0, f32::max);
    let middle = if low <= high { 0.5 * (low + high) } else { scene.camera.height_m };
    let pitch_deg = (middle - scene.camera.height_m).atan2(AHEAD_M).to_degrees();
    Camera { pitch_deg, roll_deg: 0.0, ..scene.camera.clone() }
}

/// The list with the camera as it is now; `None` if it is full.
pub(super) fn kept_with_this(document: &Document) -> Option<Action> {
    let mut cameras = document.preset().cameras.clone();
    if cameras.len() >= MAX_BOOKMARKS {
        return None;
    }
    let camera = document.preset().scene.camera.clone();
    cameras.push(Bookmark { name: format!("Camera {}", cameras.len() + 1), camera });
    Some(Action::EditCameras { step: "keep a camera", cameras })
}

/// Goes to the camera whose number was pressed.
pub(super) fn take_keys(ui: &Ui, document: &Document, actions: &mut Vec<Action>) {
    let is_free = !ui.ctx().egui_wants_keyboard_input();
    for (index, key) in KEYS.into_iter().enumerate().take(document.preset().cameras.len()) {
        if is_free && ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)) {
            actions.push(Action::GoToCamera(index));
        }
    }
}
