//! Looks for values that are not finite, and says which pass wrote the first of them.

use super::context::{Context, Extent};
use super::passes::view_of;
use super::{RenderError, Renderer};
use crate::gpu::{ProgramKey, Texture, job, readback};

/// Values of one texture that are not finite.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broken {
    /// The pass that wrote it.
    pub pass: &'static str,
    /// Texels with such a value.
    pub texels: u32,
}

impl std::fmt::Display for Broken {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{} wrote {} texels that are not finite", self.pass, self.texels)
    }
}

/// The program that counts, for flat textures or for volumes.
fn key(is_volume: bool) -> ProgramKey {
    ProgramKey::plain("pass/watch.wgsl").with_flags(is_volume.then_some("VOLUME"))
}

/// The programs of the watch.
pub fn programs() -> [ProgramKey; 2] {
    [key(false), key(true)]
}

impl Renderer {
    /// Looks at the tables, noises, maps, voxels and targets of the last frame, in the order in which they were made: one read
    /// for each texel.
    /// The first entry is where the fault began; empty is well.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn find_broken(&mut self) -> Result<Vec<Broken>, RenderError> {
        self.finish_interactive()?;
        let context = Context { gpu: &self.gpu, programs: &self.programs, pace: &self.pace, slice_ms: None };
        let mut broken = Vec::new();
        for (pass, texture) in self.watched() {
            let counter = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("counters"),
                size: 16,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            let bound = vec![("watched", view_of(texture)), ("counters", counter.as_entire_binding())];
            let is_volume = texture.texture.dimension() == wgpu::TextureDimension::D3;
            let watch = context.whole("watch", &key(is_volume), &bound, Extent::image(texture.size()))?;
            job::submit(&self.gpu, &[watch]);
            let bytes = readback::buffer(&self.gpu, &counter)?;
            let texels = bytes.first_chunk().map_or(0, |first: &[u8; 4]| u32::from_le_bytes(*first));
            if texels > 0 {
                broken.push(Broken { pass, texels });
            }
        }
        Ok(broken)
    }

    /// Every texture of the last frame whose values are light, depth or distance, with the pass that wrote it.
    fn watched(&self) -> Vec<(&'static str, &Texture)> {
        let mut all = Vec::new();
        if let Some(sky) = &self.sky {
            all.extend([
                ("sky_transmittance", &sky.transmittance),
                ("sky_multiscatter", &sky.multiscatter),
                ("sky_view", &sky.view),
            ]);
            all.extend(sky.aerial.iter().flatten().map(|texture| ("sky_aerial", texture)));
            all.extend(sky.ambient.iter().map(|texture| ("sky_ambient", texture)));
        }
        all.extend(self.bakes.textures());
        all.extend(self.weather.map().map(|map| ("weather_map", map)));
        all.extend(self.voxels.textures());
        all.extend(self.living.textures());
        all.extend(self.clearance.texture().map(|ways| ("clear_spread", ways)));
        all.extend(self.sun_grid.texture().map(|depths| ("sun_sweep", depths)));
        let Some(targets) = &self.targets else { return all };
        all.extend(targets.cloud_shadow.iter().map(|texture| ("cloud_shadow", texture)));
        all.push(("background", &targets.background));
        all.extend(targets.ground_distance.iter().map(|texture| ("background", texture)));
        if let Some(marched) = &targets.marched {
            all.push(("march", &marched.light));
            all.extend(marched.distance.iter().map(|texture| ("march", texture)));
        }
        if let (Some(sides), Some(history)) = (&targets.history, &self.history) {
            all.push(("temporal", &sides[history.side]));
        }
        all.extend(targets.shafts.iter().flatten().map(|texture| ("sunshafts", texture)));
        all.extend(targets.linear(0).map(|texture| ("composite", texture)));
        all
    }
}
