//! The editor without its window: document, panels, and the rules about losing changes. Tests drive this.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::action::{Action, Answer, Browse, Part, Request};
use super::brush::UnderWay;
use super::document::Document;
use super::preferences::Preferences;
use super::storage;
use crate::export::ExportError;
use crate::files::{self, FileError, Origin, Sky};
use crate::scene::param::Choice as _;
use crate::scene::{MapSource, Preset, Quality, Scene, clip};
use crate::ui::{self, Dialog, set_file_in};

/// Where the program keeps what belongs to the user.
#[derive(Clone, Debug)]
pub struct Folders {
    /// Presets that the list shows.
    pub presets: PathBuf,
    /// Screenshots.
    pub pictures: PathBuf,
    /// What a crash leaves behind.
    pub state: PathBuf,
}

impl Folders {
    /// The folders that suit this system; below the temporary folder where there is no home.
    pub fn of_user() -> Self {
        let dirs = directories::ProjectDirs::from("", "", "nephoscope");
        let data = dirs.as_ref().map(|dirs| dirs.data_dir().to_owned());
        let data = data.unwrap_or_else(|| std::env::temp_dir().join("nephoscope"));
        let state = dirs.as_ref().and_then(|dirs| dirs.state_dir().map(Path::to_owned));
        let pictures = directories::UserDirs::new().and_then(|dirs| dirs.picture_dir().map(Path::to_owned));
        Self {
            pictures: pictures.unwrap_or_else(|| data.join("pictures")),
            state: state.unwrap_or_else(|| data.clone()),
            ..Self::below(&data)
        }
    }

    /// Small pictures of presets.
    fn thumbnails(&self) -> PathBuf {
        self.state.join("thumbnails")
    }

    /// All folders below one.
    pub fn below(root: &Path) -> Self {
        Self { presets: root.join("presets"), pictures: root.join("pictures"), state: root.join("state") }
    }
}

/// The file of the preferences, in the folder of the program's state.
const PREFERENCES: &str = "preferences.ron";

/// Document, panels and pending questions.
#[derive(Debug)]
pub struct Session {
    /// What is being edited.
    pub document: Document,
    /// The panels.
    pub ui: ui::State,
    /// Where things are kept.
    pub folders: Folders,
    /// What is kept between runs.
    pub preferences: Preferences,
    /// The same as it was written last.
    kept: Preferences,
    /// A file that others have changed and that the user was told of.
    warned_of: Option<PathBuf>,
    /// The stroke of the brush that is under way.
    pub(super) stroke: Option<UnderWay>,
    /// What waits for the answer about unsaved changes.
    pending: Option<Request>,
    /// What a crash left behind, until the user decides.
    recovered: Vec<Preset>,
    /// When the folder of presets had changed last when it was read.
    listed: Option<SystemTime>,
}

/// When a folder's list of files changed last; `None` if there is none.
fn changed(folder: &Path) -> Option<SystemTime> {
    std::fs::metadata(folder).and_then(|about| about.modified()).ok()
}

impl Session {
    /// A session that edits `document`.
    pub fn new(document: Document, folders: Folders) -> Self {
        let listed = changed(&folders.presets);
        let library = storage::library(&folders.presets, &folders.thumbnails());
        let ui = ui::State { library, ..ui::State::default() };
        let preferences = Preferences::load(&folders.state.join(PREFERENCES));
        let kept = preferences.clone();
        Self {
            document,
            ui,
            folders,
            preferences,
            kept,
            stroke: None,
            pending: None,
            recovered: Vec::new(),
            warned_of: None,
            listed,
        }
    }

    /// Whether the user has not decided yet about what a crash left behind.
    pub fn has_undecided_recovery(&self) -> bool {
        !self.recovered.is_empty()
    }

    /// The window's title: how much of a still is done, and what is open.
    pub fn title(&self) -> String {
        let done = self.ui.busy.as_ref().and_then(|busy| busy.progress);
        let done = done.map_or_else(String::new, |(share, _)| format!("{:.0} % – ", share * 100.0));
        format!("{done}{} – Nephoscope", self.document.title())
    }

    /// Lets go of textures, as after another device was opened: they are made again when they are seen.
    pub fn reload_textures(&mut self, context: &egui::Context) {
        self.ui.library.forget_textures();
        self.ui.snapshots.reload(context);
    }

    /// Asks whether to take one of the copies that a crash left behind, newest first, with the time that has passed since.
    pub fn offer_recovery(&mut self, copies: Vec<(Preset, Duration)>) {
        let ages = copies.iter().map(|(preset, age)| (preset.name.clone(), *age)).collect();
        self.recovered = copies.into_iter().map(|(preset, _)| preset).collect();
        if !self.recovered.is_empty() {
            self.ui.dialog = Some(Dialog::Recover { copies: ages, chosen: 0 });
        }
    }

