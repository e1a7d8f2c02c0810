//! How like a photograph a picture is, in figures: how its light is spread, its colours, and the sizes of its structures (Thomann
//! 2020, section 6.6.4, compares histograms; the spectrum of sizes says what they cannot).
//!
//! All figures are of logarithms, and luminance is from its median, so that exposure does not matter; a white balance does. A distance between two
//! distributions is the earth mover's (Rubner, Tomasi and Guibas 2000): in one dimension the mean distance of quantiles.

use super::colour::luminance;
use crate::images::FloatImage;

/// Values that distributions are kept as: their quantiles.
const QUANTILES: usize = 256;
/// Brighter than so many times the median is the sun or what shines around it, and no structure.
const GLARE_STOPS: f64 = 5.0;
/// Darker than so many stops below the median is black, as silhouettes and borders are.
const DARKEST_STOPS: f64 = 8.0;
/// Fewest pixels across that a coarser level of the pyramid has.
const FEWEST: usize = 8;

/// Quantiles of a distribution, ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread(Vec<f64>);

impl Spread {
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |index: usize| values.get((2 * index + 1) * values.len() / (2 * QUANTILES)).copied().unwrap_or(0.0);
        Self((0..QUANTILES).map(at).collect())
    }

    /// The value that a share of all lies below, 0 to 1.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    pub fn quantile(&self, share: f64) -> f64 {
        self.0[((share * QUANTILES as f64) as usize).min(QUANTILES - 1)]
    }

    /// The earth mover's distance.
    pub fn distance(&self, other: &Self) -> f64 {
        self.0.iter().zip(&other.0).map(|(one, other)| (one - other).abs()).sum::<f64>() / QUANTILES as f64
    }

    /// The same with both medians laid on each other.
    pub fn distance_of_shapes(&self, other: &Self) -> f64 {
        let centred = |spread: &Self| Self(spread.0.iter().map(|value| value - spread.quantile(0.5)).collect());
        centred(self).distance(&centred(other))
    }
}

/// What is measured of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Realism {
    /// Luminance in stops from its median.
    pub luminance: Spread,
    /// Red over green, in stops.
    pub red: Spread,
    /// Blue over green, in stops.
    pub blue: Spread,
    /// Contrast of structures by their size, the finest first: root mean square difference in stops between a pixel and the mean
    /// of the four that it belongs to, then of those means, and so on.
    pub structures: Vec<f64>,
}

/// How far two pictures are from each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distances {
    /// Of luminance, in stops, whatever the exposure.
    pub luminance: f64,
    /// Of red over green, in stops.
    pub red: f64,
    /// Of blue over green, in stops.
    pub blue: f64,
    /// Of structures: mean ratio of contrasts over all sizes, in stops.
    pub structures: f64,
}

impl Realism {
    /// Of linear light, rows from the top. What is black has no colour and is left out.
    pub fn of(image: &FloatImage) -> Self {
        let size = [image.width as usize, image.height as usize];
        let pixel = |rgba: &[f32; 4]| [rgba[0], rgba[1], rgba[2]];
        let stops: Vec<f64> = image.rgba.iter().map(|rgba| luminance(pixel(rgba)).max(1e-9).log2()).collect();
        let median = Spread::of(stops.clone()).quantile(0.5);
        let glare = median + GLARE_STOPS;
        let lit = image.rgba.iter().filter(|rgba| rgba[..3].iter().all(|channel| *channel > 1e-9));
        let ratios: Vec<[f64; 2]> = lit
            .filter(|rgba| luminance(pixel(rgba)).log2() < glare)
            .map(|rgba| [rgba[0], rgba[2]].map(|channel| f64::from(channel / rgba[1]).log2()))
            .collect();
        let seen: Vec<f64> = stops.iter().map(|value| value.clamp(median - DARKEST_STOPS, glare) - median).collect();
        Self {
            structures: structures(&seen, size),
            luminance: Spread::of(seen),
            red: Spread::of(ratios.iter().map(|ratio| ratio[0]).collect()),
            blue: Spread::of(ratios.iter().map(|ratio| ratio[1]).collect()),
        }
    }

    /// How far it is from another picture of the same size.
    pub fn distances(&self, other: &Self) -> Distances {
        // Less contrast than this nobody sees.
        let seen = |contrast: f64| contrast.max(1e-3).log2();
        let ratios =
            self.structures.iter().zip(&other.structures).map(|(one, other)| (seen(*one) - seen(*other)).abs());
        Distances {
            luminance: self.luminance.distance_of_shapes(&other.luminance),
            red: self.red.distance(&other.red),
            blue: self.blue.distance(&other.blue),
            structures: ratios.sum::<f64>() / self.structures.len().min(other.structures.len()).max(1) as f64,
        }
    }
}

/// Root mean square difference between values and the means of two by two of them, then of those means, and so on.
fn structures(values: &[f64], [width, height]: [usize; 2]) -> Vec<f64> {
    let (mut level, mut size) = (values.to_vec(), [width, height]);
    let mut contrasts = Vec::new();
    while size[0].min(size[1]) >= 2 * FEWEST {
        let half = size.map(|side| side / 2);
        let at = |x: usize, y: usize| level[y * size[0] + x];
        let mut means = Vec::with_capacity(half[0] * half[1]);
        let mut squares = 0.0;
        for y in 0..half[1] {
            for x in 0..half[0] {
                let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| at(2 * x + dx, 2 * y + dy));
                let mean = four.iter().sum::<f64>() / 4.0;
                squares += four.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
                means.push(mean);
            }
        }
        contrasts.push((squares / (4 * means.len()).max(1) as f64).sqrt());
        (level, size) = (means, half);
    }
    contrasts
}

