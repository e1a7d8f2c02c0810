//! What the sky is ([`Scene`]) and how it is computed ([`Quality`]): plain data, declared once, with units and ranges.
//!
//! Axes: x east, y up, z south, in metres from the sea-level point under the world's origin. Wind is named by where it
//! blows from, azimuths run clockwise from north. Angles are degrees here, where people see them, and radians from
//! [`crate::render::uniforms`] on.

mod animation;
mod automaton;
pub mod bounds;
pub mod builtin;
pub mod clip;
mod cube;
pub mod edit;
pub mod expression;
mod frame;
pub mod genus;
mod layer;
mod light;
pub mod morph;
pub mod nearest;
mod paint;
pub mod param;
mod place;
pub mod preset;
mod quality;
pub mod random;
pub mod reference_docs;
mod shape;
mod sun_position;
mod weather;

pub use animation::{Animation, DURATION_RANGE_SECS, Ease, Keyframe, SPEED_RANGE, Track, can_move};
pub use automaton::{Automaton, AutomatonMoment, CHAPTER, EPOCH, Generation, HAND_OVER, WARM_UP};
pub use cube::{CUBE_FACES, CubeFace};
pub use frame::{Frame, LARGEST_WHOLE_PX, Output, Window};
pub use layer::{BodyForm, CloudLayer, DensityModel, Optics, PerlinOctaves, Phase, PhaseKind, VoronoiOctaves};
pub use light::{Air, Moon, PlainLight, Scattering, Sun, SunPlacement, Sunshafts};
pub use paint::{Brush, CloudKind, MAX_DABS, Stroke, Strokes};
pub use place::{
    Camera, Display, Domain, DomainKind, FALSE_COLOURS, FARTHEST_M, FieldOfViewAxis, Ground, Projection, ToneMap,
};
pub use preset::{
    Bookmark, MAX_BOOKMARKS, PRESET_VERSION, Preset, PresetError, file_stem, quality_from_ron, quality_to_ron,
};
pub use quality::{Quality, QualityLevel, UpdateFraction, UpdateOrder};
pub use shape::{MAX_SHAPES, Shape, ShapeJoin, ShapeKind, ShapeRole};
pub use sun_position::{CITIES, Moment};
pub use weather::{FlowKind, MapBlend, MapEdge, MapLayer, MapSource, Weather, Wind};

use crate::params;

/// Most cloud layers one scene may hold.
pub const MAX_LAYERS: usize = 4;

/// Most items that a list of parameters may hold, by its name.
pub fn most_of(list: &str) -> usize {
    if list == "shapes" { MAX_SHAPES } else { MAX_LAYERS }
}

params! {
    /// What the sky is.
    pub struct Scene ("Scene") {
        /// Sheets of cloud; they may overlap.
        layers: Vec<CloudLayer> = vec![CloudLayer::default()];
        /// Bodies of cloud for layers of that model, and solid things.
        shapes: Vec<Shape> = vec![Shape::default()];
        /// Over what depth inside shapes their clouds become full.
        shape_edge_m: f32 = 220.0, 1.0..=5000.0, Metres, logarithmic;
        /// Where clouds are.
        weather: Weather = Weather::default();
        /// Wind that carries them.
        wind: Wind = Wind::default();
        /// The sun.
        sun: Sun = Sun::default();
        /// The moon and the light of the night.
        moon: Moon = Moon::default();
        /// Scattered light inside clouds.
        scattering: Scattering = Scattering::default();
        /// The clear air.
        air: Air = Air::default();
        /// Light without any air.
        plain_light: PlainLight = PlainLight::default();
        /// Streaks of light.
        sunshafts: Sunshafts = Sunshafts::default();
        /// The ground.
        ground: Ground = Ground::default();
        /// The space that holds clouds.
        domain: Domain = Domain::default();
        /// The eye.
        camera: Camera = Camera::default();
        /// How light becomes the picture on the screen.
        display: Display = Display::default();
    }
}

