//! The editor: a window on a [`Document`], its panels, and the renderer behind the picture.
//!
//! Panels return [`action::Action`]s; [`Session`] carries them out on the document and returns what concerns windows
//! and threads; [`window::App`] does that, and keeps the picture and the panels going beside each other.

pub mod action;
pub mod camera_control;
pub mod document;
mod egui_glue;
mod hands;
mod painter;
mod recovery;
pub mod session;
mod statistics;
pub mod storage;
mod surface;
mod viewport;
mod window;
mod worker;

pub use action::Action;
pub use document::Document;
pub use session::{Folders, Session};

use std::path::PathBuf;

use anyhow::Context as _;

use crate::gpu::AdapterChoice;
use crate::scene::builtin::BUILTINS;
use crate::scene::edit;
use crate::scene::{Preset, Quality};

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

/// There is no display to open a window on.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no display: {0}. Start the editor from a desktop session, \
     or render without a window: nephoscope render SCENE -o out.png"
)]
pub struct NoDisplay(pub String);

/// Opens the window and returns when it is closed.
///
/// # Errors
/// [`NoDisplay`] if no window can be had; else what the scene, the display or the device says.
pub fn run(options: Options) -> anyhow::Result<()> {
    let has = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if cfg!(all(unix, not(target_os = "macos"))) && !has("DISPLAY") && !has("WAYLAND_DISPLAY") {
        return Err(NoDisplay("neither DISPLAY nor WAYLAND_DISPLAY is set".to_owned()).into());
    }
    let folders = Folders::of_user();
    let document = open(&options, &folders)?;
    window::run(Session::new(document, folders), options.adapter)
}

/// The document that the options ask for.
fn open(options: &Options, folders: &Folders) -> anyhow::Result<Document> {
    let mut document = match &options.scene {
        None => {
            let preset = BUILTINS.first().map(|builtin| builtin.preset()).transpose()?;
            Document::new(preset.unwrap_or_default(), Quality::default())
        }
        Some(path) if path.exists() || path.extension().is_some() => {
            let loaded = storage::load(path, &folders.maps)?;
            let quality = loaded.quality.unwrap_or_default();
            if loaded.is_preset_file {
                Document::from_file(loaded.preset, quality, path.clone())
            } else {
                Document::new(Preset { quality: None, ..loaded.preset }, quality)
            }
        }
        Some(name) => Document::new(storage::builtin(&name.to_string_lossy())?, Quality::default()),
    };
    let mut scene = document.preset().scene.clone();
    for assignment in &options.sets {
        let (key, value) = edit::split(assignment)?;
        edit::set(&mut scene, key, value).with_context(|| format!("--set {assignment}"))?;
        document.apply(&Action::EditScene { key: key.to_owned(), scene: Box::new(scene.clone()) });
    }
    Ok(document)
}
