//! The ten genera of clouds (World Meteorological Organization, "International Cloud Atlas", 2017) as recipes: each is the cloud
//! of a built-in sky, whose layers another sky can take over.

use super::{BodyForm, CloudLayer, MAX_LAYERS, Optics, Scene, builtin};
use crate::choices;

choices! {
    /// A genus of clouds; of cumulus its three usual species.
    pub enum Genus {
        /// Fibres and tufts of ice, white and without shadows.
        Cirrus ("Cirrus"),
        /// Grains and ripples in a thin high sheet.
        Cirrocumulus ("Cirrocumulus"),
        /// A veil of ice over the whole sky, through which the sun throws shadows.
        Cirrostratus ("Cirrostratus"),
        /// Flakes and rolls of water cloud at a middle height.
        Altocumulus ("Altocumulus"),
        /// A grey sheet at a middle height; the sun is a bright place in it.
        Altostratus ("Altostratus"),
        /// A deep dark sheet with scud below it, from which it rains.
        Nimbostratus ("Nimbostratus"),
        /// Rolls and tiles of low cloud, with light gaps.
        Stratocumulus ("Stratocumulus"),
        /// A low grey sheet.
        Stratus ("Stratus"),
        /// Small flat heaps of fair weather.
        CumulusHumilis ("Cumulus humilis"),
        /// Heaps about as high as wide.
        CumulusMediocris ("Cumulus mediocris"),
        /// Towers with crowns like cauliflower.
        CumulusCongestus ("Cumulus congestus"),
        /// Thunderclouds with anvils of ice.
        Cumulonimbus ("Cumulonimbus"),
    }
}

/// Why a genus cannot be added to a sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the sky would have more than {MAX_LAYERS} cloud layers; remove one first")]
pub struct TooManyLayers;

impl Genus {
    /// The built-in sky that shows it, how many of its first layers are the genus, and what kind of bodies it has.
    fn recipe(self) -> (&'static str, usize, BodyForm) {
        match self {
            Self::Cirrus => ("cirrus", 1, BodyForm::Stratocumulus),
            Self::Cirrocumulus => ("cirrocumulus", 1, BodyForm::Stratocumulus),
            Self::Cirrostratus => ("cirrostratus", 1, BodyForm::Stratus),
            Self::Altocumulus => ("altocumulus", 1, BodyForm::Stratocumulus),
            Self::Altostratus => ("altostratus", 1, BodyForm::Stratus),
            Self::Nimbostratus => ("nimbostratus", 2, BodyForm::Cumulus),
            Self::Stratocumulus => ("stratocumulus", 1, BodyForm::Stratocumulus),
            Self::Stratus => ("stratus", 1, BodyForm::Stratus),
            Self::CumulusHumilis => ("clear_puffs", 1, BodyForm::Cumulus),
            Self::CumulusMediocris => ("fair_weather", 1, BodyForm::Cumulus),
            Self::CumulusCongestus => ("towering", 1, BodyForm::Cumulus),
            Self::Cumulonimbus => ("cumulonimbus", 2, BodyForm::Cumulus),
        }
    }

    /// The sky that shows it.
    fn sky(self) -> Option<Scene> {
        // A test finds and loads them all.
        Some(builtin::find(self.recipe().0)?.preset().ok()?.scene)
    }

    /// Gives a sky the clouds, the weather and the domain of this genus in place of its own. Light, air and camera stay.
    pub fn replace(self, scene: &mut Scene) {
        if let Some(sky) = self.sky() {
            (scene.layers, scene.weather, scene.domain) = (sky.layers, sky.weather, sky.domain);
        }
    }

    /// Adds it to a sky's own clouds, as much of it as in its own sky: coverage, map and domain of the sky stay, and the new
    /// layers make up for the first two, on this side of a front.
    ///
    /// # Errors
    /// [`TooManyLayers`]; the sky is then as it was.
    pub fn join(self, scene: &mut Scene) -> Result<(), TooManyLayers> {
        let (_, count, form) = self.recipe();
        let Some(sky) = self.sky() else { return Ok(()) };
        if scene.layers.len() + count > MAX_LAYERS {
            return Err(TooManyLayers);
        }
        let more = sky.weather.coverage - scene.weather.coverage;
        let larger = sky.weather.size_m / scene.weather.size_m;
        scene.layers.extend(sky.layers.into_iter().take(count).map(|layer| CloudLayer {
            form: if layer.form == BodyForm::Map { form } else { layer.form },
            coverage_offset: (layer.coverage_offset + more).clamp(-1.0, 1.0),
            map_scale: (layer.map_scale * larger).clamp(0.05, 20.0),
            ..layer
        }));
        Ok(())
    }
}

/// What follows from a layer's water and droplets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derived {
    /// Effective radius of the droplets, in micrometres; `None` where optics are given.
    pub effective_radius_um: Option<f32>,
    /// Light lost per metre at full density.
    pub extinction_per_m: f32,
    /// Optical depth from base to top at full density: the most that the layer can have.
    pub optical_depth: f32,
}

