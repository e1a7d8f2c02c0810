//! How far a picture is from a reference, in linear light.
//!
//! Every figure is relative to the reference, so that exposure does not matter, and comes with its standard error
//! ([`Estimate`]). `a` is the picture, `r` the reference; means run over the pixels measured and their three channels
//! unless luminance is named. ε = (0.01 · mean r)² keeps dark pixels from deciding a figure: below a hundredth of the mean
//! an error counts as absolute.
//!
//! | figure | formula | range | from |
//! |---|---|---|---|
//! | relMSE | mean((a − r)² / (r² + ε)) | 0 and up | Rousselle, Knaus and Zwicker 2011, with ε fixed; pbrt-v4's `imgtool` has (a − r)² / (r + 0.01)², which changes with exposure |
//! | relRMSE | √max(0, relMSE) | 0 and up | |
//! | bias | mean(a − r) / mean(r) | −1 and up for light | signed: dark is negative |
//! | relative error | \|a − r\| / √(r² + ε) of luminance, mean and 95 % | 0 and up | |
//! | bias², variance | of pictures with different seeds, on the scale of relMSE | | law of total variance |
//! | flicker | σ over frames / mean, of luminance | 0 and up | |
//!
//! The relative error is one of luminance and not of channels: it is one number for each pixel, so that "one pixel in
//! twenty is off by more than this" means pixels, and the eye sees detail in luminance. What luminance misses, a cloud of
//! the right brightness in the wrong colour, is in relMSE.
//!
//! # A reference that is not exact
//!
//! A path-traced reference r̂ is itself a mean of samples and differs from r by noise of variance v, the square of its
//! standard error. Noise of its own that the picture does not share adds to every square: E\[(a − r̂)²\] = (a − r)² + v. So
//! where v is given it is subtracted pixel by pixel, and relMSE = mean(((a − r̂)² − v) / (r̂² + ε)). It may then come out
//! below zero when nothing is left to measure; relRMSE is 0 there. The noise also changes the divisor, by a share of about
//! v / r² of the figure; [`Errors::reference_noise`] says how great that is. Figures without a square are not corrected:
//! bias needs it not, and the relative error of a perfect picture reads about 0.8 · √`reference_noise` instead of 0.

mod estimate;
pub mod mask;
mod temporal;

pub use estimate::{Estimate, TILE};
pub use temporal::{Flicker, Frames};

use estimate::{Sample, mean, ratio, share_below};

use super::colour::luminance;

/// Light below this share of the mean counts as that much: √ε / mean r.
const DARK_SHARE: f64 = 0.01;

/// Why a figure does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MetricError {
    /// The picture is empty, or the mask leaves nothing of it.
    #[error("no pixels are left to measure; widen the mask")]
    NoPixels,
    /// The pixels do not fill whole rows.
    #[error("{pixels} pixels do not fill rows of {width}")]
    Rows {
        /// Pixels in a row, as given.
        width: usize,
        /// Pixels.
        pixels: usize,
    },
    /// Something has not one entry for each pixel.
    #[error("the {what} has {found} entries for {expected} pixels of the reference")]
    Length {
        /// What it is.
        what: &'static str,
        /// Pixels of the reference.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// A pixel that is measured is NaN or infinite.
    #[error("the {what} is not a finite number in pixel {pixel}; mend it, or leave the pixel out of the mask")]
    NotFinite {
        /// Where it was found.
        what: &'static str,
        /// Index of the pixel.
        pixel: usize,
    },
    /// A variance is below zero.
    #[error("the variance of the reference is negative in pixel {pixel}")]
    NegativeVariance {
        /// Index of the pixel.
        pixel: usize,
    },
    /// The reference is black on average, or below: nothing can be relative to it.
    #[error("the reference holds no light where it is measured")]
    NoLight,
    /// A spread needs at least two.
    #[error("{found} {what} are too few; a spread needs two or more")]
    TooFew {
        /// Of what.
        what: &'static str,
        /// How many there were.
        found: usize,
    },
}

