//! The editor without its window: document, panels, and the rules about losing changes. Tests drive this.

use std::path::{Path, PathBuf};

use super::action::{Action, Answer, Browse, Request};
use super::document::Document;
use super::storage;
use crate::files::{self, Origin, Sky};
use crate::scene::{Preset, Quality, Scene, clip};
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

    /// All folders below one.
    pub fn below(root: &Path) -> Self {
        Self { presets: root.join("presets"), pictures: root.join("pictures"), state: root.join("state") }
    }
}

/// Document, panels and pending questions.
#[derive(Debug)]
pub struct Session {
    /// What is being edited.
    pub document: Document,
    /// The panels.
    pub ui: ui::State,
    /// Where things are kept.
    pub folders: Folders,
    /// A file that others have changed and that the user was told of.
    warned_of: Option<PathBuf>,
    /// What waits for the answer about unsaved changes.
    pending: Option<Request>,
    /// What a crash left behind, until the user decides.
    recovered: Option<Preset>,
}

impl Session {
    /// A session that edits `document`.
    pub fn new(document: Document, folders: Folders) -> Self {
        let ui = ui::State { library: storage::library(&folders.presets), ..ui::State::default() };
        Self { document, ui, folders, pending: None, recovered: None, warned_of: None }
    }

    /// Asks whether to take what a crash left behind.
    pub fn offer_recovery(&mut self, preset: Preset) {
        self.ui.dialog = Some(Dialog::Recover { name: preset.name.clone() });
        self.recovered = Some(preset);
    }

    /// Draws one frame of the panels, carries out what the user wants, and returns what only the window can do.
    pub fn frame(&mut self, ui: &mut egui::Ui, readout: &ui::Readout) -> Vec<Request> {
        self.document.hold(ui.input(|input| input.pointer.any_down()));
        let actions = ui::show(ui, &mut self.ui, &self.document, readout);
        let requests = actions.into_iter().filter_map(|action| self.perform(action)).collect();
        if self.ui.dialog.is_none() {
            // Whoever closes the question or the path dialog stays with the document.
            self.pending = None;
        }
        requests
    }

    /// Carries out what the user wants; returns what only the window can do.
    pub fn perform(&mut self, action: Action) -> Option<Request> {
        match action {
            Action::Ask(request) => self.request(request),
            action => {
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
                    Some(path) => {
                        self.save_to(&path);
                    }
                    None => self.ask_where_to_save(),
                }
                None
            }
            Request::SaveAs(path) => {
                let saved = self.save_to(&path);
                self.go_on_after_saving(saved)
            }
            Request::Answer(answer) => self.answer(answer),
            Request::Recover(taken) => {
                if let Some(preset) = self.recovered.take().filter(|_| taken) {
                    let mut recovered = Document::new(preset, self.document.quality().clone());
                    recovered.mark_recovered();
                    self.document.replace_by(recovered, "recover");
                }
                Some(Request::Recover(taken))
            }
            Request::Paste { key, text } => {
                if let Err(error) = self.paste(key.as_deref(), &text) {
                    self.ui.toasts.error(error);
                }
                None
            }
            Request::Browse(_)
            | Request::Screenshot
            | Request::Snapshot
            | Request::Export(_)
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
                self.document.replace_by(Document::new(Preset::new("", Scene::default()), quality), "new");
                None
            }
            Request::Open(path) => {
                self.open(&path);
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

    /// Opens a sky; the document stays as it is if that fails.
    pub fn open(&mut self, source: &Path) {
        match files::open(source) {
            Ok(sky) => {
                let opened = document_of(sky, self.document.quality().clone());
                let step = format!("open {}", opened.name());
                self.document.replace_by(opened, step);
            }
            Err(error) => self.ui.toasts.error(error),
        }
    }

    /// Takes over text from the clipboard: values below a key, or a whole sky. On an error nothing has changed.
    fn paste(&mut self, key: Option<&str>, text: &str) -> Result<(), String> {
        let failed = |error: &dyn std::fmt::Display| format!("Nothing was pasted: {error}");
        let Some(key) = key else {
            let preset = Preset::from_ron(text, "the clipboard").map_err(|error| failed(&error))?;
            let pasted = Document::new(preset, self.document.quality().clone());
            self.document.replace_by(pasted, "paste a sky");
            return Ok(());
        };
        let (mut scene, mut quality) = (self.document.preset().scene.clone(), self.document.quality().clone());
        let action = if let Some(key) = key.strip_prefix("quality.") {
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

    fn refresh_library(&mut self) {
        let search = std::mem::take(&mut self.ui.library.search);
        self.ui.library = ui::Library { search, ..storage::library(&self.folders.presets) };
    }
}

/// The document of an opened sky. The window keeps the user's quality: the level that a preset names, and the settings
/// that a still was rendered with, are meant for stills, and would make the window crawl.
pub(super) fn document_of(sky: Sky, quality: Quality) -> Document {
    match sky.origin {
        Origin::Preset(path) => Document::from_file(sky.preset, quality, path),
        Origin::Builtin(_) | Origin::Picture(_) | Origin::Grid(_) => Document::new(sky.preset, quality),
    }
}
