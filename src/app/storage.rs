//! The presets there are to choose from.

use std::path::Path;

use crate::scene::Preset;
use crate::scene::builtin::BUILTINS;
use crate::ui::{Entry, Library};

/// Lists the built-in presets and those in the user's folder; files that are no presets are left out.
pub(super) fn library(folder: &Path) -> Library {
    let builtin = BUILTINS.iter().filter_map(|builtin| {
        let preset = builtin.preset().ok()?;
        Some(Entry {
            name: preset.name,
            description: preset.description,
            source: builtin.name.into(),
            is_builtin: true,
        })
    });
    let mut user: Vec<Entry> = Vec::new();
    for file in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = file.path();
        if path.extension().is_some_and(|ending| ending == "ron")
            && let Ok(preset) = Preset::load(&path)
        {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let name = if preset.name.is_empty() { stem } else { preset.name };
            user.push(Entry { name, description: preset.description, source: path, is_builtin: false });
        }
    }
    user.sort_by(|one, other| one.name.cmp(&other.name));
    Library { builtin: builtin.collect(), user, folder: folder.to_owned(), search: String::new() }
}
