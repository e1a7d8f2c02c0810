//! The hard cases of volumetric rendering through the whole program, on whatever driver it runs: each has a symptom
//! that some renderer has shown, and a figure that says whether this one does.

use super::{Check, VerifyError, models};
use crate::render::{LinearImage, Renderer};
use crate::scene::{
    CloudLayer, DensityModel, DomainKind, Frame, MapEdge, Output, Phase, PhaseKind, PlainLight, Projection, Quality,
    Scene, UpdateFraction,
};

pub(super) const SIZE: [u32; 2] = [32, 18];

/// What a case found: what was expected, what was measured, and whether that will do.
pub(super) struct Finding {
    expected: String,
    measured: String,
    holds: bool,
}

impl Finding {
    /// A figure that has to stay below a limit.
    fn below(figure: f64, limit: f64, what: &str) -> Self {
        let holds = figure <= limit;
        Self { expected: format!("{what} at most {limit:.1e}"), measured: format!("{figure:.1e}"), holds }
    }

    pub(super) fn that(holds: bool, expected: &str, measured: impl Into<String>) -> Self {
        Self { expected: expected.to_owned(), measured: measured.into(), holds }
    }
}

/// Share of the light of a low sun that may be left when it is 9° below the horizon.
const NIGHT: f64 = 2e-4;

type Case = fn(&mut Renderer) -> Result<Finding, VerifyError>;

/// All cases: a name, and what tries it.
const CASES: [(&str, Case); 23] = [
    ("extinction towards 0", thin_cloud),
    ("extinction without end", thick_cloud),
    ("phase functions towards their poles", sharp_phases),
    ("the eye on and about both boundaries", boundaries),
    ("the sun through the horizon", sunset),
    ("grazing rays from a moving eye", grazing),
    ("a layer without thickness", no_thickness),
    ("coverage 0", no_coverage),
    ("coverage 1 with the sharpest edge", full_coverage),
    ("days of wind", days_of_wind),
    ("far from the world's origin", far_away),
    ("a year, and times before the beginning", any_time),
    ("the smallest pictures", small_pictures),
    ("a cut of the camera", camera_cut),
    ("a sun of physical brightness in half floats", bright_sun),
    ("rays along the faces of a box", box_faces),
    ("as many steps as the panel allows", many_steps),
    ("the poles of panoramas", panoramas),
    ("automata at their ends", models::automata),
    ("shapes of no size and of any", models::shapes),
    ("brushes at their ends", models::paintings),
    ("the grid of sun depth from anywhere", models::sun_grids),
    ("the same picture twice", twice),
];

/// Tries all cases.
///
/// # Errors
/// [`VerifyError::Render`] and [`VerifyError::Gpu`].
pub fn hard_cases(renderer: &mut Renderer) -> Result<Vec<Check>, VerifyError> {
    let mut checks = Vec::new();
    for (name, case) in CASES {
        renderer.forget_history();
        let Finding { expected, measured, holds } = case(renderer)?;
        checks.push(Check { name: format!("hard case: {name}"), holds, figure: format!("{measured}; {expected}") });
    }
    Ok(checks)
}

/// What a still shows: its light, and the clouds with their transmittance.
pub(super) struct Shown {
    image: LinearImage,
    clouds: Vec<[f32; 4]>,
}

impl Shown {
    /// The first value that is no light, or no transmittance.
    pub(super) fn fault(&self) -> Option<f32> {
        let is_light = |value: &&f32| !(value.is_finite() && **value >= 0.0);
        let light = self.image.rgba.iter().chain(&self.clouds).flatten().find(is_light);
        light.or_else(|| self.clouds.iter().map(|cloud| &cloud[3]).find(|t| **t > 1.0)).copied()
    }

    pub(super) fn opacity(&self) -> f64 {
        self.clouds.iter().map(|cloud| 1.0 - f64::from(cloud[3])).sum::<f64>() / self.clouds.len().max(1) as f64
    }

    pub(super) fn mean(&self) -> f64 {
        let light = self.image.rgba.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>();
        light / self.image.rgba.len().max(1) as f64
    }

    /// Root mean square of the difference in light, relative to the other's mean.
    fn difference(&self, other: &Self) -> f64 {
        let pairs = self.image.rgba.iter().zip(&other.image.rgba);
        let squares: f64 = pairs.map(|(a, b)| f64::from(a[1] - b[1]).powi(2)).sum();
        (squares / self.image.rgba.len().max(1) as f64).sqrt() / other.mean().max(f64::MIN_POSITIVE)
    }
}

