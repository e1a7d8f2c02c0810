//! ꟻLIP: how different two pictures look when they take turns on a screen.
//!
//! Pontus Andersson, Jim Nilsson, Tomas Akenine-Möller, Magnus Oskarsson, Kalle Åström and Mark D. Fairchild, "ꟻLIP: A
//! Difference Evaluator for Alternating Images", Proceedings of the ACM on Computer Graphics and Interactive Techniques
//! 3(2), High-Performance Graphics 2020. Own code in double precision; names and symbols are the paper's. Beyond the edge
//! a picture goes on with the pixels of its edge.
//!
//! Colour: both pictures are blurred in an opponent space as much as the eye blurs at that distance, and compared in
//! L*a*b* by a distance that suits large differences. Features: edges and points in one picture that the other one lacks.
//! The more the features differ, the closer to 1 comes the colour difference.
//!
//! Beside the authors' program (version 1.7, single precision), means of pictures agree within 3·10⁻⁵ and single pixels
//! within 8·10⁻⁵.

use std::f64::consts::PI;

use glam::DVec3;

use super::colour::{WhiteRelative, linear_from_srgb};

/// Pixels in a degree of the field of view, as the paper has it: a display of 3840 pixels on 0.7 m, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.020_643_276_582_26;

/// What [`flip`] takes for pixels per degree. Below it, filters vanish between pixels; above it, they outgrow pictures.
const PIXELS_PER_DEGREE_RANGE: std::ops::RangeInclusive<f64> = 1.0..=1000.0;

/// A Gaussian of a contrast sensitivity function: height and squared width, the paper's `a` and `b`.
type Bell = (f64, f64);

/// Contrast sensitivity to lightness, to red against green, and to blue against yellow.
const SENSITIVITY: [&[Bell]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// `q_c`: compresses large colour differences.
const COLOUR_EXPONENT: f64 = 0.7;
/// `p_c`: the share of the greatest colour difference that ends the lower part of the scale.
const COLOUR_KNEE: f64 = 0.4;
/// `p_t`: the error at that knee.
const ERROR_AT_KNEE: f64 = 0.95;
/// `w`: width of a feature in degrees.
const FEATURE_DEG: f64 = 0.082;
/// `q_f`: exponent of the feature difference.
const FEATURE_EXPONENT: f64 = 0.5;

/// Why two pictures cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FlipError {
    /// There are no pixels, or not whole rows of them, or not as many in both.
    #[error("cannot compare {reference} pixels with {test} in rows of {width}; both pictures need the same whole rows")]
    Size {
        /// Pixels of the reference.
        reference: usize,
        /// Pixels of the picture under test.
        test: usize,
        /// Pixels in a row.
        width: usize,
    },
    /// A pixel is NaN or infinite.
    #[error("pixel {pixel} is not a finite number; ꟻLIP has no meaning there, so mend the picture first")]
    NotFinite {
        /// Index of the first such pixel in either picture.
        pixel: usize,
    },
    /// The viewing distance makes no sense.
    #[error("{0} pixels per degree are not within 1 to 1000")]
    PixelsPerDegree(f64),
}

/// How different two pictures look.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// For each pixel the error from 0, no difference to be seen, to 1, the greatest.
    pub map: Vec<f32>,
    /// Their mean.
    pub mean: f64,
}

/// Pixels per degree at a distance from a display of that width, for the middle of the screen.
pub fn pixels_per_degree(distance_m: f64, display_m: f64, display_pixels: u32) -> f64 {
    distance_m * f64::from(display_pixels) / display_m * PI / 180.0
}

