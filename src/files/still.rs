//! Renders a still and writes it: one picture, or a cube map.

use std::path::{Path, PathBuf};

use super::motion::motion;
use super::picture::{metadata, save_png_pixels, save_with};
use super::{About, FileError, save_png};
use crate::export::ExportError;
use crate::export::exr::{Band, ExrLayers, ExrOptions, write_exr_in_bands};
use crate::export::hdr::write_hdr;
use crate::export::png::PngPixels;
use crate::images::cross::cross;
use crate::plan::{FramePlan, Lighting};
use crate::render::{LinearImage, Proceed, RenderError, Renderer};
use crate::scene::{CUBE_FACES, Camera, Frame, Output, Preset, Scene, Window, file_stem};

/// Rows of the jitter's pattern: bands are multiples of it.
const BAND_STEP: u32 = 64;

/// What a picture's file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// The picture as on the screen, 8 bits: PNG.
    Display,
    /// The same with 16 bits: PNG.
    Display16,
    /// Linear light as Radiance picture.
    Radiance,
    /// Linear light: EXR.
    Linear(ExrOptions),
    /// The same, with layers of light beside it: EXR.
    Layers(ExrOptions),
    /// Clouds with their opacity: EXR.
    CloudsAlone(ExrOptions, Alpha),
}

/// What colours say where clouds are thin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    /// The light that the clouds add, as EXR has it: laid over a picture by `light + (1 - A) behind`.
    Associated,
    /// The same over their opacity, for programs that multiply by it.
    Straight,
}

impl Alpha {
    /// Gives a picture with associated alpha this one.
    pub fn apply(self, image: &mut LinearImage) {
        if self == Self::Straight {
            for [red, green, blue, alpha] in image.rgba.iter_mut().filter(|pixel| pixel[3] > 0.0) {
                (*red, *green, *blue) = (*red / *alpha, *green / *alpha, *blue / *alpha);
            }
        }
    }
}

impl Content {
    /// What the renderer is asked for.
    pub fn output(self) -> Output {
        match self {
            Self::Display | Self::Display16 => Output::Display,
            Self::CloudsAlone(..) => Output::CloudsAlone,
            Self::Radiance | Self::Linear(_) | Self::Layers(_) => Output::Linear,
        }
    }
}

/// How the faces of a cube map are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CubeLayout {
    /// Six files: `sky.px.exr` is east, `py` up, `pz` north, and so on.
    Faces,
    /// One file: a lying cross, north in its middle.
    Cross,
}

/// Why a still could not be rendered or written.
#[derive(Debug, thiserror::Error)]
pub enum StillError {
    /// Rendering failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// Writing failed.
    #[error(transparent)]
    File(#[from] FileError),
    /// It is too large to be rendered whole, and cannot be rendered in bands.
    #[error(
        "a picture of this size has to be rendered in bands, which neither layers nor regions, faces of cubes nor streaks of \
         light can be: make it smaller, leave those out, or set sunshafts.strength to 0"
    )]
    TooLarge,
    /// The content does not go with a cube map.
    #[error(
        "layers cannot be written as a cube map; write linear light, or layers of a panorama (--projection equirect)"
    )]
    CubeOfLayers,
}

impl From<ExportError> for StillError {
    fn from(error: ExportError) -> Self {
        Self::File(error.into())
    }
}

/// A still to be written. The sky is as its preset has it, at no other time.
#[derive(Clone, Copy, Debug)]
pub struct StillFile<'a> {
    /// Where it goes.
    pub path: &'a Path,
    /// What it holds.
    pub content: Content,
    /// Width and height in pixels; of a face, if it is a cube map.
    pub size: [u32; 2],
    /// Whether, and how, it is a cube map.
    pub cube: Option<CubeLayout>,
    /// The part of the picture that is rendered, in pixels: offset from the top left, then width and height. `None` for all.
    pub region: Option<[[u32; 2]; 2]>,
    /// Seconds of the scene until the next frame, for the motion that goes with layers.
    pub frame_secs: f64,
    /// Where light is to end: what is brighter is compressed towards it ([`soften`]). `None` leaves it as it is. Of layers,
    /// and of clouds alone, nothing is compressed.
    pub brightest: Option<f32>,
    /// Pictures of more pixels are rendered in bands; [`LARGEST_WHOLE_PX`](crate::scene::LARGEST_WHOLE_PX) suits most machines.
    pub largest_whole: u64,
    /// What it shows, and how it is computed.
    pub about: About<'a>,
}

