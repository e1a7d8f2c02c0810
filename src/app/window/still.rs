//! The window's part in rendering stills: one at a time, with its progress, and a way out.

use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Instant;

use super::super::action::{Export, Shape};
use super::super::worker::StillJob;
use super::App;
use crate::scene::{Projection, Quality, UpdateFraction};
use crate::ui::Busy;

impl App {
    /// Renders a still on a thread of its own.
    pub(super) fn render_still(&mut self, export: Export) {
        let Some(live) = &self.live else { return };
        if self.given_up.is_some() {
            let said = "One still at a time: wait for the one that is being rendered, or cancel it";
            self.session.ui.toasts.error(said);
            return;
        }
        let document = &self.session.document;
        let level = export.level.map_or_else(|| document.quality().clone(), Quality::level);
        // A still has no pictures before it to take pixels from, and the size asked for is that of the file.
        let quality = Quality { update: UpdateFraction::Full, resolution_scale: 1.0, ..level };
        let mut preset = document.preset().clone();
        if export.shape == Shape::Panorama {
            // The file says what it shows.
            preset.scene.camera.projection = Projection::Equirect;
            preset.animation.override_by(["camera.projection"]);
        }
        let text = if export.frames.is_some() { "Rendering a sequence" } else { "Rendering a still" }.to_owned();
        let job = StillJob { gpu: live.gpu.clone(), preset, quality, time_secs: document.time_secs(), export };
        self.session.ui.busy = Some(Busy { text, progress: Some((0.0, None)), can_stop: true });
        self.given_up = Some(self.worker.still(job));
    }

    /// Gives up the still that is being rendered.
    pub(super) fn give_up_still(&mut self) {
        if let Some(given_up) = &self.given_up {
            given_up.store(true, Ordering::Relaxed);
        }
    }

    /// Takes in how far a still is that was begun at a time.
    pub(super) fn hear_of_still(&mut self, share: f32, begun: Instant) {
        // A guess is worth nothing before something was done.
        let passed = begun.elapsed().as_secs_f64();
        let left = (share > 0.02).then(|| passed * f64::from(1.0 / share - 1.0));
        if let Some(busy) = self.session.ui.busy.as_mut().filter(|busy| busy.can_stop) {
            busy.progress = Some((share, left));
        }
    }

    /// Takes in what became of a still.
    pub(super) fn finish_still(&mut self, result: Result<Option<PathBuf>, String>) {
        (self.given_up, self.session.ui.busy) = (None, None);
        let toasts = &mut self.session.ui.toasts;
        match result {
            Ok(Some(path)) => toasts.info(format!("Saved {}", path.display())),
            Ok(None) => toasts.info("Given up; only what was finished is written"),
            Err(error) => toasts.error(error),
        }
    }
}
