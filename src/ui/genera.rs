//! Genera of clouds by name, and what follows from the water of each layer.

use egui::Ui;

use super::row;
use crate::scene::genus::{Derived, Genus};
use crate::scene::param::Choice as _;
use crate::scene::{MAX_LAYERS, Scene};

/// Draws a row for each genus and what follows from each layer's water; returns the key of what was changed in the scene.
pub(super) fn show(ui: &mut Ui, scene: &mut Scene) -> Option<&'static str> {
    let mut changed = None;
    ui.horizontal_wrapped(|ui| {
        for genus in Genus::ALL {
            let title = genus.title();
            let menu = ui.menu_button(title, |ui| {
                ui.set_min_width(180.0);
                let instead = ui.button("In place of these clouds");
                if instead.on_hover_text("Clouds and weather of this genus; light and camera stay").clicked() {
                    genus.replace(scene);
                    changed = Some("genus");
                    ui.close();
                }
                let is_room = scene.layers.len() < MAX_LAYERS;
                let beside = ui.add_enabled(is_room, egui::Button::new("Beside these clouds"));
                let hint = format!("Adds its layers; a sky has {MAX_LAYERS} at most");
                if beside.on_hover_text(&hint).on_disabled_hover_text(&hint).clicked() {
                    let mut fuller = scene.clone();
                    if genus.join(&mut fuller).is_ok() {
                        *scene = fuller;
                        changed = Some("layers");
                    }
                    ui.close();
                }
            });
            row::name(ui, &menu.response, title, &format!("genus.{title}"));
            menu.response.on_hover_text(genus.doc().trim());
        }
    });
    for (index, layer) in scene.layers.iter().enumerate().filter(|(_, layer)| layer.is_visible()) {
        let derived = Derived::of(layer);
        let droplets =
            derived.effective_radius_um.map_or_else(String::new, |radius| format!("droplets of {radius:.1} µm, "));
        let free = 1.0 / derived.extinction_per_m.max(1e-9);
        let text = format!(
            "Layer {}: {droplets}free path {free:.0} m, optical depth up to {:.1}",
            index + 1,
            derived.optical_depth
        );
        let hint = "Effective radius of the droplets, mean way of light between two of them at full density, and that over the \
                    whole thickness. “Optics” in the layer chooses whether water and droplets are given, or the extinction";
        ui.weak(text).on_hover_text(hint);
    }
    changed
}
