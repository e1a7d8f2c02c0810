//! The window's surface: an 8-bit format in gamma space, as egui wants it.

use std::sync::Arc;

use anyhow::Context as _;
use winit::window::Window;

use crate::gpu::{AdapterChoice, Gpu};

/// A surface with its device.
#[derive(Debug)]
pub(super) struct WindowSurface {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    window: Arc<Window>,
}

/// What came of asking for the next image.
pub(super) enum Acquired {
    /// Draw on it.
    Image(wgpu::SurfaceTexture),
    /// There is none now; try at the next frame.
    Skip,
}

impl WindowSurface {
    /// A surface on the window, and a device that presents to it.
    pub(super) fn open(window: &Arc<Window>, choice: &AdapterChoice) -> anyhow::Result<(Self, Gpu)> {
        let instance = Gpu::new_instance();
        let surface = instance.create_surface(Arc::clone(window)).context("the window cannot be drawn on")?;
        let gpu = Gpu::for_surface(instance, choice, &surface)?;
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let wanted = [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Bgra8Unorm];
        let format = wanted.into_iter().find(|format| capabilities.formats.contains(format));
        let format = format.context("the window offers no 8-bit format that is not sRGB")?;
        let size = window.inner_size();
        let mut config = surface
            .get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1))
            .context("the adapter cannot draw on this window")?;
        config.format = format;
        config.view_formats.clear();
        config.present_mode = wgpu::PresentMode::AutoVsync;
        config.desired_maximum_frame_latency = 1;
        surface.configure(&gpu.device, &config);
        Ok((Self { surface, config, window: Arc::clone(window) }, gpu))
    }

    /// The format of the images.
    pub(super) fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Size of the images in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Follows the window's size; what is too small or too large to configure keeps the old size.
    pub(super) fn follow_window(&mut self, gpu: &Gpu) {
        let size = self.window.inner_size();
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if size.width == 0 || size.height == 0 {
            return;
        }
        let size = [size.width.min(limit), size.height.min(limit)];
        if size != self.size() {
            [self.config.width, self.config.height] = size;
            self.surface.configure(&gpu.device, &self.config);
        }
    }

    /// The next image to draw on.
    pub(super) fn acquire(&mut self, gpu: &Gpu) -> Acquired {
        use wgpu::CurrentSurfaceTexture as Current;
        for _ in 0..2 {
            match self.surface.get_current_texture() {
                Current::Success(image) | Current::Suboptimal(image) => return Acquired::Image(image),
                Current::Timeout | Current::Occluded | Current::Validation => return Acquired::Skip,
                Current::Outdated => self.surface.configure(&gpu.device, &self.config),
                Current::Lost => match gpu.instance.create_surface(Arc::clone(&self.window)) {
                    Ok(surface) => {
                        self.surface = surface;
                        self.surface.configure(&gpu.device, &self.config);
                    }
                    Err(_) => return Acquired::Skip,
                },
            }
        }
        Acquired::Skip
    }
}
