//! Voxel grids with a description beside them: what another renderer needs to draw the same picture, and the sky that
//! such a pair makes. `docs/grid.md` states the format.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{FileError, folder_of, read_text, write_text};
use crate::export::ExportError;
use crate::export::atomic::write_atomically;
use crate::images::voxels::{Bounds, VdbOptions, VoxelGrid};
use crate::scene::param::{Colour, FileName};
use crate::scene::{
    CloudLayer, DensityModel, DomainKind, FieldOfViewAxis, Phase, PhaseKind, PlainLight, Preset, Scene, edit,
};

/// What the entry `format` has to say.
const FORMAT: &str = "nephoscope-grid 1";

/// The longest side of a box that does not say how large its unit is, in metres.
const USUAL_SIDE_M: f64 = 1000.0;
/// The shortest side that a box may have here, and the height of the lowest thing above sea level, in metres.
const SHORTEST_SIDE_M: f64 = 10.0;
const LIFT_M: f64 = 1000.0;

/// The description, as the file has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GridDescription {
    /// Which format this is.
    pub format: String,
    /// Name of the cloud.
    #[serde(default)]
    pub name: String,
    /// File of the voxels, beside this one.
    pub values: String,
    /// Lower and upper corner of the box; that of a `.vol` if it is left out.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Metres that one unit of length is; without it the box is scaled and moved to where there is room.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub metres_per_unit: Option<f64>,
    /// Extinction per unit of length where the value is 1.
    #[serde(default = "one")]
    pub extinction_scale: f64,
    /// Share of the extinction that is scattered.
    #[serde(default = "one")]
    pub albedo: f64,
    /// Directions in which is scattered.
    #[serde(default)]
    pub phase: PhaseDescription,
    /// The sun; none without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sun: Option<SunDescription>,
    /// Radiance of the sky.
    #[serde(default)]
    pub sky_radiance: Rgb,
    /// The eye; one that sees the whole box if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraDescription>,
}

fn one() -> f64 {
    1.0
}

/// A number for all colours, or red, green and blue.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Rgb {
    /// The same for all colours.
    Grey(f64),
    /// Linear Rec.709.
    Coloured([f64; 3]),
}

impl Default for Rgb {
    fn default() -> Self {
        Self::Grey(0.0)
    }
}

/// A phase function.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PhaseDescription {
    /// Its name in presets; isotropic without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<PhaseKind>,
    /// Anisotropy.
    #[serde(default)]
    pub g: f64,
    /// Anisotropy of the second lobe.
    #[serde(default)]
    pub back_g: f64,
    /// Share of the second lobe.
    #[serde(default)]
    pub back_mix: f64,
}

/// A sun so far away that its light is parallel.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SunDescription {
    /// Irradiance of a surface that faces it.
    pub irradiance: Rgb,
    /// From the cloud towards the sun; of any length.
    pub towards: [f64; 3],
}

/// A camera that looks at a place.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraDescription {
    /// Where it is.
    pub origin: [f64; 3],
    /// What it looks at.
    pub target: [f64; 3],
    /// What is up in the picture, as nearly as can be.
    #[serde(default = "upright")]
    pub up: [f64; 3],
    /// Angle that the picture spans from left to right, in degrees.
    pub fov_x_deg: f64,
}

fn upright() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

/// How the file's lengths become the world's.
struct Placement {
    metres: f64,
    offset_m: DVec3,
}

impl Placement {
    fn place(&self, at: [f64; 3]) -> DVec3 {
        DVec3::from(at) * self.metres + self.offset_m
    }
}

