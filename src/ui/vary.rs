//! Random changes of a sky: by how much, from which seed, and which sections stay as they are.

use std::collections::BTreeSet;

use egui::{Align2, Context, Rect, Slider};

use super::row;
use crate::app::action::Action;
use crate::app::document::Document;
use crate::scene::Scene;
use crate::scene::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params as _, Visitor};
use crate::scene::random::vary;

/// Sections that are kept until the user wants otherwise: they are about the picture, not the sky.
const KEPT_AT_FIRST: [&str; 4] = ["camera", "display", "domain", "plain_light"];

/// What the window remembers.
#[derive(Clone, Debug)]
pub struct VaryState {
    /// Whether the window is there.
    pub is_open: bool,
    seed: u32,
    percent: f32,
    kept: BTreeSet<String>,
    /// The sky that is being varied, and what came of it last: other seeds start from the same sky.
    last: Option<Box<(Scene, Scene)>>,
}

impl Default for VaryState {
    fn default() -> Self {
        let kept = KEPT_AT_FIRST.iter().map(|key| (*key).to_owned()).collect();
        Self { is_open: false, seed: 1, percent: 30.0, kept, last: None }
    }
}

impl VaryState {
    /// The sky of the seed.
    fn varied(&mut self, scene: &Scene) -> Scene {
        let camera = &scene.camera;
        let base = match self.last.take() {
            // Flights do not count.
            Some(last) if Scene { camera: camera.clone(), ..last.1.clone() } == *scene => {
                Scene { camera: camera.clone(), ..last.0 }
            }
            _ => scene.clone(),
        };
        let mut varied = base.clone();
        vary(&mut varied, self.seed, self.percent / 100.0, &|key| self.kept.contains(key));
        varied.mend();
        self.last = Some(Box::new((base, varied.clone())));
        varied
    }
}

/// Keys and titles of a scene's sections.
struct Sections(Vec<(String, String)>);

impl Visitor for Sections {
    fn float(&mut self, _: &Info<f32>, _: &mut f32) {}
    fn count(&mut self, _: &Info<u32>, _: &mut u32) {}
    fn switch(&mut self, _: &Info<bool>, _: &mut bool) {}
    fn choice(&mut self, _: &ChoiceInfo, _: &mut usize) {}
    fn colour(&mut self, _: &Info<Colour>, _: &mut Colour) {}
    fn file(&mut self, _: &Info<FileName>, _: &mut FileName) {}

    fn group(&mut self, info: &GroupInfo, _: &mut dyn FnMut(&mut dyn Visitor)) {
        self.0.push((info.name.to_owned(), info.title.to_owned()));
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        let item = |index| (format!("{}.{index}", info.name), format!("{} {}", info.title, index + 1));
        self.0.extend((0..list.count()).map(item));
    }
}

/// Draws the window.
pub(super) fn show(
    context: &Context,
    area: Rect,
    (state, document): (&mut VaryState, &Document),
    actions: &mut Vec<Action>,
) {
    let mut is_open = state.is_open;
    let window = egui::Window::new("Vary the sky").open(&mut is_open).default_width(250.0).constrain_to(area);
    window.pivot(Align2::RIGHT_TOP).default_pos(area.right_top() + egui::vec2(-12.0, 12.0)).show(context, |ui| {
        let mut wanted = false;
        ui.horizontal(|ui| {
            ui.label("By");
            let slider = ui.add(Slider::new(&mut state.percent, 1.0..=100.0).suffix(" %").fixed_decimals(0));
            row::name(ui, &slider, "Amount", "vary.amount");
            // The same seed by more or less is seen while the slider moves.
            wanted |= slider.changed() && state.last.as_ref().is_some_and(|last| last.1 == document.preset().scene);
        });
        ui.horizontal(|ui| {
            ui.label("Seed");
            let seed = ui.add(egui::DragValue::new(&mut state.seed).range(0..=999_999));
            row::name(ui, &seed, "Seed", "vary.seed");
            wanted |= seed.changed();
            if ui.button("Vary").on_hover_text("Moves every parameter by a random share of itself").clicked() {
                wanted = true;
            }
            if ui.button("Another").on_hover_text("Draws the next seed for the same sky").clicked() {
                state.seed = state.seed.wrapping_add(1) % 1_000_000;
                wanted = true;
            }
        });
        ui.add_space(4.0);
        ui.weak("Kept as they are:");
        let mut sections = Sections(Vec::new());
        document.preset().scene.clone().visit(&mut sections);
        ui.horizontal_wrapped(|ui| {
            for (key, title) in sections.0 {
                let mut is_kept = state.kept.contains(&key);
                let response = ui.checkbox(&mut is_kept, title.as_str());
                row::name(ui, &response, &format!("Keep {title}"), &format!("vary.keep.{key}"));
                if response.changed() {
                    if is_kept {
                        state.kept.insert(key)
                    } else {
                        state.kept.remove(&key)
                    };
                }
            }
        });
        if wanted {
            let scene = state.varied(&document.preset().scene);
            actions.push(Action::EditScene { key: "vary".to_owned(), scene: Box::new(scene) });
        }
    });
    state.is_open = is_open;
}
