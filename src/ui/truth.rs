//! The picture that refines at rest, and the realtime picture beside the truth: what is chosen, and what is said of it.

use egui::{Align2, Color32, Id, Rect, RichText, Ui};

use super::{Picture, State, row};
use crate::choices;
use crate::lab::colormap;
use crate::lab::metrics::{Errors, Estimate};
use crate::plan::Integrator;
use crate::scene::param::Choice;

choices! {
    /// How the realtime picture and the truth are shown together.
    pub enum Comparison {
        /// Not at all.
        Off ("Off"),
        /// The realtime picture left of a divider that can be dragged, the truth right of it.
        Wipe ("Wipe"),
        /// Both whole, the realtime picture on the left.
        SideBySide ("Side by side"),
        /// The realtime picture, and the truth while T is held.
        Flip ("Flip"),
        /// Their difference in luminance, as colours with a scale.
        Difference ("Difference"),
    }
}

/// How far a truth is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// Which truth.
    pub integrator: Integrator,
    /// Level of the ladder or samples of each pixel that are finished, shown or not; `None` before the first.
    pub finished: Option<u32>,
    /// Samples of each pixel on the last level: finished, and in the end.
    pub pixel_samples: (u32, u32),
    /// Share of the level or of all samples under way, 0 to 1.
    pub share: f32,
    /// Relative change of the last level, or relative standard error; 0.01 is one per cent. `None` before it is known.
    pub error: Option<f32>,
    /// Time spent, in seconds.
    pub spent_secs: f64,
}

/// What the work towards the truth is at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Refinement {
    /// Nothing: it is off, or something moves.
    #[default]
    Idle,
    /// Shaders are being compiled.
    Compiling,
    /// The realtime picture gets several samples of each pixel.
    Smoothing {
        /// How many are finished.
        finished: u32,
        /// How many there will be.
        count: u32,
    },
    /// The realtime picture of all pixels is being made.
    Still,
    /// A truth is on its way.
    Working(Refined),
    /// A truth is not worked on at the moment, as something was touched, or for good.
    Halted(Refined),
    /// A truth is within its tolerance, or, where `false`, as good as its levels or samples make it.
    Done(Refined, bool),
    /// No cloud is in view.
    NoCloud,
}

/// A share in per cent, with as many digits as tell something.
fn percent(share: f64) -> String {
    format!("{:.*} %", digits(share), share * 100.0)
}

fn digits(share: f64) -> usize {
    match share.abs() * 100.0 {
        small if small < 0.095 => 2,
        middle if middle < 9.95 => 1,
        _ => 0,
    }
}

impl Refined {
    fn way(self) -> String {
        let error = self.error.map(|error| percent(f64::from(error)));
        match self.integrator {
            Integrator::PathTraced => {
                let error = error.map_or_else(String::new, |error| format!(", noise {error}"));
                format!("{} paths a pixel, {:.0} % of more{error}", self.finished.unwrap_or(0), self.share * 100.0)
            }
            _ if self.pixel_samples.0 > 0 => {
                let (finished, count) = self.pixel_samples;
                format!("sample {} of {count} a pixel, {:.0} %", (finished + 1).min(count), self.share * 100.0)
            }
            _ => {
                let level = self.finished.map_or(0, |finished| finished + 1);
                let error = error.map_or_else(String::new, |error| format!(", changed {error} last"));
                format!("level {level}, {:.0} %{error}", self.share * 100.0)
            }
        }
    }

    fn end(self, is_within: bool) -> String {
        let verb = if self.integrator == Integrator::PathTraced { "path traced" } else { "converged" };
        let error = self.error.map_or_else(|| "an unknown error".to_owned(), |error| percent(f64::from(error)));
        let spent = seconds(self.spent_secs);
        if is_within {
            format!("{verb} within {error}, {spent}")
        } else {
            format!("not {verb} within its limits: {error} left, {spent}")
        }
    }
}

impl Refinement {
    /// What is said over the picture; `None` for nothing.
    pub fn text(self) -> Option<String> {
        match self {
            Self::Idle => None,
            Self::Compiling => Some("refining: compiling shaders".to_owned()),
            Self::Smoothing { finished, count } => {
                Some(format!("smoothing: sample {} of {count} a pixel", (finished + 1).min(count)))
            }
            Self::Still => Some("comparing: realtime picture of all pixels".to_owned()),
            Self::Working(refined) => Some(format!("refining: {}", refined.way())),
            Self::Halted(refined) => Some(format!("halted: {}", refined.way())),
            Self::Done(refined, is_within) => Some(refined.end(is_within)),
            Self::NoCloud => Some("nothing to refine: no cloud in view".to_owned()),
        }
    }
}

