//! A scene with each effect, one without it, and scenes in which it changes nothing.

use nephoscope::plan::{Effect, Forced, FramePlan};
use nephoscope::scene::{
    Brush, CloudKind, DensityModel, DomainKind, FieldOfViewAxis, MapEdge, MapLayer, MapSource, Output, PhaseKind,
    Quality, Scene, Shape, ShapeRole, Stroke, Strokes, UpdateFraction,
};

use crate::common::sky::{frame, quick};

pub(super) const SIZE: [u32; 2] = [48, 27];

#[derive(Clone, PartialEq)]
pub(super) struct Setup {
    pub(super) scene: Scene,
    pub(super) quality: Quality,
    pub(super) output: Output,
}

pub(super) type Change = fn(&mut Setup);

impl Setup {
    pub(super) fn new(change: Change) -> Self {
        let mut scene = Scene::default();
        scene.weather.coverage = 0.6;
        let mut setup = Self { scene, quality: quick(), output: Output::Linear };
        change(&mut setup);
        setup
    }

    pub(super) fn plan(&self, forced: Forced) -> FramePlan {
        FramePlan::forced(&frame(&self.scene, &self.quality, SIZE, self.output), forced)
    }

    pub(super) fn all_layers(&mut self, change: impl Fn(&mut nephoscope::scene::CloudLayer)) {
        self.scene.layers.iter_mut().for_each(change);
    }

    /// A camera that looks at a place in the sky.
    pub(super) fn look(&mut self, elevation_deg: f32, azimuth_deg: f32) {
        self.scene.camera.pitch_deg = elevation_deg;
        self.scene.camera.heading_deg = azimuth_deg;
    }
}

/// Scenes that tell about one effect.
pub(super) struct Example {
    /// Calls for it.
    pub(super) on: Change,
    /// Does not.
    pub(super) off: Change,
    /// Could have it and would not look different.
    pub(super) needless: &'static [Change],
    /// Whether the first one looks different without it.
    pub(super) is_seen: bool,
}

pub(super) const fn example(on: Change, off: Change, needless: &'static [Change], is_seen: bool) -> Example {
    Example { on, off, needless, is_seen }
}

pub(super) fn base(_: &mut Setup) {}

pub(super) fn night(s: &mut Setup) {
    s.scene.sun.elevation_deg = -30.0;
    s.scene.display.exposure_ev = -4.0;
}

pub(super) fn at_the_sun(s: &mut Setup) {
    s.scene.weather.coverage = 0.0;
    let sun = s.scene.sun.clone();
    s.scene.camera.field_of_view_deg = 20.0;
    s.look(sun.elevation_deg, sun.azimuth_deg);
}

pub(super) fn away_from_the_sun(s: &mut Setup) {
    s.look(10.0, s.scene.sun.azimuth_deg + 180.0);
}

pub(super) fn at_the_moon(s: &mut Setup) {
    night(s);
    s.scene.weather.coverage = 0.0;
    let moon = s.scene.moon.clone();
    s.scene.camera.field_of_view_deg = 20.0;
    s.look(moon.elevation_deg, moon.azimuth_deg);
}

pub(super) fn away_from_the_moon(s: &mut Setup) {
    night(s);
    s.look(10.0, s.scene.moon.azimuth_deg + 180.0);
}

pub(super) fn mountains(s: &mut Setup) {
    (s.scene.ground.mountains_m, s.scene.camera.pitch_deg) = (2000.0, 2.0);
}

pub(super) fn no_relief(s: &mut Setup) {
    (s.scene.ground.hills_m, s.scene.ground.mountains_m) = (0.0, 0.0);
}

pub(super) fn looking_down(s: &mut Setup) {
    (s.scene.camera.pitch_deg, s.scene.camera.height_m) = (-50.0, 900.0);
    s.scene.weather.coverage = 0.4;
}

pub(super) fn texture(s: &mut Setup) {
    s.all_layers(|layer| layer.model = DensityModel::Texture);
    s.scene.weather.layers.iter_mut().for_each(|map| map.source = MapSource::WeatherTexture);
}

