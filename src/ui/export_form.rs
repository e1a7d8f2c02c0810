//! The form for stills.

use std::path::PathBuf;

use egui::Ui;

use super::dialogs::{Fate, confirm, path_field};
use super::row;
use crate::app::action::{Action, Browse, Export, Request, Sequence, Shape, Still};
use crate::app::document::Document;
use crate::scene::param::Choice as _;
use crate::scene::{Animation, Camera, LARGEST_WHOLE_PX, QualityLevel, file_stem};

/// The form for a still, as typed.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportForm {
    /// What the still shows.
    pub still: Still,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// What it shows.
    pub shape: Shape,
    /// Its frames, if it is a sequence.
    pub frames: Option<Sequence>,
    /// Quality; `None` for that of the viewport.
    pub level: Option<QualityLevel>,
    /// Where light is compressed to, and whether it is.
    pub brightest: (f32, bool),
    /// Where it goes.
    pub path: String,
    /// The region of the viewport, and whether only that is rendered.
    pub region: Option<([f32; 4], bool)>,
    /// The document's film.
    film: Animation,
    /// The camera, and the size of the viewport, in which the region was framed.
    framed: (Camera, [u32; 2]),
}

impl ExportForm {
    /// A full-HD EXR named after the document, at the level that its preset names, of the viewport's region if it has one.
    pub fn for_document(document: &Document, (region, viewport): (Option<[f32; 4]>, [u32; 2])) -> Self {
        let path = PathBuf::from(format!("{}.exr", file_stem(document.name())));
        let path = std::path::absolute(&path).unwrap_or(path).display().to_string();
        let level = Some(document.preset().quality.unwrap_or(QualityLevel::High));
        Self {
            still: Still::Exr,
            width: 1920,
            height: 1080,
            shape: Shape::Camera,
            frames: None,
            level,
            brightest: (1000.0, false),
            path,
            region: region.map(|region| (region, true)),
            film: document.animation().clone(),
            framed: (document.preset().scene.camera.clone(), viewport),
        }
    }

    /// The region in a still of its own shape: what was framed in the viewport.
    fn region_of_still(&self) -> Option<[f32; 4]> {
        let ([left, top, right, bottom], _) =
            self.region.filter(|(_, wanted)| *wanted && self.shape == Shape::Camera)?;
        let (camera, viewport) = &self.framed;
        let corner = |at| camera.point_of(camera.direction_through(at, *viewport), [self.width, self.height]);
        let ([left, top], [right, bottom]) = (corner([left, top])?, corner([right, bottom])?);
        let inside = |share: f32| share.clamp(0.0, 1.0);
        Some([left, top, right, bottom].map(inside))
    }

    /// Memory that it takes, in megabytes. Measured on a software adapter, whose memory is the processor's: so much for each
    /// pixel that is rendered together, what is kept until it is written, and the program itself.
    fn megabytes(&self) -> f64 {
        let faces = if self.shape == Shape::CubeCross { 12.0 } else { 1.0 };
        let pixels = f64::from(self.width) * f64::from(self.height);
        let largest = LARGEST_WHOLE_PX as f64;
        let (together, kept) = match self.still {
            Still::LayersExr => (220.0 * pixels, 0.0),
            Still::Exr | Still::CloudsExr if pixels > largest => (120.0 * 0.5 * largest, 0.0),
            _ if pixels > largest => (120.0 * 0.5 * largest, 24.0 * pixels),
            _ => (120.0 * pixels, 32.0 * pixels * (faces - 1.0)),
        };
        300.0 + (together + kept) / 1e6
    }

    /// Whether its light may be compressed: layers would no longer sum, and clouds have no sun.
    fn can_soften(&self) -> bool {
        matches!(self.still, Still::Exr | Still::Radiance)
    }

    fn is_cube(&self) -> bool {
        matches!(self.shape, Shape::CubeFaces | Shape::CubeCross)
    }

    /// A size that suits what is shown.
    fn fit_size(&mut self) {
        (self.width, self.height) = match self.shape {
            Shape::Camera => (1920, 1080),
            Shape::Panorama => (4096, 2048),
            Shape::CubeFaces | Shape::CubeCross => (1024, 1024),
        };
    }

    /// Gives the path a place for the frame's number, or takes it away.
    fn fit_number(&mut self) {
        let path = PathBuf::from(&self.path);
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let name = match (self.frames.is_some(), name.contains('#'), name.rsplit_once('.')) {
            (true, false, Some((stem, ending))) => format!("{stem}.####.{ending}"),
            (true, false, None) => format!("{name}.####"),
            (false, true, _) => name.replace(".####", "").replace('#', ""),
            _ => name,
        };
        self.path = path.with_file_name(name).display().to_string();
    }

    /// Gives the path the ending that suits the still.
    fn fit_ending(&mut self) {
        let ending = match self.still {
            Still::Png | Still::Png16 => "png",
            Still::Radiance => "hdr",
            Still::Exr | Still::LayersExr | Still::CloudsExr => "exr",
        };
        let path = PathBuf::from(&self.path).with_extension(ending);
        self.path = path.display().to_string();
    }
}

