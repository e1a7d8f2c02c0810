//! Pictures too large to be held whole: rows come band by band, and are gone when they are written.

use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Mutex, PoisonError};

use ::exr::prelude as exrs;
use ::exr::prelude::WritableImage as _;
use half::f16;

use super::{ExrDepth, ExrMetadata, ExrOptions, HALF_MAX, layer_attributes};
use crate::export::ExportError;
use crate::export::atomic::write_atomically;
use crate::images::{FloatImage, find_non_finite, position};

/// Rows of a picture, from the top.
pub type Band = Vec<[f32; 4]>;

/// Writes an EXR of which `next` gives band after band, each of whole rows, until it gives `None` too early, which gives the
/// picture up; then nothing is written, and `false` returned. Half floats have to be asked for: how bright the picture gets
/// is not known before.
///
/// # Errors
/// What `next` reports, and as [`write_exr`](super::write_exr).
pub fn write_exr_in_bands<E: From<ExportError>>(
    path: &Path,
    [width, height]: [u32; 2],
    (metadata, options): (&ExrMetadata, ExrOptions),
    next: &mut dyn FnMut() -> Result<Option<Band>, E>,
) -> Result<bool, E> {
    let size = exrs::Vec2(width as usize, height as usize);
    let frame = FloatImage { width, height, rgba: Vec::new(), depth: None, crop: None };
    let attributes = layer_attributes(path, &frame, metadata)?;
    let encoding = exrs::Encoding {
        compression: options.compression.into(),
        blocks: exrs::Blocks::ScanLines,
        line_order: exrs::LineOrder::Increasing,
    };
    let is_half = options.depth == ExrDepth::Half;
    let is_stopped = AtomicBool::new(false);
    // One band is written while the next is rendered.
    let (sender, bands) = sync_channel::<Band>(1);
    std::thread::scope(|scope| {
        let is_stopped = &is_stopped;
        let writer = scope.spawn(move || {
            let rows = Mutex::new(Rows { bands, band: Vec::new(), first: 0, width: size.0, is_stopped });
            let pixel = |at: exrs::Vec2<usize>| rows.lock().unwrap_or_else(PoisonError::into_inner).pixel(at);
            write_atomically(path, |writer| {
                let target = Stoppable { inner: writer, is_stopped };
                let written = if is_half {
                    let half = |at| {
                        let [r, g, b, a] = pixel(at).map(f16::from_f32);
                        (r, g, b, a)
                    };
                    let channels = exrs::SpecificChannels::rgba(half);
                    let layer = exrs::Layer::new(size, attributes, encoding, channels);
                    exrs::Image::from_layer(layer).write().non_parallel().to_buffered(target)
                } else {
                    let float = |at| {
                        let [r, g, b, a] = pixel(at);
                        (r, g, b, a)
                    };
                    let channels = exrs::SpecificChannels::rgba(float);
                    let layer = exrs::Layer::new(size, attributes, encoding, channels);
                    exrs::Image::from_layer(layer).write().non_parallel().to_buffered(target)
                };
                written.map_err(|error| match error {
                    exrs::Error::Io(cause) => ExportError::writing(path, cause),
                    other => ExportError::Encode { path: path.to_owned(), reason: other.to_string() },
                })
            })
        });
        let fed = feed(path, ([width, height], is_half), next, &sender);
        if !matches!(fed, Ok(true)) {
            is_stopped.store(true, Ordering::Relaxed);
        }
        drop(sender);
        let written = writer.join().unwrap_or_else(|_| {
            Err(ExportError::Encode { path: path.to_owned(), reason: "the writing thread panicked".to_owned() })
        });
        match fed {
            Ok(true) => written.map(|()| true).map_err(E::from),
            // That it was stopped is no fault of the file's.
            other => other,
        }
    })
}