    /// Draws one frame of the panels, carries out what the user wants, and returns what only the window can do.
    pub fn frame(&mut self, ui: &mut egui::Ui, readout: &ui::Readout) -> Vec<Request> {
        // A stroke ends when all of it is painted.
        self.document.hold(ui.input(|input| input.pointer.any_down()) || !self.ui.paint.touches.is_empty());
        let actions = ui::show(ui, &mut self.ui, (&self.document, &mut self.preferences), readout);
        let requests = actions.into_iter().filter_map(|action| self.perform(action)).collect();
        if self.ui.dialog.is_none() {
            // Whoever closes the question or the path dialog stays with the document.
            self.pending = None;
        }
        self.keep_preferences(ui.ctx());
        requests
    }

    /// Gives the panels theme and size as they were in the last run.
    pub fn apply_preferences(&self, context: &egui::Context) {
        if let Some(light) = self.preferences.light {
            context.set_theme(if light { egui::Theme::Light } else { egui::Theme::Dark });
        }
        context.set_zoom_factor(self.preferences.zoom);
    }

    /// Writes the preferences if they have changed. Who cannot write them loses no work, and is told once.
    fn keep_preferences(&mut self, context: &egui::Context) {
        self.preferences.light = match context.options(|options| options.theme_preference) {
            egui::ThemePreference::Light => Some(true),
            egui::ThemePreference::Dark => Some(false),
            egui::ThemePreference::System => None,
        };
        self.preferences.zoom = context.zoom_factor();
        if self.preferences != self.kept {
            if let Err(error) = self.preferences.save(&self.folders.state.join(PREFERENCES), &self.kept) {
                self.ui.toasts.error(format!("Preferences are not kept: {error}"));
            }
            self.kept = self.preferences.clone();
        }
    }

    /// Carries out what the user wants; returns what only the window can do.
    pub fn perform(&mut self, action: Action) -> Option<Request> {
        match action {
            Action::Ask(request) => self.request(request),
            action => {
                let sun = &self.document.preset().scene.sun;
                if matches!(action, Action::DayLapse { .. }) && sun.daylight().is_none() {
                    let say = "The sun does not come up on this day at this place: choose others in section Sun";
                    self.ui.toasts.error(say);
                    return None;
                }
                self.document.apply(&action);
                None
            }
        }
    }

    fn request(&mut self, request: Request) -> Option<Request> {
        match request {
            Request::New | Request::Open(_) | Request::Quit => self.unless_unsaved(request),
            Request::Save => {
                match self.document.path().cloned() {
                    Some(path) if self.is_changed_by_others(&path) => {}
                    Some(path) => return self.save_to(&path).then_some(Request::KeepPicture(path)),
                    None => self.ask_where_to_save(),
                }
                None
            }
            Request::SaveAs(path) => {
                let saved = self.save_to(&path);
                self.go_on_after_saving(saved).or_else(|| saved.then_some(Request::KeepPicture(path)))
            }
            Request::TakeOver { source, part } => {
                if let Some(sky) = self.other_sky(&source) {
                    let mut scene = self.document.preset().scene.clone();
                    part.take_over(&mut scene, &sky.preset.scene);
                    scene.mend();
                    let what = if part == Part::Camera { "camera" } else { part.title() };
                    let key = format!("{what} of {}", sky.preset.name);
                    self.document.apply(&Action::EditScene { key, scene: Box::new(scene) });
                }
                None
            }
            Request::Morph(source) => {
                if let Some(sky) = self.other_sky(&source) {
                    let from = self.document.preset().scene.clone();
                    let (to, name) = (sky.preset.scene, sky.preset.name);
                    self.ui.library.morph = Some(ui::Morph { last: Some(from.clone()), from, to, name, share: 0.0 });
                }
                None
            }
            Request::Answer(answer) => self.answer(answer),
            Request::Recover(taken) => {
                let copies = std::mem::take(&mut self.recovered);
                if let Some(preset) = taken.and_then(|index| copies.into_iter().nth(index)) {
                    let mut recovered = Document::new(preset, self.document.quality().clone());
                    recovered.mark_unsaved();
                    self.replace_document(recovered, "recover");
                }
                Some(Request::Recover(taken))
            }
            Request::Paste { key: Some(key), text } => {
                if let Err(error) = self.paste(&key, &text) {
                    self.ui.toasts.error(error);
                }
                None
            }
            Request::Paste { key: None, .. } => self.unless_unsaved(request),
            Request::Browse(_)
            | Request::Screenshot
            | Request::Snapshot
            | Request::KeepPicture(_)
            | Request::CopyPicture
            | Request::CopySystem
            | Request::Export(_)
            | Request::Steer(_)
            | Request::Lab(_)
            | Request::ToggleFullScreen => Some(request),
        }
    }