/// What comparing has found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// Errors of the realtime picture against the converged one, or why there are none.
    pub converged: Option<Result<Errors, String>>,
    /// The same against the path-traced one.
    pub traced: Option<Result<Errors, String>>,
    /// Time of the realtime picture, in milliseconds; `None` where it could not be measured.
    pub cost_ms: Option<f64>,
    /// Where that time comes from.
    pub source: &'static str,
    /// Time of the truth so far, in seconds.
    pub truth_secs: Option<f64>,
}

fn seconds(value: f64) -> String {
    if value < 9.95 { format!("{value:.1} s") } else { format!("{value:.0} s") }
}

fn estimate(Estimate { value, std_error }: Estimate) -> String {
    match std_error {
        Some(error) => format!("{:.*} ± {}", digits(error), value * 100.0, percent(error)),
        None => percent(value),
    }
}

impl Figures {
    /// What it says, in a sentence; `None` before anything was measured.
    pub fn text(&self) -> Option<String> {
        let figure = |errors: &Option<Result<Errors, String>>, name: &str| match errors {
            Some(Ok(errors)) => Some(format!("{} from {name}", estimate(errors.rel_rmse))),
            _ => None,
        };
        let converged = figure(&self.converged, "converged");
        let traced = figure(&self.traced, "path traced");
        let off = match (converged, traced) {
            (Some(one), Some(other)) => format!("{one} ({other})"),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => return None,
        };
        let cost = self.cost_ms.map_or_else(|| "n/a".to_owned(), |cost| format!("{cost:.0} ms"));
        let truth = self.truth_secs.map_or_else(|| "n/a".to_owned(), seconds);
        Some(format!("What you see is {off}; it costs {cost}, the truth {truth} ({}).", self.source))
    }

    /// What the figures are, and why one is missing.
    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let both = [&self.converged, &self.traced].map(Option::as_ref);
        let known = both.into_iter().flatten().find_map(|errors| errors.as_ref().ok());
        if let Some(errors) = known {
            let noise = if matches!(self.traced, Some(Ok(_))) { "; the paths’ noise is subtracted" } else { "" };
            notes.push(format!("relRMSE ± standard error over {} cloud pixels{noise}", errors.pixels));
        }
        notes.extend(both.into_iter().flatten().filter_map(|errors| errors.as_ref().err()).cloned());
        notes
    }
}

/// Pictures of the same moment, where they are finished.
#[derive(Clone, Debug, Default)]
pub struct TruthView {
    /// What is being done.
    pub refinement: Refinement,
    /// What the viewport shows at rest: smooth, then converged as well.
    pub refined: Option<Picture>,
    /// The realtime picture of all pixels.
    pub still: Option<Picture>,
    /// The truth that it is compared with.
    pub truth: Option<Picture>,
    /// Their signed difference and its absolute value.
    pub difference: Option<[Picture; 2]>,
    /// Relative difference at the end of the colour scale; 0.1 is ten per cent.
    pub limit: f32,
    /// What was measured.
    pub figures: Figures,
    /// What went wrong in the shaders, in words.
    pub faults: Vec<String>,
}

/// What the user chose, and what there is to show.
#[derive(Clone, Debug)]
pub struct TruthState {
    /// Whether the picture refines at rest.
    pub refines: bool,
    /// How the pictures are compared.
    pub comparison: Comparison,
    /// What comes back when comparing is switched on by its key.
    before: Comparison,
    /// What is compared with; never [`Integrator::Realtime`].
    pub reference: Integrator,
    /// Whether differences have a sign.
    pub is_signed: bool,
    /// Whether accumulating was stopped and the picture kept.
    pub is_kept: bool,
    /// Place of the divider, 0 to 1 from the left.
    pub divider: f32,
    /// Height of the controls when they were drawn last, in points.
    pub(super) height: f32,
    /// What the program tells.
    pub view: TruthView,
}

impl Default for TruthState {
    fn default() -> Self {
        Self {
            refines: true,
            comparison: Comparison::Off,
            before: Comparison::Wipe,
            reference: Integrator::Converged,
            is_signed: true,
            is_kept: false,
            divider: 0.5,
            height: 0.0,
            view: TruthView::default(),
        }
    }
}

