//! A plot drawn into the window: what [`Plot::svg`] is for files, with points that can be clicked.

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui};

use crate::lab::plot::{Plot, Ruler};

/// As the files have them (Okabe and Ito 2008), brighter where the ground is dark.
const COLOURS: [Color32; 6] = [
    Color32::from_rgb(0x2C, 0x92, 0xD4),
    Color32::from_rgb(0xE0, 0x73, 0x1A),
    Color32::from_rgb(0x16, 0xA9, 0x80),
    Color32::from_rgb(0xD0, 0x80, 0xAC),
    Color32::from_rgb(0xE6, 0x9F, 0x00),
    Color32::from_rgb(0x56, 0xB4, 0xE9),
];
const HEIGHT: f32 = 230.0;
/// Room for numbers left of the area and below it, and above it for the legend.
const LEFT: f32 = 44.0;
const BELOW: f32 = 34.0;
const ABOVE: f32 = 20.0;
/// Distance at which the pointer means a point.
const REACH: f32 = 9.0;

#[allow(clippy::cast_possible_truncation, reason = "a share of the plot")]
fn narrow(share: f64) -> f32 {
    share as f32
}

/// Draws it; `names` are those of the points of the first series. Returns the point of the first series that was clicked.
pub(super) fn show(ui: &mut Ui, plot: &Plot, names: &[String]) -> Option<usize> {
    let width = ui.available_width().max(160.0);
    let (whole, response) = ui.allocate_exact_size(egui::vec2(width, HEIGHT), Sense::click());
    let area =
        Rect::from_min_max(whole.min + egui::vec2(LEFT, ABOVE), egui::pos2(whole.max.x - 12.0, whole.max.y - BELOW));
    let rulers = plot.rulers();
    axes(ui, area, plot, &rulers);
    let place = |[x, y]: [f64; 2]| -> Option<Pos2> {
        let share = [rulers[0].place(x).map(narrow)?, rulers[1].place(y).map(narrow)?];
        Some(egui::pos2(area.left() + area.width() * share[0], area.bottom() - area.height() * share[1]))
    };
    let painter = ui.painter_at(whole);
    let ink = ui.visuals().text_color();
    let front: Vec<Pos2> = plot.front.iter().filter_map(|point| place(*point)).collect();
    painter.add(Shape::line(front, Stroke::new(1.5, ink)));
    let mut legend = area.left();
    for (series, colour) in plot.series.iter().zip(COLOURS.into_iter().cycle()) {
        let points: Vec<Pos2> = series.points.iter().filter_map(|point| place(*point)).collect();
        if series.joined {
            painter.add(Shape::line(points.clone(), Stroke::new(1.5, colour)));
        }
        for point in points {
            painter.circle(point, 4.0, colour, Stroke::new(1.0, ui.visuals().window_fill()));
        }
        painter.circle_filled(egui::pos2(legend + 5.0, whole.top() + 9.0), 4.0, colour);
        let corner = egui::pos2(legend + 13.0, whole.top() + 9.0);
        let text = painter.text(corner, Align2::LEFT_CENTER, &series.name, FontId::proportional(11.5), ink);
        legend = text.right() + 14.0;
    }
    if let Some(current) = plot.current.and_then(place) {
        painter.circle_stroke(current, 8.0, Stroke::new(2.0, ink));
        painter.circle_stroke(egui::pos2(legend + 6.0, whole.top() + 9.0), 5.0, Stroke::new(2.0, ink));
        let corner = egui::pos2(legend + 15.0, whole.top() + 9.0);
        painter.text(corner, Align2::LEFT_CENTER, "in use · line: front", FontId::proportional(11.5), ink);
    }
    let pointer = response.hover_pos()?;
    let first = plot.series.first()?;
    let near = first.points.iter().enumerate().filter_map(|(index, point)| {
        let distance = place(*point)?.distance(pointer);
        (distance < REACH).then_some((index, distance))
    });
    let (index, _) = near.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let [x, y] = first.points[index];
    if let Some(name) = names.get(index) {
        response.clone().on_hover_text_at_pointer(format!("{name}\n{x:.1} ms, {y:.2} %\nClick to use it"));
    }
    response.clicked().then_some(index)
}

fn axes(ui: &Ui, area: Rect, plot: &Plot, rulers: &[Ruler; 2]) {
    let painter = ui.painter();
    let (ink, grid) = (ui.visuals().text_color(), ui.visuals().widgets.noninteractive.bg_stroke.color);
    let font = FontId::proportional(10.5);
    painter.rect(area, 0.0, ui.visuals().extreme_bg_color, Stroke::new(1.0, grid), egui::StrokeKind::Inside);
    for (side, ruler) in rulers.iter().enumerate() {
        for (log, number) in &ruler.ticks {
            let share = narrow((log - ruler.range[0]) / (ruler.range[1] - ruler.range[0]));
            let (from, to, at, anchor) = if side == 0 {
                let x = area.left() + area.width() * share;
                let at = egui::pos2(x, area.bottom() + 3.0);
                (egui::pos2(x, area.top()), egui::pos2(x, area.bottom()), at, Align2::CENTER_TOP)
            } else {
                let y = area.bottom() - area.height() * share;
                let at = egui::pos2(area.left() - 5.0, y);
                (egui::pos2(area.left(), y), egui::pos2(area.right(), y), at, Align2::RIGHT_CENTER)
            };
            let strength = if number.is_some() { 1.0 } else { 0.35 };
            painter.line_segment([from, to], Stroke::new(1.0, grid.gamma_multiply(strength)));
            if let Some(number) = number {
                painter.text(at, anchor, number, font.clone(), ink);
            }
        }
    }
    let below = egui::pos2(area.center().x, area.bottom() + 17.0);
    painter.text(below, Align2::CENTER_TOP, &plot.x_label, font.clone(), ink);
    let beside = egui::pos2(area.left() + 4.0, area.top() + 3.0);
    painter.text(beside, Align2::LEFT_TOP, &plot.y_label, font, ink);
}
