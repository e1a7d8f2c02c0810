//! Ctrl-C as a wish: what is finished is kept.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);

/// A command was stopped; whatever it had finished was written.
#[derive(Debug, thiserror::Error)]
#[error("stopped before the end; {0}")]
pub(super) struct Interrupted(pub(super) String);

/// From now on the first Ctrl-C is only taken note of; the second one ends the program.
pub(super) fn watch() {
    static WATCHED: OnceLock<()> = OnceLock::new();
    WATCHED.get_or_init(|| {
        let handler = || {
            if ASKED.swap(true, Ordering::Relaxed) {
                std::process::exit(super::error::INTERRUPTED.into());
            }
        };
        // Where there is no such signal, nobody can send it either.
        ctrlc::set_handler(handler).ok();
    });
}

/// Whether the user wants an end.
pub(super) fn is_asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
