//! Draws egui's triangles with wgpu.
//!
//! egui's own painter for wgpu chooses its texture filter and dithering by branches in the fragment shader. Software
//! drivers carry out both sides of every branch: on llvmpipe that took 70 ms for 1280×720 where this takes a
//! fraction. It also panics when the device is lost; here a failed upload is one bad frame.

use std::collections::HashMap;

use egui::epaint::{ImageDelta, Primitive};
use egui::{ClippedPrimitive, ImageData, TextureId};

use crate::gpu::Gpu;

/// Bytes of one corner: position, texture coordinates, colour.
const CORNER_BYTES: u64 = 20;

/// How large the screen is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    /// In pixels.
    pub(super) size_px: [u32; 2],
    /// Pixels per point.
    pub(super) pixels_per_point: f32,
}

/// A texture as the shader sees it, and the texture itself where it is the painter's own.
struct Image {
    bindings: wgpu::BindGroup,
    texture: Option<wgpu::Texture>,
}

/// Pipeline, textures and buffers.
pub(super) struct Painter {
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    images: HashMap<TextureId, Image>,
    next_own: u64,
    screen: wgpu::Buffer,
    screen_bindings: wgpu::BindGroup,
    corners: wgpu::Buffer,
    indices: wgpu::Buffer,
}

impl Painter {
    /// A painter for targets of this format, which must be in gamma space.
    pub(super) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let pipeline = pipeline(&gpu.device, format);
        let screen = gpu.uniform("panels: screen", &[0; 16]);
        let screen_bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("panels: screen"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: screen.as_entire_binding() }],
        });
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("panels"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self {
            pipeline,
            sampler,
            images: HashMap::new(),
            next_own: 0,
            screen,
            screen_bindings,
            corners: buffer(gpu, wgpu::BufferUsages::VERTEX, 1 << 18),
            indices: buffer(gpu, wgpu::BufferUsages::INDEX, 1 << 17),
        }
    }

    /// Makes a view known under an id of its own, or under `id` again.
    pub(super) fn register(&mut self, gpu: &Gpu, view: &wgpu::TextureView, id: Option<TextureId>) -> TextureId {
        let id = id.unwrap_or_else(|| {
            self.next_own += 1;
            TextureId::User(self.next_own)
        });
        let bindings = self.bind(gpu, view);
        self.images.insert(id, Image { bindings, texture: None });
        id
    }

    fn bind(&self, gpu: &Gpu, view: &wgpu::TextureView) -> wgpu::BindGroup {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("panels: image"),
            layout: &self.pipeline.get_bind_group_layout(1),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            ],
        })
    }

    /// Takes over what egui changed in one of its textures.
    pub(super) fn update_texture(&mut self, gpu: &Gpu, id: TextureId, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size.map(|side| u32::try_from(side).unwrap_or(u32::MAX));
        let extent = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        if delta.pos.is_none() {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("panels: egui"),
                size: extent,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            });
            let bindings = self.bind(gpu, &texture.create_view(&wgpu::TextureViewDescriptor::default()));
            self.images.insert(id, Image { bindings, texture: Some(texture) });
        }
        let Some(texture) = self.images.get(&id).and_then(|image| image.texture.as_ref()) else { return };
        let [x, y] = delta.pos.unwrap_or([0, 0]).map(|place| u32::try_from(place).unwrap_or(0));
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x, y, z: 0 },
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(&image.pixels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None },
            extent,
        );
    }

    /// Forgets a texture.
    pub(super) fn free_texture(&mut self, id: TextureId) {
        self.images.remove(&id);
    }

    /// Draws the triangles over a black target.
    pub(super) fn paint(
        &mut self,
        gpu: &Gpu,
        target: &wgpu::TextureView,
        triangles: &[ClippedPrimitive],
        screen: Screen,
    ) -> wgpu::CommandBuffer {
        self.upload(gpu, triangles, screen);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("panels") });
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("panels"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.screen_bindings, &[]);
            pass.set_vertex_buffer(0, self.corners.slice(..));
            pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
            self.draw(&mut pass, triangles, screen);
        }
        encoder.finish()
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, triangles: &[ClippedPrimitive], screen: Screen) {
        let (mut first_index, mut first_corner) = (0_u32, 0_i32);
        for ClippedPrimitive { clip_rect, primitive } in triangles {
            let Primitive::Mesh(mesh) = primitive else { continue };
            let last_index = first_index + u32::try_from(mesh.indices.len()).unwrap_or(0);
            let scissor = scissor(*clip_rect, screen);
            if let (Some([x, y, width, height]), Some(image)) = (scissor, self.images.get(&mesh.texture_id)) {
                pass.set_scissor_rect(x, y, width, height);
                pass.set_bind_group(1, &image.bindings, &[]);
                pass.draw_indexed(first_index..last_index, first_corner, 0..1);
            }
            first_index = last_index;
            first_corner += i32::try_from(mesh.vertices.len()).unwrap_or(0);
        }
    }

    /// Sends all corners and indices in one write each.
    fn upload(&mut self, gpu: &Gpu, triangles: &[ClippedPrimitive], screen: Screen) {
        let (mut corners, mut indices) = (Vec::<u8>::new(), Vec::<u8>::new());
        for ClippedPrimitive { primitive, .. } in triangles {
            if let Primitive::Mesh(mesh) = primitive {
                corners.extend_from_slice(bytemuck::cast_slice(&mesh.vertices));
                indices.extend_from_slice(bytemuck::cast_slice(&mesh.indices));
            }
        }
        fit(gpu, &mut self.corners, corners.len());
        fit(gpu, &mut self.indices, indices.len());
        gpu.queue.write_buffer(&self.corners, 0, &corners);
        gpu.queue.write_buffer(&self.indices, 0, &indices);
        let points = screen.size_px.map(|side| side as f32 / screen.pixels_per_point);
        gpu.queue.write_buffer(&self.screen, 0, bytemuck::cast_slice(&points));
    }
}

