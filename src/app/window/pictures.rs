//! Small pictures of presets that have none, made while there is nothing else to do.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::App;

/// Hands that have done nothing for so long rest.
const REST: Duration = Duration::from_secs(1);

/// What is being made, and what need not be tried again.
#[derive(Debug, Default)]
pub(super) struct SmallPictures {
    tried: BTreeSet<PathBuf>,
    /// How many the thread has still to tell of.
    left: usize,
    /// Whether the thread waits, as somebody works.
    waits: Arc<AtomicBool>,
}

impl App {
    /// Lets pictures be made while the window and the hands rest; they wait while either works. Says when to come again.
    pub(super) fn make_small_pictures(&mut self, is_idle: bool) -> Option<Instant> {
        let live = self.live.as_ref()?;
        let begins = live.viewport.truths.disturbed() + REST;
        let is_at_rest = is_idle && Instant::now() >= begins;
        self.small.waits.store(!is_at_rest, Ordering::Relaxed);
        if self.small.left > 0 {
            return is_idle.then_some(begins).filter(|_| !is_at_rest);
        }
        let bare = self.session.ui.library.user.iter().filter(|entry| entry.thumbnail.is_none());
        let wanted: Vec<PathBuf> =
            bare.map(|entry| entry.source.clone()).filter(|it| !self.small.tried.contains(it)).collect();
        if wanted.is_empty() || !is_at_rest {
            return Some(begins).filter(|_| is_idle && !wanted.is_empty());
        }
        self.small.tried.extend(wanted.iter().cloned());
        self.small.left = wanted.len();
        if !self.worker.small_pictures(&live.gpu, (wanted, Arc::clone(&self.small.waits))) {
            self.small.left = 0;
        }
        None
    }

    /// Takes in one of them; `None` if it could not be made.
    pub(super) fn take_small_picture(&mut self, preset: &Path, picture: Option<([u32; 2], Vec<u8>)>) {
        self.small.left = self.small.left.saturating_sub(1);
        if let Some((size, rgba8)) = picture {
            self.session.note_picture(preset, (size, &rgba8));
        }
    }
}
