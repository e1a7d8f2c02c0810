//! The picture in the middle, and what hands do to it.

use egui::{Align2, Color32, FontId, PointerButton, Pos2, Rect, Sense, Stroke, Ui, Vec2};

use super::inspector::InspectorState;
use super::paint::PaintState;
use super::snapshots::{self, Beside, SnapshotState};
use super::truth::{Comparison, TruthState};
use crate::app::document::Document;
use crate::app::preferences::Habit;
use crate::scene::param::Choice;

/// What the picture lies on: a middle grey that changes no colour's looks, in both themes.
const SURROUND: Color32 = Color32::from_gray(72);

/// All of a texture.
const FULL: Rect = Rect { min: Pos2::ZERO, max: Pos2::new(1.0, 1.0) };
/// Side of the smallest region, in points.
const SMALLEST_REGION: f32 = 16.0;

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
    /// Shift the camera across the view.
    Pan(Vec2),
    /// Move towards the point ahead, by the second coordinate upwards.
    Dolly(f32),
    /// Walk level, and turn.
    Walk(Vec2),
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
    /// Whether directions are drawn over the picture.
    pub has_guides: bool,
    /// The part of the picture that is drawn: left, top, right and bottom, 0 to 1.
    pub region: Option<[f32; 4]>,
    /// Whether the next drag chooses the region; and where it began.
    pub is_choosing: bool,
    begun: Option<Pos2>,
    /// What lies behind the region.
    pub backdrop: Option<Backdrop>,
}

/// A picture that this program keeps itself.
#[derive(Clone)]
pub struct Backdrop(egui::TextureHandle, [u32; 2]);

impl std::fmt::Debug for Backdrop {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_tuple("Backdrop").field(&self.1).finish()
    }
}

impl From<(egui::TextureHandle, [u32; 2])> for Backdrop {
    fn from((texture, size): (egui::TextureHandle, [u32; 2])) -> Self {
        Self(texture, size)
    }
}

