//! The timeline: a ruler to scrub on, and the keys of every parameter that has some.

use egui::{Align2, Color32, FontId, Id, Key, Pos2, Rect, Response, ScrollArea, Sense, Stroke, Ui, Vec2};

use super::row;
use crate::app::action::Action;
use crate::app::document::Document;
use crate::scene::expression::evaluate;
use crate::scene::param::{Choice as _, Unit};
use crate::scene::{Animation, DURATION_RANGE_SECS, Ease, Track};

/// Width of the names left of the tracks, in points.
const NAMES: f32 = 150.0;
/// Height of the ruler and of a track, in points.
const LINE: f32 = 20.0;
/// Half the width of a key, in points.
const KEY: f32 = 5.0;
/// Free space left and right of the ruler, so that the first and the last key can be seen, in points.
const MARGIN: f32 = 9.0;
/// Films of a day: seconds of film, and how many times faster than life clouds go.
const DAYS: [(f64, f64); 3] = [(10.0, 60.0), (20.0, 30.0), (60.0, 10.0)];

/// The timeline's state.
#[derive(Clone, Debug, Default)]
pub struct TimelineState {
    /// Whether it is there.
    pub is_open: bool,
    /// The key that was chosen: its parameter and its number.
    chosen: Option<(String, usize)>,
}

/// The colour of keys and of what has them.
pub(super) fn colour(ui: &Ui) -> Color32 {
    if ui.visuals().dark_mode { Color32::from_rgb(240, 190, 90) } else { Color32::from_rgb(160, 95, 0) }
}

fn keyed_id() -> Id {
    Id::unique("parameters with keys")
}

/// Notes for the rows of the panel which parameters have keys.
pub(super) fn note_keyed(ui: &Ui, animation: &Animation) {
    let keys: std::sync::Arc<[String]> = animation.tracks.iter().map(|track| track.key.clone()).collect();
    ui.data_mut(|data| data.insert_temp(keyed_id(), keys));
}

/// Whether a parameter has keys.
pub(super) fn is_keyed(ui: &Ui, key: &str) -> bool {
    let keys: Option<std::sync::Arc<[String]>> = ui.data(|data| data.get_temp(keyed_id()));
    keys.is_some_and(|keys| keys.iter().any(|known| known == key))
}

/// Where times lie on the screen.
#[derive(Clone, Copy, Debug)]
struct Scale {
    left: f32,
    width: f32,
    duration_secs: f64,
}

#[allow(clippy::cast_possible_truncation, reason = "points of the screen")]
impl Scale {
    fn of(strip: Rect, duration_secs: f64) -> Self {
        Self { left: strip.left() + MARGIN, width: (strip.width() - 2.0 * MARGIN).max(1.0), duration_secs }
    }

    fn x(self, time_secs: f64) -> f32 {
        self.left + self.width * (time_secs / self.duration_secs).clamp(0.0, 1.0) as f32
    }

    fn time_secs(self, x: f32) -> f64 {
        f64::from((x - self.left) / self.width).clamp(0.0, 1.0) * self.duration_secs
    }

    /// The distance of marks that leaves each some room: 1, 2 or 5 of a power of ten, or minutes and hours.
    fn step_secs(self) -> f64 {
        let least = self.duration_secs * f64::from(70.0 / self.width.max(70.0));
        let clock = [60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0, 7200.0, 21_600.0, 86_400.0];
        if least > 30.0
            && let Some(step) = clock.into_iter().find(|step| *step >= least)
        {
            return step;
        }
        let power = 10.0_f64.powf(least.max(1e-3).log10().floor());
        [1.0, 2.0, 5.0].into_iter().map(|factor| factor * power).find(|step| *step >= least).unwrap_or(10.0 * power)
    }
}

/// A time as people write it: `12.5 s`, or `1:02:30` where there are minutes.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "centuries fit")]
fn clock(seconds: f64) -> String {
    if seconds < 60.0 {
        return format!("{} s", row::number((seconds * 100.0).round() / 100.0));
    }
    let whole = seconds.round() as u64;
    match whole / 3600 {
        0 => format!("{}:{:02}", whole / 60, whole % 60),
        hours => format!("{hours}:{:02}:{:02}", whole / 60 % 60, whole % 60),
    }
}

