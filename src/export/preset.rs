//! Getting a sky back from a picture: the preset, the quality and the maps that were stored in it.

use std::fs::File;
use std::io::{BufReader, Read as _, Seek as _};
use std::path::Path;

use ::exr::meta::MetaData;
use ::exr::meta::header::Header;
use ::exr::prelude::{AttributeValue, Text};

use super::exr::{EmbeddedFile, FILE_PREFIX, PREFIX, PRESET, PRESET_VERSION, QUALITY, SHA256_PREFIX, TIME_SECS};

use super::{ExportError, png};
use crate::images::map::{EXR_MAGIC, PNG_MAGIC, exr_failure};
use crate::images::{ImageError, sha256_hex};

/// What a picture says about how it was made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmbeddedPreset {
    /// The preset, byte for byte as it was exported.
    pub preset_ron: String,
    /// Version of the preset format.
    pub preset_version: u32,
    /// The quality settings, if they were stored.
    pub quality_ron: Option<String>,
    /// The time that the picture shows, in seconds since the scene began, as it was stored.
    pub time_secs: Option<String>,
    /// User files the preset names, sorted by name. Those that were too large to embed have no bytes.
    pub files: Vec<EmbeddedFile>,
}

/// Reads the preset out of an exported EXR, or of a PNG with the same text entries (which carries no files).
///
/// Of an EXR only the header is read, so this takes no longer for a large picture, and it succeeds if only the pixels
/// are damaged.
///
/// # Errors
/// If the file is missing, unreadable, neither EXR nor PNG, truncated within the header, damaged, holds no preset, or
/// if an embedded file does not match its sum.
pub fn read_preset(path: &Path) -> Result<EmbeddedPreset, ExportError> {
    let reading = |error| ImageError::reading(path, error);
    let mut file = File::open(path).map_err(reading)?;
    let mut magic = Vec::new();
    file.by_ref().take(PNG_MAGIC.len() as u64).read_to_end(&mut magic).map_err(reading)?;
    file.rewind().map_err(reading)?;
    if magic.starts_with(EXR_MAGIC) {
        let metadata = MetaData::read_from_buffered(BufReader::new(file), false);
        let metadata = metadata.map_err(|error| exr_failure(path, error))?;
        let header = metadata.headers.first().ok_or_else(|| ExportError::NoPreset { path: path.to_owned() })?;
        preset_of_header(path, header)
    } else if magic.starts_with(PNG_MAGIC) {
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(reading)?;
        preset_of_png(path, &bytes)
    } else {
        Err(ImageError::WrongFormat { path: path.to_owned() }.into())
    }
}

fn preset_of_header(path: &Path, header: &Header) -> Result<EmbeddedPreset, ExportError> {
    let attributes = &header.own_attributes.other;
    let string = |name: &str| match attributes.get(name.as_bytes()) {
        Some(AttributeValue::Text(text)) => utf8(path, name, text).map(Some),
        _ => Ok(None),
    };
    let preset_ron = string(PRESET)?.ok_or_else(|| ExportError::NoPreset { path: path.to_owned() })?;
    let version = match attributes.get(PRESET_VERSION.as_bytes()) {
        Some(AttributeValue::I32(version)) => u32::try_from(*version).ok(),
        _ => None,
    };
    let mut names: Vec<&str> = attributes
        .keys()
        .filter_map(|name| std::str::from_utf8(name.bytes()).ok()?.strip_prefix(SHA256_PREFIX))
        .collect();
    names.sort_unstable();
    let mut files = Vec::new();
    for name in names {
        let Some(sha256) = string(&format!("{SHA256_PREFIX}{name}"))? else { continue };
        let bytes = match attributes.get(format!("{FILE_PREFIX}{name}").as_bytes()) {
            Some(AttributeValue::Bytes { bytes, .. }) => Some(bytes.to_vec()),
            _ => None,
        };
        if bytes.as_ref().is_some_and(|bytes| sha256_hex(bytes) != sha256) {
            return Err(ExportError::EmbeddedFileDamaged { path: path.to_owned(), name: name.to_owned() });
        }
        files.push(EmbeddedFile { name: name.to_owned(), sha256, bytes });
    }
    Ok(EmbeddedPreset {
        preset_ron,
        preset_version: version.ok_or_else(|| no_version(path))?,
        quality_ron: string(QUALITY)?,
        time_secs: string(&format!("{PREFIX}{TIME_SECS}"))?,
        files,
    })
}

fn preset_of_png(path: &Path, bytes: &[u8]) -> Result<EmbeddedPreset, ExportError> {
    let mut entries = png::text_entries(path, bytes)?;
    let mut take = |name: &str| {
        let index = entries.iter().position(|(keyword, _)| keyword == name)?;
        Some(entries.swap_remove(index).1)
    };
    let preset_ron = take(PRESET).ok_or_else(|| ExportError::NoPreset { path: path.to_owned() })?;
    let version = take(PRESET_VERSION).and_then(|version| version.parse().ok());
    Ok(EmbeddedPreset {
        preset_ron,
        preset_version: version.ok_or_else(|| no_version(path))?,
        quality_ron: take(QUALITY),
        time_secs: take(&format!("{PREFIX}{TIME_SECS}")),
        files: Vec::new(),
    })
}

