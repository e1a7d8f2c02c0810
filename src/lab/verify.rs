//! Checks of whole frames that take their time: a build, or a driver, keeps what the program promises of every sky.
//!
//! The two reference integrators share the density, the phase functions and the tables of the air, and nothing of how
//! they walk through them. With single scattering of the key light alone both have to see the same picture: the converged
//! march up to its last halving of steps, paths up to their noise.

mod hard;
mod models;
pub mod skies;
mod slabs;

use glam::UVec3;

use super::accuracy::{AccuracyError, TruthImage, truth};
use crate::gpu::GpuError;
use crate::plan::Lighting;
use crate::reference::random::{pcg3d, unit_from_bits};
use crate::render::truth::{Convergence, Goal};
use crate::render::{RenderError, Renderer};
use crate::scene::param::Choice as _;
use crate::scene::{CloudLayer, Frame, Output, Quality, Scene};

pub use hard::hard_cases;
pub use slabs::analytic;

/// Where the converged march stops.
const TOLERANCE: f32 = 0.003;
/// What neighbouring pixels of the converged march may still be off by together, relative; the whole is nearer.
const POOL_TOLERANCE: f64 = 0.005;
/// Pixels that are judged together: a path that finds its way out of dark cloud is so rare that the spread of a single
/// pixel's paths says little.
const POOL: usize = 16;
/// Pixels with less opacity do not count as cloud.
const CLOUD: f32 = 0.01;
/// Largest deviation of the whole picture, in standard errors: one in 16,000 is beyond by chance.
const MOST_SIGMAS: f64 = 4.0;
/// Largest share of pools beyond three standard errors. By chance it is 0.003; in the dark the errors themselves are
/// uncertain.
const MOST_BEYOND: f64 = 0.03;

/// One promise and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// What was checked, of which sky.
    pub name: String,
    /// Whether it holds.
    pub holds: bool,
    /// The figure that says so.
    pub figure: String,
}

/// Why a check could not be made.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// A truth could not be found.
    #[error(transparent)]
    Truth(#[from] AccuracyError),
    /// A picture could not be made.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A picture could not be read back.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// How two pictures of the same light agree.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Agreement {
    pixels: usize,
    /// Sum of the differences in standard errors of that sum.
    sigmas: f64,
    /// Share of pools of pixels beyond three of their own.
    beyond: f64,
    /// Difference of the means, relative.
    relative: f64,
}

fn agreement(seen: &[f64], variance: &[f64], expected: &[f64]) -> Agreement {
    let total: f64 = expected.iter().sum();
    let (mut difference, mut noise, mut beyond) = (0.0, 0.0, 0usize);
    let pools = || expected.chunks(POOL).zip(seen.chunks(POOL)).zip(variance.chunks(POOL));
    // Below a fifth of the mean, tolerance does not get smaller.
    let dark = 0.2 * total / pools().count().max(1) as f64;
    for ((expected, seen), variance) in pools() {
        let [light, seen, variance] = [expected, seen, variance].map(|pool| pool.iter().sum::<f64>());
        let spread = variance.sqrt().hypot(POOL_TOLERANCE * (light + dark));
        beyond += usize::from((seen - light).abs() > 3.0 * spread);
        difference += seen - light;
        noise += variance;
    }
    let error = noise.sqrt().hypot(f64::from(TOLERANCE) * total).max(f64::MIN_POSITIVE);
    Agreement {
        pixels: expected.len(),
        sigmas: difference / error,
        beyond: beyond as f64 / pools().count().max(1) as f64,
        relative: difference / total.max(f64::MIN_POSITIVE),
    }
}

impl Agreement {
    fn holds(&self) -> bool {
        self.sigmas.abs() <= MOST_SIGMAS && self.beyond <= MOST_BEYOND
    }

    fn figure(&self) -> String {
        format!(
            "{:+.2} % off, {:+.1} σ; {:.1} % of {} pixels, {POOL} by {POOL}, beyond 3 σ",
            self.relative * 100.0,
            self.sigmas,
            self.beyond * 100.0,
            self.pixels
        )
    }
}