pub(super) fn living(s: &mut Setup) {
    let layer = s.scene.layers.first_mut().expect("there is one");
    layer.model = DensityModel::Automaton;
    (layer.automaton.cells, layer.automaton.levels, layer.automaton.coverage) = (32, 12, 0.7);
    s.scene.weather.coverage = 1.0;
}

pub(super) fn shaped(s: &mut Setup) {
    s.all_layers(|layer| layer.model = DensityModel::Shapes);
    s.scene.camera.pitch_deg = 15.0;
}

pub(super) fn boxed(s: &mut Setup) {
    s.scene.domain.kind = DomainKind::Box;
    s.quality.grid_voxels = 32;
}

pub(super) fn one_lobe(s: &mut Setup) {
    s.all_layers(|layer| layer.phase.kind = PhaseKind::HenyeyGreenstein);
}

pub(super) fn low_sun(s: &mut Setup) {
    s.scene.sunshafts.strength = 1.0;
    (s.scene.sun.elevation_deg, s.scene.sun.azimuth_deg) = (8.0, 90.0);
    s.look(8.0, 90.0);
}

pub(super) fn partial(s: &mut Setup) {
    (s.quality.update, s.output) = (UpdateFraction::Quarter, Output::Display);
}

pub(super) fn shown(s: &mut Setup) {
    s.output = Output::Display;
}

