//! Questions: unsaved changes, paths, stills, recovery; and the sheet of shortcuts.

use std::path::PathBuf;

use egui::{Grid, Id, Key, Modal, RichText, Ui};

use super::command::GESTURES;
use super::{Command, Library, State, row};
use crate::app::action::{Action, Answer, Browse, Export, Request, Still};
use crate::app::document::Document;
use crate::scene::QualityLevel;
use crate::scene::param::Choice;

/// The question on the screen.
#[derive(Clone, Debug, PartialEq)]
pub enum Dialog {
    /// Whether to save before something that would lose changes; holds what that is.
    Unsaved {
        /// What comes after, as a phrase: "open another preset".
        before: String,
    },
    /// A path to open.
    Open {
        /// As typed.
        path: String,
    },
    /// Name and path to save under.
    SaveAs {
        /// Name of the preset.
        name: String,
        /// As typed.
        path: String,
    },
    /// What still to render.
    Export(ExportForm),
    /// Whether to take what a crash left behind.
    Recover {
        /// Name of the preset that was being edited.
        name: String,
    },
    /// The sheet of shortcuts.
    Shortcuts,
}

/// The form for a still, as typed.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportForm {
    /// What the still shows.
    pub still: Still,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Whether it shows all directions.
    pub is_panorama: bool,
    /// Quality; `None` for that of the viewport.
    pub level: Option<QualityLevel>,
    /// Where it goes.
    pub path: String,
}

impl ExportForm {
    /// A full-HD EXR named after the document, at the level that its preset names.
    pub fn for_document(document: &Document) -> Self {
        let path = PathBuf::from(format!("{}.exr", file_name(document.name())));
        let path = std::path::absolute(&path).unwrap_or(path).display().to_string();
        let level = Some(document.preset().quality.unwrap_or(QualityLevel::High));
        Self { still: Still::Exr, width: 1920, height: 1080, is_panorama: false, level, path }
    }

    /// Gives the path the ending that suits the still.
    fn fit_ending(&mut self) {
        let ending = if self.still == Still::Png { "png" } else { "exr" };
        let path = PathBuf::from(&self.path).with_extension(ending);
        self.path = path.display().to_string();
    }
}

/// A name as a file's name: no separators, no spaces.
fn file_name(name: &str) -> String {
    let keep = |letter: char| if letter.is_alphanumeric() || letter == '-' { letter } else { '-' };
    let name: String = name.trim().to_lowercase().chars().map(keep).collect();
    if name.is_empty() { "sky".to_owned() } else { name }
}

impl Dialog {
    /// The save-as dialog with a path that suits the document.
    pub fn save_as(document: &Document, library: &Library) -> Self {
        let path = document.path().cloned();
        let path = path.unwrap_or_else(|| library.folder.join(format!("{}.ron", file_name(document.name()))));
        Self::SaveAs { name: document.preset().name.clone(), path: path.display().to_string() }
    }

    /// Takes over a path from the system's file dialog.
    pub fn set_path(&mut self, chosen: String) {
        match self {
            Self::Open { path } | Self::SaveAs { path, .. } => *path = chosen,
            Self::Export(form) => form.path = chosen,
            Self::Unsaved { .. } | Self::Recover { .. } | Self::Shortcuts => {}
        }
    }
}

/// Whether the dialog stays.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    Stays,
    Closes,
}

/// Draws the question, if there is one.
pub(super) fn show(context: &egui::Context, state: &mut State, document: &Document, actions: &mut Vec<Action>) {
    let Some(mut dialog) = state.dialog.take() else { return };
    let screen = context.content_rect();
    let width = match dialog {
        Dialog::Shortcuts => 440.0_f32,
        _ => 460.0,
    };
    let modal = Modal::new(Id::unique("dialog")).show(context, |ui| {
        ui.set_width(width.min(screen.width() - 60.0));
        match &mut dialog {
            Dialog::Unsaved { before } => unsaved(ui, document, before, actions),
            Dialog::Open { path } => open(ui, path, actions),
            Dialog::SaveAs { name, path } => save_as(ui, name, path, (document, actions)),
            Dialog::Export(form) => export(ui, form, actions),
            Dialog::Recover { name } => recover(ui, name, actions),
            Dialog::Shortcuts => shortcuts(ui, screen.height() - 130.0),
        }
    });
    let escaped = context.input(|input| input.key_pressed(Key::Escape));
    if (escaped || modal.backdrop_response.clicked()) && modal.inner == Fate::Stays {
        match dialog {
            Dialog::Unsaved { .. } => actions.push(Action::Ask(Request::Answer(Answer::Cancel))),
            // What a crash left is only thrown away when somebody says so.
            Dialog::Recover { .. } => state.dialog = Some(dialog),
            _ => {}
        }
    } else if modal.inner == Fate::Stays {
        state.dialog = Some(dialog);
    }
}