/// Draws the timeline.
pub(super) fn show(ui: &mut Ui, state: &mut TimelineState, document: &Document, actions: &mut Vec<Action>) {
    let animation = document.animation();
    if state
        .chosen
        .as_ref()
        .is_some_and(|(key, index)| animation.track(key).is_none_or(|track| *index >= track.keys.len()))
    {
        state.chosen = None;
    }
    ui.horizontal_wrapped(|ui| header(ui, state, document, actions));
    let area = ui.available_rect_before_wrap();
    let strip = Rect::from_min_max(
        Pos2::new(area.left() + NAMES, area.top()),
        Pos2::new(area.right() - 10.0, area.top() + LINE),
    );
    let scale = Scale::of(strip, animation.duration_secs);
    ruler(ui, strip, scale, document, actions);
    ui.allocate_space(Vec2::new(1.0, LINE));
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for track in &animation.tracks {
            self::track(ui, (state, animation), (track, scale), actions);
        }
        if animation.tracks.is_empty() {
            ui.add_space(4.0);
            ui.weak("Nothing has keys yet. Right-click a parameter’s name, or point at it and press K; or choose a time-lapse.");
        }
    });
    let x = scale.x(document.time_secs());
    let rows = animation.tracks.len() as f32;
    let line = egui::Rangef::new(strip.top(), (strip.bottom() + 4.0 + LINE * rows).min(area.bottom()));
    ui.painter_at(area).vline(x, line, Stroke::new(1.5, colour(ui)));
}

/// Time, length, and what to do with the chosen key.
fn header(ui: &mut Ui, state: &mut TimelineState, document: &Document, actions: &mut Vec<Action>) {
    let animation = document.animation();
    let edit = |step: &str, animation: Animation| Action::EditAnimation {
        step: step.to_owned(),
        animation: Box::new(animation),
    };
    let seconds = |ui: &mut Ui, mut value: f64, range: std::ops::RangeInclusive<f64>, (name, key): (&str, &str)| {
        let field = egui::DragValue::new(&mut value)
            .range(range)
            .speed(animation.duration_secs / 300.0)
            .suffix(" s")
            .update_while_editing(false)
            .custom_formatter(|value, _| row::number(value))
            .custom_parser(|text| evaluate(text, Unit::Seconds));
        let response = ui.add(field).on_hover_text(name);
        row::name(ui, &response, name, key);
        response.changed().then_some(value)
    };
    ui.label("Time");
    let whole = 0.0..=animation.duration_secs.max(document.time_secs());
    if let Some(time) = seconds(ui, document.time_secs(), whole, ("Time since the scene began", "timeline.time")) {
        actions.push(Action::Seek(time));
    }
    ui.label("of");
    let length = ("Length of the film, in seconds of the scene", "timeline.duration");
    if let Some(duration_secs) = seconds(ui, animation.duration_secs, DURATION_RANGE_SECS, length) {
        actions.push(edit("set the film’s length", Animation { duration_secs, ..animation.clone() }));
    }
    let mut repeats = animation.repeats;
    if ui.checkbox(&mut repeats, "Repeat").on_hover_text("Begin anew at the end, rather than stop").changed() {
        actions.push(edit("repeat", Animation { repeats, ..animation.clone() }));
    }
    ui.menu_button("Time-lapse", |ui| {
        ui.set_min_width(220.0);
        for (film_secs, speed) in DAYS {
            let title = format!("Dawn to dusk in {film_secs} s, clouds ×{speed}");
            if ui.button(title).clicked() {
                actions.push(Action::DayLapse { film_secs, speed });
                ui.close();
            }
        }
    })
    .response
    .on_hover_text("The sun on its day at its place (section Sun)");
    let Some((key, index)) = state.chosen.clone() else { return };
    let Some(track) = animation.track(&key) else { return };
    let Some(chosen) = track.keys.get(index) else { return };
    ui.separator();
    ui.label(format!("{} at {}: {}", name_of(&key), clock(chosen.time_secs), chosen.value));
    for ease in Ease::ALL {
        let is_so = chosen.ease == *ease;
        if ui.selectable_label(is_so, ease.title()).on_hover_text(ease.doc().trim()).clicked() && !is_so {
            actions.push(edit("change a key’s ease", with_ease(animation, (&key, index), *ease)));
        }
    }
    if ui.button("Delete").on_hover_text("Takes this key away (Delete)").clicked() {
        actions.push(edit("delete a key", without(animation, (&key, index))));
        state.chosen = None;
    }
}

