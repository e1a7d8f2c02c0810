//! Where the clouds of a picture will be in the next frame, in pixels: for motion blur and retiming.

use glam::DVec3;

use crate::render::LinearImage;
use crate::render::uniforms::wind_mps;
use crate::scene::{Camera, Scene, Window};

fn eye(camera: &Camera) -> DVec3 {
    DVec3::new(camera.east_m.into(), camera.height_m.into(), camera.south_m.into())
}

/// Motion of every pixel to the right and downwards until the sky is `next`, `seconds` later: of its clouds, carried by the wind
/// and seen from a camera that may move. 0 where there is no cloud, or it leaves the picture's side of the eye. The part at
/// `window`, if there is one, counts in pixels of the whole.
#[allow(clippy::cast_possible_truncation, reason = "pixels to single precision")]
pub(super) fn motion(
    image: &LinearImage,
    window: Option<Window>,
    (now, next): (&Scene, &Scene),
    seconds: f64,
) -> [Vec<f32>; 2] {
    let (offset, whole) = window.map_or(([0, 0], image.size), |window| (window.offset, window.whole));
    let [width, height] = whole.map(|side| side as f32);
    let layer_scale = now.visible_layers().next().map_or(1.0, |layer| f64::from(layer.wind_scale));
    let wind = wind_mps(&now.wind) * layer_scale * seconds;
    let shift = DVec3::new(wind.x, 0.0, wind.y) + eye(&now.camera) - eye(&next.camera);
    let moved = |index: usize, distance_m: f32| {
        let (x, y) = crate::images::position(index, image.size[0]);
        let at = [(offset[0] + x) as f32 + 0.5, (offset[1] + y) as f32 + 0.5];
        let towards = now.camera.direction_through([at[0] / width, at[1] / height], whole);
        let place = towards.as_dvec3() * f64::from(distance_m) + shift;
        let [u, v] = next.camera.point_of(place.normalize_or_zero().as_vec3(), whole)?;
        Some([u * width - at[0], v * height - at[1]])
    };
    let all = image.distance_m.iter().enumerate().map(|(index, distance_m)| {
        let motion = if *distance_m > 0.0 { moved(index, *distance_m) } else { None };
        motion.filter(|motion| motion.iter().all(|part| part.is_finite())).unwrap_or_default()
    });
    all.map(|[across, down]| (across, down)).unzip::<f32, f32, Vec<f32>, Vec<f32>>().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(size: [u32; 2], distance_m: f32) -> LinearImage {
        let count = (size[0] * size[1]) as usize;
        LinearImage { size, rgba: vec![[0.0; 4]; count], distance_m: vec![distance_m; count], candela_per_unit: 1.0 }
    }

    #[test]
    fn clouds_move_as_wind_and_camera_say() {
        let camera = Camera { pitch_deg: 0.0, heading_deg: 0.0, field_of_view_deg: 90.0, ..Camera::default() };
        let mut now = Scene { camera, ..Scene::default() };
        // From the west: to the right, looking north.
        (now.wind.from_deg, now.wind.speed_mps) = (270.0, 10.0);
        let [across, down] = motion(&picture([100, 100], 1000.0), None, (&now, &now), 2.0);
        // 20 m at 1000 m, where 90 degrees are 100 pixels: one pixel in the middle.
        let middle = 50 * 100 + 50;
        assert!(
            (across[middle] - 1.0).abs() < 0.02 && down[middle].abs() < 0.02,
            "{} {}",
            across[middle],
            down[middle]
        );
        let mut next = now.clone();
        next.camera.east_m += 20.0;
        let [across, _] = motion(&picture([100, 100], 1000.0), None, (&now, &next), 2.0);
        assert!(across[middle].abs() < 0.02, "carried along: {}", across[middle]);
        next.camera.heading_deg = 9.0;
        let [across, _] = motion(&picture([100, 100], 1000.0), None, (&now, &next), 2.0);
        assert!(across[middle] < -7.0, "turned to the right: {}", across[middle]);
        let window = Some(Window { offset: [50, 50], whole: [100, 100] });
        let [part, _] = motion(&picture([10, 10], 1000.0), window, (&now, &next), 2.0);
        assert!((part[0] - across[middle]).abs() < 1e-4, "a part is the same as in the whole");
        let [clear, _] = motion(&picture([4, 4], 0.0), None, (&now, &next), 2.0);
        assert!(clear.iter().all(|part| *part == 0.0), "no cloud, no motion");
    }
}
