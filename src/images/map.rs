//! Images that come in: user weather maps (PNG or EXR), and EXR pictures read back.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use ::exr::meta::MetaData;
use ::exr::prelude as exrs;
use ::exr::prelude::{ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _};

use super::{Crop, FloatImage, ImageError, find_non_finite, position, sha256_hex};

/// The most bytes a map file may have. A 4096² RGBA map of uncompressed floats has a quarter of that.
pub const MAX_MAP_FILE_BYTES: u64 = 1 << 30;

/// The most pixels an EXR may have, so that a damaged header cannot claim all memory. A 16K panorama has half.
const MAX_EXR_PIXELS: u64 = 1 << 28;
/// First bytes of every PNG file.
pub(crate) const PNG_MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";
/// First bytes of every OpenEXR file.
pub(crate) const EXR_MAGIC: &[u8] = &::exr::meta::magic_number::BYTES;

/// A square map, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct MapImage {
    /// Pixels in a row.
    pub width: u32,
    /// Rows; equal to `width`.
    pub height: u32,
    /// Values as stored: a PNG's integers are divided by their largest value and NOT taken through a transfer
    /// function, since a map holds data and no colours. Grey fills R, G and B; channels that are missing are 0,
    /// alpha 1.
    pub rgba: Vec<[f32; 4]>,
    /// SHA-256 of the file, 64 lower-case hexadecimal digits.
    pub sha256: String,
}

/// Reads a square PNG or EXR map of at most `max_side` pixels a side.
///
/// # Errors
/// If the file is missing, unreadable, of another format, truncated, damaged, not square, too large, or holds a value
/// that is not finite.
pub fn read_map_image(path: &Path, max_side: u32) -> Result<MapImage, ImageError> {
    decode_map_image(path, &read_limited(path)?, max_side)
}

/// As [`read_map_image`], from bytes, such as a file embedded in an EXR; `path` is for the messages only.
///
/// # Errors
/// As [`read_map_image`], except for those of the file system.
pub fn decode_map_image(path: &Path, bytes: &[u8], max_side: u32) -> Result<MapImage, ImageError> {
    let check_size = |width: u32, height: u32| {
        let path = path.to_owned();
        if width != height {
            Err(ImageError::NotSquare { path, width, height })
        } else if width > max_side {
            Err(ImageError::TooLarge { path, width, height, limit: max_side })
        } else {
            Ok(())
        }
    };
    let (width, height, rgba) = if bytes.starts_with(PNG_MAGIC) {
        decode_png(path, bytes, check_size)?
    } else {
        let image = decode_exr(path, bytes, check_size)?;
        (image.width, image.height, image.rgba)
    };
    check_finite(path, width, &rgba, None)?;
    Ok(MapImage { width, height, rgba, sha256: sha256_hex(bytes) })
}

/// Reads an EXR picture back, with `Z` and the crop if it has them. At most 2²⁸ pixels are taken.
///
/// # Errors
/// If the file is missing, unreadable, no EXR, truncated, damaged, has no colour channels, or holds a value that is
/// not finite.
pub fn read_exr(path: &Path) -> Result<FloatImage, ImageError> {
    let bytes = fs::read(path).map_err(|error| ImageError::reading(path, error))?;
    let image = decode_exr(path, &bytes, |_, _| Ok(()))?;
    check_finite(path, image.width, &image.rgba, image.depth.as_deref())?;
    Ok(image)
}

/// First bytes of a Radiance file.
const HDR_MAGIC: &[u8] = b"#?";

/// Reads any picture: EXR and Radiance hold linear light, PNG what a screen shows, which is decoded from sRGB. Returns whether it was
/// made for a screen, too.
///
/// # Errors
/// As [`read_exr`].
pub fn read_picture(path: &Path) -> Result<(FloatImage, bool), ImageError> {
    let bytes = read_limited(path)?;
    if bytes.starts_with(EXR_MAGIC) {
        let image = decode_exr(path, &bytes, |_, _| Ok(()))?;
        check_finite(path, image.width, &image.rgba, image.depth.as_deref())?;
        return Ok((image, false));
    }
    let is_shown = bytes.starts_with(PNG_MAGIC);
    let (width, height, mut rgba) = if is_shown {
        decode_png(path, &bytes, |width, height| {
            if u64::from(width) * u64::from(height) <= MAX_EXR_PIXELS {
                return Ok(());
            }
            Err(ImageError::TooLarge { path: path.to_owned(), width, height, limit: 16_384 })
        })?
    } else if bytes.starts_with(HDR_MAGIC) {
        let decoded = image::load_from_memory_with_format(&bytes, image::ImageFormat::Hdr);
        let decoded =
            decoded.map_err(|error| ImageError::Corrupt { path: path.to_owned(), reason: error.to_string() })?;
        let (width, height) = (decoded.width(), decoded.height());
        (width, height, decoded.into_rgba32f().into_raw().as_chunks().0.to_vec())
    } else {
        return Err(ImageError::WrongFormat { path: path.to_owned() });
    };
    check_finite(path, width, &rgba, None)?;
    if is_shown {
        rgba.iter_mut().flat_map(|pixel| &mut pixel[..3]).for_each(|channel| *channel = srgb_decoded(*channel));
    }
    Ok((FloatImage { width, height, rgba, depth: None, crop: None }, is_shown))
}

