//! Textures that depend on the size of the picture. Allocated by what the plan calls for; the rest is let go.

use super::passes::view_of;
use crate::gpu::{Gpu, GpuError, Texture};
use crate::plan::FramePlan;

const SHADOW_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What the targets of a frame are made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    size: [u32; 2],
    rays: [u32; 2],
    float: bool,
    clouds: bool,
    distance: bool,
    temporal: bool,
    ground: bool,
    shafts: bool,
    shadow_px: Option<u32>,
    samples: bool,
}

/// Clouds at the resolution of rays or of pixels: light and transmittance, and mean distance.
#[derive(Clone, Debug)]
pub(super) struct CloudTarget {
    pub(super) light: Texture,
    /// Where anything asks for it.
    pub(super) distance: Option<Texture>,
}

impl CloudTarget {
    /// What writes them, by the names that shaders give them.
    pub(super) fn outputs(&self) -> impl Iterator<Item = (&'static str, wgpu::BindingResource<'_>)> {
        let all = [("cloud_out", Some(&self.light)), ("distance_out", self.distance.as_ref())];
        all.into_iter().filter_map(|(name, texture)| Some((name, view_of(texture?))))
    }

    fn bytes(&self) -> u64 {
        self.light.bytes() + self.distance.as_ref().map_or(0, Texture::bytes)
    }
}

/// The mean of the samples so far.
#[derive(Debug)]
pub(super) struct Mean {
    /// Display light: after the tone map, linear.
    pub(super) shown: Texture,
    /// Light for a file.
    pub(super) linear: Option<Texture>,
}

/// All targets of one size.
#[derive(Debug)]
pub(super) struct Targets {
    shape: Shape,
    pub(super) background: Texture,
    pub(super) ground_distance: Option<Texture>,
    pub(super) cloud_shadow: Option<Texture>,
    /// What the march writes: rays of a partial update, or all pixels.
    pub(super) marched: Option<CloudTarget>,
    /// Full pictures that take turns as history and as result: light and transmittance.
    pub(super) history: Option<[Texture; 2]>,
    pub(super) shafts: Option<[Texture; 2]>,
    /// Light for a file, where pixels have a single sample.
    linear: Option<Texture>,
    /// Where they have several: the mean before, and after.
    pub(super) means: Option<[Mean; 2]>,
    /// Finished pictures: one is shown while the other is made.
    pub(super) display: [Texture; 2],
}

/// Rays of a frame, across and down.
pub(super) fn ray_count(plan: &FramePlan, size: [u32; 2]) -> [u32; 2] {
    let block = plan.temporal.map_or([1, 1], crate::plan::UpdatePattern::block);
    [size[0].div_ceil(block[0]), size[1].div_ceil(block[1])]
}

impl Targets {
    /// The targets for a plan: `kept` if they fit.
    pub(super) fn fitting(
        kept: Option<Self>,
        gpu: &Gpu,
        plan: &FramePlan,
        size: [u32; 2],
    ) -> Result<(Self, bool), GpuError> {
        let shape = Shape {
            size,
            rays: ray_count(plan, size),
            float: plan.float,
            clouds: plan.has_clouds(),
            distance: plan.march.is_some_and(|march| march.distance),
            temporal: plan.temporal.is_some(),
            ground: plan.ground.is_some(),
            shafts: plan.sunshafts.is_some(),
            shadow_px: plan.ground.and_then(|ground| ground.shadow_px),
            samples: plan.pixel_samples > 1,
        };
        match kept {
            Some(kept) if kept.shape == shape => Ok((kept, false)),
            _ => Ok((Self::new(gpu, shape)?, true)),
        }
    }

    fn new(gpu: &Gpu, shape: Shape) -> Result<Self, GpuError> {
        let Shape { size, rays, float, .. } = shape;
        let format = if float { wgpu::TextureFormat::Rgba32Float } else { wgpu::TextureFormat::Rgba16Float };
        let image = |label: &str, size: [u32; 2], format| Texture::new_2d(gpu, label, size, format);
        let distance = wgpu::TextureFormat::R32Float;
        let cloud = |label: &str, size| -> Result<CloudTarget, GpuError> {
            let distance = shape.distance.then(|| image(label, size, distance)).transpose()?;
            Ok(CloudTarget { light: image(label, size, format)?, distance })
        };
        let display = |label: &str| image(label, size, wgpu::TextureFormat::Rgba8Unorm);
        let linear = || float.then(|| image("linear", size, wgpu::TextureFormat::Rgba32Float)).transpose();
        let mean = || -> Result<Mean, GpuError> {
            Ok(Mean { shown: image("mean", size, wgpu::TextureFormat::Rgba16Float)?, linear: linear()? })
        };
        let shaft_size = size.map(|side| side.div_ceil(4));
        let shaft = |label: &str| image(label, shaft_size, wgpu::TextureFormat::Rgba16Float);
        Ok(Self {
            shape,
            background: image("background", size, format)?,
            ground_distance: shape.ground.then(|| image("ground_distance", size, distance)).transpose()?,
            cloud_shadow: shape.shadow_px.map(|side| image("cloud_shadow", [side; 2], SHADOW_FORMAT)).transpose()?,
            marched: shape.clouds.then(|| cloud("marched", rays)).transpose()?,
            history: if shape.temporal {
                Some([image("history", size, format)?, image("history", size, format)?])
            } else {
                None
            },
            shafts: if shape.shafts { Some([shaft("shafts_mask")?, shaft("shafts")?]) } else { None },
            linear: if shape.samples { None } else { linear()? },
            means: if shape.samples { Some([mean()?, mean()?]) } else { None },
            display: [display("display")?, display("display")?],
        })
    }

    /// Light for a file: that of the one sample, or the mean on this side.
    pub(super) fn linear(&self, side: usize) -> Option<&Texture> {
        self.means.as_ref().map_or(self.linear.as_ref(), |means| means[side].linear.as_ref())
    }

    /// Size of the picture.
    pub(super) fn size(&self) -> [u32; 2] {
        self.shape.size
    }

    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let marched: u64 = self.marched.iter().map(CloudTarget::bytes).sum();
        let clouds = marched + self.history.iter().flatten().map(Texture::bytes).sum::<u64>();
        let single = [self.ground_distance.as_ref(), self.cloud_shadow.as_ref(), self.linear.as_ref()];
        let single: u64 = single.into_iter().flatten().map(Texture::bytes).sum();
        let means = self.means.iter().flatten().flat_map(|mean| [Some(&mean.shown), mean.linear.as_ref()]);
        let means: u64 = means.flatten().map(Texture::bytes).sum();
        let shafts: u64 = self.shafts.iter().flatten().map(Texture::bytes).sum();
        clouds
            + single
            + shafts
            + means
            + self.background.bytes()
            + self.display.iter().map(Texture::bytes).sum::<u64>()
    }
}
