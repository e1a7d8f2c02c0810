//! Skies on the disk: presets, quality settings, and pictures that carry the sky they show.
//!
//! [`crate::scene`] knows text and [`crate::export`] knows pixels; here both meet the file system. The names of map
//! images are relative to their preset in files, and absolute in memory.

mod grid;
mod motion;
mod open;
mod picture;
mod programs;
mod still;

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

pub use grid::{VoxelFormat, save_grid, save_vdb};
pub use open::{Origin, Sky, open};
pub use picture::{About, save_exr, save_png, save_table};
pub use programs::KeptPrograms;
pub use still::{Alpha, Content, CubeLayout, StillError, StillFile, files_of_still, named, soften};

use crate::export::ExportError;
use crate::export::atomic::write_atomically;
use crate::images::ImageError;
use crate::images::voxels::VoxelError;
use crate::scene::edit::files_of;
use crate::scene::{Preset, PresetError, Quality, quality_from_ron, quality_to_ron};

/// A preset is text of a few kilobytes; a larger file is something else.
const MAX_PRESET_BYTES: u64 = 4 << 20;

/// Why a sky could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file was read, but what it says is refused.
    #[error(transparent)]
    Preset(#[from] PresetError),
    /// The file system or a picture's encoding failed.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A description of a voxel grid was read, but what it says is refused.
    #[error("{path}: {reason}")]
    Grid {
        /// The description.
        path: PathBuf,
        /// What is wrong and what to do.
        reason: String,
    },
    /// The voxels that a description names cannot be read.
    #[error(transparent)]
    Voxels(#[from] VoxelError),
    /// The file is too large to be a preset.
    #[error("{path} has more than 4 MiB, which no preset has; check the path")]
    TooLarge {
        /// The file.
        path: PathBuf,
    },
    /// The file is not text.
    #[error("{path} is not a text file (UTF-8); open a .ron preset, or an .exr or .png that was exported")]
    NotText {
        /// The file.
        path: PathBuf,
    },
    /// Neither a file nor a built-in sky.
    #[error("there is no file and no built-in sky named {name}{hint}; `nephoscope presets list` shows them")]
    UnknownSky {
        /// The name given.
        name: String,
        /// Names close to it, as a phrase; may be empty.
        hint: String,
    },
    /// A weather map or voxel grid of a picture's sky is neither inside nor beside it.
    #[error(
        "{path} names the file {name}, which is neither inside it nor beside it with the right contents; \
         put {name} (SHA-256 {sha256}) into the same folder"
    )]
    MapMissing {
        /// The picture.
        path: PathBuf,
        /// The map.
        name: String,
        /// Sum of its contents; empty if the picture does not say.
        sha256: String,
    },
}

fn read_text(path: &Path) -> Result<String, FileError> {
    let reading = |error| FileError::Export(ImageError::reading(path, error).into());
    let mut bytes = Vec::new();
    File::open(path).map_err(reading)?.take(MAX_PRESET_BYTES + 1).read_to_end(&mut bytes).map_err(reading)?;
    if bytes.len() as u64 > MAX_PRESET_BYTES {
        return Err(FileError::TooLarge { path: path.to_owned() });
    }
    String::from_utf8(bytes).map_err(|_| FileError::NotText { path: path.to_owned() })
}

fn write_text(path: &Path, text: &str) -> Result<(), FileError> {
    Ok(write_atomically(path, |writer| {
        std::io::Write::write_all(writer, text.as_bytes()).map_err(|error| ExportError::writing(path, error))
    })?)
}

fn folder_of(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned())
}

/// Where files lie that can be made again.
fn cache_folder() -> PathBuf {
    directories::ProjectDirs::from("", "", "nephoscope")
        .map_or_else(|| std::env::temp_dir().join("nephoscope"), |dirs| dirs.cache_dir().to_owned())
}

impl Preset {
    /// Reads a preset file.
    ///
    /// # Errors
    /// If the file cannot be read, or for the first fault in it, with file, line and column.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let mut preset = Self::from_ron(&read_text(path)?, &path.display().to_string())?;
        let folder = folder_of(path);
        for name in files_of(&mut preset.scene) {
            *name = folder.join(&*name).display().to_string();
        }
        Ok(preset)
    }

    /// Whether a preset that was read from `path` is another one as that is written there: names of files may be written
    /// relative to the preset.
    pub fn is_as_saved(&self, other: &Self, path: &Path) -> bool {
        let mut other = other.clone();
        let folder = folder_of(path);
        for name in files_of(&mut other.scene) {
            *name = folder.join(&*name).display().to_string();
        }
        *self == other
    }

    /// Writes the preset, or leaves the old file as it was.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), FileError> {
        let (mut preset, folder) = (self.clone(), folder_of(path));
        for name in files_of(&mut preset.scene) {
            if let Ok(relative) = Path::new(&*name).strip_prefix(&folder) {
                *name = relative.display().to_string();
            }
        }
        write_text(path, &preset.to_ron())
    }
}

/// Reads a quality file.
///
/// # Errors
/// As [`Preset::load`].
pub fn load_quality(path: &Path) -> Result<Quality, FileError> {
    Ok(quality_from_ron(&read_text(path)?, &path.display().to_string())?)
}

/// Writes a quality file, or leaves the old one as it was.
///
/// # Errors
/// If the file cannot be written.
pub fn save_quality(quality: &Quality, path: &Path) -> Result<(), FileError> {
    write_text(path, &quality_to_ron(quality))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MapSource, Scene};

    #[test]
    fn maps_are_named_relative_to_their_preset() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("sky.ron");
        let map = folder.path().join("maps/a.png").display().to_string();
        let mut preset = Preset::new("Mapped", Scene::default());
        preset.scene.weather.layers[0].source = MapSource::Image;
        preset.scene.weather.layers[0].image.0.clone_from(&map);
        preset.save(&path).expect("saved");
        assert!(read_text(&path).expect("read").contains("image: \"maps/a.png\""), "relative in the file");
        assert_eq!(Preset::load(&path).expect("loaded"), preset, "absolute in memory");
    }

    #[test]
    fn a_failed_save_keeps_the_old_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("nowhere/sky.ron");
        assert!(Preset::default().save(&path).is_err(), "there is no such folder");
        assert!(Preset::load(folder.path()).is_err(), "a folder is no preset");
        std::fs::write(folder.path().join("x.ron"), [0xFF, 0xFE]).expect("written");
        assert!(matches!(Preset::load(&folder.path().join("x.ron")), Err(FileError::NotText { .. })));
    }

    #[test]
    fn quality_files_come_back() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("q.ron");
        let quality = Quality { view_steps: 77, ..Quality::default() };
        save_quality(&quality, &path).expect("saved");
        assert_eq!(load_quality(&path).expect("loaded"), quality);
    }
}