    /// Does what would lose the document, after asking if there is anything to lose.
    fn unless_unsaved(&mut self, request: Request) -> Option<Request> {
        if !self.document.is_modified() {
            return self.replace(request);
        }
        let before = match &request {
            Request::New => "start a new sky",
            Request::Quit => "quit",
            Request::Paste { .. } => "paste another sky",
            _ => "open another sky",
        };
        self.ui.dialog = Some(Dialog::Unsaved { before: before.to_owned() });
        self.pending = Some(request);
        None
    }

    /// Does what loses the document.
    fn replace(&mut self, request: Request) -> Option<Request> {
        let quality = self.document.quality().clone();
        match request {
            Request::New => {
                self.replace_document(Document::new(Preset::new("", Scene::default()), quality), "new");
                None
            }
            Request::Open(path) => {
                self.open(&path);
                None
            }
            Request::Paste { key: None, text } => {
                self.paste_sky(&text);
                None
            }
            other => Some(other),
        }
    }

    fn answer(&mut self, answer: Answer) -> Option<Request> {
        match answer {
            Answer::Cancel => {
                self.pending = None;
                None
            }
            Answer::Discard => {
                let request = self.pending.take()?;
                self.replace(request)
            }
            Answer::Save => match self.document.path().cloned() {
                Some(path) if self.is_changed_by_others(&path) => {
                    self.pending = None;
                    None
                }
                Some(path) => {
                    let saved = self.save_to(&path);
                    self.go_on_after_saving(saved)
                }
                None => {
                    self.ask_where_to_save();
                    None
                }
            },
        }
    }

    /// Once saved, does what waited for it; if saving failed, nothing that would lose the document.
    fn go_on_after_saving(&mut self, saved: bool) -> Option<Request> {
        let request = self.pending.take()?;
        if saved { self.replace(request) } else { None }
    }

    fn ask_where_to_save(&mut self) {
        self.ui.dialog = Some(Dialog::save_as(&self.document, &self.ui.library));
    }

    /// Whether a file is no longer what the document came from, so that saving would lose somebody's work. It is said once;
    /// who saves again means it.
    fn is_changed_by_others(&mut self, path: &Path) -> bool {
        if self.warned_of.take().as_deref() == Some(path) || !path.exists() {
            return false;
        }
        let is_same = Preset::load(path).is_ok_and(|on_disk| on_disk.is_as_saved(self.document.saved(), path));
        if !is_same {
            self.ui.toasts.error(format!(
                "{} was changed since it was opened: Save as keeps both, Save once more overwrites it",
                path.display()
            ));
            self.warned_of = Some(path.to_owned());
        }
        !is_same
    }

    /// Saves, says so, and tells whether it worked; on failure everything stays as it was.
    fn save_to(&mut self, path: &Path) -> bool {
        if path.starts_with(&self.folders.presets) {
            // A folder that cannot be made is reported by the write below, with its path.
            let _ = std::fs::create_dir_all(&self.folders.presets);
        }
        match self.document.preset().save(path) {
            Ok(()) => {
                self.document.mark_saved(path.to_owned());
                self.preferences.used(path);
                self.ui.toasts.info(format!("Saved {}", path.display()));
                self.refresh_library();
                true
            }
            Err(error) => {
                self.ui.toasts.error(error);
                false
            }
        }
    }

    /// Edits another document; what was begun with the one before is over.
    fn replace_document(&mut self, other: Document, step: impl Into<String>) {
        self.ui.library.morph = None;
        self.document.replace_by(other, step);
    }

    /// Another sky, of which something is wanted; says why there is none.
    fn other_sky(&mut self, source: &Path) -> Option<Sky> {
        files::open(source).map_err(|error| self.ui.toasts.error(error)).ok()
    }

    /// Keeps what the window shows as the picture of a preset that was just saved.
    pub(super) fn keep_picture(&mut self, preset: &Path, (size, rgba8): ([u32; 2], &[u8])) {
        storage::keep_picture(&self.folders.thumbnails(), preset, (size, rgba8));
        self.refresh_library();
    }

    /// The same for a preset of the list, whose other entries stay as they are.
    pub fn note_picture(&mut self, preset: &Path, picture: ([u32; 2], &[u8])) {
        let kept = storage::keep_picture(&self.folders.thumbnails(), preset, picture);
        let entry = self.ui.library.user.iter_mut().find(|entry| entry.source == preset);
        if let (Some(entry), Some(path)) = (entry, kept) {
            entry.thumbnail = Some(ui::Thumbnail::File(path));
        }
    }

