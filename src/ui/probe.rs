//! Small visitors that ask about parameters or change many of them: what is modified, what a filter matches, reset,
//! duplicate, and set a file's name by its key.

use crate::scene::Strokes;
use crate::scene::morph::Values;
use crate::scene::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Visitor, label};

/// Parameters of the simple view; the number of a list's item is left out.
const SIMPLE: [&str; 14] = [
    "layers.base_m",
    "layers.top_m",
    "layers.density",
    "layers.detail_strength",
    "weather.coverage",
    "weather.size_m",
    "wind.from_deg",
    "wind.speed_mps",
    "sun.elevation_deg",
    "sun.azimuth_deg",
    "sun.hour_h",
    "air.haze",
    "sunshafts.strength",
    "display.exposure_ev",
];

/// Which parameters are shown.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Filter<'f> {
    /// What name, key or help must contain, in lower case.
    pub text: &'f str,
    /// Only those that differ from their defaults.
    pub modified: bool,
    /// Only those of the simple view.
    pub simple: bool,
}

impl Filter<'_> {
    /// Whether anything may be hidden.
    pub(super) fn hides(self) -> bool {
        !self.text.is_empty() || self.modified || self.simple
    }

    /// Whether a parameter is shown.
    pub(super) fn fits(self, key: &str, doc: &str, modified: bool) -> bool {
        let name = key.rsplit('.').next().unwrap_or(key);
        let is_simple = || {
            let parts = key.split('.').filter(|part| part.parse::<usize>().is_err());
            SIMPLE.contains(&parts.collect::<Vec<_>>().join(".").as_str())
        };
        let contains = self.text.is_empty()
            || key.contains(self.text)
            || label(name).to_lowercase().contains(self.text)
            || doc.to_lowercase().contains(self.text);
        contains && (modified || !self.modified) && (!self.simple || is_simple())
    }

    /// The filter for the rows of a section: its text does not count where the section's own title has it.
    pub(super) fn for_children(self, title: &str) -> Self {
        if title.to_lowercase().contains(self.text) { Self { text: "", ..self } } else { self }
    }
}

/// Counts parameters that differ from their defaults, and those that pass a filter.
#[derive(Debug)]
pub(super) struct Probe<'f> {
    filter: Filter<'f>,
    prefix: String,
    /// Parameters that differ from their defaults.
    pub modified: usize,
    /// Parameters that pass the filter.
    pub matches: usize,
}

impl<'f> Probe<'f> {
    /// A probe for the group with this key.
    pub(super) fn new(filter: Filter<'f>, key: &str) -> Self {
        Self { filter, prefix: key.to_owned(), modified: 0, matches: 0 }
    }

    fn see(&mut self, name: &str, doc: &str, modified: bool) {
        self.modified += usize::from(modified);
        self.matches += usize::from(self.filter.fits(&format!("{}.{name}", self.prefix), doc, modified));
    }
}

impl Visitor for Probe<'_> {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        self.see(info.name, info.doc, *value != info.default);
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        self.see(info.name, info.doc, *value != info.default);
    }

    fn switch(&mut self, info: &Info<bool>, value: &mut bool) {
        self.see(info.name, info.doc, *value != info.default);
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        self.see(info.name, info.doc, *index != info.default);
    }

    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        self.see(info.name, info.doc, *value != info.default);
    }

    fn file(&mut self, info: &Info<FileName>, value: &mut FileName) {
        self.see(info.name, info.doc, *value != info.default);
    }

    fn strokes(&mut self, info: &Info<Strokes>, value: &mut Strokes) {
        self.see(info.name, info.doc, *value != info.default);
    }

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        let mut inner = Self::new(self.filter.for_children(info.title), &format!("{}.{}", self.prefix, info.name));
        children(&mut inner);
        self.modified += inner.modified;
        self.matches += inner.matches;
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        for index in 0..list.count() {
            self.group(info, &mut |visitor| list.visit_item(index, visitor));
        }
    }
}

/// Puts every parameter back to its default. Lists keep their length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reset;

