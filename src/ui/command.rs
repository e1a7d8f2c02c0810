//! Commands with keys: one table for the keyboard, the menus and the sheet of shortcuts.

use egui::{Key, KeyboardShortcut, Modifiers, Ui};

use super::{Dialog, ExportForm, State};
use crate::app::action::{Action, Request};
use crate::app::document::Document;

/// Something that a key or a menu entry does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Start anew.
    New,
    /// Ask for a file to open.
    Open,
    /// Save.
    Save,
    /// Ask for a path and save.
    SaveAs,
    /// Write the window's picture.
    Screenshot,
    /// Ask for a still and render it.
    Export,
    /// Close the program.
    Quit,
    /// Last step back.
    Undo,
    /// It again.
    Redo,
    /// List of steps on or off.
    History,
    /// Points of the picture in numbers, on or off.
    Inspect,
    /// Light of the picture on or off.
    Histogram,
    /// Stops as colours on or off.
    FalseColour,
    /// Keep the sky and its picture.
    Snapshot,
    /// Random changes on or off.
    Vary,
    /// The preset to the clipboard.
    CopySky,
    /// The picture to the clipboard.
    CopyPicture,
    /// What the machine is to the clipboard.
    CopySystem,
    /// Commands by name.
    Palette,
    /// Camera before the last flight.
    ViewBack,
    /// Camera after it.
    ViewForth,
    /// Play or pause.
    PlayPause,
    /// Time back to 0.
    ResetTime,
    /// Keys on or off.
    Timeline,
    /// Camera back to the preset's.
    ResetCamera,
    /// Camera level and towards the clouds.
    FrameClouds,
    /// Keep the camera with the sky.
    KeepCamera,
    /// Paint clouds over the picture, or not.
    Paint,
    /// The weather map from above on or off.
    Map,
    /// Directions over the picture on or off.
    Guides,
    /// Draw only a part of the picture, or all of it.
    Region,
    /// Half a stop brighter.
    Brighter,
    /// Half a stop darker.
    Darker,
    /// Preset list on or off.
    Presets,
    /// Parameter panel on or off.
    Panel,
    /// Timing overlay on or off.
    Overlay,
    /// Lab on or off.
    Lab,
    /// Refinement at rest on or off.
    Refine,
    /// Comparison with the truth on or off.
    Compare,
    /// Stop accumulating and keep the picture, or go on.
    Keep,
    /// Everything but the picture off or on.
    HideAll,
    /// Full screen on or off.
    FullScreen,
    /// Light or dark.
    Theme,
    /// Sheet of shortcuts on or off.
    Shortcuts,
    /// How to work with the program.
    Help,
    /// What the user likes.
    Preferences,
}

