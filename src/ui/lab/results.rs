//! What was measured: plots, tables, choices from them, and the governor.

use egui::{Grid, RichText, ScrollArea, Ui};

use super::super::row;
use super::{LabState, LabView, Measured, chart};
use crate::app::action::Action;
use crate::app::document::Document;
use crate::lab::pareto::{self, Point};
use crate::lab::table::Table;

/// Draws all of it.
pub(super) fn show(ui: &mut Ui, state: &mut LabState, document: &Document, actions: &mut Vec<Action>) {
    let mut used = None;
    let timed = |view: &LabView| -> Vec<usize> {
        let all = view.settings.iter().enumerate();
        all.filter_map(|(index, setting)| setting.cost_ms.map(|_| index)).collect()
    };
    let places = timed(&state.view);
    for plot in &state.view.plots {
        ui.add_space(4.0);
        ui.add(egui::Label::new(RichText::new(&plot.title).strong()).wrap());
        let names: Vec<String> = places.iter().map(|index| state.view.settings[*index].name.clone()).collect();
        if let Some(point) = chart::show(ui, plot, &names) {
            used = places.get(point).copied();
        }
    }
    if !places.is_empty() {
        used = choices(ui, state).or(used);
    }
    if !state.view.settings.is_empty() {
        used = settings(ui, &state.view).or(used);
        governor(ui, state);
    }
    if let Some(setting) = used.and_then(|index| state.view.settings.get(index)) {
        let quality = Box::new(document.quality().with_march_of(&setting.quality));
        if *document.quality() != *quality {
            actions.push(Action::EditQuality { key: "lab".to_owned(), quality });
        }
    }
    tables(ui, &state.view.tables);
}

/// Two budgets, and a button each that takes the best setting within it.
fn choices(ui: &mut Ui, state: &mut LabState) -> Option<usize> {
    let all: Vec<(usize, Point)> = state
        .view
        .settings
        .iter()
        .enumerate()
        .filter_map(|(index, setting)| Some((index, Point { cost: setting.cost_ms?, error: setting.error })))
        .collect();
    let points: Vec<Point> = all.iter().map(|(_, point)| *point).collect();
    let mut choice = None;
    ui.horizontal_wrapped(|ui| {
        let cheapest = ui.button("Use the cheapest within");
        row::name(ui, &cheapest, "Use the cheapest", "lab.cheapest");
        ui.add(egui::DragValue::new(&mut state.budget.0).range(0.01..=1000.0).speed(0.1).suffix(" %"));
        let best = ui.button("Use the most accurate within");
        row::name(ui, &best, "Use the most accurate", "lab.most_accurate");
        ui.add(egui::DragValue::new(&mut state.budget.1).range(0.01..=100_000.0).speed(0.5).suffix(" ms"));
        if cheapest.clicked() {
            choice = pareto::cheapest_within_error(&points, state.budget.0 / 100.0);
        } else if best.clicked() {
            choice = pareto::most_accurate_within_cost(&points, state.budget.1);
        }
    });
    if let Some(choice) = choice {
        let setting = &state.view.settings[all[choice.index()].0];
        let figures = format!("{} ({})", setting.name, figures(setting));
        state.chosen = Some(match choice {
            pareto::Choice::Within(_) => format!("In use: {figures}"),
            pareto::Choice::Nearest(_) => format!("None keeps to that; nearest, and in use: {figures}"),
        });
    }
    if let Some(chosen) = &state.chosen {
        ui.add(egui::Label::new(RichText::new(chosen).weak()).wrap());
    }
    choice.map(|choice| all[choice.index()].0)
}

fn figures(setting: &Measured) -> String {
    let cost = setting.cost_ms.map_or_else(|| "not timed".to_owned(), |cost| format!("{cost:.1} ms"));
    format!("{:.2} %, {cost}", setting.error * 100.0)
}

/// Every setting with a button that takes it over.
fn settings(ui: &mut Ui, view: &LabView) -> Option<usize> {
    let mut used = None;
    ScrollArea::vertical().id_salt("lab settings").max_height(150.0).auto_shrink([false, true]).show(ui, |ui| {
        Grid::new("lab settings").num_columns(5).striped(true).spacing([14.0, 2.0]).show(ui, |ui| {
            for title in ["setting", "relRMSE", "march", "reads / ray", ""] {
                ui.strong(title);
            }
            ui.end_row();
            for (index, setting) in view.settings.iter().enumerate() {
                let name = RichText::new(&setting.name);
                ui.label(if setting.is_on_front { name.strong() } else { name });
                let spread = setting.std_error.map_or_else(String::new, |error| format!(" ± {:.2}", error * 100.0));
                ui.label(RichText::new(format!("{:.2}{spread} %", setting.error * 100.0)).monospace());
                let cost = setting.cost_ms.map_or_else(|| "…".to_owned(), |cost| format!("{cost:.1} ms"));
                ui.label(RichText::new(cost).monospace());
                ui.label(RichText::new(format!("{:.1}", setting.reads)).monospace());
                let button = ui.small_button("Use").on_hover_text("Takes this setting over");
                row::name(ui, &button, &format!("Use {}", setting.name), &format!("lab.use.{index}"));
                if button.clicked() {
                    used = Some(index);
                }
                ui.end_row();
            }
        });
    });
    ui.weak("Bold: on the front; no other is both cheaper and more accurate.");
    used
}

fn governor(ui: &mut Ui, state: &mut LabState) {
    let is_possible = state.view.front().len() > 1;
    ui.horizontal_wrapped(|ui| {
        let hint = "Moves along the measured front, so that a frame takes about so long, in place of the march’s settings in \
                    the quality panel. Motion is never dropped; at rest the picture refines by the panel’s settings.";
        let switch = ui.add_enabled(is_possible, egui::Checkbox::new(&mut state.governs, "Hold a frame at"));
        let switch = switch.on_hover_text(hint).on_disabled_hover_text("The front needs two settings at least");
        row::name(ui, &switch, "Governor", "lab.governor");
        let field = egui::DragValue::new(&mut state.frame_budget_ms).range(1.0..=10_000.0).speed(1.0).suffix(" ms");
        let field = ui.add_enabled(is_possible, field);
        row::name(ui, &field, "Frame budget", "lab.frame_budget");
        if let Some(said) = &state.view.governor {
            ui.weak(said);
        }
    });
}

fn tables(ui: &mut Ui, tables: &[Table]) {
    if tables.is_empty() {
        return;
    }
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        for title in ["Copy Markdown", "Copy CSV"] {
            let button = ui.button(title);
            row::name(ui, &button, title, &format!("lab.{}", title.to_lowercase().replace(' ', "_")));
            if button.clicked() {
                let form = if title == "Copy CSV" { Table::csv } else { Table::markdown };
                ui.ctx().copy_text(tables.iter().map(form).collect::<Vec<_>>().join("\n"));
            }
        }
    });
    for (index, table) in tables.iter().enumerate() {
        ui.add(egui::Label::new(RichText::new(&table.title).strong()).wrap());
        ScrollArea::horizontal().id_salt(("lab table", index)).auto_shrink([false, true]).show(ui, |ui| {
            Grid::new(("lab table", index)).striped(true).spacing([12.0, 2.0]).show(ui, |ui| {
                for title in &table.columns {
                    ui.add(egui::Label::new(RichText::new(*title).strong().size(11.0)).extend());
                }
                ui.end_row();
                for row in table.shown() {
                    for cell in row {
                        ui.add(egui::Label::new(RichText::new(cell).size(11.0)).extend());
                    }
                    ui.end_row();
                }
            });
        });
    }
}
