//! The editor's panels. They see the document, never change it, and return what the user wants as [`Action`]s.

mod cameras;
mod clipboard;
mod command;
mod dialogs;
mod export_form;
mod genera;
mod guides;
mod histogram;
mod history;
mod inspector;
mod lab;
mod map;
mod menu;
mod overlay;
mod paint;
mod palette;
mod panel;
mod presets;
mod probe;
mod row;
mod snapshots;
mod sundial;
mod timeline;
mod toasts;
mod top_bar;
mod truth;
mod vary;
mod viewport;

pub use command::Command;
pub use dialogs::Dialog;
pub use export_form::ExportForm;
pub use histogram::HistogramState;
pub use inspector::{InspectorState, Picked};
pub use lab::{LabState, LabView, Measured, Phase};
pub use map::MapState;
pub use overlay::{PassLine, Readout};
pub use paint::{PaintState, Touch};
pub use palette::PaletteState;
pub use panel::PanelState;
pub use presets::{Entry, Library, Morph, Thumbnail};
pub use probe::set_file_in;
pub use snapshots::{Beside, Snapshot, SnapshotState};
pub use timeline::TimelineState;
pub use toasts::{Level, Toasts};
pub use truth::{Comparison, Figures, Refined, Refinement, TruthState, TruthView};
pub use vary::VaryState;
pub use viewport::{Gesture, Picture, ViewportState};

use egui::{Margin, Theme, Ui};

use crate::app::action::{Action, Steering};
use crate::app::document::Document;
use crate::app::preferences::Preferences;
use crate::plan::Forced;

/// Below this width of the window the preset list is not opened by itself, in points.
const WIDE_ENOUGH_FOR_PRESETS: f32 = 1100.0;

/// What the panels remember between frames, and what the program tells them beside the document.
#[derive(Debug)]
pub struct State {
    /// The parameter panel.
    pub panel: PanelState,
    /// Whether the parameter panel is there.
    pub show_panel: bool,
    /// Whether the preset list is there; `None` until the user says, then as the window has room.
    pub show_presets: Option<bool>,
    /// Whether the timing overlay is there.
    pub show_overlay: bool,
    /// Skies to go back to and to compare with.
    pub snapshots: SnapshotState,
    /// Points of the picture in numbers.
    pub inspector: InspectorState,
    /// The brush.
    pub paint: PaintState,
    /// The weather map from above.
    pub map: MapState,
    /// Commands by name.
    pub palette: PaletteState,
    /// Random changes.
    pub vary: VaryState,
    /// Light of the picture.
    pub histogram: HistogramState,
    /// Keys.
    pub timeline: TimelineState,
    /// Whether the list of steps is there.
    pub show_history: bool,
    /// Whether everything but the picture is hidden.
    pub hide_all: bool,
    /// The question on the screen, if any.
    pub dialog: Option<Dialog>,
    /// Short messages.
    pub toasts: Toasts,
    /// Presets to choose from.
    pub library: Library,
    /// The picture and what is done to it.
    pub viewport: ViewportState,
    /// Refinement and comparison with the truth.
    pub truth: TruthState,
    /// Measuring.
    pub lab: LabState,
    /// Effects that run, or do not, whatever the sky calls for: to see what they do.
    pub forced: Forced,
    /// What a thread is busy with, for the status line.
    pub busy: Option<Busy>,
}

impl State {
    /// What the window's picture shows whatever the sky calls for.
    pub fn forced(&self) -> Forced {
        let mut forced = self.forced;
        forced.stripes = self.histogram.stripes;
        forced
    }
}

/// What a thread is busy with.
#[derive(Clone, Debug, PartialEq)]
pub struct Busy {
    /// In words.
    pub text: String,
    /// How much of it is done, 0 to 1, and the seconds that the rest is likely to take; `None` where nobody knows.
    pub progress: Option<(f32, Option<f64>)>,
    /// Whether it goes on or waits; `None` where it cannot be stopped.
    pub steering: Option<Steering>,
    /// What [`Steering::End`] does, in words; empty where there is nothing between going on and giving up.
    pub end: &'static str,
}

