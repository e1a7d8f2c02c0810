//! Documents from and to files: presets, images that carry one, and the user's folder of presets.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::export::atomic::write_atomically;
use crate::export::exr::EmbeddedFile;
use crate::export::preset::read_preset;
use crate::export::{ExportError, sha256_hex};
use crate::scene::builtin::{BUILTINS, find};
use crate::scene::edit::map_files;
use crate::scene::{Preset, PresetError, Quality, quality_from_ron};
use crate::ui::{Entry, Library};

/// Files larger than this are no presets.
const LARGEST_PRESET_BYTES: u64 = 4 << 20;

/// Why a document was not loaded or saved. The one in the editor is unchanged.
#[derive(Debug, thiserror::Error)]
pub enum StorageError {
    /// The file cannot be read or written.
    #[error(transparent)]
    File(#[from] ExportError),
    /// The preset in it is not sound.
    #[error("{0}")]
    Preset(#[from] PresetError),
    /// The file holds no text.
    #[error("{0} is not a preset: it holds no text (UTF-8). Open a .ron file, or an EXR or PNG exported here")]
    NotText(PathBuf),
    /// The file is far too large.
    #[error("{0} is too large for a preset (more than 4 MiB). Open a .ron file, or an EXR or PNG exported here")]
    TooLarge(PathBuf),
    /// No built-in preset has that name.
    #[error("there is neither a file nor a built-in preset named {0:?}; built in are: {1}")]
    UnknownName(String, String),
}

/// What a file held.
#[derive(Debug)]
pub struct Loaded {
    /// The sky.
    pub preset: Preset,
    /// The quality it was rendered with, if the file says.
    pub quality: Option<Quality>,
    /// Whether saving goes back to the file: not for images.
    pub is_preset_file: bool,
    /// What the user should know, such as maps that are missing.
    pub notes: Vec<String>,
}

/// Loads a preset or an image that carries one. Maps inside an image go to `map_folder`.
///
/// # Errors
/// See [`StorageError`].
pub fn load(path: &Path, map_folder: &Path) -> Result<Loaded, StorageError> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if ending == "exr" || ending == "png" {
        return load_image(path, map_folder);
    }
    let reading = |cause| ExportError::reading(path, cause);
    let length = std::fs::metadata(path).map_err(reading)?.len();
    if length > LARGEST_PRESET_BYTES {
        return Err(StorageError::TooLarge(path.to_owned()));
    }
    let bytes = std::fs::read(path).map_err(reading)?;
    let text = String::from_utf8(bytes).map_err(|_| StorageError::NotText(path.to_owned()))?;
    let mut preset = Preset::from_ron(&text, &path.display().to_string())?;
    name_after_file(&mut preset, path);
    Ok(Loaded { preset, quality: None, is_preset_file: true, notes: Vec::new() })
}

fn load_image(path: &Path, map_folder: &Path) -> Result<Loaded, StorageError> {
    let embedded = read_preset(path)?;
    let shown = path.display().to_string();
    let mut preset = Preset::from_ron(&embedded.preset_ron, &shown)?;
    let quality = embedded.quality_ron.map(|text| quality_from_ron(&text, &shown)).transpose()?;
    let mut notes = Vec::new();
    for name in map_files(&mut preset.scene.weather.layers) {
        let Some(file) = embedded.files.iter().find(|file| file.name == *name) else { continue };
        match unpack(file, map_folder) {
            Ok(Some(place)) => *name = place.display().to_string(),
            Ok(None) if Path::new(name).exists() => {}
            Ok(None) => notes.push(format!(
                "The weather map {name} was too large to be stored in {shown}; put the file back under that name"
            )),
            Err(error) => notes.push(error.to_string()),
        }
    }
    name_after_file(&mut preset, path);
    Ok(Loaded { preset, quality, is_preset_file: false, notes })
}

/// Puts an embedded map into the folder under a name made of its contents, so that no two maps collide.
fn unpack(file: &EmbeddedFile, folder: &Path) -> Result<Option<PathBuf>, ExportError> {
    let Some(bytes) = &file.bytes else { return Ok(None) };
    let original = Path::new(&file.name);
    let stem = original.file_stem().unwrap_or_default().to_string_lossy();
    let ending = original.extension().unwrap_or_default().to_string_lossy();
    let sum = sha256_hex(bytes);
    let place = folder.join(format!("{stem}-{}.{ending}", sum.get(..12).unwrap_or_default()));
    if !place.exists() {
        std::fs::create_dir_all(folder).map_err(|cause| ExportError::writing(&place, cause))?;
        write_atomically(&place, |out| out.write_all(bytes).map_err(|cause| ExportError::writing(&place, cause)))?;
    }
    Ok(Some(place))
}

fn name_after_file(preset: &mut Preset, path: &Path) {
    if preset.name.is_empty() {
        preset.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    }
}

/// Writes a preset; what was under the path stays whole if it fails.
///
/// # Errors
/// See [`ExportError`].
pub fn save(preset: &Preset, path: &Path) -> Result<(), StorageError> {
    let text = preset.to_ron();
    write_atomically(path, |out| out.write_all(text.as_bytes()).map_err(|cause| ExportError::writing(path, cause)))?;
    Ok(())
}

/// The built-in preset with that file stem or that name for people.
///
/// # Errors
/// If there is none.
pub fn builtin(name: &str) -> Result<Preset, StorageError> {
    if let Some(builtin) = find(name) {
        return Ok(builtin.preset()?);
    }
    for builtin in BUILTINS {
        let preset = builtin.preset()?;
        if preset.name == name {
            return Ok(preset);
        }
    }
    let names: Vec<&str> = BUILTINS.iter().map(|builtin| builtin.name).collect();
    Err(StorageError::UnknownName(name.to_owned(), names.join(", ")))
}

/// Lists the built-in presets and those in the user's folder.
pub fn library(folder: &Path) -> Library {
    let entry = |preset: Preset, path| Entry { name: preset.name, description: preset.description, path };
    let builtin = BUILTINS.iter().filter_map(|builtin| builtin.preset().ok()).map(|preset| entry(preset, None));
    let mut user: Vec<Entry> = Vec::new();
    for file in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = file.path();
        if path.extension().is_some_and(|ending| ending == "ron")
            && let Ok(loaded) = load(&path, folder)
        {
            user.push(entry(loaded.preset, Some(path)));
        }
    }
    user.sort_by(|one, other| one.name.cmp(&other.name));
    Library { builtin: builtin.collect(), user, folder: folder.to_owned(), search: String::new() }
}