/// Opens a description and the voxels that it names.
///
/// # Errors
/// If either cannot be read, or says something that cannot be drawn.
pub(super) fn open(path: &Path) -> Result<Preset, FileError> {
    let refused = |reason: String| FileError::Grid { path: path.to_owned(), reason };
    let description: GridDescription = serde_json::from_str(&read_text(path)?)
        .map_err(|error| refused(format!("{error}; docs/grid.md lists what it may say")))?;
    if description.format != FORMAT {
        return Err(refused(format!("its format is {:?}, but only {FORMAT:?} is known", description.format)));
    }
    let values = folder_of(path).join(&description.values);
    let (grid, own_box) = VoxelGrid::read(&values)?;
    let bounds = description.bounds.or(own_box.map(|bounds| bounds.map(|corner| corner.map(f64::from))));
    let bounds = bounds.ok_or_else(|| refused("it has no box, and an .npy has none either; give box".to_owned()))?;
    let scene = scene(&description, bounds, &grid, &values).map_err(refused)?;
    let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let name = if description.name.is_empty() { stem } else { description.name.clone() };
    Ok(Preset::new(&name, scene))
}

#[allow(clippy::cast_possible_truncation, reason = "parameters are f32, and their ranges are checked")]
fn scene(
    description: &GridDescription,
    bounds: [[f64; 3]; 2],
    grid: &VoxelGrid,
    values: &Path,
) -> Result<Scene, String> {
    let [low, high] = bounds.map(DVec3::from);
    if !(low.is_finite() && high.is_finite() && (high - low).min_element() > 0.0) {
        return Err(format!("box = [{low}, {high}]: the second corner has to lie above the first on all three axes"));
    }
    positive("extinction_scale", description.extinction_scale, true)?;
    if !(0.0..=1.0).contains(&description.albedo) {
        return Err(format!("albedo = {} is outside 0 ..= 1", description.albedo));
    }
    let camera = match description.camera {
        Some(camera) => checked(camera)?,
        None => before(low, high),
    };
    let peak = description.extinction_scale * f64::from(grid.greatest());
    let placement = placement(description, [low, high], camera.origin, peak)?;
    let (base, top) = (placement.place(low.into()), placement.place(high.into()));
    let per_metre = peak / placement.metres;
    let mut scene = Scene {
        layers: vec![CloudLayer {
            model: DensityModel::Grid,
            grid: FileName(values.display().to_string()),
            base_m: base.y as f32,
            top_m: top.y as f32,
            scattering_per_m: (per_metre * description.albedo) as f32,
            absorption_per_m: (per_metre * (1.0 - description.albedo)) as f32,
            phase: phase(&description.phase),
            ..CloudLayer::default()
        }],
        plain_light: light(description)?,
        ..Scene::default()
    };
    let domain = &mut scene.domain;
    domain.kind = DomainKind::Box;
    (domain.box_east_m, domain.box_south_m) = ((0.5 * (base.x + top.x)) as f32, (0.5 * (base.z + top.z)) as f32);
    (domain.box_width_m, domain.box_length_m) = ((top.x - base.x) as f32, (top.z - base.z) as f32);
    if let Some(sun) = description.sun {
        let towards = DVec3::from(sun.towards);
        if !(towards.is_finite() && towards.length() > 0.0) {
            return Err(format!("sun.towards = {:?} is no direction", sun.towards));
        }
        let towards = towards.normalize();
        scene.sun.elevation_deg = towards.y.asin().to_degrees() as f32;
        scene.sun.azimuth_deg = towards.x.atan2(-towards.z).to_degrees().rem_euclid(360.0) as f32;
    }
    let eye = placement.place(camera.origin);
    let towards = DVec3::from(camera.target) - DVec3::from(camera.origin);
    let lens = &mut scene.camera;
    (lens.east_m, lens.height_m, lens.south_m) = (eye.x as f32, eye.y as f32, eye.z as f32);
    lens.look(towards.normalize().as_vec3(), DVec3::from(camera.up).normalize().as_vec3());
    lens.field_of_view_deg = camera.fov_x_deg as f32;
    lens.field_of_view_axis = FieldOfViewAxis::Horizontal;
    let display = &mut scene.display;
    // A white surface that faces the sun is shown as one.
    let white =
        f64::from(scene.plain_light.sun_irradiance) / std::f64::consts::PI + f64::from(scene.plain_light.sky_radiance);
    display.exposure_ev = (white.max(1e-3) / 1.2).log2().clamp(-12.0, 24.0) as f32;
    display.white_kelvin = 6500.0;
    let problems = edit::faults(&scene).iter().map(ToString::to_string).chain(scene.problems()).next();
    match problems {
        Some(problem) => Err(format!(
            "it does not fit the program's world ({problem}); one unit is {} m here, say another with metres_per_unit",
            placement.metres
        )),
        None => Ok(scene),
    }
}

