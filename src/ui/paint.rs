//! The brush: what it does, where it is over the picture, and its controls.

use egui::{Align2, Color32, Context, Pos2, Rect, Response, Stroke, Ui};

use super::row;
use crate::scene::param::Choice;
use crate::scene::{Brush, CloudKind, FlowKind, Scene};

/// The brush touched the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Where, 0 to 1 from the top left of the picture; or on the weather map, in its edges from its corner.
    pub at: [f32; 2],
    /// Whether a stroke begins there.
    pub begins: bool,
    /// Whether it is the map that was touched.
    pub is_on_map: bool,
}

/// The brush, and what it touched.
#[derive(Clone, Debug)]
pub struct PaintState {
    /// Whether the left mouse button paints.
    pub is_on: bool,
    /// Whether it stirs the map instead of painting.
    pub stirs: bool,
    /// How it stirs.
    pub flow: FlowKind,
    /// Whether it works on whole clouds, by a click on one; its radius is then theirs.
    pub whole: bool,
    /// What it paints.
    pub brush: Brush,
    /// The kind of cloud that it adds.
    pub kind: CloudKind,
    /// Its radius.
    pub radius_m: f32,
    /// How far one pass of it goes; how fast what it stirs flows.
    pub strength: f32,
    /// Share of the radius over which it fades.
    pub softness: f32,
    /// How much cloud it adds at most.
    pub amount: f32,
    /// Whether the button was pressed over the picture and is held since.
    pub is_drawing: bool,
    /// Touches that are not painted yet.
    pub touches: Vec<Touch>,
    /// Height above the sea that it paints at; that of the last stroke.
    pub height_m: Option<f32>,
}

impl Default for PaintState {
    fn default() -> Self {
        Self {
            is_on: false,
            stirs: false,
            flow: FlowKind::Vortex,
            whole: false,
            brush: Brush::Add,
            kind: CloudKind::Cumulus,
            radius_m: 900.0,
            strength: 0.7,
            softness: 0.7,
            amount: 1.0,
            is_drawing: false,
            touches: Vec::new(),
            height_m: None,
        }
    }
}

/// Takes what the mouse does over the picture at `place`; draws the brush's edge where it would paint, where that is the whole
/// picture.
pub(super) fn over_picture(
    ui: &Ui,
    (response, (place, is_whole)): (&Response, (Rect, bool)),
    scene: &Scene,
    state: &mut PaintState,
) {
    if !state.is_on {
        return;
    }
    if response.hovered() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
    }
    let (is_down, begins) = ui.input(|input| (input.pointer.primary_down(), input.pointer.primary_pressed()));
    // Keys with the button are the camera's.
    let is_plain = ui.input(|input| input.modifiers.is_none() && !input.key_down(egui::Key::L));
    // A click may be over before this is drawn.
    let pointer = if is_down || begins { response.interact_pointer_pos() } else { None };
    let pointer = pointer.filter(|pointer| is_plain && place.contains(*pointer));
    // Who pressed the button elsewhere does not paint.
    let begins = begins && pointer.is_some();
    state.is_drawing = is_down && (state.is_drawing || begins);
    if let Some(pointer) = pointer.filter(|_| state.is_drawing || begins) {
        let at = (pointer - place.min) / place.size();
        let touch = Touch { at: [at.x, at.y], begins, is_on_map: false };
        if state.touches.last() != Some(&touch) {
            state.touches.push(touch);
        }
    }
    let has_edge = state.stirs || !state.whole;
    if let Some(pointer) = response.hover_pos().filter(|_| is_whole && has_edge) {
        edge(&ui.painter_at(place), (place, pointer), scene, state);
    }
}

