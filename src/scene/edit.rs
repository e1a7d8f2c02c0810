//! Reaches parameters by key: `--set layers.0.base_m=900`, lists of all keys, and the range check of a scene in memory.

use super::bounds::{Fault, colour_fault, count_fault, float_fault, range_phrase};
use super::genus::Genus;
use super::nearest::did_you_mean;
use super::param::{Choice as _, ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Unit, Visitor};
use super::{Quality, Scene, Strokes};

/// Why a parameter was not set. The scene is unchanged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// Not of the form `key=value`.
    #[error("`{0}` is not of the form key=value, such as weather.coverage=0.6")]
    NoEquals(String),
    /// No parameter has this key.
    #[error("there is no parameter {key}{hint}")]
    UnknownKey {
        /// The key asked for.
        key: String,
        /// Known keys close to it, as a phrase; may be empty.
        hint: String,
    },
    /// The key names a group or a list.
    #[error("{key} is a group of parameters; set one of them, such as {example}")]
    Group {
        /// The key asked for.
        key: String,
        /// A parameter in it.
        example: String,
    },
    /// The text cannot be read as a value of this type.
    #[error("{key} = {value} cannot be read; expected {expected}")]
    WrongType {
        /// The parameter.
        key: String,
        /// The text given.
        value: String,
        /// What belongs there.
        expected: String,
    },
    /// The value is outside the range.
    #[error("{0}")]
    OutOfRange(Fault),
    /// A list item that neither exists nor comes next.
    #[error("{key}: the list has {count} item(s), so the index may be at most {greatest}")]
    Index {
        /// The list.
        key: String,
        /// Its length.
        count: usize,
        /// The greatest index that may be used.
        greatest: usize,
    },
    /// The values are sound alone but not together.
    #[error("{0}")]
    Rule(String),
}

impl EditError {
    fn below(mut self, prefix: &str) -> Self {
        match &mut self {
            Self::UnknownKey { key, .. }
            | Self::Group { key, .. }
            | Self::WrongType { key, .. }
            | Self::OutOfRange(Fault { key, .. })
            | Self::Index { key, .. } => key.insert_str(0, prefix),
            Self::NoEquals(_) | Self::Rule(_) => {}
        }
        self
    }
}

/// Takes `key=value` apart.
///
/// # Errors
/// [`EditError::NoEquals`].
pub fn split(assignment: &str) -> Result<(&str, &str), EditError> {
    let (key, value) = assignment.split_once('=').ok_or_else(|| EditError::NoEquals(assignment.to_owned()))?;
    Ok((key.trim(), value.trim()))
}

/// Applies `key=value` assignments in order; keys that begin with `quality.` go to the quality. `genus=Cirrus` gives the sky the
/// clouds of a genus, `genus=+Cirrus` adds them to its own.
///
/// # Errors
/// See [`EditError`]; the assignments before the refused one stay applied.
pub fn apply(assignments: &[String], scene: &mut Scene, quality: &mut Quality) -> Result<(), EditError> {
    const QUALITY: &str = "quality.";
    for assignment in assignments {
        let (key, value) = split(assignment)?;
        match key.strip_prefix(QUALITY) {
            None if key == "genus" => set_genus(scene, value)?,
            Some(key) => set(quality, key, value).map_err(|error| error.below(QUALITY))?,
            None => {
                set(scene, key, value)?;
                follow_edit(scene, key);
            }
        }
    }
    scene.problems().into_iter().next().map_or(Ok(()), |problem| Err(EditError::Rule(problem)))
}

/// Lets what depends on each other follow an edit of a parameter: see `CloudLayer::follow_edit`.
pub fn follow_edit(scene: &mut Scene, key: &str) {
    let layer = key.strip_prefix("layers.").and_then(|rest| rest.split_once('.'));
    let Some((Ok(index), name)) = layer.map(|(index, name)| (index.parse::<usize>(), name)) else { return };
    if let Some(layer) = scene.layers.get_mut(index) {
        layer.follow_edit(name);
    }
}

fn set_genus(scene: &mut Scene, value: &str) -> Result<(), EditError> {
    let name = value.trim().trim_start_matches('+').trim();
    let Some(genus) = Genus::ALL.iter().find(|genus| genus.name().eq_ignore_ascii_case(name)) else {
        let names: Vec<&str> = Genus::ALL.iter().map(|genus| genus.name()).collect();
        let expected = format!("one of {}, with + before it to add it", names.join(", "));
        return Err(EditError::WrongType { key: "genus".to_owned(), value: value.to_owned(), expected });
    };
    if value.trim().starts_with('+') {
        return genus.join(scene).map_err(|error| EditError::Rule(error.to_string()));
    }
    genus.replace(scene);
    Ok(())
}