pub(super) fn show_at(
    renderer: &mut Renderer,
    (scene, quality): (&Scene, &Quality),
    size: [u32; 2],
    time_secs: f64,
) -> Result<Shown, VerifyError> {
    renderer.render(&Frame { scene, quality, size, time_secs, output: Output::Linear, window: None })?;
    Ok(Shown { image: renderer.linear()?, clouds: renderer.clouds()? })
}

pub(super) fn show(renderer: &mut Renderer, scene: &Scene, quality: &Quality) -> Result<Shown, VerifyError> {
    show_at(renderer, (scene, quality), SIZE, 0.0)
}

pub(super) fn quality() -> Quality {
    Quality {
        view_steps: 96,
        light_steps: 6,
        light_grid: 0,
        update: UpdateFraction::Full,
        shadow_map_px: 32,
        ..Quality::default()
    }
}

/// A sky whose cloud is a slab, the same everywhere, seen straight up in plain light that is scattered once.
fn slab(extinction_per_m: f32) -> Scene {
    let mut scene = Scene::default();
    scene.domain.kind = DomainKind::Flat;
    scene.weather.coverage = 1.0;
    (scene.camera.pitch_deg, scene.camera.field_of_view_deg, scene.camera.height_m) = (90.0, 1.0, 0.0);
    scene.plain_light = PlainLight { enabled: true, sun_irradiance: 1.0, sky_radiance: 0.0, ..PlainLight::default() };
    scene.sun.elevation_deg = 90.0;
    (scene.scattering.ambient, scene.ground.visible) = (0.0, false);
    scene.layers = vec![CloudLayer {
        model: DensityModel::Uniform,
        base_m: 1000.0,
        top_m: 2000.0,
        scattering_per_m: extinction_per_m,
        phase: Phase { kind: PhaseKind::Isotropic, ..Phase::default() },
        ..CloudLayer::default()
    }];
    scene
}

fn once() -> Quality {
    Quality { octaves: 0, light_share: 0.0, early_exit: 0.0, ..quality() }
}

fn thin_cloud(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let mut worst = 0.0_f64;
    for depth in [1e-7_f32, 1e-6, 1e-5, 1e-4, 1e-3] {
        let seen = show(renderer, &slab(depth / 1000.0), &once())?;
        let expected = f64::from(depth) / (4.0 * std::f64::consts::PI);
        let light = seen.clouds.iter().map(|cloud| f64::from(cloud[1])).sum::<f64>() / seen.clouds.len() as f64;
        worst = worst.max((light / expected - 1.0).abs());
    }
    Ok(Finding::below(worst, 0.01, "light off that of a thin slab, relative,"))
}

fn thick_cloud(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let (mut least, mut greatest) = (f64::INFINITY, 0.0_f64);
    for density in [0.1, 1.0, 10.0] {
        let mut scene = slab(1.0);
        scene.layers[0].density = density;
        // The sun stands behind the eye: its light comes from the surface.
        (scene.camera.height_m, scene.camera.pitch_deg) = (3000.0, -90.0);
        let seen = show(renderer, &scene, &once())?;
        if let Some(fault) = seen.fault() {
            return Ok(Finding::that(false, "finite light", fault.to_string()));
        }
        let light = seen.clouds.iter().map(|cloud| f64::from(cloud[1])).sum::<f64>() / seen.clouds.len() as f64;
        // All of it at the surface would send p times its irradiance; a half space sends half of that.
        let relative = light * 4.0 * std::f64::consts::PI;
        (least, greatest) = (least.min(relative), greatest.max(relative));
    }
    let holds = least > 0.35 && greatest < 1.01;
    Ok(Finding::that(
        holds,
        "light of a half space, 0.5, to that of a surface, 1, or a little less",
        format!("{least:.3} to {greatest:.3}"),
    ))
}

fn sharp_phases(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let mut tried = 0;
    for kind in [PhaseKind::HenyeyGreenstein, PhaseKind::TwoLobe, PhaseKind::CornetteShanks, PhaseKind::Schlick] {
        for g in [-0.99, -1e-4, 0.0, 1e-4, 0.9, 0.99] {
            for pitch_deg in [90.0, 0.0] {
                let mut scene = slab(1e-3);
                scene.layers[0].phase = Phase { kind, g, back_g: -g, back_mix: 0.5 };
                (scene.camera.pitch_deg, scene.camera.field_of_view_deg) = (pitch_deg, 2.0);
                scene.sun.elevation_deg = pitch_deg;
                scene.sun.azimuth_deg = scene.camera.heading_deg;
                if let Some(fault) = show(renderer, &scene, &once())?.fault() {
                    let name = format!("{kind:?}, g {g}: {fault}");
                    return Ok(Finding::that(false, "finite light towards the sun", name));
                }
                tried += 1;
            }
        }
    }
    Ok(Finding::that(true, "finite light towards the sun", format!("{tried} functions")))
}

