//! The editor: a window on a [`Document`], its panels, and the renderer behind the picture.
//!
//! Panels return [`action::Action`]s; [`Session`] carries them out on the document and returns what concerns windows
//! and threads; `window::App` does that, and keeps the picture and the panels going beside each other.

pub mod about;
pub mod action;
mod brush;
pub mod camera_control;
mod crash;
pub mod document;
mod egui_glue;
mod hands;
mod history;
pub mod lab;
mod painter;
pub mod preferences;
mod recovery;
pub mod session;
mod statistics;
mod storage;
mod surface;
mod truth;
mod viewport;
mod whole;
mod window;
mod worker;

pub use action::Action;
pub use document::Document;
pub use session::{Folders, Session};

use std::path::PathBuf;

use crate::files;
use crate::gpu::AdapterChoice;
use crate::scene::Quality;
use crate::scene::builtin::BUILTINS;

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
    let document = open(&options)?;
    let mut session = Session::new(document, Folders::of_user());
    if let Some(file) = options.scene.as_deref().filter(|file| file.is_file()) {
        session.preferences.used(file);
    }
    window::run(session, options.adapter)
}

/// The document that the options ask for.
fn open(options: &Options) -> anyhow::Result<Document> {
    let first = BUILTINS.first().map(|builtin| PathBuf::from(builtin.name));
    let source = options.scene.clone().or(first).unwrap_or_default();
    let mut document = session::document_of(files::open(&source)?, Quality::default());
    let (mut preset, mut quality) = (document.preset().clone(), document.quality().clone());
    preset.set_all(&options.sets, &mut quality)?;
    let step = "--set".to_owned();
    document.apply(&Action::EditAnimation { step: step.clone(), animation: Box::new(preset.animation) });
    document.apply(&Action::EditScene { key: step, scene: Box::new(preset.scene) });
    document.apply(&Action::EditQuality { key: "--set".to_owned(), quality: Box::new(quality) });
    Ok(document)
}