impl Visitor for Reset {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        *value = info.default;
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        *value = info.default;
    }

    fn switch(&mut self, info: &Info<bool>, value: &mut bool) {
        *value = info.default;
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        *index = info.default;
    }

    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        *value = info.default;
    }

    fn file(&mut self, info: &Info<FileName>, value: &mut FileName) {
        value.clone_from(&info.default);
    }

    fn strokes(&mut self, info: &Info<Strokes>, value: &mut Strokes) {
        value.clone_from(&info.default);
    }

    fn group(&mut self, _: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        children(self);
    }

    fn list(&mut self, _: &GroupInfo, list: &mut dyn List) {
        for index in 0..list.count() {
            list.visit_item(index, self);
        }
    }
}

/// Appends a copy of item `index` to the list.
pub(super) fn duplicate_last_from(list: &mut dyn List, index: usize) {
    let mut values = Values::default();
    list.visit_item(index, &mut values);
    list.append();
    values.write(|visitor| list.visit_item(list.count() - 1, visitor));
}

/// Gives the file parameter with this key a new value; tells whether there is one.
pub(super) fn set_file(params: &mut dyn FnMut(&mut dyn Visitor), key: &str, path: &str) -> bool {
    let mut setter = SetFile { key, path, prefix: String::new(), found: false };
    params(&mut setter);
    setter.found
}

/// As `set_file`, for anything written with `params!`.
pub fn set_file_in<P: Params>(params: &mut P, key: &str, path: &str) -> bool {
    set_file(&mut |visitor| params.visit(visitor), key, path)
}

struct SetFile<'k> {
    key: &'k str,
    path: &'k str,
    prefix: String,
    found: bool,
}

impl SetFile<'_> {
    fn within(&mut self, name: &str, visit: &mut dyn FnMut(&mut dyn Visitor)) {
        let length = self.prefix.len();
        self.prefix.push_str(name);
        self.prefix.push('.');
        visit(self);
        self.prefix.truncate(length);
    }
}

impl Visitor for SetFile<'_> {
    fn float(&mut self, _: &Info<f32>, _: &mut f32) {}
    fn count(&mut self, _: &Info<u32>, _: &mut u32) {}
    fn switch(&mut self, _: &Info<bool>, _: &mut bool) {}
    fn choice(&mut self, _: &ChoiceInfo, _: &mut usize) {}
    fn colour(&mut self, _: &Info<Colour>, _: &mut Colour) {}

    fn file(&mut self, info: &Info<FileName>, value: &mut FileName) {
        if self.key.strip_prefix(&self.prefix) == Some(info.name) {
            value.0 = self.path.to_owned();
            self.found = true;
        }
    }

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        self.within(info.name, children);
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        for index in 0..list.count() {
            self.within(&format!("{}.{index}", info.name), &mut |visitor| list.visit_item(index, visitor));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{CloudLayer, Scene};

    #[test]
    fn duplicates_copy_the_item_asked_for() {
        let mut layers = vec![CloudLayer { base_m: 111.0, ..CloudLayer::default() }, CloudLayer::default()];
        duplicate_last_from(&mut layers, 0);
        assert_eq!(layers.len(), 3);
        assert_eq!(layers[2], layers[0]);
    }

    #[test]
    fn files_are_set_by_their_key() {
        let mut scene = Scene::default();
        assert!(set_file_in(&mut scene, "weather.layers.0.image", "map.png"), "the key exists");
        assert_eq!(scene.weather.layers[0].image.0, "map.png");
        assert!(!set_file_in(&mut scene, "weather.layers.7.image", "map.png"), "no such layer");
    }

    #[test]
    fn probes_count_and_reset_clears() {
        let mut scene = Scene::default();
        scene.layers[0].phase.g = 0.3;
        let mut probe = Probe::new(Filter { text: "anisotropy", ..Filter::default() }, "scene");
        scene.visit(&mut probe);
        // The default scene differs from the defaults of its groups nowhere.
        assert_eq!(probe.modified, 1, "only g differs");
        assert!(probe.matches >= 3, "g, back_g and octave_anisotropy: {}", probe.matches);
        scene.visit(&mut Reset);
        assert_eq!(scene, Scene::default());
    }
}
