//! What belongs to the user and to no sky: theme, size of the panels, what was opened last, favourites.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::choices;
use crate::export::ExportError;
use crate::export::atomic::write_atomically;

/// Older files are forgotten.
const MOST_RECENT: usize = 12;
/// A larger file is none of this program's.
const MOST_BYTES: u64 = 1 << 20;

choices! {
    /// Whose habits of the mouse the picture follows. The right button looks and flies in all of them.
    pub enum Habit {
        /// Middle orbits, with Shift it pans, with Ctrl it moves nearer. Shift and the left one orbit too.
        Blender ("Blender"),
        /// With Alt the left orbits, the middle pans, the right moves nearer.
        Maya ("Maya"),
        /// With Alt as in Maya; the middle pans, the left walks and turns.
        Unreal ("Unreal"),
    }
}

choices! {
    /// What lengths and speeds are shown and typed in. Files and `--set` have metres.
    pub enum Units {
        /// Metres, metres per second.
        Metric ("Metres"),
        /// Feet, knots, as pilots have them.
        Aviation ("Feet and knots"),
    }
}

/// Everything that is kept between runs. Fields that a file does not have, or has too many of, do no harm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Whether panels are light; `None` as the system wants it.
    pub light: Option<bool>,
    /// Size of the panels relative to the usual one.
    pub zoom: f32,
    /// Files that were opened or saved, the last first.
    pub recent: Vec<PathBuf>,
    /// Presets with a star: short names of built-in ones, and files.
    pub favourites: BTreeSet<PathBuf>,
    /// What the mouse does over the picture.
    pub habit: Habit,
    /// What lengths and speeds are shown in.
    pub units: Units,
    /// Whether the first steps have been told.
    pub is_introduced: bool,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            light: None,
            zoom: 1.0,
            recent: Vec::new(),
            favourites: BTreeSet::new(),
            habit: Habit::Blender,
            units: Units::Metric,
            is_introduced: false,
        }
    }
}

impl Preferences {
    /// Reads the file. One that cannot be understood is put aside beside it, as somebody may want to mend it.
    pub fn load(path: &Path) -> Self {
        let is_sound = std::fs::metadata(path).is_ok_and(|about| about.is_file() && about.len() <= MOST_BYTES);
        let text = is_sound.then(|| std::fs::read_to_string(path).ok()).flatten();
        let read: Option<Self> = text.and_then(|text| ron::from_str(&text).ok());
        if read.is_none() && path.is_file() {
            // What cannot be moved is replaced at the next change.
            let _ = std::fs::rename(path, path.with_extension("ron.damaged"));
        }
        let read = read.unwrap_or_default();
        let zoom = if read.zoom.is_finite() { read.zoom.clamp(0.5, 4.0) } else { 1.0 };
        Self { zoom, ..read }
    }

    /// Writes the file, whole or not at all. `before` is how they were read or written last: what has not changed since is as
    /// another window has left it.
    ///
    /// # Errors
    /// If the folder or the file cannot be written.
    pub fn save(&mut self, path: &Path, before: &Self) -> Result<(), ExportError> {
        let others = Self::load(path);
        for other in others.recent {
            if !self.recent.contains(&other) {
                self.recent.push(other);
            }
        }
        self.recent.truncate(MOST_RECENT);
        let given = self.favourites.difference(&before.favourites).cloned();
        let taken: BTreeSet<_> = before.favourites.difference(&self.favourites).cloned().collect();
        self.favourites = others.favourites.into_iter().filter(|star| !taken.contains(star)).chain(given).collect();
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| ExportError::writing(path, error))?;
        }
        let pretty = ron::ser::PrettyConfig::new();
        let text = ron::ser::to_string_pretty(self, pretty)
            .map_err(|error| ExportError::writing(path, std::io::Error::other(error)))?;
        write_atomically(path, |writer| {
            std::io::Write::write_all(writer, text.as_bytes()).map_err(|error| ExportError::writing(path, error))
        })
    }

    /// Notes that a file was opened or saved.
    pub fn used(&mut self, file: &Path) {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        self.recent.retain(|other| *other != file);
        self.recent.insert(0, file);
        self.recent.truncate(MOST_RECENT);
    }

    /// Gives a preset a star, or takes it.
    pub fn toggle_favourite(&mut self, source: &Path) {
        if !self.favourites.remove(source) {
            self.favourites.insert(source.to_owned());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preferences_come_back_and_windows_do_not_fight() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("state/preferences.ron");
        assert_eq!(Preferences::load(&path), Preferences::default(), "no file");
        let mut one = Preferences { light: Some(true), zoom: 1.5, ..Preferences::default() };
        one.used(Path::new("/skies/a.ron"));
        one.used(Path::new("/skies/b.ron"));
        one.used(Path::new("/skies/a.ron"));
        assert_eq!(one.recent, [PathBuf::from("/skies/a.ron"), PathBuf::from("/skies/b.ron")]);
        one.toggle_favourite(Path::new("stormy"));
        one.save(&path, &Preferences::default()).expect("written");
        let mut other = Preferences::default();
        other.used(Path::new("/skies/c.ron"));
        other.save(&path, &Preferences::default()).expect("written");
        let read = Preferences::load(&path);
        assert!(read.favourites.contains(Path::new("stormy")), "the other window's star");
        let mut without = read.clone();
        without.toggle_favourite(Path::new("stormy"));
        without.save(&path, &read).expect("written");
        assert!(Preferences::load(&path).favourites.is_empty(), "a star that was taken is gone");
        assert_eq!(read.recent.len(), 3, "both windows' files: {:?}", read.recent);
        assert_eq!(read.recent[0], PathBuf::from("/skies/c.ron"));
    }

    #[test]
    fn damaged_preferences_are_the_usual_ones() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("preferences.ron");
        for (text, zoom) in
            [("", 1.0), ("(((", 1.0), ("(zoom: NaN)", 1.0), ("(zoom: 2.0, unknown: 3)", 2.0), ("(light: 7)", 1.0)]
        {
            std::fs::write(&path, text).expect("written");
            assert_eq!(Preferences::load(&path).zoom, zoom, "{text}");
        }
        let aside = std::fs::read_to_string(folder.path().join("preferences.ron.damaged")).expect("put aside");
        assert_eq!(aside, "(light: 7)", "as it was");
    }
}
