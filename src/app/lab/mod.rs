//! Measurements beside the window.

use std::path::{Path, PathBuf};

use crate::export::ExportError;
use crate::export::png::{PngPixels, write_png};
use crate::lab::costa;

/// Writes the two weather textures that Costa's sweeps read into a folder.
///
/// # Errors
/// If they cannot be written.
pub fn write_textures(folder: &Path) -> Result<[PathBuf; 2], ExportError> {
    let paths = costa::textures(folder);
    for (path, pixels) in paths.iter().zip(costa::texture_pixels()) {
        write_png(path, [costa::TEXTURE_SIDE; 2], PngPixels::Rgb8(&pixels), &[])?;
    }
    Ok(paths)
}
