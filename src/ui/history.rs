//! The list of steps: what was done, what was undone, and a click to go there.

use egui::{Align2, Context, Rect, RichText, ScrollArea};

use crate::app::action::Action;
use crate::app::document::Document;

/// Draws the list; a click on a step goes to the document as it was after it.
pub(super) fn show(
    context: &Context,
    area: Rect,
    document: &Document,
    (is_open, actions): (&mut bool, &mut Vec<Action>),
) {
    let (past, future) = document.steps();
    let window = egui::Window::new("History").open(is_open).default_width(230.0).constrain_to(area);
    window.pivot(Align2::LEFT_TOP).default_pos(area.left_top() + egui::vec2(12.0, 12.0)).show(context, |ui| {
        if past.is_empty() && future.is_empty() {
            ui.weak("Nothing was changed yet.");
            return;
        }
        ScrollArea::vertical().max_height(320.0).auto_shrink([false, true]).stick_to_bottom(true).show(ui, |ui| {
            let names = std::iter::once("the beginning").chain(past.iter().copied()).chain(future.iter().copied());
            for (index, name) in names.enumerate() {
                let is_undone = index > past.len();
                let text = RichText::new(name);
                let button = egui::Button::selectable(index == past.len(), if is_undone { text.weak() } else { text });
                let response = ui.add(button.truncate().min_size([ui.available_width(), 0.0].into()));
                super::row::name(ui, &response, name, &format!("history.{index}"));
                if response.clicked() && index != past.len() {
                    let steps = isize::try_from(index).unwrap_or(0) - isize::try_from(past.len()).unwrap_or(0);
                    actions.push(Action::TravelHistory(steps));
                }
            }
        });
    });
}