fn boundaries(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let mut worst = 0.0_f64;
    for kind in [DomainKind::Shell, DomainKind::Flat] {
        for boundary_m in [1000.0_f32, 2000.0] {
            for pitch_deg in [-60.0, -2.0, 0.0, 2.0, 60.0] {
                let mut before: Option<Shown> = None;
                for off_m in [-0.05, 0.0, 0.05] {
                    let mut scene = slab(1e-3);
                    scene.domain.kind = kind;
                    (scene.sun.elevation_deg, scene.camera.field_of_view_deg) = (50.0, 20.0);
                    (scene.camera.height_m, scene.camera.pitch_deg) = (boundary_m + off_m, pitch_deg);
                    let quality = Quality { step_m: 20.0, view_steps: 1024, ..once() };
                    let seen = show(renderer, &scene, &quality)?;
                    if let Some(fault) = seen.fault() {
                        return Ok(Finding::that(false, "finite light", format!("{:?}: {fault}", scene.camera)));
                    }
                    if let Some(before) = before {
                        worst = worst.max((seen.opacity() - before.opacity()).abs());
                    }
                    before = Some(seen);
                }
            }
        }
    }
    Ok(Finding::below(worst, 0.02, "opacity that a step of 5 cm changes"))
}

fn sunset(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let (mut before, mut worst, mut all) = (None, 0.0_f64, Vec::new());
    for step in 0..=48 {
        let mut scene = Scene::default();
        scene.sun.elevation_deg = 3.0 - 0.25 * step as f32;
        scene.moon.enabled = false;
        let seen = show(renderer, &scene, &quality())?;
        if let Some(fault) = seen.fault() {
            return Ok(Finding::that(false, "finite light", format!("at {}°: {fault}", scene.sun.elevation_deg)));
        }
        let light = seen.mean() * f64::from(seen.image.candela_per_unit);
        all.push(light);
        if let Some(before) = before.replace(light) {
            // Brighter with less sun, or a fall too steep for twilight.
            worst = worst.max((light / before - 1.0).max(before / light - 1.35));
        }
    }
    let left = all.last().copied().unwrap_or(0.0) / all.first().copied().unwrap_or(1.0);
    let holds = worst <= 0.02 && left < NIGHT;
    let expected =
        "no rise by a fiftieth, no fall by more than a quarter, in steps of a quarter degree, and night at the end";
    Ok(Finding::that(holds, expected, format!("{worst:.1e} beyond that, {left:.1e} left")))
}

fn grazing(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let mut worst = 0.0_f64;
    for height_m in [2.0, 3500.0] {
        let at = |renderer: &mut Renderer, east_m: f32| {
            let mut scene = Scene::default();
            let camera = &mut scene.camera;
            (camera.height_m, camera.east_m, camera.pitch_deg, camera.field_of_view_deg) = (height_m, east_m, 1.0, 6.0);
            show_at(renderer, (&scene, &quality()), [64, 36], 0.0)
        };
        let (here, there) = (at(renderer, 0.0)?, at(renderer, 2.0)?);
        worst = worst.max(there.difference(&here));
    }
    Ok(Finding::below(worst, 0.08, "change of the picture for 2 m, relative RMS,"))
}

/// Whether a change leaves the picture without clouds, in every bit.
fn is_bare(renderer: &mut Renderer, change: fn(&mut Scene)) -> Result<Finding, VerifyError> {
    let mut bare = Scene::default();
    bare.layers.clear();
    let mut scene = Scene::default();
    change(&mut scene);
    let (seen, expected) = (show(renderer, &scene, &quality())?, show(renderer, &bare, &quality())?);
    let bits = |shown: &Shown| -> Vec<[u32; 4]> { shown.image.rgba.iter().map(|p| p.map(f32::to_bits)).collect() };
    let other = bits(&seen).iter().zip(bits(&expected)).filter(|(a, b)| **a != *b).count();
    Ok(Finding::that(other == 0, "the sky behind it, bit for bit", format!("{other} pixels differ")))
}

fn no_thickness(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    is_bare(renderer, |scene| scene.layers[0].top_m = scene.layers[0].base_m)
}

fn no_coverage(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    is_bare(renderer, |scene| scene.weather.coverage = 0.0)
}

