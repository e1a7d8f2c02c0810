//! The weather map: document data that says where clouds are and of which type.

use super::paint::Strokes;
use super::param::FileName;
use crate::{choices, params};

choices! {
    /// Where a layer of the weather map comes from.
    pub enum MapSource {
        /// Layered Perlin and Worley noise.
        Generated ("Generated"),
        /// The same noise as coverage, height and altitude, for the density model of that name.
        WeatherTexture ("Generated weather texture"),
        /// A PNG or EXR image of the user's.
        Image ("Image"),
        /// An image of the user's that lives: more of its kind grows beyond its border, and it becomes another of its kind.
        Grown ("Image, growing"),
        /// A numbered sequence of images, played over time.
        Sequence ("Image sequence"),
        /// Strokes of the brush, over what the layers below have.
        Painted ("Painted"),
        /// No cloud of its own: a flow that carries what the layers below have.
        Flow ("Flow"),
    }
}

choices! {
    /// How a flow carries the map below it.
    pub enum FlowKind {
        /// All of it, beside the wind.
        Uniform ("Uniform"),
        /// In circles about a place, the inner ones faster; clockwise at positive speeds.
        Vortex ("Vortex"),
        /// Along a band.
        Band ("Band"),
        /// To and fro, in stripes as wide as half of the map; fastest at its place.
        Shear ("Shear"),
    }
}

choices! {
    /// How a layer of the weather map joins those below it.
    pub enum MapBlend {
        /// Whichever has more cloud, of each kind.
        Densest ("Densest"),
        /// This layer alone.
        Replace ("Replace"),
        /// The sum.
        Add ("Add"),
        /// What lies below, less this one.
        Subtract ("Take away"),
        /// What lies below, times this one's cloud of all kinds: a mask.
        Mask ("Mask"),
    }
}

choices! {
    /// What lies beyond the edge of the map.
    pub enum MapEdge {
        /// The map again.
        Repeat ("Repeat"),
        /// The map's outermost texels.
        Clamp ("Clamp"),
        /// No cloud.
        Clear ("Clear"),
    }
}

impl MapSource {
    /// Whether it comes from noise, and so tiles and evolves.
    pub fn is_generated(self) -> bool {
        matches!(self, Self::Generated | Self::WeatherTexture)
    }

    /// Whether the wind carries it.
    pub fn drifts(self) -> bool {
        self.is_generated() || matches!(self, Self::Painted | Self::Grown | Self::Flow)
    }
}

