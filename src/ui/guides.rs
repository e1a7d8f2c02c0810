//! Guides over the picture: the horizon, azimuths and elevations, thirds, and where the sun is.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Vec2};

use crate::scene::{Scene, direction};

/// Degrees from one line to the next.
const GRID_DEG: u16 = 15;
/// Degrees from one point of a line to the next.
const POINT_DEG: u16 = 3;

/// Draws the guides over a picture.
pub(super) fn paint(painter: &Painter, place: Rect, scene: &Scene) {
    let painter = painter.with_clip_rect(place.intersect(painter.clip_rect()));
    // Only its shape matters.
    let size = [place.width(), place.height()].map(|side| {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a size on the screen")]
        let side = side.max(1.0).round() as u32;
        side
    });
    let at = |elevation: f32, azimuth: f32| {
        let [u, v] = scene.camera.point_of(direction(elevation, azimuth), size)?;
        let is_near = (-1.0..=2.0).contains(&u) && (-1.0..=2.0).contains(&v);
        is_near.then(|| Pos2::new(place.left() + u * place.width(), place.top() + v * place.height()))
    };
    let line = |points: &mut dyn Iterator<Item = Option<Pos2>>, stroke: Stroke| {
        let mut before: Option<Pos2> = None;
        for point in points {
            // A line that leaves one side of a panorama and comes back on the other has no middle.
            if let (Some(from), Some(to)) = (before, point)
                && from.distance(to) < 0.5 * place.width()
            {
                painter.line_segment([from, to], stroke);
            }
            before = point;
        }
    };
    let faint = Stroke::new(1.0, Color32::from_white_alpha(60));
    for azimuth in (0..360).step_by(usize::from(GRID_DEG)).map(|degrees: u16| f32::from(degrees)) {
        line(&mut degrees(-90, 90).map(|elevation| at(elevation, azimuth)), faint);
    }
    for elevation in degrees(-75, 75).filter(|elevation| elevation % f32::from(GRID_DEG) == 0.0) {
        let stroke = if elevation == 0.0 { Stroke::new(1.5, Color32::from_rgb(255, 210, 120)) } else { faint };
        line(&mut degrees(0, 360).map(|azimuth| at(elevation, azimuth)), stroke);
    }
    for share in [1.0 / 3.0, 2.0 / 3.0] {
        let thirds = Stroke::new(1.0, Color32::from_black_alpha(110));
        painter.vline(place.left() + share * place.width(), place.y_range(), thirds);
        painter.hline(place.x_range(), place.top() + share * place.height(), thirds);
    }
    for (name, azimuth) in
        [("N", 0.0), ("NE", 45.0), ("E", 90.0), ("SE", 135.0), ("S", 180.0), ("SW", 225.0), ("W", 270.0), ("NW", 315.0)]
    {
        if let Some(point) = at(0.0, azimuth).filter(|point| place.contains(*point)) {
            label(&painter, point, name);
        }
    }
    let sun = scene.camera.point_of(scene.towards_sun(), size);
    if let Some([u, v]) = sun {
        let centre = Pos2::new(place.left() + u * place.width(), place.top() + v * place.height());
        painter.circle_stroke(centre, 11.0, Stroke::new(3.0, Color32::from_black_alpha(120)));
        painter.circle_stroke(centre, 11.0, Stroke::new(1.5, Color32::from_rgb(255, 210, 120)));
    }
}

/// From one to the other, point by point.
fn degrees(from: i16, to: i16) -> impl Iterator<Item = f32> {
    (from..=to).step_by(usize::from(POINT_DEG)).map(f32::from)
}

fn label(painter: &Painter, at: Pos2, text: &str) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), Color32::WHITE);
    let place = Align2::CENTER_TOP.anchor_size(at + Vec2::new(0.0, 4.0), galley.size());
    painter.rect_filled(place.expand2(Vec2::new(4.0, 1.0)), 3.0, Color32::from_black_alpha(140));
    painter.galley(place.min, galley, Color32::WHITE);
}
