//! Opens a sky by any of its names: a built-in preset, a preset file, a picture with a preset inside, or a voxel grid.

use std::path::{Path, PathBuf};

use super::{FileError, cache_folder, folder_of, grid};
use crate::export::ExportError;
use crate::export::atomic::write_atomically;
use crate::export::exr::EmbeddedFile;
use crate::export::preset::read_preset;
use crate::images::sha256_hex;
use crate::scene::builtin::{self, BUILTINS};
use crate::scene::edit::files_of;
use crate::scene::nearest::did_you_mean;
use crate::scene::{Preset, Quality, quality_from_ron};

/// Where a sky came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The program.
    Builtin(&'static str),
    /// A preset file, which can be saved to again.
    Preset(PathBuf),
    /// A picture.
    Picture(PathBuf),
    /// The description of a voxel grid.
    Grid(PathBuf),
}

/// An opened sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    /// The preset.
    pub preset: Preset,
    /// The settings a picture was made with, or those of the level that the preset names.
    pub quality: Option<Quality>,
    /// Where it came from.
    pub origin: Origin,
    /// The time that a picture shows, in seconds since the scene began; 0 for everything else.
    pub time_secs: f64,
}

/// Opens a sky.
///
/// # Errors
/// If `source` is neither a file nor a built-in sky, if the file cannot be read, for the first fault in its preset,
/// and if a picture's weather map is missing.
pub fn open(source: &Path) -> Result<Sky, FileError> {
    let name = source.to_str().unwrap_or_default();
    let extension = source.extension().and_then(|extension| extension.to_str()).map(str::to_lowercase);
    match extension.as_deref() {
        Some("exr" | "png") => open_picture(source),
        Some("json") => Ok(sky(grid::open(source)?, None, Origin::Grid(source.to_owned()))),
        None if !source.is_file() => {
            let builtin = builtin::find(name).ok_or_else(|| FileError::UnknownSky {
                name: source.display().to_string(),
                hint: did_you_mean(name, BUILTINS.iter().map(|builtin| builtin.name)),
            })?;
            Ok(sky(builtin.preset()?, None, Origin::Builtin(builtin.name)))
        }
        _ => Ok(sky(Preset::load(source)?, None, Origin::Preset(source.to_owned()))),
    }
}

fn sky(preset: Preset, quality: Option<Quality>, origin: Origin) -> Sky {
    let quality = quality.or_else(|| preset.quality.map(Quality::level));
    Sky { preset, quality, origin, time_secs: 0.0 }
}

fn open_picture(path: &Path) -> Result<Sky, FileError> {
    let embedded = read_preset(path)?;
    let shown = path.display();
    let mut preset = Preset::from_ron(&embedded.preset_ron, &format!("{shown}, preset"))?;
    let quality = match &embedded.quality_ron {
        Some(text) => Some(quality_from_ron(text, &format!("{shown}, quality"))?),
        None => None,
    };
    for name in files_of(&mut preset.scene) {
        *name = map_of_picture(path, name, &embedded.files)?.display().to_string();
    }
    let time_secs = embedded.time_secs.and_then(|text| text.parse().ok()).filter(|time: &f64| time.is_finite());
    let time_secs = time_secs.unwrap_or(0.0);
    Ok(Sky { time_secs, ..sky(preset, quality, Origin::Picture(path.to_owned())) })
}

/// A map that a picture names: from inside it, or the file of that name beside it.
fn map_of_picture(path: &Path, name: &str, files: &[EmbeddedFile]) -> Result<PathBuf, FileError> {
    let file = files.iter().find(|file| file.name == name);
    if let Some((file, bytes)) = file.and_then(|file| file.bytes.as_ref().map(|bytes| (file, bytes))) {
        return unpack(file, bytes);
    }
    let sha256 = file.map_or("", |file| file.sha256.as_str());
    // Only the name counts, so that a picture from elsewhere cannot point at any file of this machine.
    let beside = folder_of(path).join(Path::new(name).file_name().unwrap_or_default());
    let fits = std::fs::read(&beside).is_ok_and(|bytes| sha256.is_empty() || sha256_hex(&bytes) == sha256);
    if fits || name.contains('#') {
        return Ok(beside);
    }
    Err(FileError::MapMissing { path: path.to_owned(), name: name.to_owned(), sha256: sha256.to_owned() })
}

/// Writes an embedded map into the cache, in a folder named by its contents.
fn unpack(file: &EmbeddedFile, bytes: &[u8]) -> Result<PathBuf, FileError> {
    let folder = cache_folder().join("maps").join(&sha256_hex(bytes)[..16]);
    let target = folder.join(Path::new(&file.name).file_name().unwrap_or("map".as_ref()));
    if std::fs::read(&target).is_ok_and(|found| found == bytes) {
        return Ok(target);
    }
    std::fs::create_dir_all(&folder).map_err(|error| ExportError::writing(&target, error))?;
    write_atomically(&target, |writer| {
        std::io::Write::write_all(writer, bytes).map_err(|error| ExportError::writing(&target, error))
    })?;
    Ok(target)
}