/// Extinction of the clouds that are compared, relative to the sky's own. Through a thick deck light scattered once hardly
/// passes, and the few paths that see any say little.
const THINNING: f32 = 0.05;
/// Optical depth towards the light through all layers that is left at most: under a closed sheet of more, light scattered once
/// is a matter of luck, and so is the spread of its paths.
const THICKEST: f32 = 3.0;
/// Least sine of the light's elevation that counts: lower ways are curved.
const LOWEST_SINE: f32 = 0.03;

/// The sky as both integrators can see it: the key light scattered once, no other light on the clouds, no air before
/// them, the same extinction towards the light as along the ray, and thin enough for light to pass.
fn single_scattering(scene: &Scene) -> Scene {
    let mut single = scene.clone();
    single.scattering.ambient = 0.0;
    single.air.aerial_perspective = false;
    single.sunshafts.strength = 0.0;
    let depth_of = |layer: &CloudLayer| layer.extinction_per_m() * layer.density * (layer.top_m - layer.base_m);
    let sine = Lighting::new(scene).towards_key.y.abs().max(LOWEST_SINE);
    let depth = scene.visible_layers().map(depth_of).sum::<f32>() / sine;
    let thinning = THINNING.min(THICKEST / depth.max(f32::MIN_POSITIVE));
    for layer in &mut single.layers {
        *layer = layer.with_given_optics();
        layer.shadow_extinction_scale = 1.0;
        layer.scattering_per_m *= thinning;
        layer.absorption_per_m *= thinning;
    }
    single
}

fn fault_check(name: &str, image: &TruthImage) -> Check {
    let counts = image.progress.counts;
    Check {
        name: format!("{name}: {}, nothing over its bound, nothing cut short", image.integrator.title().to_lowercase()),
        holds: counts.exceeded == 0 && counts.cut == 0,
        figure: format!("{} over, {} cut", counts.exceeded, counts.cut),
    }
}

/// Paths of one scattering against the converged march without octaves, pixel by pixel.
///
/// # Errors
/// [`VerifyError::Truth`].
pub fn single_scattering_agrees(
    renderer: &mut Renderer,
    (name, scene): (&str, &Scene),
    (size, paths): ([u32; 2], u32),
    watch: &mut dyn FnMut(&Convergence),
) -> Result<Vec<Check>, VerifyError> {
    let scene = single_scattering(scene);
    let quality = Quality { octaves: 0, ..Quality::default() };
    let of = (&scene, &quality);
    let converged = truth(renderer, of, size, Goal::Converged { tolerance: TOLERANCE, levels: 8 }, watch)?;
    let goal = Goal::PathTraced { tolerance: 1e-6, samples: paths, scatterings: Some(1), seed: 1 };
    let traced = truth(renderer, of, size, goal, watch)?;
    let cloudy: Vec<usize> = (0..converged.opacity().len()).filter(|at| converged.opacity()[*at] > CLOUD).collect();
    let green = |pixels: &[[f32; 3]]| -> Vec<f64> { cloudy.iter().map(|at| f64::from(pixels[*at][1])).collect() };
    let found = agreement(&green(traced.light()), &green(traced.variance()), &green(converged.light()));
    let agrees = Check {
        name: format!("{name}: one scattering of paths is the converged march"),
        holds: found.pixels > 0 && found.holds(),
        figure: found.figure(),
    };
    Ok(vec![agrees, fault_check(name, &converged), fault_check(name, &traced)])
}

