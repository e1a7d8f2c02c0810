//! Radiance pictures: linear light with one exponent for the three colours of a pixel.

use std::path::Path;

use image::Rgb;
use image::codecs::hdr::HdrEncoder;

use super::ExportError;
use super::atomic::write_atomically;
use crate::images::{find_non_finite, position};

/// Writes linear Rec.709 light, rows from the top. What is below 0 is stored as 0; neither metadata nor opacity fit in.
///
/// # Errors
/// If the pixels do not fit `size`, if a value is NaN or infinite, and for everything [`write_atomically`] reports.
pub fn write_hdr(path: &Path, size: [u32; 2], pixels: &[[f32; 4]]) -> Result<(), ExportError> {
    let [width, height] = size.map(|side| side as usize);
    if pixels.is_empty() || pixels.len() != width * height {
        let reason = format!("{} pixels given, {width} x {height} need {}", pixels.len(), width * height);
        return Err(ExportError::BadImage { path: path.to_owned(), reason });
    }
    if let Some((count, first, channel)) = find_non_finite(pixels, None) {
        let (x, y) = position(first, size[0]);
        return Err(ExportError::NonFinite { path: path.to_owned(), count, x, y, channel });
    }
    let pixels: Vec<Rgb<f32>> =
        pixels.iter().map(|[red, green, blue, _]| Rgb([red.max(0.0), green.max(0.0), blue.max(0.0)])).collect();
    write_atomically(path, |writer| {
        let encoder = HdrEncoder::new(writer);
        encoder
            .encode(&pixels, width, height)
            .map_err(|error| ExportError::Encode { path: path.to_owned(), reason: error.to_string() })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_comes_back_within_its_precision_and_broken_light_is_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("sky.hdr");
        let pixels: Vec<[f32; 4]> = (0..64 * 8).map(|index| [index as f32, 0.25 * index as f32, 1e5, 1.0]).collect();
        write_hdr(&path, [64, 8], &pixels).expect("written");
        let bytes = std::fs::read(&path).expect("it is there");
        assert!(bytes.starts_with(b"#?RADIANCE"), "the name of the format");
        let read = image::load_from_memory_with_format(&bytes, image::ImageFormat::Hdr).expect("sound").to_rgb32f();
        for (own, seen) in pixels.iter().zip(read.pixels()) {
            let own = &own[..3];
            let peak = own.iter().copied().fold(0.0, f32::max);
            for (own, seen) in own.iter().zip(seen.0) {
                assert!((own - seen).abs() <= peak / 128.0, "{own} became {seen} beside {peak}");
            }
        }
        let error = write_hdr(&path, [1, 1], &[[0.0, f32::NAN, 0.0, 1.0]]).expect_err("NaN");
        assert!(matches!(error, ExportError::NonFinite { channel: 'G', .. }), "{error}");
        assert!(write_hdr(&path, [3, 2], &pixels).is_err(), "another size");
        assert_eq!(std::fs::read(&path).expect("still there"), bytes, "the earlier file is as it was");
    }
}