impl Derived {
    /// Of a layer.
    pub fn of(layer: &CloudLayer) -> Self {
        let extinction_per_m = layer.extinction_per_m() * layer.density;
        let is_physical = layer.optics == Optics::Droplets;
        Self {
            effective_radius_um: is_physical.then(|| layer.effective_radius_um()),
            extinction_per_m,
            optical_depth: extinction_per_m * (layer.top_m - layer.base_m).max(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::edit::faults;
    use super::*;
    use crate::scene::param::Choice as _;

    #[test]
    fn every_genus_has_a_sky_and_can_be_added_to_any_other() {
        for genus in Genus::ALL {
            let sky = genus.sky().unwrap_or_else(|| panic!("{genus:?} has no sky"));
            let (_, count, _) = genus.recipe();
            assert!(sky.layers.len() >= count, "{genus:?}");
            let mut scene = Scene::default();
            scene.weather.size_m = 12_000.0;
            genus.join(&mut scene).expect("there is room");
            assert_eq!(scene.layers.len(), 1 + count, "{genus:?}");
            let (own, added) = (&sky.layers[0], &scene.layers[1]);
            assert!(added.form != BodyForm::Map, "{genus:?}: whatever the map of the other sky says");
            let covered = |scene: &Scene, layer: &CloudLayer| scene.weather.coverage + layer.coverage_offset;
            assert!((covered(&sky, own) - covered(&scene, added)).abs() < 1e-6, "{genus:?}: as much cloud");
            let cells = |scene: &Scene, layer: &CloudLayer| scene.weather.size_m * layer.map_scale;
            assert!((cells(&sky, own) / cells(&scene, added) - 1.0).abs() < 1e-5, "{genus:?}: as large");
            assert!(faults(&scene).is_empty() && scene.problems().is_empty(), "{genus:?}: {:?}", faults(&scene));
            genus.replace(&mut scene);
            assert_eq!((scene.layers, scene.weather), (sky.layers, sky.weather), "{genus:?}");
        }
        let mut full = Scene { layers: vec![CloudLayer::default(); MAX_LAYERS], ..Scene::default() };
        assert_eq!(Genus::Cirrus.join(&mut full), Err(TooManyLayers));
    }

    /// The genera with their water, as `docs/genera.md` has them.
    fn page() -> String {
        let mut page = "# Genera\n\n\
            The clouds of each genus in the built-in sky that shows it: its first layer, and what follows from its water. Droplets are\n\
            crystals where it is ice. Optical depth is that of the whole thickness at full density, the most there can be; real columns\n\
            have less. `--set genus=NAME` gives a sky these clouds, `--set genus=+NAME` adds them.\n\n\
            This page is written by a test of `scene::genus`; do not edit it.\n\n\
            | genus | sky | base, m | top, m | water, g/m³ | droplets, 1/cm³ | effective radius, µm | free path, m | optical depth |\n\
            |---|---|---|---|---|---|---|---|---|\n"
            .to_owned();
        for genus in Genus::ALL {
            let sky = genus.sky().expect("it has one");
            let layer = &sky.layers[0];
            let Derived { effective_radius_um, extinction_per_m, optical_depth } = Derived::of(layer);
            page.push_str(&format!(
                "| {} | `{}` | {} | {} | {} | {} | {:.1} | {:.0} | {optical_depth:.1} |\n",
                genus.title(),
                genus.recipe().0,
                layer.base_m,
                layer.top_m,
                layer.water_g_per_m3,
                layer.droplets_per_cm3,
                effective_radius_um.unwrap_or_else(|| panic!("{genus:?} is not given by its water")),
                1.0 / extinction_per_m,
            ));
        }
        page
    }

    #[test]
    fn the_page_of_genera_is_the_one_that_their_skies_give() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/genera.md");
        if std::env::var_os("NEPHOSCOPE_UPDATE").is_some() {
            std::fs::write(path, page()).expect("docs/genera.md can be written");
        }
        let stored = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            stored == page(),
            "docs/genera.md differs from the presets; run `NEPHOSCOPE_UPDATE=1 cargo test --lib genus`"
        );
    }

    #[test]
    fn droplets_make_the_extinction_of_the_literature() {
        // Water in g/m³, droplets in a cm³, effective radius in µm, extinction in 1/m: Stephens 1978 with k = 0.8.
        for (water, droplets, radius, extinction) in
            [(0.35, 400.0, 6.4, 0.082), (0.55, 350.0, 7.8, 0.106), (0.9, 300.0, 9.6, 0.140), (0.15, 150.0, 6.7, 0.034)]
        {
            let layer = CloudLayer {
                optics: Optics::Droplets,
                water_g_per_m3: water,
                droplets_per_cm3: droplets,
                ..CloudLayer::default()
            };
            let derived = Derived::of(&layer);
            let seen = derived.effective_radius_um.expect("it follows from the droplets");
            assert!((seen - radius).abs() < 0.06, "{water} g: {seen} µm, not {radius}");
            assert!((derived.extinction_per_m - extinction).abs() < 6e-4, "{water} g: {}", derived.extinction_per_m);
            // τ = 3/2 · water path / (density of water · effective radius).
            let path_g_per_m2 = water * (layer.top_m - layer.base_m);
            let depth = 1.5 * path_g_per_m2 / radius;
            assert!((derived.optical_depth / depth - 1.0).abs() < 0.01, "{}, not {depth}", derived.optical_depth);
            let given = layer.with_given_optics();
            assert_eq!((given.optics, given.extinction_per_m()), (Optics::Given, layer.extinction_per_m()));
        }
    }
}