/// Every effect has its scenes here, or this does not compile.
#[allow(clippy::too_many_lines, reason = "a table")]
pub(super) fn scenes(effect: Effect) -> Example {
    match effect {
        Effect::SkyTables => example(base, |s| s.scene.plain_light.enabled = true, &[], false),
        Effect::AirTable => {
            const OFF: Change = |s| (s.scene.ground.visible, s.scene.air.aerial_perspective) = (false, false);
            example(base, OFF, &[OFF], false)
        }
        Effect::SkyLightTable => {
            const OFF: Change = |s| (s.scene.ground.visible, s.scene.scattering.ambient) = (false, 0.0);
            example(base, OFF, &[OFF], false)
        }
        Effect::MoonlitAir => {
            example(night, base, &[base, |s| (s.scene.moon.enabled, s.scene.sun.elevation_deg) = (false, -30.0)], true)
        }
        Effect::SunDisc => {
            const SET: Change = |s| {
                s.scene.sun.elevation_deg = -2.0;
                s.look(3.0, s.scene.sun.azimuth_deg);
            };
            example(at_the_sun, away_from_the_sun, &[away_from_the_sun, SET], true)
        }
        Effect::MoonDisc => example(at_the_moon, away_from_the_moon, &[away_from_the_moon], true),
        Effect::Stars => {
            const ON: Change = |s| {
                night(s);
                (s.scene.weather.coverage, s.scene.camera.pitch_deg) = (0.0, 50.0);
            };
            example(ON, base, &[base], true)
        }
        Effect::Ground => {
            const UP: Change = |s| s.scene.camera.pitch_deg = 80.0;
            example(base, UP, &[UP], true)
        }
        Effect::Terrain => example(
            mountains,
            no_relief,
            &[no_relief, |s| {
                no_relief(s);
                looking_down(s);
            }],
            true,
        ),
        Effect::Solids => {
            const ON: Change = |s| {
                looking_down(s);
                let near = Shape { role: ShapeRole::Solid, south_m: -700.0, height_m: 100.0, ..Shape::default() };
                s.scene.shapes = vec![Shape { width_m: 300.0, length_m: 200.0, tall_m: 400.0, ..near }];
            };
            example(ON, looking_down, &[looking_down, base], true)
        }
        Effect::GroundEverywhere => example(
            looking_down,
            base,
            &[base, |s| {
                mountains(s);
                s.scene.camera.pitch_deg = 25.0;
            }],
            false,
        ),
        Effect::CloudShadows => {
            const OFF: Change = |s| {
                looking_down(s);
                s.scene.ground.cloud_shadows = 0.0;
            };
            example(looking_down, OFF, &[OFF], true)
        }
        Effect::Clouds => {
            const DOWN: Change = |s| (s.scene.camera.pitch_deg, s.scene.camera.height_m) = (-80.0, 900.0);
            const UP: Change = |s| (s.scene.camera.pitch_deg, s.scene.camera.height_m) = (80.0, 9000.0);
            example(base, |s| s.scene.layers.clear(), &[DOWN, UP], true)
        }
        Effect::CloudsEverywhere => {
            const LEVEL: Change = |s| s.scene.camera.pitch_deg = -5.0;
            const ABOVE: Change = |s| (s.scene.camera.pitch_deg, s.scene.camera.height_m) = (-5.0, 6000.0);
            const TILTED: Change = |s| (s.scene.camera.pitch_deg, s.scene.camera.roll_deg) = (-12.0, 25.0);
            const FLAT: Change = |s| (s.scene.camera.pitch_deg, s.scene.domain.kind) = (-5.0, DomainKind::Flat);
            const BOX: Change = |s| (s.scene.camera.pitch_deg, s.scene.domain.kind) = (5.0, DomainKind::Box);
            const PARTIAL: Change = |s| {
                partial(s);
                s.scene.camera.pitch_deg = -7.0;
            };
            const UP: Change = |s| s.scene.camera.pitch_deg = 45.0;
            example(UP, LEVEL, &[LEVEL, ABOVE, TILTED, FLAT, BOX, PARTIAL], false)
        }
        Effect::Profile => {
            const OFF: Change = |s| s.all_layers(|layer| layer.model = DensityModel::Thesis);
            example(base, OFF, &[OFF], true)
        }
        Effect::Thesis => example(|s| s.all_layers(|layer| layer.model = DensityModel::Thesis), base, &[base], true),
        Effect::Uniform => example(|s| s.all_layers(|layer| layer.model = DensityModel::Uniform), base, &[base], true),
        Effect::Texture => example(texture, base, &[base], true),
        Effect::Product => example(
            |s| {
                s.all_layers(|layer| layer.model = DensityModel::Product);
                s.scene.weather.coverage = 0.9;
            },
            base,
            &[base],
            true,
        ),
        Effect::Automaton => example(living, base, &[base], true),
        Effect::Shear => {
            const ON: Change = |s| {
                living(s);
                s.all_layers(|layer| layer.automaton.shear = 1.0);
            };
            example(ON, living, &[living], true)
        }
        Effect::Shapes => example(shaped, base, &[base], true),
        Effect::ShapeNoise => example(base, |s| s.all_layers(|layer| layer.model = DensityModel::Thesis), &[], false),
        Effect::Grid => example(
            |s| {
                s.all_layers(|layer| layer.model = DensityModel::Grid);
                s.scene.domain.kind = DomainKind::Box;
            },
            base,
            &[],
            false,
        ),
        Effect::Baked => example(boxed, base, &[], false),
        Effect::WeatherMap => example(base, |s| s.scene.layers.clear(), &[], false),
        Effect::GrowingMap => example(
            |s| {
                let layer = &mut s.scene.weather.layers[0];
                layer.source = MapSource::Grown;
                layer.image.0 = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/heaps.png").to_owned();
            },
            base,
            &[],
            false,
        ),
        Effect::Flows => {
            const ON: Change = |s| {
                let whirl = MapLayer { flow_begun_secs: 300.0, flow_mps: 30.0, ..MapLayer::default() };
                s.scene.weather.layers.push(MapLayer { source: MapSource::Flow, ..whirl });
            };
            const STANDS: Change = |s| {
                ON(s);
                s.scene.weather.layers[1].flow_mps = 0.0;
            };
            example(ON, STANDS, &[STANDS], true)
        }
        Effect::Painting => example(
            |s| {
                let dabs = (0..40).map(|i| [0.1 * (i % 8) as f32, 0.2 * (i / 8) as f32]).collect();
                let stroke = Stroke {
                    brush: Brush::Erase,
                    kind: CloudKind::Cumulus,
                    radius: 0.2,
                    strength: 1.0,
                    softness: 0.5,
                    amount: 1.0,
                    dabs,
                };
                let strokes = Strokes(vec![std::sync::Arc::new(stroke)]);
                s.scene.weather.layers.push(MapLayer { source: MapSource::Painted, strokes, ..MapLayer::default() });
            },
            |s| {
                let unpainted = MapLayer { source: MapSource::Painted, ..MapLayer::default() };
                s.scene.weather.layers.push(unpainted);
            },
            &[base],
            true,
        ),
        Effect::Detail => {
            const OFF: Change = |s| s.all_layers(|layer| layer.detail_strength = 0.0);
            example(base, OFF, &[OFF], true)
        }
        Effect::Curl => {
            const ON: Change = |s| {
                s.all_layers(|layer| layer.curl_m = 400.0);
                (s.scene.camera.height_m, s.scene.camera.pitch_deg) = (1300.0, 10.0);
            };
            const OFF: Change = |s| s.all_layers(|layer| layer.curl_m = 0.0);
            example(ON, OFF, &[OFF], true)
        }
        Effect::Front => {
            const ON: Change = |s| {
                (s.scene.weather.coverage_changes, s.scene.weather.coverage_change_to) = (true, 1.0);
                (s.scene.weather.front_distance_m, s.scene.weather.front_width_m) = (2000.0, 1000.0);
            };
            const SAME: Change = |s| {
                (s.scene.weather.coverage_changes, s.scene.weather.coverage_change_to) = (true, 0.6);
            };
            example(ON, |s| s.scene.weather.coverage_changes = false, &[SAME], true)
        }
        Effect::ClearWays => {
            example(|s| s.scene.weather.coverage = 0.3, |s| s.scene.weather.edge = MapEdge::Clamp, &[], true)
        }
        Effect::KeyLight => {
            const OFF: Change = |s| s.all_layers(|layer| layer.phase_gain = 0.0);
            const SET: Change = |s| {
                (s.scene.sun.elevation_deg, s.scene.moon.enabled) = (-5.6, false);
                s.scene.display.exposure_ev = 0.0;
            };
            const DARK: Change = |s| {
                night(s);
                s.scene.moon.enabled = false;
            };
            example(base, OFF, &[OFF, SET, DARK], true)
        }
        Effect::SunGrid => {
            const ON: Change = |s| {
                (s.quality.light_steps, s.quality.light_grid) = (12, 160);
                s.scene.sun.elevation_deg = 12.0;
            };
            example(ON, |s| s.quality.light_grid = 0, &[], true)
        }
        Effect::Octaves => {
            example(base, |s| s.quality.octaves = 0, &[|s| s.scene.scattering.octave_energy = 0.0], true)
        }
        Effect::HenyeyGreenstein => example(one_lobe, base, &[base], true),
        Effect::TwoLobes => {
            const OFF: Change = |s| s.all_layers(|layer| layer.phase.back_mix = 0.0);
            example(base, OFF, &[OFF, one_lobe], true)
        }
        Effect::CornetteShanks => {
            example(|s| s.all_layers(|layer| layer.phase.kind = PhaseKind::CornetteShanks), base, &[base], true)
        }
        Effect::Schlick => {
            example(|s| s.all_layers(|layer| layer.phase.kind = PhaseKind::Schlick), base, &[base], true)
        }
        Effect::Rayleigh => {
            const ON: Change = |s| {
                s.all_layers(|layer| layer.phase.kind = PhaseKind::Rayleigh);
                away_from_the_sun(s);
            };
            example(ON, base, &[base], true)
        }
        Effect::Ambient => {
            const OFF: Change = |s| s.scene.scattering.ambient = 0.0;
            const BLACK: Change = |s| {
                s.scene.plain_light.enabled = true;
                s.scene.plain_light.sky_radiance = 0.0;
            };
            example(base, OFF, &[OFF, BLACK], true)
        }
        Effect::Air => {
            const EMPTY: Change = |s| (s.scene.air.haze, s.scene.air.molecules, s.scene.air.ozone) = (0.0, 0.0, 0.0);
            example(base, |s| s.scene.air.aerial_perspective = false, &[EMPTY], true)
        }
        Effect::Distance => example(base, shown, &[shown], false),
        Effect::Temporal => example(partial, shown, &[], true),
        Effect::Glow => {
            const ON: Change = |s| {
                low_sun(s);
                s.scene.sunshafts.strength = 0.0;
                (s.scene.scattering.glow, s.scene.scattering.glow_deg) = (2.0, 60.0);
            };
            const OFF: Change = |s| {
                ON(s);
                s.scene.scattering.glow = 0.0;
            };
            example(ON, OFF, &[OFF, base], true)
        }
        Effect::Sunshafts => {
            const OFF: Change = |s| {
                low_sun(s);
                s.scene.sunshafts.strength = 0.0;
            };
            const BEHIND: Change = |s| {
                low_sun(s);
                s.look(8.0, 270.0);
            };
            const ASIDE: Change = |s| {
                low_sun(s);
                (s.scene.camera.field_of_view_axis, s.scene.camera.field_of_view_deg) =
                    (FieldOfViewAxis::Horizontal, 60.0);
                s.scene.sunshafts.length_deg = 90.0;
                s.look(8.0, 90.0 + 145.0);
            };
            const SET: Change = |s| {
                low_sun(s);
                s.scene.sun.elevation_deg = -2.0;
            };
            example(low_sun, OFF, &[OFF, BEHIND, ASIDE, SET], true)
        }
        Effect::Grading => {
            const ON: Change = |s| s.scene.display.contrast = 1.5;
            const OFF: Change = |s| (s.scene.display.contrast, s.scene.display.saturation) = (1.0, 1.0);
            example(ON, OFF, &[OFF], true)
        }
    }
}

