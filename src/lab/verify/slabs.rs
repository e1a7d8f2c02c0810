//! Whole frames of clouds whose light is known: homogeneous slabs in plain light, and any cloud in a furnace.

use super::{Check, VerifyError};
use crate::lab::accuracy::{TruthImage, truth};
use crate::render::Renderer;
use crate::render::truth::Goal;
use crate::scene::{
    Camera, CloudLayer, DensityModel, Domain, DomainKind, Phase, PhaseKind, PlainLight, Quality, Scene, Sun, Weather,
};

/// Heights of a slab, and of an eye below and above it, in metres.
const SLAB_M: [f32; 2] = [1000.0, 2000.0];
const EYE_M: [f32; 2] = [500.0, 2500.0];
/// Standard errors that a mean may be off by.
const MOST_SIGMAS: f64 = 3.5;
/// What the picture's own width (a degree) and steps may make of it, relative.
const OWN_ERROR: f64 = 0.002;
/// Radiance, of a sun of irradiance 1, that is rounding: of what it is added to, whose last bit is 1e-8 or less.
const LEAST_LIGHT: f64 = 1e-8;

/// A slab over black ground, a sun of irradiance 1, and a direction of view.
#[derive(Clone, Copy, Debug)]
struct Slab {
    depth: f32,
    albedo: f32,
    g: f32,
    /// Slope of the sun: the cosine of its angle from the zenith.
    sun: f32,
    /// Slope of the view, its azimuth from the sun's in degrees, and whether it looks up from below.
    view: f32,
    azimuth_deg: f32,
    is_up: bool,
}

const fn slab([depth, albedo, g, sun]: [f32; 4], [view, azimuth_deg]: [f32; 2], is_up: bool) -> Slab {
    Slab { depth, albedo, g, sun, view, azimuth_deg, is_up }
}

/// Radiances by DISORT (Stamnes et al. 1988) with 64 streams.
const DISORT: [(Slab, f64); 12] = [
    (slab([1.0, 0.9, 0.5, 0.6], [0.7, 0.0], true), 0.182_925),
    (slab([1.0, 0.9, 0.5, 0.6], [0.4, 60.0], true), 0.088_897),
    (slab([1.0, 0.9, 0.5, 0.6], [0.7, 0.0], false), 0.055_735),
    (slab([1.0, 0.9, 0.5, 0.6], [0.4, 90.0], false), 0.054_954),
    (slab([4.0, 0.999, 0.85, 0.6], [0.7, 0.0], true), 0.390_291),
    (slab([4.0, 0.999, 0.85, 0.6], [0.4, 60.0], true), 0.124_507),
    (slab([4.0, 0.999, 0.85, 0.6], [0.7, 0.0], false), 0.097_280),
    (slab([4.0, 0.999, 0.85, 0.6], [0.4, 90.0], false), 0.079_008),
    (slab([16.0, 0.999, 0.85, 0.5], [0.7, 0.0], true), 0.048_525),
    (slab([16.0, 0.999, 0.85, 0.5], [0.4, 60.0], true), 0.036_160),
    (slab([16.0, 0.999, 0.85, 0.5], [0.7, 0.0], false), 0.142_165),
    (slab([16.0, 0.999, 0.85, 0.5], [0.4, 90.0], false), 0.108_428),
];

impl Slab {
    fn scene(self) -> Scene {
        let per_metre = self.depth / (SLAB_M[1] - SLAB_M[0]);
        let pitch_deg = self.view.asin().to_degrees();
        Scene {
            layers: vec![CloudLayer {
                model: DensityModel::Uniform,
                base_m: SLAB_M[0],
                top_m: SLAB_M[1],
                lean_m: 0.0,
                scattering_per_m: per_metre * self.albedo,
                absorption_per_m: per_metre * (1.0 - self.albedo),
                phase: Phase { kind: PhaseKind::HenyeyGreenstein, g: self.g, ..Phase::default() },
                ..CloudLayer::default()
            }],
            weather: Weather { coverage: 1.0, ..Weather::default() },
            domain: Domain { kind: DomainKind::Flat, ..Domain::default() },
            plain_light: PlainLight { enabled: true, sun_irradiance: 1.0, sky_radiance: 0.0, ..PlainLight::default() },
            sun: Sun { elevation_deg: self.sun.asin().to_degrees(), azimuth_deg: 90.0, ..Sun::default() },
            camera: Camera {
                height_m: EYE_M[usize::from(!self.is_up)],
                heading_deg: 90.0 + self.azimuth_deg,
                pitch_deg: if self.is_up { pitch_deg } else { -pitch_deg },
                field_of_view_deg: 1.0,
                ..Camera::default()
            },
            ..Scene::default()
        }
    }

    /// Light scattered once, in closed form.
    fn scattered_once(self) -> f64 {
        let [depth, view, sun] = [self.depth, self.view, self.sun].map(f64::from);
        let vertical = if self.is_up { view * sun } else { -view * sun };
        let across = ((1.0 - view * view) * (1.0 - sun * sun)).sqrt() * f64::from(self.azimuth_deg).to_radians().cos();
        let g = f64::from(self.g);
        let d = 1.0 + g * g - 2.0 * g * (vertical + across);
        let phase = (1.0 - g * g) / (4.0 * std::f64::consts::PI * d * d.sqrt());
        // Towards the eye and from the sun, along the slab.
        let (rate, start) =
            if self.is_up { (1.0 / view - 1.0 / sun, (-depth / sun).exp()) } else { (1.0 / view + 1.0 / sun, 1.0) };
        f64::from(self.albedo) * phase * start / view * -(-rate * depth).exp_m1() / rate
    }

