//! The presets that the program carries, in the order of the gallery.

use super::Preset;
use super::preset::PresetError;

/// A preset inside the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Builtin {
    /// Its name on the command line: the stem of its file in `presets/`.
    pub name: &'static str,
    /// The text of that file.
    pub ron: &'static str,
    /// A small picture of it as PNG, made by `scripts/gallery.sh`.
    pub picture: &'static [u8],
}

impl Builtin {
    /// The preset.
    ///
    /// # Errors
    /// None for a released program: a test loads them all.
    pub fn preset(&self) -> Result<Preset, PresetError> {
        Preset::from_ron(self.ron, &format!("presets/{}.ron", self.name))
    }
}

macro_rules! builtins {
    ($($name:literal,)*) => {
        &[$( Builtin {
            name: $name,
            ron: include_str!(concat!("../../presets/", $name, ".ron")),
            picture: include_bytes!(concat!("../../thumbnails/", $name, ".png")),
        }, )*]
    };
}

/// All of them; the first is the sky that a start without arguments shows.
pub const BUILTINS: &[Builtin] = builtins![
    "fair_weather",
    "puffy_afternoon",
    "clear_puffs",
    "towering",
    "stratocumulus",
    "stratus",
    "broken_sunset",
    "stormy",
    "moonlit",
    "above_clouds",
    "cirrus",
    "cirrocumulus",
    "cirrostratus",
    "altocumulus",
    "altostratus",
    "nimbostratus",
    "cumulonimbus",
    "mackerel_sunset",
    "mares_tails",
    "thesis",
    "box_afternoon",
    "box_day",
    "box_puffy",
    "box_night",
    "box_sunset",
    "box_clear",
    "box_stormy",
    "living_cumulus",
    "living_evening",
    "sculpted_heaps",
    "towers_in_fog",
    "contrails",
    "island_eddies",
];

/// The built-in preset of that name.
pub fn find(name: &str) -> Option<&'static Builtin> {
    BUILTINS.iter().find(|builtin| builtin.name == name)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::edit::faults;
    use super::*;

    #[test]
    fn the_table_is_the_folder() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/presets");
        let files: BTreeSet<String> = std::fs::read_dir(folder)
            .expect("presets/ is there")
            .filter_map(|entry| entry.expect("it can be listed").file_name().into_string().ok())
            .collect();
        let table: BTreeSet<String> = BUILTINS.iter().map(|builtin| format!("{}.ron", builtin.name)).collect();
        assert_eq!(files, table, "presets/ and the table in src/scene/builtin.rs must agree");
    }

    #[test]
    fn each_loads_in_range_and_comes_back_from_its_own_text() {
        for builtin in BUILTINS {
            let preset = builtin.preset().unwrap_or_else(|error| panic!("{error}"));
            assert!(!preset.name.is_empty() && !preset.description.is_empty(), "{} lacks words", builtin.name);
            assert!(faults(&preset.scene).is_empty(), "{}: {:?}", builtin.name, faults(&preset.scene));
            let again = Preset::from_ron(&preset.to_ron(), builtin.name).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(again, preset, "{}", builtin.name);
            assert!(preset.scene.visible_layers().count() > 0, "{} holds no cloud", builtin.name);
        }
    }
}