/// Compares two display-encoded sRGB pictures, 0 to 1, row by row; values outside are clamped, as a display does.
/// [`PIXELS_PER_DEGREE`] is the usual viewing distance.
///
/// # Errors
/// If sizes do not agree, a pixel is not finite, or pixels per degree are not within 1 to 1000.
pub fn flip(
    reference: &[[f32; 3]],
    test: &[[f32; 3]],
    width: usize,
    pixels_per_degree: f64,
) -> Result<Flip, FlipError> {
    let whole_rows = width > 0 && !reference.is_empty() && reference.len().is_multiple_of(width);
    if !whole_rows || reference.len() != test.len() {
        return Err(FlipError::Size { reference: reference.len(), test: test.len(), width });
    }
    if !PIXELS_PER_DEGREE_RANGE.contains(&pixels_per_degree) {
        return Err(FlipError::PixelsPerDegree(pixels_per_degree));
    }
    let finite = |pixel: &[f32; 3]| pixel.iter().all(|value| value.is_finite());
    if let Some(pixel) = reference.iter().zip(test).position(|(a, b)| !finite(a) || !finite(b)) {
        return Err(FlipError::NotFinite { pixel });
    }
    let viewer = Viewer::new(pixels_per_degree);
    let (reference, test) = (viewer.look_at(reference, width), viewer.look_at(test, width));
    let errors = reference.iter().zip(&test).map(|(a, b)| viewer.difference(a, b));
    let errors: Vec<f64> = errors.collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    #[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
    let map = errors.into_iter().map(|error| error as f32).collect();
    Ok(Flip { map, mean })
}

/// What the eye makes of one pixel.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// L*, a*, b* of the blurred picture, with Hunt's adjustment.
    colour: DVec3,
    /// Strength of an edge.
    edge: f64,
    /// Strength of a point.
    point: f64,
}

/// The eye at a distance, and the filters that follow from it.
struct Viewer {
    space: WhiteRelative,
    /// For lightness, red-green and blue-yellow: Gaussians and their shares of the whole.
    blurs: [Vec<(f64, Vec<f64>)>; 3],
    /// A Gaussian of the width of features, and its first and second derivative.
    feature: [Vec<f64>; 3],
    /// The colour difference that counts as greatest: green against blue.
    greatest: f64,
}

impl Viewer {
    fn new(pixels_per_degree: f64) -> Self {
        let space = WhiteRelative::new();
        let [green, blue] = [DVec3::Y, DVec3::Z].map(|colour| hunt(space.lab_from_rgb(colour)));
        Self {
            space,
            blurs: SENSITIVITY.map(|bells| blur(bells, pixels_per_degree)),
            feature: feature_filters(pixels_per_degree),
            greatest: hyab(green, blue).powf(COLOUR_EXPONENT),
        }
    }

    fn look_at(&self, picture: &[[f32; 3]], width: usize) -> Vec<Seen> {
        let opponent: Vec<DVec3> = picture.iter().map(|pixel| self.opponent_from_srgb(*pixel)).collect();
        let plane = |channel: usize| Plane { width, values: opponent.iter().map(|colour| colour[channel]).collect() };
        let [lightness, red_green, blue_yellow] = [0, 1, 2].map(|channel| {
            let plane = plane(channel);
            let mut blurred = vec![0.0; picture.len()];
            for (share, bell) in &self.blurs[channel] {
                for (sum, value) in blurred.iter_mut().zip(plane.filtered(bell, bell).values) {
                    *sum += share * value;
                }
            }
            blurred
        });
        // Features are sought in lightness scaled to 0 to 1.
        let sharp = Plane { width, values: opponent.iter().map(|colour| (colour.x + 16.0) / 116.0).collect() };
        let [smooth, first, second] = &self.feature;
        let (edges, points) = (sharp.slope(first, smooth), sharp.slope(second, smooth));
        (0..picture.len())
            .map(|pixel| {
                let colour = DVec3::new(lightness[pixel], red_green[pixel], blue_yellow[pixel]);
                Seen { colour: self.lab_from_opponent(colour), edge: edges[pixel], point: points[pixel] }
            })
            .collect()
    }

    /// `Y_y C_x C_z`: L*a*b* without the cube root, so that blurring it blurs light.
    fn opponent_from_srgb(&self, pixel: [f32; 3]) -> DVec3 {
        let linear = pixel.map(|value| linear_from_srgb(f64::from(value).clamp(0.0, 1.0)));
        let [x, y, z] = (self.space.xyz_from_rgb * DVec3::from_array(linear)).to_array();
        DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
    }

