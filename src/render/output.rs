//! Finished pictures, and counted work, back on the processor.

use super::{FrameReport, RenderError, Renderer};
use crate::gpu::{Texture, job, readback};
use crate::plan::FramePlan;
use crate::scene::Frame;

/// Linear light of a finished frame, row by row from the top.
#[derive(Clone, Debug)]
pub struct LinearImage {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Red, green, blue in working units, and opacity: 1, or the clouds' own for
    /// [`Output::CloudsAlone`](crate::scene::Output::CloudsAlone).
    pub rgba: Vec<[f32; 4]>,
    /// Distance to the cloud weighted by what it adds to the picture, in metres; 0 where there is none.
    pub distance_m: Vec<f32>,
    /// Multiply by this to get cd/m².
    pub candela_per_unit: f32,
}

/// Work of one frame's march, counted by a variant of its shader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rays marched.
    pub rays: u64,
    /// Steps along them.
    pub view_steps: u64,
    /// Steps towards the light.
    pub light_steps: u64,
    /// Texture reads of the density field.
    pub texture_reads: u64,
}

impl Renderer {
    /// The last finished picture as bytes, for a file: size, then red, green, blue and 255 for each pixel.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn display_rgba8(&self) -> Result<([u32; 2], Vec<u8>), RenderError> {
        self.shown.as_ref().map_or(Ok(([0, 0], Vec::new())), |texture| self.rgba8_of(texture))
    }

    /// The same of any picture that is shown, such as a truth's.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn rgba8_of(&self, shown: &Texture) -> Result<([u32; 2], Vec<u8>), RenderError> {
        Ok((shown.size(), readback::texture(&self.gpu, shown)?))
    }

    /// The light of the last frame rendered with a linear output.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn linear(&self) -> Result<LinearImage, RenderError> {
        let candela_per_unit = self.candela_per_unit;
        let Some((targets, linear)) = self.targets.as_ref().and_then(|targets| Some((targets, targets.linear(0)?)))
        else {
            return Ok(LinearImage { size: [0, 0], rgba: Vec::new(), distance_m: Vec::new(), candela_per_unit });
        };
        let rgba = readback::rgba(&self.gpu, linear)?;
        let distance_m = match targets.marched.as_ref().and_then(|cloud| cloud.distance.as_ref()) {
            Some(distance) => readback::scalars(&self.gpu, distance)?,
            None => vec![0.0; rgba.len()],
        };
        Ok(LinearImage { size: targets.size(), rgba, distance_m, candela_per_unit })
    }

    /// Clouds of the last finished frame: light and transmittance of each pixel, for tests and comparisons.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn clouds(&self) -> Result<Vec<[f32; 4]>, RenderError> {
        match self.last_cloud() {
            Some(cloud) => Ok(readback::rgba(&self.gpu, cloud)?),
            None => Ok(Vec::new()),
        }
    }

    /// Light and transmittance of the clouds of the last finished frame.
    pub(super) fn last_cloud(&self) -> Option<&Texture> {
        let targets = self.targets.as_ref()?;
        let temporal = targets.history.as_ref().zip(self.history.as_ref());
        let marched = targets.marched.as_ref().map(|marched| &marched.light);
        temporal.map(|(sides, history)| &sides[history.side]).or(marched)
    }

    /// Renders the frame with a shader that counts, which costs time and must not be timed.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn counted_reads(&mut self, frame: &Frame<'_>) -> Result<Counts, RenderError> {
        self.finish_interactive()?;
        let counters = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("counters"),
            size: 16,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let (jobs, _) = self.schedule(frame, FramePlan::forced(frame, self.forced), None, Some(&counters))?;
        job::run(&self.gpu, &jobs)?;
        let _: Option<FrameReport> = self.complete();
        let bytes = readback::buffer(&self.gpu, &counters)?;
        let counted: Vec<u64> = bytemuck::cast_slice::<u8, u32>(&bytes).iter().map(|count| u64::from(*count)).collect();
        Ok(Counts { rays: counted[0], view_steps: counted[1], light_steps: counted[2], texture_reads: counted[3] })
    }
}
