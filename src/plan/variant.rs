//! The compiled form of the march.

use super::decide::{Need, Verdicts};
use super::effect::Effect;
use super::view;
use super::{KeyLight, Lighting};
use crate::scene::{
    CloudLayer, DensityModel, DomainKind, Frame, MapEdge, MapLayer, MapSource, Output, PhaseKind, Quality, Scene,
};

/// Fewest voxels across a baked box; half as many upwards have to be more than one.
const LEAST_VOXELS: u32 = 4;

/// Which phase functions some layer has; scattering the same in all directions takes none of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Phases {
    /// Henyey and Greenstein's.
    pub one_lobe: bool,
    /// Two of them, mixed.
    pub two_lobes: bool,
    /// Cornette and Shanks's.
    pub cornette_shanks: bool,
    /// Schlick's.
    pub schlick: bool,
    /// Rayleigh's.
    pub rayleigh: bool,
}

impl Phases {
    const FLAGS: [&'static str; 5] =
        ["PHASE_ONE_LOBE", "PHASE_TWO_LOBES", "PHASE_CORNETTE_SHANKS", "PHASE_SCHLICK", "PHASE_RAYLEIGH"];

    fn flags(self) -> impl Iterator<Item = &'static str> {
        let on = [self.one_lobe, self.two_lobes, self.cornette_shanks, self.schlick, self.rayleigh];
        Self::FLAGS.into_iter().zip(on).filter_map(|(flag, on)| on.then_some(flag))
    }
}

/// How the grid of the sun's optical depth is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SunGridPlan {
    /// Nodes across.
    pub nodes: u32,
    /// Whether the light is so low that its planes follow each other sideways.
    pub is_low: bool,
}

/// Sine of the light's elevation below which they do.
const LOW_LIGHT_SINE: f32 = 0.35;
/// Fewest nodes across the grid.
const LEAST_NODES: u32 = 16;
/// A shorter way towards the light is marched.
const LEAST_REACH_M: f32 = 20_000.0;

/// The compiled form of the march: the key of its pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MarchVariant {
    /// How many layers there are.
    pub layers: u32,
    /// Octaves of multiple scattering on top of the first.
    pub octaves: u32,
    /// Shape of the space.
    pub domain: DomainKind,
    /// Some layer has the profile model, which reads the large noise.
    pub profile: bool,
    /// Some layer has the thesis's model, which reads the Worley noise.
    pub thesis: bool,
    /// Some layer is uniform.
    pub uniform: bool,
    /// Some layer has Costa's model, which reads the large noise as well.
    pub texture: bool,
    /// Some layer is Perlin times Voronoi noise, summed from octaves.
    pub product: bool,
    /// Some layer is a cellular automaton.
    pub automaton: bool,
    /// Some layer's clouds are shapes.
    pub shapes: bool,
    /// Some layer is the voxels of a file.
    pub grid: bool,
    /// All layers are read from voxels that were baked before, so many from west to east.
    pub baked: Option<u32>,
    /// No layer reads the weather map.
    pub mapless: bool,
    /// Light comes from a plain sun and sky.
    pub plain: bool,
    /// Some layer reads the small noise.
    pub detail: bool,
    /// Some layer reads the curl noise.
    pub curl: bool,
    /// Coverage differs on the two sides of a front.
    pub front: bool,
    /// The key light shines on the clouds.
    pub lit: bool,
    /// The light of the whole sky does.
    pub ambient: bool,
    /// How they scatter it.
    pub phases: Phases,
    /// The air in front of clouds is drawn.
    pub air: bool,
    /// The ground may end a ray.
    pub ground: bool,
    /// Targets are float.
    pub float: bool,
    /// Clear air is crossed in steps as long as the map allows.
    pub skip: bool,
    /// The distance of the clouds is kept.
    pub distance: bool,
    /// The sun's optical depth is read from a grid where it is far from a sample.
    pub sun_grid: Option<SunGridPlan>,
}

