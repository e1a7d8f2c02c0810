//! Which pixels a figure is about.
//!
//! Errors of clouds belong over clouds: over clear sky every setting is right, and a picture with more of it would look
//! more accurate. The sun's disc is thousands of times brighter than all else and would decide any figure.

use glam::Vec3;

use crate::scene::{Camera, Projection, Scene, direction};

/// Opacity 1 − T above which a pixel holds cloud.
pub const CLOUD_OPACITY: f32 = 0.01;

/// Pixels of cloud: opacity 1 − T, T being the transmittance of the clouds before the pixel, above [`CLOUD_OPACITY`]. NaN
/// is no cloud.
pub fn clouds(opacity: &[f32]) -> Vec<bool> {
    opacity.iter().map(|opacity| *opacity > CLOUD_OPACITY).collect()
}

/// Pixels that errors of clouds are measured in: [`clouds`] without [`sun_disc`]. `None` if there are not as many
/// opacities as pixels.
pub fn cloud_pixels(opacity: &[f32], scene: &Scene, size: [u32; 2]) -> Option<Vec<bool>> {
    without(&clouds(opacity), &sun_disc(scene, size))
}

/// Pixels whose values are all finite.
pub fn finite(pixels: &[[f32; 3]]) -> Vec<bool> {
    pixels.iter().map(|pixel| pixel.iter().all(|value| value.is_finite())).collect()
}

/// Pixels that the sun's disc touches in a picture of that size, whether clouds hide it or not.
pub fn sun_disc(scene: &Scene, size: [u32; 2]) -> Vec<bool> {
    let towards_sun = scene.towards_sun();
    // A pixel's own height on top: the disc has a soft edge, and its pixels are left out as a whole.
    let reach = scene.sun.radius_deg.to_radians() + pixel_rad(&scene.camera, size);
    let touches = |dir: Vec3| dir.angle_between(towards_sun) < reach;
    directions(&scene.camera, size).map(touches).collect()
}

/// Pixels that are in the first mask and not in the second. `None` if they have different lengths.
pub fn without(mask: &[bool], left_out: &[bool]) -> Option<Vec<bool>> {
    (mask.len() == left_out.len()).then(|| mask.iter().zip(left_out).map(|(a, b)| *a && !b).collect())
}

/// Height of a pixel in the middle of the picture, in radians.
fn pixel_rad(camera: &Camera, size: [u32; 2]) -> f32 {
    let whole_rad = match camera.projection {
        Projection::Perspective => 2.0 * camera.half_tangents(size)[1].atan(),
        Projection::Equirect => std::f32::consts::PI,
        Projection::Dome => std::f32::consts::FRAC_PI_2,
    };
    whole_rad / size[1].max(1) as f32
}