impl TruthState {
    /// Whether pictures are compared.
    pub fn compares(&self) -> bool {
        self.comparison != Comparison::Off
    }

    /// Changes how pictures are compared.
    pub fn compare(&mut self, comparison: Comparison) {
        if comparison == Comparison::Off {
            self.is_kept = false;
        } else {
            self.before = comparison;
        }
        self.comparison = comparison;
    }

    /// Comparing off, or on as it was before.
    pub fn toggle(&mut self) {
        self.compare(if self.compares() { Comparison::Off } else { self.before });
    }
}

/// The rows of the View menu and of the controls: how, and with what.
pub(super) fn choose(ui: &mut Ui, truth: &mut TruthState) {
    ui.horizontal_wrapped(|ui| {
        for option in Comparison::ALL {
            let response = ui.selectable_label(truth.comparison == *option, option.title());
            let response = response.on_hover_text(option.doc().trim());
            row::name(
                ui,
                &response,
                &format!("Compare: {}", option.title()),
                &format!("truth.mode.{}", option.title()),
            );
            if response.clicked() {
                truth.compare(*option);
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label("with");
        for option in [Integrator::Converged, Integrator::PathTraced] {
            let response = ui.selectable_label(truth.reference == option, option.title());
            let response = response.on_hover_text(option.doc().trim());
            let key = format!("truth.reference.{}", option.title());
            row::name(ui, &response, &format!("Compare with {}", option.title()), &key);
            if response.clicked() && truth.reference != option {
                truth.reference = option;
                truth.is_kept = false;
            }
        }
    });
}

const FAULT: Color32 = Color32::from_rgb(225, 40, 40);

fn faults(ui: &mut Ui, faults: &[String]) {
    for fault in faults {
        let text = RichText::new(fault).color(Color32::WHITE).background_color(FAULT).strong();
        ui.add(egui::Label::new(text).wrap());
    }
}

/// Draws the status text, or the controls and the read-out of a comparison, at the lower edge of `area`.
pub(super) fn show(context: &egui::Context, area: Rect, state: &mut State) {
    let hud = state.viewport.hud.is_some();
    let truth = &mut state.truth;
    let corner = area.left_bottom() + egui::vec2(10.0, -10.0);
    let width = (area.width() - 20.0).max(120.0);
    let place = |name: &str| egui::Area::new(Id::unique(name)).pivot(Align2::LEFT_BOTTOM).fixed_pos(corner);
    if truth.compares() {
        let frame = egui::Frame::window(&context.global_style()).inner_margin(8.0);
        let area = place("comparison").show(context, |ui| {
            frame.show(ui, |ui| {
                ui.set_max_width((width - 18.0).min(560.0));
                controls(ui, truth);
            });
        });
        truth.height = area.response.rect.height() + 10.0;
        return;
    }
    truth.height = 0.0;
    let text = truth.view.refinement.text().filter(|_| !hud);
    if text.is_none() && truth.view.faults.is_empty() {
        return;
    }
    place("refinement").interactable(false).show(context, |ui| {
        ui.set_max_width(width);
        let dark = egui::Frame::new().fill(Color32::from_black_alpha(150)).corner_radius(4.0);
        dark.inner_margin(egui::Margin::symmetric(7, 3)).show(ui, |ui| {
            if let Some(text) = text {
                let text = RichText::new(text).color(Color32::WHITE).size(12.5);
                ui.add(egui::Label::new(text).selectable(false).wrap());
            }
            faults(ui, &truth.view.faults);
        });
    });
}

fn controls(ui: &mut Ui, truth: &mut TruthState) {
    choose(ui, truth);
    ui.horizontal_wrapped(|ui| {
        let verb = if truth.is_kept { "Continue" } else { "Stop and keep" };
        let hint = "Accumulates no further and keeps the picture (F6)";
        let keep = ui.button(verb).on_hover_text(hint);
        row::name(ui, &keep, verb, "truth.keep");
        if keep.clicked() {
            truth.is_kept = !truth.is_kept;
        }
        if truth.comparison == Comparison::Difference {
            for (is_signed, title) in [(true, "Signed"), (false, "Absolute")] {
                let response = ui.selectable_label(truth.is_signed == is_signed, title);
                row::name(ui, &response, &format!("{title} difference"), &format!("truth.{}", title.to_lowercase()));
                if response.clicked() {
                    truth.is_signed = is_signed;
                }
            }
        } else if truth.comparison == Comparison::Flip {
            ui.weak("Hold T to see the truth");
        }
    });
    let view = &truth.view;
    if truth.comparison == Comparison::Difference {
        match view.difference {
            Some(_) => legend(ui, truth.is_signed, view.limit),
            None => drop(ui.weak("The colours come with the first finished picture of the truth.")),
        }
    }
    let text = view.figures.text().unwrap_or_else(|| "Nothing was measured yet.".to_owned());
    ui.add(egui::Label::new(text).wrap());
    for note in view.figures.notes() {
        ui.add(egui::Label::new(RichText::new(note).weak()).wrap());
    }
    let status = view.refinement.text().unwrap_or_else(|| "waiting for a picture at rest".to_owned());
    ui.add(egui::Label::new(RichText::new(status).weak()).wrap());
    faults(ui, &view.faults);
}

/// The colour scale with its ends in per cent.
fn legend(ui: &mut Ui, is_signed: bool, limit: f32) {
    let end = percent(f64::from(limit));
    let (low, middle) = if is_signed { (format!("−{end}"), "0") } else { ("0".to_owned(), "") };
    ui.horizontal_wrapped(|ui| {
        ui.label(low);
        let (rect, _) = ui.allocate_exact_size(egui::vec2(150.0, 12.0), egui::Sense::hover());
        const STEPS: u8 = 75;
        for step in 0..STEPS {
            let share = (f32::from(step) + 0.5) / f32::from(STEPS);
            let [r, g, b] = if is_signed { colormap::diverging(2.0 * share - 1.0) } else { colormap::viridis(share) };
            let left = rect.left() + rect.width() * f32::from(step) / f32::from(STEPS);
            let cell = Rect::from_min_size(egui::pos2(left, rect.top()), egui::vec2(2.5, rect.height()));
            ui.painter().rect_filled(cell.intersect(rect), 0.0, Color32::from_rgb(r, g, b));
        }
        if !middle.is_empty() {
            let font = egui::FontId::proportional(10.0);
            ui.painter().text(rect.center(), Align2::CENTER_CENTER, middle, font, Color32::BLACK);
        }
        ui.label(if is_signed { format!("+{end}") } else { end });
        ui.weak(if is_signed { "of the truth’s luminance; red is too bright" } else { "of the truth’s luminance" });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refined(integrator: Integrator) -> Refined {
        Refined {
            integrator,
            finished: Some(1),
            pixel_samples: (0, 1),
            share: 0.4,
            error: Some(0.013),
            spent_secs: 12.2,
        }
    }

    #[test]
    fn the_status_says_how_far_it_is() {
        let converged = refined(Integrator::Converged);
        let text = |refinement: Refinement| refinement.text().unwrap_or_default();
        assert_eq!(text(Refinement::Working(converged)), "refining: level 2, 40 %, changed 1.3 % last");
        let first = Refined { finished: None, error: None, ..converged };
        assert_eq!(text(Refinement::Working(first)), "refining: level 0, 40 %");
        let good = Refined { error: Some(0.004), ..converged };
        assert_eq!(text(Refinement::Done(good, true)), "converged within 0.4 %, 12 s");
        assert!(text(Refinement::Done(converged, false)).starts_with("not converged"), "no false claim");
        assert_eq!(
            text(Refinement::Working(refined(Integrator::PathTraced))),
            "refining: 1 paths a pixel, 40 % of more, noise 1.3 %"
        );
        assert_eq!(Refinement::Idle.text(), None);
    }

    #[test]
    fn what_was_not_measured_is_not_said() {
        assert_eq!(Figures::default().text(), None);
        let failed = Figures { converged: Some(Err("no pixels".to_owned())), ..Figures::default() };
        assert_eq!((failed.text(), failed.notes()), (None, vec!["no pixels".to_owned()]));
    }

    #[test]
    fn comparing_comes_back_as_it_was() {
        let mut truth = TruthState::default();
        truth.compare(Comparison::Difference);
        truth.is_kept = true;
        truth.toggle();
        assert!(!truth.compares() && !truth.is_kept, "off keeps nothing");
        truth.toggle();
        assert_eq!(truth.comparison, Comparison::Difference);
    }
}
