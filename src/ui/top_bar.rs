//! The bar at the top: menus, time, and the document's name.

use egui::containers::menu::{MenuConfig, SubMenuButton};
use egui::{Align, Layout, PopupCloseBehavior, ThemePreference, Ui};

use super::{Busy, Command, State, row};
use crate::app::action::{Action, Request, Steering};
use crate::app::document::Document;
use crate::app::preferences::Preferences;
use crate::scene::SPEED_RANGE;
use crate::scene::expression::evaluate;
use crate::scene::param::Unit;

/// Draws the bar.
pub(super) fn show(
    ui: &mut Ui,
    state: &mut State,
    (document, preferences): (&Document, &Preferences),
    actions: &mut Vec<Action>,
) {
    ui.horizontal(|ui| {
        menus(ui, state, (document, preferences), actions);
        ui.separator();
        time(ui, document, actions);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let title = document.title();
            let title = if document.is_modified() { egui::RichText::new(title).strong() } else { title.into() };
            let hint = match document.path() {
                Some(path) => path.display().to_string(),
                None => "Not saved to a file yet".to_owned(),
            };
            ui.add(egui::Label::new(title).truncate()).on_hover_text(hint);
            if let Some(busy) = &state.busy {
                self::busy(ui, busy, actions);
            }
        });
    });
}

fn menus(
    ui: &mut Ui,
    state: &mut State,
    (document, preferences): (&Document, &Preferences),
    actions: &mut Vec<Action>,
) {
    let mut chosen = None;
    ui.menu_button("File", |ui| {
        let groups = [
            &[Command::New, Command::Open][..],
            &[Command::Save, Command::SaveAs],
            &[Command::Screenshot, Command::Export],
            &[Command::Quit],
        ];
        entries(ui, (state, document), &groups, &mut chosen);
        ui.separator();
        ui.add_enabled_ui(!preferences.recent.is_empty(), |ui| {
            ui.menu_button("Open recent", |ui| recent(ui, preferences, actions));
        });
    });
    ui.menu_button("Edit", |ui| {
        let groups = [
            &[Command::Undo, Command::Redo, Command::History][..],
            &[Command::ViewBack, Command::ViewForth],
            &[Command::Paint, Command::Map],
            &[Command::Preferences],
        ];
        entries(ui, (state, document), &groups, &mut chosen);
    });
    ui.menu_button("View", |ui| {
        // Names are typed in it: only a click outside closes it.
        let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        SubMenuButton::new("Cameras").config(stays).ui(ui, |ui| super::cameras::menu(ui, document, actions));
        let groups = [
            &[
                Command::Presets,
                Command::Panel,
                Command::Timeline,
                Command::Overlay,
                Command::Lab,
                Command::Inspect,
                Command::Histogram,
            ][..],
            &[Command::HideAll, Command::FullScreen, Command::Guides, Command::Region],
            &[Command::ResetCamera, Command::FrameClouds, Command::Brighter, Command::Darker, Command::FalseColour],
            &[Command::Refine, Command::Keep, Command::Compare],
        ];
        entries(ui, (state, document), &groups, &mut chosen);
        super::truth::choose(ui, &mut state.truth);
        ui.separator();
        theme_and_scale(ui);
    });
    ui.menu_button("Help", |ui| {
        entries(
            ui,
            (state, document),
            &[&[Command::Help, Command::Palette, Command::Shortcuts], &[Command::CopySystem]],
            &mut chosen,
        );
    });
    if let Some(command) = chosen {
        command.run(ui, state, document, actions);
    }
}

fn entries(ui: &mut Ui, (state, document): (&State, &Document), groups: &[&[Command]], chosen: &mut Option<Command>) {
    ui.set_min_width(230.0);
    for (index, group) in groups.iter().enumerate() {
        if index > 0 {
            ui.separator();
        }
        for command in *group {
            let keys = command.keys(ui.ctx());
            let button = egui::Button::new(command.label(document)).shortcut_text(keys).selected(command.is_on(state));
            if ui.add_enabled(command.is_possible(document), button).clicked() {
                *chosen = Some(*command);
                ui.close();
            }
        }
    }
}

