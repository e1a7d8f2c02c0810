//! Images that come in, and the names of numbered ones: what both the renderer and the export read.
//!
//! Pixels and file names only; nothing here knows of clouds, scenes or devices.

pub mod cross;
pub mod map;
pub mod pattern;
pub mod voxels;

use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};

/// What can go wrong when an image is read. Each message names the file and says what to do.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file to be read does not exist.
    #[error("cannot read {path}: there is no such file; check the path")]
    FileMissing {
        /// The path as given.
        path: PathBuf,
    },
    /// The file exists but cannot be read.
    #[error("cannot read {path}: {cause}; check its permissions")]
    NotReadable {
        /// The path as given.
        path: PathBuf,
        /// The failure reported by the operating system.
        cause: io::Error,
    },
    /// The file is neither an EXR nor a PNG.
    #[error("{path} is neither an OpenEXR nor a PNG image; only these two can be read")]
    WrongFormat {
        /// The file that was read.
        path: PathBuf,
    },
    /// The file ends too early.
    #[error("{path} is truncated: it ends in the middle; copy or export it again")]
    Truncated {
        /// The file that was read.
        path: PathBuf,
    },
    /// The file contradicts its format, or uses a part of it that is not supported.
    #[error("{path} cannot be understood: {reason}; export it again from the program that made it")]
    Corrupt {
        /// The file that was read.
        path: PathBuf,
        /// The decoder's own words.
        reason: String,
    },
    /// A map must be square, because it tiles the ground.
    #[error("{path} is {width} x {height} pixels; a map must be square, crop or resize it")]
    NotSquare {
        /// The map.
        path: PathBuf,
        /// Its width, pixels.
        width: u32,
        /// Its height, pixels.
        height: u32,
    },
    /// A map is larger than the renderer takes.
    #[error("{path} is {width} x {height} pixels; it may be at most {limit} x {limit}, make it smaller")]
    TooLarge {
        /// The map.
        path: PathBuf,
        /// Its width, pixels.
        width: u32,
        /// Its height, pixels.
        height: u32,
        /// The largest side that is taken, pixels.
        limit: u32,
    },
    /// The file has more bytes than is sensible for a map.
    #[error("{path} has {bytes} bytes; a map may have at most {limit}, make it smaller or compress it")]
    TooManyBytes {
        /// The map.
        path: PathBuf,
        /// Its size, bytes.
        bytes: u64,
        /// The most that is taken, bytes.
        limit: u64,
    },
    /// NaN or infinity in an image that was read.
    #[error(
        "{path} holds {count} pixel(s) that are not finite, the first at x = {x}, y = {y}, channel {channel}; \
         replace them in the program that made the image"
    )]
    NonFiniteInput {
        /// The file that was read.
        path: PathBuf,
        /// How many pixels hold a NaN or an infinity.
        count: usize,
        /// Column of the first such pixel, from the left.
        x: u32,
        /// Row of the first such pixel, from the top.
        y: u32,
        /// The first channel of that pixel that is not finite.
        channel: char,
    },
}

impl ImageError {
    /// Sorts a failure of the operating system while reading `path` into the variants a user can act on.
    #[must_use]
    pub fn reading(path: &Path, cause: io::Error) -> Self {
        let path = path.to_owned();
        match cause.kind() {
            io::ErrorKind::NotFound => Self::FileMissing { path },
            io::ErrorKind::UnexpectedEof => Self::Truncated { path },
            _ => Self::NotReadable { path, cause },
        }
    }
}

/// Scene-linear pixels, rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FloatImage {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear Rec.709 with associated alpha: colour is already multiplied by coverage, and may exceed alpha.
    pub rgba: Vec<[f32; 4]>,
    /// Camera-space distance to the plane of each pixel, m; always stored as 32-bit float in channel `Z`.
    /// Where nothing is covered, put a large finite number.
    pub depth: Option<Vec<f32>>,
    /// Where these pixels lie if they are only a part of the frame.
    pub crop: Option<Crop>,
}

/// Position of a rendered region (the data window) in its full frame (the display window), pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Left edge of the region.
    pub x: u32,
    /// Top edge of the region.
    pub y: u32,
    /// Width of the full frame.
    pub full_width: u32,
    /// Height of the full frame.
    pub full_height: u32,
}

/// How many pixels are not finite, with the index and the channel of the first.
pub(crate) fn find_non_finite(rgba: &[[f32; 4]], depth: Option<&[f32]>) -> Option<(usize, usize, char)> {
    let bad_channel = |index: usize| {
        let z = depth.map_or(0.0, |depth| depth[index]);
        let [r, g, b, a] = rgba[index];
        [('R', r), ('G', g), ('B', b), ('A', a), ('Z', z)].into_iter().find(|(_, value)| !value.is_finite())
    };
    let mut bad = (0..rgba.len()).filter_map(|index| Some((index, bad_channel(index)?.0)));
    let (first, channel) = bad.next()?;
    Some((1 + bad.count(), first, channel))
}

/// Column and row of a pixel index.
pub(crate) fn position(index: usize, width: u32) -> (u32, u32) {
    let width = width.max(1) as usize;
    let coordinate = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
    (coordinate(index % width), coordinate(index / width))
}

/// The SHA-256 sum of `bytes` as 64 lower-case hexadecimal digits.
#[must_use]
pub fn sha256_hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    Sha256::digest(bytes).iter().fold(String::with_capacity(64), |mut hex, byte| {
        // Writing into a String cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sha256_matches_the_published_vector() {
        // FIPS 180-2, appendix B.1.
        assert_eq!(sha256_hex(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn failures_of_the_system_are_sorted() {
        let path = Path::new("sky.exr");
        assert!(matches!(ImageError::reading(path, io::ErrorKind::NotFound.into()), ImageError::FileMissing { .. }));
        assert!(matches!(ImageError::reading(path, io::ErrorKind::UnexpectedEof.into()), ImageError::Truncated { .. }));
    }
}