impl MarchVariant {
    /// Every flag of the density field.
    const FIELD_FLAGS: [&'static str; 14] = [
        "BILLOWS",
        "PROFILE",
        "THESIS",
        "UNIFORM",
        "TEXTURE",
        "PRODUCT",
        "AUTOMATON",
        "SHAPES",
        "GRID",
        "BAKED",
        "MAPLESS",
        "DETAIL",
        "CURL",
        "FRONT",
    ];

    /// The variant that reads a frame's layers, or `None` where none can hold cloud. What only light and the march itself
    /// need is left out of it until [`Self::marched`].
    pub(super) fn of_field(frame: &Frame<'_>, why: &mut Verdicts) -> Option<Self> {
        let scene = frame.scene;
        let layers: Vec<&CloudLayer> = scene.visible_layers().collect();
        if layers.is_empty() {
            return None;
        }
        let any = |test: fn(&CloudLayer) -> bool| layers.iter().any(|layer| test(layer));
        let Models { profile, thesis, uniform, texture, product, automaton, shapes, grid } = Models::of(&layers, why);
        let has_heights =
            scene.weather.layers.iter().any(|map| !matches!(map.source, MapSource::Generated | MapSource::Flow));
        let baked = baked(frame, why);
        let reads_map = any(CloudLayer::reads_map) || profile || thesis || uniform || texture || product || automaton;
        let of_map = if texture && !has_heights {
            "it holds no heights for the weather texture: set its source to a weather texture or an image"
        } else {
            "layers are placed by it"
        };
        why.unless(Effect::WeatherMap, &[(!reads_map, Need::Impossible, "no layer is placed by it")], of_map);
        let is_painted = |map: &MapLayer| map.source == MapSource::Painted && map.strokes.dabs() > 0;
        why.unless(
            Effect::Painting,
            &[
                (!reads_map, Need::Impossible, "no layer is placed by the map"),
                (!scene.weather.layers.iter().any(is_painted), Need::Needless, "nothing is painted on it"),
            ],
            "the map is painted",
        );
        let detail = why.needed_if(
            any(CloudLayer::has_detail),
            Effect::Detail,
            "some layer is eroded",
            "erosion is 0 in every layer",
        );
        let curl = why.unless(
            Effect::Curl,
            &[
                (!detail, Need::Impossible, "there is no detail to drag"),
                (!any(CloudLayer::has_curl), Need::Needless, "it drags nothing"),
            ],
            "it drags the detail",
        );
        let weather = &scene.weather;
        let front = why.unless(
            Effect::Front,
            &[
                (!weather.coverage_changes, Need::Unwanted, "coverage does not change"),
                (weather.coverage == weather.coverage_change_to, Need::Needless, "it changes to what it is"),
            ],
            "another coverage arrives",
        );
        Some(Self {
            layers: u32::try_from(layers.len()).unwrap_or(1),
            octaves: 0,
            domain: scene.domain.kind,
            profile,
            thesis,
            uniform,
            texture,
            product,
            automaton,
            shapes,
            grid,
            baked,
            mapless: !reads_map,
            plain: scene.plain_light.enabled,
            detail,
            curl,
            front,
            lit: false,
            ambient: false,
            phases: Phases::default(),
            air: false,
            ground: false,
            float: frame.output != Output::Display,
            skip: false,
            distance: false,
            sun_grid: None,
        })
    }