fn positive(name: &str, value: f64, zero: bool) -> Result<(), String> {
    let is_sound = value.is_finite() && (value > 0.0 || zero && value == 0.0);
    let wanted = if zero { "a finite number that is not negative" } else { "a finite number above 0" };
    if is_sound { Ok(()) } else { Err(format!("{name} = {value}, but it has to be {wanted}")) }
}

fn checked(camera: CameraDescription) -> Result<CameraDescription, String> {
    let towards = DVec3::from(camera.target) - DVec3::from(camera.origin);
    let up = DVec3::from(camera.up);
    if !(towards.is_finite() && towards.length() > 0.0) {
        return Err("camera.target lies where camera.origin lies, or one of them is not finite".to_owned());
    }
    if !(up.is_finite() && up.cross(towards).length() > 1e-9 * up.length() * towards.length()) {
        return Err(format!("camera.up = {:?} is no direction across the line of sight", camera.up));
    }
    if !(1.0..=150.0).contains(&camera.fov_x_deg) {
        return Err(format!("camera.fov_x_deg = {} is outside 1 ..= 150", camera.fov_x_deg));
    }
    Ok(camera)
}

/// A camera that sees the whole box.
fn before(low: DVec3, high: DVec3) -> CameraDescription {
    let middle = 0.5 * (low + high);
    let origin = middle + DVec3::new(0.45, 0.15, 1.0).normalize() * 1.6 * (high - low).length();
    CameraDescription { origin: origin.into(), target: middle.into(), up: upright(), fov_x_deg: 40.0 }
}

/// Scales and moves the box so that everything lies in the ranges of the parameters.
fn placement(
    description: &GridDescription,
    [low, high]: [DVec3; 2],
    eye: [f64; 3],
    peak: f64,
) -> Result<Placement, String> {
    if let Some(metres) = description.metres_per_unit {
        positive("metres_per_unit", metres, false)?;
        return Ok(Placement { metres, offset_m: DVec3::ZERO });
    }
    let sides = high - low;
    // The extinction per metre has a limit as well: 1.
    let metres = (USUAL_SIDE_M / sides.max_element()).max(SHORTEST_SIDE_M / sides.min_element()).max(peak);
    let middle = 0.5 * (low + high) * metres;
    let lowest = low.y.min(eye[1]) * metres;
    Ok(Placement { metres, offset_m: DVec3::new(-middle.x, LIFT_M - lowest, -middle.z) })
}

#[allow(clippy::cast_possible_truncation, reason = "parameters are f32, and their ranges are checked")]
fn phase(description: &PhaseDescription) -> Phase {
    Phase {
        kind: description.kind.unwrap_or(PhaseKind::Isotropic),
        g: description.g as f32,
        back_g: description.back_g as f32,
        back_mix: description.back_mix as f32,
    }
}

#[allow(clippy::cast_possible_truncation, reason = "parameters are f32, and their ranges are checked")]
fn light(description: &GridDescription) -> Result<PlainLight, String> {
    let split = |name: &str, rgb: Rgb| {
        let rgb = match rgb {
            Rgb::Grey(value) => [value; 3],
            Rgb::Coloured(rgb) => rgb,
        };
        rgb.iter().try_for_each(|value| positive(name, *value, true))?;
        let strength = rgb.into_iter().fold(0.0, f64::max);
        let [r, g, b] = rgb.map(|value| if strength > 0.0 { (value / strength) as f32 } else { 1.0 });
        Ok::<_, String>((strength as f32, Colour(r, g, b)))
    };
    let sun = description.sun.map_or(Rgb::default(), |sun| sun.irradiance);
    let (sun_irradiance, sun_colour) = split("sun.irradiance", sun)?;
    let (sky_radiance, sky_colour) = split("sky_radiance", description.sky_radiance)?;
    Ok(PlainLight { enabled: true, sun_irradiance, sun_colour, sky_radiance, sky_colour })
}