params! {
    /// One layer of the weather map.
    pub struct MapLayer ("Map layer") {
        /// Where the layer comes from.
        source: MapSource = MapSource::Generated;
        /// Image file (red: cumulus, green: stratus, blue: stratocumulus, each the greatest density there; for the model of weather textures coverage, height and altitude), or the pattern of a sequence such as `map.####.png`.
        image: FileName = FileName::default();
        /// Width of an image that grows relative to the map, in whose middle it lies at time 0.
        image_share: f32 = 0.5, 0.1..=1.0, None;
        /// How the layer joins those below it. A painted one lies over them.
        blend: MapBlend = MapBlend::Densest;
        /// How much of the layer counts.
        opacity: f32 = 1.0, 0.0..=1.0, None;
        /// Images shown per second of scene time, for a sequence.
        images_per_sec: f32 = 1.0, 0.001..=60.0, None, logarithmic;
        /// Strokes of the brush in the window, for a painted layer; what they cover replaces the layers below.
        strokes: Strokes = Strokes::default();
        /// Seed of the generated map, and of what grows about an image.
        seed: u32 = 1, 0..=999_999, None;
        /// Large cells across the map; each is a field of cloud.
        large_cells: u32 = 8, 2..=32, None;
        /// Share of small separate puffs among the large fields.
        small_share: f32 = 0.5, 0.0..=1.0, None;
        /// Strength of the Perlin noise that frays the cells.
        fray: f32 = 0.35, 0.0..=1.0, None;
        /// How much the amount of cloud differs from region to region.
        contrast: f32 = 0.35, 0.0..=1.0, None;
        /// Probability weight of cumulus cells.
        cumulus: f32 = 1.0, 0.0..=1.0, None;
        /// Probability weight of stratus cells.
        stratus: f32 = 0.0, 0.0..=1.0, None;
        /// Probability weight of stratocumulus cells.
        stratocumulus: f32 = 0.0, 0.0..=1.0, None;
        /// How a flow carries the map.
        flow: FlowKind = FlowKind::Vortex;
        /// Place of a flow, from the map's western edge, in edges of the map.
        flow_east: f32 = 0.5, 0.0..=1.0, None;
        /// Place of a flow, from the map's northern edge, in edges of the map.
        flow_south: f32 = 0.5, 0.0..=1.0, None;
        /// Radius of a vortex, half the width of a band, in edges of the map.
        flow_radius: f32 = 0.3, 0.01..=0.5, None;
        /// Greatest speed of a flow, for cloud layers whose map is as large as it is.
        flow_mps: f32 = 10.0, -100.0..=100.0, MetresPerSecond;
        /// Where a flow goes, clockwise from north; bands and shear keep to eighths of a turn, so that they repeat with the map.
        flow_heading_deg: f32 = 90.0, 0.0..=360.0, Degrees;
        /// Time after which a flow begins anew, in turns with another, so that nothing is wound up for ever.
        flow_secs: f32 = 1800.0, 10.0..=100_000.0, Seconds, logarithmic;
        /// How long a flow has gone on where it counts most: how far it has wound up the map.
        flow_begun_secs: f32 = 0.0, 0.0..=100_000.0, Seconds;
        /// Time at which a flow has gone on for so long.
        flow_at_secs: f32 = 0.0, -1e9..=1e9, Seconds;
    }
}

params! {
    /// Where clouds are: a map over the ground and how much of it they cover.
    pub struct Weather ("Weather") {
        /// Share of the sky that clouds cover.
        coverage: f32 = 0.36, 0.0..=1.0, None;
        /// Whether another coverage is on its way from the upwind horizon.
        coverage_changes: bool = false;
        /// The coverage that arrives from the horizon.
        coverage_change_to: f32 = 0.8, 0.0..=1.0, None;
        /// Distance of the front at time 0, upwind.
        front_distance_m: f32 = 30_000.0, 0.0..=300_000.0, Metres;
        /// Width of the transition at the front.
        front_width_m: f32 = 15_000.0, 100.0..=200_000.0, Metres, logarithmic;
        /// Edge length of the map over the ground.
        size_m: f32 = 24_000.0, 1000.0..=500_000.0, Metres, logarithmic;
        /// What lies beyond the edge of the map.
        edge: MapEdge = MapEdge::Repeat;
        /// Whether the map moves with the wind, if all of it is generated, painted, growing or flow.
        moves: bool = true;
        /// Time in which a generated map, or one that grows, becomes another. 0 holds it still.
        evolution_secs: f32 = 1200.0, 0.0..=100_000.0, Seconds;
        /// Layers of the map, from the bottom.
        layers: Vec<MapLayer> = vec![MapLayer::default()];
    }
}

params! {
    /// Wind that carries the clouds.
    pub struct Wind ("Wind") {
        /// Where the wind blows from, clockwise from north.
        from_deg: f32 = 270.0, 0.0..=360.0, Degrees;
        /// Speed of the wind.
        speed_mps: f32 = 10.0, 0.0..=100.0, MetresPerSecond;
        /// Speed of the large noise relative to the wind; other than 1 makes shapes evolve.
        shape_speed: f32 = 0.9, -4.0..=4.0, None;
        /// Speed of the small noise relative to the wind.
        detail_speed: f32 = 0.8, -4.0..=4.0, None;
        /// Speed at which the large noise rises.
        rise_mps: f32 = 0.5, -10.0..=10.0, MetresPerSecond;
    }
}
