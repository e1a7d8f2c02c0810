//! The gallery of presets: the program's own, and those in the user's folder, with pictures, stars and a search.

use std::collections::HashMap;
use std::path::PathBuf;

use egui::{Color32, ColorImage, RichText, ScrollArea, Sense, TextureHandle, Ui, Vec2};

use crate::app::action::{Action, Part, Request};
use crate::app::document::Document;
use crate::app::preferences::Preferences;
use crate::scene::Scene;
use crate::scene::morph::morph;
use crate::scene::param::Choice as _;

/// Pictures that are decoded in one frame at most, so that a long list scrolls smoothly.
const DECODED_AT_ONCE: usize = 3;
/// Width of a picture's cell, in points, when there is room for several.
const CELL: f32 = 150.0;

/// One preset in the list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entry {
    /// Name for people.
    pub name: String,
    /// What one sees.
    pub description: String,
    /// Words to search for.
    pub tags: Vec<String>,
    /// The file, or the short name of a built-in one.
    pub source: PathBuf,
    /// Whether it is the program's own.
    pub is_builtin: bool,
    /// Its picture as PNG, where there is one.
    pub thumbnail: Option<Thumbnail>,
}

/// Where a small picture lies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Thumbnail {
    /// In the program.
    Within(&'static [u8]),
    /// In a file.
    File(PathBuf),
}

impl Entry {
    fn is_wanted(&self, search: &str) -> bool {
        let text = format!("{} {} {}", self.name, self.description, self.tags.join(" ")).to_lowercase();
        search.split_whitespace().all(|word| text.contains(word))
    }
}

/// What there is to choose from.
#[derive(Clone, Default)]
pub struct Library {
    /// The program's own presets.
    pub builtin: Vec<Entry>,
    /// Presets in the user's folder.
    pub user: Vec<Entry>,
    /// The user's folder.
    pub folder: PathBuf,
    /// What the user searches for.
    pub search: String,
    /// Whether names stand without pictures.
    pub is_list: bool,
    /// Two skies and a place between them.
    pub morph: Option<Morph>,
    /// Decoded pictures, `None` for those that cannot be.
    textures: HashMap<PathBuf, Option<TextureHandle>>,
}

impl std::fmt::Debug for Library {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let counts = (self.builtin.len(), self.user.len());
        formatter
            .debug_struct("Library")
            .field("presets", &counts)
            .field("folder", &self.folder)
            .finish_non_exhaustive()
    }
}

/// A sky on its way to another.
#[derive(Clone, Debug)]
pub struct Morph {
    /// The sky as it was.
    pub from: Scene,
    /// Where it goes.
    pub to: Scene,
    /// Name of that.
    pub name: String,
    /// How far, 0 to 1.
    pub share: f32,
    /// The sky between them that was shown last.
    pub last: Option<Scene>,
}

impl Library {
    /// Presets of the program, presets of the user, and their folder.
    pub fn of(builtin: Vec<Entry>, user: Vec<Entry>, folder: PathBuf) -> Self {
        Self { builtin, user, folder, ..Self::default() }
    }

    /// Takes over what was found in the folders; pictures of files that have changed are read again.
    pub fn refresh(&mut self, found: Self) {
        for entry in &found.user {
            if !self.user.contains(entry) {
                self.textures.remove(&entry.source);
            }
        }
        (self.builtin, self.user, self.folder) = (found.builtin, found.user, found.folder);
    }

    /// Lets go of all decoded pictures, as after another device was opened.
    pub fn forget_textures(&mut self) {
        self.textures.clear();
    }

    /// The picture of a preset, decoded now if that is still `allowed`.
    fn texture(&mut self, context: &egui::Context, entry: &Entry, allowed: &mut usize) -> Option<TextureHandle> {
        if let Some(known) = self.textures.get(&entry.source) {
            return known.clone();
        }
        let thumbnail = entry.thumbnail.as_ref()?;
        if *allowed == 0 {
            context.request_repaint();
            return None;
        }
        *allowed -= 1;
        let decoded = match thumbnail {
            Thumbnail::Within(bytes) => decode(bytes),
            Thumbnail::File(path) => std::fs::read(path).ok().and_then(|bytes| decode(&bytes)),
        };
        let name = entry.source.display().to_string();
        let texture = decoded.map(|image| context.load_texture(name, image, egui::TextureOptions::LINEAR));
        self.textures.insert(entry.source.clone(), texture.clone());
        texture
    }
}

/// A small PNG; `None` for anything else.
fn decode(png: &[u8]) -> Option<ColorImage> {
    let mut reader = image::ImageReader::with_format(std::io::Cursor::new(png), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(1024), Some(1024));
    reader.limits(limits);
    let pixels = reader.decode().ok()?.into_rgb8();
    let size = [pixels.width() as usize, pixels.height() as usize];
    Some(ColorImage::from_rgb(size, pixels.as_raw()))
}

