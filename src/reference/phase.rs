//! Twins of `cloud/phase.wgsl`, in `f64` and in their textbook forms of the scattering cosine.

use std::f64::consts::PI;

/// Isotropic scattering; the kinds are the shader's `PHASE_` constants.
pub const ISOTROPIC: u32 = 0;
/// Henyey-Greenstein.
pub const HENYEY_GREENSTEIN: u32 = 1;
/// A blend of two Henyey-Greenstein lobes.
pub const TWO_LOBES: u32 = 2;
/// Cornette-Shanks.
pub const CORNETTE_SHANKS: u32 = 3;
/// Schlick's approximation of Henyey-Greenstein.
pub const SCHLICK: u32 = 4;
/// Rayleigh scattering.
pub const RAYLEIGH: u32 = 5;
/// Names of the kinds, in order of their numbers.
pub const KIND_NAMES: [&str; 6] =
    ["isotropic", "Henyey-Greenstein", "two lobes", "Cornette-Shanks", "Schlick", "Rayleigh"];

/// Twin of the shader's struct of this name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseShape {
    /// One of the constants of this module.
    pub kind: u32,
    /// Asymmetry −1..1, clamped to ±0.99.
    pub g: f64,
    /// Asymmetry of the second lobe.
    pub back_g: f64,
    /// Share 0..1 of the second lobe.
    pub back_mix: f64,
}

fn clamped(g: f64) -> f64 {
    g.clamp(-0.99, 0.99)
}

fn schlick_k(g: f64) -> f64 {
    let g = clamped(g);
    (1.55 * g - 0.55 * g.powi(3)).clamp(-0.999, 0.999)
}

fn henyey_greenstein(g: f64, cosine: f64) -> f64 {
    let g = clamped(g);
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
}

/// The phase function in 1/sr at the scattering cosine; +1 is straight on.
#[must_use]
pub fn phase(shape: PhaseShape, cosine: f64) -> f64 {
    let g = clamped(shape.g);
    match shape.kind {
        HENYEY_GREENSTEIN => henyey_greenstein(g, cosine),
        TWO_LOBES => {
            let front = henyey_greenstein(g, cosine);
            front + (henyey_greenstein(shape.back_g, cosine) - front) * shape.back_mix
        }
        CORNETTE_SHANKS => {
            let d = (1.0 + g * g - 2.0 * g * cosine).powf(1.5);
            3.0 * (1.0 - g * g) * (1.0 + cosine * cosine) / (8.0 * PI * (2.0 + g * g) * d)
        }
        SCHLICK => {
            let k = schlick_k(g);
            (1.0 - k * k) / (4.0 * PI * (1.0 - k * cosine).powi(2))
        }
        RAYLEIGH => 3.0 / (16.0 * PI) * (1.0 + cosine * cosine),
        _ => 1.0 / (4.0 * PI),
    }
}

/// As [`phase`] with both asymmetries times `anisotropy_scale`, for scattering octaves.
#[must_use]
pub fn phase_scaled(shape: PhaseShape, anisotropy_scale: f64, cosine: f64) -> f64 {
    let scaled = PhaseShape { g: shape.g * anisotropy_scale, back_g: shape.back_g * anisotropy_scale, ..shape };
    phase(scaled, cosine)
}

/// The mean of the scattering cosine, in closed form.
#[must_use]
pub fn mean_cosine(shape: PhaseShape) -> f64 {
    let g = clamped(shape.g);
    match shape.kind {
        HENYEY_GREENSTEIN => g,
        TWO_LOBES => g + (clamped(shape.back_g) - g) * shape.back_mix,
        CORNETTE_SHANKS => 3.0 * g * (4.0 + g * g) / (5.0 * (2.0 + g * g)),
        SCHLICK => {
            let k = schlick_k(g);
            if k.abs() < 1e-3 {
                // The closed form is 0/0 at k = 0; its series begins with 2k/3.
                return k * 2.0 / 3.0;
            }
            1.0 / k + (1.0 - k * k) / (2.0 * k * k) * ((1.0 - k) / (1.0 + k)).ln()
        }
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrates `f(cosine)` over the sphere; cosines near ±1 are resolved by cos = tanh-like substitution.
    fn over_sphere(f: impl Fn(f64) -> f64) -> f64 {
        let steps = 20_000;
        let sum: f64 = (0..steps)
            .map(|i| {
                let angle = (f64::from(i) + 0.5) / f64::from(steps) * PI;
                f(angle.cos()) * angle.sin()
            })
            .sum();
        sum * PI / f64::from(steps) * 2.0 * PI
    }

    #[test]
    fn every_kind_integrates_to_one_with_its_mean_cosine() {
        for kind in 0..6 {
            for g in [-0.9, -0.3, 0.0, 1e-4, 0.5, 0.85, 0.9, 0.99, 1.0] {
                let shape = PhaseShape { kind, g, back_g: -0.25, back_mix: 0.3 };
                let name = KIND_NAMES[kind as usize];
                let total = over_sphere(|c| phase(shape, c));
                assert!((total - 1.0).abs() < 1e-4, "{name} at g = {g} integrates to {total}");
                let mean = over_sphere(|c| c * phase(shape, c));
                assert!((mean - mean_cosine(shape)).abs() < 1e-4, "{name} at g = {g} has mean cosine {mean}");
            }
        }
    }

    #[test]
    fn peaks_have_their_closed_forms() {
        let shape = PhaseShape { kind: HENYEY_GREENSTEIN, g: 0.7, back_g: 0.0, back_mix: 0.0 };
        assert!((phase(shape, 1.0) - 1.7 / (4.0 * PI * 0.09)).abs() < 1e-12, "forward");
        assert!((phase(shape, -1.0) - 0.3 / (4.0 * PI * 1.7 * 1.7)).abs() < 1e-12, "backward");
        assert!((phase_scaled(shape, 0.0, 0.3) - 1.0 / (4.0 * PI)).abs() < 1e-12, "flattened to isotropic");
    }
}
