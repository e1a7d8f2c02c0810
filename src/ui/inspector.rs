//! The inspector: what one point of the picture is, in numbers.

use egui::{Align2, Color32, Context, Grid, Id, Pos2, Rect, Stroke};

use super::row::number;
use crate::render::probe::Probe;

/// What was found at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Picked {
    /// The point, 0 to 1 from the top left of the picture.
    pub at: [f32; 2],
    /// Elevation above the horizon and azimuth clockwise from north, in degrees.
    pub direction_deg: [f32; 2],
    /// Light in cd/m², linear Rec.709.
    pub light: [f32; 3],
    /// The same as the screen shows it.
    pub display: Option<[u8; 3]>,
    /// What of the light behind them the clouds let through, 0 to 1.
    pub transmittance: f32,
    /// Metres to the cloud, weighted by what it adds; `None` where there is none.
    pub distance_m: Option<f32>,
    /// The clouds there; `None` where there are none.
    pub probe: Option<Probe>,
    /// That place: metres to the east, up, and to the south.
    pub position_m: Option<[f32; 3]>,
}

/// Whether points are looked at, and what was found at the last.
#[derive(Clone, Debug, Default)]
pub struct InspectorState {
    /// Whether a click looks at a point.
    pub is_on: bool,
    /// A point that was clicked and not looked at yet.
    pub wish: Option<[f32; 2]>,
    /// What was found.
    pub picked: Option<Picked>,
}

/// Draws what was found in a corner of the picture.
pub(super) fn show(context: &Context, area: Rect, state: &InspectorState) {
    if !state.is_on {
        return;
    }
    let corner = area.right_bottom() - egui::vec2(10.0, 10.0);
    let place = egui::Area::new(Id::unique("inspector")).pivot(Align2::RIGHT_BOTTOM).fixed_pos(corner);
    place.interactable(false).show(context, |ui| {
        egui::Frame::window(&context.global_style()).inner_margin(8.0).show(ui, |ui| match &state.picked {
            None if state.wish.is_some() => drop(ui.weak("Looking…")),
            None => drop(ui.weak("Click a point of the picture (I ends it)")),
            Some(picked) => {
                Grid::new("inspector values").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
                    for (name, value) in lines(picked) {
                        ui.weak(name);
                        ui.label(egui::RichText::new(value).monospace().strong());
                        ui.end_row();
                    }
                });
            }
        });
    });
}

/// Marks the point that was looked at.
pub(super) fn mark(painter: &egui::Painter, place: Rect, state: &InspectorState) {
    let at = state.wish.or(state.picked.as_ref().map(|picked| picked.at)).filter(|_| state.is_on);
    if let Some([u, v]) = at {
        let centre = Pos2::new(place.left() + u * place.width(), place.top() + v * place.height());
        painter.circle_stroke(centre, 5.0, Stroke::new(3.0, Color32::from_black_alpha(160)));
        painter.circle_stroke(centre, 5.0, Stroke::new(1.5, Color32::WHITE));
    }
}

fn lines(picked: &Picked) -> Vec<(&'static str, String)> {
    let exact = |value: f32| number(f64::from(value));
    let [elevation, azimuth] = picked.direction_deg;
    let [red, green, blue] = picked.light;
    let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    let mut lines = vec![
        ("Direction", format!("{elevation:.2}° up, {azimuth:.2}° from north")),
        ("Light", format!("{} {} {} cd/m²", exact(red), exact(green), exact(blue))),
        ("Luminance", format!("{} cd/m²", exact(luminance))),
    ];
    if luminance > 0.0 {
        // The meter's constant of 12.5 at ISO 100: EV = log2(L · 100 / 12.5).
        lines.push(("Exposure value", format!("{:.2} EV", (luminance * 8.0).log2())));
    }
    if let Some([r, g, b]) = picked.display {
        lines.push(("On the screen", format!("{r} {g} {b}")));
    }
    lines.push(("Transmittance", format!("{:.4}", picked.transmittance)));
    match (picked.distance_m, picked.position_m) {
        (Some(distance), Some([east, up, south])) => {
            lines.push(("Distance", format!("{distance:.0} m")));
            lines.push(("Height", format!("{up:.0} m")));
            let side = |value: f32, [above, below]: [&str; 2]| {
                format!("{:.0} m {}", value.abs(), if value < 0.0 { below } else { above })
            };
            let place = [side(east, ["east", "west"]), side(south, ["south", "north"])];
            lines.push(("Place", place.join(", ")));
            if let Some(Probe { densities, extinction_per_m }) = picked.probe {
                let shown = densities.iter().enumerate().filter(|(_, density)| **density > 0.0);
                let shown: Vec<String> =
                    shown.map(|(layer, density)| format!("{density:.3} (layer {})", layer + 1)).collect();
                lines.push(("Density", if shown.is_empty() { "0".to_owned() } else { shown.join(", ") }));
                lines.push(("Extinction", format!("{} /m", exact(extinction_per_m))));
            }
        }
        _ => lines.push(("Distance", "no cloud".to_owned())),
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_not_said() {
        let clear = Picked {
            at: [0.5, 0.5],
            direction_deg: [10.0, 20.0],
            light: [0.0; 3],
            display: None,
            transmittance: 1.0,
            distance_m: None,
            probe: None,
            position_m: None,
        };
        let texts = lines(&clear);
        assert!(texts.contains(&("Distance", "no cloud".to_owned())), "{texts:?}");
        assert!(!texts.iter().any(|(name, _)| *name == "Exposure value"), "black has none: {texts:?}");
        let probe = Some(Probe { densities: [0.0, 0.25, 0.0, 0.0], extinction_per_m: 0.02 });
        let cloud = Picked { distance_m: Some(900.0), position_m: Some([0.0; 3]), probe, ..clear.clone() };
        assert!(lines(&cloud).contains(&("Density", "0.250 (layer 2)".to_owned())), "{:?}", lines(&cloud));
        let grey = Picked { light: [4000.0; 3], ..clear };
        assert!(lines(&grey).contains(&("Exposure value", "14.97 EV".to_owned())), "{:?}", lines(&grey));
    }
}
