//! Parameters as text for a clipboard: `key=value` lines, as `--set` takes them, below a line that names the section.

use super::edit::{self, EditError, Entry};
use super::param::Params;

/// Begins the line that names the section.
const SECTION: &str = "# ";

/// What a parameter or a whole section holds, as text; empty if there is none with this key. No key is everything.
pub fn copy<P: Params + Clone>(root: &P, key: &str) -> String {
    let within = if key.is_empty() { String::new() } else { format!("{key}.") };
    let entries = edit::keys(root);
    let line = |key: &str, entry: &Entry| format!("{key}={}\n", entry.value);
    if let Some(entry) = entries.iter().find(|entry| entry.key == key) {
        return line(key, entry);
    }
    let inside = entries.iter().filter_map(|entry| Some(line(entry.key.strip_prefix(&within)?, entry)));
    let lines: String = inside.collect();
    if lines.is_empty() {
        lines
    } else {
        format!("{SECTION}{}\n{lines}", if key.is_empty() { "everything" } else { key })
    }
}

/// Puts copied text into a parameter or a section, which may be another one of the same kind: all of it or nothing. A value
/// alone is taken for the parameter's.
///
/// # Errors
/// [`EditError`] for the first line that does not fit.
pub fn paste<P: Params + Clone>(root: &mut P, key: &str, text: &str) -> Result<(), EditError> {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty()).peekable();
    let is_section = lines.next_if(|line| line.starts_with(SECTION)).is_some();
    let mut edited = root.clone();
    if is_section {
        for line in lines {
            let (below, value) = edit::split(line)?;
            let whole = if key.is_empty() { below.to_owned() } else { format!("{key}.{below}") };
            edit::set(&mut edited, &whole, value)?;
        }
    } else {
        let line = lines.next().unwrap_or_default();
        let value = edit::split(line).map_or(line, |(_, value)| value);
        edit::set(&mut edited, key, value)?;
    }
    *root = edited;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{CloudLayer, Scene};
    use super::*;

    #[test]
    fn sections_and_values_go_from_one_place_to_another() {
        let mut scene = Scene::default();
        scene.layers.push(CloudLayer::default());
        scene.layers[0].base_m = 777.0;
        scene.layers[0].phase.g = 0.5;
        let section = copy(&scene, "layers.0");
        assert!(section.starts_with("# layers.0\n") && section.contains("\nphase.g=0.5\n"), "{section}");
        paste(&mut scene, "layers.1", &section).expect("the same kind");
        assert_eq!(scene.layers[0], scene.layers[1]);
        let value = copy(&scene, "layers.0.base_m");
        assert_eq!(value.trim(), "layers.0.base_m=777");
        paste(&mut scene, "layers.1.top_m", &value).expect("any number");
        assert_eq!(scene.layers[1].top_m, 777.0);
        paste(&mut scene, "layers.1.base_m", " 42 ").expect("a value alone");
        assert_eq!(scene.layers[1].base_m, 42.0);
        let mut other = Scene::default();
        let whole = copy(&Scene { layers: other.layers.clone(), ..scene.clone() }, "");
        paste(&mut other, "", &whole).expect("everything");
        assert_eq!((&other.wind, &other.weather), (&scene.wind, &scene.weather));
        assert_eq!(copy(&scene, "nothing"), "");
    }

    #[test]
    fn what_does_not_fit_changes_nothing() {
        let mut scene = Scene::default();
        let before = scene.clone();
        for (key, text) in [
            ("layers.0", copy(&scene, "wind")),
            ("wind.speed_mps", "fast".to_owned()),
            ("wind", "speed_mps=3".to_owned()),
        ] {
            assert!(paste(&mut scene, key, &text).is_err(), "{key}");
            assert_eq!(scene, before, "{key}");
        }
    }
}