/// Draws the gallery.
pub(super) fn show(
    ui: &mut Ui,
    library: &mut Library,
    (document, preferences): (&Document, &mut Preferences),
) -> Vec<Action> {
    let mut actions = Vec::new();
    ui.horizontal(|ui| {
        ui.strong("Presets");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let list = ui.selectable_label(library.is_list, "List").on_hover_text("Names without pictures");
            super::row::name(ui, &list, "Presets as a list", "presets.list");
            library.is_list ^= list.clicked();
        });
    });
    let edit = egui::TextEdit::singleline(&mut library.search).hint_text("Search").desired_width(f32::INFINITY);
    let response = ui.add(edit).on_hover_text("Words of names, descriptions and tags");
    super::row::name(ui, &response, "Search presets", "presets.search");
    morph_row(ui, library, document, &mut actions);
    ui.add_space(2.0);
    ScrollArea::vertical().id_salt("preset list").auto_shrink([false; 2]).show(ui, |ui| {
        let search = library.search.trim().to_lowercase();
        let wanted = |entry: &&Entry| entry.is_wanted(&search);
        let all: Vec<Entry> = library.builtin.iter().chain(&library.user).filter(wanted).cloned().collect();
        let (starred, others): (Vec<Entry>, Vec<Entry>) =
            all.into_iter().partition(|entry| preferences.favourites.contains(&entry.source));
        let (builtin, user): (Vec<Entry>, Vec<Entry>) = others.into_iter().partition(|entry| entry.is_builtin);
        let mut allowed = DECODED_AT_ONCE;
        let mut gallery = Gallery { library, preferences, document, allowed: &mut allowed, actions: &mut actions };
        if !starred.is_empty() {
            ui.label(RichText::new("Starred").strong());
            gallery.show(ui, &starred);
            ui.add_space(6.0);
        }
        gallery.show(ui, &builtin);
        ui.add_space(6.0);
        let folder = gallery.library.folder.display().to_string();
        ui.label(RichText::new("Yours").strong()).on_hover_text(folder);
        if gallery.library.user.is_empty() {
            ui.weak("Presets that you save in your folder appear here.");
        }
        gallery.show(ui, &user);
    });
    actions
}

/// The slider between two skies.
fn morph_row(ui: &mut Ui, library: &mut Library, document: &Document, actions: &mut Vec<Action>) {
    let Some(state) = &mut library.morph else { return };
    let mut is_over = false;
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(format!("→ {}", state.name)).truncate());
        let done = ui.button("Done").on_hover_text("Keeps the sky as it is now");
        super::row::name(ui, &done, "Morph done", "presets.morph.done");
        is_over = done.clicked();
    });
    ui.spacing_mut().slider_width = (ui.available_width() - 8.0).max(40.0);
    let slider = ui.add(egui::Slider::new(&mut state.share, 0.0..=1.0).show_value(false));
    super::row::name(ui, &slider, "Morph", "presets.morph");
    if slider.changed() {
        let now = &document.preset().scene;
        let is_ours = |last: &Scene| Scene { camera: now.camera.clone(), ..last.clone() } == *now;
        if !state.last.as_ref().is_some_and(is_ours) {
            // What was edited meanwhile is where it goes on from.
            state.from = now.clone();
        }
        let scene = Scene { camera: now.camera.clone(), ..morph(&state.from, &state.to, state.share) };
        state.last = Some(scene.clone());
        actions.push(Action::EditScene { key: format!("towards {}", state.name), scene: Box::new(scene) });
    }
    if is_over {
        library.morph = None;
    }
}

struct Gallery<'g> {
    library: &'g mut Library,
    preferences: &'g mut Preferences,
    document: &'g Document,
    allowed: &'g mut usize,
    actions: &'g mut Vec<Action>,
}