/// Sets the parameter with that key to the value written as in a preset; a file name may go without quotes. The item
/// after the last of a list, up to [`super::most_of`] its name, is made as a copy of the last.
///
/// # Errors
/// See [`EditError`]; `root` is then unchanged.
pub fn set<P: Params + Clone>(root: &mut P, key: &str, value: &str) -> Result<(), EditError> {
    let mut edited = root.clone();
    let mut set = Set { key, value, rest: key, outcome: None };
    edited.visit(&mut set);
    match set.outcome {
        Some(Ok(())) => {
            *root = edited;
            Ok(())
        }
        Some(Err(error)) => Err(error),
        None => {
            let known = keys(root);
            let known = known.iter().map(|entry| entry.key.as_str());
            Err(EditError::UnknownKey { key: key.to_owned(), hint: did_you_mean(key, known) })
        }
    }
}

struct Set<'a> {
    key: &'a str,
    value: &'a str,
    /// What is left of the key below the group that is being visited.
    rest: &'a str,
    outcome: Option<Result<(), EditError>>,
}

impl<'a> Set<'a> {
    fn is_here(&self, name: &str) -> bool {
        self.outcome.is_none() && self.rest == name
    }

    /// The part of the key below `name`, if it leads there.
    fn below(&self, name: &str) -> Option<&'a str> {
        if self.outcome.is_some() {
            return None;
        }
        self.rest.strip_prefix(name)?.strip_prefix('.')
    }

    fn wrong_type<T>(&self, expected: impl Into<String>) -> Result<T, EditError> {
        let (key, value) = (self.key.to_owned(), self.value.to_owned());
        Err(EditError::WrongType { key, value, expected: expected.into() })
    }

    fn accept<T>(&mut self, target: &mut T, value: T, fault: Option<Fault>) {
        self.outcome = Some(match fault {
            Some(fault) => Err(EditError::OutOfRange(fault)),
            None => {
                *target = value;
                Ok(())
            }
        });
    }

    fn group_instead(&mut self, mut first: impl FnMut(&mut dyn Visitor)) {
        let mut collect = Keys { prefix: self.key.to_owned(), entries: Vec::new() };
        first(&mut collect);
        let example = collect.entries.first().map_or(String::new(), |entry| entry.key.clone());
        self.outcome = Some(Err(EditError::Group { key: self.key.to_owned(), example }));
    }
}

impl Visitor for Set<'_> {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        if self.is_here(info.name) {
            match self.value.parse() {
                Ok(new) => self.accept(value, new, float_fault(self.key, info, new)),
                Err(_) => self.outcome = Some(self.wrong_type("a number")),
            }
        }
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        if self.is_here(info.name) {
            match self.value.parse() {
                Ok(new) => self.accept(value, new, count_fault(self.key, info, new)),
                Err(_) => self.outcome = Some(self.wrong_type(format!("a whole number{}", in_range(info)))),
            }
        }
    }

    fn switch(&mut self, info: &Info<bool>, value: &mut bool) {
        if self.is_here(info.name) {
            match self.value.parse() {
                Ok(new) => self.accept(value, new, None),
                Err(_) => self.outcome = Some(self.wrong_type("true or false")),
            }
        }
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        if self.is_here(info.name) {
            match info.options.iter().position(|[name, ..]| *name == self.value) {
                Some(new) => self.accept(index, new, None),
                None => {
                    let names: Vec<&str> = info.options.iter().map(|[name, ..]| *name).collect();
                    self.outcome = Some(self.wrong_type(format!("one of {}", names.join(", "))));
                }
            }
        }
    }

    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        if self.is_here(info.name) {
            match ron::from_str(self.value) {
                Ok(new) => self.accept(value, new, colour_fault(self.key, new)),
                Err(_) => self.outcome = Some(self.wrong_type("a colour such as (1.0, 0.9, 0.8)")),
            }
        }
    }

    fn file(&mut self, info: &Info<FileName>, value: &mut FileName) {
        if self.is_here(info.name) {
            let name = ron::from_str(self.value).unwrap_or_else(|_| self.value.to_owned());
            self.accept(value, FileName(name), None);
        }
    }

    fn strokes(&mut self, info: &Info<Strokes>, value: &mut Strokes) {
        if self.is_here(info.name) {
            match ron::from_str(self.value) {
                Ok(new) => self.accept(value, new, None),
                Err(error) => self.outcome = Some(self.wrong_type(format!("{STROKES} ({})", error.code))),
            }
        }
    }

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        if self.is_here(info.name) {
            self.group_instead(children);
        } else if let Some(rest) = self.below(info.name) {
            let outer = std::mem::replace(&mut self.rest, rest);
            children(self);
            self.rest = outer;
        }
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        if self.is_here(info.name) {
            let name = info.name;
            let (key, example) = (self.key.to_owned(), format!("{name}.0.…"));
            self.outcome = Some(Err(EditError::Group { key, example }));
            return;
        }
        let Some(rest) = self.below(info.name) else { return };
        let (index, rest) = rest.split_once('.').unwrap_or((rest, ""));
        let Ok(index) = index.parse::<usize>() else { return };
        let count = list.count();
        let greatest = count.min(super::most_of(info.name) - 1);
        if index > greatest {
            let key = self.key[..self.key.len() - self.rest.len()].to_owned() + info.name;
            self.outcome = Some(Err(EditError::Index { key, count, greatest }));
            return;
        }
        if index == count {
            list.append();
        }
        if rest.is_empty() {
            self.group_instead(|visitor| list.visit_item(index, visitor));
            return;
        }
        let outer = std::mem::replace(&mut self.rest, rest);
        list.visit_item(index, self);
        self.rest = outer;
    }
}

