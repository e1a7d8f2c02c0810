//! What a crash leaves behind: a report with the message, where it was, and the machine. Nothing is sent anywhere.

use std::fs;
use std::panic::PanicHookInfo;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

/// Reports that are kept; older ones make room.
const MOST_REPORTS: usize = 10;

static FOLDER: OnceLock<PathBuf> = OnceLock::new();
static SYSTEM: Mutex<String> = Mutex::new(String::new());

/// Writes a report into `folder` whenever a thread panics, beside what is printed anyway.
pub(super) fn watch(folder: &Path) {
    if FOLDER.set(folder.to_owned()).is_err() {
        return;
    }
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        before(panic);
        if let Some(path) = FOLDER.get().and_then(|folder| write(folder, &describe(panic))) {
            eprintln!("a report of this crash is in {}", path.display());
        }
    }));
}

/// What a report says of the machine from now on.
pub(super) fn set_system(about: String) {
    *SYSTEM.lock().unwrap_or_else(PoisonError::into_inner) = about;
}

fn describe(panic: &PanicHookInfo<'_>) -> String {
    let system = SYSTEM.lock().unwrap_or_else(PoisonError::into_inner);
    let thread = std::thread::current();
    format!(
        "{panic}\nthread {}\n\n{system}\n{}\n",
        thread.name().unwrap_or("without a name"),
        std::backtrace::Backtrace::force_capture()
    )
}

/// Writes a report and returns where; `None` if that is not possible, as a crash must not lead to another.
fn write(folder: &Path, text: &str) -> Option<PathBuf> {
    let nanos = SystemTime::now().duration_since(UNIX_EPOCH).ok()?.as_nanos();
    fs::create_dir_all(folder).ok()?;
    // Names sort by time.
    let path = folder.join(format!("crash-{nanos:020}.txt"));
    fs::write(&path, text).ok()?;
    let mut reports = reports(folder);
    reports.sort();
    for old in reports.iter().rev().skip(MOST_REPORTS) {
        // It stays, then.
        let _ = fs::remove_file(old);
    }
    Some(path)
}

fn reports(folder: &Path) -> Vec<PathBuf> {
    let files = fs::read_dir(folder).into_iter().flatten().flatten().map(|file| file.path());
    let is_report = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        name.starts_with("crash-") && name.ends_with(".txt")
    };
    files.filter(is_report).collect()
}

/// The newest report that nobody was told of; from now on somebody was.
pub(super) fn unseen(folder: &Path) -> Option<PathBuf> {
    let newest = reports(folder).into_iter().max()?;
    let seen = folder.join("crash-seen");
    let name = newest.file_name()?.to_string_lossy().into_owned();
    if fs::read_to_string(&seen).is_ok_and(|told| told == name) {
        return None;
    }
    // Who cannot write it is told again.
    let _ = fs::write(seen, name);
    Some(newest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_told_of_once_and_old_ones_make_room() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        assert_eq!(unseen(folder.path()), None, "nothing has crashed");
        for index in 0..MOST_REPORTS + 5 {
            let path = write(folder.path(), &format!("report {index}")).expect("written");
            assert!(path.exists(), "the one just written stays");
        }
        assert_eq!(reports(folder.path()).len(), MOST_REPORTS);
        let newest = unseen(folder.path()).expect("one is new");
        assert!(fs::read_to_string(newest).expect("it is there").starts_with("report"), "its text");
        assert_eq!(unseen(folder.path()), None, "it was told of");
    }
}
