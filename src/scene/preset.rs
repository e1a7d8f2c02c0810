//! Presets: a scene in a RON file, checked field by field, and written as what differs from the defaults.
//!
//! A parameter's key is its path below `scene`, such as `layers.0.base_m`. Here is only text; the module `files`
//! reads and writes the disk.

mod check;
mod locate;
mod migrate;
mod write;

use std::fmt::{self, Display};

use ron::extensions::Extensions;
use serde::{Deserialize, de::DeserializeOwned};

use self::check::{Finding, What};
use self::locate::{Kind, Node};
pub(super) use self::write::quoted;
use super::bounds::Fault;
use super::edit::{self, EditError};
use super::nearest::did_you_mean;
use super::param::{Choice, Params};
use super::{Animation, Camera, Quality, QualityLevel, Scene};

/// The version that this program writes. Older ones are read too.
pub const PRESET_VERSION: u32 = 2;

/// A sky with a name.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Preset {
    /// Version of the format.
    pub version: u32,
    /// Name for people.
    pub name: String,
    /// What one sees, in a sentence or two.
    pub description: String,
    /// Words to search for.
    pub tags: Vec<String>,
    /// The quality level that suits the sky, if its author says.
    pub quality: Option<QualityLevel>,
    /// The sky; what has keys as it is at the time that was played last, and at time 0 in a file.
    pub scene: Scene,
    /// What changes with time.
    pub animation: Animation,
    /// Cameras to go to, at most [`MAX_BOOKMARKS`].
    pub cameras: Vec<Bookmark>,
}

/// Most cameras that a preset keeps: there are nine keys for them.
pub const MAX_BOOKMARKS: usize = 9;

/// A camera with a name.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Bookmark {
    /// Name for people.
    pub name: String,
    /// Where the eye is.
    pub camera: Camera,
}

impl Default for Preset {
    fn default() -> Self {
        Self {
            version: PRESET_VERSION,
            name: String::new(),
            description: String::new(),
            tags: Vec::new(),
            quality: None,
            scene: Scene::default(),
            animation: Animation::default(),
            cameras: Vec::new(),
        }
    }
}

/// A place in a file; prints as `file:line:column`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, as it was named.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

impl Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// Why a preset or a quality file was refused. Nothing of such a file is used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PresetError {
    /// The text is not RON.
    #[error("{place}: {message}")]
    Syntax {
        /// Where reading stopped.
        place: Place,
        /// What was expected.
        message: String,
    },
    /// A value has another type than its parameter.
    #[error("{place}: {key} is {found}, but must be {expected}")]
    WrongType {
        /// Where the value stands.
        place: Place,
        /// The parameter.
        key: String,
        /// What is there.
        found: String,
        /// What belongs there.
        expected: String,
    },
    /// A number is NaN, infinite or outside its range.
    #[error("{place}: {fault}")]
    OutOfRange {
        /// Where the value stands.
        place: Place,
        /// Parameter, value and range.
        fault: Fault,
    },
    /// A field that no parameter has.
    #[error("{place}: there is no parameter {key}{hint}")]
    UnknownField {
        /// Where the key stands.
        place: Place,
        /// The key.
        key: String,
        /// Known names close to it, as a phrase; may be empty.
        hint: String,
    },
    /// No version, or one that does not exist yet.
    #[error("{place}: {message}")]
    Version {
        /// Where the version stands or should.
        place: Place,
        /// What is wrong and what to do.
        message: String,
    },
    /// Values that are sound alone but not together.
    #[error("{place}: {message}")]
    Rule {
        /// Where the first of them stands.
        place: Place,
        /// The rule.
        message: String,
    },
}

impl Preset {
    /// A preset of a scene.
    pub fn new(name: impl Into<String>, scene: Scene) -> Self {
        Self { name: name.into(), scene, ..Self::default() }
    }

