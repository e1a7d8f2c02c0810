//! Writes a rendered frame with everything needed to make it again.

use std::path::Path;

use glam::{Mat4, Vec3, Vec4};

use super::FileError;
use crate::export::ExportError;
use crate::export::exr::{EmbeddedFile, ExrDepth, ExrLayers, ExrMetadata, ExrOptions, PRESET, QUALITY};
use crate::export::exr::{PREFIX, PRESET_VERSION as VERSION_NAME, TIME_SECS, write_exr_with_layers};
use crate::export::png::{PngPixels, write_png};
use crate::images::{Crop, FloatImage};
use crate::render::LinearImage;
use crate::render::tables::Table;
use crate::scene::edit::files_of;
use crate::scene::{Camera, PRESET_VERSION, Preset, Projection, Quality, Window, quality_to_ron};

/// What a picture shows and how it was computed.
#[derive(Clone, Copy, Debug)]
pub struct About<'a> {
    /// The sky.
    pub preset: &'a Preset,
    /// How it was computed.
    pub quality: &'a Quality,
    /// Seconds since the scene began.
    pub time_secs: f64,
}

/// Writes a display-encoded picture as PNG. The preset goes in as text; map images are only named.
///
/// # Errors
/// If the bytes do not fit the size, or the file cannot be written.
pub fn save_png(path: &Path, size: [u32; 2], rgba: &[u8], about: &About<'_>) -> Result<(), FileError> {
    if rgba.iter().skip(3).step_by(4).all(|alpha| *alpha == u8::MAX) {
        let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        return save_png_pixels(path, size, PngPixels::Rgb8(&rgb), about);
    }
    save_png_pixels(path, size, PngPixels::Rgba8(rgba), about)
}

/// The same with pixels of any kind.
pub(super) fn save_png_pixels(
    path: &Path,
    size: [u32; 2],
    pixels: PngPixels<'_>,
    about: &About<'_>,
) -> Result<(), FileError> {
    let (preset, _) = portable(about.preset);
    let text = [
        ("Software".to_owned(), ExrMetadata::default().software),
        ("Title".to_owned(), preset.name.clone()),
        (PRESET.to_owned(), preset.to_ron()),
        (VERSION_NAME.to_owned(), PRESET_VERSION.to_string()),
        (QUALITY.to_owned(), quality_to_ron(about.quality)),
        (format!("{PREFIX}{TIME_SECS}"), about.time_secs.to_string()),
    ];
    Ok(write_png(path, size, pixels, &text)?)
}

/// Writes linear light as EXR with preset, quality, map images and camera; returns the depth that was used.
///
/// # Errors
/// If a value is NaN or infinite, if half was demanded and a value exceeds it, or if the file cannot be written.
pub fn save_exr(
    path: &Path,
    image: LinearImage,
    about: &About<'_>,
    options: ExrOptions,
) -> Result<ExrDepth, FileError> {
    let camera = Some(&about.preset.scene.camera);
    save_with(path, (image, ExrLayers::default()), (about, camera, None), options)
}