fn with_ease(animation: &Animation, (key, index): (&str, usize), ease: Ease) -> Animation {
    let mut edited = animation.clone();
    if let Some(track) = edited.tracks.iter_mut().find(|track| track.key == key)
        && let Some(keyframe) = track.keys.get_mut(index)
    {
        keyframe.ease = ease;
    }
    edited
}

fn without(animation: &Animation, (key, index): (&str, usize)) -> Animation {
    let mut edited = animation.clone();
    edited.remove_key(key, index);
    edited
}

/// A parameter's key for people: `layers.0.base_m` becomes `Layers 1 Base`.
fn name_of(key: &str) -> String {
    let mut parts: Vec<String> = key
        .split('.')
        .map(|part| match part.parse::<usize>() {
            Ok(index) => (index + 1).to_string(),
            Err(_) => crate::scene::param::label(part),
        })
        .collect();
    let last = parts.pop().unwrap_or_default();
    if parts.is_empty() { last } else { format!("{} · {last}", parts.join(" ")) }
}

fn ruler(ui: &Ui, strip: Rect, scale: Scale, document: &Document, actions: &mut Vec<Action>) {
    let response = ui.interact(strip, ui.scope_id().with("ruler"), Sense::click_and_drag());
    row::name(ui, &response, "Time ruler", "timeline.ruler");
    if response.clicked() {
        response.request_focus();
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        actions.push(Action::Seek(scale.time_secs(at.x)));
    }
    if let Some(steps) = arrows(ui, &response) {
        let time = document.time_secs() + steps * document.animation().duration_secs * 0.01;
        actions.push(Action::Seek(time.clamp(0.0, scale.duration_secs)));
    }
    let painter = ui.painter_at(strip);
    let visuals = ui.visuals();
    painter.rect_filled(strip, 2.0, visuals.extreme_bg_color);
    let step = scale.step_secs();
    let mut time = 0.0;
    while time <= scale.duration_secs {
        let x = scale.x(time);
        painter.vline(x, strip.y_range(), Stroke::new(1.0, visuals.weak_text_color()));
        let font = FontId::proportional(11.0);
        let at = Pos2::new(x + 3.0, strip.center().y);
        let galley = painter.layout_no_wrap(clock(time), font, visuals.text_color());
        if at.x + galley.size().x < strip.right() {
            painter.galley(Align2::LEFT_CENTER.anchor_size(at, galley.size()).min, galley, visuals.text_color());
        }
        time += step;
    }
    if response.has_focus() {
        painter.rect_stroke(strip, 2.0, visuals.selection.stroke, egui::StrokeKind::Inside);
    }
}

/// Steps to the right that the arrow keys ask of what has the focus.
fn arrows(ui: &Ui, response: &Response) -> Option<f64> {
    if !response.has_focus() {
        return None;
    }
    let filter = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let pressed = |key| f64::from(u8::from(ui.input(|input| input.key_pressed(key))));
    let steps = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
    (steps != 0.0).then_some(steps)
}