impl StillFile<'_> {
    /// The files that it becomes.
    pub fn paths(&self) -> Vec<PathBuf> {
        files_of_still(self.path, self.cube)
    }

    /// Renders and writes it. `proceed` hears the share that is done, and says what becomes of it; cubes and
    /// bands are made to their end. If it is given up, nothing is
    /// written but for the faces of a cube that were finished. Returns whether it was written.
    ///
    /// # Errors
    /// [`StillError`].
    pub fn render(&self, renderer: &mut Renderer, proceed: &mut dyn FnMut(f32) -> Proceed) -> Result<bool, StillError> {
        let is_in_parts = self.cube.is_some() || self.is_large();
        let proceed = &mut |share: f32| match proceed(share) {
            // Parts of unlike samples would show their seams.
            Proceed::WithWhatIsDone if is_in_parts => Proceed::On,
            asked => asked,
        };
        match self.cube {
            None => {
                let scene = &self.about.preset.scene;
                let camera = Some(&scene.camera);
                let part = self.region.map(|[offset, size]| (Window { offset, whole: self.size }, size));
                if self.is_large() && (part.is_some() || !self.is_in_bands_possible(scene)) {
                    return Err(StillError::TooLarge);
                }
                match self.content {
                    Content::Linear(options) | Content::CloudsAlone(options, _)
                        if part.is_none() && self.is_large() =>
                    {
                        return self.write_in_bands(renderer, options, proceed);
                    }
                    _ if part.is_none() && self.is_large() => {
                        let Some(taken) = self.take_in_bands(renderer, proceed)? else { return Ok(false) };
                        self.write(self.path, taken, (&self.about, camera, None))?;
                    }
                    _ => {
                        let Some(taken) = self.take(renderer, (scene, part), proceed)? else { return Ok(false) };
                        self.write(self.path, taken, (&self.about, camera, part.map(|(window, _)| window)))?;
                    }
                }
            }
            Some(_) if matches!(self.content, Content::Layers(_)) => return Err(StillError::CubeOfLayers),
            Some(_) if self.is_large() => return Err(StillError::TooLarge),
            Some(CubeLayout::Faces) => {
                for (index, path) in self.paths().iter().enumerate() {
                    let mut preset = Preset { scene: self.face(index), ..self.about.preset.clone() };
                    preset.animation.override_by(["camera", "sunshafts.strength"]);
                    let mut part = |share: f32| proceed((index as f32 + share) / CUBE_FACES.len() as f32);
                    let Some(taken) = self.take(renderer, (&preset.scene, None), &mut part)? else { return Ok(false) };
                    let about = About { preset: &preset, ..self.about };
                    self.write(path, taken, (&about, Some(&preset.scene.camera), None))?;
                }
            }
            Some(CubeLayout::Cross) => {
                let mut faces = Vec::new();
                for index in 0..CUBE_FACES.len() {
                    let mut part = |share: f32| proceed((index as f32 + share) / CUBE_FACES.len() as f32);
                    let Some(taken) = self.take(renderer, (&self.face(index), None), &mut part)? else {
                        return Ok(false);
                    };
                    faces.push(taken);
                }
                if let Some(whole) = crossed(faces, self.size[0]) {
                    self.write(self.path, whole, (&self.about, None, None))?;
                }
            }
        }
        Ok(true)
    }

    /// Whether it takes more memory than most machines have to hold what each pixel of it, or of its region, needs while it
    /// is rendered.
    pub fn is_large(&self) -> bool {
        let [width, height] = self.region.map_or(self.size, |[_, part]| part);
        u64::from(width) * u64::from(height) > self.largest_whole
    }

    /// Whether pixels do not depend on others that may lie in another band.
    fn is_in_bands_possible(&self, scene: &Scene) -> bool {
        let quality = &self.about.quality.of_still();
        let (size, time_secs, output) = (self.size, self.about.time_secs, self.content.output());
        let frame = Frame { scene, quality, size, time_secs, output, window: None };
        let has_streaks = FramePlan::new(&frame).sunshafts.is_some();
        !has_streaks && !matches!(self.content, Content::Layers(_))
    }

    /// The bands of a large picture, from the top. They begin where the jitter's pattern does, so that no seam is seen.
    fn bands(&self) -> Vec<(Window, [u32; 2])> {
        let [width, height] = self.size;
        let rows = u32::try_from(self.largest_whole / 2 / u64::from(width))
            .unwrap_or(u32::MAX)
            .max(1)
            .next_multiple_of(BAND_STEP);
        let band = |first: u32| (Window { offset: [0, first], whole: self.size }, [width, rows.min(height - first)]);
        (0..height).step_by(rows as usize).map(band).collect()
    }

    fn write_in_bands(
        &self,
        renderer: &mut Renderer,
        options: ExrOptions,
        proceed: &mut dyn FnMut(f32) -> Proceed,
    ) -> Result<bool, StillError> {
        let scene = &self.about.preset.scene;
        let camera = Some(&scene.camera);
        let candela_per_unit = Lighting::new(scene).candela_per_unit;
        let metadata = metadata((&self.about, camera), self.size, candela_per_unit);
        let all = self.bands();
        let count = all.len() as f32;
        let mut left = all.into_iter().enumerate();
        let mut next = || -> Result<Option<Band>, StillError> {
            let Some((index, band)) = left.next() else { return Ok(None) };
            let mut part = |share: f32| proceed((index as f32 + share) / count);
            let taken = self.take(renderer, (scene, Some(band)), &mut part)?;
            Ok(taken.map(|taken| if let Taken::Light(image, _) = taken { image.rgba } else { Vec::new() }))
        };
        write_exr_in_bands(self.path, self.size, (&metadata, options), &mut next)
    }

    /// The bands of a picture one below the other.
    fn take_in_bands(
        &self,
        renderer: &mut Renderer,
        proceed: &mut dyn FnMut(f32) -> Proceed,
    ) -> Result<Option<Taken>, StillError> {
        let bands = self.bands();
        let mut whole: Option<Taken> = None;
        for (index, band) in bands.iter().enumerate() {
            let mut part = |share: f32| proceed((index as f32 + share) / bands.len() as f32);
            let Some(taken) = self.take(renderer, (&self.about.preset.scene, Some(*band)), &mut part)? else {
                return Ok(None);
            };
            whole = Some(match whole {
                None => taken,
                Some(above) => above.over(taken),
            });
        }
        Ok(whole)
    }

    /// The sky seen from the eye towards a face. Streaks round the sun belong to a lens, and would end at its edges.
    fn face(&self, index: usize) -> Scene {
        let mut scene = self.about.preset.scene.clone();
        scene.camera = scene.camera.at_face(&CUBE_FACES[index]);
        scene.sunshafts.strength = 0.0;
        scene
    }

    fn take(
        &self,
        renderer: &mut Renderer,
        (scene, part): (&Scene, Option<(Window, [u32; 2])>),
        proceed: &mut dyn FnMut(f32) -> Proceed,
    ) -> Result<Option<Taken>, StillError> {
        let mut quality = self.about.quality.clone();
        if self.content == Content::Display16 {
            // The mean of several samples is kept finer than the screen needs.
            quality.pixel_samples = quality.pixel_samples.max(2);
        }
        let time_secs = self.about.time_secs;
        let (window, size) = part.map_or((None, self.size), |(window, size)| (Some(window), size));
        let frame = Frame { scene, quality: &quality, size, time_secs, output: self.content.output(), window };
        if let Content::Layers(_) = self.content {
            let layers = renderer.layers(&frame, proceed)?.filter(|_| proceed(1.0) != Proceed::No);
            return Ok(layers.map(|layers| {
                let lights = layers.lights.into_iter().map(|(name, light)| (name.to_owned(), light)).collect();
                let distance = layers.beauty.distance_m.clone();
                let preset = self.about.preset;
                let next =
                    if preset.animation.is_moving() { preset.at(time_secs + self.frame_secs) } else { scene.clone() };
                let [across, down] = motion(&layers.beauty, window, (scene, &next), self.frame_secs);
                let data = [
                    ("transmittance.A", layers.transmittance),
                    ("distance.X", distance),
                    ("motion.u", across),
                    ("motion.v", down),
                ];
                let data = data.into_iter().map(|(name, values)| (name.to_owned(), values)).collect();
                Taken::Light(layers.beauty, ExrLayers { lights, data })
            }));
        }
        // The last moment to give it up; then it is written.
        let Some(still) = renderer.still_while(&frame, proceed)?.filter(|_| proceed(1.0) != Proceed::No) else {
            return Ok(None);
        };
        Ok(Some(match self.content {
            Content::Display => {
                let (size, rgba8) = renderer.rgba8_of(&still.into_display())?;
                Taken::Bytes(size, rgba8)
            }
            Content::Display16 => {
                let (size, rgb16) = still.display16(renderer)?;
                Taken::Words(size, rgb16)
            }
            content => {
                let mut image = still.picture(renderer)?.image;
                match (content, self.brightest) {
                    (Content::CloudsAlone(_, alpha), _) => alpha.apply(&mut image),
                    (_, Some(brightest)) => soften(&mut image.rgba, brightest),
                    _ => {}
                }
                Taken::Light(image, ExrLayers::default())
            }
        }))
    }

    fn write(
        &self,
        path: &Path,
        taken: Taken,
        (about, camera, window): (&About<'_>, Option<&Camera>, Option<Window>),
    ) -> Result<(), FileError> {
        match (taken, self.content) {
            (Taken::Bytes(size, rgba8), _) => save_png(path, size, &rgba8, about)?,
            (Taken::Words(size, rgb16), _) => {
                let flat: Vec<u16> = rgb16.into_iter().flatten().collect();
                save_png_pixels(path, size, PngPixels::Rgb16(&flat), about)?;
            }
            (Taken::Light(image, _), Content::Radiance) => {
                write_hdr(path, image.size, &image.rgba)?;
            }
            (
                Taken::Light(image, layers),
                Content::Linear(options) | Content::Layers(options) | Content::CloudsAlone(options, _),
            ) => {
                save_with(path, (image, layers), (about, camera, window), options)?;
            }
            // Light was asked for by those alone.
            (Taken::Light(..), Content::Display | Content::Display16) => {}
        }
        Ok(())
    }
}

