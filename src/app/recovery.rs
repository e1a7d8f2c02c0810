//! Keeps a copy of unsaved work, so that a crash costs at most half a minute.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::document::Document;
use crate::scene::Preset;

/// How often the copy is renewed.
const PERIOD: Duration = Duration::from_secs(30);

/// Windows that may be open at a time, each with a copy of its own.
const MOST_WINDOWS: u32 = 64;

/// The copy of unsaved work.
#[derive(Debug)]
pub(super) struct Recovery {
    path: PathBuf,
    written: Option<Preset>,
    last: Instant,
    /// Held while the window is open, so that other windows leave its copy alone.
    _lock: Option<File>,
}

fn copy_of(folder: &Path, window: u32) -> PathBuf {
    folder.join(if window == 0 { "recovery.ron".to_owned() } else { format!("recovery-{window}.ron") })
}

/// The lock of a window's copy, and whether another window holds it. Where there are no locks nobody holds one.
fn lock_of(folder: &Path, window: u32) -> (Option<File>, bool) {
    let Ok(lock) = File::create(folder.join(format!("recovery-{window}.lock"))) else { return (None, false) };
    let is_held = matches!(lock.try_lock(), Err(TryLockError::WouldBlock));
    (Some(lock), is_held)
}

impl Recovery {
    /// Copies go into `folder`; returns what an earlier run left there, or why it cannot be read. A damaged copy is put aside:
    /// somebody may still find something in it. Copies of windows that are open are not touched.
    pub(super) fn open(folder: &Path) -> (Self, Option<Result<Preset, String>>) {
        // A folder that cannot be made has no copies, and gets none.
        let _ = std::fs::create_dir_all(folder);
        let mut own = None;
        for window in 0..MOST_WINDOWS {
            let path = copy_of(folder, window);
            if own.is_some() && !path.exists() {
                continue;
            }
            let (lock, is_held) = lock_of(folder, window);
            if is_held {
                continue;
            }
            if path.exists() {
                // A copy that nobody holds: that of a window that has crashed.
                let left = Self::read(folder, &path);
                return (Self { path, written: None, last: Instant::now(), _lock: lock }, Some(left));
            }
            own.get_or_insert((path, lock));
        }
        let (path, lock) = own.unwrap_or_else(|| (copy_of(folder, 0), None));
        (Self { path, written: None, last: Instant::now(), _lock: lock }, None)
    }

    fn read(folder: &Path, path: &Path) -> Result<Preset, String> {
        Preset::load(path).map_err(|error| {
            let name = |index: u32| folder.join(format!("recovery-damaged-{index}.ron"));
            let aside = (1..1000).map(name).find(|aside| !aside.exists()).unwrap_or_else(|| name(1000));
            match std::fs::rename(path, &aside) {
                Ok(()) => format!("the copy of unsaved work is damaged and kept as {}: {error}", aside.display()),
                Err(why) => format!(
                    "the copy of unsaved work is damaged and cannot be put aside, copy {} yourself: {error}; {why}",
                    path.display()
                ),
            }
        })
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
        let copy = Preset::load(&state.join("recovery.ron")).expect("a sound copy");
        assert_eq!(copy.name, "Storm");
        assert_eq!(recovery.due_in(&document), None, "the copy is as new as the work");
        document.apply(&Action::Rename("Storms".to_owned()));
        assert!(recovery.due_in(&document).is_some(), "it is no longer");
        document.mark_saved(folder.path().join("storm.ron"));
        recovery.keep(&document);
        drop(recovery);
        assert!(Recovery::open(&state).1.is_none(), "saved work needs no copy");
    }

    #[test]
    fn a_damaged_copy_is_put_aside_and_said() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("recovery.ron"), "(version: 2, scene: (lay").expect("written");
        let (mut recovery, left) = Recovery::open(folder.path());
        let said = left.expect("something was there").expect_err("it is no preset");
        assert!(said.contains("recovery-damaged-1.ron"), "{said}");
        let mut document = Document::new(Preset::default(), Quality::default());
        document.apply(&Action::Rename("Next".to_owned()));
        recovery.keep(&document);
        let aside = std::fs::read_to_string(folder.path().join("recovery-damaged-1.ron")).expect("kept");
        assert!(aside.ends_with("(lay"), "as it was");
        drop(recovery);
        assert_eq!(Recovery::open(folder.path()).1.expect("a copy").expect("a sound one").name, "Next");
    }

    #[test]
    fn windows_leave_each_other_s_copies_alone() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let edited = |name: &str| {
            let mut document = Document::new(Preset::default(), Quality::default());
            document.apply(&Action::Rename(name.to_owned()));
            document
        };
        let (mut one, left) = Recovery::open(folder.path());
        assert!(left.is_none(), "nothing was left");
        one.keep(&edited("one"));
        let (mut two, left) = Recovery::open(folder.path());
        assert!(left.is_none(), "the first window is open");
        two.keep(&edited("two"));
        // The second window crashes: its lock goes, its copy stays.
        drop(two);
        let (three, left) = Recovery::open(folder.path());
        assert_eq!(left.expect("a copy").expect("sound").name, "two");
        drop((one, three));
        let (_, left) = Recovery::open(folder.path());
        assert_eq!(left.expect("a copy").expect("sound").name, "one");
    }
}
