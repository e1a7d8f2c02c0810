//! Quality: how the sky is computed. It belongs to the user and the command line, not to the sky.

use crate::{choices, params};

choices! {
    /// The share of pixels that one frame computes anew.
    pub enum UpdateFraction {
        /// Every pixel.
        Full ("1/1"),
        /// Every other pixel, as on a checkerboard.
        Half ("1/2"),
        /// One of each 2×2.
        Quarter ("1/4"),
        /// One of each 4×4.
        Sixteenth ("1/16"),
    }
}

choices! {
    /// The order in which the pixels of a 4×4 block take their turn (Koblížek 2019, figure 3.3).
    pub enum UpdateOrder {
        /// The cross pattern, figure 3.3(c): neighbours in time are far apart.
        Cross ("Cross"),
        /// Multiples of seven, figure 3.3(b).
        Sevens ("×7"),
        /// Row by row, figure 3.3(a).
        Naive ("Naive"),
    }
}

choices! {
    /// A named set of quality settings.
    pub enum QualityLevel {
        /// For slow machines and quick looks.
        Draft ("Draft"),
        /// For work in the viewport.
        Preview ("Preview"),
        /// For stills.
        High ("High"),
        /// For export.
        Final ("Final"),
    }
}

params! {
    /// How the sky is computed.
    pub struct Quality ("Quality") {
        /// Most steps along a view ray; if steps are not equal, the second half of them grow where they would not take all of its way.
        view_steps: u32 = 160, 4..=1024, None;
        /// Length of the first step inside cloud; up to twice as long where a layer is thicker than 1.2 km, longer in deep, soft sheets, a little shorter where a layer is flatter, and a little longer in very thin cloud.
        step_m: f32 = 45.0, 1.0..=1000.0, Metres, logarithmic;
        /// Growth of the step with distance: metres more per metre.
        step_growth: f32 = 0.0038, 0.0..=0.1, None;
        /// Optical depth of a step inside dense cloud; the step is never longer than its length by distance.
        step_depth: f32 = 1.0, 0.02..=10_000.0, None, logarithmic;
        /// Longest step near cloud but outside, relative to one in cloud; farther away steps are as long as the weather map allows. 1 takes equal steps everywhere.
        empty_stride: f32 = 1.2, 1.0..=8.0, None;
        /// Clear air is crossed in one step as far as the weather map promises it.
        skip_clear: bool = true;
        /// Greatest distance at which clouds are drawn.
        max_distance_m: f32 = 350_000.0, 1000.0..=500_000.0, Metres, logarithmic;
        /// Steps from a sample towards the light; up to five times as many where layers are thick or the light is low and no grid is read, and down to a third in thin cloud.
        light_steps: u32 = 18, 1..=128, None;
        /// Longest way covered towards the light; shorter where it leaves the clouds before.
        light_reach_m: f32 = 100_000.0, 50.0..=500_000.0, Metres, logarithmic;
        /// Length of each light step relative to the one before, over a way of a kilometre; more over longer ways.
        light_growth: f32 = 1.1, 1.0..=4.0, None;
        /// How many of the light steps read the small noise.
        light_detail_steps: u32 = 6, 0..=128, None;
        /// Nodes across a grid of the sun's optical depth, from which steps towards the light beyond the first few cells are read. 0 takes all steps.
        light_grid: u32 = 320, 0..=384, None;
        /// Samples that follow each other inside cloud are lit as one until they send so much of what the eye sees. 0 lights each by itself.
        light_share: f32 = 0.45, 0.0..=1.0, None;
        /// Octaves of multiple scattering on top of the first. 0 is true single scattering.
        octaves: u32 = 5, 0..=7, None;
        /// Transmittance below which a ray ends.
        early_exit: f32 = 0.02, 0.0..=0.2, None;
        /// Distance at which the small noise has faded to its mean; it begins to at half of it.
        detail_distance_m: f32 = 150_000.0, 100.0..=500_000.0, Metres, logarithmic;
        /// Coarser (above 0) or finer mip levels of the noises with distance.
        noise_level_bias: f32 = 0.0, -4.0..=4.0, None;
        /// Voxels across a box into which the density of all its clouds is baked before it is read, half as many upwards (Costa 2023, table 10). 0 reads the field as it is.
        grid_voxels: u32 = 0, 0..=512, None;
        /// Share of pixels computed anew in a frame.
        update: UpdateFraction = UpdateFraction::Sixteenth;
        /// Order in which pixels take their turn.
        update_order: UpdateOrder = UpdateOrder::Cross;
        /// Samples of each pixel in a still, and in the window at rest. A picture that moves has one.
        pixel_samples: u32 = 4, 1..=64, None;
        /// Length of the steps of a still, and of the window at rest, relative to those of a picture that moves.
        still_step: f32 = 0.7, 0.1..=1.0, None;
        /// Resolution of the picture relative to its frame.
        resolution_scale: f32 = 1.0, 0.1..=2.0, None;
        /// Edge length of the map of cloud shadows on the ground.
        shadow_map_px: u32 = 128, 32..=1024, Pixels;
        /// Samples along a streak of light.
        shaft_samples: u32 = 24, 4..=128, None;
    }
}

