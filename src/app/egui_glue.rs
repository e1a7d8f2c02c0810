//! egui on winit and wgpu: input in, triangles out.

use std::time::Duration;

use egui_wgpu::{RendererOptions, ScreenDescriptor};
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
use winit::window::Window;

use super::surface::{Acquired, WindowSurface};
use super::worker::Event;
use crate::gpu::Gpu;
use crate::ui::{self, Picture};

/// egui with everything it needs on this window and device.
pub(super) struct Egui {
    context: egui::Context,
    state: egui_winit::State,
    renderer: egui_wgpu::Renderer,
    /// The texture that stands for the picture, and the texture it was made from.
    picture: Option<(Picture, wgpu::Texture)>,
    /// How often the device was replaced.
    rebuilt: u32,
}

/// A frame of the panels that was run but not yet drawn.
struct Output {
    triangles: Vec<egui::ClippedPrimitive>,
    textures: egui::TexturesDelta,
    screen: ScreenDescriptor,
}

impl Egui {
    /// egui for a window that is not shown yet.
    pub(super) fn new(
        (event_loop, proxy): (&ActiveEventLoop, EventLoopProxy<Event>),
        window: &Window,
        gpu: &Gpu,
        format: wgpu::TextureFormat,
    ) -> Self {
        let context = egui::Context::default();
        ui::style(&context);
        let limit = gpu.device.limits().max_texture_dimension_2d as usize;
        let scale = window.scale_factor() as f32;
        let theme = window.theme();
        let mut state =
            egui_winit::State::new(context.clone(), egui::ViewportId::ROOT, window, Some(scale), theme, Some(limit));
        state.init_accesskit(event_loop, window, proxy);
        let renderer = egui_wgpu::Renderer::new(&gpu.device, format, RendererOptions::default());
        Self { context, state, renderer, picture: None, rebuilt: 0 }
    }

    /// The context.
    pub(super) fn context(&self) -> &egui::Context {
        &self.context
    }

    /// Starts over on another device; theme, scale and folded sections stay.
    pub(super) fn rebuild(&mut self, gpu: &Gpu, format: wgpu::TextureFormat) {
        self.renderer = egui_wgpu::Renderer::new(&gpu.device, format, RendererOptions::default());
        self.picture = None;
        // The new renderer lacks the fonts' texture. Only other definitions make egui send it anew, so one font gets
        // one more name, which nothing uses.
        self.rebuilt += 1;
        let mut fonts = ui::fonts();
        if let Some(data) = fonts.font_data.values().next().cloned() {
            fonts.font_data.insert(format!("device {}", self.rebuilt), data);
        }
        self.context.set_fonts(fonts);
    }

    /// Hands an event to egui; tells whether the panels must be drawn again.
    pub(super) fn on_window_event(&mut self, window: &Window, event: &WindowEvent) -> bool {
        self.state.on_window_event(window, event).repaint
    }

    /// Hands what a screen reader asks for to egui.
    pub(super) fn on_accessibility_request(&mut self, request: egui::accesskit::ActionRequest) {
        self.state.on_accesskit_action_request(request);
    }

    /// Makes the renderer's texture known to egui.
    pub(super) fn set_picture(&mut self, gpu: &Gpu, texture: Option<&crate::gpu::Texture>) -> Option<Picture> {
        let Some(texture) = texture else { return self.picture.as_ref().map(|(picture, _)| *picture) };
        let filter = wgpu::FilterMode::Linear;
        let size = texture.size();
        let id = match &self.picture {
            Some((picture, source)) if *source == texture.texture => picture.texture,
            Some((picture, _)) => {
                let id = picture.texture;
                self.renderer.update_egui_texture_from_wgpu_texture(&gpu.device, &texture.view, filter, id);
                id
            }
            None => self.renderer.register_native_texture(&gpu.device, &texture.view, filter),
        };
        let picture = Picture { texture: id, size };
        self.picture = Some((picture, texture.texture.clone()));
        Some(picture)
    }

    /// Runs the panels, draws them with the picture and presents. Returns when egui wants to be run again.
    pub(super) fn frame(
        &mut self,
        (window, event_loop): (&Window, &ActiveEventLoop),
        gpu: &Gpu,
        surface: &mut WindowSurface,
        panels: &mut dyn FnMut(&mut egui::Ui),
    ) -> Duration {
        let input = self.state.take_egui_input(window);
        let output = self.context.run_ui(input, panels);
        self.state.handle_platform_output_with_event_loop(window, event_loop, output.platform_output);
        let again = output.viewport_output.get(&egui::ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        let output = Output {
            triangles: self.context.tessellate(output.shapes, output.pixels_per_point),
            textures: output.textures_delta,
            screen: ScreenDescriptor { size_in_pixels: surface.size(), pixels_per_point: output.pixels_per_point },
        };
        self.draw(window, gpu, surface, output);
        again.unwrap_or(Duration::MAX)
    }

    fn draw(&mut self, window: &Window, gpu: &Gpu, surface: &mut WindowSurface, mut output: Output) {
        let Gpu { device, queue, .. } = gpu;
        for (id, deltas) in &output.textures.set {
            for delta in deltas {
                self.renderer.update_texture(device, queue, *id, delta);
            }
        }
        if let Acquired::Image(image) = surface.acquire(gpu) {
            let view = image.texture.create_view(&wgpu::TextureViewDescriptor::default());
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("panels") });
            let uploads =
                self.renderer.update_buffers(device, queue, &mut encoder, &output.triangles, &output.screen);
            {
                let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("panels"),
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view: &view,
                        depth_slice: None,
                        resolve_target: None,
                        ops: wgpu::Operations {
                            load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                            store: wgpu::StoreOp::Store,
                        },
                    })],
                    ..Default::default()
                });
                self.renderer.render(&mut pass.forget_lifetime(), &output.triangles, &output.screen);
            }
            queue.submit(uploads.into_iter().chain([encoder.finish()]));
            window.pre_present_notify();
            queue.present(image);
        }
        for id in &output.textures.free {
            self.renderer.free_texture(id);
        }
        // egui insists on hearing that all of them were seen to.
        output.textures.clear();
    }
}