/// Unit vectors through the middles of the pixels, row by row; what `ray_through` is in the shaders.
pub(in crate::lab) fn directions(camera: &Camera, [width, height]: [u32; 2]) -> impl Iterator<Item = Vec3> {
    let [forward, right, up] = camera.axes();
    let [across, high] = camera.half_tangents([width, height.max(1)]);
    let (right_edge, up_edge) = (right * across, up * high);
    let (projection, heading_deg) = (camera.projection, camera.heading_deg);
    (0..height).flat_map(move |row| {
        (0..width).map(move |column| {
            let (u, v) = ((column as f32 + 0.5) / width as f32, (row as f32 + 0.5) / height as f32);
            let azimuth_deg = heading_deg + (u - 0.5) * 360.0;
            match projection {
                Projection::Perspective => {
                    (forward + (2.0 * u - 1.0) * right_edge - (2.0 * v - 1.0) * up_edge).normalize()
                }
                Projection::Equirect => direction((0.5 - v) * 180.0, azimuth_deg),
                Projection::Dome => direction((0.5 - 0.5 * v) * 180.0, azimuth_deg),
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facing_the_sun(projection: Projection) -> Scene {
        let mut scene = Scene::default();
        let towards_sun = scene.towards_sun();
        scene.camera.heading_deg = towards_sun.x.atan2(-towards_sun.z).to_degrees().rem_euclid(360.0);
        scene.camera.pitch_deg = towards_sun.y.asin().to_degrees();
        scene.camera.projection = projection;
        scene.sun.radius_deg = 5.0;
        scene
    }

    /// Pixels in the mask, and the mean of their columns and rows.
    fn centre(mask: &[bool], width: usize) -> (f32, [f32; 2]) {
        let inside: Vec<usize> = (0..mask.len()).filter(|pixel| mask[*pixel]).collect();
        let count = inside.len() as f32;
        let sum = |part: fn(usize, usize) -> usize| inside.iter().map(|pixel| part(*pixel, width) as f32).sum::<f32>();
        (count, [sum(|pixel, width| pixel % width) / count, sum(|pixel, width| pixel / width) / count])
    }

    #[test]
    fn a_camera_that_faces_the_sun_has_it_in_the_middle() {
        let scene = facing_the_sun(Projection::Perspective);
        let (count, [column, row]) = centre(&sun_disc(&scene, [161, 91]), 161);
        assert!((column - 80.0).abs() < 0.1 && (row - 45.0).abs() < 0.1, "around ({column}, {row})");
        // 25° to the edge are 45.5 pixels, and the radius is 5° and one pixel of 0.55°.
        let radius = 45.5 * 5.55_f32.to_radians().tan() / 25_f32.to_radians().tan();
        let expected = std::f32::consts::PI * radius * radius;
        assert!((count / expected - 1.0).abs() < 0.05, "{count} pixels instead of {expected}");
    }

    #[test]
    fn clouds_before_the_sun_do_not_count() {
        let scene = facing_the_sun(Projection::Perspective);
        let pixels = cloud_pixels(&[1.0; 31 * 31], &scene, [31, 31]).expect("as many as pixels");
        assert!(!pixels[15 * 31 + 15] && pixels[0], "the sun is in the middle, cloud in the corner");
        assert_eq!(cloud_pixels(&[1.0; 30], &scene, [31, 31]), None);
    }

    #[test]
    fn panoramas_have_the_sun_at_its_height_in_the_middle_column() {
        for (projection, top, bottom) in [(Projection::Equirect, 90.0, -90.0), (Projection::Dome, 90.0, 0.0)] {
            let scene = facing_the_sun(projection);
            let (count, [column, row]) = centre(&sun_disc(&scene, [361, 180]), 361);
            let elevation = top + (bottom - top) * (row + 0.5) / 180.0;
            assert!(count > 50.0 && (column - 180.0).abs() < 0.1, "{projection:?}: {count} pixels around {column}");
            // The widening of a panorama towards the zenith draws the mean of the rows up a little.
            assert!((elevation - scene.camera.pitch_deg).abs() < 1.0, "{projection:?}: {elevation}°");
        }
    }

    #[test]
    fn east_is_right_of_north_and_up_is_up() {
        let camera = Camera { heading_deg: 0.0, pitch_deg: 0.0, ..Camera::default() };
        let rays: Vec<Vec3> = directions(&camera, [3, 3]).collect();
        assert!(rays[4].abs_diff_eq(Vec3::NEG_Z, 1e-6), "{}", rays[4]);
        assert!(rays[5].x > 0.1 && rays[3].x < -0.1 && rays[1].y > 0.1 && rays[7].y < -0.1, "{rays:?}");
    }

    #[test]
    fn clouds_are_what_hides_more_than_a_hundredth() {
        let seen = clouds(&[0.0, 0.01, 0.011, 1.0, f32::NAN]);
        assert_eq!(seen, [false, false, true, true, false]);
        assert_eq!(without(&seen, &[false, false, false, true, false]), Some(vec![false, false, true, false, false]));
        assert_eq!(without(&seen, &[true]), None);
        assert_eq!(finite(&[[0.0; 3], [0.0, f32::NAN, 0.0], [f32::INFINITY; 3]]), [true, false, false]);
        assert_eq!(sun_disc(&Scene::default(), [0, 0]), Vec::<bool>::new());
    }
}
