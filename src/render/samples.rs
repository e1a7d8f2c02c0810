//! Several samples of each pixel, for pictures that take their time: edges come out smooth, and what one jittered march
//! meets by chance is met by all of them on average.
//!
//! Samples are whole pictures, one after the other over the same targets; the passes at their end keep two means in turn,
//! of light for a file, and of display light for the screen. A disc far above white would have no smooth edge if its light
//! were averaged before the tone map.

use glam::Vec2;

use super::uniforms::scene::ViewUniforms;
use crate::gpu::Gpu;

/// How far each sample shifts the jitter of the march: the golden ratio spreads any number of them evenly.
const JITTER_SHIFT: f32 = 0.618_034;

/// The shift of a sample or a seed.
pub(super) fn jitter_shift(index: u32) -> f32 {
    (index as f32 * JITTER_SHIFT).fract()
}

/// Where a picture's samples have got to.
#[derive(Debug)]
pub(super) struct PixelSamples {
    view: ViewUniforms,
    buffer: wgpu::Buffer,
    count: u32,
    current: u32,
}

impl PixelSamples {
    /// `count` samples of what `view` sees, which `buffer` tells the passes. The first one is begun.
    pub(super) fn new(gpu: &Gpu, view: &ViewUniforms, buffer: &wgpu::Buffer, count: u32) -> Self {
        let samples = Self { view: *view, buffer: buffer.clone(), count: count.max(1), current: 0 };
        samples.write(gpu);
        samples
    }

    /// Begins the next one; `false` where there is none.
    pub(super) fn next(&mut self, gpu: &Gpu) -> bool {
        let is_there = self.current + 1 < self.count;
        if is_there {
            self.current += 1;
            self.write(gpu);
        }
        is_there
    }

    /// Drops the one under way for the one before it, whose mean is still there.
    pub(super) fn step_back(&mut self) {
        self.current = self.current.saturating_sub(1);
    }

    /// How many there will be.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// Which of the two means the one under way goes into.
    pub(super) fn side(&self) -> usize {
        self.current as usize % 2
    }

    fn write(&self, gpu: &Gpu) {
        let mut view = self.view;
        view.pixel_point = point(self.current, self.count);
        view.jitter.y = (self.view.jitter.y + jitter_shift(self.current)).fract();
        view.sample_share = 1.0 / (self.current + 1) as f32;
        view.sample_angle = self.view.pixel_angle / (self.count as f32).sqrt();
        gpu.queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(&view));
    }
}

/// A place in the unit square: no two of `count` share a row or a column of `count` each (rooks on a board), in the order
/// of the Halton sequence, begun in the middle, so that any first few of them balance too. A single one lies in the middle.
fn point(index: u32, count: u32) -> Vec2 {
    let rank = |base: u32| {
        let own = inverse(index, base);
        (0..count).filter(|other| inverse(*other, base) < own).count() as f32
    };
    (Vec2::new(rank(2), rank(3)) + 0.5) / count as f32
}

/// Digits of a number behind the point in reverse (van der Corput), half a turn on.
fn inverse(mut index: u32, base: u32) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0);
    while index > 0 {
        digit /= f64::from(base);
        value += digit * f64::from(index % base);
        index /= base;
    }
    (value + 0.5).fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_sample_looks_through_the_middle() {
        assert_eq!(point(0, 1), Vec2::splat(0.5));
    }

    #[test]
    fn samples_share_neither_rows_nor_columns_and_balance() {
        for count in [2u32, 3, 4, 7, 16, 64] {
            let points: Vec<Vec2> = (0..count).map(|index| point(index, count)).collect();
            let mean = points.iter().sum::<Vec2>() / count as f32;
            assert!((mean - 0.5).length() < 1e-5, "{count}: the picture does not shift, {mean}");
            let mut rows: Vec<f32> = points.iter().map(|point| point.y).collect();
            rows.sort_by(f32::total_cmp);
            let expected = (0..count).map(|row| (row as f32 + 0.5) / count as f32);
            assert!(rows.iter().zip(expected).all(|(seen, row)| (seen - row).abs() < 1e-6), "{count}: {rows:?}");
        }
        for count in [4u32, 8, 16, 64] {
            for first in 1..=count {
                let mean = (0..first).map(|index| point(index, count)).sum::<Vec2>() / first as f32;
                assert!((mean - 0.5).abs().max_element() < 0.26, "the first {first} of {count} lie aside: {mean}");
            }
            let begin = point(0, count);
            assert!((begin - 0.5).abs().max_element() < 0.15, "the first of {count}: {begin}");
        }
    }
}
