//! Everything that one image depends on.

use super::{Quality, Scene};

/// What becomes of the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Output {
    /// The screen: half-float targets, tone-mapped.
    #[default]
    Display,
    /// A file of linear light: float targets; also tone-mapped.
    Linear,
    /// A file of the clouds alone: in-scattered light and opacity, float targets.
    CloudsAlone,
}

/// One image, borrowed from whoever owns the scene.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// What the sky is.
    pub scene: &'a Scene,
    /// How it is computed.
    pub quality: &'a Quality,
    /// Width and height in pixels, before [`Quality::resolution_scale`].
    pub size: [u32; 2],
    /// Seconds since the scene began.
    pub time_secs: f64,
    /// What becomes of the image.
    pub output: Output,
}

impl Frame<'_> {
    /// Width and height of the picture that is computed; at least one pixel each.
    #[allow(clippy::cast_possible_truncation, reason = "a size in pixels; a cast from a float saturates")]
    pub fn render_size(&self) -> [u32; 2] {
        let scale = f64::from(self.quality.resolution_scale);
        self.size.map(|side| ((f64::from(side) * scale).round() as u32).max(1))
    }
}