/// What pictures are compared with, and where. All slices run row by row from the top.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// Linear red, green and blue.
    pub pixels: &'a [[f32; 3]],
    /// Variance of each of these numbers, the square of its standard error; `None` if they are exact.
    pub variance: Option<&'a [[f32; 3]]>,
    /// Which pixels are measured; `None` for all.
    pub mask: Option<&'a [bool]>,
    /// Pixels in a row.
    pub width: usize,
}

/// Errors of one picture; formulas at the head of the module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Relative mean squared error.
    pub rel_mse: Estimate,
    /// Its root. Its standard error is how far it rises when relMSE rises by its own, which stays finite at 0.
    pub rel_rmse: Estimate,
    /// Signed mean error over mean light: −0.01 is one per cent too dark.
    pub bias: Estimate,
    /// Mean relative error of luminance.
    pub mean_relative: Estimate,
    /// What the relative error of luminance stays below in 95 % of the pixels.
    pub p95_relative: Estimate,
    /// The relMSE that the reference's own noise has and that was subtracted, mean(v / (r̂² + ε)). `None` without a
    /// variance.
    pub reference_noise: Option<f64>,
    /// Pixels measured.
    pub pixels: usize,
}

/// The relative squared error of a method, over all seeds it could have, in its two parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// relMSE of one picture, on average over the seeds; the sum of the other two.
    pub mse: Estimate,
    /// What stays when pictures of all seeds are averaged: mean(((ā − r̂)² − s²/K − v) / (r̂² + ε)), with ā and s² mean and
    /// sample variance of a pixel over K seeds. Free of bias itself, so it scatters around 0 where there is none.
    pub bias_squared: Estimate,
    /// What goes away: mean(s² / (r̂² + ε)).
    pub variance: Estimate,
    /// Seeds.
    pub seeds: usize,
    /// Pixels measured.
    pub pixels: usize,
}

