//! Scene-linear pictures as OpenEXR, with everything needed to make them again.
//!
//! One unnamed scan-line part with the channels `R G B A` (associated alpha) and, if given, `Z`. Colours are linear
//! Rec.709, named by the attribute `colorInteropID` (ASWF Color Interop Forum, "Identifying the Color Space of
//! OpenEXR Files", version 1.0.0). What is Nephoscope's own has the prefix `nephoscope:`.

mod bands;

use std::collections::HashMap;
use std::path::Path;

use ::exr::prelude as exrs;
use ::exr::prelude::{AttributeValue, Text, WritableImage as _};
use half::f16;

pub use bands::{Band, write_exr_in_bands};

use super::ExportError;
use super::atomic::write_atomically;
use crate::images::{Crop, FloatImage, find_non_finite, position, sha256_hex};

/// Prefix of the attributes that only Nephoscope understands.
pub const PREFIX: &str = "nephoscope:";
/// The whole preset, RON text.
pub const PRESET: &str = "nephoscope:preset";
/// Version of the preset format, an integer.
pub const PRESET_VERSION: &str = "nephoscope:presetVersion";
/// The quality settings of the render, RON text.
pub const QUALITY: &str = "nephoscope:quality";
/// What a picture's time is called behind [`PREFIX`], in seconds since the scene began.
pub const TIME_SECS: &str = "timeSecs";
/// Candela per square metre that a channel value of 1 stands for.
pub const LUMINANCE_SCALE: &str = "nephoscope:candelaPerSquareMetrePerUnit";
/// Prefix of an embedded file's bytes; its name follows.
pub const FILE_PREFIX: &str = "nephoscope:file:";
/// Prefix of an embedded file's SHA-256 sum; its name follows.
pub const SHA256_PREFIX: &str = "nephoscope:sha256:";
/// Larger user files are only named, with their sum: an image should stay an image.
pub const MAX_EMBEDDED_FILE_BYTES: usize = 8 << 20;

/// OpenEXR's limit for the name of an attribute, bytes.
const MAX_NAME_BYTES: usize = 255;
/// The largest finite half-precision number.
const HALF_MAX: f32 = 65504.0;

/// A user's file (a weather map, say) carried inside an EXR so that the sky can be made again elsewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmbeddedFile {
    /// The name by which the preset calls it; at most 200 bytes.
    pub name: String,
    /// SHA-256 of the contents, 64 lower-case hexadecimal digits.
    pub sha256: String,
    /// The contents; `None` if they were too large to embed (see [`MAX_EMBEDDED_FILE_BYTES`]).
    pub bytes: Option<Vec<u8>>,
}

impl EmbeddedFile {
    /// A file with the sum of its contents, which are dropped if they are larger than [`MAX_EMBEDDED_FILE_BYTES`].
    #[must_use]
    pub fn new(name: impl Into<String>, bytes: Vec<u8>) -> Self {
        let sha256 = sha256_hex(&bytes);
        Self { name: name.into(), sha256, bytes: Some(bytes).filter(|bytes| bytes.len() <= MAX_EMBEDDED_FILE_BYTES) }
    }
}

/// What is written beside the pixels. Empty strings are left out.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrMetadata {
    /// Program and version, attribute `software`.
    pub software: String,
    /// Free text, attribute `comments`.
    pub comments: String,
    /// Local time as `YYYY:MM:DD hh:mm:ss`, attribute `capDate`.
    pub cap_date: String,
    /// The whole preset as RON; kept byte for byte.
    pub preset_ron: String,
    /// Version of the preset format; written only with a preset.
    pub preset_version: u32,
    /// The quality settings as RON.
    pub quality_ron: String,
    /// Candela per square metre for a channel value of 1; finite and above 0.
    pub candela_per_unit: f32,
    /// World to camera, rows of a matrix that multiplies row vectors from the right (translation in the last row);
    /// the camera looks along +z, with +x to the right and +y up (OpenEXR, `ImfStandardAttributes.h`).
    pub world_to_camera: Option<[[f32; 4]; 4]>,
    /// World to normalised device coordinates, same convention; (0, 0) is the top left, (1, 1) the bottom right.
    pub world_to_ndc: Option<[[f32; 4]; 4]>,
    /// Further text entries, (name, value); the prefix `nephoscope:` is added to each name.
    pub extra: Vec<(String, String)>,
    /// Files that the preset names.
    pub files: Vec<EmbeddedFile>,
}

impl Default for ExrMetadata {
    fn default() -> Self {
        Self {
            software: concat!("nephoscope ", env!("CARGO_PKG_VERSION")).to_owned(),
            comments: String::new(),
            cap_date: String::new(),
            preset_ron: String::new(),
            preset_version: 0,
            quality_ron: String::new(),
            candela_per_unit: 1.0,
            world_to_camera: None,
            world_to_ndc: None,
            extra: Vec::new(),
            files: Vec::new(),
        }
    }
}

