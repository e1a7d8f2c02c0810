//! The closed list of what a frame may need, one row each; everything that concerns all effects runs over it: the plan's
//! verdicts, the overlay, `bench --suite effects`, docs/effects.md, and the two proofs of `tests/gpu/effects.rs`.

/// What an effect is, and the traces that it alone leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectInfo {
    /// Its name, as the overlay and `--force` have it.
    pub name: &'static str,
    /// What is not in the picture without it, or what is computed in vain.
    pub does: &'static str,
    /// Shader flags.
    pub flags: &'static [&'static str],
    /// Textures and buffers, by the names that shaders give them.
    pub bindings: &'static [&'static str],
    /// Passes.
    pub passes: &'static [&'static str],
    /// Whether the picture can be made without it.
    pub can_be_off: bool,
    /// How much of a value the picture may differ by where it runs although it is needless: 0 is bit for bit.
    pub may_differ: f32,
}

macro_rules! effects {
    ($( $Effect:ident ($name:literal, $does:literal) {
        flags: $flags:expr, bindings: $bindings:expr, passes: $passes:expr $(, essential: $essential:literal)? $(, may_differ: $differ:literal)?
    } )*) => {
        /// Something that a frame may or may not need.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Effect { $( #[doc = $does] $Effect, )* }

        impl Effect {
            /// All of them, in the order in which a frame comes to them.
            pub const ALL: &'static [Self] = &[$( Self::$Effect, )*];

            /// Its row of the table.
            pub const fn info(self) -> EffectInfo {
                match self {
                    $( Self::$Effect => EffectInfo {
                        name: $name,
                        does: $does,
                        flags: &$flags,
                        bindings: &$bindings,
                        passes: &$passes,
                        can_be_off: true $( && !$essential )?,
                        may_differ: 0.0 $( + $differ )?,
                    }, )*
                }
            }
        }
    };
}

