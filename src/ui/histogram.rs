//! The histogram: how much of the picture has which luminance, against what the screen can show.

use egui::{Align2, Color32, Context, FontId, Id, Pos2, Rect, Sense, Stroke, Ui, Vec2};

use super::row;
use crate::app::action::Action;
use crate::app::document::Document;
use crate::render::meter::LightHistogram;
use crate::scene::{Display, FALSE_COLOURS, ToneMap};

/// Size of the chart, in points.
const CHART: Vec2 = Vec2::new(300.0, 92.0);
/// Stops below and above middle grey that the chart shows, around the exposure.
const SHOWN: [f64; 2] = [-9.0, 7.0];

/// The histogram's state.
#[derive(Clone, Debug, Default)]
pub struct HistogramState {
    /// Whether it is there.
    pub is_open: bool,
    /// Whether the exposure follows the picture.
    pub is_auto: bool,
    /// The light of the last picture.
    pub light: Option<LightHistogram>,
    /// The curve that was left for false colours.
    left: Option<ToneMap>,
    /// Whether what clips is striped in the window.
    pub stripes: bool,
}

impl HistogramState {
    /// False colours, or the curve that was left for them.
    pub(super) fn toggled(&mut self, document: &Document) -> Action {
        let mut scene = document.preset().scene.clone();
        let curve = scene.display.tone_map;
        scene.display.tone_map = if curve == ToneMap::FalseColour {
            self.left.take().unwrap_or(ToneMap::Agx)
        } else {
            self.left = Some(curve);
            ToneMap::FalseColour
        };
        Action::EditScene { key: "display.tone_map".to_owned(), scene: Box::new(scene) }
    }

    /// The change of exposure, in stops, that shows the mean of the picture as middle grey.
    pub fn correction(&self, document: &Document) -> Option<f32> {
        let now = f64::from(document.preset().scene.display.exposure_ev);
        let wanted = self.light.as_ref()?.exposure_ev()?;
        #[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
        Some((wanted - now) as f32)
    }
}

/// Middle grey of an exposure, as a meter counts.
fn middle_ev(exposure_ev: f64) -> f64 {
    exposure_ev + (8.0_f64 * 1.2 * 0.18).log2()
}

/// Stops above middle grey at which a curve reaches white.
fn white(tone_map: ToneMap) -> f64 {
    match tone_map {
        // AgX ends 16.5 stops above log2 -12.47.
        ToneMap::Agx => 16.5 - 12.473_93 - 0.18_f64.log2(),
        // Neutral approaches white without end; a tenth of its highlights is left 5 stops up.
        ToneMap::Neutral => 5.0,
        // Hill's fit reaches 1 at 25.67, after its gain of 1/0.6.
        ToneMap::Aces => (0.6 * 25.67 / 0.18_f64).log2(),
        ToneMap::Linear => -(0.18_f64.log2()),
        ToneMap::FalseColour => f64::from(FALSE_COLOURS[FALSE_COLOURS.len() - 2].0),
    }
}

/// Draws it in a corner of the picture, `below` points above its edge.
pub(super) fn show(
    context: &Context,
    (area, below): (Rect, f32),
    state: &mut HistogramState,
    document: &Document,
    actions: &mut Vec<Action>,
) {
    let corner = area.left_bottom() + Vec2::new(10.0, -34.0 - below);
    let place = egui::Area::new(Id::unique("histogram")).pivot(Align2::LEFT_BOTTOM).fixed_pos(corner);
    place.show(context, |ui| {
        egui::Frame::window(&context.global_style()).inner_margin(8.0).show(ui, |ui| {
            ui.set_width(CHART.x);
            let display = &document.preset().scene.display;
            chart(ui, state.light.as_ref(), display);
            ui.horizontal(|ui| buttons(ui, state, document, actions));
            if display.tone_map == ToneMap::FalseColour {
                legend(ui);
            }
        });
    });
}

fn buttons(ui: &mut Ui, state: &mut HistogramState, document: &Document, actions: &mut Vec<Action>) {
    let correction = state.correction(document);
    let expose = ui.add_enabled(correction.is_some() && !state.is_auto, egui::Button::new("Expose"));
    let hint = "Sets the exposure so that the mean of the picture is middle grey";
    if expose.on_hover_text(hint).clicked() {
        actions.extend(correction.map(Action::ChangeExposure));
    }
    let auto = ui.checkbox(&mut state.is_auto, "Auto");
    row::name(ui, &auto, "Automatic exposure", "histogram.auto");
    auto.on_hover_text("The exposure follows the picture; off locks it as it is");
    let stripes = ui.checkbox(&mut state.stripes, "Stripes");
    row::name(ui, &stripes, "Stripes over what clips", "histogram.stripes");
    stripes.on_hover_text(
        "Stripes over what is as bright as the screen goes. They are in no file but screenshots, and in snapshots",
    );
    let is_false = document.preset().scene.display.tone_map == ToneMap::FalseColour;
    let colours = ui.selectable_label(is_false, "False colour");
    row::name(ui, &colours, "False colour", "histogram.false_colour");
    if colours.on_hover_text("Stops above and below middle grey as colours").clicked() {
        actions.push(state.toggled(document));
    }
}

