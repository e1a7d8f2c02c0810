//! The sun on a dial: north above, the zenith in the middle, the horizon a ring; and named hours, cities, and now.

use egui::{Color32, Pos2, Rect, Sense, Stroke, Ui, Vec2};

use super::row;
use crate::scene::{CITIES, Moment, Scene, Sun, SunPlacement};

/// Side of the dial, in points.
const SIDE: f32 = 132.0;
/// Degrees below the horizon at the dial's edge.
const LOWEST_DEG: f32 = 18.0;

/// Draws the dial; returns the key of what was changed in the scene.
pub(super) fn show(ui: &mut Ui, scene: &mut Scene) -> Option<&'static str> {
    let mut changed = None;
    ui.horizontal_top(|ui| {
        if dial(ui, scene) {
            changed = Some("sun.placement");
        }
        ui.vertical(|ui| {
            ui.horizontal_wrapped(|ui| {
                for (moment, hour) in Moment::ALL.into_iter().zip(hours(ui, &scene.sun)) {
                    let button = ui.add_enabled(hour.is_some(), egui::Button::new(moment.title()));
                    let hint = hour.map_or_else(|| "Not on this day at this place".to_owned(), clock);
                    if button.on_hover_text(&hint).on_disabled_hover_text(&hint).clicked()
                        && let Some(hour) = hour
                    {
                        scene.sun.placement = SunPlacement::Hour;
                        scene.sun.hour_h = hour;
                        changed = Some("sun.hour_h");
                    }
                }
                if ui.button("Now").on_hover_text("Day and hour of this machine’s clock").clicked()
                    && let Ok(now) = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH)
                {
                    scene.sun.set_clock(now.as_secs());
                    changed = Some("sun.hour_h");
                }
            });
            let near = |(_, latitude, longitude, _): &(&str, f32, f32, f32)| {
                (latitude - scene.sun.latitude_deg).abs() < 0.3 && (longitude - scene.sun.longitude_deg).abs() < 0.3
            };
            let name = CITIES.iter().find(|city| near(city)).map_or("Place…", |city| city.0);
            let combo = egui::ComboBox::from_id_salt("city").selected_text(name).width(110.0);
            let response = combo.show_ui(ui, |ui| {
                for (city, latitude, longitude, offset) in CITIES {
                    if ui.selectable_label(city == name, city).clicked() {
                        scene.sun.placement = SunPlacement::Hour;
                        (scene.sun.latitude_deg, scene.sun.longitude_deg) = (latitude, longitude);
                        scene.sun.utc_offset_h = offset;
                        changed = Some("sun.latitude_deg");
                    }
                }
            });
            row::name(ui, &response.response, "City", "sun.city");
            response.response.on_hover_text("Its latitude, longitude, and time zone");
            let saving = ui.checkbox(&mut scene.sun.daylight_saving, "Summer time");
            row::name(ui, &saving, "Daylight saving", "sun.daylight_saving.dial");
            if saving.on_hover_text("Clocks are an hour ahead").changed() {
                changed = Some("sun.daylight_saving");
            }
        });
    });
    changed
}

/// The hours of all moments, computed anew only for another day or place: each takes some hundred positions of the sun.
fn hours(ui: &Ui, sun: &Sun) -> [Option<f32>; Moment::ALL.len()] {
    let saved = f32::from(u8::from(sun.daylight_saving));
    let key = [sun.latitude_deg, sun.longitude_deg, sun.utc_offset_h, saved, sun.day as f32].map(f32::to_bits);
    let id = egui::Id::unique("hours of the sun");
    if let Some((known, hours)) = ui.data(|data| data.get_temp::<([u32; 5], [Option<f32>; 6])>(id))
        && known == key
    {
        return hours;
    }
    let hours = Moment::ALL.map(|moment| sun.hour_of(moment));
    ui.data_mut(|data| data.insert_temp(id, (key, hours)));
    hours
}

/// An hour as `6:05`.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "hours of a day")]
fn clock(hour: f32) -> String {
    let minutes = (hour * 60.0).round() as u32;
    format!("{}:{:02}", minutes / 60, minutes % 60)
}

/// The place of a direction on the dial.
fn place(centre: Pos2, radius: f32, elevation_deg: f32, azimuth_deg: f32) -> Pos2 {
    let share = ((90.0 - elevation_deg) / (90.0 + LOWEST_DEG)).clamp(0.0, 1.0);
    let (sine, cosine) = azimuth_deg.to_radians().sin_cos();
    centre + radius * share * Vec2::new(sine, -cosine)
}

