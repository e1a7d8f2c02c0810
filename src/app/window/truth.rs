//! The window's part in refining and comparing: turns of work, pictures for the panels, and what is said of them.

use std::time::{Duration, Instant};

use winit::event::WindowEvent;

use super::super::egui_glue::Place;
use super::super::truth::{Compared, Outcome, Wishes};
use super::{App, Live};
use crate::app::Session;
use crate::app::action::Request;
use crate::plan::Integrator;
use crate::render::RenderError;
use crate::ui::TruthView;

/// Time between two frames of the panels that only say how far the truth is.
pub(super) const STATUS: Duration = Duration::from_millis(250);

/// Whether somebody did something, rather than the system.
pub(super) fn is_input(event: &WindowEvent) -> bool {
    matches!(
        event,
        WindowEvent::KeyboardInput { .. }
            | WindowEvent::CursorMoved { .. }
            | WindowEvent::MouseInput { .. }
            | WindowEvent::MouseWheel { .. }
            | WindowEvent::Touch(_)
            | WindowEvent::PinchGesture { .. }
            | WindowEvent::PanGesture { .. }
            | WindowEvent::Ime(_)
    )
}

fn wishes(session: &Session, moves: bool) -> Wishes {
    let truth = &session.ui.truth;
    Wishes {
        refines: truth.refines,
        compare: truth.compares().then_some(truth.reference),
        is_kept: truth.is_kept,
        moves,
    }
}

impl App {
    /// Lets the truths take a turn if the window's own picture is finished; never for longer than about a slice.
    pub(super) fn refine(&mut self, is_idle: bool) -> Outcome {
        let Some(live) = &mut self.live else { return Outcome::default() };
        if live.viewport.has_moved_on() {
            self.session.ui.truth.is_kept = false;
            self.session.ui.inspector.picked = None;
        }
        // What is being measured is not disturbed.
        if !is_idle || self.session.ui.lab.is_running() {
            return Outcome::default();
        }
        let moves = self.session.document.is_playing() || live.hands.are_busy();
        let wishes = wishes(&self.session, moves);
        let mut outcome = live.viewport.refine(wishes);
        if outcome.is_ok() && wishes.compare.is_some() {
            outcome = live.viewport.comparison().map(|job| {
                job.into_iter().for_each(|job| self.worker.compare(job));
                outcome.unwrap_or_default()
            });
        }
        match outcome {
            Ok(outcome) => {
                if outcome.has_picture {
                    live.is_new = true;
                    live.draw_within(Duration::ZERO);
                } else if live.status_of(wishes) != self.session.ui.truth.view.refinement {
                    live.draw_within(STATUS);
                }
                outcome
            }
            Err(error) => {
                self.session.ui.toasts.error(error);
                live.draw_within(Duration::ZERO);
                Outcome { wake: Some(Instant::now()), ..Outcome::default() }
            }
        }
    }

    /// Takes in what comparing found, and compares what has become finished meanwhile.
    pub(super) fn take_comparison(&mut self, compared: Compared) {
        let Some(live) = &mut self.live else { return };
        live.viewport.truths.take(live.egui.context(), compared);
        if !self.session.ui.truth.compares() {
            return;
        }
        match live.viewport.comparison() {
            Ok(job) => job.into_iter().for_each(|job| self.worker.compare(job)),
            Err(error) => self.session.ui.toasts.error(error),
        }
    }
}

impl Live {
    /// Keeps the picture as it was before only a region of it is drawn, to lie behind that.
    pub(super) fn keep_backdrop(&mut self, session: &mut Session) {
        let is_kept = session.ui.viewport.backdrop.is_some();
        if session.ui.viewport.region.is_none() {
            session.ui.viewport.backdrop = None;
        } else if !is_kept
            && let Ok((size, pixels)) = self.shown_rgba8(session)
            && !pixels.is_empty()
        {
            let image = egui::ColorImage::from_rgba_unmultiplied(size.map(|side| side as usize), &pixels);
            let texture = self.egui.context().load_texture("backdrop", image, egui::TextureOptions::LINEAR);
            session.ui.viewport.backdrop = Some((texture, size).into());
        }
    }
}

impl App {
    /// Remembers what wants a picture: the one that is shown may still be that of another sky.
    pub(super) fn wait_for_picture(&mut self, request: Request) {
        if self.live.as_ref().is_none_or(|live| live.viewport.renderer().display().is_none()) {
            if request == Request::Snapshot {
                self.session.ui.toasts.error("There is no picture to keep yet; wait for the first one");
            }
            return;
        }
        if self.session.ui.viewport.region.is_some() {
            if request == Request::Snapshot {
                self.session.ui.toasts.error("Only a region is drawn; Ctrl+B draws all of it, then take the snapshot");
            }
            // A part is no picture of a preset.
            return;
        }
        if request == Request::Snapshot && self.is_working {
            self.session.ui.toasts.info("The snapshot is taken when the picture is finished");
        }
        self.waiting.push(request);
    }

    /// Gives the finished picture to those that wait for it.
    pub(super) fn take_pictures(&mut self) {
        for request in std::mem::take(&mut self.waiting) {
            match request {
                // One with stripes is none of the sky's; what has none is drawn while the window rests.
                Request::KeepPicture(_) if self.session.ui.histogram.stripes => {}
                Request::KeepPicture(preset) => self.keep_picture(&preset),
                _ => self.take_snapshot(),
            }
        }
    }

