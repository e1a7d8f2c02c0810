//! PNG files for the screen: display-referred sRGB, 8 or 16 bits, with text entries.

use std::path::Path;

use super::ExportError;
use super::atomic::write_atomically;
use crate::images::ImageError;

/// Interleaved pixels, rows from the top. Alpha is straight (not premultiplied), as PNG demands.
#[derive(Clone, Copy, Debug)]
pub enum PngPixels<'a> {
    /// Three bytes a pixel.
    Rgb8(&'a [u8]),
    /// Four bytes a pixel.
    Rgba8(&'a [u8]),
    /// Three 16-bit words a pixel.
    Rgb16(&'a [u16]),
    /// Four 16-bit words a pixel.
    Rgba16(&'a [u16]),
}

impl PngPixels<'_> {
    fn colour(self) -> ::png::ColorType {
        match self {
            Self::Rgb8(_) | Self::Rgb16(_) => ::png::ColorType::Rgb,
            Self::Rgba8(_) | Self::Rgba16(_) => ::png::ColorType::Rgba,
        }
    }

    fn depth(self) -> ::png::BitDepth {
        match self {
            Self::Rgb8(_) | Self::Rgba8(_) => ::png::BitDepth::Eight,
            Self::Rgb16(_) | Self::Rgba16(_) => ::png::BitDepth::Sixteen,
        }
    }

    fn sample_count(self) -> usize {
        match self {
            Self::Rgb8(samples) | Self::Rgba8(samples) => samples.len(),
            Self::Rgb16(samples) | Self::Rgba16(samples) => samples.len(),
        }
    }
}

/// Writes a PNG of `size` (width, height, pixels) with the `sRGB` chunk and the given text entries, for instance
/// `Software`, `Comment` and `nephoscope:preset`.
///
/// ASCII text becomes a `tEXt` chunk, which every program reads; other text becomes `iTXt`, which holds UTF-8.
///
/// # Errors
/// If the array does not fit `size`, if a text entry cannot be stored, and for everything
/// [`write_atomically`] reports.
pub fn write_png(
    path: &Path,
    size: [u32; 2],
    pixels: PngPixels<'_>,
    text: &[(String, String)],
) -> Result<(), ExportError> {
    let [width, height] = size;
    let expected = width as usize * height as usize * pixels.colour().samples();
    if expected == 0 || pixels.sample_count() != expected {
        return Err(ExportError::BadImage {
            path: path.to_owned(),
            reason: format!("{} samples given, {width} x {height} pixels need {expected}", pixels.sample_count()),
        });
    }
    for (keyword, value) in text {
        check_text(path, keyword, value)?;
    }
    write_atomically(path, |writer| {
        let mut encoder = ::png::Encoder::new(writer, width, height);
        encoder.set_color(pixels.colour());
        encoder.set_depth(pixels.depth());
        encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
        for (keyword, value) in text {
            let added = if value.is_ascii() {
                encoder.add_text_chunk(keyword.clone(), value.clone())
            } else {
                encoder.add_itxt_chunk(keyword.clone(), value.clone())
            };
            added.map_err(|error| encoding(path, error))?;
        }
        let mut image = encoder.write_header().map_err(|error| encoding(path, error))?;
        match pixels {
            PngPixels::Rgb8(samples) | PngPixels::Rgba8(samples) => image.write_image_data(samples),
            PngPixels::Rgb16(samples) | PngPixels::Rgba16(samples) => {
                let big_endian: Vec<u8> = samples.iter().flat_map(|sample| sample.to_be_bytes()).collect();
                image.write_image_data(&big_endian)
            }
        }
        .and_then(|()| image.finish())
        .map_err(|error| encoding(path, error))
    })
}

/// The text entries of a PNG held in memory, in file order. The pixels are not decoded.
///
/// # Errors
/// If the bytes are no PNG, truncated, or damaged. `path` is for the message only.
pub fn text_entries(path: &Path, bytes: &[u8]) -> Result<Vec<(String, String)>, ExportError> {
    let reader = ::png::Decoder::new(std::io::Cursor::new(bytes)).read_info();
    let reader = reader.map_err(|error| decoding(path, error))?;
    let info = reader.info();
    let mut entries: Vec<_> =
        info.uncompressed_latin1_text.iter().map(|chunk| (chunk.keyword.clone(), chunk.text.clone())).collect();
    for chunk in &info.utf8_text {
        let value = chunk.get_text().map_err(|error| decoding(path, error))?;
        entries.push((chunk.keyword.clone(), value));
    }
    Ok(entries)
}

/// Refuses what the chunks cannot hold: keywords are 1 to 79 printable Latin-1 characters, and NUL ends a text
/// (PNG specification, third edition, section 11.3.3).
fn check_text(path: &Path, keyword: &str, value: &str) -> Result<(), ExportError> {
    let printable = |letter: char| matches!(letter, ' '..='~' | '\u{a1}'..='\u{ff}');
    let reason = if !(1..=79).contains(&keyword.chars().count()) || !keyword.chars().all(printable) {
        "needs a name of 1 to 79 printable Latin-1 characters"
    } else if value.contains('\0') {
        "must not hold a NUL character"
    } else {
        return Ok(());
    };
    Err(ExportError::BadMetadata { path: path.to_owned(), name: keyword.to_owned(), reason: reason.to_owned() })
}

fn encoding(path: &Path, error: ::png::EncodingError) -> ExportError {
    match error {
        ::png::EncodingError::IoError(cause) => ExportError::writing(path, cause),
        other => ExportError::Encode { path: path.to_owned(), reason: other.to_string() },
    }
}

fn decoding(path: &Path, error: ::png::DecodingError) -> ImageError {
    match error {
        ::png::DecodingError::IoError(cause) => ImageError::reading(path, cause),
        other => ImageError::Corrupt { path: path.to_owned(), reason: other.to_string() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(keyword: &str, value: &str) -> (String, String) {
        (keyword.to_owned(), value.to_owned())
    }

    #[test]
    fn eight_bit_pixels_and_text_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.png");
        let samples: Vec<u8> = (0..3 * 2 * 4).collect();
        let text =
            [entry("Software", "nephoscope 0.1.0"), entry("nephoscope:preset", "(name: \"Föhn 雲\",\n seed: 7)")];
        write_png(&path, [3, 2], PngPixels::Rgba8(&samples), &text).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(text_entries(&path, &bytes).unwrap(), text);
        let image = image::load_from_memory(&bytes).unwrap();
        assert_eq!((image.width(), image.height()), (3, 2));
        assert_eq!(image.into_rgba8().into_raw(), samples);
    }

    #[test]
    fn sixteen_bit_pixels_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.png");
        let samples = [0_u16, 1, 256, 65535, 32768, 12345];
        write_png(&path, [2, 1], PngPixels::Rgb16(&samples), &[]).unwrap();
        let image = image::open(&path).unwrap();
        assert_eq!(image.into_rgb16().into_raw(), samples);
    }

    #[test]
    fn wrong_sizes_and_keywords_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.png");
        let short = write_png(&path, [2, 2], PngPixels::Rgb8(&[0; 9]), &[]);
        assert!(matches!(short, Err(ExportError::BadImage { .. })), "{short:?}");
        for (keyword, value) in [("k".repeat(80).as_str(), "v"), ("", "v"), ("雲", "v"), ("Comment", "a\0b")] {
            let refused = write_png(&path, [1, 1], PngPixels::Rgb8(&[0; 3]), &[entry(keyword, value)]);
            assert!(matches!(refused, Err(ExportError::BadMetadata { .. })), "{keyword}: {refused:?}");
        }
        assert!(!path.exists(), "a refused picture must leave no file");
    }
}