/// Bits per colour sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExrDepth {
    /// Half, unless a value is beyond its range of ±65504 (an unclipped sun is).
    #[default]
    Auto,
    /// 16-bit half.
    Half,
    /// 32-bit float.
    Float,
}

/// Codecs. ZIP is the smallest lossless one for clean skies; PIZ wins only on grain. DWAA loses what is hardly seen: colours
/// by their channels' names, never opacity or data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExrCompression {
    /// Deflate over blocks of 16 lines.
    #[default]
    Zip,
    /// Deflate line by line, quicker to read for compositors that go by lines.
    Zips,
    /// Wavelets over blocks of 32 lines.
    Piz,
    /// Lossy cosines over blocks of 32 lines, at the usual level of 45.
    Dwaa,
    /// As it is.
    None,
}

impl From<ExrCompression> for exrs::Compression {
    fn from(compression: ExrCompression) -> Self {
        match compression {
            ExrCompression::Zip => Self::ZIP16,
            ExrCompression::Zips => Self::ZIP1,
            ExrCompression::Piz => Self::PIZ,
            ExrCompression::Dwaa => Self::DWAA(Some(45.0)),
            ExrCompression::None => Self::Uncompressed,
        }
    }
}

/// How the pixels are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExrOptions {
    /// Bits per colour sample.
    pub depth: ExrDepth,
    /// The codec.
    pub compression: ExrCompression,
}

/// Channels beside those of the picture itself.
#[derive(Clone, Debug, Default)]
pub struct ExrLayers {
    /// Layers of light: `direct` is written as `direct.R`, `direct.G`, `direct.B`, with the depth of the picture.
    pub lights: Vec<(String, Vec<[f32; 3]>)>,
    /// Data, always of 32 bits; their names end in `.A` or `.X`, which no lossy codec takes for colours.
    pub data: Vec<(String, Vec<f32>)>,
}

/// Writes an EXR atomically and returns the depth that was chosen, [`ExrDepth::Half`] or [`ExrDepth::Float`].
///
/// # Errors
/// If array lengths and sizes disagree, if any value is NaN or infinite, if half was demanded for a value beyond its
/// range, if a metadata entry cannot be stored, and for everything [`write_atomically`] reports.
pub fn write_exr(
    path: &Path,
    image: &FloatImage,
    metadata: &ExrMetadata,
    options: ExrOptions,
) -> Result<ExrDepth, ExportError> {
    write_exr_with_layers(path, (image, &ExrLayers::default()), metadata, options)
}

/// The same with layers beside the picture.
///
/// # Errors
/// As [`write_exr`].
pub fn write_exr_with_layers(
    path: &Path,
    (image, layers): (&FloatImage, &ExrLayers),
    metadata: &ExrMetadata,
    options: ExrOptions,
) -> Result<ExrDepth, ExportError> {
    check_sizes(path, image)?;
    check_finite(path, image)?;
    check_layers(path, image, layers)?;
    let depth = resolve_depth(path, image, options.depth)?;
    let layer = exrs::Layer {
        channel_data: channels(image, layers, depth),
        attributes: layer_attributes(path, image, metadata)?,
        size: exrs::Vec2(image.width as usize, image.height as usize),
        encoding: exrs::Encoding {
            compression: options.compression.into(),
            blocks: exrs::Blocks::ScanLines,
            line_order: exrs::LineOrder::Increasing,
        },
    };
    let full = image.crop.map_or([image.width, image.height], |crop| [crop.full_width, crop.full_height]);
    let attributes = exrs::ImageAttributes::with_size((full[0] as usize, full[1] as usize));
    let file = exrs::Image { attributes, layer_data: layer };
    write_atomically(path, |writer| {
        file.write().to_buffered(writer).map_err(|error| match error {
            exrs::Error::Io(cause) => ExportError::writing(path, cause),
            other => ExportError::Encode { path: path.to_owned(), reason: other.to_string() },
        })
    })?;
    Ok(depth)
}

