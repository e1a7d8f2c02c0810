//! Cloud layers: where they are, what shapes them, and what they do to light.

use super::automaton::Automaton;
use super::param::FileName;
use crate::{choices, params};

choices! {
    /// How a layer turns the weather map into density.
    pub enum DensityModel {
        /// Bodies from the map, a height profile by cloud type, billows and wisps: the program's own model.
        Profile ("Profile"),
        /// Map times height function times four-channel Worley noise (Koblížek 2019, equations 2.1 and 2.2).
        Thesis ("Thesis"),
        /// The same everywhere the map has cloud: fog, haze, and tests against closed forms.
        Uniform ("Uniform"),
        /// Coverage, height and altitude from one image, with the noises of Costa 2023, section 3.1.
        Texture ("Weather texture"),
        /// Voxels of a file, in a box.
        Grid ("Voxel grid"),
        /// Octaves of Perlin noise times octaves of Voronoi noise, in a box or wherever the map has cloud (Thomann 2020, section 6.3).
        Product ("Perlin × Voronoi"),
        /// Clouds that live: cells that become humid, condense and vanish, with the billows of the program's own model (Dobashi et al. 2000).
        Automaton ("Cellular automaton"),
        /// The sky's shapes of cloud, with the billows of the program's own model (Thomann 2020, chapter 4; Costa 2023, section 2.2).
        Shapes ("Shapes"),
    }
}

choices! {
    /// What kind of cloud a layer's bodies are.
    pub enum BodyForm {
        /// What the weather map says at each place.
        Map ("As the map says"),
        /// Heaps whose tops rise with their width.
        Cumulus ("Heaps"),
        /// A flat sheet in the lower third of the layer.
        Stratus ("Sheet"),
        /// Rolls and tiles up to the middle of the layer.
        Stratocumulus ("Rolls and tiles"),
    }
}

choices! {
    /// What a layer's extinction is computed from.
    pub enum Optics {
        /// Scattering and absorption per metre, as they are given.
        Given ("As given"),
        /// Water and droplets in each cubic metre; scattering per metre follows.
        Droplets ("From water and droplets"),
    }
}

choices! {
    /// How a droplet scatters light, as a function of the angle alone. All are normalised over the sphere.
    pub enum PhaseKind {
        /// The same in all directions.
        Isotropic ("Isotropic"),
        /// Henyey and Greenstein 1941: one lobe with mean cosine g.
        HenyeyGreenstein ("Henyey-Greenstein"),
        /// A forward and a backward Henyey-Greenstein lobe, mixed.
        TwoLobe ("Two-lobe Henyey-Greenstein"),
        /// Cornette and Shanks 1992: Henyey-Greenstein times a Rayleigh-like term.
        CornetteShanks ("Cornette-Shanks"),
        /// Schlick's rational approximation of Henyey-Greenstein.
        Schlick ("Schlick"),
        /// Rayleigh: particles far smaller than the wavelength.
        Rayleigh ("Rayleigh"),
    }
}

params! {
    /// The directions in which droplets scatter.
    pub struct Phase ("Phase function") {
        /// Formula of the phase function.
        kind: PhaseKind = PhaseKind::TwoLobe;
        /// Anisotropy of the forward lobe: the mean cosine for Henyey-Greenstein. 0 is isotropic, towards 1 is forward.
        g: f32 = 0.8, -0.99..=0.99, None;
        /// Anisotropy of the second lobe; negative scatters back towards the light.
        back_g: f32 = -0.25, -0.99..=0.99, None;
        /// Share of the second lobe.
        back_mix: f32 = 0.25, 0.0..=1.0, None;
    }
}

params! {
    /// The sum of octaves of Perlin noise in the model *Perlin × Voronoi*.
    pub struct PerlinOctaves ("Perlin octaves") {
        /// Size of a cell of the first octave.
        size_m: f32 = 900.0, 20.0..=50_000.0, Metres, logarithmic;
        /// Number of octaves.
        octaves: u32 = 4, 1..=8, None;
        /// Amplitude of each octave relative to the one before.
        persistence: f32 = 0.5, 0.0..=1.0, None;
        /// Frequency of each octave relative to the one before; whole, so that the noise repeats without a seam.
        lacunarity: u32 = 2, 1..=4, None;
        /// Shift of the noise, up and across.
        shift_m: f32 = 0.0, -100_000.0..=100_000.0, Metres;
        /// What is taken from the sum.
        threshold: f32 = 0.4, 0.0..=1.0, None;
        /// Factor of what is left.
        multiplier: f32 = 3.0, 0.0..=20.0, None;
    }
}