/// Which files of voxels are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoxelFormat {
    /// `NumPy`'s.
    Npy,
    /// Mitsuba's.
    Vol,
    /// Both; the description names `NumPy`'s.
    Both,
}

/// Writes voxels of extinction in 1/m, in a box of the world, with a description of the scene's light and camera. Returns
/// the files, the description first.
///
/// # Errors
/// If a file cannot be written.
pub fn save_grid(
    path: &Path,
    (grid, bounds): (&VoxelGrid, Bounds),
    preset: &Preset,
    (format, size): (VoxelFormat, [u32; 2]),
) -> Result<Vec<PathBuf>, FileError> {
    let mut files = vec![path.to_owned()];
    let mut write = |extension: &str, values: &dyn Fn(&mut dyn std::io::Write) -> std::io::Result<()>| {
        let beside = path.with_extension(extension);
        write_atomically(&beside, |mut writer| {
            values(&mut writer).map_err(|error| ExportError::writing(&beside, error))
        })?;
        files.push(beside);
        Ok::<_, ExportError>(())
    };
    if format != VoxelFormat::Vol {
        write("npy", &|mut to| grid.write_npy(&mut to))?;
    }
    if format != VoxelFormat::Npy {
        write("vol", &|mut to| grid.write_vol(bounds, &mut to))?;
    }
    let values = files[1].file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let description = describe(preset, values, bounds, size);
    let text = serde_json::to_string_pretty(&description).unwrap_or_else(|error| unreachable!("plain data: {error}"));
    write_text(path, &format!("{text}\n"))?;
    Ok(files)
}

/// Writes voxels in a box of the world as an `OpenVDB` fog volume.
///
/// # Errors
/// If the file cannot be written.
pub fn save_vdb(path: &Path, (grid, bounds): (&VoxelGrid, Bounds), options: VdbOptions) -> Result<(), FileError> {
    Ok(write_atomically(path, |mut writer| {
        grid.write_vdb(bounds, options, &mut writer).map_err(|error| ExportError::writing(path, error))
    })?)
}

/// What a scene says of a box of its clouds: the layer that comes first speaks for all.
fn describe(preset: &Preset, values: String, bounds: Bounds, [width, height]: [u32; 2]) -> GridDescription {
    let scene = &preset.scene;
    let layer = scene.visible_layers().next().cloned().unwrap_or_default();
    let (sun, plain) = (scene.towards_sun(), &scene.plain_light);
    let (irradiance, sky) = if plain.enabled {
        (plain.sun_colour.vec() * plain.sun_irradiance, plain.sky_colour.vec() * plain.sky_radiance)
    } else {
        (scene.sun.colour.vec() * scene.sun.illuminance_klx, glam::Vec3::ZERO)
    };
    let rgb = |colour: glam::Vec3| Rgb::Coloured(colour.to_array().map(f64::from));
    let eye = DVec3::new(scene.camera.east_m.into(), scene.camera.height_m.into(), scene.camera.south_m.into());
    let [forward, _, up] = scene.camera.axes().map(glam::Vec3::as_dvec3);
    let across = scene.camera.half_tangents([width, height])[0];
    GridDescription {
        format: FORMAT.to_owned(),
        name: preset.name.clone(),
        values,
        bounds: Some(bounds.map(|corner| corner.map(f64::from))),
        metres_per_unit: Some(1.0),
        extinction_scale: 1.0,
        albedo: f64::from(layer.scattering()) / f64::from(layer.extinction_per_m()),
        phase: PhaseDescription {
            kind: Some(layer.phase.kind),
            g: layer.phase.g.into(),
            back_g: layer.phase.back_g.into(),
            back_mix: layer.phase.back_mix.into(),
        },
        sun: Some(SunDescription { irradiance: rgb(irradiance), towards: sun.as_dvec3().into() }),
        sky_radiance: rgb(sky),
        camera: Some(CameraDescription {
            origin: eye.into(),
            target: (eye + forward * 1000.0).into(),
            up: up.into(),
            fov_x_deg: f64::from(2.0 * across.atan().to_degrees()).min(150.0),
        }),
    }
}

#[cfg(test)]
mod tests;