fn check_sizes(path: &Path, image: &FloatImage) -> Result<(), ExportError> {
    let bad = |reason| Err(ExportError::BadImage { path: path.to_owned(), reason });
    let (width, height) = (image.width, image.height);
    let count = width as usize * height as usize;
    if count == 0 {
        return bad(format!("{width} x {height} is no picture"));
    }
    if image.rgba.len() != count || image.depth.as_ref().is_some_and(|depth| depth.len() != count) {
        return bad(format!("the pixel arrays do not hold {width} x {height} values"));
    }
    let crop = image.crop.unwrap_or(Crop { x: 0, y: 0, full_width: width, full_height: height });
    let fits = |start: u32, size: u32, full: u32| start.checked_add(size).is_some_and(|end| end <= full);
    if !fits(crop.x, width, crop.full_width) || !fits(crop.y, height, crop.full_height) {
        return bad(format!("the region {width} x {height} leaves its frame: {crop:?}"));
    }
    // OpenEXR windows are signed; a quarter of that range keeps every sum of two coordinates inside it.
    if crop.full_width.max(crop.full_height) > 1 << 29 {
        return bad(format!("a frame of {} x {} is too large", crop.full_width, crop.full_height));
    }
    Ok(())
}

fn check_finite(path: &Path, image: &FloatImage) -> Result<(), ExportError> {
    match find_non_finite(&image.rgba, image.depth.as_deref()) {
        None => Ok(()),
        Some((count, first, channel)) => {
            let (x, y) = position(first, image.width);
            Err(ExportError::NonFinite { path: path.to_owned(), count, x, y, channel })
        }
    }
}

fn check_layers(path: &Path, image: &FloatImage, layers: &ExrLayers) -> Result<(), ExportError> {
    let count = image.rgba.len();
    let lights = layers.lights.iter().map(|(name, light)| (name, light.len(), light.as_flattened()));
    let data = layers.data.iter().map(|(name, data)| (name, data.len(), data.as_slice()));
    for (name, length, values) in lights.chain(data) {
        if length != count || values.iter().any(|value| !value.is_finite()) {
            let reason = format!("the layer {name} has {length} of {count} pixels, or values that are not finite");
            return Err(ExportError::BadImage { path: path.to_owned(), reason });
        }
    }
    Ok(())
}

fn resolve_depth(path: &Path, image: &FloatImage, depth: ExrDepth) -> Result<ExrDepth, ExportError> {
    let too_large = |pixel: &[f32; 4]| pixel.iter().copied().find(|value| value.abs() > HALF_MAX);
    let first = image.rgba.iter().enumerate().find_map(|(index, pixel)| Some((index, too_large(pixel)?)));
    match (depth, first) {
        (ExrDepth::Float, _) | (ExrDepth::Auto, Some(_)) => Ok(ExrDepth::Float),
        (_, None) => Ok(ExrDepth::Half),
        (ExrDepth::Half, Some((index, value))) => {
            let (x, y) = position(index, image.width);
            Err(ExportError::BeyondHalf { path: path.to_owned(), value, x, y })
        }
    }
}

fn channels(image: &FloatImage, layers: &ExrLayers, depth: ExrDepth) -> exrs::AnyChannels<exrs::FlatSamples> {
    let colour = |name: &str, values: &mut dyn Iterator<Item = f32>| {
        let samples = match depth {
            ExrDepth::Half => exrs::FlatSamples::F16(values.map(f16::from_f32).collect()),
            _ => exrs::FlatSamples::F32(values.collect()),
        };
        exrs::AnyChannel::new(name, samples)
    };
    let own = ["R", "G", "B", "A"].iter().enumerate();
    let own = own.map(|(index, name)| colour(name, &mut image.rgba.iter().map(|pixel| pixel[index])));
    let mut list: exrs::SmallVec<_> = own.collect();
    if let Some(depth) = &image.depth {
        // Half would place a cloud at 20 km on steps of 16 m, hence always 32 bits.
        list.push(exrs::AnyChannel::new("Z", exrs::FlatSamples::F32(depth.clone())));
    }
    for (name, light) in &layers.lights {
        for (index, channel) in ["R", "G", "B"].iter().enumerate() {
            list.push(colour(&format!("{name}.{channel}"), &mut light.iter().map(|pixel| pixel[index])));
        }
    }
    for (name, values) in &layers.data {
        list.push(exrs::AnyChannel::new(name.as_str(), exrs::FlatSamples::F32(values.clone())));
    }
    exrs::AnyChannels::sort(list)
}

/// UTF-8 as it is. OpenEXR does not name an encoding for strings; `Text::from` would panic beyond Latin-1.
fn text(value: &str) -> Text {
    Text::from_bytes_unchecked(exrs::SmallVec::from_slice(value.as_bytes()))
}

/// Attributes that are not in the standard's list, refusing names that cannot be stored or come twice.
struct CustomAttributes<'a> {
    path: &'a Path,
    map: HashMap<Text, AttributeValue>,
}

