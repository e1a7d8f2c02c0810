//! Weather maps that grow out of an image of the user's: more of its kind beyond its border, and another of its kind in time.
//!
//! By-example noise with a blending operator that keeps the histogram (Heitz and Neyret, "High-Performance By-Example Noise
//! using a Histogram-Preserving Blending Operator", 2018): patches of the image, whose values have been made normally
//! distributed, are blended so that their sum stays so, and are given the image's own distribution again.

use super::context::{Context, Extent};
use super::uniforms::other::GrowUniforms;
use super::weather::{SIDE, STATES, uploaded};
use crate::gpu::{GpuError, Job, ProgramKey, Texture};
use crate::images::map::MapImage;
use crate::scene::MapLayer;

/// Values of the table that takes normal values back to the image's.
const TABLE: usize = 1024;
/// The normal values' mean and standard deviation: six of them span 0 to 1.
const MEAN: f64 = 0.5;
const SIGMA: f64 = 1.0 / 6.0;
/// Share of a normal distribution below 0 and above 1, which the values leave out.
const TAIL: f64 = 0.001_35;
/// Patches across the image: each vertex of the lattice has one, as wide as two of its cells.
const PATCHES: f32 = 4.0;

/// An image to grow from.
#[derive(Debug)]
pub(super) struct Example {
    /// Which image.
    pub(super) name: String,
    image: Texture,
    normal: Texture,
    back: Texture,
}

impl Example {
    pub(super) fn new(gpu: &crate::gpu::Gpu, name: &str, image: &MapImage) -> Result<Self, GpuError> {
        // No finer than the map that it grows.
        let (pixels, width) = reduced(&image.rgba, image.width as usize, SIDE as usize);
        let (normal, back) = normal_values(&pixels, width);
        #[allow(clippy::cast_possible_truncation, reason = "small sizes")]
        let (table, size) = ([TABLE as u32, 1], [width as u32; 2]);
        Ok(Self {
            name: name.to_owned(),
            image: uploaded(gpu, ("weather_image", size), &pixels)?,
            normal: uploaded(gpu, ("weather_normal", size), &normal)?,
            back: uploaded(gpu, ("weather_back", table), &back)?,
        })
    }

    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        [&self.image, &self.normal, &self.back].map(Texture::bytes).iter().sum()
    }

    /// What a map grown from the image is at a state; at state 0 the image itself lies in its middle.
    pub(super) fn grown(
        &self,
        context: &Context<'_>,
        (layer, state): (&MapLayer, i64),
        sampler: &wgpu::Sampler,
        jobs: &mut Vec<Job>,
    ) -> Result<Texture, GpuError> {
        let texture = Texture::new_2d(context.gpu, "weather_state", [SIDE; 2], wgpu::TextureFormat::Rgba16Float)?;
        let uniforms = uniforms(layer, state);
        let buffer = context.gpu.uniform("grow", bytemuck::bytes_of(&uniforms));
        let bound = vec![
            ("grow", buffer.as_entire_binding()),
            ("linear_repeat", wgpu::BindingResource::Sampler(sampler)),
            ("example", wgpu::BindingResource::TextureView(&self.image.view)),
            ("example_normal", wgpu::BindingResource::TextureView(&self.normal.view)),
            ("example_back", wgpu::BindingResource::TextureView(&self.back.view)),
            ("map_out", wgpu::BindingResource::TextureView(&texture.view)),
        ];
        jobs.push(context.whole("weather_grow", &key(), &bound, Extent::image([SIDE; 2]))?);
        Ok(texture)
    }
}

/// The program that grows maps.
pub(super) fn key() -> ProgramKey {
    ProgramKey::plain("pass/weather_grow.wgsl")
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small counts; epochs are hashed as bits")]
fn uniforms(layer: &MapLayer, state: i64) -> GrowUniforms {
    let cells = (PATCHES / layer.image_share).round().max(2.0);
    let age = (state as f64 / STATES as f64).abs().min(1.0);
    GrowUniforms {
        seed: layer.seed,
        cells: cells as u32,
        epoch: state.div_euclid(STATES) as u32,
        phase: state.rem_euclid(STATES) as f32 / STATES as f32,
        image_share: layer.image_share,
        image_weight: (1.0 - age * age * (3.0 - 2.0 * age)) as f32,
        patch_share: (2.0 / cells / layer.image_share).min(1.0),
        pad0: 0.0,
    }
}

/// Values of each channel by their rank as those of a normal distribution (the Gaussian histogram transformation), and the look-up
/// table of its inverse.
fn normal_values(rgba: &[[f32; 4]], width: usize) -> (Vec<[f32; 4]>, Vec<[f32; 4]>) {
    let mut normal = vec![[0.5; 4]; rgba.len()];
    let mut back = vec![[0.0; 4]; TABLE];
    let shares: Vec<f64> = (0..TABLE)
        .map(|index| (probability((index as f64 / (TABLE - 1) as f64 - MEAN) / SIGMA) - TAIL) / (1.0 - 2.0 * TAIL))
        .collect();
    for channel in 0..4 {
        let values: Vec<f32> = rgba.iter().map(|pixel| pixel[channel].clamp(0.0, 1.0)).collect();
        // Where much of the image has one value, as clear air has, places nearer to others rank nearer to them.
        let near = blurred(&values, width);
        // Those that are alike even there, in any order but that of rows.
        let lot = |at: usize| at.wrapping_mul(0x9e37_79b9) & 0xffff_ffff;
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|a, b| {
            values[*a].total_cmp(&values[*b]).then(near[*a].total_cmp(&near[*b])).then(lot(*a).cmp(&lot(*b)))
        });
        let count = values.len() as f64;
        for (rank, at) in order.iter().enumerate() {
            #[allow(clippy::cast_possible_truncation, reason = "a texel")]
            let value = (MEAN + SIGMA * deviate(TAIL + (1.0 - 2.0 * TAIL) * (rank as f64 + 0.5) / count))
                .clamp(0.0, 1.0) as f32;
            normal[*at][channel] = value;
        }
        for (entry, share) in back.iter_mut().zip(&shares) {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
            let rank = ((share * count) as usize).min(values.len() - 1);
            entry[channel] = values[order[rank]];
        }
    }
    (normal, back)
}