    /// The variant with what the march needs beside the field.
    pub(super) fn marched(
        self,
        frame: &Frame<'_>,
        (ground, temporal): (bool, bool),
        lighting: &Lighting,
        why: &mut Verdicts,
    ) -> Self {
        let (scene, quality) = (frame.scene, frame.quality);
        let scatters =
            |gain: fn(&CloudLayer) -> f32| scene.visible_layers().any(|layer| layer.scattering() * gain(layer) > 0.0);
        let shines = scatters(|layer| layer.brightness * layer.phase_gain);
        let lit = why.unless(
            Effect::KeyLight,
            &[
                (lighting.key == KeyLight::None, Need::Needless, "neither sun nor moon shines"),
                (!shines, Need::Needless, "no layer scatters it"),
                (
                    !scene.plain_light.enabled && view::is_below_all_horizons(frame, lighting),
                    Need::Needless,
                    "it is below the horizon of the highest cloud",
                ),
            ],
            match lighting.key {
                KeyLight::Moon => "the moon shines",
                _ => "the sun shines",
            },
        );
        let octaves = why.unless(
            Effect::Octaves,
            &[
                (!lit, Need::Impossible, "no light is marched towards"),
                (quality.octaves == 0, Need::Impossible, "the quality asks for the first order alone"),
                (scene.scattering.octave_energy <= 0.0, Need::Needless, "their energy is 0"),
            ],
            format!("{} on top of the first", quality.octaves),
        );
        let ambient_light = scene.scattering.ambient
            * scene.scattering.ambient_top.vec().max(scene.scattering.ambient_bottom.vec()).max_element();
        let plain = &scene.plain_light;
        let ambient = why.unless(
            Effect::Ambient,
            &[
                (ambient_light <= 0.0, Need::Needless, "its strength is 0"),
                (!scatters(|layer| layer.brightness), Need::Needless, "no layer scatters it"),
                (plain.enabled && plain.sky_radiance <= 0.0, Need::Needless, "the sky is black"),
            ],
            "the sky shines on the clouds",
        );
        let air = why.unless(
            Effect::Air,
            &[
                (plain.enabled, Need::Impossible, "there is no air"),
                (frame.output == Output::CloudsAlone, Need::Unwanted, "clouds stand alone"),
                (!scene.air.aerial_perspective, Need::Unwanted, "it is switched off"),
                (
                    scene.air.haze.max(scene.air.molecules).max(scene.air.ozone) <= 0.0,
                    Need::Needless,
                    "the air is empty",
                ),
            ],
            "air lies before the clouds",
        );
        let distance = why.needed_if(
            temporal || self.float,
            Effect::Distance,
            if temporal { "the next picture takes over from this one" } else { "files hold it" },
            "nothing asks for it",
        );
        let repeats = scene.weather.edge == MapEdge::Repeat;
        let is_mapped = scene.visible_layers().any(|l| l.reads_map() && l.model != DensityModel::Uniform);
        let skip = why.unless(
            Effect::ClearWays,
            &[
                (!repeats, Need::Impossible, "the map has an end"),
                (self.baked.is_some(), Need::Impossible, "voxels are read"),
                (!is_mapped, Need::Impossible, "no layer is placed by the map alone"),
                (quality.empty_stride <= 1.0, Need::Impossible, "all steps are equal"),
                (!quality.skip_clear, Need::Unwanted, "it is switched off"),
            ],
            "the map says where nothing is",
        );
        let sun_grid = self.sun_grid(quality, lit, lighting, why);
        let octaves = if octaves { quality.octaves } else { 0 };
        Self { octaves, lit, ambient, air, ground, skip, distance, sun_grid, phases: phases(scene, lit, why), ..self }
    }

    /// The grid that far steps towards the light are read from.
    fn sun_grid(self, quality: &Quality, lit: bool, lighting: &Lighting, why: &mut Verdicts) -> Option<SunGridPlan> {
        let runs = why.unless(
            Effect::SunGrid,
            &[
                (!lit, Need::Impossible, "no light is marched towards"),
                (self.domain == DomainKind::Box, Need::Impossible, "the clouds are in a box"),
                (self.baked.is_some(), Need::Impossible, "voxels are read"),
                (quality.light_reach_m < LEAST_REACH_M, Need::Impossible, "steps towards the light end before it"),
                (quality.light_grid < LEAST_NODES, Need::Unwanted, "the quality asks for all steps"),
            ],
            "far cloud shadows clouds softly",
        );
        let nodes = quality.light_grid.max(LEAST_NODES);
        runs.then_some(SunGridPlan { nodes, is_low: lighting.towards_key.y < LOW_LIGHT_SINE })
    }

