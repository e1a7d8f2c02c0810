//! Makes a PNG of the framebuffer file that `Xvfb -fbdir` keeps (X window dump, version 7), and fails if there is no
//! picture in it: `framebuffer Xvfb_screen0 window.png`. Used by `scripts/window_smoke.sh`.

use std::collections::HashSet;
use std::error::Error;

/// A panel with a sky has far more colours than this; an empty window and a window of plain widgets have fewer.
const LEAST_COLOURS: usize = 500;

/// The fields of the header that matter, by their place among its big-endian words.
const HEADER_SIZE: usize = 0;
const VERSION: usize = 1;
const WIDTH: usize = 4;
const HEIGHT: usize = 5;
const BYTE_ORDER: usize = 7;
const BITS_PER_PIXEL: usize = 11;
const BYTES_PER_LINE: usize = 12;
const COLOURS: usize = 19;
/// Bytes of one entry of the colour table.
const COLOUR_SIZE: usize = 12;

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths = std::env::args().skip(1);
    let (Some(dump), Some(picture)) = (paths.next(), paths.next()) else {
        return Err("usage: framebuffer DUMP PNG".into());
    };
    let bytes = std::fs::read(dump)?;
    let word = |index: usize| -> Result<usize, Box<dyn Error>> {
        let word = bytes.get(index * 4..index * 4 + 4).ok_or("the dump is cut off")?;
        Ok(u32::from_be_bytes(word.try_into()?) as usize)
    };
    if word(VERSION)? != 7 || word(BITS_PER_PIXEL)? != 32 {
        return Err("not a dump of version 7 with 32 bits per pixel".into());
    }
    let (width, height, line) = (word(WIDTH)?, word(HEIGHT)?, word(BYTES_PER_LINE)?);
    let is_little = word(BYTE_ORDER)? == 0;
    let pixels = bytes.get(word(HEADER_SIZE)? + word(COLOURS)? * COLOUR_SIZE..).ok_or("the dump is cut off")?;
    let mut rgb = Vec::with_capacity(width * height * 3);
    for row in pixels.chunks(line).take(height) {
        for pixel in row.chunks_exact(4).take(width) {
            let channels = if is_little { [pixel[2], pixel[1], pixel[0]] } else { [pixel[1], pixel[2], pixel[3]] };
            rgb.extend(channels);
        }
    }
    image::save_buffer(picture, &rgb, u32::try_from(width)?, u32::try_from(height)?, image::ColorType::Rgb8)?;
    let colours: HashSet<&[u8]> = rgb.chunks_exact(3).collect();
    if colours.len() < LEAST_COLOURS {
        return Err(format!("the screen shows only {} colours, so no sky", colours.len()).into());
    }
    Ok(())
}