/// Compresses light above half of `brightest` so that it never exceeds it, colour by colour of a pixel alike: a sun that hardware
/// and samplers of other programs can bear. Light and its slope go on without a step. The compression is that of Khronos'
/// PBR Neutral for its highlights.
pub fn soften(rgba: &mut [[f32; 4]], brightest: f32) {
    let knee = 0.5 * brightest;
    let room = brightest - knee;
    for [red, green, blue, _] in rgba {
        let peak = red.max(*green).max(*blue);
        if peak > knee {
            let scale = (brightest - room * room / (peak - knee + room)) / peak;
            (*red, *green, *blue) = (*red * scale, *green * scale, *blue * scale);
        }
    }
}

/// `{name}` and `{seed}` in a file's name stand for the sky's name and the first seed of its weather.
pub fn named(path: &Path, preset: &Preset) -> PathBuf {
    let Some(name) = path.file_name().and_then(|name| name.to_str()).filter(|name| name.contains('{')) else {
        return path.to_owned();
    };
    let seed = preset.scene.weather.layers.first().map_or(0, |layer| layer.seed);
    path.with_file_name(name.replace("{name}", &file_stem(&preset.name)).replace("{seed}", &seed.to_string()))
}

/// The files that a still becomes.
pub fn files_of_still(path: &Path, cube: Option<CubeLayout>) -> Vec<PathBuf> {
    match cube {
        Some(CubeLayout::Faces) => CUBE_FACES.iter().map(|face| face_path(path, face.name)).collect(),
        _ => vec![path.to_owned()],
    }
}

