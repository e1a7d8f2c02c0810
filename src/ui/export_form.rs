//! The form for stills.

use std::path::PathBuf;

use egui::Ui;

use super::dialogs::{Fate, confirm, file_name, path_field};
use super::row;
use crate::app::action::{Action, Browse, Export, Request, Still};
use crate::app::document::Document;
use crate::scene::QualityLevel;
use crate::scene::param::Choice as _;

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

/// Draws the form.
pub(super) fn show(ui: &mut Ui, form: &mut ExportForm, actions: &mut Vec<Action>) -> Fate {
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