effects! {
    SkyTables ("sky tables", "Light and transparency of the air, from which everything else is lit.") {
        flags: [],
        bindings: ["sky_view", "sky_transmittance", "sky_multiscatter"],
        passes: ["sky_transmittance", "sky_multiscatter", "sky_view"],
        essential: true
    }
    AirTable ("table of the air", "The air between the eye and every distance, for the ground and for clouds.") {
        flags: [], bindings: ["sky_aerial_light"], passes: ["sky_aerial"], essential: true
    }
    SkyLightTable ("table of sky light", "Mean radiances of the sky, for the ground and for clouds.") {
        flags: [], bindings: ["sky_ambient"], passes: ["sky_ambient"], essential: true
    }
    MoonlitAir ("moonlit air", "Moonlight that the air scatters.") {
        flags: ["MOONLIT"], bindings: [], passes: [], may_differ: 4e-3
    }
    SunDisc ("sun's disc", "The sun itself, darker at its limb.") {
        flags: ["SUN_DISC"], bindings: [], passes: []
    }
    MoonDisc ("moon's disc", "The moon itself, with its phase.") {
        flags: ["MOON_DISC"], bindings: [], passes: []
    }
    Stars ("stars", "Stars of the night.") {
        flags: ["STARS"], bindings: [], passes: []
    }
    Ground ("ground", "The ground, and where it ends the view.") {
        flags: ["GROUND"], bindings: ["ground_distance"], passes: []
    }
    Terrain ("terrain", "Hills and mountains.") {
        flags: ["TERRAIN"], bindings: ["terrain_map"], passes: ["bake_terrain"]
    }
    Solids ("solid shapes", "Solid things, and their shadows.") {
        flags: ["SOLIDS"], bindings: [], passes: []
    }
    GroundEverywhere ("ground in open rows", "A search for ground in rows of the picture that lie above all of it.") {
        flags: [], bindings: [], passes: [], essential: true
    }
    CloudShadows ("cloud shadows", "Shadows of clouds on the ground.") {
        flags: ["SHADOW"], bindings: ["cloud_shadow"], passes: ["cloud_shadow"]
    }
    Clouds ("clouds", "The march through the clouds.") {
        flags: ["CLOUDS"], bindings: ["cloud"], passes: ["march"]
    }
    CloudsEverywhere ("clouds in clear rows", "A march in rows of the picture that no cloud can be in.") {
        flags: [], bindings: [], passes: [], essential: true
    }
    Profile ("profile model", "Clouds from height profiles, billows and wisps.") {
        flags: ["PROFILE"], bindings: [], passes: []
    }
    Thesis ("thesis model", "Clouds of Koblížek's thesis.") {
        flags: ["THESIS"], bindings: ["worley_noise"], passes: ["bake_worley"]
    }
    Uniform ("uniform model", "Layers that are as dense everywhere as the map says.") {
        flags: ["UNIFORM"], bindings: [], passes: []
    }
    Texture ("weather texture model", "Clouds of Costa's weather texture.") {
        flags: ["TEXTURE"], bindings: [], passes: []
    }
    Product ("Perlin × Voronoi model", "Clouds of Thomann's two noises.") {
        flags: ["PRODUCT"], bindings: ["octave_noise"], passes: ["bake_octave"]
    }
    Automaton ("cellular automaton", "Clouds that appear, merge and vanish by rules between neighbours.") {
        flags: ["AUTOMATON"],
        bindings: ["automaton_cells", "automaton_bound"],
        passes: ["automaton_favour", "automaton_advance", "automaton_smooth", "automaton_bound"]
    }
    Shear ("wind shear", "Cells of the automaton that the wind carries on, the higher the farther.") {
        flags: [], bindings: [], passes: ["automaton_drift"]
    }
    Shapes ("shapes model", "Clouds in the form of shapes.") {
        flags: ["SHAPES"], bindings: [], passes: []
    }
    ShapeNoise ("large noise", "Billows of the profile model and of the weather texture.") {
        flags: [], bindings: ["shape_noise"], passes: ["bake_shape"], essential: true
    }
    Grid ("voxel grid", "Clouds from the voxels of a file.") {
        flags: ["GRID"], bindings: ["voxels"], passes: [], essential: true
    }
    Baked ("baked voxels", "Layers baked into voxels before they are read.") {
        flags: ["BAKED"], bindings: [], passes: ["bake_voxels"], essential: true
    }
    WeatherMap ("weather map", "Where clouds stand.") {
        flags: [], bindings: ["weather_map"], passes: ["weather_map"], essential: true
    }
    GrowingMap ("growing map", "Weather maps that grow out of an image.") {
        flags: [], bindings: ["example_normal"], passes: ["weather_grow"], essential: true
    }
    Flows ("flows", "Flows that carry the weather map.") {
        flags: [], bindings: ["flow"], passes: ["weather_flow"], may_differ: 1e-3
    }
    Painting ("painted map", "Clouds painted on the weather map, or taken away from it.") {
        flags: [], bindings: ["painted"], passes: ["paint"]
    }
    Detail ("detail", "Erosion of the clouds' surface by the small noise.") {
        flags: ["DETAIL"], bindings: ["detail_noise"], passes: ["bake_detail"]
    }
    Curl ("curl", "Curls into which the detail is dragged.") {
        flags: ["CURL"], bindings: ["curl_noise"], passes: ["bake_curl"]
    }
    Front ("coverage front", "Another coverage that the wind brings.") {
        flags: ["FRONT"], bindings: [], passes: [], may_differ: 1e-6
    }
    ClearWays ("map of clear ways", "How far it is to any cloud, so that clear air is crossed in long steps.") {
        flags: ["SKIP"], bindings: ["clear_ways"], passes: ["clear_cells", "clear_row", "clear_spread"]
    }
    KeyLight ("light march", "Light of sun or moon on the clouds, and its march through them.") {
        flags: ["LIT"], bindings: [], passes: []
    }
    SunGrid ("grid of sun depth", "The sun's optical depth on a grid, from which far steps towards the light are read.") {
        flags: ["SUN_GRID"], bindings: ["sun_depths"], passes: ["sun_sweep"]
    }
    Octaves ("scattering octaves", "Light scattered more than once in the clouds.") {
        flags: [], bindings: [], passes: []
    }
    HenyeyGreenstein ("Henyey-Greenstein phase", "One lobe of scattering.") {
        flags: ["PHASE_ONE_LOBE"], bindings: [], passes: []
    }
    TwoLobes ("second lobe", "Scattering back towards the light, by a second lobe.") {
        flags: ["PHASE_TWO_LOBES"], bindings: [], passes: []
    }
    CornetteShanks ("Cornette-Shanks phase", "Scattering after Cornette and Shanks.") {
        flags: ["PHASE_CORNETTE_SHANKS"], bindings: [], passes: []
    }
    Schlick ("Schlick phase", "Scattering after Schlick.") {
        flags: ["PHASE_SCHLICK"], bindings: [], passes: []
    }
    Rayleigh ("Rayleigh phase", "Scattering by particles far smaller than the wavelength.") {
        flags: ["PHASE_RAYLEIGH"], bindings: [], passes: []
    }
    Ambient ("ambient light", "Light of the whole sky on the clouds.") {
        flags: ["AMBIENT"], bindings: [], passes: []
    }
    Air ("aerial perspective", "Air between the eye and the clouds.") {
        flags: ["AIR"], bindings: [], passes: []
    }
    Distance ("distance of clouds", "How far the clouds of each pixel are, for reprojection and for files.") {
        flags: ["DISTANCE"], bindings: ["distance_out"], passes: [], essential: true
    }
    Temporal ("temporal reprojection", "Pixels taken from the picture before.") {
        flags: ["HISTORY"], bindings: ["history_cloud"], passes: ["temporal"]
    }
    Sunshafts ("sunshafts", "Streaks of light in the haze.") {
        flags: ["SHAFTS"], bindings: ["shafts_light"], passes: ["sunshafts"]
    }
    Glow ("glow", "The artists' glow of thin cloud about the light.") {
        flags: ["GLOW"], bindings: ["glow"], passes: []
    }
    Grading ("grading", "The display's contrast and saturation.") {
        flags: ["GRADED"], bindings: [], passes: [], may_differ: 4e-3
    }
}

