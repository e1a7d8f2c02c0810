//! The timing overlay: what each pass costs, where the numbers come from, and what the plan decided.

use egui::{Grid, Id, Rect, RichText, ScrollArea, Ui};

use super::LabState;
use crate::plan::{Forced, Verdict};

/// One pass with its time.
#[derive(Clone, Debug, PartialEq)]
pub struct PassLine {
    /// Name of the pass.
    pub pass: &'static str,
    /// Median over the last frames, in milliseconds; `None` where nothing usable was measured.
    pub median_ms: Option<f64>,
}

/// Everything the overlay shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readout {
    /// Adapter, driver and interface.
    pub adapter: String,
    /// Where the times of the passes come from.
    pub source: &'static str,
    /// The passes of the last frames.
    pub passes: Vec<PassLine>,
    /// Median of whole frames, in milliseconds.
    pub total_ms: Option<f64>,
    /// Over how many frames the medians run.
    pub frames: usize,
    /// Pictures finished per second; `None` while nothing is rendered.
    pub pictures_per_sec: Option<f64>,
    /// Size of the picture in pixels.
    pub size: [u32; 2],
    /// Device memory of the renderer's textures, in bytes.
    pub memory_bytes: u64,
    /// 95th percentile of the panels' frame times, in milliseconds.
    pub panel_p95_ms: Option<f64>,
    /// The plan of the last frame.
    pub verdicts: Vec<Verdict>,
}

/// Milliseconds for people; what was not measured is never 0.
fn millis(value: Option<f64>) -> String {
    value.map_or_else(|| "n/a".to_owned(), |value| format!("{value:.2} ms"))
}

/// Draws the overlay in the upper left corner of `area`.
pub(super) fn show(
    context: &egui::Context,
    area: Rect,
    readout: &Readout,
    (lab, forced): (&mut LabState, &mut Forced),
) {
    let frame = egui::Frame::window(&context.global_style()).inner_margin(8.0);
    let size = egui::vec2((area.width() - 40.0).clamp(120.0, 330.0), (area.height() - 44.0).max(60.0));
    egui::Area::new(Id::unique("timing overlay")).fixed_pos(area.min + egui::vec2(10.0, 10.0)).show(context, |ui| {
        frame.show(ui, |ui| {
            ui.set_max_width(size.x);
            ui.set_max_height(size.y);
            ScrollArea::vertical().max_height(size.y).max_width(size.x).show(ui, |ui| {
                ui.set_width(size.x);
                contents(ui, readout, forced);
                ui.add_space(6.0);
                let measure = ui.button("Measure…").on_hover_text("The table of the thesis, and other sets (F9)");
                super::row::name(ui, &measure, "Measure", "overlay.measure");
                if measure.clicked() {
                    lab.open_suites();
                }
            });
        });
    });
}

fn contents(ui: &mut Ui, readout: &Readout, forced: &mut Forced) {
    ui.spacing_mut().item_spacing.y = 2.0;
    ui.strong("Time per picture");
    ui.weak(match readout.frames {
        0 => "No picture yet".to_owned(),
        1 => format!("One picture · {}", readout.source),
        frames => format!("Median of {frames} pictures · {}", readout.source),
    });
    Grid::new("pass times").num_columns(2).spacing([18.0, 2.0]).show(ui, |ui| {
        for line in &readout.passes {
            ui.label(line.pass);
            ui.label(RichText::new(millis(line.median_ms)).monospace());
            ui.end_row();
        }
        ui.strong("Picture");
        ui.label(RichText::new(millis(readout.total_ms)).monospace().strong());
        ui.end_row();
        ui.label("Pictures per second");
        let rate = readout.pictures_per_sec.map_or_else(|| "at rest".to_owned(), |rate| format!("{rate:.1}"));
        ui.label(RichText::new(rate).monospace());
        ui.end_row();
        ui.label("Panels, 95th percentile");
        ui.label(RichText::new(millis(readout.panel_p95_ms)).monospace());
        ui.end_row();
        ui.label("Picture size");
        ui.label(RichText::new(format!("{} × {} px", readout.size[0], readout.size[1])).monospace());
        ui.end_row();
        ui.label("Textures");
        ui.label(RichText::new(format!("{:.1} MB", readout.memory_bytes as f64 / 1e6)).monospace());
        ui.end_row();
    });
    ui.add(egui::Label::new(RichText::new(&readout.adapter).weak()).wrap());
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        ui.strong("Effects");
        if !forced.is_empty() {
            let reset = ui.small_button("As planned").on_hover_text("Leave all effects to the plan again");
            super::row::name(ui, &reset, "As planned", "overlay.as_planned");
            if reset.clicked() {
                *forced = Forced::default();
            }
        }
    });
    if readout.verdicts.is_empty() {
        ui.weak("None yet");
    }
    for verdict in &readout.verdicts {
        effect(ui, verdict, forced);
    }
}

/// One effect: whether it runs and why. A click forces it the other way, another one leaves it to the plan again.
fn effect(ui: &mut Ui, verdict: &Verdict, forced: &mut Forced) {
    let text = RichText::new(verdict.line());
    let text = match (verdict.is_forced(), verdict.runs) {
        (true, _) => text.color(ui.visuals().warn_fg_color),
        (false, true) => text,
        (false, false) => text.weak(),
    };
    let info = verdict.effect.info();
    if !verdict.can_be_forced() {
        ui.add(egui::Label::new(text).wrap()).on_hover_text(info.does);
        return;
    }
    let label = ui.add(egui::Label::new(text).wrap().sense(egui::Sense::click()));
    let hint = match (verdict.is_forced(), verdict.runs) {
        (true, _) => "Click to leave it to the plan again.",
        (false, true) => "Click to force it off.",
        (false, false) => "Click to force it on.",
    };
    let label = label.on_hover_text(format!("{} {hint}", info.does)).on_hover_cursor(egui::CursorIcon::PointingHand);
    super::row::name(ui, &label, info.name, &format!("overlay.effect.{}", info.name));
    if label.clicked() {
        let force = if verdict.is_forced() { None } else { Some(!verdict.runs) };
        *forced = forced.with(verdict.effect, force);
    }
}