impl Default for ViewportState {
    fn default() -> Self {
        Self {
            picture: None,
            hud: None,
            status: "Preparing the sky…".to_owned(),
            rect: Rect::from_min_size(Pos2::ZERO, Vec2::ZERO),
            gestures: Vec::new(),
            has_guides: false,
            region: None,
            is_choosing: false,
            begun: None,
            backdrop: None,
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
pub(super) fn show(
    ui: &mut Ui,
    state: &mut ViewportState,
    (truth, snapshots, inspector, paint): (&mut TruthState, &mut SnapshotState, &mut InspectorState, &mut PaintState),
    (document, habit): (&Document, Habit),
) {
    let rect = ui.available_rect_before_wrap();
    state.rect = rect;
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    super::row::name(ui, &response, &format!("Sky: {}", document.name()), "viewport");
    if inspector.is_on && response.hovered() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
    }
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, SURROUND);
    let whole = rect;
    let rect = match state.region {
        Some(region) => {
            if let Some(Backdrop(texture, size)) = &state.backdrop {
                let dimmed = Color32::from_gray(110);
                painter.image(texture.id(), fitted(whole, *size), FULL, dimmed);
            }
            part_of(whole, region)
        }
        None => whole,
    };
    let painter = ui.painter_at(whole);
    // At rest the refined picture stands for the realtime one; while pictures are compared, that of all pixels does.
    let plain = if truth.compares() { truth.view.still } else { truth.view.refined };
    match plain.or(state.picture) {
        Some(picture) => {
            if !compared(ui, rect, truth) {
                let place = fitted(rect, picture.size);
                image(&painter, place, picture.texture);
                // Snapshots are whole pictures; of a region only their part is seen.
                let of_whole = if state.region.is_some() { whole } else { place };
                beside(&painter.with_clip_rect(place), (ui, of_whole), snapshots);
            }
            let place = fitted(rect, picture.size);
            // Side by side there are two pictures, and neither fills the place.
            let is_whole = truth.comparison != Comparison::SideBySide;
            let clicked = inspector.is_on && is_whole && response.clicked();
            if let (true, Some(at)) = (clicked, response.interact_pointer_pos()) {
                let inside = (at - place.min) / place.size();
                inspector.wish = Some([inside.x.clamp(0.0, 1.0), inside.y.clamp(0.0, 1.0)]);
                inspector.picked = None;
            }
            if state.has_guides {
                let whole = if state.region.is_some() { whole } else { place };
                super::guides::paint(&painter, whole, &document.preset().scene);
            }
            super::inspector::mark(&painter, place, inspector);
            if is_whole && !state.is_choosing {
                let shown = (place, state.region.is_none());
                super::paint::over_picture(ui, (&response, shown), &document.preset().scene, paint);
            }
        }
        None => {
            let font = FontId::proportional(16.0);
            painter.text(rect.center(), Align2::CENTER_CENTER, &state.status, font, Color32::from_gray(215));
        }
    }
    if state.region.is_some() {
        painter.rect_stroke(rect, 0.0, Stroke::new(1.0, Color32::from_rgb(255, 210, 120)), egui::StrokeKind::Outside);
    }
    let rect = whole;
    if let Some(hud) = &state.hud {
        let font = FontId::proportional(15.0);
        let galley = painter.layout_no_wrap(hud.clone(), font, Color32::WHITE);
        let place = Align2::CENTER_BOTTOM
            .anchor_size(rect.center_bottom() - Vec2::new(0.0, 14.0 + truth.height), galley.size());
        painter.rect_filled(place.expand2(Vec2::new(8.0, 4.0)), 4.0, Color32::from_black_alpha(150));
        painter.galley(place.min, galley, Color32::WHITE);
    }
    if state.is_choosing {
        choose_region(ui, (whole, &response), state);
    } else {
        gestures(ui, &response, (habit, paint.is_on), &mut state.gestures);
    }
}

/// The part of an area.
fn part_of(area: Rect, [left, top, right, bottom]: [f32; 4]) -> Rect {
    let at = |u: f32, v: f32| Pos2::new(area.left() + u * area.width(), area.top() + v * area.height());
    Rect::from_min_max(at(left, top), at(right, bottom))
}

/// Lets a drag choose the region; Escape ends it.
fn choose_region(ui: &Ui, (area, response): (Rect, &egui::Response), state: &mut ViewportState) {
    if response.hovered() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
    }
    if ui.input(|input| input.key_pressed(egui::Key::Escape)) {
        (state.is_choosing, state.begun) = (false, None);
        return;
    }
    let Some(pointer) = response.interact_pointer_pos() else { return };
    if response.drag_started_by(PointerButton::Primary) {
        state.begun = ui.input(|input| input.pointer.press_origin()).or(Some(pointer));
    }
    let Some(begun) = state.begun else { return };
    let chosen = Rect::from_two_pos(begun, pointer).intersect(area);
    ui.painter_at(area).rect_stroke(chosen, 0.0, Stroke::new(1.5, Color32::WHITE), egui::StrokeKind::Middle);
    if response.drag_stopped() {
        (state.is_choosing, state.begun) = (false, None);
        // A slip of the hand is no region.
        if chosen.width() >= SMALLEST_REGION && chosen.height() >= SMALLEST_REGION {
            let (low, high) = ((chosen.min - area.min) / area.size(), (chosen.max - area.min) / area.size());
            state.region = Some([low.x, low.y, high.x, high.y]);
        }
    }
}

fn image(painter: &egui::Painter, place: Rect, texture: egui::TextureId) {
    painter.image(texture, place, FULL, Color32::WHITE);
}

/// Says in an upper corner whose picture it is.
fn caption(painter: &egui::Painter, place: Rect, text: &str, corner: Align2) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(13.0), Color32::WHITE);
    let inner = place.shrink2(Vec2::new(14.0, 10.0));
    let at = corner.anchor_size(corner.pos_in_rect(&inner), galley.size());
    painter.rect_filled(at.expand2(Vec2::new(6.0, 3.0)), 4.0, Color32::from_black_alpha(150));
    painter.galley(at.min, galley, Color32::WHITE);
}