fn chart(ui: &mut Ui, light: Option<&LightHistogram>, display: &Display) {
    let (rect, response) = ui.allocate_exact_size(CHART, Sense::hover());
    row::name(ui, &response, "Histogram", "histogram");
    let painter = ui.painter_at(rect);
    let visuals = ui.visuals();
    painter.rect_filled(rect, 3.0, visuals.extreme_bg_color);
    let middle = middle_ev(f64::from(display.exposure_ev));
    let Some(light) = light.filter(|light| light.total() > 0) else {
        painter.text(
            rect.center(),
            Align2::CENTER_CENTER,
            "Waiting for a picture",
            FontId::proportional(13.0),
            visuals.weak_text_color(),
        );
        return;
    };
    #[allow(clippy::cast_possible_truncation, reason = "points of the screen")]
    let x = |stops: f64| rect.left() + rect.width() * ((stops - SHOWN[0]) / (SHOWN[1] - SHOWN[0])) as f32;
    for stops in [-6.0, -3.0, 0.0, 3.0, 6.0] {
        let shade = visuals.weak_text_color().gamma_multiply(if stops == 0.0 { 0.9 } else { 0.35 });
        painter.vline(x(stops), rect.y_range(), Stroke::new(1.0, shade));
        let at = Pos2::new(x(stops) + 3.0, rect.top() + 2.0);
        painter.text(
            at,
            Align2::LEFT_TOP,
            if stops == 0.0 { "0".to_owned() } else { format!("{stops:+}") },
            FontId::proportional(10.0),
            visuals.weak_text_color(),
        );
    }
    let clips = white(display.tone_map);
    let limit = Rect::from_min_max(Pos2::new(x(clips).min(rect.right()), rect.top()), rect.max);
    painter.rect_filled(limit, 0.0, Color32::from_rgb(200, 60, 40).gamma_multiply(0.25));
    let peak = light.bins.iter().copied().max().unwrap_or(1).max(1);
    for (bin, count) in light.bins.iter().enumerate().filter(|(_, count)| **count > 0) {
        let stops = light.ev(bin) - middle;
        if !(SHOWN[0]..SHOWN[1]).contains(&stops) {
            continue;
        }
        // A root leaves what is rare visible.
        let height = (rect.height() - 14.0) * (*count as f32 / peak as f32).sqrt();
        let half = 0.5 * LightHistogram::BIN_EV;
        let bar = Rect::from_min_max(
            Pos2::new(x(stops - half), rect.bottom() - height),
            Pos2::new(x(stops + half), rect.bottom()),
        );
        let fill = if stops > clips { Color32::from_rgb(220, 80, 60) } else { visuals.text_color() };
        painter.rect_filled(bar, 0.0, fill);
    }
    let share = light.share_above(middle + clips);
    if share > 0.0 {
        let text = format!("{:.1} % clip", 100.0 * share);
        let colour = Color32::from_rgb(230, 90, 70);
        painter.text(
            rect.right_top() + Vec2::new(-4.0, 14.0),
            Align2::RIGHT_TOP,
            text,
            FontId::proportional(11.0),
            colour,
        );
    }
    response.on_hover_text("Luminance in stops from middle grey; red is white on the screen");
}

/// What the false colours mean.
fn legend(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(CHART.x, 26.0), Sense::hover());
    let painter = ui.painter_at(rect);
    let width = rect.width() / FALSE_COLOURS.len() as f32;
    for (index, (end, [red, green, blue])) in FALSE_COLOURS.iter().enumerate() {
        let left = rect.left() + width * index as f32;
        let swatch = Rect::from_min_size(Pos2::new(left, rect.top()), Vec2::new(width, 12.0));
        painter.rect_filled(swatch, 0.0, Color32::from_rgb(*red, *green, *blue));
        if end.is_finite() {
            let at = Pos2::new(left + width, rect.top() + 13.0);
            let text = row::number(f64::from(*end));
            painter.text(at, Align2::CENTER_TOP, text, FontId::proportional(10.0), ui.visuals().text_color());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Preset, Quality};

    #[test]
    fn a_correction_brings_the_mean_to_middle_grey() {
        let document = Document::new(Preset::default(), Quality::default());
        let exposure = f64::from(document.preset().scene.display.exposure_ev);
        let mut bins = vec![0; 320];
        bins[160] = 100;
        let light = LightHistogram { lowest_ev: middle_ev(exposure) - 160.0 * LightHistogram::BIN_EV - 2.0, bins };
        let state = HistogramState { light: Some(light), ..HistogramState::default() };
        let correction = state.correction(&document).expect("there is light");
        assert!((correction + 2.0).abs() < 0.1, "two stops darker than grey: {correction}");
        assert_eq!(HistogramState::default().correction(&document), None);
    }
}