fn in_range(info: &Info<u32>) -> String {
    info.range.as_ref().map_or(String::new(), |range| format!(" in {}", range_phrase(range, info.unit)))
}

/// Everything known of one parameter, its value included, as text.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// The doc comment, trimmed.
    pub doc: &'static str,
    /// Unit of the number.
    pub unit: Unit,
    /// What is allowed: a range with its unit, or the names of a choice.
    pub allowed: String,
    /// The value of a new scene.
    pub default: String,
    /// The value now.
    pub value: String,
}

/// What is allowed for a file.
const FILE: &str = "a file name";
const STROKES: &str = "strokes of the brush";

impl Entry {
    /// Whether the parameter names a file.
    pub fn is_file(&self) -> bool {
        self.allowed == FILE
    }
}

/// All parameters of `root` in order, list items included.
pub fn keys<P: Params + Clone>(root: &P) -> Vec<Entry> {
    let mut keys = Keys { prefix: String::new(), entries: Vec::new() };
    root.clone().visit(&mut keys);
    keys.entries
}

struct Keys {
    prefix: String,
    entries: Vec<Entry>,
}

impl Keys {
    fn within(&mut self, name: &str, visit: impl FnOnce(&mut Self)) {
        let outer = self.prefix.clone();
        self.prefix = join(&outer, name);
        visit(self);
        self.prefix = outer;
    }

    fn push<T>(&mut self, info: &Info<T>, allowed: String, written: [String; 2]) {
        let [default, value] = written;
        let key = join(&self.prefix, info.name);
        self.entries.push(Entry { key, doc: info.doc.trim(), unit: info.unit, allowed, default, value });
    }
}

fn join(prefix: &str, name: &str) -> String {
    if prefix.is_empty() { name.to_owned() } else { format!("{prefix}.{name}") }
}

fn colour_text(colour: &Colour) -> String {
    format!("({}, {}, {})", colour.0, colour.1, colour.2)
}