/// The mean of `by` × `by` pixels for each; what is left at the edges goes.
pub fn smaller(image: &FloatImage, by: u32) -> FloatImage {
    let by = by.max(1);
    let [width, height] = [image.width / by, image.height / by];
    let mean = |x: u32, y: u32| {
        let mut sum = [0.0_f64; 4];
        for row in y * by..(y + 1) * by {
            for column in x * by..(x + 1) * by {
                let rgba = image.rgba[(row * image.width + column) as usize];
                sum.iter_mut().zip(rgba).for_each(|(sum, channel)| *sum += f64::from(channel));
            }
        }
        #[allow(clippy::cast_possible_truncation, reason = "a mean of f32")]
        sum.map(|sum| (sum / f64::from(by * by)) as f32)
    };
    let rgba = (0..height).flat_map(|y| (0..width).map(move |x| mean(x, y))).collect();
    FloatImage { width, height, rgba, depth: None, crop: None }
}

/// The upper half: of a panorama the sky.
pub fn upper_half(image: &FloatImage) -> FloatImage {
    let height = (image.height / 2).max(1);
    let rgba = image.rgba.iter().take((image.width * height) as usize).copied().collect();
    FloatImage { width: image.width, height, rgba, depth: None, crop: None }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stripes, `period` pixels long.
    fn stripes(period: u32) -> FloatImage {
        let light = |x: u32| if (x / (period / 2)).is_multiple_of(2) { 0.2_f32 } else { 0.8 };
        let row = (0..64).map(|x| [light(x), light(x), light(x), 1.0]);
        FloatImage { width: 64, height: 64, rgba: (0..64).flat_map(|_| row.clone()).collect(), depth: None, crop: None }
    }

    fn changed(image: &FloatImage, factors: [f32; 3]) -> FloatImage {
        let scaled = |p: &[f32; 4]| [p[0] * factors[0], p[1] * factors[1], p[2] * factors[2], p[3]];
        FloatImage { rgba: image.rgba.iter().map(scaled).collect(), ..image.clone() }
    }

    #[test]
    fn a_picture_is_like_itself_at_any_exposure() {
        let picture = stripes(8);
        let own = Realism::of(&picture);
        for factor in [1.0, 0.01, 100.0] {
            let far = own.distances(&Realism::of(&changed(&picture, [factor; 3])));
            let all = [far.luminance, far.red, far.blue, far.structures];
            assert!(all.iter().all(|distance| *distance < 1e-5), "{factor}: {far:?}");
        }
    }

    #[test]
    fn tints_contrast_and_sizes_are_told_apart() {
        let picture = stripes(8);
        let own = Realism::of(&picture);
        let warm = own.distances(&Realism::of(&changed(&picture, [2.0, 1.0, 0.5])));
        assert!((warm.red - 1.0).abs() < 1e-5 && (warm.blue - 1.0).abs() < 1e-5, "a stop each: {warm:?}");
        // Squares of light have twice the contrast in stops.
        let square = |p: &[f32; 4]| [p[0] * p[0], p[1] * p[1], p[2] * p[2], p[3]];
        let hard = FloatImage { rgba: picture.rgba.iter().map(square).collect(), ..picture.clone() };
        let hard = own.distances(&Realism::of(&hard));
        assert!((hard.luminance - 1.0).abs() < 0.02, "the half of two stops more: {hard:?}");
        let narrow = Realism::of(&stripes(4));
        assert!(own.distances(&narrow).luminance < 1e-6 && own.distances(&narrow).structures > 1.0);
        let largest = |realism: &Realism| {
            let all = realism.structures.iter().enumerate();
            all.max_by(|one, other| one.1.total_cmp(other.1)).map(|(level, _)| level)
        };
        assert_eq!((largest(&own), largest(&narrow)), (Some(2), Some(1)), "half a period is four pixels, and two");
    }

    #[test]
    fn the_sun_does_not_count_as_structure() {
        let picture = stripes(8);
        let with_sun = |light: f32| {
            let mut sun = picture.clone();
            sun.rgba[1000] = [light, light, light, 1.0];
            Realism::of(&sun)
        };
        assert_eq!(with_sun(1e3), with_sun(1e6), "what shines is cut off");
        assert_eq!(with_sun(1e-6).structures, with_sun(0.0).structures, "and what is black");
        let far = Realism::of(&picture).distances(&with_sun(1e6));
        assert!(far.luminance < 0.05 && far.red < 1e-6, "{far:?}");
    }

    #[test]
    fn smaller_pictures_hold_means_and_the_sky_is_above() {
        let picture = stripes(2);
        let half = smaller(&picture, 2);
        assert!(half.width == 32 && half.rgba.iter().all(|pixel| (pixel[0] - 0.5).abs() < 1e-6));
        assert_eq!(upper_half(&half).rgba.len(), 32 * 16);
    }
}
