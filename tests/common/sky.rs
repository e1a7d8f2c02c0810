//! Whole frames through the renderer.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use nephoscope::render::tables::{Table, TableKind};
use nephoscope::render::{FrameReport, LinearImage, Renderer};
use nephoscope::scene::{Frame, Output, Quality, Scene, UpdateFraction};

use super::gpu;

/// The renderer that tests share, so that each shader is compiled once. It remembers no picture.
pub(crate) fn renderer() -> MutexGuard<'static, Renderer> {
    static RENDERER: OnceLock<Mutex<Renderer>> = OnceLock::new();
    let renderer = RENDERER.get_or_init(|| Mutex::new(Renderer::new(gpu()).expect("the sky tables fit")));
    let mut renderer = renderer.lock().unwrap_or_else(PoisonError::into_inner);
    renderer.forget_history();
    renderer
}

/// Work small enough for the software driver; every pixel in every frame.
pub(crate) fn quick() -> Quality {
    Quality {
        view_steps: 64,
        step_m: 90.0,
        light_steps: 3,
        light_grid: 0,
        octaves: 1,
        update: UpdateFraction::Full,
        shadow_map_px: 32,
        shaft_samples: 8,
        ..Quality::default()
    }
}

/// A frame at time 0.
pub(crate) fn frame<'a>(scene: &'a Scene, quality: &'a Quality, size: [u32; 2], output: Output) -> Frame<'a> {
    Frame { scene, quality, size, time_secs: 0.0, output, window: None }
}

/// A table of a sky, made without what is only made from it.
pub(crate) fn table(renderer: &mut Renderer, scene: &Scene, time_secs: f64, kind: TableKind) -> Table {
    let quality = Quality { light_grid: 0, skip_clear: false, ..Quality::default() };
    let frame = Frame { scene, quality: &quality, size: [32, 18], time_secs, output: Output::Display, window: None };
    let made = renderer.table(&frame, kind).unwrap_or_else(|error| panic!("{error}"));
    made.unwrap_or_else(|| panic!("the sky has no {kind:?}"))
}

/// Renders a frame; a failure names itself.
pub(crate) fn render(renderer: &mut Renderer, frame: &Frame<'_>) -> FrameReport {
    renderer.render(frame).unwrap_or_else(|error| panic!("{error}"))
}

/// The linear light of a still.
pub(crate) fn linear(scene: &Scene, quality: &Quality, size: [u32; 2]) -> LinearImage {
    let mut renderer = renderer();
    render(&mut renderer, &frame(scene, quality, size, Output::Linear));
    renderer.linear().expect("it can be read")
}
