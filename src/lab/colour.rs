//! The colour spaces that measures of pictures are made in.

use glam::{DMat3, DVec3};

/// Luminance weights of linear Rec.709 (ITU-R BT.709-6, item 3.2).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Chromaticities x, y of the sRGB primaries and of its white, D65 (IEC 61966-2-1).
const RED: [f64; 2] = [0.64, 0.33];
const GREEN: [f64; 2] = [0.30, 0.60];
const BLUE: [f64; 2] = [0.15, 0.06];
const WHITE: [f64; 2] = [0.3127, 0.3290];

/// Where the cube root of L*a*b* gives way to its tangent (CIE 15:2004).
const LAB_KNEE: f64 = 6.0 / 29.0;

/// Luminance of a linear Rec.709 colour, in its own unit.
pub(super) fn luminance(rgb: [f32; 3]) -> f64 {
    rgb.iter().zip(LUMINANCE).map(|(value, weight)| f64::from(*value) * weight).sum()
}

/// One channel from the display's encoding to linear light (IEC 61966-2-1).
pub(super) fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Between linear sRGB and XYZ divided by the XYZ of white, so that white is (1, 1, 1) in both.
#[derive(Clone, Copy, Debug)]
pub(super) struct WhiteRelative {
    /// X/Xn, Y/Yn, Z/Zn from linear sRGB.
    pub(super) xyz_from_rgb: DMat3,
    /// Linear sRGB from X/Xn, Y/Yn, Z/Zn.
    pub(super) rgb_from_xyz: DMat3,
}

impl WhiteRelative {
    /// From the chromaticities, so that no rounded matrix has to agree with another one.
    pub(super) fn new() -> Self {
        let primaries = DMat3::from_cols(xyz(RED), xyz(GREEN), xyz(BLUE));
        let white = xyz(WHITE);
        let amounts = primaries.inverse() * white;
        let xyz_from_rgb = DMat3::from_diagonal(white.recip()) * primaries * DMat3::from_diagonal(amounts);
        Self { xyz_from_rgb, rgb_from_xyz: xyz_from_rgb.inverse() }
    }

    /// L*, a*, b* of a linear sRGB colour.
    pub(super) fn lab_from_rgb(&self, rgb: DVec3) -> DVec3 {
        let curve = |t: f64| {
            let linear = t / (3.0 * LAB_KNEE * LAB_KNEE) + 4.0 / 29.0;
            if t > LAB_KNEE.powi(3) { t.cbrt() } else { linear }
        };
        let [x, y, z] = (self.xyz_from_rgb * rgb).to_array().map(curve);
        DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
    }
}

/// XYZ of a chromaticity at luminance 1.
fn xyz([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_the_coordinates_of_the_standards() {
        let space = WhiteRelative::new();
        let lab = |rgb| space.lab_from_rgb(DVec3::from_array(rgb));
        // Lindbloom's calculator, sRGB and D65.
        for (rgb, expected) in [
            ([1.0, 1.0, 1.0], [100.0, 0.0, 0.0]),
            ([1.0, 0.0, 0.0], [53.241, 80.092, 67.203]),
            ([0.0, 0.0, 1.0], [32.297, 79.188, -107.860]),
            ([0.001, 0.001, 0.001], [0.9033, 0.0, 0.0]),
        ] {
            let seen = lab(rgb);
            assert!(seen.abs_diff_eq(DVec3::from_array(expected), 0.02), "{rgb:?}: {seen}");
        }
        assert!((linear_from_srgb(0.5) - 0.214_041).abs() < 1e-6, "{}", linear_from_srgb(0.5));
        assert!((linear_from_srgb(0.04) - 0.04 / 12.92).abs() < 1e-12, "the straight part");
        assert!((luminance([1.0, 1.0, 1.0]) - 1.0).abs() < 1e-12, "white has luminance 1");
    }

    #[test]
    fn the_matrices_are_inverse() {
        let space = WhiteRelative::new();
        let colour = DVec3::new(0.2, 0.7, 0.1);
        assert!((space.rgb_from_xyz * (space.xyz_from_rgb * colour)).abs_diff_eq(colour, 1e-12), "there and back");
    }
}