fn pipeline(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("painter.wgsl"));
    let attributes = wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Unorm8x4];
    let add =
        |src_factor, dst_factor| wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("panels"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: CORNER_BYTES,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            })],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format,
                blend: Some(wgpu::BlendState {
                    color: add(wgpu::BlendFactor::One, wgpu::BlendFactor::OneMinusSrcAlpha),
                    alpha: add(wgpu::BlendFactor::OneMinusDstAlpha, wgpu::BlendFactor::One),
                }),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn buffer(gpu: &Gpu, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("panels"),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Replaces a buffer by a larger one if it is too small.
fn fit(gpu: &Gpu, kept: &mut wgpu::Buffer, bytes: usize) {
    let bytes = bytes as u64;
    if kept.size() < bytes {
        let usage = kept.usage().difference(wgpu::BufferUsages::COPY_DST);
        *kept = buffer(gpu, usage, bytes.next_power_of_two());
    }
}

/// A rectangle in points as x, y, width, height in pixels; `None` if nothing of it is on the screen.
#[allow(clippy::cast_possible_truncation, reason = "clamped to 0 ..= limit")]
fn scissor(rect: egui::Rect, screen: Screen) -> Option<[u32; 4]> {
    let pixel = |points: f32, limit: u32| ((points * screen.pixels_per_point).round().max(0.0) as u32).min(limit);
    let [width, height] = screen.size_px;
    let (left, right) = (pixel(rect.min.x, width), pixel(rect.max.x, width));
    let (top, bottom) = (pixel(rect.min.y, height), pixel(rect.max.y, height));
    (right > left && bottom > top).then(|| [left, top, right - left, bottom - top])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scissors_stay_on_the_screen() {
        let screen = Screen { size_px: [100, 50], pixels_per_point: 2.0 };
        let rect = |x0, y0, x1, y1| egui::Rect::from_min_max(egui::pos2(x0, y0), egui::pos2(x1, y1));
        assert_eq!(scissor(rect(-5.0, 1.0, 20.0, 400.0), screen), Some([0, 2, 40, 48]));
        assert_eq!(scissor(rect(60.0, 0.0, 70.0, 10.0), screen), None, "outside");
        assert_eq!(scissor(rect(5.0, 5.0, 5.0, 9.0), screen), None, "empty");
    }
}
