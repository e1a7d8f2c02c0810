//! egui on winit and wgpu: input in, triangles out.

use std::time::Duration;

use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
use winit::window::Window;

use super::painter::{Painter, Screen};
use super::surface::{Acquired, WindowSurface};
use super::worker::Event;
use crate::gpu::Gpu;
use crate::ui::{self, Picture};

/// egui with everything it needs on this window and device.
pub(super) struct Egui {
    context: egui::Context,
    state: egui_winit::State,
    painter: Painter,
    /// The textures that stand for the pictures, and the textures they were made from.
    pictures: [Option<(Picture, wgpu::Texture)>; Place::COUNT],
    /// How often the device was replaced.
    rebuilt: u32,
}

/// What a picture of the renderer's is to the panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// The last finished frame.
    Frame,
    /// The realtime picture of all pixels.
    Still,
    /// The converged picture.
    Converged,
    /// The path-traced picture.
    Traced,
    /// What the window shows at rest.
    AtRest,
    /// The weather map from above.
    Map,
}

impl Place {
    const COUNT: usize = 6;
}

/// A frame of the panels that was run but not yet drawn.
struct Output {
    triangles: Vec<egui::ClippedPrimitive>,
    textures: egui::TexturesDelta,
    screen: Screen,
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
        #[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
        let scale = window.scale_factor() as f32;
        let theme = window.theme();
        let mut state =
            egui_winit::State::new(context.clone(), egui::ViewportId::ROOT, window, Some(scale), theme, Some(limit));
        state.init_accesskit(event_loop, window, proxy);
        let painter = Painter::new(gpu, format);
        Self { context, state, painter, pictures: Default::default(), rebuilt: 0 }
    }

    /// The context.
    pub(super) fn context(&self) -> &egui::Context {
        &self.context
    }

    /// Starts over on another device; theme, scale and folded sections stay.
    pub(super) fn rebuild(&mut self, gpu: &Gpu, format: wgpu::TextureFormat) {
        self.painter = Painter::new(gpu, format);
        self.pictures = Default::default();
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

    /// Makes a texture of the renderer's known to egui, and lets go of the one that was in its place.
    pub(super) fn set_picture(
        &mut self,
        gpu: &Gpu,
        place: Place,
        texture: Option<&crate::gpu::Texture>,
    ) -> Option<Picture> {
        let kept = &mut self.pictures[place as usize];
        let Some(texture) = texture else {
            if let Some((picture, _)) = kept.take() {
                self.painter.free_texture(picture.texture);
            }
            return None;
        };
        let id = match &*kept {
            Some((picture, source)) if *source == texture.texture => picture.texture,
            before => {
                let id = before.as_ref().map(|(picture, _)| picture.texture);
                self.painter.register(gpu, &texture.view, id)
            }
        };
        let picture = Picture { texture: id, size: texture.size() };
        *kept = Some((picture, texture.texture.clone()));
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
            screen: Screen { size_px: surface.size(), pixels_per_point: output.pixels_per_point },
        };
        self.draw(window, gpu, surface, output);
        again.unwrap_or(Duration::MAX)
    }

    #[allow(clippy::iter_over_hash_type, reason = "textures do not depend on each other")]
    fn draw(&mut self, window: &Window, gpu: &Gpu, surface: &mut WindowSurface, mut output: Output) {
        for (id, deltas) in &output.textures.set {
            for delta in deltas {
                self.painter.update_texture(gpu, *id, delta);
            }
        }
        if let Acquired::Image(image) = surface.acquire(gpu) {
            let view = image.texture.create_view(&wgpu::TextureViewDescriptor::default());
            let commands = self.painter.paint(gpu, &view, &output.triangles, output.screen);
            gpu.queue.submit([commands]);
            window.pre_present_notify();
            gpu.queue.present(image);
        }
        for id in &output.textures.free {
            self.painter.free_texture(*id);
        }
        // egui insists on hearing that all of them were seen to.
        output.textures.clear();
    }
}
