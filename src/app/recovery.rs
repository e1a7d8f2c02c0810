//! Keeps a copy of unsaved work, so that a crash costs at most half a minute.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::document::Document;
use crate::scene::Preset;

/// How often the copy is renewed.
const PERIOD: Duration = Duration::from_secs(30);

/// The copy of unsaved work.
#[derive(Debug)]
pub(super) struct Recovery {
    path: PathBuf,
    written: Option<Preset>,
    last: Instant,
}

impl Recovery {
    /// Copies go into `folder`; returns what an earlier run left there.
    pub(super) fn open(folder: &Path) -> (Self, Option<Preset>) {
        let path = folder.join("recovery.ron");
        let left = Preset::load(&path).ok();
        (Self { path, written: None, last: Instant::now() }, left)
    }

    /// Renews the copy if it is time and there is unsaved work; takes it away if there is none.
    pub(super) fn tend(&mut self, document: &Document) {
        if self.last.elapsed() >= PERIOD {
            self.keep(document);
        }
    }

    /// Renews the copy now. Failures are silent: this is a second net, and the first says why it tore.
    pub(super) fn keep(&mut self, document: &Document) {
        self.last = Instant::now();
        if !document.is_modified() {
            if self.written.take().is_some() {
                self.clear();
            }
        } else if self.written.as_ref() != Some(document.preset()) {
            let folder_made = self.path.parent().is_some_and(|folder| std::fs::create_dir_all(folder).is_ok());
            if folder_made && document.preset().save(&self.path).is_ok() {
                self.written = Some(document.preset().clone());
            }
        }
    }

    /// Takes the copy away: the work was saved or given up.
    pub(super) fn clear(&self) {
        // It may never have been written.
        let _ = std::fs::remove_file(&self.path);
    }

    /// Time until the next look, for the event loop; `None` if it would change nothing, so that an idle window sleeps.
    pub(super) fn due_in(&self, document: &Document) -> Option<Duration> {
        let wanted = document.is_modified().then_some(document.preset());
        (wanted != self.written.as_ref()).then(|| PERIOD.saturating_sub(self.last.elapsed()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Action;
    use crate::scene::Quality;

    #[test]
    fn unsaved_work_survives_and_saved_work_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let state = folder.path().join("state");
        let (mut recovery, left) = Recovery::open(&state);
        assert!(left.is_none(), "nothing yet");
        let mut document = Document::new(Preset::default(), Quality::default());
        document.apply(&Action::Rename("Storm".to_owned()));
        recovery.keep(&document);
        let (_, left) = Recovery::open(&state);
        assert_eq!(left.expect("a copy").name, "Storm");
        assert_eq!(recovery.due_in(&document), None, "the copy is as new as the work");
        document.apply(&Action::Rename("Storms".to_owned()));
        assert!(recovery.due_in(&document).is_some(), "it is no longer");
        document.mark_saved(folder.path().join("storm.ron"));
        recovery.keep(&document);
        assert!(Recovery::open(&state).1.is_none(), "saved work needs no copy");
    }
}