    /// Opens a sky; the document stays as it is if that fails.
    pub fn open(&mut self, source: &Path) {
        match files::open(source) {
            Ok(sky) => {
                if !matches!(sky.origin, Origin::Builtin(_)) {
                    self.preferences.used(source);
                }
                let opened = document_of(sky, self.document.quality().clone());
                let step = format!("open {}", opened.name());
                self.replace_document(opened, step);
            }
            Err(error) => self.ui.toasts.error(error),
        }
    }

    /// Takes a file that was dropped on the window: a sky, or a picture without one, which becomes the weather map.
    pub fn drop_file(&mut self, path: &Path) -> Option<Request> {
        let is_picture = path
            .extension()
            .and_then(|ending| ending.to_str())
            .is_some_and(|ending| ["png", "exr"].iter().any(|known| ending.eq_ignore_ascii_case(known)));
        let holds_none = matches!(files::open(path), Err(FileError::Export(ExportError::NoPreset { .. })));
        if !is_picture || !holds_none {
            return self.perform(Action::Ask(Request::Open(path.to_owned())));
        }
        let mut scene = self.document.preset().scene.clone();
        let layer = scene.weather.layers.first_mut()?;
        // One that grows goes on growing, out of another image.
        if layer.source != MapSource::Grown {
            layer.source = MapSource::Image;
        }
        layer.image.0 = path.display().to_string();
        self.document.apply(&Action::EditScene { key: "weather.layers.0.image".to_owned(), scene: Box::new(scene) });
        self.ui.toasts.info(format!("{} holds no sky and became the weather map (Ctrl+Z undoes it)", path.display()));
        None
    }

    /// Edits a sky from the clipboard, which no file holds; says why it cannot be read.
    fn paste_sky(&mut self, text: &str) {
        match Preset::from_ron(text, "the clipboard") {
            Ok(preset) => {
                let mut pasted = Document::new(preset, self.document.quality().clone());
                pasted.mark_unsaved();
                self.replace_document(pasted, "paste a sky");
            }
            Err(error) => self.ui.toasts.error(format!("Nothing was pasted: {error}")),
        }
    }

    /// Takes over text from the clipboard: values below a key. On an error nothing has changed.
    fn paste(&mut self, key: &str, text: &str) -> Result<(), String> {
        let failed = |error: &dyn std::fmt::Display| format!("Nothing was pasted: {error}");
        let (mut scene, mut quality) = (self.document.preset().scene.clone(), self.document.quality().clone());
        let action = if let Some(key) = key.strip_prefix("quality").map(|rest| rest.trim_start_matches('.')) {
            clip::paste(&mut quality, key, text).map_err(|error| failed(&error))?;
            Action::EditQuality { key: key.to_owned(), quality: Box::new(quality) }
        } else {
            clip::paste(&mut scene, key, text).map_err(|error| failed(&error))?;
            Action::EditScene { key: key.to_owned(), scene: Box::new(scene) }
        };
        self.document.apply(&action);
        Ok(())
    }

    /// Takes over what the system's file dialog gave.
    pub fn picked(&mut self, purpose: &Browse, path: &Path) {
        let text = path.display().to_string();
        if let Browse::Parameter(key) = purpose {
            let mut scene = self.document.preset().scene.clone();
            if set_file_in(&mut scene, key, &text) {
                self.document.apply(&Action::EditScene { key: key.clone(), scene: Box::new(scene) });
            }
        } else if let Some(dialog) = &mut self.ui.dialog {
            dialog.set_path(text);
        }
    }

    /// Lists the presets anew if others have put some into the folder, or taken some away.
    pub fn notice_presets(&mut self) {
        if changed(&self.folders.presets) != self.listed {
            self.refresh_library();
        }
    }

    fn refresh_library(&mut self) {
        self.listed = changed(&self.folders.presets);
        self.ui.library.refresh(storage::library(&self.folders.presets, &self.folders.thumbnails()));
    }
}

/// The document of an opened sky. The window keeps the user's quality: the level that a preset names, and the settings
/// that a still was rendered with, are meant for stills, and would make the window crawl.
pub(super) fn document_of(sky: Sky, quality: Quality) -> Document {
    let mut document = match sky.origin {
        Origin::Preset(path) => Document::from_file(sky.preset, quality, path),
        Origin::Builtin(_) | Origin::Picture(_) | Origin::Grid(_) => Document::new(sky.preset, quality),
    };
    document.apply(&Action::Seek(sky.time_secs));
    document
}