impl Gallery<'_> {
    fn show(&mut self, ui: &mut Ui, entries: &[Entry]) {
        let width = ui.available_width();
        if self.library.is_list {
            for entry in entries {
                let button = egui::Button::selectable(self.is_current(entry), entry.name.as_str());
                let response = ui.add(button.truncate().min_size([width, 0.0].into()));
                self.respond(response, entry);
            }
            return;
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few columns")]
        let columns = ((width / CELL) as usize).max(1);
        let gap = ui.spacing().item_spacing.x;
        let cell = (width - gap * (columns as f32 - 1.0)) / columns as f32;
        for row in entries.chunks(columns) {
            ui.horizontal_top(|ui| row.iter().for_each(|entry| self.cell(ui, entry, cell)));
        }
    }

    /// A picture with the preset's name below.
    fn cell(&mut self, ui: &mut Ui, entry: &Entry, width: f32) {
        let picture = Vec2::new(width, width * 9.0 / 16.0);
        let text_height = ui.spacing().interact_size.y;
        let (rect, response) = ui.allocate_exact_size(picture + Vec2::new(0.0, text_height), Sense::click());
        if !ui.is_rect_visible(rect) {
            self.respond(named(ui, response, entry), entry);
            return;
        }
        let place = egui::Rect::from_min_size(rect.min, picture);
        let painter = ui.painter_at(rect);
        match self.library.texture(ui.ctx(), entry, self.allowed) {
            Some(texture) => {
                let uv = egui::Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
                painter.image(texture.id(), place, uv, Color32::WHITE);
            }
            None => {
                painter.rect_filled(place, 3.0, ui.visuals().faint_bg_color);
            }
        }
        let is_current = self.is_current(entry);
        let stroke = if is_current || response.hovered() {
            egui::Stroke::new(2.0, ui.visuals().selection.bg_fill)
        } else {
            egui::Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color)
        };
        painter.rect_stroke(place, 3.0, stroke, egui::StrokeKind::Inside);
        if self.preferences.favourites.contains(&entry.source) {
            star(&painter, place.right_top() + Vec2::new(-11.0, 11.0), 7.0);
        }
        let colour = if is_current { ui.visuals().strong_text_color() } else { ui.visuals().text_color() };
        let font = egui::TextStyle::Body.resolve(ui.style());
        let mut job = egui::text::LayoutJob::simple_singleline(entry.name.clone(), font, colour);
        job.wrap = egui::text::TextWrapping::truncate_at_width(width);
        let galley = painter.layout_job(job);
        let below = place.left_bottom() + Vec2::new(2.0, 0.5 * (text_height - galley.size().y));
        painter.galley(below, galley, colour);
        self.respond(named(ui, response, entry), entry);
    }

    fn is_current(&self, entry: &Entry) -> bool {
        match self.document.path() {
            Some(path) => *path == entry.source,
            None => entry.is_builtin && self.document.preset().name == entry.name,
        }
    }

    /// What a click and the menu of an entry do.
    fn respond(&mut self, response: egui::Response, entry: &Entry) {
        let open = |request| Action::Ask(request);
        if response.clicked() {
            self.actions.push(open(Request::Open(entry.source.clone())));
        }
        super::menu::on(&response, |ui| {
            let source = || entry.source.clone();
            if ui.button("Open").clicked() {
                self.actions.push(open(Request::Open(source())));
                ui.close();
            }
            ui.menu_button("Take over only", |ui| {
                for part in Part::ALL {
                    if ui.button(part.title()).clicked() {
                        self.actions.push(open(Request::TakeOver { source: source(), part: *part }));
                        ui.close();
                    }
                }
            });
            if ui.button("Morph towards it").clicked() {
                self.actions.push(open(Request::Morph(source())));
                ui.close();
            }
            let is_starred = self.preferences.favourites.contains(&entry.source);
            if ui.button(if is_starred { "Take the star" } else { "Star" }).clicked() {
                self.preferences.toggle_favourite(&entry.source);
                ui.close();
            }
        });
        if !entry.description.is_empty() {
            let tags = if entry.tags.is_empty() { String::new() } else { format!("\n{}", entry.tags.join(", ")) };
            response.on_hover_text(format!("{}{tags}", entry.description));
        }
    }
}

/// A star, which the fonts lack: five kites round a point.
fn star(painter: &egui::Painter, at: egui::Pos2, radius: f32) {
    painter.circle_filled(at, radius + 3.0, Color32::from_black_alpha(120));
    let corner = |turn: f32, radius: f32| {
        let angle = std::f32::consts::TAU * turn / 5.0 - std::f32::consts::FRAC_PI_2;
        at + radius * Vec2::angled(angle)
    };
    for tip in 0..5_u8 {
        let turn = f32::from(tip);
        let kite = vec![at, corner(turn - 0.5, 0.42 * radius), corner(turn, radius), corner(turn + 0.5, 0.42 * radius)];
        painter.add(egui::Shape::convex_polygon(kite, Color32::from_rgb(255, 214, 90), egui::Stroke::NONE));
    }
}

/// Gives a cell the name of its preset, for screen readers and the keyboard.
fn named(ui: &Ui, response: egui::Response, entry: &Entry) -> egui::Response {
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_role(egui::accesskit::Role::Button));
    super::row::name(ui, &response, &entry.name, &format!("preset.{}", entry.source.display()));
    response
}
