//! Measurements beside the window.

mod governor;
mod run;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use winit::event_loop::EventLoopProxy;

use super::action::{self, Order};
use super::worker::Event;
use crate::export::ExportError;
use crate::export::png::{PngPixels, write_png};
use crate::gpu::Gpu;
use crate::lab::costa;
use crate::scene::Preset;
use crate::scene::param::Choice as _;
use crate::ui::{LabView, Phase};
pub(super) use governor::Governor;
use run::{Control, Job, Wish};

/// Writes the two weather textures that Costa's sweeps read into a folder.
///
/// # Errors
/// If they cannot be written.
pub fn write_textures(folder: &Path) -> Result<[PathBuf; 2], ExportError> {
    let paths = costa::textures(folder);
    for (path, pixels) in paths.iter().zip(costa::texture_pixels()) {
        write_png(path, [costa::TEXTURE_SIDE; 2], PngPixels::Rgb8(&pixels), &[])?;
    }
    Ok(paths)
}

/// What is being measured beside the window, if anything is.
#[derive(Debug, Default)]
pub(super) struct Lab {
    control: Option<Arc<Control>>,
    /// Counts what was begun, so that late news can be told.
    generation: u64,
}

/// News of a measurement.
#[derive(Debug)]
pub(super) struct News {
    generation: u64,
    view: LabView,
}

impl Lab {
    /// Does what the panel wants, of the document's sky on this device. Returns what to show at once.
    pub(super) fn fulfil(
        &mut self,
        wish: action::Lab,
        (gpu, preset): (&Gpu, &Preset),
        proxy: &EventLoopProxy<Event>,
    ) -> Option<LabView> {
        let set = |control: &Option<Arc<Control>>, wish| control.iter().for_each(|control| control.set(wish));
        match wish {
            action::Lab::Pause => set(&self.control, Wish::Pause),
            action::Lab::Resume => set(&self.control, Wish::Run),
            action::Lab::Stop => set(&self.control, Wish::Stop),
            action::Lab::Start(order) => {
                self.leave();
                return Some(self.start(*order, (gpu, preset), proxy));
            }
        }
        None
    }

    /// Leaves what is being measured.
    pub(super) fn leave(&mut self) {
        if let Some(control) = self.control.take() {
            control.set(Wish::Stop);
        }
    }

    fn start(&mut self, order: Order, (gpu, preset): (&Gpu, &Preset), proxy: &EventLoopProxy<Event>) -> LabView {
        let name = match &order {
            Order::Sweep { .. } => preset.name.clone(),
            Order::Suite(kind, ..) => kind.title().to_owned(),
        };
        let job = Job { gpu: gpu.clone(), name: name.clone(), scene: preset.scene.clone(), order };
        self.generation += 1;
        let (control, generation, proxy) = (Control::new(), self.generation, proxy.clone());
        self.control = Some(Arc::clone(&control));
        let work = move || {
            run::run(job, &control, &|view| {
                // The loop is gone only when the window is closed; then nobody waits for news.
                let _ = proxy.send_event(Event::Lab(Box::new(News { generation, view })));
            });
        };
        match std::thread::Builder::new().name("lab".to_owned()).spawn(work) {
            Ok(_) => LabView { name, phase: Phase::Running, what: "preparing".to_owned(), ..LabView::default() },
            Err(error) => LabView { name, phase: Phase::Failed(format!("no thread: {error}")), ..LabView::default() },
        }
    }

    /// What the panel is to show, unless it is of something that was left for something else.
    pub(super) fn take(&self, news: News) -> Option<LabView> {
        (news.generation == self.generation).then_some(news.view)
    }
}