const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Command, key, and name for people.
const TABLE: [(Command, Modifiers, Key, &str); 46] = [
    (Command::New, Modifiers::COMMAND, Key::N, "New"),
    (Command::Open, Modifiers::COMMAND, Key::O, "Open…"),
    // The longer combination first: a shortcut also fires when more modifiers are held.
    (Command::SaveAs, CTRL_SHIFT, Key::S, "Save as…"),
    (Command::Save, Modifiers::COMMAND, Key::S, "Save"),
    (Command::Screenshot, Modifiers::NONE, Key::F12, "Screenshot"),
    (Command::FalseColour, CTRL_SHIFT, Key::E, "False colour"),
    (Command::Export, Modifiers::COMMAND, Key::E, "Export…"),
    (Command::Quit, Modifiers::COMMAND, Key::Q, "Quit"),
    (Command::Redo, CTRL_SHIFT, Key::Z, "Redo"),
    (Command::Undo, Modifiers::COMMAND, Key::Z, "Undo"),
    (Command::History, Modifiers::NONE, Key::F8, "History"),
    (Command::Inspect, Modifiers::NONE, Key::I, "Inspect points"),
    (Command::Paint, Modifiers::NONE, Key::P, "Paint clouds"),
    (Command::Map, Modifiers::NONE, Key::M, "Weather map from above"),
    (Command::Histogram, Modifiers::NONE, Key::H, "Histogram and exposure"),
    (Command::Snapshot, Modifiers::NONE, Key::F7, "Take a snapshot"),
    (Command::Vary, Modifiers::COMMAND, Key::R, "Vary the sky"),
    (Command::CopySky, CTRL_SHIFT, Key::C, "Copy the sky as text"),
    (Command::CopyPicture, CTRL_SHIFT, Key::I, "Copy the picture"),
    (Command::CopySystem, CTRL_SHIFT, Key::F1, "Copy what this machine is"),
    (Command::Palette, Modifiers::COMMAND, Key::P, "Command palette"),
    (Command::ViewBack, Modifiers::ALT, Key::ArrowLeft, "Camera back"),
    (Command::ViewForth, Modifiers::ALT, Key::ArrowRight, "Camera forth"),
    (Command::PlayPause, Modifiers::NONE, Key::Space, "Play or pause"),
    (Command::ResetTime, CTRL_SHIFT, Key::Home, "Time back to 0"),
    (Command::Timeline, Modifiers::COMMAND, Key::T, "Timeline"),
    (Command::ResetCamera, Modifiers::NONE, Key::Home, "Camera back to the preset’s"),
    (Command::FrameClouds, Modifiers::NONE, Key::F, "Look at the clouds, level"),
    (Command::KeepCamera, Modifiers::COMMAND, Key::K, "Keep this camera"),
    (Command::Guides, Modifiers::NONE, Key::G, "Guides: horizon, compass, thirds"),
    (Command::Region, Modifiers::COMMAND, Key::B, "Render a region"),
    (Command::Brighter, Modifiers::NONE, Key::OpenBracket, "Half a stop brighter"),
    (Command::Darker, Modifiers::NONE, Key::CloseBracket, "Half a stop darker"),
    (Command::Presets, Modifiers::NONE, Key::F2, "Preset list"),
    (Command::Panel, Modifiers::NONE, Key::F3, "Parameter panel"),
    (Command::Overlay, Modifiers::NONE, Key::F10, "Timing overlay"),
    (Command::Lab, Modifiers::NONE, Key::F9, "Lab"),
    (Command::Refine, Modifiers::NONE, Key::F4, "Refine the picture at rest"),
    (Command::Compare, Modifiers::NONE, Key::F5, "Compare with the truth"),
    (Command::Keep, Modifiers::NONE, Key::F6, "Stop refining and keep the picture"),
    (Command::HideAll, Modifiers::NONE, Key::Tab, "Hide the panels"),
    (Command::FullScreen, Modifiers::NONE, Key::F11, "Full screen"),
    (Command::Theme, CTRL_SHIFT, Key::L, "Light or dark"),
    (Command::Preferences, Modifiers::COMMAND, Key::Comma, "Preferences…"),
    (Command::Help, Modifiers::SHIFT, Key::F1, "Help"),
    (Command::Shortcuts, Modifiers::NONE, Key::F1, "Shortcuts"),
];

/// What mice and held keys do, for the sheet.
pub(super) const GESTURES: [(&str, &str); 19] = [
    ("Right mouse held", "Look around"),
    ("… with W A S D", "Fly forwards, left, back, right"),
    ("… with Q E", "Fly down, up"),
    ("… with wheel", "Speed of flight"),
    ("… with Shift, Ctrl", "Five times faster, slower"),
    ("Other buttons", "Orbit, pan, nearer: as Preferences say"),
    ("Wheel", "Nearer to the point ahead, or away from it"),
    ("1 to 9", "Go to a kept camera"),
    ("L and left mouse", "Move the sun"),
    ("B held", "Show the chosen snapshot"),
    ("T held", "Show the truth while pictures are compared by Flip"),
    ("Ctrl+F", "Filter parameters"),
    ("Shift, Ctrl while dragging", "Finer; from one round number to the next"),
    ("Ctrl+C, Ctrl+V on a name", "Copy, paste a parameter or a section"),
    ("… elsewhere", "Copy the picture, paste a sky"),
    ("Backspace on a name", "Reset a parameter"),
    ("K on a name", "Set a key at this time"),
    ("Shift+F10", "Menu of what has the focus"),
    ("Ctrl and + − 0", "Size of the panels"),
];