impl Reference<'_> {
    /// Errors of a picture.
    ///
    /// # Errors
    /// If lengths do not agree, no pixel is measured, a pixel measured is not finite, or the reference holds no light.
    pub fn errors(&self, picture: &[[f32; 3]]) -> Result<Errors, MetricError> {
        let pixels = self.measured()?;
        self.check_picture(picture, &pixels)?;
        let floor = self.floor(&pixels)?;
        let square = |pixel: usize| {
            self.relative(pixel, floor, |channel, r| (f64::from(picture[pixel][channel]) - r).powi(2))
                - self.relative_variance(pixel, floor)
        };
        let rel_mse = self.mean(&pixels, square)?;
        let error = |pixel: usize| (0..3).map(|channel| self.error(picture, pixel, channel)).sum::<f64>();
        let light = |pixel: usize| self.pixels[pixel].iter().map(|value| f64::from(*value)).sum::<f64>();
        let bias = pixels.iter().map(|pixel| Sample { pixel: *pixel, above: error(*pixel), below: light(*pixel) });
        let bias = ratio(self.width, bias).ok_or(MetricError::NoPixels)?;
        let relative = self.relative_luminance(picture, &pixels)?;
        let mean_relative = mean(self.width, relative.iter().copied()).ok_or(MetricError::NoPixels)?;
        let p95_relative = share_below(self.width, &relative, 0.95).ok_or(MetricError::NoPixels)?;
        let noise = pixels.iter().map(|pixel| self.relative_variance(*pixel, floor)).sum::<f64>();
        let reference_noise = self.variance.map(|_| noise / pixels.len() as f64);
        let rel_rmse = root(rel_mse);
        Ok(Errors { rel_mse, rel_rmse, bias, mean_relative, p95_relative, reference_noise, pixels: pixels.len() })
    }

    /// How much of the error of pictures that differ in their seed alone is bias, and how much is noise.
    ///
    /// # Errors
    /// As [`Self::errors`] for any of the pictures, and with fewer than two of them.
    pub fn split(&self, pictures: &[&[[f32; 3]]]) -> Result<Split, MetricError> {
        if pictures.len() < 2 {
            return Err(MetricError::TooFew { what: "seeds", found: pictures.len() });
        }
        let pixels = self.measured()?;
        for picture in pictures {
            self.check_picture(picture, &pixels)?;
        }
        let floor = self.floor(&pixels)?;
        let count = pictures.len() as f64;
        // Mean and sample variance over the seeds.
        let moments = |pixel: usize, channel: usize| {
            let values = pictures.iter().map(|picture| f64::from(picture[pixel][channel]));
            let mean = values.clone().sum::<f64>() / count;
            (mean, values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0))
        };
        let variance = |pixel: usize| self.relative(pixel, floor, |channel, _| moments(pixel, channel).1);
        let bias_squared = |pixel: usize| {
            let square = |channel: usize, r: f64| {
                let (mean, variance) = moments(pixel, channel);
                (mean - r).powi(2) - variance / count
            };
            self.relative(pixel, floor, square) - self.relative_variance(pixel, floor)
        };
        Ok(Split {
            mse: self.mean(&pixels, |pixel| bias_squared(pixel) + variance(pixel))?,
            bias_squared: self.mean(&pixels, bias_squared)?,
            variance: self.mean(&pixels, variance)?,
            seeds: pictures.len(),
            pixels: pixels.len(),
        })
    }

    /// The mean over the pixels measured of any other number for each of them, such as a map of
    /// [`flip`](super::flip::flip).
    ///
    /// # Errors
    /// If lengths do not agree, no pixel is measured, or a pixel measured is not finite.
    pub fn mean_of(&self, map: &[f32]) -> Result<Estimate, MetricError> {
        check_rows(self.width, self.pixels.len())?;
        check_length("map", self.pixels.len(), map.len())?;
        let pixels = measured(self.mask, self.pixels.len())?;
        if let Some(pixel) = pixels.iter().find(|pixel| !map[**pixel].is_finite()) {
            return Err(MetricError::NotFinite { what: "map", pixel: *pixel });
        }
        self.mean(&pixels, |pixel| f64::from(map[pixel]))
    }

    /// Signed relative difference of luminance in every pixel, (a − r) / √(r² + ε), with ε from the pixels measured: 0.1 is
    /// ten per cent too bright. NaN where a pixel is.
    ///
    /// # Errors
    /// As [`Self::errors`].
    pub fn relative_difference(&self, picture: &[[f32; 3]]) -> Result<Vec<f32>, MetricError> {
        let pixels = self.measured()?;
        self.check_picture(picture, &pixels)?;
        let light = pixels.iter().map(|pixel| luminance(self.pixels[*pixel])).sum::<f64>();
        let floor = floor(light / pixels.len() as f64)?;
        let relative = |(a, r): (&[f32; 3], &[f32; 3])| {
            let (a, r) = (luminance(*a), luminance(*r));
            #[allow(clippy::cast_possible_truncation, reason = "a colour is chosen by it")]
            let relative = ((a - r) / (r * r + floor).sqrt()) as f32;
            relative
        };
        Ok(picture.iter().zip(self.pixels).map(relative).collect())
    }

    /// The pixels measured, once the reference is known to be sound there.
    fn measured(&self) -> Result<Vec<usize>, MetricError> {
        check_rows(self.width, self.pixels.len())?;
        let pixels = measured(self.mask, self.pixels.len())?;
        check_finite("reference", self.pixels, &pixels)?;
        if let Some(variance) = self.variance {
            check_length("variance", self.pixels.len(), variance.len())?;
            check_finite("variance", variance, &pixels)?;
            let negative = |pixel: &&usize| variance[**pixel].iter().any(|value| *value < 0.0);
            if let Some(pixel) = pixels.iter().find(negative) {
                return Err(MetricError::NegativeVariance { pixel: *pixel });
            }
        }
        Ok(pixels)
    }

    fn check_picture(&self, picture: &[[f32; 3]], pixels: &[usize]) -> Result<(), MetricError> {
        check_length("picture", self.pixels.len(), picture.len())?;
        check_finite("picture", picture, pixels)
    }

    /// ε of all channels.
    fn floor(&self, pixels: &[usize]) -> Result<f64, MetricError> {
        let sum = |pixel: &usize| self.pixels[*pixel].iter().map(|value| f64::from(*value)).sum::<f64>();
        floor(pixels.iter().map(sum).sum::<f64>() / (3 * pixels.len()) as f64)
    }

    fn error(&self, picture: &[[f32; 3]], pixel: usize, channel: usize) -> f64 {
        f64::from(picture[pixel][channel]) - f64::from(self.pixels[pixel][channel])
    }

    /// A squared quantity over r² + ε, as the mean over the channels; `square` takes the channel and r.
    fn relative(&self, pixel: usize, floor: f64, square: impl Fn(usize, f64) -> f64) -> f64 {
        let term = |channel: usize| {
            let r = f64::from(self.pixels[pixel][channel]);
            square(channel, r) / (r * r + floor)
        };
        (0..3).map(term).sum::<f64>() / 3.0
    }

    fn relative_variance(&self, pixel: usize, floor: f64) -> f64 {
        self.variance
            .map_or(0.0, |variance| self.relative(pixel, floor, |channel, _| f64::from(variance[pixel][channel])))
    }

    fn relative_luminance(&self, picture: &[[f32; 3]], pixels: &[usize]) -> Result<Vec<(usize, f64)>, MetricError> {
        let light = pixels.iter().map(|pixel| luminance(self.pixels[*pixel])).sum::<f64>();
        let floor = floor(light / pixels.len() as f64)?;
        let relative = |pixel: &usize| {
            let r = luminance(self.pixels[*pixel]);
            (*pixel, (luminance(picture[*pixel]) - r).abs() / (r * r + floor).sqrt())
        };
        Ok(pixels.iter().map(relative).collect())
    }

    fn mean(&self, pixels: &[usize], value: impl Fn(usize) -> f64) -> Result<Estimate, MetricError> {
        mean(self.width, pixels.iter().map(|pixel| (*pixel, value(*pixel)))).ok_or(MetricError::NoPixels)
    }
}

