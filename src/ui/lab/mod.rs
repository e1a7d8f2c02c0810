//! The lab: what accuracy costs, measured beside the window, plotted, and chosen from.

mod chart;
mod results;
mod sweep;

use egui::{Id, Rect, RichText, Ui};

use super::row;
use crate::app::action::{Action, Lab, Order, Request};
use crate::app::document::Document;
use crate::lab::bench::Rounds;
use crate::lab::plot::Plot;
use crate::lab::suite::SuiteKind;
use crate::lab::table::Table;
use crate::scene::Quality;
use crate::scene::param::Choice as _;
use sweep::SweepForm;

/// What measuring is at.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Phase {
    /// Nothing was measured yet.
    #[default]
    Idle,
    /// Something is being measured.
    Running,
    /// It waits, and can go on.
    Paused,
    /// It is at its end, or was left before it.
    Ended {
        /// Whether it was left.
        is_partial: bool,
    },
    /// It cannot go on.
    Failed(String),
}

/// One measured setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// What differs from the others.
    pub name: String,
    /// All of it.
    pub quality: Quality,
    /// Median milliseconds of the march; `None` before it was timed.
    pub cost_ms: Option<f64>,
    /// relRMSE over clouds against the first truth, and its standard error.
    pub error: f64,
    /// Standard error of the error.
    pub std_error: Option<f64>,
    /// Texture reads of a ray.
    pub reads: f64,
    /// Whether no other is both cheaper and more accurate.
    pub is_on_front: bool,
    /// Whether it was in use when measuring began.
    pub is_current: bool,
}

/// What the program tells of measuring.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LabView {
    /// What is measured.
    pub name: String,
    /// What it is at.
    pub phase: Phase,
    /// Share of all work that is done, 0 to 1.
    pub share: f32,
    /// What is being done.
    pub what: String,
    /// Tables of what was measured so far.
    pub tables: Vec<Table>,
    /// Plots of it.
    pub plots: Vec<Plot>,
    /// Settings of a sweep, in the order of the plot's first series.
    pub settings: Vec<Measured>,
    /// What the governor says of itself.
    pub governor: Option<String>,
}

impl LabView {
    /// Settings on the front with their costs, from the cheapest to the most accurate.
    pub fn front(&self) -> Vec<(&Measured, f64)> {
        let mut front: Vec<(&Measured, f64)> = self
            .settings
            .iter()
            .filter(|setting| setting.is_on_front)
            .filter_map(|setting| Some((setting, setting.cost_ms?)))
            .collect();
        front.sort_by(|a, b| a.1.total_cmp(&b.1));
        front
    }
}

/// What the user chose, and what there is to show.
#[derive(Clone, Debug)]
pub struct LabState {
    /// Whether the window is there.
    pub is_open: bool,
    /// Whether it shows the fixed sets instead of sweeps.
    shows_suites: bool,
    form: SweepForm,
    suite: SuiteKind,
    rounds: u32,
    /// Largest error and longest time that are looked for, in per cent and milliseconds.
    budget: (f64, f64),
    /// Whether settings follow the front to hold the frame time.
    pub governs: bool,
    /// Frame time to hold, in milliseconds.
    pub frame_budget_ms: f64,
    /// What the choice said last.
    chosen: Option<String>,
    /// What the program tells.
    pub view: LabView,
}

impl Default for LabState {
    fn default() -> Self {
        Self {
            is_open: false,
            shows_suites: false,
            form: SweepForm::default(),
            suite: SuiteKind::Thesis,
            rounds: 3,
            budget: (10.0, 50.0),
            governs: false,
            frame_budget_ms: 120.0,
            chosen: None,
            view: LabView::default(),
        }
    }
}

impl LabState {
    /// Opens the window at the fixed sets.
    pub fn open_suites(&mut self) {
        (self.is_open, self.shows_suites) = (true, true);
    }

    /// Whether something is being measured at this moment.
    pub fn is_running(&self) -> bool {
        self.view.phase == Phase::Running
    }
}

/// Draws the window.
pub(super) fn show(
    context: &egui::Context,
    area: Rect,
    (state, document): (&mut LabState, &Document),
    actions: &mut Vec<Action>,
) {
    let mut is_open = state.is_open;
    let size = egui::vec2((area.width() - 40.0).clamp(300.0, 660.0), (area.height() - 60.0).clamp(200.0, 640.0));
    egui::Window::new("Lab")
        .id(Id::unique("lab"))
        .open(&mut is_open)
        .default_pos(area.min + egui::vec2(20.0, 14.0))
        .default_size(size)
        .constrain_to(area)
        .show(context, |ui| {
            egui::ScrollArea::vertical().auto_shrink([false; 2]).show(ui, |ui| contents(ui, state, document, actions));
        });
    state.is_open = is_open;
}

