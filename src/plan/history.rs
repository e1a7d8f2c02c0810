//! What a picture may take over from the one before.

use crate::scene::{Camera, Display, Frame, Quality, Scene, UpdateFraction, UpdateOrder, Window};

/// Cross order, figure 3.3(c) of Koblížek 2019, zero-based: the phase in which each pixel of a block is computed.
const CROSS: [u32; 16] = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5];
/// Multiples of seven, figure 3.3(b).
const SEVENS: [u32; 16] = [0, 7, 14, 5, 12, 3, 10, 1, 8, 15, 6, 13, 4, 11, 2, 9];

/// Which pixels of each block are computed when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UpdatePattern {
    fraction: UpdateFraction,
    order: UpdateOrder,
}

impl UpdatePattern {
    /// The pattern of a fraction, in an order.
    pub fn new(fraction: UpdateFraction, order: UpdateOrder) -> Self {
        Self { fraction, order }
    }

    /// Frames until every pixel was computed once.
    pub fn phases(self) -> u32 {
        match self.fraction {
            UpdateFraction::Full => 1,
            UpdateFraction::Half => 2,
            UpdateFraction::Quarter => 4,
            UpdateFraction::Sixteenth => 16,
        }
    }

    /// Pixels per ray, across and down.
    pub fn block(self) -> [u32; 2] {
        match self.fraction {
            UpdateFraction::Full => [1, 1],
            UpdateFraction::Half => [2, 1],
            UpdateFraction::Quarter => [2, 2],
            UpdateFraction::Sixteenth => [4, 4],
        }
    }

    /// Whether every other row takes the other pixel.
    pub fn is_checkerboard(self) -> bool {
        self.fraction == UpdateFraction::Half
    }

    /// The pixel of a block that a phase computes.
    pub fn offset(self, phase: u32) -> [u32; 2] {
        let phase = phase % self.phases();
        match self.fraction {
            UpdateFraction::Full => [0, 0],
            UpdateFraction::Half => [phase, 0],
            UpdateFraction::Quarter => [[0, 0], [1, 1], [1, 0], [0, 1]][phase as usize],
            UpdateFraction::Sixteenth => {
                let place = match self.order {
                    UpdateOrder::Naive => phase,
                    UpdateOrder::Sevens => position(&SEVENS, phase),
                    UpdateOrder::Cross => position(&CROSS, phase),
                };
                [place % 4, place / 4]
            }
        }
    }
}

fn position(order: &[u32; 16], phase: u32) -> u32 {
    (0..16).find(|place| order[*place as usize] == phase).unwrap_or(0)
}

/// Everything that makes a picture worthless for the next one when it changes. Camera and time are not in it, for they
/// are reprojected; exposure and tone map come after.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryKey {
    scene: Scene,
    quality: Quality,
    size: [u32; 2],
    window: Option<Window>,
}

impl HistoryKey {
    /// The key of a frame.
    pub fn new(frame: &Frame<'_>) -> Self {
        let lens = Camera {
            projection: frame.scene.camera.projection,
            field_of_view_deg: frame.scene.camera.field_of_view_deg,
            field_of_view_axis: frame.scene.camera.field_of_view_axis,
            ..Camera::default()
        };
        Self {
            scene: Scene { camera: lens, display: Display::default(), ..frame.scene.clone() },
            quality: frame.quality.clone(),
            size: frame.render_size(),
            window: frame.window,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::scene::Output;

    #[test]
    fn every_pixel_gets_its_turn_once() {
        for fraction in [UpdateFraction::Full, UpdateFraction::Half, UpdateFraction::Quarter, UpdateFraction::Sixteenth]
        {
            for order in [UpdateOrder::Cross, UpdateOrder::Sevens, UpdateOrder::Naive] {
                let pattern = UpdatePattern::new(fraction, order);
                let places: BTreeSet<[u32; 2]> = (0..pattern.phases()).map(|phase| pattern.offset(phase)).collect();
                assert_eq!(places.len(), pattern.phases() as usize, "{fraction:?} {order:?}");
                let [width, height] = pattern.block();
                assert!(places.iter().all(|[x, y]| *x < width && *y < height), "{fraction:?} stays in its block");
            }
        }
    }

    #[test]
    fn the_orders_are_those_of_the_thesis() {
        let sixteenth = |order| UpdatePattern::new(UpdateFraction::Sixteenth, order);
        assert_eq!(sixteenth(UpdateOrder::Cross).offset(1), [2, 2], "cross: 2 stands in the third row, third column");
        assert_eq!(sixteenth(UpdateOrder::Sevens).offset(1), [3, 1], "×7: 2 stands in the second row, fourth column");
        assert_eq!(sixteenth(UpdateOrder::Naive).offset(5), [1, 1]);
    }

    #[test]
    fn camera_and_exposure_keep_history_and_clouds_do_not() {
        let quality = Quality::default();
        let key = |scene: &Scene| {
            HistoryKey::new(&Frame {
                scene,
                quality: &quality,
                size: [64, 36],
                time_secs: 0.0,
                output: Output::Display,
                window: None,
            })
        };
        let scene = Scene::default();
        let mut moved = scene.clone();
        moved.camera.heading_deg = 90.0;
        moved.display.exposure_ev = 3.0;
        assert_eq!(key(&scene), key(&moved));
        let mut changed = scene.clone();
        changed.weather.coverage = 0.9;
        assert_ne!(key(&scene), key(&changed));
        let mut zoomed = scene.clone();
        zoomed.camera.field_of_view_deg = 20.0;
        assert_ne!(key(&scene), key(&zoomed), "another lens is another picture");
    }
}