fn unsaved(ui: &mut Ui, document: &Document, before: &str, actions: &mut Vec<Action>) -> Fate {
    ui.heading("Save changes?");
    ui.label(format!("“{}” has changes that are not saved. Save them before you {before}?", document.name()));
    let mut answer = None;
    ui.add_space(8.0);
    ui.horizontal_wrapped(|ui| {
        for (title, choice) in [("Save", Answer::Save), ("Discard", Answer::Discard), ("Cancel", Answer::Cancel)] {
            if ui.button(title).clicked() {
                answer = Some(choice);
            }
        }
    });
    let Some(answer) = answer else { return Fate::Stays };
    actions.push(Action::Ask(Request::Answer(answer)));
    Fate::Closes
}

/// A path with a button for the system's dialog; returns whether Enter was pressed in it.
fn path_field(ui: &mut Ui, path: &mut String, browse: Browse, actions: &mut Vec<Action>) -> bool {
    ui.label("Path");
    ui.horizontal(|ui| {
        let width = ui.available_width() - 84.0;
        let response = ui.add(egui::TextEdit::singleline(path).desired_width(width).hint_text("path of the file"));
        row::name(ui, &response, "Path", "dialog.path");
        if ui.button("Browse…").clicked() {
            actions.push(Action::Ask(Request::Browse(browse)));
        }
        response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
    })
    .inner
}

/// The row of buttons under a form; `None` while neither was pressed.
fn confirm(ui: &mut Ui, verb: &str, enabled: bool) -> Option<bool> {
    let mut answer = None;
    ui.add_space(8.0);
    ui.horizontal(|ui| {
        if ui.add_enabled(enabled, egui::Button::new(verb)).clicked() {
            answer = Some(true);
        }
        if ui.button("Cancel").clicked() {
            answer = Some(false);
        }
    });
    answer
}

fn open(ui: &mut Ui, path: &mut String, actions: &mut Vec<Action>) -> Fate {
    ui.heading("Open");
    ui.label("A preset (.ron), or an exported EXR or PNG, which holds the sky it was made from.");
    let entered = path_field(ui, path, Browse::Open, actions);
    let ready = !path.trim().is_empty();
    match confirm(ui, "Open", ready).or((entered && ready).then_some(true)) {
        None => Fate::Stays,
        Some(confirmed) => {
            if confirmed {
                actions.push(Action::Ask(Request::Open(PathBuf::from(path.trim()))));
            }
            Fate::Closes
        }
    }
}

fn save_as(
    ui: &mut Ui,
    name: &mut String,
    path: &mut String,
    (document, actions): (&Document, &mut Vec<Action>),
) -> Fate {
    ui.heading("Save as");
    ui.label("Name");
    let response = ui.add(egui::TextEdit::singleline(name).desired_width(f32::INFINITY).hint_text("Untitled"));
    row::name(ui, &response, "Name", "dialog.name");
    let entered = path_field(ui, path, Browse::SaveAs, actions);
    let ready = !path.trim().is_empty();
    match confirm(ui, "Save", ready).or((entered && ready).then_some(true)) {
        None => Fate::Stays,
        Some(confirmed) => {
            if confirmed {
                if *name != document.preset().name {
                    actions.push(Action::Rename(name.clone()));
                }
                let mut path = PathBuf::from(path.trim());
                if path.extension().is_none() {
                    path.set_extension("ron");
                }
                actions.push(Action::Ask(Request::SaveAs(path)));
            }
            Fate::Closes
        }
    }
}