impl Quality {
    /// The settings behind a name.
    pub fn level(level: QualityLevel) -> Self {
        match level {
            QualityLevel::Draft => Self {
                view_steps: 96,
                step_m: 110.0,
                step_growth: 0.012,
                step_depth: 2.5,
                light_steps: 9,
                light_growth: 1.2,
                light_grid: 96,
                light_detail_steps: 0,
                octaves: 4,
                pixel_samples: 1,
                still_step: 1.0,
                resolution_scale: 0.75,
                shadow_map_px: 128,
                ..Self::default()
            },
            QualityLevel::Preview => Self::default(),
            QualityLevel::High => Self {
                view_steps: 400,
                step_m: 18.0,
                step_growth: 0.0025,
                step_depth: 0.5,
                empty_stride: 1.1,
                light_steps: 24,
                light_growth: 1.08,
                light_grid: 384,
                light_detail_steps: 10,
                light_share: 0.2,
                octaves: 6,
                early_exit: 0.004,
                update: UpdateFraction::Full,
                still_step: 1.0,
                shadow_map_px: 384,
                shaft_samples: 48,
                ..Self::default()
            },
            QualityLevel::Final => Self {
                view_steps: 1000,
                step_m: 10.0,
                step_growth: 0.0014,
                step_depth: 0.25,
                empty_stride: 1.1,
                light_steps: 36,
                light_growth: 1.06,
                light_grid: 0,
                light_detail_steps: 24,
                light_share: 0.05,
                octaves: 7,
                early_exit: 0.001,
                detail_distance_m: 400_000.0,
                update: UpdateFraction::Full,
                pixel_samples: 8,
                still_step: 1.0,
                shadow_map_px: 512,
                shaft_samples: 64,
                ..Self::default()
            },
        }
    }

    /// The same with the march of another: how its steps are taken. Size, order and share of pixels, samples, shadows and
    /// voxels stay.
    #[must_use]
    pub fn with_march_of(&self, other: &Self) -> Self {
        Self {
            update: self.update,
            update_order: self.update_order,
            resolution_scale: self.resolution_scale,
            pixel_samples: self.pixel_samples,
            still_step: self.still_step,
            shadow_map_px: self.shadow_map_px,
            shaft_samples: self.shaft_samples,
            grid_voxels: self.grid_voxels,
            ..other.clone()
        }
    }

    /// The same for a picture that takes its time: all pixels, and shorter steps.
    #[must_use]
    pub fn of_still(&self) -> Self {
        let scale = self.still_step;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, and clamped")]
        let finer = |count: u32, most: f32| (count as f32 / scale).ceil().min(most) as u32;
        Self {
            view_steps: finer(self.view_steps, 1024.0),
            step_m: self.step_m * scale,
            step_growth: self.step_growth * scale,
            light_grid: finer(self.light_grid, 384.0),
            update: UpdateFraction::Full,
            still_step: 1.0,
            ..self.clone()
        }
    }

    /// How much light steps grow over their whole way, for each metre of it: over a kilometre as [`Self::light_growth`]
    /// says.
    pub fn light_spread_per_m(&self) -> f32 {
        // Steps without end would otherwise begin shorter than f32 can tell.
        (self.light_growth.powf(self.light_steps as f32) - 1.0).min(1e5) / 1000.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_a_still_are_shorter_and_reach_as_far() {
        let quality = Quality { still_step: 0.5, ..Quality::default() };
        let still = quality.of_still();
        assert_eq!((still.step_m, still.step_growth), (0.5 * quality.step_m, 0.5 * quality.step_growth));
        assert_eq!(still.view_steps, 2 * quality.view_steps);
        assert_eq!(still.of_still(), still, "once is enough");
        let high = Quality::level(QualityLevel::High);
        assert_eq!(high.of_still(), high, "high is meant for stills as it is");
    }

    #[test]
    fn light_steps_grow_over_a_kilometre_as_they_are_told() {
        let quality = Quality { light_growth: 1.5, light_steps: 6, ..Quality::default() };
        let spread = 1.0 + 1000.0 * quality.light_spread_per_m();
        assert!((spread.powf(1.0 / 6.0) - 1.5).abs() < 1e-4, "{spread}");
        let extreme = Quality { light_growth: 4.0, light_steps: 128, ..Quality::default() };
        assert!(extreme.light_spread_per_m().is_finite());
        assert_eq!(Quality { light_growth: 1.0, ..extreme }.light_spread_per_m(), 0.0, "equal steps");
    }
}