/// A square image of at most so many pixels a side: each the mean of a square of the image's.
fn reduced(rgba: &[[f32; 4]], width: usize, most: usize) -> (Vec<[f32; 4]>, usize) {
    let square = width.div_ceil(most);
    if square <= 1 {
        return (rgba.to_vec(), width);
    }
    let side = width / square;
    let mean = |index: usize| {
        let (x, y) = (index % side * square, index / side * square);
        let pixels = (0..square * square).map(|k| rgba[(y + k / square) * width + x + k % square]);
        pixels
            .fold([0.0; 4], |sum, pixel| std::array::from_fn(|channel| sum[channel] + pixel[channel]))
            .map(|sum: f32| sum / (square * square) as f32)
    };
    ((0..side * side).map(mean).collect(), side)
}

/// Means over a sixteenth of the image about each of its pixels; the image goes on at its ends as at its border.
fn blurred(values: &[f32], width: usize) -> Vec<f32> {
    let reach = (width / 32).max(1);
    let along = |values: &[f32], place: &dyn Fn(usize, usize) -> usize| {
        let mut means = vec![0.0; values.len()];
        for line in 0..width {
            let at = |i: isize| f64::from(values[place(line, i.clamp(0, width.cast_signed() - 1).unsigned_abs())]);
            let mut sum: f64 = (-reach.cast_signed()..=reach.cast_signed()).map(at).sum();
            for i in 0..width {
                #[allow(clippy::cast_possible_truncation, reason = "a mean of values in 0..1")]
                let mean = (sum / (2 * reach + 1) as f64) as f32;
                means[place(line, i)] = mean;
                let i = i.cast_signed();
                sum += at(i + 1 + reach.cast_signed()) - at(i - reach.cast_signed());
            }
        }
        means
    };
    let rows = along(values, &|line, i| line * width + i);
    along(&rows, &|line, i| i * width + line)
}

/// The normal deviate that a share of all lies below (Abramowitz and Stegun, 26.2.23; to 4.5e-4).
fn deviate(share: f64) -> f64 {
    let tail = share.min(1.0 - share).max(1e-12);
    let t = (-2.0 * tail.ln()).sqrt();
    let above =
        t - (2.515_517 + t * (0.802_853 + t * 0.010_328)) / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308)));
    if share < 0.5 { -above } else { above }
}

/// The share of all that lies below a normal deviate: the deviates' inverse, by halving.
fn probability(value: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if deviate(middle) < value {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    fn normal_values_are_normal_and_go_back_to_what_they_were() {
        let width = 64;
        let value = |at: usize| ((at % width) as f32 / 63.0 * ((at / width) as f32 / 63.0) - 0.2).max(0.0);
        let rgba: Vec<[f32; 4]> = (0..width * width).map(|at| [value(at), 1.0 - value(at), 0.3, 1.0]).collect();
        let (normal, back) = normal_values(&rgba, width);
        let mean = |power: i32| {
            normal.iter().map(|pixel| ((f64::from(pixel[0]) - MEAN) / SIGMA).powi(power)).sum::<f64>()
                / normal.len() as f64
        };
        // Of a normal distribution that ends at three standard deviations.
        let (second, fourth) = (mean(2), mean(4));
        assert!((second - 0.973).abs() < 0.005 && (fourth - 2.68).abs() < 0.05, "{second}, {fourth}");
        assert!(mean(1).abs() < 0.005 && mean(3).abs() < 0.01, "{} {}", mean(1), mean(3));
        for (at, pixel) in normal.iter().enumerate() {
            for channel in 0..4 {
                let index = (pixel[channel] * (TABLE - 1) as f32).round() as usize;
                let returned = back[index][channel];
                assert!((returned - rgba[at][channel]).abs() < 0.02, "{returned} for {:?}", rgba[at]);
            }
        }
    }

    #[test]
    fn shares_and_deviates_are_each_others_inverse() {
        for (share, value) in [(0.5, 0.0), (0.841_345, 1.0), (0.022_750, -2.0), (0.998_650, 3.0)] {
            assert!((deviate(share) - value).abs() < 1e-3, "{share}");
            assert!((probability(value) - share).abs() < 3e-4, "{value}");
        }
    }
}