impl Scene {
    /// Rules that concern more than one field, as sentences; empty when all is well.
    pub fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        if self.layers.len() > MAX_LAYERS {
            problems.push(format!("layers: {} cloud layers, but at most {MAX_LAYERS} can be drawn", self.layers.len()));
        }
        if self.weather.layers.len() > MAX_LAYERS {
            problems.push(format!(
                "weather.layers: {} map layers, but at most {MAX_LAYERS} can be combined",
                self.weather.layers.len()
            ));
        }
        if self.shapes.len() > MAX_SHAPES {
            problems.push(format!("shapes: {} shapes, but at most {MAX_SHAPES} can be drawn", self.shapes.len()));
        }
        let mut grids = self.layers.iter().enumerate().filter(|(_, layer)| layer.model == DensityModel::Grid);
        if let Some((index, _)) = grids.next()
            && self.domain.kind != DomainKind::Box
        {
            problems.push(format!(
                "layers.{index}.model is Grid, which fills a box; set domain.kind to Box, or choose another model"
            ));
        }
        if let Some((index, _)) = grids.next() {
            problems.push(format!("layers.{index}.model is Grid, but only one layer can be a voxel grid"));
        }
        let mut living = self.layers.iter().enumerate().filter(|(_, layer)| layer.model == DensityModel::Automaton);
        if let Some((index, _)) = living.by_ref().nth(1) {
            problems.push(format!("layers.{index}.model is Automaton, but only one layer can be an automaton"));
        }
        for (index, layer) in self.layers.iter().enumerate() {
            if layer.top_m < layer.base_m {
                problems.push(format!(
                    "layers.{index}.top_m = {} m lies below layers.{index}.base_m = {} m; raise the top or lower the base",
                    layer.top_m, layer.base_m
                ));
            }
        }
        problems
    }

    /// Changes as little as makes all rules hold.
    pub fn mend(&mut self) {
        self.layers.truncate(MAX_LAYERS);
        self.weather.layers.truncate(MAX_LAYERS);
        self.shapes.truncate(MAX_SHAPES);
        for layer in &mut self.layers {
            layer.top_m = layer.top_m.max(layer.base_m);
        }
        self.keep_models_apart();
    }

    /// Changes as little as makes the rules of models hold: voxel grids in a box, and no second grid or automaton.
    pub fn keep_models_apart(&mut self) {
        let (mut has_grid, mut has_automaton) = (false, false);
        for layer in &mut self.layers {
            let is_second = match layer.model {
                DensityModel::Grid => std::mem::replace(&mut has_grid, true),
                DensityModel::Automaton => std::mem::replace(&mut has_automaton, true),
                _ => false,
            };
            if is_second {
                layer.model = CloudLayer::default().model;
            }
        }
        if has_grid {
            self.domain.kind = DomainKind::Box;
        }
    }

    /// The layers that can hold any cloud.
    pub fn visible_layers(&self) -> impl Iterator<Item = &CloudLayer> {
        self.numbered_layers().map(|(_, layer)| layer)
    }

    /// The first of them that stands where the weather map says: what a picture of the map shows, and what is painted where
    /// nothing says how high.
    pub fn layer_on_map(&self) -> Option<(usize, &CloudLayer)> {
        self.numbered_layers().find(|(_, layer)| layer.reads_map())
    }

    /// The same, each with its index among all.
    pub fn numbered_layers(&self) -> impl Iterator<Item = (usize, &CloudLayer)> {
        let coverage = self.weather.greatest_coverage();
        let has_shapes = self.has_shapes(ShapeRole::Cloud);
        let all = self.layers.iter().enumerate().take(MAX_LAYERS);
        let holds_any = move |layer: &CloudLayer| has_shapes || layer.model != DensityModel::Shapes;
        all.filter(move |(_, layer)| layer.is_visible() && layer.is_covered(coverage) && holds_any(layer))
    }

    /// Whether any shape has a role. What joins by taking away, or by what is common, needs one before it.
    pub fn has_shapes(&self, role: ShapeRole) -> bool {
        self.shapes.iter().any(|shape| shape.role == role && shape.join == ShapeJoin::Union)
    }

    /// Where a direction from the eye first meets a height above the sea, relative to the eye; `None` where it never does, or
    /// behind the ground.
    #[allow(clippy::cast_possible_truncation, reason = "no farther than clouds are drawn")]
    pub fn place_at_height(&self, towards: glam::Vec3, height_m: f32) -> Option<glam::Vec3> {
        let [up, eye_m, height_m] = [towards.y, self.camera.height_m, height_m].map(f64::from);
        let way = if self.domain.kind == DomainKind::Shell {
            let radius = f64::from(self.domain.planet_radius_m);
            let along = (radius + eye_m) * up;
            // Both ways to a sphere about the planet's middle.
            let roots = |height: f64| {
                let within = along * along - (eye_m - height) * (2.0 * radius + eye_m + height);
                (within >= 0.0).then(|| [-along - within.sqrt(), -along + within.sqrt()])
            };
            let first = |height: f64| roots(height)?.into_iter().find(|way| *way > 0.0);
            let ground = if eye_m > 0.0 { first(0.0) } else { None };
            first(height_m).filter(|way| ground.is_none_or(|ground| *way <= ground))?
        } else {
            (height_m - eye_m) / up
        };
        (way > 0.0 && way < f64::from(Quality::default().max_distance_m)).then(|| towards * way as f32)
    }

    /// Unit vector towards the sun.
    pub fn towards_sun(&self) -> glam::Vec3 {
        let (elevation, azimuth) = sun_position::elevation_azimuth_deg(&self.sun);
        direction(elevation, azimuth)
    }

    /// Unit vector towards the moon.
    pub fn towards_moon(&self) -> glam::Vec3 {
        direction(self.moon.elevation_deg, self.moon.azimuth_deg)
    }
}

