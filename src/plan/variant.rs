//! The compiled form of the march.

use super::reasons::Reasons;
use super::{KeyLight, Lighting};
use crate::scene::{CloudLayer, DensityModel, DomainKind, Frame, MapEdge, MapSource, Output, Scene};

/// Fewest voxels across a baked box; half as many upwards have to be more than one.
const LEAST_VOXELS: u32 = 4;

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
    /// The air in front of clouds is drawn.
    pub air: bool,
    /// The ground may end a ray.
    pub ground: bool,
    /// Targets are float.
    pub float: bool,
    /// Clear air is crossed in steps as long as the map allows.
    pub skip: bool,
}

impl MarchVariant {
    /// Every flag the cloud shaders know.
    pub const FLAGS: [&'static str; 15] = [
        "PROFILE", "THESIS", "UNIFORM", "TEXTURE", "GRID", "BAKED", "MAPLESS", "DETAIL", "CURL", "FRONT", "PLAIN",
        "AIR", "GROUND", "FLOAT", "SKIP",
    ];

    /// The variant a frame needs, or `None` when no cloud can be in it.
    pub(super) fn new(frame: &Frame<'_>, ground: bool, lighting: &Lighting, why: &mut Reasons) -> Option<Self> {
        let scene = frame.scene;
        let layers: Vec<&CloudLayer> = scene.visible_layers().collect();
        if layers.is_empty() {
            why.no("clouds", no_cloud(scene));
            return None;
        }
        why.yes("clouds", format!("{} layer(s) can hold cloud", layers.len()));
        let any = |test: fn(&CloudLayer) -> bool| layers.iter().any(|layer| test(layer));
        let detail = any(CloudLayer::has_detail);
        why.either(detail, "detail noise", "some layer is eroded", "erosion is 0 in every layer");
        let curl = detail && any(CloudLayer::has_curl);
        why.either(curl, "curl noise", "it drags the detail", "it drags nothing");
        let front = scene.weather.coverage_changes && scene.weather.coverage != scene.weather.coverage_change_to;
        why.either(front, "coverage front", "another coverage arrives", "coverage is the same everywhere");
        let lit = lighting.key != KeyLight::None;
        let octaves = if lit { frame.quality.octaves } else { 0 };
        why.either(octaves > 0, "scattering octaves", format!("{octaves} on top of the first"), "only the first order");
        let plain = scene.plain_light.enabled;
        let air = scene.air.aerial_perspective && frame.output != Output::CloudsAlone && !plain;
        why.either(
            air,
            "aerial perspective",
            "air lies before the clouds",
            "it is switched off, or clouds stand alone, or there is none",
        );
        if any(|layer| layer.model == DensityModel::Texture)
            && scene.weather.layers.iter().all(|map| map.source == MapSource::Generated)
        {
            why.no("weather texture", "the map holds no heights; set its source to a weather texture or an image");
        }
        let baked = baked(frame, why);
        let mapless = layers.iter().all(|layer| !layer.reads_map());
        let repeats = scene.weather.edge == MapEdge::Repeat;
        let skip = repeats
            && baked.is_none()
            && frame.quality.skip_clear
            && frame.quality.empty_stride > 1.0
            && any(|layer| !matches!(layer.model, DensityModel::Uniform | DensityModel::Grid));
        why.either(
            skip,
            "empty-space skipping",
            "the map says where nothing is",
            "it is switched off, or steps are equal, or the map ends, or voxels are read",
        );
        Some(Self {
            layers: u32::try_from(layers.len()).unwrap_or(1),
            octaves,
            domain: scene.domain.kind,
            profile: any(|layer| layer.model == DensityModel::Profile),
            thesis: any(|layer| layer.model == DensityModel::Thesis),
            uniform: any(|layer| layer.model == DensityModel::Uniform),
            texture: any(|layer| layer.model == DensityModel::Texture),
            grid: any(|layer| layer.model == DensityModel::Grid),
            baked,
            mapless,
            plain,
            detail,
            curl,
            front,
            air,
            ground,
            float: frame.output != Output::Display,
            skip,
        })
    }

    /// Whether some layer reads the large noise.
    pub fn reads_shape(self) -> bool {
        self.profile || self.texture
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
        Self { baked: None, skip: false, ..self }
    }

    /// Parts of the shader that add a binding are switched by text, or the layout would still need them.
    pub fn flags(self) -> impl Iterator<Item = &'static str> {
        let seen = self.seen();
        let on = [
            seen.profile,
            seen.thesis,
            seen.uniform,
            seen.texture,
            seen.grid,
            seen.baked.is_some(),
            seen.mapless,
            seen.detail,
            seen.curl,
            seen.front,
            seen.plain,
            seen.air,
            seen.ground,
            seen.float,
            seen.skip,
        ];
        Self::FLAGS.into_iter().zip(on).filter_map(|(flag, on)| on.then_some(flag))
    }

    /// The flags that decide how the density field is read, for other passes that read it.
    pub fn field_flags(self) -> impl Iterator<Item = &'static str> {
        self.flags().filter(|flag| !matches!(*flag, "PLAIN" | "AIR" | "GROUND" | "FLOAT" | "SKIP"))
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

/// Voxels from west to east where all layers are to be read from baked ones.
fn baked(frame: &Frame<'_>, why: &mut Reasons) -> Option<u32> {
    let voxels = frame.quality.grid_voxels;
    let is_box = frame.scene.domain.kind == DomainKind::Box;
    let baked = (voxels > 0 && is_box).then_some(voxels.max(LEAST_VOXELS));
    let because = if voxels == 0 { "the field is read as it is" } else { "only a box can be baked" };
    why.either(baked.is_some(), "baked voxels", format!("{voxels} of them across"), because);
    baked
}

fn no_cloud(scene: &Scene) -> &'static str {
    if scene.layers.iter().all(|layer| !layer.enabled) {
        "every layer is switched off"
    } else if scene.layers.iter().all(|layer| !layer.is_visible()) {
        "no layer has thickness, density and extinction"
    } else {
        "coverage is 0"
    }
}