/// Draws the two pictures that are compared, as far as they are there; `false` if that is nothing.
fn compared(ui: &Ui, rect: Rect, truth: &mut TruthState) -> bool {
    let (Some(still), Some(other)) = (truth.view.still, truth.view.truth) else { return false };
    let painter = ui.painter_at(rect);
    let place = fitted(rect, still.size);
    let reference = truth.reference.title();
    match truth.comparison {
        Comparison::Off => return false,
        Comparison::Wipe => {
            let x = place.left() + place.width() * truth.divider;
            let right = Rect::from_min_max(Pos2::new(x, place.top()), place.max);
            image(&painter, place, still.texture);
            image(&painter.with_clip_rect(right.intersect(rect)), place, other.texture);
            let left = Rect::from_min_max(place.min, Pos2::new(x, place.bottom()));
            caption(&painter.with_clip_rect(left.intersect(rect)), left, "Realtime", Align2::RIGHT_TOP);
            caption(&painter.with_clip_rect(right.intersect(rect)), right, reference, Align2::LEFT_TOP);
            divider(ui, place, ("Divider between realtime and truth", "truth.divider"), &mut truth.divider);
        }
        Comparison::SideBySide => {
            // Half as large there is room for them above the controls.
            let free = Rect::from_min_max(rect.min, rect.max - Vec2::new(0.0, truth.height.min(0.5 * rect.height())));
            let (left, right) = free.split_left_right_at_fraction(0.5);
            for (half, picture, name) in [(left, still, "Realtime"), (right, other, reference)] {
                let place = fitted(half.shrink2(Vec2::new(1.0, 0.0)), picture.size);
                image(&painter, place, picture.texture);
                caption(&painter, place, name, Align2::CENTER_TOP);
            }
        }
        Comparison::Flip => {
            let typing = ui.ctx().egui_wants_keyboard_input();
            let flipped = !typing && ui.input(|input| input.key_down(egui::Key::T) && input.modifiers.is_none());
            image(&painter, place, if flipped { other.texture } else { still.texture });
            caption(&painter, place, if flipped { reference } else { "Realtime" }, Align2::CENTER_TOP);
        }
        Comparison::Difference => {
            let Some([signed, absolute]) = &truth.view.difference else { return false };
            image(&painter, place, if truth.is_signed { signed.texture } else { absolute.texture });
        }
    }
    true
}

/// Draws the chosen snapshot over the picture, as far as it is wanted.
fn beside(painter: &egui::Painter, (ui, place): (&Ui, Rect), state: &mut SnapshotState) {
    let Some((snapshot, picture)) = state.chosen() else { return };
    // As high as the picture and in its middle: a lens shows the same things there, whatever the width.
    let [width, height] = picture.size.map(|side| side.max(1) as f32);
    let theirs = Rect::from_center_size(place.center(), Vec2::new(place.height() * width / height, place.height()));
    match state.beside {
        Beside::Flip if !snapshots::is_flipped(ui, state) => {}
        Beside::Flip => {
            image(painter, theirs, picture.texture);
            caption(painter, place, &snapshot.name, Align2::CENTER_TOP);
        }
        Beside::Wipe => {
            let left = snapshots::left_of(place, state.divider);
            let painter = &painter.with_clip_rect(left.intersect(painter.clip_rect()));
            image(painter, theirs, picture.texture);
            caption(painter, left, &snapshot.name, Align2::RIGHT_TOP);
            divider(ui, place, ("Divider between snapshot and picture", "snapshots.divider"), &mut state.divider);
        }
        Beside::Difference => {
            let Some(difference) = state.difference() else { return };
            image(painter, place, difference.texture);
            caption(painter, place, &format!("Difference to {}, ×8", snapshot.name), Align2::CENTER_TOP);
        }
    }
}