/// Scenes in which an effect only just runs: a rule that leaves it out a little too early changes them.
pub(super) fn borders(effect: Effect) -> &'static [Change] {
    match effect {
        Effect::Sunshafts => &[|s| {
            low_sun(s);
            s.scene.weather.coverage = 0.1;
            (s.scene.sunshafts.strength, s.scene.sunshafts.length_deg) = (4.0, 90.0);
            (s.scene.camera.field_of_view_axis, s.scene.camera.field_of_view_deg) = (FieldOfViewAxis::Horizontal, 90.0);
            s.look(8.0, 90.0 + 110.0);
        }],
        Effect::SunDisc => &[|s| {
            at_the_sun(s);
            let sun = s.scene.sun.clone();
            s.scene.camera.field_of_view_deg = 20.0;
            s.look(sun.elevation_deg - 7.0, sun.azimuth_deg + 12.0);
        }],
        Effect::MoonlitAir => &[|s| (s.scene.sun.elevation_deg, s.scene.display.exposure_ev) = (-8.0, 0.0)],
        Effect::Stars => &[|s| {
            s.scene.sun.elevation_deg = -8.0;
            (s.scene.weather.coverage, s.scene.camera.pitch_deg, s.scene.display.exposure_ev) = (0.0, 50.0, -2.0);
        }],
        Effect::Ground => &[|s| (s.scene.camera.pitch_deg, s.scene.camera.field_of_view_deg) = (24.0, 50.0), mountains],
        Effect::Clouds => &[
            |s| (s.scene.camera.pitch_deg, s.scene.weather.coverage) = (-23.0, 1.0),
            |s| (s.scene.camera.pitch_deg, s.scene.camera.height_m, s.scene.weather.coverage) = (20.0, 9000.0, 1.0),
        ],
        Effect::KeyLight => &[|s| {
            (s.scene.sun.elevation_deg, s.scene.moon.enabled) = (-1.0, false);
        }],
        Effect::CloudShadows => &[|s| {
            looking_down(s);
            s.scene.sun.elevation_deg = 3.0;
        }],
        _ => &[],
    }
}
