//! A texture with its view and the bytes it takes.

use super::{Gpu, GpuError};

/// A texture and the view of all of it.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The texture.
    pub texture: wgpu::Texture,
    /// A view of all its levels.
    pub view: wgpu::TextureView,
}

impl Texture {
    /// What shaders need: written as storage, read as a texture, copied both ways.
    const USAGE: wgpu::TextureUsages = wgpu::TextureUsages::STORAGE_BINDING
        .union(wgpu::TextureUsages::TEXTURE_BINDING)
        .union(wgpu::TextureUsages::COPY_SRC)
        .union(wgpu::TextureUsages::COPY_DST);

    /// A flat image of `width`×`height` texels.
    pub fn new_2d(
        gpu: &Gpu,
        label: &str,
        [width, height]: [u32; 2],
        format: wgpu::TextureFormat,
    ) -> Result<Self, GpuError> {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if width > limit || height > limit {
            return Err(GpuError::TooLarge { what: "an image", width, height, limit });
        }
        Ok(Self::new(gpu, label, [width, height, 1], (1, format), wgpu::TextureDimension::D2))
    }

    /// Texels in three dimensions with `levels` mip levels.
    pub fn new_3d(gpu: &Gpu, label: &str, size: [u32; 3], levels: (u32, wgpu::TextureFormat)) -> Self {
        Self::new(gpu, label, size, levels, wgpu::TextureDimension::D3)
    }

    fn new(
        gpu: &Gpu,
        label: &str,
        size: [u32; 3],
        (levels, format): (u32, wgpu::TextureFormat),
        dimension: wgpu::TextureDimension,
    ) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: size[0].max(1),
                height: size[1].max(1),
                depth_or_array_layers: size[2].max(1),
            },
            mip_level_count: levels,
            sample_count: 1,
            dimension,
            format,
            usage: Self::USAGE,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view }
    }

    /// A view of one mip level, as storage bindings need it.
    pub fn level_view(&self, level: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: level,
            mip_level_count: Some(1),
            ..Default::default()
        })
    }

    /// Width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        [self.texture.width(), self.texture.height()]
    }

    /// Device memory of all levels, in bytes.
    pub fn bytes(&self) -> u64 {
        let texel = u64::from(self.texture.format().block_copy_size(None).unwrap_or(4));
        (0..self.texture.mip_level_count())
            .map(|level| {
                let side = |length: u32| u64::from((length >> level).max(1));
                let depth = if self.texture.dimension() == wgpu::TextureDimension::D3 {
                    side(self.texture.depth_or_array_layers())
                } else {
                    1
                };
                side(self.texture.width()) * side(self.texture.height()) * depth * texel
            })
            .sum()
    }
}
