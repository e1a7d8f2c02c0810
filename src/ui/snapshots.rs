//! Snapshots: skies with their pictures, to go back to, and to hold beside the picture as it is now.

use egui::{Color32, ColorImage, Context, Key, Rect, RichText, ScrollArea, TextureHandle, Ui, Vec2};

use super::{Picture, row};
use crate::app::action::{Action, Request};
use crate::app::document::Document;
use crate::choices;
use crate::scene::param::Choice as _;
use crate::scene::{Preset, Quality, edit};

/// Older ones make room.
const MOST: usize = 12;
/// Height of a thumbnail, in points.
const THUMBNAIL: f32 = 62.0;
/// Height of the strip, in points.
pub(super) const HEIGHT: f32 = 108.0;
/// How many times differences are enlarged.
const GAIN: i32 = 8;

choices! {
    /// How the chosen snapshot and the picture are shown together.
    pub enum Beside {
        /// The picture, and the snapshot while B is held.
        Flip ("Flip"),
        /// The snapshot left of a divider that can be dragged, the picture right of it.
        Wipe ("Wipe"),
        /// The difference of both, eight times enlarged; grey is none.
        Difference ("Difference"),
    }
}

/// A sky with its picture.
#[derive(Clone)]
pub struct Snapshot {
    /// What it is called.
    pub name: String,
    /// The sky.
    pub preset: Preset,
    /// How it was computed.
    pub quality: Quality,
    path: Option<std::path::PathBuf>,
    saved: Preset,
    time_secs: f64,
    size: [u32; 2],
    rgba8: Vec<u8>,
    texture: TextureHandle,
}

impl std::fmt::Debug for Snapshot {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Snapshot").field("name", &self.name).field("size", &self.size).finish_non_exhaustive()
    }
}

impl Snapshot {
    fn picture(&self) -> Picture {
        Picture { texture: self.texture.id(), size: self.size }
    }
}

/// A picture on the device.
#[derive(Clone)]
struct Shown(TextureHandle, [u32; 2]);

impl std::fmt::Debug for Shown {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_tuple("Shown").field(&self.1).finish()
    }
}

/// The strip, and what is held beside the picture.
#[derive(Clone, Debug)]
pub struct SnapshotState {
    list: Vec<Snapshot>,
    taken: usize,
    /// The one that is held beside the picture.
    chosen: Option<usize>,
    /// How.
    pub beside: Beside,
    /// Place of the divider, 0 to 1 from the left.
    pub(super) divider: f32,
    difference: Option<Shown>,
}

impl Default for SnapshotState {
    fn default() -> Self {
        Self { list: Vec::new(), taken: 0, chosen: None, beside: Beside::Flip, divider: 0.5, difference: None }
    }
}

fn image(size: [u32; 2], rgba8: &[u8]) -> ColorImage {
    ColorImage::from_rgba_unmultiplied(size.map(|side| side as usize), rgba8)
}

impl SnapshotState {
    /// Adds what the window shows of the document, `size` pixels large.
    pub fn add(&mut self, context: &Context, document: &Document, (size, rgba8): ([u32; 2], Vec<u8>)) {
        if self.list.len() == MOST {
            self.remove(0);
        }
        self.taken += 1;
        let name = format!("{} {}", self.taken, document.name());
        let texture = context.load_texture(&name, image(size, &rgba8), egui::TextureOptions::LINEAR);
        self.list.push(Snapshot {
            name,
            preset: document.preset().clone(),
            quality: document.quality().clone(),
            path: document.path().cloned(),
            saved: document.saved().clone(),
            time_secs: document.time_secs(),
            size,
            rgba8,
            texture,
        });
    }

    /// Makes all textures again, as after another device was opened.
    pub fn reload(&mut self, context: &Context) {
        for snapshot in &mut self.list {
            let picture = image(snapshot.size, &snapshot.rgba8);
            snapshot.texture = context.load_texture(&snapshot.name, picture, egui::TextureOptions::LINEAR);
        }
        self.difference = None;
    }

    /// All of them, the oldest first.
    pub fn list(&self) -> &[Snapshot] {
        &self.list
    }

    /// The one that is held beside the picture.
    pub(super) fn chosen(&self) -> Option<(&Snapshot, Picture)> {
        let snapshot = self.list.get(self.chosen?)?;
        Some((snapshot, snapshot.picture()))
    }