/// Draws the circle that the brush covers about the place under the pointer.
fn edge(painter: &egui::Painter, (place, pointer): (Rect, Pos2), scene: &Scene, state: &PaintState) {
    // Only its shape matters.
    let size = [place.width(), place.height()].map(|side| {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a size on the screen")]
        let side = side.max(1.0).round() as u32;
        side
    });
    let at = (pointer - place.min) / place.size();
    let towards = scene.camera.direction_through([at.x, at.y], size);
    let height_m = state.height_m.or_else(|| scene.visible_layers().next().map(|layer| layer.base_m));
    let Some(centre) = height_m.and_then(|height_m| scene.place_at_height(towards, height_m)) else { return };
    let point = |turn: f32| {
        let (sin, cos) = turn.sin_cos();
        let there = centre + glam::Vec3::new(cos, 0.0, sin) * state.radius_m;
        let [u, v] = scene.camera.point_of(there.normalize(), size)?;
        let is_near = (-1.0..=2.0).contains(&u) && (-1.0..=2.0).contains(&v);
        is_near.then(|| Pos2::new(place.left() + u * place.width(), place.top() + v * place.height()))
    };
    let points: Vec<Option<Pos2>> = (0..=48_u8).map(|i| point(f32::from(i) / 48.0 * std::f32::consts::TAU)).collect();
    for pair in points.windows(2) {
        if let [Some(from), Some(to)] = pair {
            painter.line_segment([*from, *to], Stroke::new(3.0, Color32::from_black_alpha(140)));
            painter.line_segment([*from, *to], Stroke::new(1.2, Color32::WHITE));
        }
    }
}

/// Draws the brush's controls in a corner of the picture.
pub(super) fn show(context: &Context, area: Rect, state: &mut PaintState) {
    if !state.is_on {
        return;
    }
    // Above what the picture says of its progress.
    let corner = area.left_bottom() + egui::vec2(10.0, -44.0);
    let place = egui::Area::new(egui::Id::unique("brush")).pivot(Align2::LEFT_BOTTOM).fixed_pos(corner);
    place.show(context, |ui| {
        egui::Frame::window(&context.global_style()).inner_margin(8.0).show(ui, |ui| {
            ui.set_max_width(230.0);
            ui.horizontal(|ui| {
                ui.strong("Brush");
                ui.weak("left mouse paints, P ends it");
            });
            let stirs = ui.checkbox(&mut state.stirs, "Stir").on_hover_text(
                "Draws flows that carry the clouds: from where the button is pressed to where it is let go, and on from there.",
            );
            row::name(ui, &stirs, "Stir", "brush.stirs");
            let paints = !state.stirs;
            if paints {
                let whole = ui.checkbox(&mut state.whole, "Whole clouds").on_hover_text(
                    "A click works on all of the cloud under it at once; the brush that moves takes it along while you drag.",
                );
                row::name(ui, &whole, "Whole clouds", "brush.whole");
            }
            if paints {
                pick(ui, "brush.does", &mut state.brush);
            } else {
                pick(ui, "brush.flow", &mut state.flow);
            }
            let adds = paints && state.brush == Brush::Add;
            if adds {
                pick(ui, "brush.kind", &mut state.kind);
            }
            if !(paints && state.whole) {
                let radius = egui::Slider::new(&mut state.radius_m, 50.0..=20_000.0).logarithmic(true).suffix(" m");
                slider(ui, radius, "Radius", "brush.radius");
            }
            // What a whole cloud has of its own is not asked for.
            let is_carried = paints && state.whole && state.brush == Brush::Move;
            if !is_carried {
                slider(ui, egui::Slider::new(&mut state.strength, 0.01..=1.0), "Strength", "brush.strength");
            }
            let is_reshaped = state.whole && matches!(state.brush, Brush::Move | Brush::Grow | Brush::Shrink);
            if paints && !is_reshaped {
                slider(ui, egui::Slider::new(&mut state.softness, 0.0..=1.0), "Softness", "brush.softness");
            }
            if adds {
                slider(ui, egui::Slider::new(&mut state.amount, 0.0..=1.0), "Amount", "brush.amount");
            }
        });
    });
}

fn slider(ui: &mut Ui, slider: egui::Slider<'_>, name: &str, key: &str) {
    let response = ui.add(slider.text(name).max_decimals(2));
    row::name(ui, &response, name, key);
}

fn pick<C: Choice>(ui: &mut Ui, key: &str, choice: &mut C) {
    let list = egui::ComboBox::from_id_salt(key).selected_text(choice.title()).width(200.0).show_ui(ui, |ui| {
        for option in C::ALL {
            let response = ui.selectable_label(*option == *choice, option.title()).on_hover_text(option.doc().trim());
            if response.clicked() {
                *choice = *option;
            }
        }
    });
    row::name(ui, &list.response, choice.title(), key);
}