impl Weather {
    /// The coverage that may occur anywhere, before the offset of a layer.
    pub fn greatest_coverage(&self) -> f32 {
        if self.coverage_changes { self.coverage.max(self.coverage_change_to) } else { self.coverage }
    }
}

/// Unit vector of an elevation and an azimuth clockwise from north.
pub fn direction(elevation_deg: f32, azimuth_deg: f32) -> glam::Vec3 {
    let (sin_elevation, cos_elevation) = f64::from(elevation_deg).to_radians().sin_cos();
    let (sin_azimuth, cos_azimuth) = f64::from(azimuth_deg).to_radians().sin_cos();
    glam::DVec3::new(cos_elevation * sin_azimuth, sin_elevation, -cos_elevation * cos_azimuth).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuth_runs_clockwise_from_north() {
        assert!(direction(0.0, 0.0).abs_diff_eq(glam::Vec3::NEG_Z, 1e-6), "north is −z");
        assert!(direction(0.0, 90.0).abs_diff_eq(glam::Vec3::X, 1e-6), "east is x");
        assert!(direction(90.0, 12.0).abs_diff_eq(glam::Vec3::Y, 1e-6), "up is y");
    }

    #[test]
    fn a_height_is_met_where_geometry_says() {
        let mut scene = Scene::default();
        scene.camera.height_m = 100.0;
        let up = scene.place_at_height(glam::Vec3::Y, 1600.0).expect("overhead");
        assert!((up.y - 1500.0).abs() < 0.1, "{up}");
        let slant = scene.place_at_height(glam::Vec3::new(0.6, 0.8, 0.0), 1600.0).expect("above");
        assert!((slant.x - 1125.0).abs() < 1.0, "{slant}");
        let level = scene.place_at_height(glam::Vec3::X, 1600.0).expect("over the horizon");
        let by_hand = (2.0_f64 * 6.36e6 * 1500.0).sqrt();
        assert!((f64::from(level.x) / by_hand - 1.0).abs() < 1e-3, "{level}, by hand {by_hand}");
        assert_eq!(scene.place_at_height(glam::Vec3::new(0.6, -0.8, 0.0), 1600.0), None, "behind the ground");
        assert_eq!(scene.place_at_height(glam::Vec3::NEG_Y, 50.0), Some(glam::Vec3::NEG_Y * 50.0), "below");
        scene.domain.kind = DomainKind::Flat;
        assert_eq!(scene.place_at_height(glam::Vec3::X, 1600.0), None, "never");
        assert_eq!(scene.place_at_height(glam::Vec3::NEG_Y, 1600.0), None, "behind the eye");
    }

    #[test]
    fn a_layer_upside_down_is_named() {
        let mut scene = Scene::default();
        assert!(scene.problems().is_empty(), "the default scene is sound");
        scene.layers[0].top_m = 100.0;
        let problems = scene.problems();
        assert!(problems.len() == 1 && problems[0].contains("layers.0.top_m"), "{problems:?}");
        assert_eq!(scene.visible_layers().count(), 0, "and holds no cloud");
        scene.mend();
        assert!(scene.problems().is_empty(), "{:?}", scene.problems());
    }

    #[test]
    fn a_voxel_grid_needs_a_box_of_its_own() {
        let mut scene = Scene::default();
        scene.layers[0].model = DensityModel::Grid;
        assert!(scene.problems()[0].contains("domain.kind"), "{:?}", scene.problems());
        scene.domain.kind = DomainKind::Box;
        scene.weather.coverage = 0.0;
        assert_eq!((scene.problems().len(), scene.visible_layers().count()), (0, 1), "whatever the map covers");
        scene.layers.push(scene.layers[0].clone());
        assert!(scene.problems()[0].contains("layers.1.model"), "{:?}", scene.problems());
        scene.mend();
        assert!(scene.problems().is_empty() && scene.layers[0].model == DensityModel::Grid, "{scene:?}");
    }
}