/// Linear light of an sRGB value, 0 to 1 (IEC 61966-2-1).
pub fn srgb_decoded(value: f32) -> f32 {
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

fn read_limited(path: &Path) -> Result<Vec<u8>, ImageError> {
    let reading = |error| ImageError::reading(path, error);
    let bytes = fs::metadata(path).map_err(reading)?.len();
    if bytes > MAX_MAP_FILE_BYTES {
        return Err(ImageError::TooManyBytes { path: path.to_owned(), bytes, limit: MAX_MAP_FILE_BYTES });
    }
    fs::read(path).map_err(reading)
}

fn check_finite(path: &Path, width: u32, rgba: &[[f32; 4]], depth: Option<&[f32]>) -> Result<(), ImageError> {
    let Some((count, first, channel)) = find_non_finite(rgba, depth) else { return Ok(()) };
    let (x, y) = position(first, width);
    Err(ImageError::NonFiniteInput { path: path.to_owned(), count, x, y, channel })
}

/// Width, height and pixels.
type Pixels = (u32, u32, Vec<[f32; 4]>);

fn decode_png(
    path: &Path,
    bytes: &[u8],
    check_size: impl Fn(u32, u32) -> Result<(), ImageError>,
) -> Result<Pixels, ImageError> {
    let failed = |error| match error {
        image::ImageError::IoError(cause) => ImageError::reading(path, cause),
        other => ImageError::Corrupt { path: path.to_owned(), reason: other.to_string() },
    };
    // The size comes first: a small file can promise a picture larger than the memory.
    let reader = || image::ImageReader::with_format(Cursor::new(bytes), image::ImageFormat::Png);
    let (width, height) = reader().into_dimensions().map_err(failed)?;
    check_size(width, height)?;
    let mut reader = reader();
    reader.no_limits();
    let values = reader.decode().map_err(failed)?.into_rgba32f().into_raw();
    Ok((width, height, values.as_chunks().0.to_vec()))
}

/// What a reader of EXR headers found wrong, told apart for the user.
pub(crate) fn exr_failure(path: &Path, error: exrs::Error) -> ImageError {
    match error {
        exrs::Error::Io(cause) => ImageError::reading(path, cause),
        // The crate turns an unexpected end of file into this text.
        exrs::Error::Invalid(reason) if reason.contains("missing bytes") => {
            ImageError::Truncated { path: path.to_owned() }
        }
        other => ImageError::Corrupt { path: path.to_owned(), reason: other.to_string() },
    }
}

/// Values for the pixels of a file while it is read: colour with a separate luminance, and depth.
struct Collected {
    width: usize,
    rgba: Vec<[f32; 4]>,
    depth: Option<Vec<f32>>,
}

fn decode_exr(
    path: &Path,
    bytes: &[u8],
    check_size: impl Fn(u32, u32) -> Result<(), ImageError>,
) -> Result<FloatImage, ImageError> {
    if !bytes.starts_with(EXR_MAGIC) {
        return Err(ImageError::WrongFormat { path: path.to_owned() });
    }
    let failed = |error| exr_failure(path, error);
    let corrupt = |reason: &str| ImageError::Corrupt { path: path.to_owned(), reason: reason.to_owned() };
    let metadata = MetaData::read_from_buffered(bytes, false).map_err(failed)?;
    let header = metadata.headers.first().ok_or_else(|| corrupt("it has no image part"))?;
    if header.deep {
        return Err(corrupt("deep images are not supported"));
    }
    let side = |value: usize| u32::try_from(value).map_err(|_| corrupt("its size is beyond 32 bits"));
    let (width, height) = (side(header.layer_size.width())?, side(header.layer_size.height())?);
    if width == 0 || height == 0 {
        return Err(corrupt("it has no pixels"));
    }
    check_size(width, height)?;
    if u64::from(width) * u64::from(height) > MAX_EXR_PIXELS {
        return Err(corrupt("it promises more pixels than 16384 x 16384"));
    }

    let has = |name: &str| header.channels.list.iter().any(|channel| channel.name.eq(name));
    let is_grey = has("Y") && !has("R");
    if !is_grey && !has("R") {
        return Err(corrupt("it has neither a channel R nor a channel Y"));
    }
    if header.channels.list.iter().any(|channel| channel.sampling != exrs::Vec2(1, 1)) {
        return Err(corrupt("channels with fewer samples than pixels are not supported"));
    }
    let has_depth = has("Z");
    let image = exrs::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .optional("R", 0.0_f32)
        .optional("G", 0.0_f32)
        .optional("B", 0.0_f32)
        .optional("A", 1.0_f32)
        .optional("Y", 0.0_f32)
        .optional("Z", 0.0_f32)
        .collect_pixels(
            move |size, _| {
                let count = size.area();
                let depth = has_depth.then(|| vec![0.0; count]);
                Collected { width: size.width(), rgba: vec![[0.0; 4]; count], depth }
            },
            move |pixels: &mut Collected, at, (r, g, b, a, y, z): (f32, f32, f32, f32, f32, f32)| {
                let index = at.y() * pixels.width + at.x();
                pixels.rgba[index] = if is_grey { [y, y, y, a] } else { [r, g, b, a] };
                if let Some(depth) = &mut pixels.depth {
                    depth[index] = z;
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(failed)?;
    let pixels = image.layer_data.channel_data.pixels;
    Ok(FloatImage { width, height, rgba: pixels.rgba, depth: pixels.depth, crop: crop_of(header) })
}

/// The place of the data window if it is a true part of the display window.
fn crop_of(header: &::exr::meta::header::Header) -> Option<Crop> {
    let (data, full) = (header.data_window(), header.shared_attributes.display_window);
    let offset = |data: i32, full: i32| u32::try_from(i64::from(data) - i64::from(full)).ok();
    let crop = Crop {
        x: offset(data.position.x(), full.position.x())?,
        y: offset(data.position.y(), full.position.y())?,
        full_width: u32::try_from(full.size.width()).ok()?,
        full_height: u32::try_from(full.size.height()).ok()?,
    };
    let inside = crop.x as usize + data.size.width() <= full.size.width()
        && crop.y as usize + data.size.height() <= full.size.height();
    if inside && data.size != full.size { Some(crop) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::exr::{ExrDepth, ExrMetadata, ExrOptions, write_exr};
    use crate::export::png::{PngPixels, write_png};
    use std::path::PathBuf;

    fn in_folder(name: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        (folder, path)
    }

    fn write_square_exr(path: &Path) -> FloatImage {
        let rgba = (0..16_u8).map(|i| [f32::from(i), 0.25, 1.0e5, 0.5]).collect();
        let image = FloatImage { width: 4, height: 4, rgba, depth: None, crop: None };
        let options = ExrOptions { depth: ExrDepth::Float, ..Default::default() };
        write_exr(path, &image, &ExrMetadata::default(), options).unwrap();
        image
    }

    #[test]
    fn png_values_are_taken_as_stored() {
        let (_folder, path) = in_folder("map.png");
        let samples = [0, 51, 255, 102, 1, 2, 3, 4, 255, 255, 255, 255, 9, 8, 7, 6];
        write_png(&path, [2, 2], PngPixels::Rgba8(&samples), &[]).unwrap();
        let map = read_map_image(&path, 16).unwrap();
        assert_eq!((map.width, map.height), (2, 2));
        assert_eq!(map.rgba[0], [0.0, 0.2, 1.0, 0.4], "no transfer function may be applied");
        assert_eq!(map.sha256, sha256_hex(&fs::read(&path).unwrap()));
    }

    #[test]
    fn grey_png_fills_three_channels_at_16_bits() {
        let (_folder, path) = in_folder("map.png");
        image::ImageBuffer::from_fn(2, 2, |x, _| image::Luma([if x == 0 { 1_u16 } else { 65535 }]))
            .save(&path)
            .unwrap();
        let map = read_map_image(&path, 16).unwrap();
        let low = 1.0 / 65535.0;
        assert_eq!(map.rgba[..2], [[low, low, low, 1.0], [1.0; 4]]);
    }

    #[test]
    fn exr_maps_keep_their_floats() {
        let (_folder, path) = in_folder("map.exr");
        let image = write_square_exr(&path);
        assert_eq!(read_map_image(&path, 4).unwrap().rgba, image.rgba);
    }

    #[test]
    fn one_luminance_channel_is_enough() {
        let (_folder, path) = in_folder("map.exr");
        let channel = exrs::AnyChannel::new("Y", exrs::FlatSamples::F32(vec![0.5; 4]));
        let channels = exrs::AnyChannels::sort(exrs::SmallVec::from_vec(vec![channel]));
        exrs::WritableImage::write(&exrs::Image::from_channels((2, 2), channels)).to_file(&path).unwrap();
        assert_eq!(read_map_image(&path, 4).unwrap().rgba, [[0.5, 0.5, 0.5, 1.0]; 4]);
    }

    #[test]
    fn maps_of_the_wrong_size_are_refused_before_decoding() {
        let (_folder, path) = in_folder("map.png");
        write_png(&path, [2, 1], PngPixels::Rgb8(&[0; 6]), &[]).unwrap();
        assert!(matches!(read_map_image(&path, 4), Err(ImageError::NotSquare { width: 2, height: 1, .. })));
        let (_folder, path) = in_folder("map.exr");
        write_square_exr(&path);
        let error = read_map_image(&path, 3).unwrap_err();
        assert!(matches!(error, ImageError::TooLarge { limit: 3, .. }), "{error:?}");
        assert!(error.to_string().contains("3 x 3"), "the limit belongs in the message: {error}");

        // The header alone promises 60000 x 60000 pixels, 14 GB; only the limit stands between that and the memory.
        let mut huge = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\xea\x60\0\0\xea\x60\x08\x06\0\0\0".to_vec();
        huge.extend(crc32(&huge[12..]).to_be_bytes());
        huge.extend(b"\0\0\0\0IDAT");
        huge.extend(crc32(b"IDAT").to_be_bytes());
        let result = decode_map_image(&path, &huge, 8192);
        assert!(matches!(result, Err(ImageError::TooLarge { width: 60000, .. })), "{result:?}");
    }

    /// CRC-32 as PNG uses it (ISO 3309).
    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1)))
        })
    }

    #[test]
    fn missing_and_foreign_files_are_told_apart() {
        let (folder, path) = in_folder("map.png");
        assert!(matches!(read_map_image(&path, 4), Err(ImageError::FileMissing { .. })));
        assert!(matches!(read_map_image(folder.path(), 4), Err(ImageError::NotReadable { .. })));
        for contents in [&b""[..], b"GIF89a", b"(name: \"sky\")"] {
            fs::write(&path, contents).unwrap();
            assert!(matches!(read_map_image(&path, 4), Err(ImageError::WrongFormat { .. })));
        }
    }

    #[test]
    fn every_truncation_is_an_error_and_no_panic() {
        let (_folder, exr) = in_folder("map.exr");
        write_square_exr(&exr);
        let (_folder, png) = in_folder("map.png");
        let noise: Vec<u8> = (0..16 * 16 * 4_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        write_png(&png, [16, 16], PngPixels::Rgba8(&noise), &[]).unwrap();
        for path in [exr, png] {
            let bytes = fs::read(&path).unwrap();
            // The 12 bytes of a PNG's IEND chunk carry nothing, so decoders may do without.
            for length in (0..bytes.len() - 12).step_by(3) {
                assert!(decode_map_image(&path, &bytes[..length], 64).is_err(), "{length} bytes of {}", path.display());
            }
            let result = decode_map_image(&path, &bytes[..bytes.len() / 2], 64);
            assert!(matches!(result, Err(ImageError::Truncated { .. })), "{result:?}");
        }
    }

    #[test]
    fn damaged_files_do_not_panic() {
        let (_folder, exr) = in_folder("map.exr");
        write_square_exr(&exr);
        let bytes = fs::read(&exr).unwrap();
        for index in 4..bytes.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[index] ^= flip;
                // Any answer is good, if it comes without a panic and without much memory.
                let _ = decode_map_image(&exr, &damaged, 64);
            }
        }
    }

    #[test]
    fn maps_with_nan_are_refused() {
        let (_folder, path) = in_folder("map.exr");
        let channel = exrs::AnyChannel::new("R", exrs::FlatSamples::F32(vec![0.5, 0.5, 0.5, f32::NAN]));
        let channels = exrs::AnyChannels::sort(exrs::SmallVec::from_vec(vec![channel]));
        exrs::WritableImage::write(&exrs::Image::from_channels((2, 2), channels)).to_file(&path).unwrap();
        let result = read_map_image(&path, 4);
        assert!(
            matches!(result, Err(ImageError::NonFiniteInput { count: 1, x: 1, y: 1, channel: 'R', .. })),
            "{result:?}"
        );
    }
}