/// A rendered picture.
enum Taken {
    Bytes([u32; 2], Vec<u8>),
    Words([u32; 2], Vec<[u16; 3]>),
    Light(LinearImage, ExrLayers),
}

impl Taken {
    /// The same with another picture of its kind and width below it.
    fn over(self, below: Self) -> Self {
        match (self, below) {
            (Self::Bytes([width, height], mut bytes), Self::Bytes([_, more], rest)) => {
                bytes.extend(rest);
                Self::Bytes([width, height + more], bytes)
            }
            (Self::Words([width, height], mut words), Self::Words([_, more], rest)) => {
                words.extend(rest);
                Self::Words([width, height + more], words)
            }
            (Self::Light(mut image, layers), Self::Light(rest, _)) => {
                image.size[1] += rest.size[1];
                image.rgba.extend(rest.rgba);
                // Nothing that is written in bands needs distances.
                image.distance_m.clear();
                Self::Light(image, layers)
            }
            (above, _) => above,
        }
    }
}

/// The name of a face's file: `sky.exr` becomes `sky.px.exr`.
fn face_path(path: &Path, face: &str) -> PathBuf {
    let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", ending.to_string_lossy()));
    let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    path.with_file_name(format!("{stem}.{face}{ending}"))
}

/// Six pictures of one kind as a cross.
fn crossed(faces: Vec<Taken>, side: u32) -> Option<Taken> {
    let side = side as usize;
    let size = |[width, height]: [usize; 2]| [width, height].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    let (mut bytes, mut words, mut light, mut scale) = (Vec::new(), Vec::new(), Vec::new(), 1.0);
    for face in faces {
        match face {
            Taken::Bytes(_, rgba8) => bytes.push(rgba8.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect()),
            Taken::Words(_, rgb16) => words.push(rgb16),
            Taken::Light(image, _) => {
                scale = image.candela_per_unit;
                light.push(image.rgba);
            }
        }
    }
    if let Ok(faces) = <[Vec<[u8; 4]>; 6]>::try_from(bytes) {
        let (whole, pixels) = cross(&faces, side, [0, 0, 0, u8::MAX]);
        return Some(Taken::Bytes(size(whole), pixels.into_flattened()));
    }
    if let Ok(faces) = <[Vec<[u16; 3]>; 6]>::try_from(words) {
        let (whole, pixels) = cross(&faces, side, [0; 3]);
        return Some(Taken::Words(size(whole), pixels));
    }
    let faces = <[Vec<[f32; 4]>; 6]>::try_from(light).ok()?;
    let (whole, rgba) = cross(&faces, side, [0.0, 0.0, 0.0, 1.0]);
    let distance_m = vec![0.0; rgba.len()];
    Some(Taken::Light(
        LinearImage { size: size(whole), rgba, distance_m, candela_per_unit: scale },
        ExrLayers::default(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn softened_light_ends_where_it_is_told_and_bends_without_a_step() {
        let soft = |value: f32| {
            let mut pixel = [[value, 0.5 * value, 0.25 * value, 0.3]];
            soften(&mut pixel, 10.0);
            pixel[0]
        };
        assert_eq!(soft(5.0), [5.0, 2.5, 1.25, 0.3], "as it was");
        let mut before = 5.0;
        for step in 1..200 {
            let seen = soft(5.0 + 0.05 * step as f32);
            assert!(seen[0] > before && seen[0] - before <= 0.0501, "{before} to {}", seen[0]);
            assert!((seen[1] / seen[0] - 0.5).abs() < 1e-6, "its hue stays");
            before = seen[0];
        }
        let sun = soft(3e9)[0];
        assert!((9.99..=10.0).contains(&sun), "{sun}");
    }

    #[test]
    fn names_and_seeds_go_into_file_names_alone() {
        let mut preset = Preset::new("Fair weather, 2", Scene::default());
        preset.scene.weather.layers[0].seed = 42;
        let path = |text: &str| named(Path::new(text), &preset).display().to_string();
        assert_eq!(path("{seed}/{name}_{seed}.####.exr"), "{seed}/fair-weather--2_42.####.exr");
        assert_eq!(path("sky.png"), "sky.png");
    }
}