    /// The variant of paths, which scatter all light by the layers' phase functions, whatever the march needs.
    pub(super) fn traced(self, scene: &Scene) -> Self {
        let used = |kind: PhaseKind| scene.visible_layers().any(|layer| layer.phase.effective_kind() == kind);
        let phases = Phases {
            one_lobe: used(PhaseKind::HenyeyGreenstein),
            two_lobes: used(PhaseKind::TwoLobe),
            cornette_shanks: used(PhaseKind::CornetteShanks),
            schlick: used(PhaseKind::Schlick),
            rayleigh: used(PhaseKind::Rayleigh),
        };
        Self { phases, ..self }
    }

    /// Whether some layer reads the large noise.
    pub fn reads_shape(self) -> bool {
        self.has_billows() || self.texture
    }

    /// Whether some layer's clouds are shaped by billows and erosion.
    fn has_billows(self) -> bool {
        self.profile || self.automaton || self.shapes
    }

    /// What programs read: the baked voxels alone, where there are any.
    fn seen(self) -> Self {
        if self.baked.is_none() {
            return self;
        }
        Self {
            profile: false,
            thesis: false,
            uniform: false,
            texture: false,
            product: false,
            automaton: false,
            shapes: false,
            grid: true,
            mapless: true,
            detail: false,
            curl: false,
            front: false,
            ..self
        }
    }

    /// The form that bakes the voxels: every layer as it is.
    pub fn to_bake(self) -> Self {
        Self { baked: None, skip: false, sun_grid: None, ..self }
    }

    /// Parts of the shader that add a binding are switched by text, or the layout would still need them.
    pub fn flags(self) -> impl Iterator<Item = &'static str> {
        let own = [
            ("PLAIN", self.plain),
            ("LIT", self.lit),
            ("AMBIENT", self.ambient),
            ("AIR", self.air),
            ("GROUND", self.ground),
            ("FLOAT", self.float),
            ("SKIP", self.skip),
            ("DISTANCE", self.distance),
            ("SUN_GRID", self.sun_grid.is_some()),
        ];
        let own = own.into_iter().filter_map(|(flag, on)| on.then_some(flag));
        self.field_flags().chain(self.phases.flags()).chain(own)
    }

    /// The flags that decide how the density field is read, for other passes that read it.
    pub fn field_flags(self) -> impl Iterator<Item = &'static str> {
        let seen = self.seen();
        let on = [
            seen.has_billows(),
            seen.profile,
            seen.thesis,
            seen.uniform,
            seen.texture,
            seen.product,
            seen.automaton,
            seen.shapes,
            seen.grid,
            seen.baked.is_some(),
            seen.mapless,
            seen.detail,
            seen.curl,
            seen.front,
        ];
        Self::FIELD_FLAGS.into_iter().zip(on).filter_map(|(flag, on)| on.then_some(flag))
    }

    /// The same without anything but the field: for what is made from it once, whoever looks.
    pub fn field_alone(self) -> Self {
        Self {
            octaves: 0,
            lit: false,
            ambient: false,
            phases: Phases::default(),
            air: false,
            ground: false,
            float: false,
            skip: false,
            distance: false,
            sun_grid: None,
            ..self
        }
    }

    /// Numbers the compiler should know.
    pub fn domain_index(self) -> u32 {
        match self.domain {
            DomainKind::Shell => 0,
            DomainKind::Flat => 1,
            DomainKind::Box => 2,
        }
    }
}