fn track(
    ui: &mut Ui,
    (state, animation): (&mut TimelineState, &Animation),
    (track, scale): (&Track, Scale),
    actions: &mut Vec<Action>,
) {
    let edit = |step: String, edited: Animation| Action::EditAnimation { step, animation: Box::new(edited) };
    let title = name_of(&track.key);
    let (line, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), LINE), Sense::hover());
    let name_rect = Rect::from_min_max(line.min, Pos2::new(line.left() + NAMES - 24.0, line.bottom()));
    let middle = egui::Layout::left_to_right(egui::Align::Center);
    let mut names =
        ui.new_child(egui::UiBuilder::new().id_salt(("name", &track.key)).max_rect(name_rect).layout(middle));
    names.add(egui::Label::new(title.as_str()).truncate()).on_hover_text(track.key.as_str());
    let remove_rect = Rect::from_center_size(Pos2::new(line.left() + NAMES - 14.0, line.center().y), Vec2::splat(18.0));
    let mut removal =
        ui.new_child(egui::UiBuilder::new().id_salt(("remove", &track.key)).max_rect(remove_rect).layout(middle));
    let remove =
        removal.add(egui::Button::new("×").frame(false)).on_hover_text(format!("Take all keys of {title} away"));
    row::name(ui, &remove, &format!("Remove the keys of {title}"), &format!("{}.keys.remove", track.key));
    if remove.clicked() {
        let mut edited = animation.clone();
        edited.tracks.retain(|other| other.key != track.key);
        actions.push(edit(format!("remove the keys of {}", track.key), edited));
    }
    let painter = ui.painter_at(ui.clip_rect());
    let ends = egui::Rangef::new(scale.left, scale.left + scale.width);
    painter.hline(ends, line.center().y, Stroke::new(1.0, ui.visuals().weak_text_color()));
    for (index, keyframe) in track.keys.iter().enumerate() {
        // Keys beyond the end lie at it.
        let at = Pos2::new(scale.x(keyframe.time_secs), line.center().y);
        let id = ui.scope_id().with((&track.key, index));
        let response = ui.interact(Rect::from_center_size(at, Vec2::splat(3.0 * KEY)), id, Sense::click_and_drag());
        row::name(
            ui,
            &response,
            &format!("Key {} of {title} at {}", index + 1, clock(keyframe.time_secs)),
            &format!("{}.keys.{index}", track.key),
        );
        if response.clicked() || response.drag_started() {
            response.request_focus();
            state.chosen = Some((track.key.clone(), index));
            if response.clicked() {
                actions.push(Action::Seek(keyframe.time_secs));
            }
        }
        let moved = match response.interact_pointer_pos().filter(|_| response.dragged()) {
            Some(pointer) => Some(scale.time_secs(pointer.x)),
            None => arrows(ui, &response).map(|steps| keyframe.time_secs + steps * scale.duration_secs * 0.01),
        };
        if let Some(time) = moved {
            let mut edited = animation.clone();
            edited.move_key(&track.key, index, time);
            actions.push(edit(format!("move a key of {}", track.key), edited));
        }
        let is_chosen = state.chosen.as_ref().is_some_and(|(key, at)| *key == track.key && *at == index);
        if response.has_focus() && ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Delete)) {
            actions.push(edit("delete a key".to_owned(), without(animation, (&track.key, index))));
        }
        paint_key(ui, &painter, at, (keyframe.ease, is_chosen || response.hovered()));
        response.on_hover_text(format!("{}: {}", clock(keyframe.time_secs), keyframe.value));
    }
}

/// A key: round where the way goes on smoothly, pointed where it goes evenly, square where it holds.
fn paint_key(ui: &Ui, painter: &egui::Painter, at: Pos2, (ease, is_lit): (Ease, bool)) {
    let fill = if is_lit { ui.visuals().strong_text_color() } else { colour(ui) };
    let rim = Stroke::new(1.0, ui.visuals().extreme_bg_color);
    match ease {
        Ease::Smooth => {
            painter.circle(at, KEY, fill, rim);
        }
        Ease::Linear => {
            let corners = [Vec2::X, Vec2::Y, -Vec2::X, -Vec2::Y].map(|corner| at + 1.3 * KEY * corner);
            painter.add(egui::Shape::convex_polygon(corners.to_vec(), fill, rim));
        }
        Ease::Hold => {
            painter.rect(Rect::from_center_size(at, Vec2::splat(1.8 * KEY)), 0.0, fill, rim, egui::StrokeKind::Inside);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_have_room_and_times_are_found_where_they_are_drawn() {
        let strip = Rect::from_min_size(Pos2::new(100.0, 0.0), Vec2::new(600.0, LINE));
        for duration in [0.1, 1.0, 30.0, 61.0, 600.0, 86_400.0, 1e7] {
            let scale = Scale::of(strip, duration);
            let marks = duration / scale.step_secs();
            assert!((1.0..=9.0).contains(&marks) || duration > 1e6, "{marks} marks on {duration} s");
            for share in [0.0, 0.3, 1.0] {
                let time = share * duration;
                assert!((scale.time_secs(scale.x(time)) - time).abs() < 1e-4 * duration, "{time} of {duration}");
            }
        }
        assert_eq!((clock(12.5), clock(61.0), clock(3725.0)), ("12.5 s".into(), "1:01".into(), "1:02:05".into()));
        assert_eq!(name_of("layers.0.base_m"), "Layers 1 · Base");
    }
}
