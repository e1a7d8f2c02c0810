//! No command: the editor, or without a display a picture.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use super::render::{self, RenderArgs};
use super::{Device, Edits};
use crate::app;
use crate::scene::builtin::BUILTINS;

pub(super) fn run(scene: Option<PathBuf>, edits: Edits, device: &Device) -> Result<()> {
    if has_display() {
        return app::run(app::Options { scene, adapter: device.choice(), sets: edits.sets });
    }
    let stem = scene.as_deref().and_then(Path::file_stem).map(|stem| stem.to_string_lossy().into_owned());
    let output = Path::new("out").join(format!("{}.png", stem.as_deref().unwrap_or("default-sky")));
    eprintln!("There is no display (neither DISPLAY nor WAYLAND_DISPLAY is set), so no editor can open.");
    eprintln!("Rendering the sky to {} instead …", output.display());
    std::fs::create_dir_all("out").context("cannot make the folder out")?;
    let scene = scene.unwrap_or_else(|| BUILTINS[0].name.into());
    render::run(&RenderArgs::still(scene, output, edits, device.clone()))
}

/// Whether a window can be expected to open. Only Unix desktops other than macOS tell by their environment.
fn has_display() -> bool {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(all(unix, not(target_os = "macos"))) || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}
