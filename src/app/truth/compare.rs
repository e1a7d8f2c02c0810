//! Measures a realtime picture against a truth, on a thread of its own: it may take a second.

use std::sync::Arc;

use crate::lab::colormap;
use crate::lab::metrics::{Errors, Reference, mask};
use crate::plan::Integrator;
use crate::render::truth::TruthPicture;
use crate::scene::Scene;

/// Ends that the colour scale may have: 0.1 is ten per cent.
const LIMITS: [f32; 8] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0];

/// Light and opacity of a picture.
#[derive(Debug)]
pub(crate) struct Linear {
    rgb: Vec<[f32; 3]>,
    opacity: Vec<f32>,
}

impl Linear {
    pub(super) fn new(picture: &TruthPicture) -> Self {
        Self {
            rgb: picture.image.rgba.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect(),
            opacity: picture.clouds.iter().map(|cloud| 1.0 - cloud[3]).collect(),
        }
    }
}

/// Everything that a comparison needs, owned, so that the window can go on.
#[derive(Debug)]
pub(crate) struct Job {
    /// Which moment it belongs to.
    pub(super) generation: u64,
    pub(super) integrator: Integrator,
    pub(super) scene: Scene,
    pub(super) size: [u32; 2],
    pub(super) still: Arc<Linear>,
    pub(super) truth: TruthPicture,
}

/// What it found.
#[derive(Debug)]
pub(crate) struct Compared {
    pub(super) generation: u64,
    pub(super) integrator: Integrator,
    pub(super) errors: Result<Errors, String>,
    /// Signed and absolute difference in colours.
    pub(super) maps: Option<[egui::ColorImage; 2]>,
    /// Relative difference at the end of the colour scale.
    pub(super) limit: f32,
}

impl Job {
    /// Compares.
    pub(crate) fn run(self) -> Compared {
        let Self { generation, integrator, .. } = self;
        let failed = |error: String| Compared { generation, integrator, errors: Err(error), maps: None, limit: 0.0 };
        self.compare().unwrap_or_else(failed)
    }

    fn compare(self) -> Result<Compared, String> {
        let truth = Linear::new(&self.truth);
        let is_noisy = self.integrator == Integrator::PathTraced;
        // Noise would count clear sky as cloud here and there; where the reference is smooth, what the realtime picture
        // misses must count.
        let opacity: Vec<f32> = if is_noisy {
            self.still.opacity.clone()
        } else {
            self.still.opacity.iter().zip(&truth.opacity).map(|(one, other)| one.max(*other)).collect()
        };
        let cloud = mask::cloud_pixels(&opacity, &self.scene, self.size).ok_or("the pictures differ in size")?;
        let variance: Vec<[f32; 3]> = self.truth.variance.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
        let reference = Reference {
            pixels: &truth.rgb,
            variance: (!variance.is_empty()).then_some(&variance),
            mask: Some(&cloud),
            width: self.size[0] as usize,
        };
        let text = |error: crate::lab::metrics::MetricError| error.to_string();
        let errors = reference.errors(&self.still.rgb).map_err(text)?;
        let map = reference.relative_difference(&self.still.rgb).map_err(text)?;
        let limit = limit(errors.p95_relative.value);
        let colours = |colour: &dyn Fn(f32) -> [u8; 3]| {
            let bytes: Vec<u8> = map.iter().flat_map(|difference| colour(difference / limit)).collect();
            egui::ColorImage::from_rgb(self.size.map(|side| side as usize), &bytes)
        };
        let maps = [colours(&colormap::diverging), colours(&|share| colormap::viridis(share.abs()))];
        let Self { generation, integrator, .. } = self;
        Ok(Compared { generation, integrator, errors: Ok(errors), maps: Some(maps), limit })
    }
}

/// The least end of the scale that keeps 95 % of the cloud's pixels within it.
fn limit(p95: f64) -> f32 {
    LIMITS.into_iter().find(|limit| f64::from(*limit) >= p95).unwrap_or(2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::LinearImage;

    const SIZE: [u32; 2] = [16, 16];

    fn picture(light: f32, variance: Option<f32>) -> TruthPicture {
        let pixels = 256;
        let image = LinearImage {
            size: SIZE,
            rgba: vec![[light, light, light, 1.0]; pixels],
            distance_m: vec![0.0; pixels],
            candela_per_unit: 1.0,
        };
        let variance = variance.map_or_else(Vec::new, |variance| vec![[variance; 4]; pixels]);
        TruthPicture { image, clouds: vec![[light, light, light, 0.5]; pixels], variance }
    }

    fn job(integrator: Integrator, variance: Option<f32>) -> Job {
        let still = Arc::new(Linear::new(&picture(1.1, None)));
        // The sun's disc is behind the camera.
        let mut scene = Scene::default();
        let towards_sun = scene.towards_sun();
        scene.camera.heading_deg = (towards_sun.x.atan2(-towards_sun.z).to_degrees() + 180.0).rem_euclid(360.0);
        Job { generation: 7, integrator, scene, size: SIZE, still, truth: picture(1.0, variance) }
    }

    #[test]
    fn a_tenth_too_bright_is_ten_per_cent_and_red() {
        let compared = job(Integrator::Converged, None).run();
        let errors = compared.errors.expect("there is cloud");
        assert!((errors.rel_rmse.value - 0.1).abs() < 1e-4, "{errors:?}");
        assert_eq!((compared.generation, compared.limit), (7, 0.1));
        let [signed, _] = compared.maps.expect("there are maps");
        let [r, _, b, _] = signed.pixels[0].to_array();
        assert!(r > b, "too bright is red: {:?}", signed.pixels[0]);
    }

    #[test]
    fn the_noise_of_paths_is_subtracted() {
        let errors = job(Integrator::PathTraced, Some(0.0051)).run().errors.expect("there is cloud");
        assert!((errors.rel_mse.value - 0.0049).abs() < 1e-4, "{errors:?}");
    }

    #[test]
    fn pictures_that_cannot_be_compared_say_why() {
        let mut without_light = job(Integrator::Converged, None);
        without_light.truth = picture(0.0, None);
        let compared = without_light.run();
        assert!(compared.maps.is_none() && compared.errors.is_err(), "{compared:?}");
        assert_eq!([limit(0.0), limit(0.06), limit(9.0)], [0.01, 0.1, 2.0]);
    }
}