/// A camera and a sun that nobody chose, by a hash of `index`: anywhere from the ground to above the clouds, at any hour.
pub fn anywhere(scene: &Scene, index: u32) -> Scene {
    let mut scene = scene.clone();
    let draw = |salt: u32| f64::from(unit_from_bits(pcg3d(UVec3::new(index, salt, 0)).x));
    #[allow(clippy::cast_possible_truncation, reason = "a place, to single precision")]
    let between = |low: f64, high: f64, salt: u32| (low + (high - low) * draw(salt)) as f32;
    scene.camera.height_m = 2.0 + between(0.0, 1.0, 1).powi(2) * 9000.0;
    scene.camera.east_m = between(-40_000.0, 40_000.0, 2);
    scene.camera.south_m = between(-40_000.0, 40_000.0, 3);
    scene.camera.heading_deg = between(0.0, 360.0, 4);
    scene.camera.pitch_deg = between(-40.0, 60.0, 5);
    scene.sun.elevation_deg = between(-8.0, 85.0, 6);
    scene.sun.azimuth_deg = between(0.0, 360.0, 7);
    scene
}

/// The realtime picture has no value that is not finite or is negative, from `views` places that nobody chose.
///
/// # Errors
/// [`VerifyError::Render`] and [`VerifyError::Gpu`].
pub fn stays_finite(
    renderer: &mut Renderer,
    (name, scene): (&str, &Scene),
    (size, views): ([u32; 2], u32),
) -> Result<Check, VerifyError> {
    let quality = Quality::default().of_still();
    let mut broken = Vec::new();
    for index in 0..views {
        let scene = anywhere(scene, index);
        renderer.render(&Frame {
            scene: &scene,
            quality: &quality,
            size,
            time_secs: 0.0,
            output: Output::Linear,
            window: None,
        })?;
        let clouds = renderer.clouds()?;
        let light = renderer.linear()?.rgba;
        let is_fine = |pixel: &[f32; 4]| pixel.iter().all(|value| value.is_finite() && *value >= 0.0);
        if !light.iter().chain(&clouds).all(is_fine) {
            broken.push(index.to_string());
        }
    }
    let figure = if broken.is_empty() {
        format!("{views} views")
    } else {
        format!("broken in {} of {views} views: {}", broken.len(), broken.join(", "))
    };
    Ok(Check { name: format!("{name}: finite from anywhere, at any hour"), holds: broken.is_empty(), figure })
}

impl Check {
    /// Its line in a report.
    pub fn line(&self) -> String {
        format!("{}  {}: {}", if self.holds { "ok  " } else { "FAIL" }, self.name, self.figure)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal deviates of variance 1, by the sum of twelve draws.
    fn noise(index: u32) -> f64 {
        (0..12).map(|k| f64::from(unit_from_bits(pcg3d(UVec3::new(index, k, 1)).x))).sum::<f64>() - 6.0
    }

    #[test]
    fn noise_passes_and_a_bias_of_two_per_cent_does_not() {
        let expected = vec![1.0; 4000];
        let variance = vec![0.0025; 4000];
        let seen = |bias: f64| -> Vec<f64> { (0..4000).map(|at| 1.0 + bias + 0.05 * noise(at)).collect() };
        let fine = agreement(&seen(0.0), &variance, &expected);
        assert!(fine.holds() && fine.beyond < 0.006, "{fine:?}");
        let biased = agreement(&seen(0.02), &variance, &expected);
        assert!(!biased.holds(), "{biased:?}");
    }

    #[test]
    fn a_few_wrong_pixels_are_found_though_the_mean_is_right() {
        let expected = vec![1.0; 1000];
        let seen: Vec<f64> = (0..1000).map(|at| if at % 20 == 0 { 1.5 } else { 1.0 - 0.5 / 19.0 }).collect();
        let found = agreement(&seen, &vec![1e-4; 1000], &expected);
        assert!(found.sigmas.abs() < 1.0 && !found.holds(), "{found:?}");
    }

    #[test]
    fn nobody_chose_the_views_and_they_differ() {
        let views: Vec<f32> = (0..20).map(|index| anywhere(&Scene::default(), index).camera.height_m).collect();
        assert!(views.iter().any(|height| *height < 500.0) && views.iter().any(|height| *height > 4000.0), "{views:?}");
    }
}