/// The same with layers, with the camera's matrices if one camera made the picture, and as a part of a whole.
pub(super) fn save_with(
    path: &Path,
    (image, layers): (LinearImage, ExrLayers),
    (about, camera, window): (&About<'_>, Option<&Camera>, Option<Window>),
    options: ExrOptions,
) -> Result<ExrDepth, FileError> {
    let [width, height] = image.size;
    let whole = window.map_or(image.size, |window| window.whole);
    let metadata = metadata((about, camera), whole, image.candela_per_unit);
    let crop = window.map(|window| Crop {
        x: window.offset[0],
        y: window.offset[1],
        full_width: window.whole[0],
        full_height: window.whole[1],
    });
    let image = FloatImage { width, height, rgba: image.rgba, depth: None, crop };
    Ok(write_exr_with_layers(path, (&image, &layers), &metadata, options)?)
}

/// What is said of a picture of this size in its file.
pub(super) fn metadata(
    (about, camera): (&About<'_>, Option<&Camera>),
    size: [u32; 2],
    candela_per_unit: f32,
) -> ExrMetadata {
    let (preset, files) = portable(about.preset);
    let camera = camera.and_then(|camera| matrices(camera, size));
    ExrMetadata {
        comments: preset.name.clone(),
        preset_ron: preset.to_ron(),
        preset_version: PRESET_VERSION,
        quality_ron: quality_to_ron(about.quality),
        candela_per_unit,
        world_to_camera: camera.map(|camera| camera[0].to_cols_array_2d()),
        world_to_ndc: camera.map(|camera| camera[1].to_cols_array_2d()),
        extra: vec![(TIME_SECS.to_owned(), about.time_secs.to_string())],
        files,
        ..ExrMetadata::default()
    }
}

/// Writes values of a map, a noise or a table: as EXR with all bits, or as PNG with 16 bits for 0 to 1.
///
/// # Errors
/// As [`save_exr`] and [`save_png`]; and if values do not lie within 0 to 1, for a PNG.
pub fn save_table(path: &Path, table: Table, about: &About<'_>) -> Result<(), FileError> {
    let is_png = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    if is_png {
        let all = || table.rgba.iter().flatten().copied();
        let (low, high) = (all().fold(f32::INFINITY, f32::min), all().fold(f32::NEG_INFINITY, f32::max));
        if low < 0.0 || high > 1.0 + 1e-3 {
            let reason = format!("its values go from {low} to {high}, and a PNG holds 0 to 1; write an .exr");
            return Err(ExportError::BadImage { path: path.to_owned(), reason }.into());
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0 to 65535")]
        let word = |value: f32| (value.clamp(0.0, 1.0) * 65_535.0 + 0.5) as u16;
        let is_opaque = table.rgba.iter().all(|texel| texel[3] == 1.0);
        let channels = if is_opaque { 3 } else { 4 };
        let words: Vec<u16> =
            table.rgba.iter().flat_map(|texel| texel[..channels].iter().map(|value| word(*value))).collect();
        let pixels = if is_opaque { PngPixels::Rgb16(&words) } else { PngPixels::Rgba16(&words) };
        return save_png_pixels(path, table.size, pixels, about);
    }
    let distance_m = vec![0.0; table.rgba.len()];
    let image = LinearImage { size: table.size, rgba: table.rgba, distance_m, candela_per_unit: 1.0 };
    let options = ExrOptions { depth: ExrDepth::Float, ..ExrOptions::default() };
    save_with(path, (image, ExrLayers::default()), (about, None, None), options).map(|_| ())
}

/// The preset with map images named without their folders, and the images themselves.
fn portable(preset: &Preset) -> (Preset, Vec<EmbeddedFile>) {
    let mut preset = preset.clone();
    let mut files: Vec<EmbeddedFile> = Vec::new();
    for name in files_of(&mut preset.scene) {
        let stem = Path::new(&*name).file_name().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let bytes = std::fs::read(&*name).ok();
        *name = stem;
        let Some(bytes) = bytes else { continue };
        let mut file = EmbeddedFile::new(name.clone(), bytes);
        if files.contains(&file) {
            continue;
        }
        if files.iter().any(|other| other.name == *name) {
            *name = format!("{}-{name}", files.len());
            file.name.clone_from(name);
        }
        files.push(file);
    }
    (preset, files)
}

/// World to camera and world to normalised device coordinates, in OpenEXR's convention of row vectors: the rows of its
/// matrices are the columns here. Only a lens has them.
fn matrices(camera: &Camera, size: [u32; 2]) -> Option<[Mat4; 2]> {
    if camera.projection != Projection::Perspective {
        return None;
    }
    let [forward, right, up] = camera.axes();
    let eye = Vec3::new(camera.east_m, camera.height_m, camera.south_m);
    let row = |axis: Vec3| axis.extend(-axis.dot(eye));
    let to_camera = Mat4::from_cols(row(right), row(up), row(forward), Vec4::W).transpose();
    let [across, high] = camera.half_tangents(size);
    // x / z and −y / z fall on 0 ..= 1 from the top left; the third coordinate is 1 − 1 m / z.
    let to_ndc = Mat4::from_cols(
        Vec4::new(0.5 / across, 0.0, 0.0, 0.0),
        Vec4::new(0.0, -0.5 / high, 0.0, 0.0),
        Vec4::new(0.5, 0.5, 1.0, 1.0),
        Vec4::new(0.0, 0.0, -1.0, 0.0),
    );
    Some([to_camera, to_ndc * to_camera])
}

#[cfg(test)]
mod tests {
    use super::super::{Origin, open};
    use super::*;
    use crate::scene::{MapSource, Scene};

    #[test]
    fn a_known_point_falls_on_its_pixel() {
        let camera = Camera { heading_deg: 90.0, pitch_deg: 0.0, field_of_view_deg: 90.0, ..Camera::default() };
        let [to_camera, to_ndc] = matrices(&camera, [200, 100]).expect("a lens");
        let eye = Vec3::new(camera.east_m, camera.height_m, camera.south_m);
        let ahead = to_camera.transform_point3(eye + Vec3::new(100.0, 10.0, 0.0));
        assert!(ahead.abs_diff_eq(Vec3::new(0.0, 10.0, 100.0), 1e-3), "{ahead}");
        // 50 m south of a line of sight to the east is to the right by half of 2 × 100 m.
        let shown = to_ndc.project_point3(eye + Vec3::new(100.0, 100.0, 50.0));
        assert!((shown.x - 0.625).abs() < 1e-5 && shown.y.abs() < 1e-5, "right of the middle, at the top: {shown}");
    }

    #[test]
    fn a_picture_gives_its_sky_back_with_its_map() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let map = folder.path().join("here/map.png");
        std::fs::create_dir(folder.path().join("here")).expect("made");
        write_png(&map, [1, 1], PngPixels::Rgb8(&[1, 2, 3]), &[]).expect("written");
        let mut preset = Preset::new("Mapped", Scene::default());
        preset.scene.weather.layers[0].source = MapSource::Image;
        preset.scene.weather.layers[0].image.0 = map.display().to_string();
        let quality = Quality { light_steps: 7, ..Quality::default() };
        let about = About { preset: &preset, quality: &quality, time_secs: 2.5 };
        let image = LinearImage {
            size: [1, 1],
            rgba: vec![[1.0, 2.0, 1e6, 1.0]],
            distance_m: vec![0.0],
            candela_per_unit: 1.0,
        };
        let exr = folder.path().join("sky.exr");
        assert_eq!(save_exr(&exr, image, &about, ExrOptions::default()).expect("written"), ExrDepth::Float);
        let mut sky = open(&exr).expect("opened");
        assert_eq!((sky.quality, sky.origin), (Some(quality.clone()), Origin::Picture(exr)));
        let unpacked = std::mem::take(&mut sky.preset.scene.weather.layers[0].image.0);
        assert_eq!(std::fs::read(&unpacked).expect("unpacked"), std::fs::read(&map).expect("there"));
        assert!(!sky.preset.to_ron().contains("here"), "no folder of this machine is told");

        let png = folder.path().join("sky.png");
        save_png(&png, [1, 1], &[1, 2, 3, 255], &about).expect("written");
        let missing = open(&png).expect_err("a PNG carries no map").to_string();
        assert!(missing.contains("map.png") && missing.contains("same folder"), "{missing}");
        std::fs::copy(&map, folder.path().join("map.png")).expect("copied");
        assert_eq!(open(&png).expect("found beside it").preset.name, "Mapped");
    }
}