/// Which density models some layer has, or was forced to be compiled for.
#[derive(Clone, Copy, Debug)]
struct Models {
    profile: bool,
    thesis: bool,
    uniform: bool,
    texture: bool,
    product: bool,
    automaton: bool,
    shapes: bool,
    grid: bool,
}

impl Models {
    fn of(layers: &[&CloudLayer], why: &mut Verdicts) -> Self {
        let has = |model: DensityModel| layers.iter().any(|layer| layer.model == model);
        let mut model = |effect: Effect, which: DensityModel| {
            why.needed_if(has(which), effect, "some layer has it", "no layer has it")
        };
        let models = Self {
            profile: model(Effect::Profile, DensityModel::Profile),
            thesis: model(Effect::Thesis, DensityModel::Thesis),
            uniform: model(Effect::Uniform, DensityModel::Uniform),
            texture: model(Effect::Texture, DensityModel::Texture),
            product: model(Effect::Product, DensityModel::Product),
            automaton: model(Effect::Automaton, DensityModel::Automaton),
            shapes: model(Effect::Shapes, DensityModel::Shapes),
            grid: has(DensityModel::Grid),
        };
        let is_sheared = |l: &CloudLayer| l.model == DensityModel::Automaton && l.automaton.shear != 0.0;
        why.unless(
            Effect::Shear,
            &[
                (!models.automaton, Need::Impossible, "no layer is an automaton"),
                (!layers.iter().any(|layer| is_sheared(layer)), Need::Needless, "its shear is 0"),
            ],
            "its tops drift from its bases",
        );
        why.unless(Effect::Grid, &[(!models.grid, Need::Impossible, "no layer names a file")], "some layer has it");
        let reads_shape = models.profile || models.texture || models.automaton || models.shapes;
        let reason = "no model reads it";
        why.unless(Effect::ShapeNoise, &[(!reads_shape, Need::Impossible, reason)], "some model reads it");
        models
    }
}

/// Voxels from west to east where all layers are to be read from baked ones.
fn baked(frame: &Frame<'_>, why: &mut Verdicts) -> Option<u32> {
    let voxels = frame.quality.grid_voxels;
    why.unless(
        Effect::Baked,
        &[
            (voxels == 0, Need::Impossible, "the field is read as it is"),
            (frame.scene.domain.kind != DomainKind::Box, Need::Impossible, "only a box can be baked"),
        ],
        format!("{voxels} of them across"),
    )
    .then_some(voxels.max(LEAST_VOXELS))
}

/// The phase functions of the layers, where light is scattered at all.
fn phases(scene: &Scene, lit: bool, why: &mut Verdicts) -> Phases {
    let mut function = |effect: Effect, kind: PhaseKind| {
        let is_used = scene.visible_layers().any(|layer| layer.phase.effective_kind() == kind);
        let is_named = scene.visible_layers().any(|layer| layer.phase.kind == kind);
        let if_not = if is_named { "its share is 0" } else { "no layer has it" };
        why.unless(
            effect,
            &[(!lit, Need::Impossible, "no light is scattered by angle"), (!is_used, Need::Needless, if_not)],
            "some layer has it",
        )
    };
    Phases {
        one_lobe: function(Effect::HenyeyGreenstein, PhaseKind::HenyeyGreenstein),
        two_lobes: function(Effect::TwoLobes, PhaseKind::TwoLobe),
        cornette_shanks: function(Effect::CornetteShanks, PhaseKind::CornetteShanks),
        schlick: function(Effect::Schlick, PhaseKind::Schlick),
        rayleigh: function(Effect::Rayleigh, PhaseKind::Rayleigh),
    }
}

/// Why no layer holds any cloud.
pub(super) fn no_cloud(scene: &Scene) -> &'static str {
    if scene.layers.iter().all(|layer| !layer.enabled) {
        "every layer is switched off"
    } else if scene.layers.iter().all(|layer| !layer.is_visible()) {
        "no layer has thickness, density and extinction"
    } else {
        "coverage is 0"
    }
}
