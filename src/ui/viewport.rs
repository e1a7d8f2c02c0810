//! The picture in the middle, and what hands do to it.

use egui::{Align2, Color32, FontId, PointerButton, Pos2, Rect, Sense, Ui, Vec2};

use crate::app::document::Document;

/// What the picture lies on: a middle grey that changes no colour's looks, in both themes.
const SURROUND: Color32 = Color32::from_gray(72);

/// The last finished picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picture {
    /// The texture.
    pub texture: egui::TextureId,
    /// Its size in pixels.
    pub size: [u32; 2],
}

/// A movement of the mouse over the picture, in points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gesture {
    /// The right button went down: look and fly until it goes up.
    StartLook,
    /// Orbit the point ahead.
    Orbit(Vec2),
    /// Move the sun.
    DragSun(Vec2),
}

/// What is shown, where, and what was done to it since it was last drawn.
#[derive(Clone, Debug)]
pub struct ViewportState {
    /// The last finished picture.
    pub picture: Option<Picture>,
    /// A line over the picture, such as the speed of flight.
    pub hud: Option<String>,
    /// What is said while there is no picture.
    pub status: String,
    /// Where the picture goes, in points.
    pub rect: Rect,
    /// What hands did.
    pub gestures: Vec<Gesture>,
}

impl Default for ViewportState {
    fn default() -> Self {
        Self {
            picture: None,
            hud: None,
            status: "Preparing the sky…".to_owned(),
            rect: Rect::from_min_size(Pos2::ZERO, Vec2::ZERO),
            gestures: Vec::new(),
        }
    }
}

impl ViewportState {
    /// Size of the area in pixels of the screen; at least one each.
    #[allow(clippy::cast_possible_truncation, reason = "screens are smaller")]
    pub fn size_px(&self, pixels_per_point: f32) -> [u32; 2] {
        let side = |points: f32| ((points * pixels_per_point).round() as u32).max(1);
        [side(self.rect.width()), side(self.rect.height())]
    }
}

/// Draws the picture and notes the gestures.
pub(super) fn show(ui: &mut Ui, state: &mut ViewportState, document: &Document) {
    let rect = ui.available_rect_before_wrap();
    state.rect = rect;
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    super::row::name(ui, &response, &format!("Sky: {}", document.name()), "viewport");
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, SURROUND);
    match state.picture {
        Some(picture) => {
            let uv = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(picture.texture, fitted(rect, picture.size), uv, Color32::WHITE);
        }
        None => {
            let font = FontId::proportional(16.0);
            painter.text(rect.center(), Align2::CENTER_CENTER, &state.status, font, Color32::from_gray(215));
        }
    }
    if let Some(hud) = &state.hud {
        let font = FontId::proportional(15.0);
        let galley = painter.layout_no_wrap(hud.clone(), font, Color32::WHITE);
        let place = Align2::CENTER_BOTTOM.anchor_size(rect.center_bottom() - Vec2::new(0.0, 14.0), galley.size());
        painter.rect_filled(place.expand2(Vec2::new(8.0, 4.0)), 4.0, Color32::from_black_alpha(150));
        painter.galley(place.min, galley, Color32::WHITE);
    }
    gestures(ui, &response, &mut state.gestures);
}

fn gestures(ui: &Ui, response: &egui::Response, gestures: &mut Vec<Gesture>) {
    let pressed = ui.input(|input| input.pointer.button_pressed(PointerButton::Secondary));
    if pressed && response.hovered() {
        gestures.push(Gesture::StartLook);
        ui.ctx().memory_mut(|memory| {
            if let Some(focused) = memory.focused() {
                memory.surrender_focus(focused);
            }
        });
    }
    let drag = response.drag_delta();
    if drag == Vec2::ZERO {
        return;
    }
    let (shift, sun) = ui.input(|input| (input.modifiers.shift, input.key_down(egui::Key::L)));
    let left = response.dragged_by(PointerButton::Primary);
    if left && sun {
        gestures.push(Gesture::DragSun(drag));
    } else if response.dragged_by(PointerButton::Middle) || left && shift {
        gestures.push(Gesture::Orbit(drag));
    }
}

/// The largest rectangle of the picture's shape in the middle of `area`.
fn fitted(area: Rect, size: [u32; 2]) -> Rect {
    let picture = Vec2::new(size[0] as f32, size[1] as f32);
    let scale = (area.width() / picture.x).min(area.height() / picture.y);
    // The shapes agree but for the rounding of the picture to whole pixels, except while the window changes its size.
    let close = (area.width() / picture.x / (area.height() / picture.y) - 1.0).abs() < 0.01;
    if close { area } else { Rect::from_center_size(area.center(), picture * scale) }
}