impl CustomAttributes<'_> {
    fn refuse(&self, name: &str, reason: impl Into<String>) -> ExportError {
        ExportError::BadMetadata { path: self.path.to_owned(), name: name.to_owned(), reason: reason.into() }
    }

    fn insert(&mut self, name: &str, value: AttributeValue) -> Result<(), ExportError> {
        if name.len() > MAX_NAME_BYTES || name.contains('\0') || name.ends_with(':') {
            return Err(self.refuse(name, format!("needs a name of 1 to {MAX_NAME_BYTES} bytes without NUL")));
        }
        match self.map.insert(text(name), value) {
            None => Ok(()),
            Some(_) => Err(self.refuse(name, "is given twice")),
        }
    }

    fn insert_text(&mut self, name: &str, value: &str) -> Result<(), ExportError> {
        self.insert(name, AttributeValue::Text(text(value)))
    }

    fn insert_file(&mut self, file: &EmbeddedFile) -> Result<(), ExportError> {
        self.insert_text(&format!("{SHA256_PREFIX}{}", file.name), &file.sha256)?;
        let Some(bytes) = file.bytes.as_ref().filter(|bytes| bytes.len() <= MAX_EMBEDDED_FILE_BYTES) else {
            return Ok(());
        };
        let bytes = exrs::SmallVec::from_slice(bytes);
        let value = AttributeValue::Bytes { type_hint: text("application/octet-stream"), bytes };
        self.insert(&format!("{FILE_PREFIX}{}", file.name), value)
    }
}

fn layer_attributes(
    path: &Path,
    image: &FloatImage,
    metadata: &ExrMetadata,
) -> Result<exrs::LayerAttributes, ExportError> {
    let optional = |value: &str| if value.is_empty() { None } else { Some(text(value)) };
    let position = |value: u32| i32::try_from(value).unwrap_or(i32::MAX);
    Ok(exrs::LayerAttributes {
        // A name would make viewers such as tev prefix every channel with it.
        layer_name: None,
        layer_position: image.crop.map_or(exrs::Vec2(0, 0), |crop| exrs::Vec2(position(crop.x), position(crop.y))),
        software_name: optional(&metadata.software),
        comments: optional(&metadata.comments),
        capture_date: optional(&metadata.cap_date),
        world_to_camera: flat_matrix(path, "worldToCamera", metadata.world_to_camera)?,
        world_to_normalized_device: flat_matrix(path, "worldToNDC", metadata.world_to_ndc)?,
        other: custom_attributes(path, metadata)?,
        ..Default::default()
    })
}

fn flat_matrix(path: &Path, name: &str, rows: Option<[[f32; 4]; 4]>) -> Result<Option<[f32; 16]>, ExportError> {
    let Some(rows) = rows else { return Ok(None) };
    if rows.as_flattened().iter().any(|value| !value.is_finite()) {
        let (name, reason) = (name.to_owned(), "holds a number that is not finite".to_owned());
        return Err(ExportError::BadMetadata { path: path.to_owned(), name, reason });
    }
    Ok(Some(std::array::from_fn(|index| rows[index / 4][index % 4])))
}

fn custom_attributes(path: &Path, metadata: &ExrMetadata) -> Result<HashMap<Text, AttributeValue>, ExportError> {
    let mut custom = CustomAttributes { path, map: HashMap::new() };
    if !is_cap_date(&metadata.cap_date) {
        return Err(custom.refuse("capDate", "must look like 2026:11:22 18:30:00"));
    }
    if !(metadata.candela_per_unit.is_finite() && metadata.candela_per_unit > 0.0) {
        return Err(custom.refuse(LUMINANCE_SCALE, "must be finite and above 0"));
    }
    custom.insert(LUMINANCE_SCALE, AttributeValue::F32(metadata.candela_per_unit))?;
    custom.insert_text("colorInteropID", "lin_rec709_scene")?;
    if !metadata.preset_ron.is_empty() {
        let version = i32::try_from(metadata.preset_version)
            .map_err(|_| custom.refuse(PRESET_VERSION, format!("must be at most {}", i32::MAX)))?;
        custom.insert_text(PRESET, &metadata.preset_ron)?;
        custom.insert(PRESET_VERSION, AttributeValue::I32(version))?;
    }
    if !metadata.quality_ron.is_empty() {
        custom.insert_text(QUALITY, &metadata.quality_ron)?;
    }
    for (name, value) in &metadata.extra {
        custom.insert_text(&format!("{PREFIX}{name}"), value)?;
    }
    for file in &metadata.files {
        custom.insert_file(file)?;
    }
    Ok(custom.map)
}

/// `YYYY:MM:DD hh:mm:ss` by shape, or nothing.
fn is_cap_date(date: &str) -> bool {
    let shape = b"0000:00:00 00:00:00";
    let fits = |(byte, shape): (u8, &u8)| if *shape == b'0' { byte.is_ascii_digit() } else { byte == *shape };
    date.is_empty() || (date.len() == shape.len() && date.bytes().zip(shape).all(fits))
}

#[cfg(test)]
mod tests;