impl Visitor for Keys {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        let allowed = info.range.as_ref().map_or(String::new(), |range| range_phrase(range, info.unit));
        self.push(info, allowed, [info.default.to_string(), value.to_string()]);
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        let allowed = info.range.as_ref().map_or(String::new(), |range| range_phrase(range, info.unit));
        self.push(info, allowed, [info.default.to_string(), value.to_string()]);
    }

    fn switch(&mut self, info: &Info<bool>, value: &mut bool) {
        self.push(info, "true, false".to_owned(), [info.default.to_string(), value.to_string()]);
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        let names: Vec<&str> = info.options.iter().map(|[name, ..]| *name).collect();
        let name = |index: usize| names.get(index).copied().unwrap_or_default().to_owned();
        let (key, doc) = (join(&self.prefix, info.name), info.doc.trim());
        let (default, value) = (name(info.default), name(*index));
        self.entries.push(Entry { key, doc, unit: Unit::None, allowed: names.join(", "), default, value });
    }

    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        self.push(info, "(red, green, blue)".to_owned(), [colour_text(&info.default), colour_text(value)]);
    }

    fn file(&mut self, info: &Info<FileName>, value: &mut FileName) {
        self.push(info, FILE.to_owned(), [info.default.0.clone(), value.0.clone()]);
    }

    fn strokes(&mut self, info: &Info<Strokes>, value: &mut Strokes) {
        let text = |strokes: &Strokes| ron::to_string(strokes).unwrap_or_default();
        self.push(info, STROKES.to_owned(), [text(&info.default), text(value)]);
    }

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        self.within(info.name, |keys| children(keys));
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        for index in 0..list.count() {
            self.within(&format!("{}.{index}", info.name), |keys| list.visit_item(index, keys));
        }
    }
}

/// Every value of `root` outside its range, in order.
pub fn faults<P: Params + Clone>(root: &P) -> Vec<Fault> {
    let mut check = RangeCheck { prefix: String::new(), faults: Vec::new() };
    root.clone().visit(&mut check);
    check.faults
}

struct RangeCheck {
    prefix: String,
    faults: Vec<Fault>,
}

impl RangeCheck {
    fn within(&mut self, name: &str, visit: impl FnOnce(&mut Self)) {
        let outer = self.prefix.clone();
        self.prefix = join(&outer, name);
        visit(self);
        self.prefix = outer;
    }
}

impl Visitor for RangeCheck {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        self.faults.extend(float_fault(&join(&self.prefix, info.name), info, *value));
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        self.faults.extend(count_fault(&join(&self.prefix, info.name), info, *value));
    }

    fn switch(&mut self, _: &Info<bool>, _: &mut bool) {}

    fn choice(&mut self, _: &ChoiceInfo, _: &mut usize) {}

    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        self.faults.extend(colour_fault(&join(&self.prefix, info.name), *value));
    }

    fn file(&mut self, _: &Info<FileName>, _: &mut FileName) {}

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        self.within(info.name, |check| children(check));
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        for index in 0..list.count() {
            self.within(&format!("{}.{index}", info.name), |check| list.visit_item(index, check));
        }
    }
}