    /// Keeps the sky with the picture as the window shows it.
    fn take_snapshot(&mut self) {
        let Some(live) = &mut self.live else { return };
        match live.shown_rgba8(&self.session) {
            Ok((_, pixels)) if pixels.is_empty() => {
                self.session.ui.toasts.error("There is no picture to keep yet; wait for the first one");
            }
            Ok(picture) => {
                let Session { ui, document, .. } = &mut self.session;
                ui.snapshots.add(live.egui.context(), document, picture);
                live.draw_within(Duration::ZERO);
            }
            Err(error) => self.session.ui.toasts.error(error),
        }
    }
}

impl App {
    /// Looks at the point that was clicked, once the picture is finished and the shaders are there.
    pub(super) fn inspect(&mut self) {
        let Some(live) = &mut self.live else { return };
        let Some(at) = self.session.ui.inspector.wish else { return };
        match live.viewport.pick(at) {
            Ok(None) => {}
            Ok(Some(mut picked)) => {
                picked.display =
                    live.shown_rgba8(&self.session).ok().and_then(|(size, pixels)| pixel(size, &pixels, at));
                self.session.ui.inspector.picked = Some(picked);
                self.session.ui.inspector.wish = None;
            }
            Err(error) => {
                self.session.ui.inspector.wish = None;
                self.session.ui.toasts.error(error);
            }
        }
        live.draw_within(STATUS);
    }

    /// Puts the picture into the clipboard as the window shows it.
    pub(super) fn copy_picture(&mut self) {
        let Some(live) = &self.live else { return };
        match live.shown_rgba8(&self.session) {
            Ok((_, pixels)) if pixels.is_empty() => {
                self.session.ui.toasts.error("There is no picture to copy yet; wait for the first one");
            }
            Ok((size, pixels)) => {
                let size = size.map(|side| side as usize);
                live.egui.context().copy_image(egui::ColorImage::from_rgba_unmultiplied(size, &pixels));
                self.session.ui.toasts.info("The picture is in the clipboard");
            }
            Err(error) => self.session.ui.toasts.error(error),
        }
    }

    /// Keeps what the window shows as the small picture of a preset.
    fn keep_picture(&mut self, preset: &std::path::Path) {
        if let Some(live) = &self.live
            && let Ok((size, pixels)) = live.shown_rgba8(&self.session)
        {
            self.session.keep_picture(preset, (size, &pixels));
        }
    }
}

impl Live {
    /// Compares a new picture with the chosen snapshot, if that is to be seen.
    pub(super) fn show_difference(&mut self, session: &mut Session) {
        let snapshots = &session.ui.snapshots;
        let is_wanted = snapshots.wants_difference() && (self.is_new || !snapshots.has_difference());
        if is_wanted && let Ok((size, pixels)) = self.shown_rgba8(session) {
            session.ui.snapshots.show_difference(self.egui.context(), (size, &pixels));
            self.is_new = false;
        }
    }

    /// Tells the panels of all pictures beside the window's own.
    pub(super) fn show_pictures(&mut self, session: &mut Session) {
        self.show_truth(session);
        self.show_difference(session);
        self.show_map(session);
    }

    fn show_map(&mut self, session: &mut Session) {
        let ui = &mut session.ui;
        if !ui.map.is_open {
            ui.map.picture = self.egui.set_picture(&self.gpu, Place::Map, None);
            self.viewport.close_map();
            return;
        }
        match self.viewport.map_view() {
            Ok(picture) => ui.map.picture = self.egui.set_picture(&self.gpu, Place::Map, picture),
            Err(error) => {
                ui.map.is_open = false;
                ui.toasts.error(error);
            }
        }
    }

    fn status_of(&self, wishes: Wishes) -> crate::ui::Refinement {
        self.viewport.truths.refinement(wishes)
    }

    /// Tells the panels what pictures there are and what is known of them.
    pub(super) fn show_truth(&mut self, session: &mut Session) {
        let wishes = wishes(session, false);
        let reference = session.ui.truth.reference;
        let truths = &self.viewport.truths;
        let mut set = |place, texture| self.egui.set_picture(&self.gpu, place, texture);
        let at_rest = set(Place::AtRest, truths.at_rest());
        let converged = set(Place::Converged, truths.display(Integrator::Converged));
        let traced = set(Place::Traced, truths.display(Integrator::PathTraced));
        let still = set(Place::Still, truths.still());
        let (difference, limit) = truths.difference(reference).unzip();
        session.ui.truth.view = TruthView {
            refinement: truths.refinement(wishes),
            refined: at_rest,
            still,
            truth: if reference == Integrator::PathTraced { traced } else { converged },
            difference,
            limit: limit.unwrap_or(1.0),
            figures: truths.figures(reference),
            faults: truths.faults(),
        };
    }

    /// The picture as the window shows it, for a file: the one at rest, else the last frame.
    pub(super) fn shown_rgba8(&self, session: &Session) -> Result<([u32; 2], Vec<u8>), RenderError> {
        let at_rest = self.viewport.truths.at_rest();
        match at_rest.filter(|_| !session.ui.truth.compares()) {
            Some(texture) => self.viewport.renderer().rgba8_of(texture),
            None => self.viewport.renderer().display_rgba8(),
        }
    }
}

/// The colour at a point of a picture, 0 to 1 from the top left.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
fn pixel(size: [u32; 2], rgba8: &[u8], at: [f32; 2]) -> Option<[u8; 3]> {
    let [x, y] = [0, 1].map(|axis| ((at[axis] * size[axis] as f32) as u32).min(size[axis].saturating_sub(1)) as usize);
    let index = 4 * (y * size[0] as usize + x);
    let colour = rgba8.get(index..index + 3)?;
    Some([colour[0], colour[1], colour[2]])
}
