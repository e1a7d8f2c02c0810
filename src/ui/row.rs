//! The widgets of one row: label, control with unit and range, reset.

use std::ops::RangeInclusive;

use egui::{Align, DragValue, Id, Layout, Response, Slider, Ui, UiBuilder, Vec2};

use super::{clipboard, timeline};
use crate::app::preferences::Units;
use crate::scene::Strokes;
use crate::scene::expression::evaluate;
use crate::scene::param::{ChoiceInfo, Colour, FileName, Info, Unit, label};

/// Width of the number field, in points.
const NUMBER_WIDTH: f32 = 84.0;
/// Width of the reset button, in points.
const RESET_WIDTH: f32 = 18.0;
/// Ranges wider than this get no slider: nobody can hit anything on it.
const WIDEST_SLIDER: f64 = 90_000.0;

/// Remembers what lengths and speeds are shown in.
pub(super) fn note_units(ui: &Ui, units: Units) {
    ui.data_mut(|data| data.insert_temp(Id::unique("units"), units));
}

/// How numbers of a unit are shown here: what one of them is worth in the parameter's own, and what stands behind it.
fn shown_in(ui: &Ui, unit: Unit) -> (f64, &'static str) {
    let units = ui.data(|data| data.get_temp(Id::unique("units"))).unwrap_or(Units::Metric);
    match (units, unit) {
        (Units::Aviation, Unit::Metres) => (0.3048, " ft"),
        (Units::Aviation, Unit::MetresPerSecond) => (0.514_444, " kn"),
        _ => (1.0, unit.suffix()),
    }
}

/// A typed number in the parameter's own unit: one that names no unit is in what is shown.
fn typed(text: &str, unit: Unit, worth: f64) -> Option<f64> {
    let value = evaluate(text, unit)?;
    Some(if text.contains(|letter: char| letter.is_alphabetic()) { value } else { value * worth })
}

/// Names a widget for accessibility and tests; `key` identifies it among namesakes.
pub(super) fn name(ui: &Ui, response: &Response, name: &str, key: &str) {
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_label(name);
        node.set_author_id(key);
    });
}

/// What is said about a parameter when the pointer rests on its label.
struct Help<'i> {
    key: &'i str,
    doc: &'i str,
    range: Option<String>,
    default: String,
    /// Whether it can have keys, if it is of the sky.
    can_move: bool,
}

impl Help<'_> {
    fn text(&self) -> String {
        let range = self.range.as_ref().map(|range| format!("Range {range} · ")).unwrap_or_default();
        format!(
            "{}\n\n{range}Default {}\nKey {}\n\nBackspace resets, Ctrl+C and Ctrl+V copy and paste what the pointer is on, K sets a key",
            self.doc.trim(),
            self.default,
            self.key
        )
    }
}

/// Lays out a row: label on the left, reset on the right, the control in between. Returns whether either changed it.
fn frame(
    ui: &mut Ui,
    title: &str,
    help: &Help<'_>,
    modified: bool,
    control: impl FnOnce(&mut Ui) -> bool,
) -> RowResult {
    let mut result = RowResult::default();
    let height = ui.spacing().interact_size.y;
    let width = ui.available_width();
    let (rect, whole) = ui.allocate_exact_size(Vec2::new(width, height), egui::Sense::hover());
    let label_width = (width * 0.41).clamp(90.0, 200.0);
    let mut label_rect = rect;
    label_rect.set_width(label_width);
    let mut control_rect = rect;
    control_rect.min.x += label_width + 4.0;
    control_rect.max.x -= RESET_WIDTH + 4.0;
    let mut reset_rect = rect;
    reset_rect.min.x = rect.max.x - RESET_WIDTH;

    let mut label_ui = ui.new_child(UiBuilder::new().max_rect(label_rect).layout(Layout::left_to_right(Align::Center)));
    let text = egui::RichText::new(title);
    let text = match (timeline::is_keyed(ui, help.key), modified) {
        (true, _) => text.color(timeline::colour(ui)),
        (false, true) => text.color(ui.visuals().strong_text_color()),
        (false, false) => text,
    };
    let heading = label_ui.add(egui::Label::new(text).truncate().selectable(false).sense(egui::Sense::click()));
    name(ui, &heading, title, &format!("{}.label", help.key));
    let heading = heading.on_hover_ui(|ui| {
        ui.set_max_width(340.0);
        ui.label(help.text());
    });
    result.reset |= heading.double_clicked();
    let can_move = help.can_move && !help.key.starts_with("quality.");
    clipboard::menu(&heading, help.key, title, (modified, can_move), &mut result.reset);
    if whole.contains_pointer() {
        clipboard::note_pointed(ui, help.key);
        result.reset |= modified && clipboard::is_reset_pressed(ui);
    }
    let layout = Layout::left_to_right(Align::Center);
    let mut control_ui = ui.new_child(UiBuilder::new().id_salt(help.key).max_rect(control_rect).layout(layout));
    result.changed = control(&mut control_ui);
    let mut reset_ui = ui.new_child(UiBuilder::new().id_salt(("reset", help.key)).max_rect(reset_rect).layout(layout));
    let reset = reset_ui.add_enabled(modified, egui::Button::new("↺").frame(false).min_size(Vec2::splat(RESET_WIDTH)));
    let reset = reset.on_hover_text(format!("Reset to {}", help.default));
    name(ui, &reset, &format!("Reset {title}"), &format!("{}.reset", help.key));
    result.reset |= reset.clicked();
    result
}