impl Command {
    /// All commands in the order of the sheet.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|(command, ..)| *command)
    }

    /// Name for people.
    pub fn title(self) -> &'static str {
        TABLE.iter().find(|(command, ..)| *command == self).map_or("", |(.., title)| title)
    }

    /// The key.
    pub fn shortcut(self) -> KeyboardShortcut {
        let row = TABLE.iter().find(|(command, ..)| *command == self);
        row.map_or(KeyboardShortcut::new(Modifiers::NONE, Key::F35), |(_, modifiers, key, _)| {
            KeyboardShortcut::new(*modifiers, *key)
        })
    }

    /// The key as people read it.
    pub(super) fn keys(self, context: &egui::Context) -> String {
        let keys = context.format_shortcut(&self.shortcut());
        keys.replace("OpenBracket", "[").replace("CloseBracket", "]").replace("Comma", ",")
    }

    /// Does it: changes the state, or adds an action.
    pub fn run(self, ui: &Ui, state: &mut State, document: &Document, actions: &mut Vec<Action>) {
        let mut ask = |request| actions.push(Action::Ask(request));
        match self {
            Self::New => ask(Request::New),
            Self::Open => state.dialog = Some(Dialog::Open { path: String::new() }),
            Self::Save if document.path().is_some() => ask(Request::Save),
            Self::Save | Self::SaveAs => state.dialog = Some(Dialog::save_as(document, &state.library)),
            Self::Screenshot => ask(Request::Screenshot),
            Self::Export => {
                let viewport = (state.viewport.region, state.viewport.size_px(ui.ctx().pixels_per_point()));
                state.dialog = Some(Dialog::Export(ExportForm::for_document(document, viewport)));
            }
            Self::Quit => ask(Request::Quit),
            Self::Undo => actions.push(Action::Undo),
            Self::Redo => actions.push(Action::Redo),
            Self::History => state.show_history = !state.show_history,
            Self::Inspect => {
                let is_on = !state.inspector.is_on;
                state.inspector = super::InspectorState { is_on, ..Default::default() };
                state.paint.is_on &= !is_on;
            }
            Self::Paint => {
                state.paint.is_on = !state.paint.is_on;
                state.paint.touches.clear();
                // A click cannot do both.
                state.inspector.is_on &= !state.paint.is_on;
            }
            Self::Map => state.map.is_open = !state.map.is_open,
            Self::Snapshot => ask(Request::Snapshot),
            Self::Vary => state.vary.is_open = !state.vary.is_open,
            Self::CopySky => {
                ui.ctx().copy_text(document.preset().to_ron());
                state.toasts.info("The sky is in the clipboard; Ctrl+V over the picture opens one");
            }
            Self::CopyPicture => ask(Request::CopyPicture),
            Self::CopySystem => ask(Request::CopySystem),
            Self::Palette => state.palette.is_open = !state.palette.is_open,
            Self::ViewBack => actions.push(Action::ViewBack),
            Self::ViewForth => actions.push(Action::ViewForth),
            Self::PlayPause => actions.push(Action::Play(!document.is_playing())),
            Self::ResetTime => actions.push(Action::ResetTime),
            Self::ResetCamera => actions.push(Action::ResetCamera),
            Self::Brighter => actions.push(Action::ChangeExposure(-0.5)),
            Self::Darker => actions.push(Action::ChangeExposure(0.5)),
            Self::Presets => state.show_presets = Some(!state.presets_visible(ui.ctx().content_rect().width())),
            Self::Panel => state.show_panel = !state.show_panel,
            Self::Histogram => state.histogram.is_open = !state.histogram.is_open,
            Self::FalseColour => actions.push(state.histogram.toggled(document)),
            Self::FrameClouds => actions.push(Action::PlaceCamera(super::cameras::at_clouds(document))),
            Self::KeepCamera => match super::cameras::kept_with_this(document) {
                Some(action) => {
                    actions.push(action);
                    state.toasts.info("The camera is kept with the sky: View, Cameras, or its number");
                }
                None => state.toasts.error("Nine cameras are kept already; forget one first (View, Cameras)"),
            },
            Self::Region => choose_region(state),
            Self::Guides => state.viewport.has_guides = !state.viewport.has_guides,
            Self::Timeline => state.timeline.is_open = !state.timeline.is_open,
            Self::Overlay => state.show_overlay = !state.show_overlay,
            Self::Lab => state.lab.is_open = !state.lab.is_open,
            Self::Refine => state.truth.refines = !state.truth.refines,
            Self::Compare => state.truth.toggle(),
            Self::Keep => state.truth.is_kept = !state.truth.is_kept,
            Self::HideAll => {
                state.hide_all = !state.hide_all;
                // egui has taken the same key for the next widget.
                ui.ctx().memory_mut(|memory| {
                    memory.move_focus(egui::FocusDirection::None);
                    if let Some(focused) = memory.focused() {
                        memory.surrender_focus(focused);
                    }
                });
            }
            Self::FullScreen => ask(Request::ToggleFullScreen),
            Self::Theme => ui.ctx().set_theme(super::other(ui.ctx().theme())),
            Self::Help => state.dialog = Some(Dialog::Help),
            Self::Preferences => state.dialog = Some(Dialog::Preferences),
            Self::Shortcuts => {
                let open = state.dialog == Some(Dialog::Shortcuts);
                state.dialog = if open { None } else { Some(Dialog::Shortcuts) };
            }
        }
    }

    /// Its name in a menu, with what it would do now.
    pub(super) fn label(self, document: &Document) -> String {
        let (past, future) = document.steps();
        let step = match self {
            Self::Undo => past.last(),
            Self::Redo => future.first(),
            _ => None,
        };
        step.map_or_else(|| self.title().to_owned(), |step| format!("{}: {step}", self.title()))
    }

    /// Whether there is anything for it to do.
    pub(super) fn is_possible(self, document: &Document) -> bool {
        match self {
            Self::Undo => document.can_undo(),
            Self::Redo => document.can_redo(),
            Self::ViewBack => document.can_go_back(),
            Self::ViewForth => document.can_go_forth(),
            _ => true,
        }
    }

    /// Whether it is a switch that is on.
    pub(super) fn is_on(self, state: &State) -> bool {
        match self {
            Self::Refine => state.truth.refines,
            Self::Lab => state.lab.is_open,
            Self::Compare => state.truth.compares(),
            Self::Keep => state.truth.is_kept,
            Self::History => state.show_history,
            Self::Timeline => state.timeline.is_open,
            Self::Histogram => state.histogram.is_open,
            Self::Guides => state.viewport.has_guides,
            Self::Region => state.viewport.region.is_some() || state.viewport.is_choosing,
            Self::Vary => state.vary.is_open,
            Self::Inspect => state.inspector.is_on,
            Self::Paint => state.paint.is_on,
            Self::Map => state.map.is_open,
            _ => false,
        }
    }

    /// Keys that a focused widget needs for itself.
    fn yields_to_focus(self) -> bool {
        matches!(
            self,
            Self::Inspect
                | Self::Paint
                | Self::Map
                | Self::Histogram
                | Self::Guides
                | Self::FrameClouds
                | Self::PlayPause
                | Self::ResetCamera
                | Self::ResetTime
                | Self::Brighter
                | Self::Darker
                | Self::HideAll
        )
    }
}