    /// Reads a preset of this or an older version; what it leaves out has its default. `file` is for messages.
    ///
    /// # Errors
    /// The first fault found, with its place: see [`PresetError`].
    pub fn from_ron(text: &str, file: &str) -> Result<Self, PresetError> {
        let source = Source { text, file };
        let mut tree = source.parse()?;
        let version = source.version(&tree)?;
        source.check_header(
            &tree,
            &["version", "name", "description", "tags", "quality", "scene", "animation", "cameras"],
        )?;
        source.check_texts(&tree)?;
        source.check_level(&tree)?;
        if let Some(scene) = field_mut(&mut tree, "scene") {
            migrate::rename_keys(scene, version);
            source.check_fields(&mut Scene::default(), scene)?;
        }
        source.check_cameras(&tree)?;
        let mut preset: Self = source.read(&tree)?;
        preset.version = PRESET_VERSION;
        if let Some(message) = preset.scene.problems().into_iter().next() {
            let key: &str = message.split([' ', ':']).next().unwrap_or_default();
            let scene = tree.field("scene").map_or(&tree, |field| &field.value);
            return Err(PresetError::Rule { place: source.place(scene.nearest(key).span.start), message });
        }
        if let Some((track, message)) = preset.animation.fault(&preset.scene) {
            let animation = tree.field("animation").map_or(&tree, |field| &field.value);
            let tracks = animation.field("tracks").map(|field| &field.value.kind);
            let node = match (tracks, track) {
                (Some(Kind::List(tracks)), Some(index)) => tracks.get(index),
                _ => None,
            };
            return Err(PresetError::Rule { place: source.place(node.unwrap_or(animation).span.start), message });
        }
        preset.play(0.0);
        Ok(preset)
    }

    /// Applies `key=value` assignments, as [`edit::apply`] does; they hold at all times, whatever keys there were.
    ///
    /// # Errors
    /// As [`edit::apply`].
    pub fn set_all(&mut self, assignments: &[String], quality: &mut Quality) -> Result<(), EditError> {
        edit::apply(assignments, &mut self.scene, quality)?;
        // A genus brings layers and weather of its own, unless it joins those that are there.
        let changed = assignments.iter().filter_map(|set| edit::split(set).ok()).flat_map(|(key, value)| match key {
            "genus" if value.starts_with('+') => Vec::new(),
            "genus" => vec!["layers", "weather", "domain"],
            _ => vec![key],
        });
        self.animation.override_by(changed);
        self.animation.keep_only_what_is_in(&self.scene);
        Ok(())
    }

    /// Gives everything that has keys its value at that time.
    pub fn play(&mut self, time_secs: f64) {
        self.animation.play(&mut self.scene, time_secs);
    }

    /// The sky at a time.
    pub fn at(&self, time_secs: f64) -> Scene {
        let mut scene = self.scene.clone();
        self.animation.play(&mut scene, time_secs);
        scene
    }

    /// The preset as a file holds it: at time 0.
    pub fn at_rest(&self) -> Self {
        Self { scene: self.at(0.0), ..self.clone() }
    }