params! {
    /// The sum of octaves of Voronoi noise in the model *Perlin × Voronoi*: 1 at the cells' points, towards 0 between them.
    pub struct VoronoiOctaves ("Voronoi octaves") {
        /// Size of a cell of the first octave.
        size_m: f32 = 450.0, 20.0..=50_000.0, Metres, logarithmic;
        /// Number of octaves.
        octaves: u32 = 3, 1..=8, None;
        /// Amplitude of each octave relative to the one before.
        persistence: f32 = 0.45, 0.0..=1.0, None;
        /// Frequency of each octave relative to the one before; whole, so that the noise repeats without a seam.
        lacunarity: u32 = 2, 1..=4, None;
        /// Shift of the noise, up and across.
        shift_m: f32 = 0.0, -100_000.0..=100_000.0, Metres;
        /// What is taken from the sum.
        threshold: f32 = 0.3, 0.0..=1.0, None;
        /// Factor of what is left.
        multiplier: f32 = 2.0, 0.0..=20.0, None;
    }
}

params! {
    /// One sheet of cloud between two heights.
    pub struct CloudLayer ("Cloud layer") {
        /// Whether the layer is drawn.
        enabled: bool = true;
        /// How the layer turns the weather map into density.
        model: DensityModel = DensityModel::Profile;
        /// File of a voxel grid, .npy or .vol; its greatest value is density 1. For that model only.
        grid: FileName = FileName::default();
        /// Height of the cloud base above sea level.
        base_m: f32 = 1200.0, 0.0..=15_000.0, Metres;
        /// Greatest height of the cloud tops above sea level.
        top_m: f32 = 2700.0, 10.0..=20_000.0, Metres;
        /// Added to the coverage of the weather map for this layer.
        coverage_offset: f32 = 0.0, -1.0..=1.0, None;
        /// What kind of cloud its bodies are: for the models *Profile* and *Thesis*.
        form: BodyForm = BodyForm::Map;
        /// How far map and noises are drawn out along the wind, and lean with the tops: fibres of ice above 4 or so.
        stretch: f32 = 1.0, 1.0..=20.0, None, logarithmic;
        /// Width of the soft edge of a cloud body, as a part of the map's range.
        edge_softness: f32 = 0.26, 0.02..=1.0, None;
        /// Size of this layer's copy of the weather map, relative to the map's own.
        map_scale: f32 = 1.0, 0.05..=20.0, None, logarithmic;
        /// Shift of this layer's copy of the map towards the east.
        map_east_m: f32 = 0.0, -100_000.0..=100_000.0, Metres;
        /// Shift of this layer's copy of the map towards the south.
        map_south_m: f32 = 0.0, -100_000.0..=100_000.0, Metres;
        /// How much tops vary in height from body to body.
        top_variation: f32 = 0.6, 0.0..=1.0, None;
        /// How far tops spread out sideways, as an anvil.
        anvil: f32 = 0.0, 0.0..=1.0, None;
        /// Edge length of the tile of the large 3D noise.
        shape_size_m: f32 = 2400.0, 200.0..=50_000.0, Metres, logarithmic;
        /// Strength of the large 3D noise that makes billows.
        shape_strength: f32 = 1.0, 0.0..=2.0, None;
        /// Edge length of the tile of the small 3D noise.
        detail_size_m: f32 = 320.0, 20.0..=10_000.0, Metres, logarithmic;
        /// Strength of the small noise that erodes the surface. 0 removes its texture reads.
        detail_strength: f32 = 1.0, 0.0..=2.0, None;
        /// How wispy (rather than billowy) the erosion is over the whole height.
        wispiness: f32 = 0.0, 0.0..=1.0, None;
        /// How far curl noise drags the detail. 0 removes its texture reads.
        curl_m: f32 = 60.0, 0.0..=1000.0, Metres;
        /// Edge length of the tile of the curl noise.
        curl_size_m: f32 = 1500.0, 50.0..=50_000.0, Metres, logarithmic;
        /// Octaves of Perlin noise, for that model only.
        perlin: PerlinOctaves = PerlinOctaves::default();
        /// Octaves of Voronoi noise, for that model only.
        voronoi: VoronoiOctaves = VoronoiOctaves::default();
        /// The cellular automaton, for that model only.
        automaton: Automaton = Automaton::default();
        /// Artists' multiplier of the density.
        density: f32 = 1.0, 0.0..=10.0, None;
        /// Steepness of the step from clear air to full density.
        sharpness: f32 = 1.0, 0.1..=4.0, None;
        /// What scattering per metre comes from.
        optics: Optics = Optics::Given;
        /// Liquid water, or ice, in a cubic metre of air at full density, in grams. For optics from droplets.
        water_g_per_m3: f32 = 0.35, 0.0001..=5.0, None, logarithmic;
        /// Droplets, or crystals, in a cubic centimetre of air. For optics from droplets.
        droplets_per_cm3: f32 = 400.0, 0.001..=5000.0, None, logarithmic;
        /// Light scattered per metre at full density. Editing it takes optics as given; editing water or droplets takes them from there.
        scattering_per_m: f32 = 0.08, 0.0..=2.0, PerMetre, logarithmic;
        /// Light absorbed per metre at full density. Water droplets absorb almost nothing.
        absorption_per_m: f32 = 0.0, 0.0..=1.0, PerMetre;
        /// Extinction towards the light relative to the true one; below 1 stands in for multiple scattering (the thesis uses 0.4 on cumulus).
        shadow_extinction_scale: f32 = 1.0, 0.0..=1.0, None;
        /// Directions in which droplets scatter.
        phase: Phase = Phase::default();
        /// Artists' multiplier of the scattered sunlight.
        phase_gain: f32 = 1.0, 0.0..=10.0, None;
        /// Artists' multiplier of all light from this layer.
        brightness: f32 = 1.0, 0.0..=10.0, None;
        /// Speed of this layer relative to the wind.
        wind_scale: f32 = 1.0, -4.0..=4.0, None;
        /// Sideways lean of the tops downwind, over the height of the layer.
        lean_m: f32 = 300.0, 0.0..=20_000.0, Metres;
    }
}