    /// Whether [`Self::show_difference`] wants to be told of new pictures.
    pub fn wants_difference(&self) -> bool {
        self.beside == Beside::Difference && self.chosen.is_some()
    }

    /// Whether the difference to the chosen one is known, of whatever picture.
    pub fn has_difference(&self) -> bool {
        self.difference.is_some()
    }

    fn choose(&mut self, chosen: Option<usize>) {
        self.chosen = chosen;
        self.difference = None;
    }

    /// Compares the chosen snapshot with the picture as it is now. Pictures of other sizes are compared as high as each other,
    /// middle on middle, which is how a lens shows the same things; beyond the snapshot's sides there is no difference.
    pub fn show_difference(&mut self, context: &Context, (size, rgba8): ([u32; 2], &[u8])) {
        let Some(snapshot) = self.chosen.and_then(|index| self.list.get(index)) else { return };
        let [width, height] = size.map(|side| side as usize);
        if rgba8.len() < 4 * width * height || snapshot.rgba8.is_empty() {
            return;
        }
        let theirs = snapshot.size.map(|side| side as usize);
        let scale = theirs[1] as f32 / height as f32;
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let now = 4 * (y * width + x);
                let across = (x as f32 + 0.5 - 0.5 * width as f32) * scale + 0.5 * theirs[0] as f32;
                if across < 0.0 || across >= theirs[0] as f32 {
                    pixels.push(Color32::from_gray(128));
                    continue;
                }
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
                let then = 4 * ((y * theirs[1] / height) * theirs[0] + across as usize);
                let channel = |c: usize| {
                    let difference = i32::from(rgba8[now + c]) - i32::from(snapshot.rgba8[then + c]);
                    u8::try_from((128 + GAIN * difference).clamp(0, 255)).unwrap_or(128)
                };
                pixels.push(Color32::from_rgb(channel(0), channel(1), channel(2)));
            }
        }
        let image = ColorImage::new([width, height], pixels);
        let texture = context.load_texture("difference", image, egui::TextureOptions::LINEAR);
        self.difference = Some(Shown(texture, size));
    }

    /// The picture of the difference, once there is one.
    pub(super) fn difference(&self) -> Option<Picture> {
        let Shown(texture, size) = self.difference.as_ref()?;
        Some(Picture { texture: texture.id(), size: *size })
    }

    fn remove(&mut self, index: usize) {
        self.list.remove(index);
        match self.chosen {
            Some(chosen) if chosen == index => self.choose(None),
            Some(chosen) if chosen > index => self.chosen = Some(chosen - 1),
            _ => {}
        }
    }
}

/// What to do with a snapshot.
enum Wish {
    Choose(usize),
    Restore(usize),
    Remove(usize),
}

/// Draws the strip.
pub(super) fn show(ui: &mut Ui, state: &mut SnapshotState, document: &Document, actions: &mut Vec<Action>) {
    let mut wish = None;
    ui.horizontal_top(|ui| {
        ui.vertical(|ui| {
            let take = ui.button("+ Snapshot").on_hover_text("Keeps the sky and its picture (F7)");
            if take.clicked() {
                actions.push(Action::Ask(Request::Snapshot));
            }
            ui.horizontal(|ui| {
                for option in Beside::ALL {
                    let response = ui.selectable_label(state.beside == *option, option.title());
                    let response = response.on_hover_text(option.doc().trim());
                    let key = format!("snapshots.{}", option.title());
                    row::name(ui, &response, &format!("Beside: {}", option.title()), &key);
                    if response.clicked() {
                        state.beside = *option;
                    }
                }
            });
            let hint = match (state.chosen, state.beside) {
                (None, _) => "Click one to compare",
                (Some(_), Beside::Flip) => "Hold B to see it",
                (Some(_), Beside::Wipe) => "Drag the divider",
                (Some(_), Beside::Difference) => "8 times enlarged",
            };
            ui.weak(hint);
        });
        ui.separator();
        ScrollArea::horizontal().id_salt("snapshot strip").auto_shrink([false, true]).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                for (index, snapshot) in state.list.iter().enumerate() {
                    thumbnail(ui, (index, snapshot), state.chosen == Some(index), (document, &mut wish));
                }
            });
        });
    });
    match wish {
        Some(Wish::Choose(index)) => state.choose((state.chosen != Some(index)).then_some(index)),
        Some(Wish::Remove(index)) => state.remove(index),
        Some(Wish::Restore(index)) => {
            let snapshot = &state.list[index];
            actions.push(Action::Restore {
                name: format!("restore {}", snapshot.name),
                preset: Box::new(snapshot.preset.clone()),
                quality: Box::new(snapshot.quality.clone()),
                path: snapshot.path.clone(),
                saved: Box::new(snapshot.saved.clone()),
                time_secs: snapshot.time_secs,
            });
        }
        None => {}
    }
}