/// What the user did in a row.
#[derive(Clone, Copy, Debug, Default)]
struct RowResult {
    changed: bool,
    reset: bool,
}

impl RowResult {
    /// Carries out the reset, and tells whether the value is another than before.
    fn settle<T: Clone>(self, value: &mut T, default: &T) -> bool {
        if self.reset {
            value.clone_from(default);
        }
        self.reset || self.changed
    }
}

/// A number as people write it: five significant digits, no trailing noughts.
#[allow(clippy::cast_possible_truncation, reason = "the magnitude of a double is within ±324")]
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor() as i32;
    let decimals = usize::try_from(4 - magnitude).unwrap_or(0).min(9);
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Everything a number's control needs to know.
struct Scale<'i> {
    title: &'i str,
    key: &'i str,
    unit: Unit,
    range: RangeInclusive<f64>,
    logarithmic: bool,
    whole: bool,
}

impl Scale<'_> {
    /// The nearest round number: with Ctrl held, controls go from one to the next.
    fn snapped(&self, value: f64) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let near = if self.logarithmic { value.abs() } else { (high - low) / 4.0 };
        if self.whole || near <= 0.0 || !near.is_finite() {
            return value;
        }
        let step = 0.5 * 10.0_f64.powf(near.log10().floor());
        ((value / step).round() * step).clamp(low, high)
    }
}

/// Slider and field for one number.
fn number_control(ui: &mut Ui, scale: &Scale<'_>, value: &mut f64) -> bool {
    let (low, high) = (*scale.range.start(), *scale.range.end());
    let with_slider = scale.logarithmic || high - low < WIDEST_SLIDER;
    let mut changed = false;
    if with_slider {
        ui.spacing_mut().slider_width = (ui.available_width() - NUMBER_WIDTH - 6.0).max(24.0);
        let mut slider = Slider::new(value, scale.range.clone()).show_value(false).logarithmic(scale.logarithmic);
        if scale.logarithmic {
            slider = slider.smallest_positive(if low > 0.0 { low } else { high * 1e-6 });
        }
        if scale.whole {
            slider = slider.step_by(1.0);
        }
        let response = ui.add(slider);
        name(ui, &response, scale.title, scale.key);
        changed |= response.changed();
        if response.dragged() && ui.input(|input| input.modifiers.command) {
            *value = scale.snapped(*value);
        }
    }
    let speed = if scale.whole {
        ((high - low) / 400.0).clamp(0.02, 20.0)
    } else if scale.logarithmic || !with_slider {
        value.abs().max(high * 1e-6) * 0.01
    } else {
        (high - low) / 500.0
    };
    let (whole, unit) = (scale.whole, scale.unit);
    let (worth, suffix) = shown_in(ui, unit);
    let field = DragValue::new(value)
        .range(scale.range.clone())
        .speed(speed)
        .suffix(suffix)
        .update_while_editing(false)
        .custom_formatter(move |value, _| if whole { format!("{value:.0}") } else { number(value / worth) })
        .custom_parser(move |text| typed(text, unit, worth));
    let width = if with_slider { NUMBER_WIDTH } else { ui.available_width() };
    let response = ui.add_sized([width.min(ui.available_width()), ui.spacing().interact_size.y], field);
    name(ui, &response, &format!("{} value", scale.title), &format!("{}.value", scale.key));
    if response.dragged() && ui.input(|input| input.modifiers.command) {
        *value = scale.snapped(*value);
    }
    changed | response.changed()
}