    fn name(self) -> String {
        let Self { depth, g, sun, view, azimuth_deg, is_up, .. } = self;
        let side = if is_up { "from below" } else { "from above" };
        format!("slab of depth {depth}, g {g}, sun {sun}, seen {side} at {view}, {azimuth_deg}°")
    }
}

/// Mean of the green light of all pixels, and its standard error.
fn mean(image: &TruthImage) -> (f64, f64) {
    let count = image.light().len().max(1) as f64;
    let light: f64 = image.light().iter().map(|pixel| f64::from(pixel[1])).sum();
    let variance: f64 = image.variance().iter().map(|pixel| f64::from(pixel[1])).sum();
    (light / count, variance.sqrt() / count)
}

fn agrees(name: String, (seen, error): (f64, f64), expected: f64) -> Check {
    let own = (OWN_ERROR * expected).max(LEAST_LIGHT);
    let sigmas = (seen - expected) / error.hypot(own);
    let figure = format!("{seen:.5} ± {error:.5}, expected {expected:.5}, {sigmas:+.1} σ");
    Check { name, holds: sigmas.abs() <= MOST_SIGMAS, figure }
}

/// Slabs against their closed form and against DISORT, and the default clouds in a furnace; all of DISORT's cases, and more
/// paths, where `is_full`.
///
/// # Errors
/// [`VerifyError::Truth`].
pub fn analytic(renderer: &mut Renderer, is_full: bool) -> Result<Vec<Check>, VerifyError> {
    let quality = Quality { octaves: 0, ..Quality::default() };
    let (side, stride, paths) = if is_full { (32, 1, 1000) } else { (16, 5, 512) };
    let mut checks = Vec::new();
    for (index, (slab, radiance)) in DISORT.iter().enumerate().step_by(stride) {
        let scene = slab.scene();
        let mut find = |goal| truth(renderer, (&scene, &quality), [side; 2], goal, &mut |_| {});
        let traced = |samples, scatterings| Goal::PathTraced { tolerance: 1e-6, samples, scatterings, seed: 1 };
        // Light that has crossed the thickest slab is noisy.
        let samples = if is_full && index >= 8 { 3400 } else { paths };
        let all = find(traced(samples, None))?;
        checks.push(agrees(format!("{}: paths are DISORT", slab.name()), mean(&all), *radiance));
        let once = slab.scattered_once();
        let single = find(traced(paths, Some(1)))?;
        checks.push(agrees(format!("{}: one scattering of paths", slab.name()), mean(&single), once));
        let march = find(Goal::Converged { tolerance: 1e-4, levels: 8 })?;
        checks.push(agrees(format!("{}: converged march", slab.name()), (mean(&march).0, 0.0), once));
    }
    checks.push(furnace(renderer)?);
    Ok(checks)
}

/// Light of radiance 1 from everywhere, and droplets that absorb nothing: nothing can be seen.
fn furnace(renderer: &mut Renderer) -> Result<Check, VerifyError> {
    let mut scene = Scene::default();
    scene.plain_light = PlainLight {
        enabled: true,
        sun_irradiance: 0.0,
        sky_radiance: 1.0,
        sky_colour: crate::scene::param::Colour::WHITE,
        ..PlainLight::default()
    };
    scene.domain.kind = DomainKind::Flat;
    scene.camera.pitch_deg = 30.0;
    let goal = Goal::PathTraced { tolerance: 1e-6, samples: 16, scatterings: None, seed: 1 };
    let image = truth(renderer, (&scene, &Quality::default()), [24, 14], goal, &mut |_| {})?;
    let cloudy = image.opacity().iter().filter(|opacity| **opacity > 0.5).count();
    let (seen, error) = mean(&image);
    let holds = cloudy > 20 && (seen - 1.0).abs() < 1e-3 + 3.0 * error;
    let figure = format!("{seen:.5} ± {error:.5} with cloud in {cloudy} pixels, expected 1");
    Ok(Check { name: "furnace: clouds that absorb nothing are invisible".to_owned(), holds, figure })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_is_the_integral() {
        for (slab, _) in DISORT {
            let [depth, view, sun] = [slab.depth, slab.view, slab.sun].map(f64::from);
            let steps = 20_000;
            let step = depth / f64::from(steps);
            let sum: f64 = (0..steps)
                .map(|i| {
                    let t = (f64::from(i) + 0.5) * step;
                    let from_sun = if slab.is_up { depth - t } else { t };
                    (-t / view - from_sun / sun).exp() * step / view
                })
                .sum();
            let isotropic = Slab { g: 0.0, albedo: 1.0, ..slab };
            let expected = sum / (4.0 * std::f64::consts::PI);
            let off = isotropic.scattered_once() / expected - 1.0;
            assert!(off.abs() < 1e-5, "{}: {off}", slab.name());
        }
    }

    #[test]
    fn a_mean_that_is_off_is_found() {
        assert!(agrees(String::new(), (1.01, 0.005), 1.0).holds, "two standard errors");
        assert!(!agrees(String::new(), (1.05, 0.005), 1.0).holds, "ten");
        assert!(!agrees(String::new(), (1.02, 0.0), 1.0).holds, "no noise, two per cent");
    }
}
