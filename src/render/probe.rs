//! The clouds at one place, for the inspector.

use wgpu::util::DeviceExt as _;

use super::context::Extent;
use super::passes::field_key;
use super::still::Apart;
use super::{RenderError, Renderer};
use crate::gpu::{ProgramKey, job, readback};
use crate::plan::{FramePlan, Integrator};
use crate::scene::Frame;

/// What is there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Probe {
    /// Density of each visible layer, 0 to 1 times its multiplier.
    pub densities: [f32; 4],
    /// Light lost per metre.
    pub extinction_per_m: f32,
}

/// The program that looks, where a plan has clouds.
pub fn programs(plan: &FramePlan) -> Option<ProgramKey> {
    plan.march.map(|march| field_key("pass/probe.wgsl", march))
}

impl Renderer {
    /// The clouds at a place, in metres from the eye to the east, above sea level at the eye, and to the south; `None` while the
    /// shader is compiled.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn probe(&mut self, frame: &Frame<'_>, place_m: [f32; 3]) -> Result<Option<Probe>, RenderError> {
        let plan = FramePlan::for_still(frame, (Integrator::Realtime, 1), self.forced);
        let Some(key) = programs(&plan) else { return Ok(Some(Probe::default())) };
        if !self.programs.ready_or_start(&key)? {
            return Ok(None);
        }
        let Apart { buffers, .. } = self.begin_apart(frame, &plan)?;
        let [x, y, z] = place_m;
        let values: [[f32; 4]; 3] = [[x, y, z, 0.0], [0.0; 4], [0.0; 4]];
        let probe = self.gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("probe"),
            contents: bytemuck::cast_slice(&values),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        });
        let mut bound = self.shared_resources();
        bound.extend(buffers.resources());
        bound.push(("probe", probe.as_entire_binding()));
        let look = self.context_apart().whole("probe", &key, &bound, Extent::image([1, 1]))?;
        job::submit(&self.gpu, &[look]);
        let bytes = readback::buffer(&self.gpu, &probe)?;
        let float = |index: usize| {
            let four = bytes.get(4 * index..4 * index + 4).and_then(|four| four.try_into().ok());
            four.map_or(0.0, f32::from_le_bytes)
        };
        Ok(Some(Probe { densities: std::array::from_fn(|layer| float(4 + layer)), extinction_per_m: float(8) }))
    }
}