/// A row for a number.
#[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
pub(super) fn float(ui: &mut Ui, key: &str, info: &Info<f32>, value: &mut f32) -> bool {
    let title = info.label();
    let (worth, suffix) = shown_in(ui, info.unit);
    let range = info.range.clone().unwrap_or(f32::MIN..=f32::MAX);
    let (low, high) = (f64::from(*range.start()), f64::from(*range.end()));
    let show = |value: f32| format!("{}{suffix}", number(f64::from(value) / worth));
    let shown_range = info.range.as_ref().map(|range| format!("{} to {}", show(*range.start()), show(*range.end())));
    let help = Help { key, doc: info.doc, range: shown_range, default: show(info.default), can_move: true };
    let scale =
        Scale { title: &title, key, unit: info.unit, range: low..=high, logarithmic: info.logarithmic, whole: false };
    let result = frame(ui, &title, &help, *value != info.default, |ui| {
        let mut wide = f64::from(*value);
        let changed = number_control(ui, &scale, &mut wide);
        if changed {
            *value = (wide as f32).clamp(*range.start(), *range.end());
        }
        changed
    });
    result.settle(value, &info.default)
}

/// A row for a whole number.
#[allow(clippy::cast_possible_truncation, reason = "clamped to the parameter's range")]
pub(super) fn count(ui: &mut Ui, key: &str, info: &Info<u32>, value: &mut u32) -> bool {
    let title = info.label();
    let suffix = info.unit.suffix();
    let range = info.range.clone().unwrap_or(0..=u32::MAX);
    let shown_range = info.range.as_ref().map(|range| format!("{} to {}{suffix}", range.start(), range.end()));
    let help =
        Help { key, doc: info.doc, range: shown_range, default: format!("{}{suffix}", info.default), can_move: true };
    let wide = f64::from(*range.start())..=f64::from(*range.end());
    let scale = Scale { title: &title, key, unit: info.unit, range: wide, logarithmic: info.logarithmic, whole: true };
    let result = frame(ui, &title, &help, *value != info.default, |ui| {
        let mut wide = f64::from(*value);
        let changed = number_control(ui, &scale, &mut wide);
        if changed {
            *value = (wide.round() as u32).clamp(*range.start(), *range.end());
        }
        changed
    });
    result.settle(value, &info.default)
}

/// A row for on or off.
pub(super) fn switch(ui: &mut Ui, key: &str, info: &Info<bool>, value: &mut bool) -> bool {
    let title = info.label();
    let word = |on| if on { "on" } else { "off" };
    let help = Help { key, doc: info.doc, range: None, default: word(info.default).to_owned(), can_move: true };
    let result = frame(ui, &title, &help, *value != info.default, |ui| {
        let response = ui.checkbox(value, "");
        name(ui, &response, &title, key);
        response.changed()
    });
    result.settle(value, &info.default)
}

/// A row for one of several named values.
pub(super) fn choice(ui: &mut Ui, key: &str, info: &ChoiceInfo, index: &mut usize) -> bool {
    let title = label(info.name);
    let option = |index: usize| info.options.get(index).copied().unwrap_or(["", "?", ""]);
    let help = Help { key, doc: info.doc, range: None, default: option(info.default)[1].to_owned(), can_move: true };
    let result = frame(ui, &title, &help, *index != info.default, |ui| {
        let before = *index;
        let width = ui.available_width();
        let combo = egui::ComboBox::from_id_salt(key).width(width).truncate().selected_text(option(*index)[1]);
        let response = combo.show_ui(ui, |ui| {
            for (candidate, [_, title, doc]) in info.options.iter().enumerate() {
                ui.selectable_value(index, candidate, *title).on_hover_text(doc.trim());
            }
        });
        name(ui, &response.response, &title, key);
        response.response.on_hover_text(option(*index)[2].trim());
        *index != before
    });
    result.settle(index, &info.default)
}