impl Phase {
    /// The formula that this one comes to: without a share of the second lobe there is one.
    pub fn effective_kind(&self) -> PhaseKind {
        match self.kind {
            PhaseKind::TwoLobe if self.back_mix <= 0.0 => PhaseKind::HenyeyGreenstein,
            kind => kind,
        }
    }
}

impl CloudLayer {
    /// Lets its optics come from what was edited last, the parameter of that name: extinction, or water and droplets.
    pub fn follow_edit(&mut self, name: &str) {
        match name {
            "scattering_per_m" => self.optics = Optics::Given,
            "water_g_per_m3" | "droplets_per_cm3" => self.optics = Optics::Droplets,
            _ => {}
        }
    }

    /// Whether the layer can hold any cloud at all.
    pub fn is_visible(&self) -> bool {
        self.enabled && self.density > 0.0 && self.extinction_per_m() > 0.0 && self.top_m - self.base_m >= 1.0
    }

    /// Whether it can hold cloud where the weather map covers so much at most.
    pub fn is_covered(&self, greatest_coverage: f32) -> bool {
        !self.reads_map() || greatest_coverage + self.coverage_offset > 0.0
    }

    /// Whether the weather map says where its clouds are.
    pub fn reads_map(&self) -> bool {
        !matches!(self.model, DensityModel::Grid | DensityModel::Shapes)
    }

    /// Effective radius of its droplets in micrometres: that of equal droplets, broader by k = 0.8 (Martin, Johnson and Spice
    /// 1994). Ice counts as water.
    pub fn effective_radius_um(&self) -> f32 {
        const BROADENING: f32 = 0.8;
        // Grams over a density of a million grams in a cubic metre, and a million cubic centimetres in it.
        let volume_m3 = self.water_g_per_m3 * 1e-6 / (self.droplets_per_cm3 * 1e6);
        1e6 * (3.0 * volume_m3 / (4.0 * std::f32::consts::PI) / BROADENING).cbrt()
    }

    /// Light scattered per metre at full density. Of droplets: 3 Q w / (4 ρ r), w the water in a volume, r the effective radius,
    /// with the efficiency Q = 2 of whatever is large against the wavelength (Stephens 1978).
    pub fn scattering(&self) -> f32 {
        match self.optics {
            Optics::Given => self.scattering_per_m,
            Optics::Droplets => 1.5 * self.water_g_per_m3 / self.effective_radius_um(),
        }
    }

    /// Scattering as given, whatever it came from.
    pub fn with_given_optics(&self) -> Self {
        Self { optics: Optics::Given, scattering_per_m: self.scattering(), ..self.clone() }
    }

    /// Light lost per metre at full density.
    pub fn extinction_per_m(&self) -> f32 {
        self.scattering() + self.absorption_per_m
    }

    /// Whether the small noise is read.
    pub fn has_detail(&self) -> bool {
        self.detail_strength > 0.0
            && !matches!(self.model, DensityModel::Uniform | DensityModel::Grid | DensityModel::Product)
    }

    /// Whether curl noise drags the small noise.
    pub fn has_curl(&self) -> bool {
        self.has_detail() && self.curl_m > 0.0
    }
}