fn contents(ui: &mut Ui, state: &mut LabState, document: &Document, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        for (suites, title, hint) in [
            (false, "Sweep", "Settings of quality against the truth of this sky"),
            (true, "Sets", "Measurements beside the documents they come from"),
        ] {
            let tab = ui.selectable_label(state.shows_suites == suites, title).on_hover_text(hint);
            row::name(ui, &tab, title, &format!("lab.{}", title.to_lowercase()));
            if tab.clicked() {
                state.shows_suites = suites;
            }
        }
    });
    ui.separator();
    let order = if state.shows_suites {
        suite_form(ui, state, document.quality())
    } else {
        sweep::show(ui, &mut state.form, document.quality())
    };
    ui.add_space(4.0);
    let wishes = progress(ui, &state.view, order);
    actions.extend(wishes.into_iter().map(|wish| Action::Ask(Request::Lab(wish))));
    results::show(ui, state, document, actions);
}

/// What a fixed set is to be like.
fn suite_form(ui: &mut Ui, state: &mut LabState, quality: &Quality) -> Result<Order, String> {
    ui.horizontal_wrapped(|ui| {
        for kind in SuiteKind::ALL {
            let chosen = ui.selectable_label(state.suite == *kind, kind.title()).on_hover_text(kind.doc().trim());
            row::name(ui, &chosen, kind.title(), &format!("lab.suite.{}", kind.name()));
            if chosen.clicked() {
                state.suite = *kind;
            }
        }
        rounds(ui, &mut state.rounds);
    });
    ui.weak("It has skies and sizes of its own, and takes many minutes without a graphics card.");
    let rounds = Rounds { warm_up: 1, rounds: state.rounds, frames: 1 };
    Ok(Order::Suite(state.suite, rounds, Box::new(quality.clone())))
}

fn rounds(ui: &mut Ui, rounds: &mut u32) {
    ui.label("Rounds");
    let field = ui.add(egui::DragValue::new(rounds).range(1..=100)).on_hover_text("Timed rounds over all cases");
    row::name(ui, &field, "Rounds", "lab.rounds");
}

/// Buttons, and how far it is.
fn progress(ui: &mut Ui, view: &LabView, order: Result<Order, String>) -> Vec<Lab> {
    let mut wishes = Vec::new();
    ui.horizontal_wrapped(|ui| {
        let button = |ui: &mut Ui, title: &str, is_enabled: bool| {
            let button = ui.add_enabled(is_enabled, egui::Button::new(title));
            row::name(ui, &button, title, &format!("lab.{}", title.to_lowercase()));
            button.clicked()
        };
        let is_busy = matches!(view.phase, Phase::Running | Phase::Paused);
        if button(ui, "Measure", !is_busy && order.is_ok())
            && let Ok(order) = &order
        {
            wishes.push(Lab::Start(Box::new(order.clone())));
        }
        if view.phase == Phase::Paused {
            if button(ui, "Resume", true) {
                wishes.push(Lab::Resume);
            }
        } else if button(ui, "Pause", view.phase == Phase::Running) {
            wishes.push(Lab::Pause);
        }
        if button(ui, "Stop", is_busy) {
            wishes.push(Lab::Stop);
        }
        if is_busy {
            ui.add(egui::ProgressBar::new(view.share).desired_width(140.0).show_percentage());
        }
    });
    let said = match (&view.phase, &order) {
        (Phase::Idle, Ok(_)) => None,
        (_, Err(why)) => Some(why.clone()),
        (Phase::Running, _) => Some(format!("{}: {}", view.name, view.what)),
        (Phase::Paused, _) => Some(format!("{}: paused, {} next", view.name, view.what)),
        (Phase::Ended { is_partial: true }, _) => Some(format!("{}: stopped before the end", view.name)),
        (Phase::Ended { is_partial: false }, _) => Some(format!("{}: measured", view.name)),
        (Phase::Failed(why), _) => Some(format!("{}: {why}", view.name)),
    };
    if let Some(said) = said {
        ui.add(egui::Label::new(RichText::new(said).weak()).wrap());
    }
    wishes
}