fn full_coverage(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let mut scene = slab(1e-3);
    scene.layers[0].edge_softness = 0.02;
    let seen = show(renderer, &scene, &once())?;
    Ok(Finding::below((seen.opacity() - (1.0 - (-1.0_f64).exp())).abs(), 1e-3, "opacity off that of a slab"))
}

/// A sky whose map and noises all repeat after 24 km.
fn periodic() -> Scene {
    let mut scene = Scene::default();
    (scene.weather.size_m, scene.weather.edge) = (24_000.0, MapEdge::Repeat);
    (scene.weather.moves, scene.weather.evolution_secs) = (true, 0.0);
    scene.domain.kind = DomainKind::Flat;
    (scene.ground.visible, scene.weather.coverage) = (false, 0.5);
    (scene.wind.speed_mps, scene.wind.from_deg, scene.wind.rise_mps) = (20.0, 270.0, 0.0);
    (scene.wind.shape_speed, scene.wind.detail_speed) = (1.0, 1.0);
    let layer = &mut scene.layers[0];
    (layer.shape_size_m, layer.detail_size_m, layer.curl_size_m) = (2400.0, 320.0, 1500.0);
    (layer.map_scale, layer.wind_scale) = (1.0, 1.0);
    scene
}

fn days_of_wind(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let of = (periodic(), quality());
    let first = show_at(renderer, (&of.0, &of.1), SIZE, 0.0)?;
    let mut worst = 0.0_f64;
    // 1200 s are one tile; a million of them are 38 years.
    for tiles in [1.0, 1e3, 1e6] {
        worst = worst.max(show_at(renderer, (&of.0, &of.1), SIZE, 1200.0 * tiles)?.difference(&first));
    }
    Ok(Finding::below(worst, 1e-5, "change after whole tiles of wind, relative RMS,"))
}

fn far_away(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let first = show(renderer, &periodic(), &quality())?;
    let mut worst = 0.0_f64;
    for tiles in [1.0_f32, 40.0] {
        let mut scene = periodic();
        (scene.camera.east_m, scene.camera.south_m) = (24_000.0 * tiles, -24_000.0 * tiles);
        worst = worst.max(show(renderer, &scene, &quality())?.difference(&first));
    }
    Ok(Finding::below(worst, 1e-5, "change after whole tiles of way, relative RMS,"))
}

fn any_time(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let (scene, quality) = (Scene::default(), quality());
    let mut at = |time_secs: f64| show_at(renderer, (&scene, &quality), SIZE, time_secs);
    let there = at(3.15e7)?;
    for time_secs in [-1.0, 1e-9, -3.15e7, 1e12, 3.15e7 - 1.0] {
        if let Some(fault) = at(time_secs)?.fault() {
            return Ok(Finding::that(false, "finite light", format!("at {time_secs} s: {fault}")));
        }
    }
    let again = at(3.15e7)?;
    Ok(Finding::below(again.difference(&there), 0.0, "change of a moment that was reached otherwise"))
}

fn small_pictures(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let scene = Scene::default();
    let sizes = [[1, 1], [1, 7], [3, 5], [17, 33], [1025, 1]];
    for size in sizes {
        for update in [UpdateFraction::Full, UpdateFraction::Sixteenth] {
            let quality = Quality { update, ..quality() };
            let seen = show_at(renderer, (&scene, &quality), size, 0.0)?;
            let frame =
                Frame { scene: &scene, quality: &quality, size, time_secs: 0.0, output: Output::Display, window: None };
            renderer.render(&frame)?;
            let shown = renderer.clouds()?;
            let is_light = |value: &f32| value.is_finite() && *value >= 0.0;
            if seen.fault().is_some() || !shown.iter().flatten().all(is_light) {
                return Ok(Finding::that(false, "finite light", format!("{size:?}, {update:?}")));
            }
        }
    }
    Ok(Finding::that(true, "finite light", format!("{} sizes", sizes.len())))
}

fn camera_cut(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let quality = Quality { update: UpdateFraction::Quarter, ..quality() };
    let show = |renderer: &mut Renderer, scene: &Scene| -> Result<Vec<[f32; 4]>, VerifyError> {
        renderer.render(&Frame {
            scene,
            quality: &quality,
            size: SIZE,
            time_secs: 0.0,
            output: Output::Display,
            window: None,
        })?;
        Ok(renderer.clouds()?)
    };
    let here = Scene::default();
    let mut there = Scene::default();
    (there.camera.east_m, there.camera.heading_deg) = (9000.0, here.camera.heading_deg + 120.0);
    show(renderer, &here)?;
    let cut = show(renderer, &there)?;
    renderer.forget_history();
    let fresh = show(renderer, &there)?;
    let other = cut.iter().zip(&fresh).filter(|(a, b)| a != b).count();
    Ok(Finding::that(other == 0, "the picture of a first frame", format!("{other} pixels differ")))
}