/// A row for a linear colour: a swatch for the hue and three fields for the numbers, which may exceed 1.
pub(super) fn colour(ui: &mut Ui, key: &str, info: &Info<Colour>, value: &mut Colour) -> bool {
    let title = info.label();
    let words = |colour: Colour| format!("{}, {}, {}", colour.0, colour.1, colour.2);
    let help = Help {
        key,
        doc: info.doc,
        range: Some("linear Rec.709, 0 to 100".to_owned()),
        default: words(info.default),
        can_move: true,
    };
    let result = frame(ui, &title, &help, *value != info.default, |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().interact_size.x = 24.0;
        ui.spacing_mut().button_padding.x = 2.0;
        let peak = value.0.max(value.1).max(value.2).max(1.0);
        let mut shown = [value.0 / peak, value.1 / peak, value.2 / peak];
        let swatch = ui.color_edit_button_rgb(&mut shown).on_hover_text("Pick a colour");
        name(ui, &swatch, &title, key);
        let mut changed = swatch.changed();
        if changed {
            *value = Colour(shown[0] * peak, shown[1] * peak, shown[2] * peak);
        }
        let width = ((ui.available_width() - 6.0) / 3.0).max(24.0);
        let channels = [("red", &mut value.0), ("green", &mut value.1), ("blue", &mut value.2)];
        for (channel, component) in channels {
            let field = DragValue::new(component)
                .range(0.0..=100.0)
                .speed(0.005)
                .update_while_editing(false)
                .custom_formatter(|value, _| number((value * 1000.0).round() / 1000.0))
                .custom_parser(|text| evaluate(text, Unit::None));
            let response = ui.add_sized([width, ui.spacing().interact_size.y], field);
            name(ui, &response, &format!("{title}, {channel}"), &format!("{key}.{channel}"));
            changed |= response.changed();
        }
        changed
    });
    result.settle(value, &info.default)
}

/// A row for what was painted: how much it is.
pub(super) fn strokes(ui: &mut Ui, key: &str, info: &Info<Strokes>, value: &mut Strokes) -> bool {
    let help = Help { key, doc: info.doc, range: None, default: "none".to_owned(), can_move: false };
    let result = frame(ui, &info.label(), &help, *value != info.default, |ui| {
        let response = match value.0.len() {
            0 => ui.weak("none: P paints"),
            count => ui.label(format!("{count}, of {} dabs", value.dabs())),
        };
        name(ui, &response, &info.label(), key);
        false
    });
    result.settle(value, &info.default)
}

/// A row for a file: its path, taken over with Enter or on leaving the field, and a button for the file dialog.
pub(super) fn file(ui: &mut Ui, key: &str, (info, value): (&Info<FileName>, &mut FileName), browse: &mut bool) -> bool {
    let title = info.label();
    let help = Help { key, doc: info.doc, range: None, default: "none".to_owned(), can_move: false };
    let result = frame(ui, &title, &help, *value != info.default, |ui| {
        let id = ui.make_persistent_id(("path", key));
        let kept: Option<String> = ui.data(|data| data.get_temp(id));
        let mut text = kept.unwrap_or_else(|| value.0.clone());
        let width = ui.available_width() - 30.0;
        let edit = egui::TextEdit::singleline(&mut text).id(id).hint_text("path").desired_width(width.max(30.0));
        let response = ui.add(edit);
        name(ui, &response, &title, key);
        let mut changed = false;
        if response.has_focus() {
            ui.data_mut(|data| data.insert_temp(id, text));
        } else if response.lost_focus() {
            ui.data_mut(|data| data.remove::<String>(id));
            changed = text != value.0;
            value.0 = text;
        }
        let button = ui.button("…").on_hover_text("Browse");
        name(ui, &button, &format!("Browse {title}"), &format!("{key}.browse"));
        *browse = button.clicked();
        changed
    });
    result.settle(value, &info.default)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_exact_enough() {
        for (value, text) in
            [(1200.0, "1200"), (0.00032, "0.00032"), (0.1 + 0.2, "0.3"), (6_360_000.0, "6360000"), (-3.5, "-3.5")]
        {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn snapped_values_are_round() {
        let scale = |range: RangeInclusive<f64>, logarithmic| Scale {
            title: "",
            key: "",
            unit: Unit::None,
            range,
            logarithmic,
            whole: false,
        };
        assert_eq!(scale(0.0..=1.0, false).snapped(0.437), 0.45);
        assert_eq!(scale(0.0..=360.0, false).snapped(137.0), 135.0);
        assert_eq!(scale(1.0..=1000.0, true).snapped(437.0), 450.0);
        assert_eq!(scale(0.0..=1.0, true).snapped(0.0), 0.0);
    }
}
