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
    /// What the newest file held when the program started: written again it would push an older one out.
    found: Option<Preset>,
    last: Instant,
    /// Held while the window is open, so that other windows leave its copy alone.
    _lock: Option<File>,
}

/// How many copies a window keeps: should the newest be what makes the program crash, an older one is there.
const KEPT: usize = 5;

fn copy_of(folder: &Path, window: u32) -> PathBuf {
    folder.join(if window == 0 { "recovery.ron".to_owned() } else { format!("recovery-{window}.ron") })
}

/// A window's copies from the newest, whether they are there or not: `recovery.ron`, `recovery.1.ron` and so on.
fn copies(newest: &Path) -> [PathBuf; KEPT] {
    std::array::from_fn(|age| if age == 0 { newest.to_owned() } else { newest.with_extension(format!("{age}.ron")) })
}

/// What an earlier run left.
#[derive(Debug, Default)]
pub(super) struct Left {
    /// What was kept and how long ago, newest first.
    pub(super) copies: Vec<(Preset, Duration)>,
    /// What is wrong with copies that cannot be read, and where they are now.
    pub(super) damage: Vec<String>,
}

/// The lock of a window's copy, and whether another window holds it. Where there are no locks nobody holds one.
fn lock_of(folder: &Path, window: u32) -> (Option<File>, bool) {
    let Ok(lock) = File::create(folder.join(format!("recovery-{window}.lock"))) else { return (None, false) };
    let is_held = matches!(lock.try_lock(), Err(TryLockError::WouldBlock));
    (Some(lock), is_held)
}

impl Recovery {
    /// Copies go into `folder`; returns what an earlier run left there. A damaged copy is put aside: somebody may still find
    /// something in it. Copies of windows that are open are not touched.
    pub(super) fn open(folder: &Path) -> (Self, Left) {
        // A folder that cannot be made has no copies, and gets none.
        let _ = std::fs::create_dir_all(folder);
        let mut own = None;
        for window in 0..MOST_WINDOWS {
            let path = copy_of(folder, window);
            let is_left = copies(&path).iter().any(|copy| copy.exists());
            if own.is_some() && !is_left {
                continue;
            }
            let (lock, is_held) = lock_of(folder, window);
            if is_held {
                continue;
            }
            if is_left {
                // Copies that nobody holds: those of a window that has crashed.
                let left = Self::read_all(folder, &path);
                let found = left.copies.first().map(|(preset, _)| preset.clone()).filter(|_| path.exists());
                return (Self { path, written: None, found, last: Instant::now(), _lock: lock }, left);
            }
            own.get_or_insert((path, lock));
        }
        let (path, lock) = own.unwrap_or_else(|| (copy_of(folder, 0), None));
        (Self { path, written: None, found: None, last: Instant::now(), _lock: lock }, Left::default())
    }

    fn read_all(folder: &Path, newest: &Path) -> Left {
        let mut left = Left::default();
        for copy in copies(newest).iter().filter(|copy| copy.exists()) {
            let written = copy.metadata().and_then(|metadata| metadata.modified()).ok();
            match Self::read(folder, copy) {
                // A clock that was set back makes a copy new.
                Ok(preset) => {
                    left.copies.push((preset, written.and_then(|at| at.elapsed().ok()).unwrap_or_default()));
                }
                Err(damage) => left.damage.push(damage),
            }
        }
        left
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
        } else if self.found.take_if(|found| found == document.preset()).is_some() {
            self.written = Some(document.preset().clone());
        } else if self.written.as_ref() != Some(document.preset()) {
            // Each grows older by one up to the first gap, or over the oldest. What cannot be moved is not worth a word here.
            let aged = copies(&self.path);
            let gap = aged.iter().position(|copy| !copy.exists()).unwrap_or(KEPT - 1);
            for (younger, older) in aged[..gap].iter().zip(&aged[1..=gap]).rev() {
                let _ = std::fs::rename(younger, older);
            }
            let folder_made = self.path.parent().is_some_and(|folder| std::fs::create_dir_all(folder).is_ok());
            if folder_made && document.preset().save(&self.path).is_ok() {
                self.written = Some(document.preset().clone());
            }
        }
    }

    /// Takes the copies away: the work was saved or given up.
    pub(super) fn clear(&self) {
        for copy in copies(&self.path) {
            // It may never have been written.
            let _ = std::fs::remove_file(copy);
        }
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
        assert!(left.copies.is_empty(), "nothing yet");
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
        assert!(Recovery::open(&state).1.copies.is_empty(), "saved work needs no copy");
    }

    fn names(left: &Left) -> Vec<&str> {
        left.copies.iter().map(|(preset, _)| preset.name.as_str()).collect()
    }

    #[test]
    fn the_last_five_states_are_there_and_a_damaged_one_does_not_hide_the_others() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (mut recovery, _) = Recovery::open(folder.path());
        let mut document = Document::new(Preset::default(), Quality::default());
        for name in ["1", "2", "3", "4", "5", "6", "7"] {
            document.apply(&Action::Rename(name.to_owned()));
            recovery.keep(&document);
            recovery.keep(&document);
        }
        drop(recovery);
        std::fs::write(folder.path().join("recovery.ron"), "(").expect("written");
        let (mut recovery, left) = Recovery::open(folder.path());
        assert_eq!(names(&left), ["6", "5", "4", "3"], "newest first");
        assert_eq!(left.damage.len(), 1, "{:?}", left.damage);
        // Taking one of them up pushes none out that was offered.
        recovery.keep(&document);
        drop(recovery);
        let (recovery, left) = Recovery::open(folder.path());
        assert_eq!(names(&left), ["7", "6", "5", "4", "3"]);
        // A state that ends the program again and again does not push the others out.
        drop(recovery);
        for _ in 0..3 {
            let (mut recovery, left) = Recovery::open(folder.path());
            assert_eq!(names(&left), ["7", "6", "5", "4", "3"]);
            recovery.keep(&document);
            drop(recovery);
        }
        let (recovery, _) = Recovery::open(folder.path());
        recovery.clear();
        assert!(Recovery::open(folder.path()).1.copies.is_empty(), "all are gone");
    }

    #[test]
    fn a_damaged_copy_is_put_aside_and_said() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("recovery.ron"), "(version: 2, scene: (lay").expect("written");
        let (mut recovery, left) = Recovery::open(folder.path());
        let said = left.damage.concat();
        assert!(said.contains("recovery-damaged-1.ron"), "{said}");
        let mut document = Document::new(Preset::default(), Quality::default());
        document.apply(&Action::Rename("Next".to_owned()));
        recovery.keep(&document);
        let aside = std::fs::read_to_string(folder.path().join("recovery-damaged-1.ron")).expect("kept");
        assert!(aside.ends_with("(lay"), "as it was");
        drop(recovery);
        assert_eq!(names(&Recovery::open(folder.path()).1), ["Next"]);
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
        assert!(left.copies.is_empty(), "nothing was left");
        one.keep(&edited("one"));
        let (mut two, left) = Recovery::open(folder.path());
        assert!(left.copies.is_empty(), "the first window is open");
        two.keep(&edited("two"));
        // The second window crashes: its lock goes, its copy stays.
        drop(two);
        let (three, left) = Recovery::open(folder.path());
        assert_eq!(names(&left), ["two"]);
        drop((one, three));
        let (_, left) = Recovery::open(folder.path());
        assert_eq!(names(&left), ["one"]);
    }
}