impl Default for State {
    fn default() -> Self {
        Self {
            panel: PanelState::default(),
            show_panel: true,
            show_presets: None,
            show_overlay: false,
            snapshots: SnapshotState::default(),
            inspector: InspectorState::default(),
            paint: PaintState::default(),
            map: MapState::default(),
            palette: PaletteState::default(),
            vary: VaryState::default(),
            histogram: HistogramState::default(),
            timeline: TimelineState::default(),
            show_history: false,
            hide_all: false,
            dialog: None,
            toasts: Toasts::default(),
            library: Library::default(),
            viewport: ViewportState::default(),
            truth: TruthState::default(),
            lab: LabState::default(),
            forced: Forced::default(),
            busy: None,
        }
    }
}

impl State {
    /// Whether the preset list is drawn in a window of this width.
    fn presets_visible(&self, width: f32) -> bool {
        self.show_presets.unwrap_or(width >= WIDE_ENOUGH_FOR_PRESETS)
    }
}

/// The fonts: signs that the text font lacks, such as arrows, come from the monospaced one.
pub fn fonts() -> egui::FontDefinitions {
    let mut fonts = egui::FontDefinitions::default();
    let monospaced = fonts.families.get(&egui::FontFamily::Monospace).cloned().unwrap_or_default();
    let proportional = fonts.families.entry(egui::FontFamily::Proportional).or_default();
    for font in monospaced {
        if !proportional.contains(&font) {
            proportional.push(font);
        }
    }
    fonts
}

/// Sets up fonts, spacing and colours; once per context.
pub fn style(context: &egui::Context) {
    context.set_fonts(fonts());
    context.all_styles_mut(|style| {
        style.animation_time = 0.06;
        style.spacing.item_spacing = egui::vec2(6.0, 4.0);
        style.spacing.indent = 12.0;
        style.spacing.scroll = egui::style::ScrollStyle::solid();
        style.spacing.combo_height = 320.0;
        style.visuals.slider_trailing_fill = true;
        style.interaction.tooltip_delay = 0.35;
    });
}

