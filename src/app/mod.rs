//! The editor's window.

use std::path::PathBuf;

use crate::gpu::AdapterChoice;

/// How the editor starts.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// A preset, an image that carries one, or the name of a built-in sky; the first built-in one if absent.
    pub scene: Option<PathBuf>,
    /// The adapter to draw with.
    pub adapter: AdapterChoice,
    /// `key=value` assignments to apply to the sky.
    pub sets: Vec<String>,
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// If no window or no device can be had.
pub fn run(options: Options) -> anyhow::Result<()> {
    let _ = options;
    Ok(())
}
