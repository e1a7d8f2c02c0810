//! Files that leave the program and come back: EXR and PNG, with the preset inside.
//!
//! This folder knows pixels and strings only. It never sees the scene or the renderer: a preset travels through it
//! as text, a camera as sixteen numbers. Every file is written by [`atomic::write_atomically`], so that a full disk,
//! a crash or a cancelled render leaves the previous file as it was.

pub mod atomic;
pub mod exr;
pub mod hdr;
pub mod png;
pub mod preset;

use std::io;
use std::path::{Path, PathBuf};

use crate::images::ImageError;

/// What can go wrong when a file is written or read back. Each message names the file and says what to do.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The folder of the output file does not exist, or is not a folder.
    #[error("cannot write {path}: there is no folder {folder}; create it, or choose another output path")]
    FolderMissing {
        /// The file that was to be written.
        path: PathBuf,
        /// The folder that is missing.
        folder: PathBuf,
    },
    /// The folder exists but no file may be created in it.
    #[error(
        "cannot write {path}: the folder {folder} is not writable ({cause}); \
         choose another folder or change its permissions"
    )]
    FolderNotWritable {
        /// The file that was to be written.
        path: PathBuf,
        /// The folder that refused.
        folder: PathBuf,
        /// The refusal of the operating system.
        cause: io::Error,
    },
    /// The disk or the quota is full (`ENOSPC`, `EDQUOT`). The file that was there before is unchanged.
    #[error(
        "cannot write {path}: the disk is full; free some space or choose another disk \
         (an earlier file of that name is unchanged)"
    )]
    DiskFull {
        /// The file that was to be written.
        path: PathBuf,
    },
    /// The output path is a folder, a device or a pipe, which must not be replaced by an image.
    #[error("cannot write {path}: it is a folder or a device; give the path of a file")]
    NotAFile {
        /// The path as given.
        path: PathBuf,
    },
    /// The output file exists and is marked read-only.
    #[error("cannot write {path}: the file is write-protected; remove the protection or choose another name")]
    WriteProtected {
        /// The protected file.
        path: PathBuf,
    },
    /// Any other failure while writing.
    #[error("cannot write {path}: {cause}; check that the disk is still connected and try again")]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// The failure reported by the operating system.
        cause: io::Error,
    },
    /// The encoder refused the picture.
    #[error("cannot write {path}: {reason}")]
    Encode {
        /// The file that was to be written.
        path: PathBuf,
        /// The encoder's own words.
        reason: String,
    },
    /// Sizes of the pixel arrays do not agree with width and height, or the crop leaves its frame.
    #[error("cannot write {path}: {reason}")]
    BadImage {
        /// The file that was to be written.
        path: PathBuf,
        /// Which numbers disagree.
        reason: String,
    },
    /// NaN or infinity in the picture. Such pixels spread in compositing, so they are never written.
    #[error(
        "cannot write {path}: {count} pixel(s) are not finite, the first at x = {x}, y = {y}, channel {channel}; \
         nothing was written, please report the preset that made them"
    )]
    NonFinite {
        /// The file that was to be written.
        path: PathBuf,
        /// How many pixels hold a NaN or an infinity in any channel.
        count: usize,
        /// Column of the first such pixel, from the left.
        x: u32,
        /// Row of the first such pixel, from the top.
        y: u32,
        /// The first channel of that pixel that is not finite.
        channel: char,
    },
    /// 16-bit floats were asked for, but a value would become infinite.
    #[error(
        "cannot write {path} as 16-bit half: the value {value} at x = {x}, y = {y} is beyond 65504; \
         use depth `auto` or `float`"
    )]
    BeyondHalf {
        /// The file that was to be written.
        path: PathBuf,
        /// The first value that does not fit.
        value: f32,
        /// Its column.
        x: u32,
        /// Its row.
        y: u32,
    },
    /// A metadata entry cannot be stored.
    #[error("cannot write {path}: the metadata entry `{name}` {reason}")]
    BadMetadata {
        /// The file that was to be written.
        path: PathBuf,
        /// The entry's name.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// An image could not be read.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A whole image, but without a preset inside.
    #[error(
        "{path} holds no sky; it was not written by Nephoscope, or another program dropped its metadata. \
         Open the original export or a .ron preset"
    )]
    NoPreset {
        /// The file that was read.
        path: PathBuf,
    },
    /// A file embedded in an EXR no longer has the contents it was stored with.
    #[error("{path}: the embedded file `{name}` does not match its SHA-256 sum; export the EXR again")]
    EmbeddedFileDamaged {
        /// The EXR that was read.
        path: PathBuf,
        /// The embedded file.
        name: String,
    },
}

impl ExportError {
    /// Sorts a failure of the operating system while writing `path` into the variants a user can act on.
    #[must_use]
    pub fn writing(path: &Path, cause: io::Error) -> Self {
        let path = path.to_owned();
        match cause.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Self::DiskFull { path },
            _ => Self::Write { path, cause },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_of_the_system_are_sorted() {
        let path = Path::new("sky.exr");
        // 28 is ENOSPC on every Unix.
        #[cfg(unix)]
        assert!(matches!(ExportError::writing(path, io::Error::from_raw_os_error(28)), ExportError::DiskFull { .. }));
        assert!(matches!(ExportError::writing(path, io::ErrorKind::BrokenPipe.into()), ExportError::Write { .. }));
    }
}