    /// The preset as RON, in the current version; [`Self::from_ron`] gives the same preset back.
    pub fn to_ron(&self) -> String {
        let mut text = format!("(\n    version: {PRESET_VERSION},\n    name: {},\n", quoted(&self.name));
        if !self.description.is_empty() {
            text.push_str(&format!("    description: {},\n", quoted(&self.description)));
        }
        if !self.tags.is_empty() {
            let tags: Vec<String> = self.tags.iter().map(|tag| quoted(tag)).collect();
            text.push_str(&format!("    tags: [{}],\n", tags.join(", ")));
        }
        if let Some(level) = self.quality {
            text.push_str(&format!("    quality: {},\n", level.name()));
        }
        push_group(&mut text, "scene", &write::fields(&mut self.at(0.0), 2));
        let animation = self.animation.to_ron(2);
        if !animation.is_empty() {
            push_group(&mut text, "animation", &animation);
        }
        if !self.cameras.is_empty() {
            text.push_str("    cameras: [\n");
            for bookmark in &self.cameras {
                text.push_str(&format!("        (name: {}, camera: (\n", quoted(&bookmark.name)));
                text.push_str(&write::fields(&mut bookmark.camera.clone(), 3));
                text.push_str("        )),\n");
            }
            text.push_str("    ],\n");
        }
        text.push_str(")\n");
        text
    }
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct QualityFile {
    #[serde(rename = "version")]
    _version: u32,
    quality: Quality,
}

/// Reads quality settings; what they leave out has its default. `file` is for messages.
///
/// # Errors
/// As [`Preset::from_ron`].
pub fn quality_from_ron(text: &str, file: &str) -> Result<Quality, PresetError> {
    let source = Source { text, file };
    let tree = source.parse()?;
    source.version(&tree)?;
    source.check_header(&tree, &["version", "quality"])?;
    if let Some(quality) = tree.field("quality") {
        source.check_fields(&mut Quality::default(), &quality.value)?;
    }
    source.read::<QualityFile>(&tree).map(|file| file.quality)
}

/// Quality settings as RON; [`quality_from_ron`] gives the same settings back.
pub fn quality_to_ron(quality: &Quality) -> String {
    let mut text = format!("(\n    version: {PRESET_VERSION},\n");
    push_group(&mut text, "quality", &write::fields(&mut quality.clone(), 2));
    text.push_str(")\n");
    text
}

fn push_group(text: &mut String, name: &str, fields: &str) {
    if fields.is_empty() {
        text.push_str(&format!("    {name}: (),\n"));
    } else {
        text.push_str(&format!("    {name}: (\n{fields}    ),\n"));
    }
}

fn field_mut<'a>(tree: &'a mut Node, name: &str) -> Option<&'a mut Node> {
    let Kind::Fields(fields) = &mut tree.kind else { return None };
    fields.iter_mut().find(|field| field.name == name).map(|field| &mut field.value)
}

/// A text with the name that messages give it.
struct Source<'a> {
    text: &'a str,
    file: &'a str,
}

