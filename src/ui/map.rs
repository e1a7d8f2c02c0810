//! The weather map from above: where the eye is on it, and the brush on all of it.

use egui::{Align2, Color32, Context, CursorIcon, Id, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2};
use glam::{DMat2, DVec2};

use super::paint::{PaintState, Touch};
use super::viewport::Picture;
use crate::app::action::Action;
use crate::app::document::{Document, EyeOnMap, eye_on_map};
use crate::scene::{Camera, FARTHEST_M, MapEdge, Scene};

/// The state of the map's window.
#[derive(Clone, Debug, Default)]
pub struct MapState {
    /// Whether it is there.
    pub is_open: bool,
    /// Whether the button was pressed over the map with the brush on, and is held since.
    is_drawing: bool,
    /// The picture of the map, while there is one.
    pub picture: Option<Picture>,
}

/// Where things are on the map, in edges of the map from its corner.
struct OnMap {
    eye: DVec2,
    /// How far metres to the east and to the south go.
    per_metre: DMat2,
    /// What the window shows in its corner: a map without end has the eye in the middle.
    corner: DVec2,
}

impl OnMap {
    fn new(scene: &Scene, time_secs: f64) -> Option<Self> {
        let EyeOnMap { eye, per_metre } = eye_on_map(scene, time_secs)?;
        let is_endless = scene.weather.edge == MapEdge::Repeat;
        let eye = if is_endless { eye - eye.floor() } else { eye };
        let corner = if is_endless { eye - 0.5 } else { DVec2::ZERO };
        Some(Self { eye, per_metre, corner })
    }

    /// What a point of the window shows.
    fn at(&self, place: Rect, pointer: Pos2) -> DVec2 {
        let share = (pointer - place.min) / place.size();
        self.corner + DVec2::new(f64::from(share.x), f64::from(share.y))
    }

    /// And back.
    #[allow(clippy::cast_possible_truncation, reason = "points on the screen")]
    fn point(&self, place: Rect, at: DVec2) -> Pos2 {
        let share = at - self.corner;
        place.min + Vec2::new(share.x as f32, share.y as f32) * place.size()
    }
}