fn bright_sun(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let mut scene = Scene::default();
    (scene.sun.illuminance_klx, scene.sun.radius_deg) = (1000.0, 0.05);
    (scene.camera.pitch_deg, scene.camera.heading_deg) = (scene.sun.elevation_deg, scene.sun.azimuth_deg);
    (scene.camera.field_of_view_deg, scene.sunshafts.strength) = (5.0, 4.0);
    let quality = Quality { update: UpdateFraction::Sixteenth, ..quality() };
    for _ in 0..3 {
        renderer.render(&Frame {
            scene: &scene,
            quality: &quality,
            size: SIZE,
            time_secs: 0.0,
            output: Output::Display,
            window: None,
        })?;
    }
    let is_light = |value: &f32| value.is_finite() && *value >= 0.0;
    let broken = renderer.clouds()?.iter().flatten().filter(|value| !is_light(value)).count();
    let linear = show(renderer, &scene, &quality)?;
    let holds = broken == 0 && linear.fault().is_none();
    Ok(Finding::that(holds, "finite light", format!("{broken} values broken, mean {:.1e}", linear.mean())))
}

fn box_faces(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let mut tried = 0;
    for (east_m, height_m, heading_deg, pitch_deg) in [
        (4000.0, 1500.0, 0.0, 0.0),
        (-4000.0, 1500.0, 180.0, 0.0),
        (0.0, 1000.0, 90.0, 0.0),
        (0.0, 2000.0, 270.0, 0.0),
        (4000.0, 1000.0, 0.0, 90.0),
        (0.0, 1500.0, 0.0, -90.0),
    ] {
        let mut scene = slab(1e-3);
        scene.domain.kind = DomainKind::Box;
        (scene.domain.box_south_m, scene.sun.elevation_deg) = (0.0, 40.0);
        let camera = &mut scene.camera;
        (camera.east_m, camera.height_m) = (east_m, height_m);
        (camera.heading_deg, camera.pitch_deg, camera.field_of_view_deg) = (heading_deg, pitch_deg, 40.0);
        // An odd size has rays exactly along the axes.
        let seen = show_at(renderer, (&scene, &quality()), [31, 17], 0.0)?;
        if let Some(fault) = seen.fault() {
            return Ok(Finding::that(false, "finite light", format!("{:?}: {fault}", scene.camera)));
        }
        tried += 1;
    }
    Ok(Finding::that(true, "finite light", format!("{tried} views")))
}

fn many_steps(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    // So thin that the light is the same everywhere, in sheets that neighbours meet at different steps.
    let mut scene = slab(1e-7);
    (scene.camera.pitch_deg, scene.camera.field_of_view_deg, scene.sun.elevation_deg) = (14.0, 50.0, 42.0);
    scene.layers = [1000.0, 1100.0, 1230.0, 1390.0]
        .map(|base_m| CloudLayer { base_m, top_m: base_m + 50.0, ..scene.layers[0].clone() })
        .into();
    let with = |light_steps: u32| Quality {
        view_steps: 1024,
        light_steps,
        light_growth: 1.0,
        step_m: 2.0,
        step_growth: 0.0,
        skip_clear: false,
        octaves: 7,
        ..once()
    };
    let (few, many) = (show(renderer, &scene, &with(1))?, show(renderer, &scene, &with(128))?);
    Ok(Finding::below(many.difference(&few), 1e-3, "change of a thin fog by more light steps, relative RMS,"))
}

fn panoramas(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    for projection in [Projection::Equirect, Projection::Dome] {
        for heading_deg in [0.0, 360.0] {
            let mut scene = Scene::default();
            (scene.camera.projection, scene.camera.heading_deg) = (projection, heading_deg);
            (scene.sun.elevation_deg, scene.sunshafts.strength) = (90.0, 1.0);
            if let Some(fault) = show(renderer, &scene, &quality())?.fault() {
                return Ok(Finding::that(false, "finite light", format!("{projection:?}: {fault}")));
            }
        }
    }
    Ok(Finding::that(true, "finite light", "4 panoramas"))
}

fn twice(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let (first, second) =
        (show(renderer, &Scene::default(), &quality())?, show(renderer, &Scene::default(), &quality())?);
    Ok(Finding::below(second.difference(&first), 0.0, "change of a second run"))
}