impl Source<'_> {
    fn place(&self, offset: usize) -> Place {
        let (line, column) = locate::line_column(self.text, offset);
        Place { file: self.file.to_owned(), line, column }
    }

    fn parse(&self) -> Result<Node, PresetError> {
        locate::parse(self.text)
            .map_err(|error| PresetError::Syntax { place: self.place(error.at), message: error.message })
    }

    fn slice(&self, node: &Node) -> &str {
        &self.text[node.span.clone()]
    }

    fn version(&self, tree: &Node) -> Result<u32, PresetError> {
        let wrong = |node: &Node, message| Err(PresetError::Version { place: self.place(node.span.start), message });
        let Some(field) = tree.field("version") else {
            return wrong(tree, format!("the file has no version; write `version: {PRESET_VERSION}` first"));
        };
        match self.slice(&field.value).parse() {
            Ok(version @ 1..=PRESET_VERSION) => Ok(version),
            Ok(newer) if newer > PRESET_VERSION => wrong(
                &field.value,
                format!("version {newer} is newer than this program, which knows 1 to {PRESET_VERSION}; update it"),
            ),
            _ => wrong(
                &field.value,
                format!("version is {}, but must be 1 to {PRESET_VERSION}", self.slice(&field.value)),
            ),
        }
    }

    fn check_header(&self, tree: &Node, known: &[&str]) -> Result<(), PresetError> {
        let Some(field) = tree.fields().iter().find(|field| !known.contains(&field.name.as_str())) else {
            return Ok(());
        };
        let hint = did_you_mean(&field.name, known.iter().copied());
        Err(PresetError::UnknownField { place: self.place(field.name_span.start), key: field.name.clone(), hint })
    }

    fn wrong_type(&self, key: &str, node: &Node, expected: &str) -> PresetError {
        let found = match node.kind {
            Kind::Number | Kind::Word => format!("`{}`", self.slice(node)),
            _ => node.kind.phrase().to_owned(),
        };
        let (key, expected) = (key.to_owned(), expected.to_owned());
        PresetError::WrongType { place: self.place(node.span.start), key, found, expected }
    }

    fn check_texts(&self, tree: &Node) -> Result<(), PresetError> {
        for key in ["name", "description"] {
            if let Some(field) = tree.field(key).filter(|field| field.value.kind != Kind::Text) {
                return Err(self.wrong_type(key, &field.value, "a string in quotes"));
            }
        }
        let Some(tags) = tree.field("tags") else { return Ok(()) };
        let Kind::List(items) = &tags.value.kind else {
            return Err(self.wrong_type("tags", &tags.value, "a list of strings"));
        };
        let other = items.iter().find(|item| item.kind != Kind::Text);
        other.map_or(Ok(()), |item| Err(self.wrong_type("tags", item, "a list of strings")))
    }

    fn check_cameras(&self, tree: &Node) -> Result<(), PresetError> {
        let Some(cameras) = tree.field("cameras") else { return Ok(()) };
        let expected = "a list such as [(name: \"Hill\", camera: (height_m: 300.0))]";
        let Kind::List(items) = &cameras.value.kind else {
            return Err(self.wrong_type("cameras", &cameras.value, expected));
        };
        if items.len() > MAX_BOOKMARKS {
            let message = format!("cameras: {} cameras, but at most {MAX_BOOKMARKS} can be kept", items.len());
            return Err(PresetError::Rule { place: self.place(cameras.value.span.start), message });
        }
        for item in items {
            if !matches!(item.kind, Kind::Fields(_)) {
                return Err(self.wrong_type("cameras", item, expected));
            }
            self.check_header(item, &["name", "camera"])?;
            if let Some(camera) = item.field("camera") {
                self.check_fields(&mut Camera::default(), &camera.value)?;
            }
        }
        Ok(())
    }

    fn check_level(&self, tree: &Node) -> Result<(), PresetError> {
        let Some(level) = tree.field("quality") else { return Ok(()) };
        let word = self.slice(&level.value);
        if word == "None" || QualityLevel::ALL.iter().any(|known| known.name() == word) {
            return Ok(());
        }
        let names: Vec<&str> = QualityLevel::ALL.iter().map(|known| known.name()).collect();
        Err(self.wrong_type("quality", &level.value, &format!("one of {}", names.join(", "))))
    }

    fn check_fields(&self, root: &mut impl Params, node: &Node) -> Result<(), PresetError> {
        let Some(Finding { at, what }) = check::check(root, self.text, node, "") else { return Ok(()) };
        let place = self.place(at);
        Err(match what {
            What::Value(fault) => PresetError::OutOfRange { place, fault },
            What::Type(key, found, expected) => PresetError::WrongType { place, key, found, expected },
            What::Unknown(key, hint) => PresetError::UnknownField { place, key, hint },
        })
    }

    /// Lets `ron` read the text with all keys under their present names.
    fn read<T: DeserializeOwned>(&self, tree: &Node) -> Result<T, PresetError> {
        let (text, growths) = migrate::rewritten(self.text, tree);
        let options = ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
        options.from_str(&text).map_err(|error| {
            let line_start: usize =
                text.split_inclusive('\n').take(error.span.end.line.saturating_sub(1)).map(str::len).sum();
            let offset = line_start + error.span.end.col.saturating_sub(1);
            let grown: isize = growths.iter().filter(|(at, _)| *at <= offset).map(|(_, growth)| growth).sum();
            let place = self.place(offset.saturating_add_signed(-grown).min(self.text.len()));
            PresetError::Syntax { place, message: error.code.to_string() }
        })
    }
}

/// A name as the stem of a file's name: no separators, no spaces.
pub fn file_stem(name: &str) -> String {
    let keep = |letter: char| if letter.is_alphanumeric() || letter == '-' { letter } else { '-' };
    // Systems end names at some 255 bytes.
    let name: String = name.trim().to_lowercase().chars().map(keep).take(60).collect();
    if name.is_empty() { "sky".to_owned() } else { name }
}

#[cfg(test)]
mod tests;