/// Draws the window.
pub(super) fn show(
    context: &Context,
    area: Rect,
    (state, brush): (&mut MapState, &mut PaintState),
    document: &Document,
    actions: &mut Vec<Action>,
) {
    let scene = &document.preset().scene;
    let window = egui::Window::new("Weather map").id(Id::unique("weather map")).constrain_to(area);
    let window = window.pivot(Align2::RIGHT_BOTTOM).default_pos(area.right_bottom() - Vec2::splat(12.0));
    let mut is_open = true;
    window.open(&mut is_open).default_size([300.0, 340.0]).min_size([180.0, 220.0]).show(context, |ui| {
        let Some((number, _)) = scene.layer_on_map() else {
            ui.weak("No cloud stands where a weather map says.");
            return;
        };
        let hint = match (brush.is_on, scene.layers.len()) {
            (true, _) => "Left mouse paints here as in the picture",
            (false, 1) => "A click takes the camera there; P paints",
            (false, _) => "as this layer reads it. A click takes the camera there; P paints",
        };
        ui.horizontal_wrapped(|ui| {
            ui.strong(format!("Layer {}", number + 1));
            ui.weak(hint);
        });
        let side = ui.available_size().min_elem().max(120.0);
        let (place, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Weather map, north upwards"));
        let painter = ui.painter_at(place);
        let Some(picture) = state.picture else {
            painter.rect_filled(place, 0.0, ui.visuals().extreme_bg_color);
            painter.text(
                place.center(),
                Align2::CENTER_CENTER,
                "Preparing the map…",
                egui::FontId::default(),
                Color32::GRAY,
            );
            return;
        };
        let Some(on_map) = OnMap::new(scene, document.time_secs()) else { return };
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        for tile in [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE] {
            let corner = on_map.point(place, on_map.corner.floor() + tile);
            painter.image(picture.texture, Rect::from_min_size(corner, place.size()), whole, Color32::WHITE);
        }
        marker(&painter, place, &on_map, scene);
        if brush.is_on {
            paint(ui, (&response, place), (scene, &on_map), (brush, &mut state.is_drawing));
            return;
        }
        state.is_drawing = false;
        if response.clicked_by(PointerButton::Primary)
            && let Some(pointer) = response.interact_pointer_pos()
        {
            actions.extend(there(scene, &on_map, on_map.at(place, pointer)).map(Action::PlaceCamera));
        }
    });
    state.is_open = is_open;
}

/// The camera where it would stand under a point of the map, the nearest such place.
#[allow(clippy::cast_possible_truncation, reason = "metres, as cameras count them")]
fn there(scene: &Scene, on_map: &OnMap, at: DVec2) -> Option<Camera> {
    let mut way = at - on_map.eye;
    if scene.weather.edge == MapEdge::Repeat {
        way -= way.round();
    }
    let metres = on_map.per_metre.inverse() * way;
    let camera = &scene.camera;
    let moved = Camera {
        east_m: ((f64::from(camera.east_m) + metres.x) as f32).clamp(-FARTHEST_M, FARTHEST_M),
        south_m: ((f64::from(camera.south_m) + metres.y) as f32).clamp(-FARTHEST_M, FARTHEST_M),
        ..camera.clone()
    };
    metres.is_finite().then_some(moved)
}

/// Draws where the eye is and where it looks.
#[allow(clippy::cast_possible_truncation, reason = "a direction on the screen")]
fn marker(painter: &egui::Painter, place: Rect, on_map: &OnMap, scene: &Scene) {
    let eye = on_map.point(place, on_map.eye);
    let heading = f64::from(scene.camera.heading_deg).to_radians();
    let ahead = on_map.per_metre * DVec2::new(heading.sin(), -heading.cos());
    let ahead = ahead.normalize_or_zero();
    let ahead = Vec2::new(ahead.x as f32, ahead.y as f32);
    let tip = eye + ahead * 14.0;
    let [left, right] = [1.0, -1.0].map(|side| eye - ahead * 7.0 + ahead.rot90() * (7.0 * side));
    let outline = Stroke::new(2.0, Color32::from_black_alpha(190));
    painter.add(egui::Shape::convex_polygon(vec![tip, left, right], Color32::from_rgb(255, 140, 40), outline));
}

/// Takes what the brush does here, and draws its edge.
#[allow(clippy::cast_possible_truncation, reason = "places on the map")]
fn paint(
    ui: &Ui,
    (response, place): (&Response, Rect),
    (scene, on_map): (&Scene, &OnMap),
    (brush, is_drawing): (&mut PaintState, &mut bool),
) {
    if response.hovered() {
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    }
    let (is_down, pressed) = ui.input(|input| (input.pointer.primary_down(), input.pointer.primary_pressed()));
    let begins = pressed && response.contains_pointer();
    *is_drawing = is_down && (*is_drawing || begins);
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| begins || *is_drawing) {
        let at = on_map.at(place, pointer).to_array().map(|edges| edges as f32);
        let touch = Touch { at, begins, is_on_map: true };
        if brush.touches.last() != Some(&touch) {
            brush.touches.push(touch);
        }
    }
    if brush.whole && !brush.stirs {
        return;
    }
    let (Some(pointer), Some((_, layer))) = (response.hover_pos(), scene.layer_on_map()) else { return };
    let radius = brush.radius_m / (scene.weather.size_m * layer.map_scale) * place.width();
    let painter = ui.painter_at(place);
    painter.circle_stroke(pointer, radius, Stroke::new(3.0, Color32::from_black_alpha(140)));
    painter.circle_stroke(pointer, radius, Stroke::new(1.2, Color32::WHITE));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_click_on_the_map_takes_the_camera_to_what_lies_there() {
        let mut scene = Scene::default();
        scene.camera.east_m = 31_000.0;
        scene.layers[0].stretch = 4.0;
        scene.layers[0].map_scale = 1.7;
        for edge in [MapEdge::Repeat, MapEdge::Clear] {
            scene.weather.edge = edge;
            for at in [DVec2::new(0.1, 0.9), DVec2::new(0.6, 0.4)] {
                let on_map = OnMap::new(&scene, 5000.0).expect("the sky has a map");
                let camera = there(&scene, &on_map, at).expect("a place");
                let moved = OnMap::new(&Scene { camera, ..scene.clone() }, 5000.0).expect("the sky has a map");
                let off = (moved.eye - at).length();
                assert!(off < 1e-4, "{edge:?}: {} is not {at:?}", moved.eye);
            }
        }
    }

    #[test]
    fn no_click_takes_the_camera_where_no_preset_may_have_it() {
        let mut scene = Scene::default();
        scene.weather.size_m = 500_000.0;
        scene.layers[0].map_scale = 20.0;
        scene.camera.east_m = -900_000.0;
        let on_map = OnMap::new(&scene, 0.0).expect("the sky has a map");
        scene.camera = there(&scene, &on_map, on_map.corner).expect("a place");
        assert!(scene.camera.east_m.abs() == FARTHEST_M && scene.problems().is_empty(), "{:?}", scene.camera);
    }
}
