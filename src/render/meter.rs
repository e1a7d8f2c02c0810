//! The light meter: how many pixels of the last picture have which luminance.

use super::context::{Context, Extent};
use super::passes::{composed_flags, view_of};
use super::uniforms::scene::ViewUniforms;
use super::{RenderError, Renderer};
use crate::gpu::{ProgramKey, job, readback};
use crate::plan::FramePlan;

/// Bins to a stop, their number and the lowest stop of working units, as in `pass/meter.wgsl`.
const BINS_PER_STOP: f64 = 8.0;
const BINS: usize = 320;
const LOWEST_STOP: f64 = -24.0;

/// Shares of the pixels, from the darkest and from the brightest, that the meter does not look at.
const IGNORED: [f64; 2] = [0.02, 0.02];

/// A histogram of luminance in exposure values at ISO 100: log2(8 L), L in cd/m².
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightHistogram {
    /// Lower edge of the first bin.
    pub lowest_ev: f64,
    /// Pixels in each; bins are [`Self::BIN_EV`] wide. What lies outside is counted in the first and the last.
    pub bins: Vec<u32>,
}

impl LightHistogram {
    /// Width of a bin in stops.
    pub const BIN_EV: f64 = 1.0 / BINS_PER_STOP;

    /// Middle of a bin.
    pub fn ev(&self, bin: usize) -> f64 {
        self.lowest_ev + (bin as f64 + 0.5) * Self::BIN_EV
    }

    /// How many pixels there are.
    pub fn total(&self) -> u64 {
        self.bins.iter().map(|count| u64::from(*count)).sum()
    }

    /// Share of the pixels that are brighter than this.
    pub fn share_above(&self, ev: f64) -> f64 {
        let above = self.bins.iter().enumerate().filter(|(bin, _)| self.ev(*bin) > ev);
        above.map(|(_, count)| f64::from(*count)).sum::<f64>() / (self.total().max(1)) as f64
    }

    /// The exposure that shows the mean of all stops, but for the darkest and brightest few pixels, as middle grey; `None` for a
    /// picture without light.
    pub fn exposure_ev(&self) -> Option<f64> {
        // The first bin is black.
        let total = self.bins.iter().skip(1).map(|count| f64::from(*count)).sum::<f64>();
        let (low, high) = (IGNORED[0] * total, (1.0 - IGNORED[1]) * total);
        let (mut before, mut weight, mut sum) = (0.0, 0.0, 0.0);
        for (bin, count) in self.bins.iter().enumerate().skip(1) {
            let after = before + f64::from(*count);
            let inside = (after.min(high) - before.max(low)).max(0.0);
            (weight, sum) = (weight + inside, sum + inside * self.ev(bin));
            before = after;
        }
        // Middle grey, 0.18 of the curve's white, lies at 0.18 · 1.2 · 2^exposure; a meter's EV is log2(8 L).
        (weight > 0.0).then(|| sum / weight - (8.0_f64 * 1.2 * 0.18).log2())
    }
}

fn key(plan: &FramePlan) -> ProgramKey {
    ProgramKey::plain("pass/meter.wgsl").with_flags(composed_flags(plan))
}

/// The program that counts.
pub fn programs(plan: &FramePlan) -> [ProgramKey; 1] {
    [key(plan)]
}

impl Renderer {
    /// Counts the luminances of the last finished picture; nothing before the first, and while another is under way.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn light_histogram(&mut self) -> Result<Option<LightHistogram>, RenderError> {
        if self.pending.is_some() {
            return Ok(None);
        }
        let (Some(targets), Some(plan)) = (&self.targets, &self.last_plan) else { return Ok(None) };
        let key = key(plan);
        if !self.programs.ready_or_start(&key)? {
            return Ok(None);
        }
        let context = Context { gpu: &self.gpu, programs: &self.programs, pace: &self.pace, slice_ms: None };
        let view = ViewUniforms { size: targets.size().into(), ..bytemuck::Zeroable::zeroed() };
        let view = self.gpu.uniform("view", bytemuck::bytes_of(&view));
        let bins = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("bins"),
            size: 4 * BINS as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut bound = self.shared_resources();
        bound.extend([
            ("view", view.as_entire_binding()),
            ("background", view_of(&targets.background)),
            ("bins", bins.as_entire_binding()),
        ]);
        bound.extend(self.last_cloud().map(|cloud| ("cloud", view_of(cloud))));
        bound.extend(targets.shafts.iter().map(|[_, shafts]| ("shafts_light", view_of(shafts))));
        let meter = context.whole("meter", &key, &bound, Extent::image(targets.size()))?;
        job::submit(&self.gpu, &[meter]);
        let bytes = readback::buffer(&self.gpu, &bins)?;
        let lowest_ev = LOWEST_STOP + f64::from(self.candela_per_unit * 8.0).log2();
        let bins = bytes.chunks_exact(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect();
        Ok(Some(LightHistogram { lowest_ev, bins }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histogram(counts: &[(usize, u32)]) -> LightHistogram {
        let mut bins = vec![0; BINS];
        for (bin, count) in counts {
            bins[*bin] = *count;
        }
        LightHistogram { lowest_ev: -8.0, bins }
    }

    #[test]
    fn the_meter_finds_the_middle_and_ignores_specks() {
        let even = histogram(&[(160, 500), (176, 500)]);
        let grey = (8.0_f64 * 1.2 * 0.18).log2();
        let exposure = even.exposure_ev().expect("there is light") + grey;
        assert!((exposure - (even.ev(160) + 1.0)).abs() < 0.05, "between two stops: {exposure}");
        let speck = histogram(&[(160, 990), (319, 10)]);
        assert!((speck.exposure_ev().expect("light") + grey - speck.ev(160)).abs() < 0.05, "a sun of one percent");
        assert_eq!(histogram(&[(0, 1000)]).exposure_ev(), None, "black");
        assert_eq!(histogram(&[]).exposure_ev(), None, "nothing");
        assert!((even.share_above(even.ev(170)) - 0.5).abs() < 1e-9);
    }
}