/// Sends all bands to the writer; `false` if there were too few, or nobody takes them any more.
fn feed<E: From<ExportError>>(
    path: &Path,
    ([width, height], is_half): ([u32; 2], bool),
    next: &mut dyn FnMut() -> Result<Option<Band>, E>,
    sender: &std::sync::mpsc::SyncSender<Band>,
) -> Result<bool, E> {
    let width_px = width as usize;
    let mut row = 0_u32;
    while row < height {
        let Some(band) = next()? else { return Ok(false) };
        let rows = band.len() / width_px.max(1);
        if rows == 0 || rows * width_px != band.len() {
            let reason = format!("a band of {} pixels is no whole rows of {width}", band.len());
            return Err(ExportError::BadImage { path: path.to_owned(), reason }.into());
        }
        let place = |index: usize| {
            let (x, y) = position(index, width);
            (x, row.saturating_add(y))
        };
        if let Some((count, first, channel)) = find_non_finite(&band, None) {
            let (x, y) = place(first);
            return Err(ExportError::NonFinite { path: path.to_owned(), count, x, y, channel }.into());
        }
        let large = |pixel: &[f32; 4]| pixel.iter().copied().find(|value| value.abs() > HALF_MAX);
        if let Some((index, value)) = band.iter().enumerate().find_map(|(index, pixel)| Some((index, large(pixel)?)))
            && is_half
        {
            let (x, y) = place(index);
            return Err(ExportError::BeyondHalf { path: path.to_owned(), value, x, y }.into());
        }
        row = row.saturating_add(u32::try_from(rows).unwrap_or(u32::MAX));
        if sender.send(band).is_err() {
            // The writer has failed, and says why.
            return Ok(true);
        }
    }
    Ok(true)
}

/// The rows that are being written.
struct Rows<'a> {
    bands: Receiver<Band>,
    band: Band,
    /// Row of its first pixel.
    first: usize,
    width: usize,
    is_stopped: &'a AtomicBool,
}

impl Rows<'_> {
    /// A pixel; rows are asked for in their order.
    fn pixel(&mut self, at: exrs::Vec2<usize>) -> [f32; 4] {
        while at.1 >= self.first + self.band.len() / self.width {
            self.first += self.band.len() / self.width;
            let Ok(band) = self.bands.recv() else {
                // Nothing more comes; what is written now is thrown away.
                self.is_stopped.store(true, Ordering::Relaxed);
                return [0.0; 4];
            };
            self.band = band;
        }
        self.band[(at.1 - self.first) * self.width + at.0]
    }
}

/// A writer that fails once it is stopped.
struct Stoppable<'a, W> {
    inner: &'a mut W,
    is_stopped: &'a AtomicBool,
}

impl<W: Write> Write for Stoppable<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.is_stopped.load(Ordering::Relaxed) {
            return Err(io::Error::other("given up"));
        }
        self.inner.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Seek> Seek for Stoppable<'_, W> {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.inner.seek(position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::images::map::read_exr;

    fn value(x: u32, y: u32) -> [f32; 4] {
        [x as f32, y as f32, 0.5, 1.0]
    }

    fn write(path: &Path, until: u32, broken: Option<u32>, options: ExrOptions) -> Result<bool, ExportError> {
        let mut row = 0;
        write_exr_in_bands(path, [33, 50], (&ExrMetadata::default(), options), &mut || {
            let rows = row..(row + 16).min(50);
            row += 16;
            let pixel = |(x, y)| if broken == Some(y) { [f32::NAN; 4] } else { value(x, y) };
            let band = rows.clone().flat_map(|y| (0..33).map(move |x| (x, y))).map(pixel).collect();
            Ok((rows.start < until).then_some(band))
        })
    }

    #[test]
    fn bands_make_the_picture_and_what_is_given_up_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("large.exr");
        for depth in [ExrDepth::Half, ExrDepth::Float] {
            let options = ExrOptions { depth, ..ExrOptions::default() };
            assert!(write(&path, 50, None, options).expect("written"));
            let read = read_exr(&path).expect("it is sound");
            assert_eq!([read.width, read.height], [33, 50]);
            let expected: Band = (0..50).flat_map(|y| (0..33).map(move |x| value(x, y))).collect();
            assert_eq!(read.rgba, expected, "{depth:?}");
        }
        let before = std::fs::read(&path).expect("it is there");
        let options = ExrOptions::default();
        assert!(!write(&path, 20, None, options).expect("given up"));
        let error = write(&path, 50, Some(40), options).expect_err("NaN");
        assert!(matches!(error, ExportError::NonFinite { y: 40, x: 0, .. }), "{error}");
        assert_eq!(std::fs::read(&path).expect("still there"), before, "the earlier file is as it was");
        assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 1, "and nothing lies beside it");
    }
}