/// Visits every file that a scene names, images of its weather map and voxel grids; empty names left out.
pub fn files_of(scene: &mut Scene) -> impl Iterator<Item = &mut String> {
    let maps = scene.weather.layers.iter_mut().map(|layer| &mut layer.image.0);
    maps.chain(scene.layers.iter_mut().map(|layer| &mut layer.grid.0)).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::super::{DensityModel, Quality, Scene};
    use super::*;

    #[test]
    fn a_genus_replaces_clouds_or_joins_them() {
        let (mut scene, mut quality) = (Scene::default(), Quality::default());
        let mut set =
            |assignment: &str| apply(&[assignment.to_owned()], &mut scene, &mut quality).map(|()| scene.clone());
        let cirrus = set("genus=cirrus").expect("case does not matter");
        assert!(cirrus.layers.len() == 1 && cirrus.layers[0].base_m > 5000.0, "high");
        let both = set("genus=+Cumulonimbus").expect("there is room");
        assert_eq!((both.layers.len(), both.layers[0] == cirrus.layers[0]), (3, true));
        assert!(set("genus=+Nimbostratus").expect_err("full").to_string().contains("more than 4 cloud layers"));
        let given = set("layers.0.scattering_per_m=0.3").expect("it is in range");
        assert!((given.layers[0].extinction_per_m() - 0.3).abs() < 1e-6, "what was set last counts");
        let water = set("layers.0.water_g_per_m3=0.5").expect("it is in range");
        assert!((water.layers[0].extinction_per_m() - 0.3).abs() > 0.01, "and the water after it");
        let error = set("genus=Cirus").expect_err("a slip").to_string();
        assert!(error.contains("Cirrocumulus") && error.contains("Cirus"), "{error}");
    }

    #[test]
    fn every_type_can_be_set() {
        let mut scene = Scene::default();
        for (key, value) in [
            ("layers.0.base_m", "900.5"),
            ("layers.0.model", "Thesis"),
            ("layers.1.phase.g", "0.7"),
            ("weather.coverage_changes", "true"),
            ("weather.layers.0.seed", "77"),
            ("weather.layers.0.image", "maps/my map.png"),
            ("sun.colour", "(1, 0.5, 0.25)"),
        ] {
            set(&mut scene, key, value).unwrap_or_else(|error| panic!("{key}={value}: {error}"));
        }
        assert_eq!(scene.layers[0].base_m, 900.5);
        assert_eq!(scene.layers[0].model, DensityModel::Thesis);
        assert_eq!((scene.layers.len(), scene.layers[1].phase.g), (2, 0.7), "a layer was added, as a copy");
        assert_eq!(scene.layers[1].base_m, 900.5);
        assert!(scene.weather.coverage_changes, "switch");
        assert_eq!(scene.weather.layers[0].seed, 77);
        assert_eq!(scene.weather.layers[0].image.0, "maps/my map.png");
        assert_eq!(scene.sun.colour, Colour(1.0, 0.5, 0.25));
    }

    #[test]
    fn assignments_reach_scene_and_quality() {
        let (mut scene, mut quality) = (Scene::default(), Quality::default());
        let mut apply = |assignments: &[&str]| {
            let assignments: Vec<String> = assignments.iter().map(|text| (*text).to_owned()).collect();
            apply(&assignments, &mut scene, &mut quality).map_err(|error| error.to_string())
        };
        assert_eq!(apply(&["weather.coverage=0.9", "quality.view_steps = 99"]), Ok(()));
        assert_eq!(apply(&["quality.view_steps=1"]), Err("quality.view_steps = 1 is outside 4 ..= 1024".to_owned()));
        assert!(apply(&["weather.coverage"]).is_err_and(|error| error.contains("key=value")), "no value");
        assert!(apply(&["layers.0.top_m=100"]).is_err_and(|error| error.contains("lies below")), "rules hold here too");
        assert_eq!((scene.weather.coverage, quality.view_steps), (0.9, 99));
    }

    #[test]
    fn refusals_name_key_value_and_range_and_change_nothing() {
        let before = Scene::default();
        let mut scene = before.clone();
        for (key, value, message) in [
            ("layers.0.bse_m", "1", "there is no parameter layers.0.bse_m; did you mean layers.0.base_m?"),
            ("layers.0.base_m", "-5", "layers.0.base_m = -5 m is outside 0 m ..= 15000 m"),
            ("layers.0.base_m", "NaN", "layers.0.base_m = NaN m is not a finite number; allowed are 0 m ..= 15000 m"),
            ("layers.0.base_m", "high", "layers.0.base_m = high cannot be read; expected a number"),
            (
                "layers.0.model",
                "thesis",
                "layers.0.model = thesis cannot be read; expected one of Profile, Thesis, Uniform, Texture, Grid, Product, Automaton, Shapes",
            ),
            ("layers.3.base_m", "1", "layers: the list has 1 item(s), so the index may be at most 1"),
            (
                "layers.0.phase",
                "1",
                "layers.0.phase is a group of parameters; set one of them, such as layers.0.phase.kind",
            ),
            ("sun.day", "2.5", "sun.day = 2.5 cannot be read; expected a whole number in 1 ..= 366"),
            ("sun.colour", "(1,2,-3)", "sun.colour = (1, 2, -3) is outside 0 ..= 100 for each component"),
        ] {
            let error = set(&mut scene, key, value).expect_err(key);
            assert_eq!(error.to_string(), message);
        }
        assert_eq!(scene, before);
    }

    #[test]
    fn keys_lead_back_to_their_values() {
        let scene = Scene::default();
        let entries = keys(&scene);
        assert!(entries.len() > 100, "{}", entries.len());
        for entry in entries {
            assert_eq!(entry.default, entry.value, "{}", entry.key);
            if entry.allowed != "a file name" {
                let mut copy = scene.clone();
                set(&mut copy, &entry.key, &entry.value).unwrap_or_else(|error| panic!("{error}"));
                assert_eq!(copy, scene, "{}", entry.key);
            }
        }
        assert!(faults(&scene).is_empty() && faults(&Quality::default()).is_empty(), "defaults are in range");
    }

    #[test]
    fn the_range_check_finds_what_got_in_another_way() {
        let mut scene = Scene::default();
        scene.layers[0].phase.g = f32::NAN;
        scene.sun.day = 0;
        let keys: Vec<String> = faults(&scene).into_iter().map(|fault| fault.key).collect();
        assert_eq!(keys, ["layers.0.phase.g", "sun.day"]);
    }
}