/// The line between the two pictures, and what moves it: the mouse, or the arrow keys when it has the focus.
fn divider(ui: &Ui, place: Rect, (name, key): (&str, &str), share: &mut f32) {
    let x = place.left() + place.width() * *share;
    let grip = Rect::from_center_size(Pos2::new(x, place.center().y), Vec2::new(12.0, place.height()));
    let response = ui.interact(grip, ui.scope_id().with(key), Sense::click_and_drag());
    let response = response.on_hover_and_drag_cursor(egui::CursorIcon::ResizeHorizontal);
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_role(egui::accesskit::Role::Splitter);
        node.set_label(name);
        node.set_author_id(key);
    });
    if response.clicked() {
        response.request_focus();
    }
    let mut moved = response.drag_delta().x;
    if response.has_focus() {
        let filter = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        moved += 0.01 * place.width() * f32::from(i8::from(pressed(egui::Key::ArrowRight)));
        moved -= 0.01 * place.width() * f32::from(i8::from(pressed(egui::Key::ArrowLeft)));
    }
    *share = (*share + moved / place.width().max(1.0)).clamp(0.0, 1.0);
    let x = place.left() + place.width() * *share;
    let width = if response.hovered() || response.dragged() || response.has_focus() { 3.0 } else { 1.5 };
    let painter = ui.painter_at(place);
    painter.vline(x, place.y_range(), Stroke::new(width + 2.0, Color32::from_black_alpha(110)));
    painter.vline(x, place.y_range(), Stroke::new(width, Color32::WHITE));
}

/// What dragging with a button means.
fn meaning(habit: Habit, button: PointerButton, modifiers: egui::Modifiers) -> Option<fn(Vec2) -> Gesture> {
    use PointerButton::{Middle, Primary, Secondary};
    let dolly: fn(Vec2) -> Gesture = |drag| Gesture::Dolly(drag.x - drag.y);
    Some(match (habit, button) {
        (Habit::Maya | Habit::Unreal, Primary) if modifiers.alt => Gesture::Orbit,
        (Habit::Maya | Habit::Unreal, Secondary) if modifiers.alt => dolly,
        (Habit::Maya, Middle) if modifiers.alt => Gesture::Pan,
        (Habit::Unreal, Middle) => Gesture::Pan,
        (Habit::Unreal, Primary) => Gesture::Walk,
        (Habit::Blender, Middle) if modifiers.shift => Gesture::Pan,
        (Habit::Blender, Middle) if modifiers.command => dolly,
        (Habit::Blender, Middle) => Gesture::Orbit,
        (Habit::Blender, Primary) if modifiers.shift => Gesture::Orbit,
        _ => return None,
    })
}

fn gestures(ui: &Ui, response: &egui::Response, (habit, paints): (Habit, bool), gestures: &mut Vec<Gesture>) {
    use PointerButton::{Middle, Primary, Secondary};
    let (pressed, modifiers, sun, wheel) = ui.input(|input| {
        (
            input.pointer.button_pressed(Secondary),
            input.modifiers,
            input.key_down(egui::Key::L),
            input.smooth_scroll_delta().y,
        )
    });
    if pressed && response.hovered() && meaning(habit, Secondary, modifiers).is_none() {
        gestures.push(Gesture::StartLook);
        ui.ctx().memory_mut(|memory| {
            if let Some(focused) = memory.focused() {
                memory.surrender_focus(focused);
            }
        });
    }
    if wheel != 0.0 && response.hovered() && !modifiers.command {
        gestures.push(Gesture::Dolly(wheel));
    }
    let drag = response.drag_delta();
    if drag == Vec2::ZERO {
        return;
    }
    if response.dragged_by(Primary) && sun {
        gestures.push(Gesture::DragSun(drag));
        return;
    }
    // The plain button is the brush's.
    let is_free = |button: &PointerButton| *button != Primary || !paints || modifiers.any();
    let held = [Primary, Middle, Secondary].into_iter().filter(is_free).find(|button| response.dragged_by(*button));
    gestures.extend(held.and_then(|button| meaning(habit, button, modifiers)).map(|gesture| gesture(drag)));
}

/// The largest rectangle of the picture's shape in the middle of `area`.
fn fitted(area: Rect, size: [u32; 2]) -> Rect {
    let picture = Vec2::new(size[0] as f32, size[1] as f32);
    let scale = (area.width() / picture.x).min(area.height() / picture.y);
    // The shapes agree but for the rounding of the picture to whole pixels, except while the window changes its size.
    let close = (area.width() / picture.x / (area.height() / picture.y) - 1.0).abs() < 0.01;
    if close { area } else { Rect::from_center_size(area.center(), picture * scale) }
}
