//! Flicker: what changes from frame to frame while nothing moves.

use super::estimate::{mean, share_below};
use super::{Estimate, MetricError, check_length, check_rows, measured};
use crate::lab::colour::luminance;

/// How much luminance varies over frames of a scene whose camera and clouds stand still. Zero for a picture that is
/// computed whole, and for reprojection once it has gone round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flicker {
    /// Mean over pixels of σ / √(μ² + ε), where μ and σ are a pixel's mean and standard deviation over the frames and
    /// ε = (0.01 · mean μ)²; 0 and up.
    pub mean: Estimate,
    /// What 95 % of the pixels stay below.
    pub p95: Estimate,
    /// Frames.
    pub frames: usize,
    /// Pixels measured.
    pub pixels: usize,
}

/// Gathers frames one by one, so that none has to be kept (Welford 1962).
#[derive(Clone, Debug)]
pub struct Frames {
    width: usize,
    count: usize,
    mean: Vec<f64>,
    /// Sum of squared distances from the mean.
    squares: Vec<f64>,
}

impl Frames {
    /// For frames of that many pixels in rows of `width`.
    ///
    /// # Errors
    /// If there are no pixels or they do not fill whole rows.
    pub fn new(width: usize, pixels: usize) -> Result<Self, MetricError> {
        check_rows(width, pixels)?;
        Ok(Self { width, count: 0, mean: vec![0.0; pixels], squares: vec![0.0; pixels] })
    }

    /// Adds a frame of linear light.
    ///
    /// # Errors
    /// If it has another number of pixels; then nothing is added.
    pub fn add(&mut self, frame: &[[f32; 3]]) -> Result<(), MetricError> {
        check_length("frame", self.mean.len(), frame.len())?;
        self.count += 1;
        let count = self.count as f64;
        for ((mean, square), pixel) in self.mean.iter_mut().zip(&mut self.squares).zip(frame) {
            let value = luminance(*pixel);
            let before = value - *mean;
            *mean += before / count;
            *square += before * (value - *mean);
        }
        Ok(())
    }

    /// The flicker of the frames so far, over the pixels of the mask or over all.
    ///
    /// # Errors
    /// With fewer than two frames, no pixels, a value that is not finite in a pixel measured, or no light.
    pub fn flicker(&self, mask: Option<&[bool]>) -> Result<Flicker, MetricError> {
        if self.count < 2 {
            return Err(MetricError::TooFew { what: "frames", found: self.count });
        }
        let pixels = measured(mask, self.mean.len())?;
        if let Some(pixel) = pixels.iter().find(|pixel| !(self.mean[**pixel] + self.squares[**pixel]).is_finite()) {
            return Err(MetricError::NotFinite { what: "frame", pixel: *pixel });
        }
        let light = pixels.iter().map(|pixel| self.mean[*pixel]).sum::<f64>() / pixels.len() as f64;
        let floor = super::floor(light)?;
        let freedom = (self.count - 1) as f64;
        let relative = |pixel: usize| (self.squares[pixel] / freedom / (self.mean[pixel].powi(2) + floor)).sqrt();
        let samples: Vec<(usize, f64)> = pixels.iter().map(|pixel| (*pixel, relative(*pixel))).collect();
        let mean = mean(self.width, samples.iter().copied()).ok_or(MetricError::NoPixels)?;
        let p95 = share_below(self.width, &samples, 0.95).ok_or(MetricError::NoPixels)?;
        Ok(Flicker { mean, p95, frames: self.count, pixels: pixels.len() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_still_picture_does_not_flicker_and_one_pixel_shows() {
        let still = vec![[0.3_f32, 0.2, 0.1]; 16 * 16];
        let mut frames = Frames::new(16, still.len()).expect("whole rows");
        for _ in 0..5 {
            frames.add(&still).expect("the same size");
        }
        let quiet = frames.flicker(None).expect("light");
        assert_eq!((quiet.mean.value, quiet.p95.value, quiet.frames), (0.0, 0.0, 5));
    }

    #[test]
    fn the_figure_is_the_standard_deviation_over_the_mean() {
        // Luminance 1 and 3 in turn: mean 2, σ² = 4 · 1 / 3 with four frames; ε adds (0.01 · 2)².
        let mut frames = Frames::new(16, 256).expect("whole rows");
        for value in [1.0, 3.0, 1.0, 3.0] {
            frames.add(&[[value; 3]; 256]).expect("the same size");
        }
        let expected = (4.0_f64 / 3.0 / (4.0 + 4e-4)).sqrt();
        let flicker = frames.flicker(None).expect("light");
        assert!((flicker.mean.value - expected).abs() < 1e-6, "{flicker:?} instead of {expected}");
        assert!((flicker.p95.value - expected).abs() < 1e-6, "{flicker:?}");
    }

    #[test]
    fn great_values_do_not_swallow_small_changes() {
        let mut frames = Frames::new(2, 4).expect("whole rows");
        for value in [65_504.0, 65_472.0] {
            frames.add(&[[value; 3]; 4]).expect("the same size");
        }
        let expected = 32.0 / 2.0_f64.sqrt() / 65_488.0;
        let seen = frames.flicker(None).expect("light").mean.value;
        assert!((seen / expected - 1.0).abs() < 1e-3, "{seen} instead of {expected}");
    }

    #[test]
    fn a_bad_pixel_matters_only_where_it_is_measured() {
        let mut frames = Frames::new(2, 4).expect("whole rows");
        let mut broken = [[1.0_f32; 3]; 4];
        broken[3][0] = f32::NAN;
        assert_eq!(frames.flicker(None), Err(MetricError::TooFew { what: "frames", found: 0 }));
        frames.add(&broken).expect("the same size");
        frames.add(&[[1.0; 3]; 4]).expect("the same size");
        assert_eq!(frames.flicker(None), Err(MetricError::NotFinite { what: "frame", pixel: 3 }));
        let mask = [true, true, true, false];
        assert_eq!(frames.flicker(Some(&mask)).map(|flicker| flicker.pixels), Ok(3));
        assert_eq!(frames.flicker(Some(&[false; 4])), Err(MetricError::NoPixels));
        assert!(frames.add(&[[1.0; 3]; 3]).is_err(), "another size");
        assert!(Frames::new(3, 4).is_err() && Frames::new(0, 0).is_err(), "no whole rows");
    }
}