    fn lab_from_opponent(&self, opponent: DVec3) -> DVec3 {
        let y = (opponent.x + 16.0) / 116.0;
        let xyz = DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
        hunt(self.space.lab_from_rgb((self.space.rgb_from_xyz * xyz).clamp(DVec3::ZERO, DVec3::ONE)))
    }

    /// `ΔE = ΔE_c^(1 − ΔE_f)`.
    fn difference(&self, reference: &Seen, test: &Seen) -> f64 {
        let feature = (reference.edge - test.edge).abs().max((reference.point - test.point).abs());
        let feature = (feature / std::f64::consts::SQRT_2).powf(FEATURE_EXPONENT);
        self.colour_difference(reference.colour, test.colour).powf(1.0 - feature)
    }

    /// Most of the scale goes to the lower part of the differences, where the eye tells more of them apart.
    fn colour_difference(&self, reference: DVec3, test: DVec3) -> f64 {
        let difference = hyab(reference, test).powf(COLOUR_EXPONENT);
        let knee = COLOUR_KNEE * self.greatest;
        if difference < knee {
            ERROR_AT_KNEE / knee * difference
        } else {
            ERROR_AT_KNEE + (difference - knee) / (self.greatest - knee) * (1.0 - ERROR_AT_KNEE)
        }
    }
}

/// Chromatic differences are seen less in the dark: a* and b* shrink with L* (Hunt 1952).
fn hunt(lab: DVec3) -> DVec3 {
    DVec3::new(lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z)
}

/// City-block in lightness, Euclidean in chroma (Abasi, Amani Tehran and Fairchild 2020).
fn hyab(a: DVec3, b: DVec3) -> f64 {
    (a.x - b.x).abs() + (a.y - b.y).hypot(a.z - b.z)
}

/// One channel's contrast sensitivity as Gaussians of sum 1 in one dimension, each with its share of the
/// two-dimensional filter. Gaussians separate, their sum does not, so they are applied one by one.
fn blur(bells: &[Bell], pixels_per_degree: f64) -> Vec<(f64, Vec<f64>)> {
    // All channels reach as far as the widest Gaussian does, three standard deviations.
    let widest = SENSITIVITY.iter().flat_map(|bells| bells.iter()).map(|bell| bell.1).fold(0.0, f64::max);
    let reach = 3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree;
    let mut weighted: Vec<(f64, Vec<f64>)> = bells
        .iter()
        .map(|(height, width)| {
            let bell = taps(reach, |pixels| (-(PI * pixels / pixels_per_degree).powi(2) / width).exp());
            let sum: f64 = bell.iter().sum();
            (height * (PI / width).sqrt() * sum * sum, bell.iter().map(|tap| tap / sum).collect())
        })
        .collect();
    let whole: f64 = weighted.iter().map(|(weight, _)| weight).sum();
    for (weight, _) in &mut weighted {
        *weight /= whole;
    }
    weighted
}

/// A Gaussian and its derivatives. Positive taps of a derivative add up to 1, negative ones to −1, so that an
/// edge from black to white has strength 1 at any distance.
fn feature_filters(pixels_per_degree: f64) -> [Vec<f64>; 3] {
    let sigma = 0.5 * FEATURE_DEG * pixels_per_degree;
    let bell = |x: f64| (-x * x / (2.0 * sigma * sigma)).exp();
    let filters: [Vec<f64>; 3] = [
        taps(3.0 * sigma, bell),
        taps(3.0 * sigma, |x| -x * bell(x)),
        taps(3.0 * sigma, |x| (x * x / (sigma * sigma) - 1.0) * bell(x)),
    ];
    filters.map(|filter| {
        let positive: f64 = filter.iter().filter(|tap| **tap > 0.0).sum();
        let negative: f64 = -filter.iter().filter(|tap| **tap < 0.0).sum::<f64>();
        filter.iter().map(|tap| tap / if *tap > 0.0 { positive } else { negative.max(f64::MIN_POSITIVE) }).collect()
    })
}

/// A filter at whole pixels on both sides of its middle.
fn taps(reach: f64, value: impl Fn(f64) -> f64) -> Vec<f64> {
    #[allow(clippy::cast_possible_truncation, reason = "a few thousand at most")]
    let reach = reach.ceil() as i32;
    (-reach..=reach).map(|pixels| value(f64::from(pixels))).collect()
}

