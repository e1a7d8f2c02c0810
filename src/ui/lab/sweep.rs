//! What a sweep is to measure.

use egui::Ui;

use super::super::row;
use crate::app::action::Order;
use crate::lab::accuracy::{Axis, settings};
use crate::lab::sweep::goals;
use crate::scene::Quality;

/// One axis as it is typed.
#[derive(Clone, Debug)]
struct AxisForm {
    key: &'static str,
    values: String,
}

/// Parameters that are worth a sweep, with values to begin with.
const OFFERED: [(&str, &str); 10] = [
    ("light_steps", "4, 6, 8, 12, 16, 20, 28, 40"),
    ("step_m", "20, 35, 50, 80, 120"),
    ("step_growth", "0.002, 0.004, 0.0055, 0.008, 0.012"),
    ("step_depth", "0.5, 1, 2.5, 5"),
    ("view_steps", "32, 64, 96, 160"),
    ("light_growth", "1, 1.05, 1.08, 1.15, 1.3"),
    ("octaves", "0, 1, 3, 5"),
    ("empty_stride", "1, 1.3, 2, 3"),
    ("early_exit", "0, 0.005, 0.02, 0.05"),
    ("detail_distance_m", "10000, 50000, 150000"),
];

/// Relative error at which a truth is good enough.
const TOLERANCE: f32 = 0.005;
/// Sizes to measure at.
const SIZES: [[u32; 2]; 3] = [[128, 72], [256, 144], [512, 288]];

/// Everything that a sweep is asked for.
#[derive(Clone, Debug)]
pub(super) struct SweepForm {
    axes: Vec<AxisForm>,
    against: [bool; 2],
    size: usize,
    rounds: u32,
    samples: u32,
}

impl Default for SweepForm {
    fn default() -> Self {
        let [(key, values), ..] = OFFERED;
        let axes = vec![AxisForm { key, values: values.to_owned() }];
        Self { axes, against: [true, false], size: 0, rounds: 15, samples: 64 }
    }
}

/// Draws the form; returns what it asks for, or what is wrong with it.
pub(super) fn show(ui: &mut Ui, form: &mut SweepForm, quality: &Quality) -> Result<Order, String> {
    let mut gone = None;
    let count = form.axes.len();
    for (index, axis) in form.axes.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            let combo = egui::ComboBox::from_id_salt(("lab axis", index)).selected_text(axis.key).width(140.0);
            let combo = combo.show_ui(ui, |ui| {
                for (key, values) in OFFERED {
                    if ui.selectable_label(axis.key == key, key).clicked() {
                        (axis.key, axis.values) = (key, values.to_owned());
                    }
                }
            });
            row::name(ui, &combo.response, "Parameter", &format!("lab.axis.{index}.key"));
            let width = (ui.available_width() - 30.0).max(80.0);
            let edit = ui.add(egui::TextEdit::singleline(&mut axis.values).desired_width(width));
            row::name(ui, &edit, &format!("Values of {}", axis.key), &format!("lab.axis.{index}"));
            let remove = ui.add_enabled(count > 1, egui::Button::new("×")).on_hover_text("Leave this axis out");
            row::name(ui, &remove, "Remove axis", &format!("lab.axis.{index}.remove"));
            if remove.clicked() {
                gone = Some(index);
            }
        });
    }
    if let Some(index) = gone {
        form.axes.remove(index);
    }
    ui.horizontal_wrapped(|ui| {
        let used = |form: &SweepForm, key: &str| form.axes.iter().any(|axis| axis.key == key);
        let next = OFFERED.into_iter().find(|(key, _)| !used(form, key));
        let more = ui.add_enabled(form.axes.len() < 3 && next.is_some(), egui::Button::new("+ Axis"));
        let more = more.on_hover_text("All combinations of the axes’ values are measured");
        row::name(ui, &more, "Add axis", "lab.axis.add");
        if let (true, Some((key, values))) = (more.clicked(), next) {
            form.axes.push(AxisForm { key, values: values.to_owned() });
        }
        ui.label("against");
        ui.checkbox(&mut form.against[0], "converged");
        ui.checkbox(&mut form.against[1], "path traced");
        if form.against[1] {
            let paths = ui.add(egui::DragValue::new(&mut form.samples).range(8..=4096).suffix(" paths"));
            row::name(ui, &paths, "Paths of each pixel", "lab.samples");
        }
    });
    ui.horizontal_wrapped(|ui| {
        for (index, [width, height]) in SIZES.into_iter().enumerate() {
            let chosen = ui.selectable_label(form.size == index, format!("{width}×{height}"));
            if chosen.clicked() {
                form.size = index;
            }
        }
        super::rounds(ui, &mut form.rounds);
    });
    order(form, quality)
}

fn order(form: &SweepForm, quality: &Quality) -> Result<Order, String> {
    let axes = form.axes.iter().map(|axis| Axis::parse(&format!("quality.{}={}", axis.key, axis.values)));
    let axes = axes.collect::<Result<Vec<_>, _>>().map_err(|error| error.to_string())?;
    let settings = settings(quality, &axes).map_err(|error| error.to_string())?;
    let goals = goals(TOLERANCE, form.against[0], form.against[1].then_some(form.samples));
    if goals.is_empty() {
        return Err("There is nothing to measure against; choose converged, path traced, or both.".to_owned());
    }
    Ok(Order::Sweep { settings, goals, size: SIZES[form.size], rounds: form.rounds })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_offered_can_be_measured() {
        for (key, values) in OFFERED {
            let form = SweepForm { axes: vec![AxisForm { key, values: values.to_owned() }], ..SweepForm::default() };
            assert!(order(&form, &Quality::default()).is_ok(), "{key}: {:?}", order(&form, &Quality::default()));
        }
        let wrong = |values: &str| {
            let axes = vec![AxisForm { key: "light_steps", values: values.to_owned() }];
            order(&SweepForm { axes, ..SweepForm::default() }, &Quality::default()).expect_err(values)
        };
        assert!(wrong("0").contains("outside 1 ..= 128") && wrong("x").contains("whole number"), "named");
        assert!(wrong("").contains("form"), "{}", wrong(""));
        let blind = SweepForm { against: [false; 2], ..SweepForm::default() };
        assert!(order(&blind, &Quality::default()).is_err(), "no truth");
    }
}