/// Draws everything, and returns what the user wants.
pub fn show(
    ui: &mut Ui,
    state: &mut State,
    (document, preferences): (&Document, &mut Preferences),
    readout: &Readout,
) -> Vec<Action> {
    let mut actions = command::take(ui, state, document);
    let width = ui.available_width();
    if !state.hide_all {
        let bar = egui::Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
        egui::Panel::top("top bar").frame(bar).show(ui, |ui| {
            top_bar::show(ui, state, (document, preferences), &mut actions);
        });
        let most = (width * 0.55).max(260.0);
        if state.show_panel {
            let size = if width < 900.0 { 300.0 } else { 350.0 };
            timeline::note_keyed(ui, document.animation());
            row::note_units(ui, preferences.units);
            egui::Panel::right("parameters").default_size(size).size_range(260.0..=most).show(ui, |ui| {
                ui.add_space(4.0);
                actions.extend(panel::show(ui, &mut state.panel, &document.preset().scene, document.quality()));
            });
        }
        if state.presets_visible(width) {
            egui::Panel::left("presets").default_size(190.0).size_range(140.0..=300.0).show(ui, |ui| {
                ui.add_space(4.0);
                actions.extend(presets::show(ui, &mut state.library, (document, preferences)));
            });
        }
    }
    if !state.hide_all && !state.snapshots.list().is_empty() {
        egui::Panel::bottom("snapshots").exact_size(snapshots::HEIGHT).show(ui, |ui| {
            ui.add_space(3.0);
            snapshots::show(ui, &mut state.snapshots, document, &mut actions);
        });
    }
    if !state.hide_all && state.timeline.is_open {
        egui::Panel::bottom("timeline").default_size(130.0).size_range(84.0..=400.0).resizable(true).show(ui, |ui| {
            ui.add_space(3.0);
            timeline::show(ui, &mut state.timeline, document, &mut actions);
        });
    }
    let central = egui::CentralPanel::no_frame().show(ui, |ui| {
        let beside = (&mut state.truth, &mut state.snapshots, &mut state.inspector, &mut state.paint);
        viewport::show(ui, &mut state.viewport, beside, (document, preferences.habit));
    });
    let area = central.response.rect;
    if state.show_overlay && !state.hide_all {
        overlay::show(ui.ctx(), area, readout, (&mut state.lab, &mut state.forced));
    }
    if !state.hide_all {
        truth::show(ui.ctx(), area, state);
    }
    if state.lab.is_open && !state.hide_all {
        lab::show(ui.ctx(), area, (&mut state.lab, document), &mut actions);
    }
    if state.histogram.is_open && !state.hide_all {
        histogram::show(ui.ctx(), (area, state.truth.height), &mut state.histogram, document, &mut actions);
    }
    inspector::show(ui.ctx(), area, &state.inspector);
    paint::show(ui.ctx(), area, &mut state.paint);
    if state.map.is_open && !state.hide_all {
        map::show(ui.ctx(), area, (&mut state.map, &mut state.paint), document, &mut actions);
    }
    if state.vary.is_open && !state.hide_all {
        vary::show(ui.ctx(), area, (&mut state.vary, document), &mut actions);
    }
    if state.show_history && !state.hide_all {
        history::show(ui.ctx(), area, document, (&mut state.show_history, &mut actions));
    }
    palette::show(ui, state, document, &mut actions);
    if state.dialog.is_none() && !state.palette.is_open {
        cameras::take_keys(ui, document, &mut actions);
    }
    let held = (&document.preset().scene, document.quality());
    let is_asking = state.dialog.is_some() || state.palette.is_open;
    clipboard::take(ui, (&mut state.panel.copied, is_asking), held, &mut actions);
    // Who sets a key wants to see it.
    state.timeline.is_open |= actions.iter().any(|action| matches!(action, Action::SetKey(_)));
    dialogs::show(ui.ctx(), state, (document, preferences), &mut actions);
    if !preferences.is_introduced && !state.hide_all {
        first_steps(ui.ctx(), area, preferences);
    }
    state.toasts.show(ui.ctx(), area);
    actions
}

/// A strip over the picture for whoever is here for the first time.
fn first_steps(context: &egui::Context, area: egui::Rect, preferences: &mut Preferences) {
    let place = egui::Area::new(egui::Id::unique("first steps")).pivot(egui::Align2::CENTER_TOP);
    place.fixed_pos(area.center_top() + egui::vec2(0.0, 10.0)).show(context, |ui| {
        egui::Frame::window(&context.global_style()).inner_margin(8.0).show(ui, |ui| {
            ui.set_max_width((area.width() - 40.0).clamp(120.0, 560.0));
            ui.horizontal_wrapped(|ui| {
                for (keys, what) in FIRST_STEPS {
                    ui.label(egui::RichText::new(keys).strong());
                    ui.label(what);
                }
                let known = ui.button("Got it");
                row::name(ui, &known, "Got it", "first_steps.close");
                preferences.is_introduced |= known.clicked();
            });
        });
    });
}

const FIRST_STEPS: [(&str, &str); 5] = [
    ("Right mouse", "look, with W A S D fly ·"),
    ("Space", "play ·"),
    ("Ctrl+Z", "undo anything ·"),
    ("Ctrl+P", "find anything ·"),
    ("Shift+F1", "help"),
];

/// The other theme.
fn other(theme: Theme) -> Theme {
    match theme {
        Theme::Dark => Theme::Light,
        Theme::Light => Theme::Dark,
    }
}