impl Effect {
    /// The effect of a name, upper case or not.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|effect| effect.info().name.eq_ignore_ascii_case(name))
    }

    const fn bit(self) -> u64 {
        1 << self as u32
    }
}

/// Effects that run, or do not, whatever the plan would say; and marks over the picture that no sky asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Forced {
    on: u64,
    off: u64,
    /// Whether what clips on the screen is striped.
    pub stripes: bool,
}

impl Forced {
    /// The same with an effect forced on or off, or left to the plan.
    #[must_use]
    pub fn with(self, effect: Effect, force: Option<bool>) -> Self {
        let rest = !effect.bit();
        let bit = |wanted: bool| if force == Some(wanted) { effect.bit() } else { 0 };
        Self { on: self.on & rest | bit(true), off: self.off & rest | bit(false), ..self }
    }

    /// Whether an effect is forced on or off.
    pub fn get(self, effect: Effect) -> Option<bool> {
        match (self.on & effect.bit() != 0, self.off & effect.bit() != 0) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        }
    }

    /// Whether all effects are left to the plan.
    pub fn is_empty(self) -> bool {
        self.on | self.off == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_and_differ() {
        assert!(Effect::ALL.len() <= 64, "a bit each");
        for effect in Effect::ALL {
            assert_eq!(Effect::named(effect.info().name), Some(*effect));
            assert!(effect.info().does.ends_with('.'), "{effect:?}");
        }
        assert_eq!(Effect::named("Sunshafts"), Some(Effect::Sunshafts));
        assert_eq!(Effect::named("sunshaft"), None);
    }

    #[test]
    fn one_force_replaces_another() {
        let forced = Forced::default().with(Effect::Curl, Some(true)).with(Effect::Stars, Some(false));
        assert_eq!((forced.get(Effect::Curl), forced.get(Effect::Stars)), (Some(true), Some(false)));
        let forced = forced.with(Effect::Curl, Some(false));
        assert_eq!((forced.get(Effect::Curl), forced.get(Effect::Detail)), (Some(false), None));
        assert!(forced.with(Effect::Curl, None).with(Effect::Stars, None).is_empty());
    }
}