/// What a thread is busy with, how far it is, and the way out. Laid out from the right.
fn busy(ui: &mut Ui, busy: &Busy, actions: &mut Vec<Action>) {
    let waits = busy.steering == Some(Steering::Wait);
    if let Some(steering) = busy.steering {
        let mut button = |title: &str, hint: &str, (name, key): (&str, &str), wanted: Steering| {
            let button = ui.button(title).on_hover_text(hint);
            row::name(ui, &button, name, key);
            if button.clicked() {
                actions.push(Action::Ask(Request::Steer(wanted)));
            }
        };
        let is_settled = matches!(steering, Steering::End | Steering::GiveUp);
        button("Cancel", "Gives it up; nothing is written", ("Cancel the work", "busy.cancel"), Steering::GiveUp);
        if !busy.end.is_empty() && !is_settled {
            button("Stop", busy.end, ("Stop and save", "busy.end"), Steering::End);
        }
        if is_settled {
            ui.weak("ends");
        } else if waits {
            button("Go on", "Renders on", ("Go on with the work", "busy.wait"), Steering::On);
        } else {
            button("Pause", "Leaves the processors to others", ("Pause the work", "busy.wait"), Steering::Wait);
        }
    }
    match busy.progress {
        Some((share, _)) if waits => {
            ui.add(egui::ProgressBar::new(share).desired_width(130.0).text(format!("{:.0} % · waits", share * 100.0)));
        }
        Some((share, left)) => {
            let left = left.map_or_else(String::new, |left| format!(" · {}", clock(left)));
            let bar = egui::ProgressBar::new(share).desired_width(130.0);
            ui.add(bar.text(format!("{:.0} %{left}", share * 100.0)));
        }
        None => {
            ui.spinner();
        }
    }
    ui.add(egui::Label::new(busy.text.as_str()).truncate());
}

/// The files that were opened or saved last.
fn recent(ui: &mut Ui, preferences: &Preferences, actions: &mut Vec<Action>) {
    ui.set_min_width(260.0);
    for path in &preferences.recent {
        let name =
            path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
        let button = ui.add_enabled(path.exists(), egui::Button::new(name).truncate());
        if button.on_hover_text(path.display().to_string()).on_disabled_hover_text("It is no longer there").clicked() {
            actions.push(Action::Ask(Request::Open(path.clone())));
            ui.close();
        }
    }
}

pub(super) fn theme_and_scale(ui: &mut Ui) {
    ui.horizontal(|ui| {
        let chosen = ui.ctx().options(|options| options.theme_preference);
        for (theme, title) in [
            (ThemePreference::Light, "Light"),
            (ThemePreference::Dark, "Dark"),
            (ThemePreference::System, "As the system"),
        ] {
            if ui.selectable_label(chosen == theme, title).clicked() {
                ui.ctx().set_theme(theme);
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label("Size");
        for percent in [75_u8, 100, 125, 150, 200] {
            let factor = f32::from(percent) / 100.0;
            let chosen = (ui.ctx().zoom_factor() - factor).abs() < 0.01;
            if ui.selectable_label(chosen, format!("{percent} %")).clicked() {
                ui.ctx().set_zoom_factor(factor);
            }
        }
    });
}

fn time(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    let (icon, verb) = if document.is_playing() { ("▮▮", "Pause") } else { ("▶", "Play") };
    let play = ui.button(icon).on_hover_text(format!("{verb} wind and time (Space)"));
    row::name(ui, &play, verb, "time.play");
    if play.clicked() {
        actions.push(Action::Play(!document.is_playing()));
    }
    let reset = ui.add_enabled(document.time_secs() != 0.0, egui::Button::new("⇤")).on_hover_text("Time back to 0");
    row::name(ui, &reset, "Reset time", "time.reset");
    if reset.clicked() {
        actions.push(Action::ResetTime);
    }
    ui.add(egui::Label::new(egui::RichText::new(clock(document.time_secs())).monospace()).selectable(false))
        .on_hover_text("Time since the scene began");
    let mut factor = document.animation().speed;
    let speed = factor.max(0.1) * 0.01;
    let field = egui::DragValue::new(&mut factor)
        .range(SPEED_RANGE)
        .speed(speed)
        .prefix("×")
        .update_while_editing(false)
        .custom_formatter(|value, _| row::number(value))
        .custom_parser(|text| evaluate(text.trim_start_matches('×'), Unit::None));
    let field = ui.add(field).on_hover_text("Speed of time: seconds of the scene per second of the clock");
    row::name(ui, &field, "Speed of time", "time.factor");
    if field.changed() {
        actions.push(Action::SetSpeed(factor));
    }
}

/// Seconds as `h:mm:ss`.
#[allow(clippy::cast_possible_truncation, reason = "centuries fit")]
fn clock(seconds: f64) -> String {
    let whole = seconds.max(0.0) as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}