/// Draws all of the picture again, or lets the next drag choose a region.
fn choose_region(state: &mut State) {
    let viewport = &mut state.viewport;
    if viewport.region.take().is_none() && !std::mem::take(&mut viewport.is_choosing) {
        viewport.is_choosing = true;
        state.toasts.info(
            "Drag a rectangle over the picture; Ctrl+B again draws all of it. Streaks of light need the whole picture",
        );
    }
}

/// Second keys, as other programs have them.
const ALSO: [(Command, Modifiers, Key); 1] = [(Command::Redo, Modifiers::COMMAND, Key::Y)];

/// Runs the commands whose keys were pressed since the last frame.
pub(super) fn take(ui: &mut Ui, state: &mut State, document: &Document) -> Vec<Action> {
    let mut actions = Vec::new();
    let asking = state.palette.is_open || state.dialog.is_some() && state.dialog != Some(Dialog::Shortcuts);
    let typing = ui.ctx().egui_wants_keyboard_input();
    let has_text = ui.ctx().text_edit_focused();
    for command in Command::all() {
        let free = command == Command::HideAll && state.hide_all;
        // Text has steps of its own to undo, and its keys go through words.
        let is_of_text = matches!(command, Command::Undo | Command::Redo | Command::ViewBack | Command::ViewForth);
        // Shift+F10 opens menus.
        let is_of_menus = command == Command::Overlay && ui.input(|input| input.modifiers.shift);
        if is_of_menus || asking || has_text && is_of_text || typing && command.yields_to_focus() && !free {
            continue;
        }
        let also = ALSO.into_iter().filter(|(other, ..)| *other == command);
        let mut keys =
            also.map(|(_, modifiers, key)| KeyboardShortcut::new(modifiers, key)).chain([command.shortcut()]);
        if ui.input_mut(|input| keys.any(|keys| input.consume_shortcut(&keys))) {
            command.run(ui, state, document, &mut actions);
        }
    }
    actions
}
