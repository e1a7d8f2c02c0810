//! The window's part in rendering stills: one at a time, with its progress, and a way out.

use std::path::PathBuf;
use std::time::Instant;

use super::super::action::{Export, Shape, Steering, Still};
use super::super::worker::StillJob;
use super::App;
use crate::scene::{Projection, Quality, UpdateFraction};
use crate::ui::Busy;

impl App {
    /// Renders a still on a thread of its own.
    pub(super) fn render_still(&mut self, export: Export) {
        let Some(live) = &self.live else { return };
        if self.helm.is_some() {
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
        let end = match (job.export.frames, job.export.still) {
            (Some(_), _) => "Ends after the frame that is being made",
            // They are differences of pictures with like samples.
            (None, Still::LayersExr) => "",
            // Parts of unlike samples would show their seams.
            (None, _) if job.export.is_in_parts() => "",
            (None, _) => "Saves it with the samples of each pixel that it has",
        };
        self.session.ui.busy = Some(Busy { text, progress: Some((0.0, None)), steering: Some(Steering::On), end });
        self.helm = Some(self.worker.still(job));
    }

    /// Says what becomes of the still that is being rendered.
    pub(super) fn steer_still(&mut self, steering: Steering) {
        let (Some(helm), Some(busy)) = (&self.helm, &mut self.session.ui.busy) else { return };
        helm.turn(steering);
        busy.steering = Some(helm.steering());
    }

    /// Takes in how far a still is that was begun at a time.
    pub(super) fn hear_of_still(&mut self, share: f32, begun: Instant) {
        // A guess is worth nothing before something was done.
        let passed = begun.elapsed().as_secs_f64();
        let left = (share > 0.02).then(|| passed * f64::from(1.0 / share - 1.0));
        if let Some(busy) = self.session.ui.busy.as_mut().filter(|busy| busy.steering.is_some()) {
            busy.progress = Some((share, left));
        }
        self.tell_title();
    }

    /// Gives the window its title, which says how far a still is, though nothing is drawn.
    pub(super) fn tell_title(&mut self) {
        let title = self.session.title();
        if let Some(live) = self.live.as_mut().filter(|live| live.title != title) {
            live.window.set_title(&title);
            live.title = title;
        }
    }

    /// Takes in what became of a still.
    pub(super) fn finish_still(&mut self, result: Result<Option<PathBuf>, String>) {
        let has_ended = self.helm.take().is_some_and(|helm| helm.steering() == Steering::End);
        self.session.ui.busy = None;
        self.tell_title();
        let toasts = &mut self.session.ui.toasts;
        match result {
            Ok(Some(path)) if has_ended => toasts.info(format!("Saved {} as far as it was", path.display())),
            Ok(Some(path)) => toasts.info(format!("Saved {}", path.display())),
            Ok(None) => toasts.info("Given up; only what was finished is written"),
            Err(error) => toasts.error(error),
        }
    }
}