/// One channel of a picture.
struct Plane {
    width: usize,
    values: Vec<f64>,
}

impl Plane {
    /// One filter along rows and one along columns, both of odd length.
    fn filtered(&self, across: &[f64], down: &[f64]) -> Self {
        let (width, height) = (self.width, self.values.len() / self.width);
        let rows = self
            .values
            .chunks_exact(width)
            .flat_map(|row| (0..width).map(|x| weighted(across, |tap| row[clamped(x + tap, across.len() / 2, width)])));
        let rows: Vec<f64> = rows.collect();
        let columns = (0..height).flat_map(|y| {
            let rows = &rows;
            let at = move |tap: usize| clamped(y + tap, down.len() / 2, height) * width;
            (0..width).map(move |x| weighted(down, |tap| rows[at(tap) + x]))
        });
        Self { width, values: columns.collect() }
    }

    /// Length of the vector of a derivative along rows and along columns.
    fn slope(&self, derivative: &[f64], smooth: &[f64]) -> Vec<f64> {
        let (x, y) = (self.filtered(derivative, smooth), self.filtered(smooth, derivative));
        x.values.iter().zip(&y.values).map(|(x, y)| x.hypot(*y)).collect()
    }
}

fn weighted(filter: &[f64], value: impl Fn(usize) -> f64) -> f64 {
    filter.iter().enumerate().map(|(tap, weight)| weight * value(tap)).sum()
}