fn thumbnail(
    ui: &mut Ui,
    (index, snapshot): (usize, &Snapshot),
    is_chosen: bool,
    (document, wish): (&Document, &mut Option<Wish>),
) {
    let [width, height] = snapshot.size.map(|side| side.max(1) as f32);
    let size = Vec2::new((THUMBNAIL * width / height).clamp(30.0, 200.0), THUMBNAIL);
    ui.vertical(|ui| {
        let button = egui::Button::image((snapshot.texture.id(), size)).selected(is_chosen);
        let response = ui.add(button);
        row::name(ui, &response, &format!("Snapshot {}", snapshot.name), &format!("snapshots.{index}"));
        if response.double_clicked() {
            *wish = Some(Wish::Restore(index));
        } else if response.clicked() {
            *wish = Some(Wish::Choose(index));
        }
        super::menu::on(&response, |ui| {
            let entries =
                [("Restore", Wish::Restore(index)), ("Compare", Wish::Choose(index)), ("Remove", Wish::Remove(index))];
            for (title, wanted) in entries {
                if ui.button(title).clicked() {
                    *wish = Some(wanted);
                    ui.close();
                }
            }
        });
        response.on_hover_ui(|ui| {
            ui.set_max_width(420.0);
            ui.strong(&snapshot.name);
            for line in differences(snapshot, document) {
                ui.label(line);
            }
            ui.weak("Click compares, double click restores");
        });
        ui.add(egui::Label::new(RichText::new(&snapshot.name).small()).truncate().selectable(false));
    });
}

/// What differs between a snapshot and the document, in lines.
fn differences(snapshot: &Snapshot, document: &Document) -> Vec<String> {
    const MOST_LINES: usize = 12;
    let all = |scene, quality| {
        let mut entries = edit::keys(scene);
        entries.extend(edit::keys(quality).into_iter().map(|mut entry| {
            entry.key.insert_str(0, "quality.");
            entry
        }));
        entries
    };
    let now = all(&document.preset().scene, document.quality());
    let then = all(&snapshot.preset.scene, &snapshot.quality);
    let value = |entries: &[edit::Entry], key: &str| {
        let entry = entries.iter().find(|entry| entry.key == key);
        entry.map_or_else(|| "none".to_owned(), |entry| entry.value.clone())
    };
    let added = now.iter().filter(|entry| then.iter().all(|other| other.key != entry.key));
    let mut lines: Vec<String> = then
        .iter()
        .chain(added)
        .filter_map(|entry| {
            let [here, now] = [value(&then, &entry.key), value(&now, &entry.key)];
            (here != now).then(|| format!("{}: {here} here, {now} now", entry.key))
        })
        .collect();
    if lines.is_empty() {
        lines.push("The same sky as now".to_owned());
    } else if lines.len() > MOST_LINES {
        let more = lines.len() - MOST_LINES;
        lines.truncate(MOST_LINES);
        lines.push(format!("… and {more} more"));
    }
    lines
}

/// Whether the chosen snapshot is to be seen instead of the picture.
pub(super) fn is_flipped(ui: &Ui, state: &SnapshotState) -> bool {
    state.beside == Beside::Flip
        && !ui.ctx().egui_wants_keyboard_input()
        && ui.input(|input| input.key_down(Key::B) && input.modifiers.is_none())
}

/// The part of `place` left of a divider at a share of its width.
pub(super) fn left_of(place: Rect, share: f32) -> Rect {
    Rect::from_min_max(place.min, egui::pos2(place.left() + place.width() * share, place.bottom()))
}