fn export(ui: &mut Ui, form: &mut ExportForm, actions: &mut Vec<Action>) -> Fate {
    ui.heading("Export still");
    ui.label("Rendered at once in full; the preset is stored in the file, so that opening it restores this sky.");
    let kinds = [
        (Still::Exr, "EXR, linear light"),
        (Still::LayersExr, "EXR, layers of light"),
        (Still::CloudsExr, "EXR, clouds alone"),
        (Still::Png, "PNG, as shown"),
    ];
    ui.horizontal_wrapped(|ui| {
        for (still, title) in kinds {
            if ui.selectable_label(form.still == still, title).clicked() {
                form.still = still;
                form.fit_ending();
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label("Size");
        for (value, title) in [(&mut form.width, "Width"), (&mut form.height, "Height")] {
            let response = ui.add(egui::DragValue::new(value).range(1..=16_384).suffix(" px"));
            row::name(ui, &response, title, title);
        }
        let sizes = [("HD", [1920, 1080]), ("4K", [3840, 2160])];
        let panoramas = [("Panorama 2K", [2048, 1024]), ("4K pano", [4096, 2048]), ("8K pano", [8192, 4096])];
        for (index, (title, [width, height])) in sizes.into_iter().chain(panoramas).enumerate() {
            if ui.button(title).on_hover_text(format!("{width} × {height}")).clicked() {
                (form.width, form.height) = (width, height);
                form.is_panorama = index >= sizes.len();
            }
        }
    });
    ui.checkbox(&mut form.is_panorama, "All directions (longitude across, latitude down)")
        .on_hover_text("For lighting with the sky; the camera’s place counts, and its heading is the middle");
    // Measured on a software adapter, whose memory is the processor's: so much for each pixel, and the program itself.
    let bytes = if form.still == Still::LayersExr { 220.0 } else { 120.0 };
    let megabytes = 300.0 + f64::from(form.width) * f64::from(form.height) * bytes / 1e6;
    ui.weak(format!("Takes about {megabytes:.0} MB of memory"));
    ui.horizontal_wrapped(|ui| {
        ui.label("Quality");
        let viewport = ui.selectable_label(form.level.is_none(), "As in the window");
        if viewport.on_hover_text("The settings of the Quality section").clicked() {
            form.level = None;
        }
        for level in QualityLevel::ALL {
            let chosen = form.level == Some(*level);
            if ui.selectable_label(chosen, level.title()).on_hover_text(level.doc()).clicked() {
                form.level = Some(*level);
            }
        }
    });
    path_field(ui, &mut form.path, Browse::Export, actions);
    match confirm(ui, "Export", !form.path.trim().is_empty()) {
        None => Fate::Stays,
        Some(confirmed) => {
            if confirmed {
                actions.push(Action::Ask(Request::Export(Export {
                    still: form.still,
                    size: [form.width, form.height],
                    is_panorama: form.is_panorama,
                    level: form.level,
                    path: PathBuf::from(form.path.trim()),
                })));
            }
            Fate::Closes
        }
    }
}

fn recover(ui: &mut Ui, name: &str, actions: &mut Vec<Action>) -> Fate {
    ui.heading("Recover unsaved work?");
    ui.label(format!("The program ended without saving “{name}”. Its last state was kept."));
    let mut taken = None;
    ui.add_space(8.0);
    ui.horizontal(|ui| {
        if ui.button("Recover").clicked() {
            taken = Some(true);
        }
        if ui.button("Discard").clicked() {
            taken = Some(false);
        }
    });
    let Some(taken) = taken else { return Fate::Stays };
    actions.push(Action::Ask(Request::Recover(taken)));
    Fate::Closes
}

fn shortcuts(ui: &mut Ui, height: f32) -> Fate {
    ui.heading("Shortcuts");
    let height = height.max(80.0);
    egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        Grid::new("shortcuts").num_columns(2).spacing([24.0, 3.0]).show(ui, |ui| {
            for (keys, what) in GESTURES {
                ui.label(RichText::new(keys).strong());
                ui.label(what);
                ui.end_row();
            }
            for command in Command::all() {
                ui.label(RichText::new(command.keys(ui.ctx())).strong());
                ui.label(command.title());
                ui.end_row();
            }
        });
    });
    ui.add_space(6.0);
    if ui.button("Close").clicked() { Fate::Closes } else { Fate::Stays }
}
