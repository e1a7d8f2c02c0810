//! Joins pictures of one size into a contact sheet, without labels: `contact_sheet COLUMNS WIDTH OUT.png IN.png...`,
//! where WIDTH is that of one picture on the sheet in pixels. Used by `scripts/gallery.sh`.

use std::error::Error;

use image::imageops::{FilterType, replace, resize};
use image::{ImageEncoder as _, Rgb, RgbImage};

/// Pixels between pictures and around them.
const GAP: u32 = 6;
/// A neutral dark grey, against which no sky looks too dark.
const PAPER: Rgb<u8> = Rgb([24, 24, 24]);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [columns, width, out, pictures @ ..] = arguments.as_slice() else {
        return Err("usage: contact_sheet COLUMNS WIDTH OUT.png IN.png...".into());
    };
    let (columns, width): (u32, u32) = (columns.parse()?, width.parse()?);
    let count = u32::try_from(pictures.len())?;
    if count == 0 || columns == 0 || width == 0 {
        return Err("columns, width and pictures must be at least one each".into());
    }
    let mut small = Vec::new();
    for picture in pictures {
        let full = image::open(picture).map_err(|error| format!("{picture}: {error}"))?.into_rgb8();
        let height = (width * full.height()).div_ceil(full.width());
        small.push(resize(&full, width, height, FilterType::Lanczos3));
    }
    let height = small.iter().map(RgbImage::height).max().unwrap_or(1);
    let along = |pictures: u32, side: u32| pictures * (side + GAP) + GAP;
    let size = [along(columns, width), along(count.div_ceil(columns), height)];
    let mut sheet = RgbImage::from_pixel(size[0], size[1], PAPER);
    for (index, picture) in (0..).zip(&small) {
        let place = [along(index % columns, width), along(index / columns, height)];
        replace(&mut sheet, picture, i64::from(place[0]), i64::from(place[1]));
    }
    let file = std::io::BufWriter::new(std::fs::File::create(out)?);
    let (best, adaptive) = (image::codecs::png::CompressionType::Best, image::codecs::png::FilterType::Adaptive);
    let encoder = image::codecs::png::PngEncoder::new_with_quality(file, best, adaptive);
    encoder.write_image(sheet.as_raw(), size[0], size[1], image::ExtendedColorType::Rgb8)?;
    println!("{out}: {}x{}, {count} pictures", size[0], size[1]);
    Ok(())
}