fn utf8(path: &Path, name: &str, text: &Text) -> Result<String, ExportError> {
    String::from_utf8(text.bytes().to_vec()).map_err(|_| {
        let reason = format!("the text of the attribute `{name}` is not UTF-8");
        ImageError::Corrupt { path: path.to_owned(), reason }.into()
    })
}

fn no_version(path: &Path) -> ExportError {
    let reason = format!("it holds a preset but no whole number in `{PRESET_VERSION}`");
    ImageError::Corrupt { path: path.to_owned(), reason }.into()
}

#[cfg(test)]
mod tests {
    use super::super::exr::{ExrMetadata, ExrOptions, MAX_EMBEDDED_FILE_BYTES, write_exr};
    use super::super::png::{PngPixels, write_png};
    use super::*;
    use crate::images::FloatImage;
    use std::fs;
    use std::path::PathBuf;

    const RON: &str = "// Föhn über 雲 ☁\n(\n\tname: \"a \\\"quoted\\\" sky\",\r\n    coverage: 0.1,\n)\n\n";

    fn written(metadata: &ExrMetadata) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        let rgba = vec![[0.5, 0.25, 0.125, 1.0]; 64];
        let image = FloatImage { width: 8, height: 8, rgba, ..Default::default() };
        write_exr(&path, &image, metadata, ExrOptions::default()).unwrap();
        (folder, path)
    }

    fn sky() -> ExrMetadata {
        ExrMetadata {
            preset_ron: RON.into(),
            preset_version: 3,
            quality_ron: "(steps: 64)".into(),
            files: vec![
                EmbeddedFile::new("wetter/karte 雲.png", (0..=255).collect()),
                EmbeddedFile::new("big.exr", vec![7; MAX_EMBEDDED_FILE_BYTES + 1]),
                EmbeddedFile::new("empty", Vec::new()),
            ],
            ..Default::default()
        }
    }

    #[test]
    fn a_preset_comes_back_bit_for_bit() {
        let (_folder, path) = written(&sky());
        let preset = read_preset(&path).unwrap();
        assert_eq!(preset.preset_ron, RON);
        assert_eq!(preset.preset_version, 3);
        assert_eq!(preset.quality_ron.as_deref(), Some("(steps: 64)"));
        let mut expected = sky().files;
        expected.sort_by(|a, b| a.name.cmp(&b.name));
        assert_eq!(preset.files, expected);
        assert_eq!(preset.files[0].bytes, None, "a large file is only named");
    }

    #[test]
    fn a_picture_without_a_preset_says_so() {
        let (_folder, path) = written(&ExrMetadata::default());
        let error = read_preset(&path).unwrap_err();
        assert!(matches!(error, ExportError::NoPreset { .. }), "{error:?}");
        assert!(error.to_string().contains("holds no sky"), "{error}");
    }

    #[test]
    fn other_files_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        assert!(matches!(read_preset(&path), Err(ExportError::Image(ImageError::FileMissing { .. }))));
        for contents in [&b""[..], b"v/", b"plain text"] {
            fs::write(&path, contents).unwrap();
            assert!(matches!(read_preset(&path), Err(ExportError::Image(ImageError::WrongFormat { .. }))));
        }
    }

    #[test]
    fn a_truncated_header_is_recognised_but_missing_pixels_do_not_matter() {
        let (_folder, path) = written(&ExrMetadata { preset_ron: RON.into(), ..Default::default() });
        let bytes = fs::read(&path).unwrap();
        for length in [4, 8, 20, 300] {
            fs::write(&path, &bytes[..length]).unwrap();
            let result = read_preset(&path);
            assert!(matches!(result, Err(ExportError::Image(ImageError::Truncated { .. }))), "{length}: {result:?}");
        }
        fs::write(&path, &bytes[..bytes.len() - 10]).unwrap();
        assert_eq!(read_preset(&path).unwrap().preset_ron, RON);
    }

    #[test]
    fn a_damaged_embedded_file_is_named() {
        let (_folder, path) = written(&sky());
        let mut bytes = fs::read(&path).unwrap();
        let run: Vec<u8> = (100..120).collect();
        let at = bytes.windows(run.len()).position(|window| window == run).unwrap();
        bytes[at] ^= 1;
        fs::write(&path, &bytes).unwrap();
        let result = read_preset(&path);
        let Err(ExportError::EmbeddedFileDamaged { name, .. }) = result else { panic!("{result:?}") };
        assert_eq!(name, "wetter/karte 雲.png");
    }

    #[test]
    fn a_png_can_carry_a_preset_too() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.png");
        let text = [(PRESET.to_owned(), RON.to_owned()), (PRESET_VERSION.to_owned(), "3".to_owned())];
        write_png(&path, [1, 1], PngPixels::Rgb8(&[1, 2, 3]), &text).unwrap();
        let preset = read_preset(&path).unwrap();
        assert_eq!((preset.preset_ron.as_str(), preset.preset_version, preset.quality_ron), (RON, 3, None));
        write_png(&path, [1, 1], PngPixels::Rgb8(&[1, 2, 3]), &[]).unwrap();
        assert!(matches!(read_preset(&path), Err(ExportError::NoPreset { .. })));
    }
}