fn sizes(ui: &mut Ui, form: &mut ExportForm) {
    ui.label("Size");
    let is_cube = form.is_cube();
    let response = ui.add(egui::DragValue::new(&mut form.width).range(1..=16_384).suffix(" px"));
    row::name(ui, &response, "Width", "Width");
    if !is_cube {
        let response = ui.add(egui::DragValue::new(&mut form.height).range(1..=16_384).suffix(" px"));
        row::name(ui, &response, "Height", "Height");
    }
    let known: &[(&str, [u32; 2])] = match form.shape {
        Shape::Camera => &[("HD", [1920, 1080]), ("4K", [3840, 2160])],
        Shape::Panorama => &[("2K", [2048, 1024]), ("4K", [4096, 2048]), ("8K", [8192, 4096]), ("16K", [16_384, 8192])],
        Shape::CubeFaces | Shape::CubeCross => &[("512", [512, 512]), ("1K", [1024, 1024]), ("2K", [2048, 2048])],
    };
    for (title, [width, height]) in known {
        if ui.button(*title).on_hover_text(format!("{width} × {height}")).clicked() {
            (form.width, form.height) = (*width, *height);
        }
    }
    if is_cube {
        form.height = form.width;
    } else if let Some((_, wanted)) = form.region.as_mut().filter(|_| form.shape == Shape::Camera) {
        ui.checkbox(wanted, "Only the region").on_hover_text("An EXR keeps its place in the whole");
    }
}

fn frames(ui: &mut Ui, form: &mut ExportForm) {
    let mut is_sequence = form.frames.is_some();
    if ui.checkbox(&mut is_sequence, "Sequence").on_hover_text("Numbered files, one for each frame").changed() {
        form.frames = is_sequence.then(|| Sequence {
            first: 0,
            last: last_frame(&form.film, 24.0),
            step: 1,
            fps: 24.0,
            keeps: true,
        });
        form.fit_number();
    }
    let Some(frames) = &mut form.frames else { return };
    for (value, range, title) in [
        (&mut frames.first, 0..=999_999, "First frame"),
        (&mut frames.last, 0..=999_999, "Last frame"),
        (&mut frames.step, 1..=1000, "Step"),
    ] {
        let field = ui.add(egui::DragValue::new(value).range(range)).on_hover_text(title);
        row::name(ui, &field, title, title);
    }
    frames.last = frames.last.max(frames.first);
    let field = ui.add(egui::DragValue::new(&mut frames.fps).range(0.1..=240.0).suffix(" fps"));
    row::name(ui, &field, "Frames per second", "Frames per second");
    if field.changed() {
        frames.last = last_frame(&form.film, frames.fps);
    }
    ui.checkbox(&mut frames.keeps, "Keep what is there").on_hover_text("Files that exist are not rendered again");
}

/// The last frame of a film from its beginning; half a minute of frames where it has no end.
fn last_frame(film: &Animation, fps: f64) -> u32 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousand frames")]
    film.last_frame(0.0, fps).unwrap_or((30.0 * fps) as u32)
}

/// Draws the form.
pub(super) fn show(ui: &mut Ui, form: &mut ExportForm, actions: &mut Vec<Action>) -> Fate {
    ui.heading("Export pictures");
    ui.label("Rendered in full. PNG and EXR hold the preset: opening one restores this sky.");
    ui.horizontal_wrapped(|ui| {
        for still in Still::ALL {
            let choice = ui.selectable_label(form.still == *still, still.title());
            if choice.on_hover_text(still.doc().trim()).clicked() {
                form.still = *still;
                form.fit_ending();
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label("Shows");
        for shape in Shape::ALL {
            let possible = form.still != Still::LayersExr || matches!(shape, Shape::Camera | Shape::Panorama);
            let choice = ui.add_enabled(possible, egui::Button::selectable(form.shape == *shape, shape.title()));
            if choice.on_hover_text(shape.doc().trim()).clicked() {
                form.shape = *shape;
                form.fit_size();
            }
        }
    });
    ui.horizontal_wrapped(|ui| sizes(ui, form));
    ui.horizontal_wrapped(|ui| frames(ui, form));
    ui.weak(format!("Takes about {:.0} MB of memory", form.megabytes()));
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
    if form.can_soften() {
        ui.horizontal_wrapped(|ui| {
            let (value, wanted) = &mut form.brightest;
            let hint = "Compresses light above half of this towards it, for programs that cannot bear the sun as it is";
            ui.checkbox(wanted, "Soften what is brighter than").on_hover_text(hint);
            let field = ui.add_enabled(*wanted, egui::DragValue::new(value).range(0.1..=65_000.0).speed(10.0));
            row::name(ui, &field, "Brightest light", "Brightest light");
        });
    }
    ui.weak("In a file’s name, {name} is the sky’s and {seed} its weather’s");
    path_field(ui, &mut form.path, Browse::Export, actions);
    match confirm(ui, "Export", !form.path.trim().is_empty()) {
        None => Fate::Stays,
        Some(confirmed) => {
            if confirmed {
                actions.push(Action::Ask(Request::Export(Export {
                    still: form.still,
                    size: [form.width, form.height],
                    shape: form.shape,
                    level: form.level,
                    frames: form.frames,
                    brightest: Some(form.brightest.0).filter(|_| form.can_soften() && form.brightest.1),
                    region: form.region_of_still(),
                    path: PathBuf::from(form.path.trim()),
                })));
            }
            Fate::Closes
        }
    }
}
