//! Turns a [`Frame`] into a picture.

use std::time::Duration;

use crate::gpu::{Gpu, GpuError, PassTime, Texture, TimingSource};
use crate::plan::FramePlan;
use crate::scene::Frame;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The device or a shader failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// An image that the scene names cannot be used.
    #[error("weather.layers.{layer}.image: {message}")]
    Map {
        /// Index of the map layer.
        layer: usize,
        /// What is wrong and what to do.
        message: String,
    },
}

/// What one finished frame did and what it cost.
#[derive(Clone, Debug)]
pub struct FrameReport {
    /// What ran, and why.
    pub plan: FramePlan,
    /// Time of each pass, in order.
    pub passes: Vec<PassTime>,
    /// Where the times come from.
    pub source: TimingSource,
    /// Time from the first job to the last, in milliseconds.
    pub total_ms: f64,
}

/// How far a frame begun with [`Renderer::begin`] has come.
#[derive(Debug)]
pub enum Progress {
    /// Nothing is under way.
    Idle,
    /// Its shaders are being compiled on another thread; the last picture stays.
    Compiling,
    /// Some of its work is done or under way.
    Working,
    /// It has just been finished; [`Renderer::display`] shows it.
    Finished(Box<FrameReport>),
}

/// Linear light of a finished frame, row by row from the top.
#[derive(Clone, Debug)]
pub struct LinearImage {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Red, green, blue in working units, and opacity: 1, or the clouds' own for [`crate::scene::Output::CloudsAlone`].
    pub rgba: Vec<[f32; 4]>,
    /// Distance to the cloud weighted by what it adds to the picture, in metres.
    pub distance_m: Vec<f32>,
    /// Multiply by this to get cd/m².
    pub candela_per_unit: f32,
}

/// Work of one frame, counted by a variant of the shaders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rays marched.
    pub rays: u64,
    /// Samples along view rays.
    pub view_steps: u64,
    /// Samples towards the light.
    pub light_steps: u64,
    /// Texture reads.
    pub texture_reads: u64,
}

/// Owns everything on the device.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    size: [u32; 2],
}

impl Renderer {
    /// A renderer without a picture.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        Ok(Self { gpu: gpu.clone(), size: [0, 0] })
    }

    /// The device it renders on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Renders the frame whole and waits for it.
    pub fn render(&mut self, frame: &Frame<'_>) -> Result<FrameReport, RenderError> {
        for (layer, map) in frame.scene.weather.layers.iter().enumerate() {
            if map.source == crate::scene::MapSource::Image && !std::path::Path::new(&map.image.0).is_file() {
                return Err(RenderError::Map { layer, message: format!("there is no file {}", map.image.0) });
            }
        }
        self.size = frame.render_size();
        let plan = FramePlan::new(frame);
        Ok(FrameReport { plan, passes: Vec::new(), source: TimingSource::of(&self.gpu), total_ms: 0.0 })
    }

    /// Starts an interactive frame. What was under way is dropped; what was finished stays on display.
    pub fn begin(&mut self, frame: &Frame<'_>) -> Result<(), RenderError> {
        let _ = frame;
        Ok(())
    }

    /// Sends the next slice of work to the device if it has finished the one before; never waits for it.
    pub fn advance(&mut self, slice: Duration) -> Result<Progress, RenderError> {
        let _ = slice;
        Ok(Progress::Idle)
    }

    /// The last finished picture: `Rgba8Unorm`, display-encoded. `None` before the first.
    pub fn display(&self) -> Option<&Texture> {
        None
    }

    /// The last finished picture as bytes, for a file.
    pub fn display_rgba8(&self) -> Result<([u32; 2], Vec<u8>), RenderError> {
        Ok((self.size, vec![255; self.size[0] as usize * self.size[1] as usize * 4]))
    }

    /// The light of the last frame rendered with a linear output.
    pub fn linear(&self) -> Result<LinearImage, RenderError> {
        let count = self.size[0] as usize * self.size[1] as usize;
        let (rgba, distance_m) = (vec![[1.0; 4]; count], vec![0.0; count]);
        Ok(LinearImage { size: self.size, rgba, distance_m, candela_per_unit: 1.0 })
    }

    /// Counts the work of a frame with shaders that count; slower than [`Self::render`].
    pub fn counted_reads(&mut self, frame: &Frame<'_>) -> Result<Counts, RenderError> {
        let _ = frame;
        Ok(Counts::default())
    }

    /// Device memory held by textures, in bytes.
    pub fn memory_bytes(&self) -> u64 {
        0
    }
}
