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
    /// Where the image lies in a larger one, of which it is a part; `size` is then that of the part.
    pub window: Option<Window>,
}

/// Pictures of more pixels are rendered in bands: what is rendered together takes some 120 bytes for each.
pub const LARGEST_WHOLE_PX: u64 = 4096 * 2176;

/// The place of a part in a larger picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Pixels left of it and above it.
    pub offset: [u32; 2],
    /// Width and height of the whole in pixels, before [`Quality::resolution_scale`].
    pub whole: [u32; 2],
}

impl Frame<'_> {
    /// Width and height of the picture that is computed; at least one pixel each.
    pub fn render_size(&self) -> [u32; 2] {
        self.size.map(|side| self.scaled(side).max(1))
    }

    /// The same of the whole picture that this one may be a part of.
    pub fn whole_size(&self) -> [u32; 2] {
        self.window.map_or_else(|| self.render_size(), |window| window.whole.map(|side| self.scaled(side).max(1)))
    }

    /// Offset and size of the picture as shares of the whole that it may be a part of.
    pub fn window_shares(&self) -> ([f64; 2], [f64; 2]) {
        let Some(window) = self.window else { return ([0.0; 2], [1.0; 2]) };
        let (whole, size) = (self.whole_size(), self.render_size());
        let share = |pixels: [u32; 2], axis: usize| f64::from(pixels[axis]) / f64::from(whole[axis]);
        let offset = window.offset.map(|side| self.scaled(side));
        ([share(offset, 0), share(offset, 1)], [share(size, 0), share(size, 1)])
    }

    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a size in pixels; a cast from a float saturates"
    )]
    fn scaled(&self, side: u32) -> u32 {
        (f64::from(side) * f64::from(self.quality.resolution_scale)).round() as u32
    }
}