fn root(square: Estimate) -> Estimate {
    let value = square.value.max(0.0).sqrt();
    Estimate { value, std_error: square.std_error.map(|error| (square.value.max(0.0) + error).sqrt() - value) }
}

/// ε for a mean light.
fn floor(mean: f64) -> Result<f64, MetricError> {
    if mean > 0.0 { Ok((DARK_SHARE * mean).powi(2)) } else { Err(MetricError::NoLight) }
}

/// Indices of the pixels of a mask, or of all.
fn measured(mask: Option<&[bool]>, pixels: usize) -> Result<Vec<usize>, MetricError> {
    if let Some(mask) = mask {
        check_length("mask", pixels, mask.len())?;
    }
    let indices: Vec<usize> = (0..pixels).filter(|pixel| mask.is_none_or(|mask| mask[*pixel])).collect();
    if indices.is_empty() { Err(MetricError::NoPixels) } else { Ok(indices) }
}

fn check_rows(width: usize, pixels: usize) -> Result<(), MetricError> {
    match pixels {
        0 => Err(MetricError::NoPixels),
        _ if width == 0 || !pixels.is_multiple_of(width) => Err(MetricError::Rows { width, pixels }),
        _ => Ok(()),
    }
}

fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), MetricError> {
    if expected == found { Ok(()) } else { Err(MetricError::Length { what, expected, found }) }
}