/// `place − back`, kept within `0 .. length`.
fn clamped(place: usize, back: usize, length: usize) -> usize {
    place.saturating_sub(back).min(length - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 33;
    const HEIGHT: usize = 17;

    /// Pictures by formula, in whole 8-bit levels.
    fn picture(name: &str) -> Vec<[f32; 3]> {
        let level = |x: usize, y: usize, channel: usize| match name {
            "ramp" => (5 * x + 3 * y + 40 * channel) % 256,
            "near" => (5 * x + 3 * y + 40 * channel + 3 * ((x * y) % 7)) % 256,
            "noise" => (37 * x + 61 * y + 17 * channel + 11 * x * y) % 256,
            "dots" if (7 * x + 5 * y).is_multiple_of(31) => 255,
            "dots" => 30 + 20 * channel,
            "edge" => 25 + 5 * channel + 205 * usize::from(x > 16),
            "moved" => 25 + 5 * channel + 205 * usize::from(x > 17),
            _ => panic!("no picture is called {name}"),
        };
        let pixel = |index: usize| std::array::from_fn(|c| level(index % WIDTH, index / WIDTH, c) as f32 / 255.0);
        (0..WIDTH * HEIGHT).map(pixel).collect()
    }

    /// Reference, test, pixels per degree; the mean and pixels 0, 16, 280, 300, 560 by flip-evaluator 1.7.
    type Official = (&'static str, &'static str, f64, f64, [f32; 5]);
    const OFFICIAL: [Official; 10] = [
        ("ramp", "near", 67.020_643, 0.234_178, [0.044_248, 0.094_000, 0.162_681, 0.211_255, 0.698_920]),
        ("ramp", "near", 20.0, 0.234_793, [0.007_156, 0.028_593, 0.175_690, 0.290_002, 0.783_090]),
        ("ramp", "noise", 67.020_643, 0.709_421, [0.603_654, 0.541_737, 0.579_697, 0.806_600, 0.976_613]),
        ("ramp", "noise", 20.0, 0.818_505, [0.487_262, 0.551_327, 0.780_330, 0.964_319, 0.984_703]),
        ("edge", "moved", 67.020_643, 0.096_172, [0.0, 0.716_304, 0.716_304, 0.0, 0.0]),
        ("edge", "moved", 20.0, 0.061_117, [0.0, 0.541_990, 0.541_990, 0.0, 0.0]),
        ("dots", "edge", 67.020_643, 0.764_304, [0.987_494, 0.847_896, 0.905_846, 0.406_524, 0.967_431]),
        ("dots", "edge", 20.0, 0.694_924, [0.994_374, 0.586_149, 0.689_147, 0.349_834, 0.957_468]),
        ("noise", "dots", 67.020_643, 0.770_111, [0.925_126, 0.472_002, 0.799_831, 0.865_457, 0.862_070]),
        ("noise", "dots", 20.0, 0.781_955, [0.992_312, 0.589_610, 0.970_302, 0.969_696, 0.827_194]),
    ];

    #[test]
    fn errors_are_those_of_the_authors_program() {
        for (reference, test, per_degree, mean, pixels) in OFFICIAL {
            let seen = flip(&picture(reference), &picture(test), WIDTH, per_degree).expect("sound pictures");
            let what = format!("{reference} and {test} at {per_degree} pixels per degree");
            // Observed at most 8·10⁻⁶ and 3·10⁻⁵; theirs computes in single precision.
            assert!((seen.mean - mean).abs() < 2e-5, "{what}: mean {} instead of {mean}", seen.mean);
            for (index, expected) in [0, 16, 280, 300, 560].into_iter().zip(pixels) {
                let error = seen.map[index];
                assert!((error - expected).abs() < 1e-4, "{what}, pixel {index}: {error} instead of {expected}");
            }
        }
    }

    #[test]
    fn the_scale_ends_at_equal_and_at_green_against_blue() {
        let noise = picture("noise");
        let same = flip(&noise, &noise, WIDTH, PIXELS_PER_DEGREE).expect("sound pictures");
        assert!(same.mean == 0.0 && same.map.iter().all(|error| *error == 0.0), "{}", same.mean);
        let (green, blue) = (vec![[0.0, 1.0, 0.0]; 12], vec![[0.0, 0.0, 1.0]; 12]);
        let most = flip(&green, &blue, 4, PIXELS_PER_DEGREE).expect("sound pictures");
        assert!((most.mean - 1.0).abs() < 1e-9, "{}", most.mean);
    }

    #[test]
    fn order_does_not_matter_and_values_outside_are_clamped() {
        let (ramp, noise) = (picture("ramp"), picture("noise"));
        let there = flip(&ramp, &noise, WIDTH, PIXELS_PER_DEGREE).expect("sound pictures");
        let back = flip(&noise, &ramp, WIDTH, PIXELS_PER_DEGREE).expect("sound pictures");
        assert_eq!(there, back);
        let white = flip(&[[1.0; 3]], &[[7.0; 3]], 1, PIXELS_PER_DEGREE).expect("sound pictures");
        assert_eq!(white.mean, 0.0);
    }

    #[test]
    fn every_distance_in_range_gives_errors_in_range() {
        for per_degree in [1.0, 5.0, 150.0] {
            let seen = flip(&picture("dots"), &picture("noise"), WIDTH, per_degree).expect("sound pictures");
            assert!(seen.map.iter().all(|error| (0.0..=1.0).contains(error)), "at {per_degree} pixels per degree");
        }
        assert!((pixels_per_degree(0.7, 0.7, 3840) - PIXELS_PER_DEGREE).abs() < 1e-9, "the usual distance");
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        let grey = [[0.5; 3]; 6];
        let size = |reference, test, width| Err(FlipError::Size { reference, test, width });
        assert_eq!(flip(&grey, &grey[..5], 3, 60.0), size(6, 5, 3));
        assert_eq!(flip(&grey, &grey, 4, 60.0), size(6, 6, 4));
        assert_eq!(flip(&grey, &grey, 0, 60.0), size(6, 6, 0));
        assert_eq!(flip(&[], &[], 3, 60.0), size(0, 0, 3));
        let mut broken = grey;
        broken[4][1] = f32::NAN;
        assert_eq!(flip(&grey, &broken, 3, 60.0), Err(FlipError::NotFinite { pixel: 4 }));
        assert_eq!(flip(&broken, &grey, 3, 60.0), Err(FlipError::NotFinite { pixel: 4 }));
        for per_degree in [0.0, -3.0, 1e9, f64::NAN] {
            let refused = flip(&grey, &grey, 3, per_degree);
            assert!(matches!(refused, Err(FlipError::PixelsPerDegree(_))), "{per_degree}");
        }
    }
}