/// The direction at a place of the dial: elevation and azimuth in degrees.
fn direction(offset: Vec2, radius: f32) -> (f32, f32) {
    let share = (offset.length() / radius).min(1.0);
    let azimuth = offset.x.atan2(-offset.y).to_degrees().rem_euclid(360.0);
    (90.0 - share * (90.0 + LOWEST_DEG), azimuth)
}

fn dial(ui: &mut Ui, scene: &mut Scene) -> bool {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::click_and_drag());
    row::name(ui, &response, "Sundial", "sundial");
    let towards = scene.towards_sun();
    let mut elevation = towards.y.clamp(-1.0, 1.0).asin().to_degrees();
    let mut azimuth = towards.x.atan2(-towards.z).to_degrees().rem_euclid(360.0);
    let radius = 0.5 * SIDE - 10.0;
    let centre = rect.center();
    let mut moved = false;
    if let Some(pointer) = response.interact_pointer_pos() {
        (elevation, azimuth) = direction(pointer - centre, radius);
        moved = true;
    }
    // Arrow keys turn it by a degree where it has the focus.
    if response.has_focus() {
        let filter = egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let step = |more, less| {
            ui.input(|input| f32::from(i8::from(input.key_pressed(more)) - i8::from(input.key_pressed(less))))
        };
        let turn = Vec2::new(
            step(egui::Key::ArrowRight, egui::Key::ArrowLeft),
            step(egui::Key::ArrowUp, egui::Key::ArrowDown),
        );
        if turn != Vec2::ZERO {
            azimuth = (azimuth + turn.x).rem_euclid(360.0);
            elevation = (elevation + turn.y).clamp(-90.0, 90.0);
            moved = true;
        }
    }
    if moved {
        scene.sun.placement = SunPlacement::Direction;
        (scene.sun.elevation_deg, scene.sun.azimuth_deg) = (elevation, azimuth);
    }
    paint(ui, rect, (centre, radius), (elevation, azimuth));
    response.on_hover_text(format!(
        "Elevation {elevation:.1}°, azimuth {azimuth:.1}°. Drag the sun; the ring is the horizon"
    ));
    moved
}

fn paint(ui: &Ui, rect: Rect, (centre, radius): (Pos2, f32), (elevation, azimuth): (f32, f32)) {
    let painter = ui.painter_at(rect);
    let horizon = radius * 90.0 / (90.0 + LOWEST_DEG);
    let visuals = ui.visuals();
    painter.circle_filled(centre, radius, visuals.extreme_bg_color);
    painter.circle_filled(centre, horizon, Color32::from_rgb(70, 110, 160));
    painter.circle_stroke(centre, horizon, Stroke::new(1.5, visuals.strong_text_color()));
    for height in [30.0_f32, 60.0] {
        let ring = radius * (90.0 - height) / (90.0 + LOWEST_DEG);
        painter.circle_stroke(centre, ring, Stroke::new(0.7, Color32::from_white_alpha(90)));
    }
    let font = egui::FontId::proportional(11.0);
    for (name, azimuth) in [("N", 0.0), ("E", 90.0), ("S", 180.0), ("W", 270.0)] {
        let at = centre + (place(centre, 1.0, -LOWEST_DEG, azimuth) - centre) * (radius + 5.0);
        painter.text(at, egui::Align2::CENTER_CENTER, name, font.clone(), visuals.text_color());
    }
    let at = place(centre, radius, elevation, azimuth);
    painter.line_segment([centre, at], Stroke::new(1.0, Color32::from_white_alpha(120)));
    let colour = if elevation > 0.0 { Color32::from_rgb(255, 224, 120) } else { Color32::from_rgb(190, 120, 70) };
    painter.circle(at, 6.0, colour, Stroke::new(1.5, Color32::BLACK));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dial_and_directions_agree() {
        let centre = Pos2::new(50.0, 60.0);
        for (elevation, azimuth) in [(42.0_f32, 235.0_f32), (0.0, 90.0), (-10.0, 359.0), (89.0, 12.0)] {
            let at = place(centre, 40.0, elevation, azimuth);
            let (seen, turned) = direction(at - centre, 40.0);
            assert!((seen - elevation).abs() < 0.01 && (turned - azimuth).abs() < 0.2, "{seen} {turned}");
        }
        assert!(place(centre, 40.0, 0.0, 90.0).x > centre.x, "east is to the right, as on a map");
        assert_eq!(clock(6.083), "6:05");
    }
}