fn check_finite(what: &'static str, values: &[[f32; 3]], pixels: &[usize]) -> Result<(), MetricError> {
    let broken = |pixel: &&usize| values[**pixel].iter().any(|value| !value.is_finite());
    pixels.iter().find(broken).map_or(Ok(()), |pixel| Err(MetricError::NotFinite { what, pixel: *pixel }))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 64;
    const PIXELS: usize = 64 * 48;

    /// Even numbers from −1 to 1 that only the seed decides (`SplitMix64`).
    fn noise(seed: usize) -> f32 {
        let mut z = (seed as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    }

    /// A picture by formula, from its pixel and channel.
    fn picture(value: impl Fn(usize, usize) -> f32) -> Vec<[f32; 3]> {
        (0..PIXELS).map(|pixel| std::array::from_fn(|channel| value(pixel, channel))).collect()
    }

    fn light(pixel: usize, channel: usize) -> f32 {
        1.0 + channel as f32 + (pixel % WIDTH) as f32 / 16.0
    }

    /// `light` with noise of standard deviation `sigma`.
    fn noisy(seed: usize, sigma: f32) -> Vec<[f32; 3]> {
        let at = |pixel: usize, channel: usize| noise((seed * PIXELS + pixel) * 3 + channel);
        picture(|pixel, channel| light(pixel, channel) + sigma * 3_f32.sqrt() * at(pixel, channel))
    }

    fn exact(pixels: &[[f32; 3]]) -> Reference<'_> {
        Reference { pixels, variance: None, mask: None, width: WIDTH }
    }

    fn close(seen: f64, expected: f64, tolerance: f64) -> bool {
        (seen - expected).abs() <= tolerance
    }

    /// Whether a figure lies as near to what it should be as its standard error says.
    fn agrees(figure: Estimate, expected: f64) -> bool {
        figure.std_error.is_some_and(|error| error > 0.0 && close(figure.value, expected, 4.0 * error))
    }

    #[test]
    fn a_picture_two_per_cent_too_dark_has_errors_of_two_per_cent() {
        let reference = picture(|_, channel| [4.0, 2.0, 1.0][channel]);
        let dark = picture(|_, channel| [3.92, 1.96, 0.98][channel]);
        let errors = exact(&reference).errors(&dark).expect("sound pictures");
        let eps = (0.01 * 7.0 / 3.0_f64).powi(2);
        let term = |r: f64| (0.02 * r).powi(2) / (r * r + eps);
        let rel_mse = (term(4.0) + term(2.0) + term(1.0)) / 3.0;
        assert!(close(errors.rel_mse.value, rel_mse, 1e-9), "{:?} instead of {rel_mse}", errors.rel_mse);
        assert!(close(errors.rel_rmse.value, rel_mse.sqrt(), 1e-7), "{:?}", errors.rel_rmse);
        assert!(close(errors.bias.value, -0.02, 1e-7), "{:?}", errors.bias);
        let relative = 0.02 / (1.0 + 1e-4_f64).sqrt();
        assert!(close(errors.mean_relative.value, relative, 1e-7), "{:?}", errors.mean_relative);
        assert!(close(errors.p95_relative.value, relative, 1e-7), "{:?}", errors.p95_relative);
        assert_eq!((errors.reference_noise, errors.pixels), (None, PIXELS));
        assert!(errors.bias.std_error.is_some_and(|error| error < 1e-9), "it is the same everywhere");
    }

    #[test]
    fn the_95th_percentile_is_that_of_pixels() {
        let reference = picture(|_, _| 1.0);
        for (share, expected) in [(4, 0.0), (6, 0.5)] {
            let some = picture(|pixel, _| if pixel % 100 < share { 1.5 } else { 1.0 });
            let seen = exact(&reference).errors(&some).expect("sound pictures").p95_relative.value;
            assert!(close(seen, expected, 1e-3), "{share} % of the pixels are off: {seen}");
        }
    }

    #[test]
    fn exposure_does_not_matter() {
        let (reference, seen) = (noisy(0, 0.0), noisy(1, 0.3));
        let brighter = |picture: &[[f32; 3]]| picture.iter().map(|p| p.map(|v| v * 1024.0)).collect::<Vec<_>>();
        let errors = exact(&reference).errors(&seen).expect("sound pictures");
        assert_eq!(exact(&brighter(&reference)).errors(&brighter(&seen)), Ok(errors), "a power of two is exact");
    }

    #[test]
    fn noise_of_the_reference_is_taken_off_where_it_is_known() {
        let truth = noisy(0, 0.0);
        let variance = vec![[0.04_f32; 3]; PIXELS];
        let rough = noisy(5, 0.2);
        let seen = noisy(9, 0.1);
        let honest = exact(&truth).errors(&seen).expect("sound pictures").rel_mse.value;
        let naive = exact(&rough).errors(&seen).expect("sound pictures").rel_mse;
        let known = Reference { variance: Some(&variance), ..exact(&rough) };
        let corrected = known.errors(&seen).expect("sound pictures");
        assert!(naive.value > 4.0 * honest, "without: {naive:?} for {honest}");
        assert!(agrees(corrected.rel_mse, honest), "with: {:?} for {honest}", corrected.rel_mse);
        let noise = corrected.reference_noise.expect("a variance");
        assert!(close(noise, naive.value - corrected.rel_mse.value, 1e-12), "{noise} was subtracted");

        let perfect = known.errors(&truth).expect("sound pictures");
        assert!(agrees(perfect.rel_mse, 0.0), "a perfect picture: {:?}", perfect.rel_mse);
        assert!(agrees(perfect.bias, 0.0), "a perfect picture: {:?}", perfect.bias);
        let upper = perfect.rel_rmse.value + perfect.rel_rmse.std_error.expect("tiles");
        assert!(upper > 0.0 && upper < 0.03, "its relRMSE: {:?}", perfect.rel_rmse);
    }

    #[test]
    fn what_runs_differ_by_is_what_the_standard_errors_say() {
        // Equally bright and equally noisy all over, so that pixels differ by nothing but noise.
        let reference = picture(|_, channel| 1.0 + channel as f32);
        let run = |seed: usize| {
            let at = |pixel: usize, channel: usize| noise((seed * PIXELS + pixel) * 3 + channel);
            let picture = picture(|pixel, channel| reference[pixel][channel] * (1.02 + 0.4 * at(pixel, channel)));
            exact(&reference).errors(&picture).expect("sound pictures")
        };
        let runs: Vec<Errors> = (1..=100).map(run).collect();
        type Figure = fn(&Errors) -> Estimate;
        let figures: [(&str, Figure); 5] = [
            ("relMSE", |errors| errors.rel_mse),
            ("relRMSE", |errors| errors.rel_rmse),
            ("bias", |errors| errors.bias),
            ("mean", |errors| errors.mean_relative),
            ("95 %", |errors| errors.p95_relative),
        ];
        for (name, figure) in figures {
            let values: Vec<f64> = runs.iter().map(|run| figure(run).value).collect();
            let mean = values.iter().sum::<f64>() / 100.0;
            let seen = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 99.0).sqrt();
            let said = runs.iter().filter_map(|run| figure(run).std_error).sum::<f64>() / 100.0;
            assert!((said / seen - 1.0).abs() < 0.25, "{name}: {said} said, {seen} seen");
        }
    }

    #[test]
    fn bias_and_variance_are_told_apart() {
        let truth = noisy(0, 0.0);
        let shifted = |seed: usize| -> Vec<[f32; 3]> {
            noisy(seed, 0.5).iter().map(|pixel| pixel.map(|value| value + 0.2)).collect()
        };
        let runs: Vec<Vec<[f32; 3]>> = (20..26).map(shifted).collect();
        let runs: Vec<&[[f32; 3]]> = runs.iter().map(Vec::as_slice).collect();
        let split = exact(&truth).split(&runs).expect("sound pictures");
        // Both over r² + ε, averaged.
        let eps = {
            let sum: f64 = truth.iter().flatten().map(|value| f64::from(*value)).sum();
            (0.01 * sum / (3 * PIXELS) as f64).powi(2)
        };
        let scale = truth.iter().flatten().map(|r| 1.0 / (f64::from(*r).powi(2) + eps)).sum::<f64>();
        let scale = scale / (3 * PIXELS) as f64;
        assert!(agrees(split.bias_squared, 0.04 * scale), "{:?}, not {}", split.bias_squared, 0.04 * scale);
        assert!(agrees(split.variance, 0.25 * scale), "{:?}, not {}", split.variance, 0.25 * scale);
        assert!(close(split.mse.value, split.bias_squared.value + split.variance.value, 1e-12), "{split:?}");
        let single = |picture: &&[[f32; 3]]| exact(&truth).errors(picture).expect("sound pictures").rel_mse.value;
        let average = runs.iter().map(single).sum::<f64>() / 6.0;
        assert!(close(split.mse.value, average, 1e-12), "{} and {average}", split.mse.value);
    }

    #[test]
    fn no_bias_is_found_where_there_is_none_even_with_a_noisy_reference() {
        let rough = noisy(50, 0.3);
        let variance = vec![[0.09_f32; 3]; PIXELS];
        let reference = Reference { variance: Some(&variance), ..exact(&rough) };
        let runs: Vec<Vec<[f32; 3]>> = (60..63).map(|seed| noisy(seed, 0.5)).collect();
        let split = reference.split(&runs.iter().map(Vec::as_slice).collect::<Vec<_>>()).expect("sound pictures");
        assert!(agrees(split.bias_squared, 0.0), "{:?}", split.bias_squared);
        assert!(split.variance.value > 10.0 * split.bias_squared.value.abs(), "{split:?}");
    }

    #[test]
    fn only_the_mask_is_measured() {
        let reference = picture(|_, _| 1.0);
        let mut seen = picture(|pixel, _| if pixel < 1000 { 1.1 } else { 9.0 });
        seen[2000] = [f32::NAN; 3];
        let mask: Vec<bool> = (0..PIXELS).map(|pixel| pixel < 1000).collect();
        let masked = Reference { mask: Some(&mask), ..exact(&reference) };
        let errors = masked.errors(&seen).expect("the NaN is outside");
        assert!(errors.pixels == 1000 && close(errors.bias.value, 0.1, 1e-6), "{errors:?}");
        let map: Vec<f32> = (0..PIXELS).map(|pixel| if pixel < 1000 { 0.25 } else { f32::NAN }).collect();
        assert_eq!(masked.mean_of(&map).map(|mean| mean.value), Ok(0.25));
        assert_eq!(exact(&reference).mean_of(&map), Err(MetricError::NotFinite { what: "map", pixel: 1000 }));
    }

    #[test]
    fn what_cannot_be_measured_is_refused() {
        use MetricError::*;
        let grey = [[0.5_f32; 3]; 6];
        let whole = Reference { pixels: &grey, variance: None, mask: None, width: 3 };
        let mut broken = grey;
        broken[4][2] = f32::INFINITY;
        let with = |reference: Reference<'_>| reference.errors(&grey).err();
        assert_eq!(whole.errors(&grey).map(|errors| errors.rel_mse), Ok(Estimate { value: 0.0, std_error: None }));
        assert_eq!(whole.errors(&broken), Err(NotFinite { what: "picture", pixel: 4 }));
        assert_eq!(whole.errors(&grey[..5]), Err(Length { what: "picture", expected: 6, found: 5 }));
        assert_eq!(with(Reference { pixels: &broken, ..whole }), Some(NotFinite { what: "reference", pixel: 4 }));
        assert_eq!(with(Reference { pixels: &[], ..whole }), Some(NoPixels));
        assert_eq!(with(Reference { pixels: &[[0.0; 3]; 6], ..whole }), Some(NoLight));
        assert_eq!(with(Reference { pixels: &[[-1.0; 3]; 6], ..whole }), Some(NoLight));
        assert_eq!(with(Reference { width: 4, ..whole }), Some(Rows { width: 4, pixels: 6 }));
        assert_eq!(with(Reference { width: 0, ..whole }), Some(Rows { width: 0, pixels: 6 }));
        assert_eq!(with(Reference { mask: Some(&[false; 6]), ..whole }), Some(NoPixels));
        assert_eq!(
            with(Reference { mask: Some(&[true; 5]), ..whole }),
            Some(Length { what: "mask", expected: 6, found: 5 })
        );
        assert_eq!(
            with(Reference { variance: Some(&grey[1..]), ..whole }),
            Some(Length { what: "variance", expected: 6, found: 5 })
        );
        assert_eq!(with(Reference { variance: Some(&[[-0.1; 3]; 6]), ..whole }), Some(NegativeVariance { pixel: 0 }));
        assert_eq!(whole.split(&[&grey]).err(), Some(TooFew { what: "seeds", found: 1 }));
        assert_eq!(whole.split(&[&grey, &broken]).err(), Some(NotFinite { what: "picture", pixel: 4 }));
    }
}
