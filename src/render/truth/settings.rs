//! What a truth aims at, and how its error is estimated.

use crate::plan::Integrator;

/// Where a truth stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The march's model, refined until the picture changes by no more than `tolerance` when steps are halved.
    Converged {
        /// Relative change, root mean square over pixels with cloud.
        tolerance: f32,
        /// Levels of the ladder at most; the first is level 0.
        levels: u32,
    },
    /// Paths, until the standard error is within `tolerance` or each pixel has `samples`.
    PathTraced {
        /// Relative standard error, root mean square over pixels with cloud.
        tolerance: f32,
        /// Paths of each pixel at most.
        samples: u32,
        /// Most scatterings of a path: 1 is single scattering, `None` leaves none out.
        scatterings: Option<u32>,
        /// Seed; another one gives independent paths.
        seed: u32,
    },
}

impl Goal {
    /// Whose goal it is.
    pub fn integrator(self) -> Integrator {
        match self {
            Self::Converged { .. } => Integrator::Converged,
            Self::PathTraced { .. } => Integrator::PathTraced,
        }
    }
}

/// Steps of one level of the ladder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// First step along a ray, in metres.
    pub view_step_m: f32,
    /// Growth of the step, in metres per metre.
    pub view_growth: f32,
    /// Steps towards the light.
    pub light_steps: u32,
}

impl Level {
    /// Level 0 is about as fine as the thesis's march; each level halves all steps.
    pub fn new(level: u32) -> Self {
        let halved = 0.5f32.powi(level.min(16).cast_signed());
        Self { view_step_m: 32.0 * halved, view_growth: 0.004 * halved, light_steps: 12 << level.min(8) }
    }
}

/// Least opacity of a pixel that counts as cloud.
const CLOUD: f32 = 0.01;

/// Root mean square of a difference per pixel, relative to a reference's light: `sqrt(mean(d² / (r² + ε)))` over channels
/// of pixels with cloud, with ε = (0.01 · mean r)². Light is in `[0..3]`, the clouds' opacity in `[3]`.
fn relative_rms(reference: &[[f32; 4]], squared_difference: impl Fn(usize, usize) -> f64) -> f32 {
    let cloudy = || reference.iter().enumerate().filter(|(_, pixel)| pixel[3] > CLOUD);
    let count = cloudy().count().max(1) as f64 * 3.0;
    let mean = cloudy().flat_map(|(_, pixel)| &pixel[..3]).map(|light| f64::from(*light)).sum::<f64>() / count;
    let epsilon = (0.01 * mean).powi(2).max(1e-30);
    let sum: f64 = cloudy()
        .flat_map(|(at, pixel)| [0, 1, 2].map(|channel| (at, channel, f64::from(pixel[channel]))))
        .map(|(at, channel, light)| squared_difference(at, channel) / (light * light + epsilon))
        .sum();
    #[allow(clippy::cast_possible_truncation, reason = "an error estimate")]
    let rms = (sum / count).sqrt() as f32;
    rms
}

/// Relative change from one picture to the next, finer one.
pub(super) fn change(before: &[[f32; 4]], after: &[[f32; 4]]) -> f32 {
    relative_rms(after, |at, channel| (f64::from(after[at][channel]) - f64::from(before[at][channel])).powi(2))
}

/// Relative standard error of a picture whose variance is known.
pub(super) fn standard_error(picture: &[[f32; 4]], variance: &[[f32; 4]]) -> f32 {
    relative_rms(picture, |at, channel| f64::from(variance[at][channel]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn change_is_relative_and_looks_at_clouds_alone() {
        let before = [[1.0, 1.0, 1.0, 1.0], [5.0, 5.0, 5.0, 0.0]];
        let after = [[1.1, 1.1, 1.1, 1.0], [9.0, 9.0, 9.0, 0.0]];
        let moved = change(&before, &after);
        assert!((moved - 0.1 / 1.1).abs() < 1e-4, "{moved}");
        assert_eq!(change(&after, &after), 0.0);
        assert_eq!(change(&[], &[]), 0.0, "no picture, no change");
    }

    #[test]
    fn each_level_halves_the_steps() {
        let (coarse, fine) = (Level::new(1), Level::new(2));
        assert_eq!(coarse.view_step_m, 2.0 * fine.view_step_m);
        assert_eq!(2 * coarse.light_steps, fine.light_steps);
    }
}
