//! Short messages at the edge of the picture. They wrap, can be copied, and are read by screen readers.

use std::time::{Duration, Instant};

use egui::{Align2, Color32, Frame, Id, Rect, RichText, Stroke};

/// How grave a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Something was done.
    Info,
    /// Something could not be done; nothing was lost.
    Error,
}

#[derive(Clone, Debug)]
struct Toast {
    level: Level,
    text: String,
    until: Instant,
}

/// The messages on the screen.
#[derive(Clone, Debug, Default)]
pub struct Toasts {
    toasts: Vec<Toast>,
}

/// More than this would hide the picture.
const MOST: usize = 4;

impl Toasts {
    /// Shows a message for some seconds; errors stay longer.
    pub fn add(&mut self, level: Level, text: impl Into<String>) {
        let seconds = match level {
            Level::Info => 5,
            Level::Error => 20,
        };
        let text = text.into();
        self.toasts.retain(|toast| toast.text != text);
        if self.toasts.len() >= MOST {
            self.toasts.remove(0);
        }
        self.toasts.push(Toast { level, text, until: Instant::now() + Duration::from_secs(seconds) });
    }

    /// Something was done.
    pub fn info(&mut self, text: impl Into<String>) {
        self.add(Level::Info, text);
    }

    /// Something could not be done.
    pub fn error(&mut self, error: impl std::fmt::Display) {
        self.add(Level::Error, error.to_string());
    }

    /// The texts on the screen, oldest first.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.toasts.iter().map(|toast| toast.text.as_str())
    }

    /// Draws the messages at the lower left of `area`.
    pub(super) fn show(&mut self, context: &egui::Context, area: Rect) {
        let now = Instant::now();
        self.toasts.retain(|toast| toast.until > now);
        let Some(next) = self.toasts.iter().map(|toast| toast.until).min() else { return };
        context.request_repaint_after(next - now);
        let width = (area.width() - 40.0).clamp(160.0, 420.0);
        let mut closed = None;
        egui::Area::new(Id::unique("toasts"))
            .order(egui::Order::Foreground)
            .pivot(Align2::LEFT_BOTTOM)
            .fixed_pos(area.left_bottom() + egui::vec2(12.0, -12.0))
            .show(context, |ui| {
                ui.set_max_width(width);
                for (index, toast) in self.toasts.iter().enumerate() {
                    if draw(ui, toast, width) {
                        closed = Some(index);
                    }
                }
            });
        if let Some(index) = closed {
            self.toasts.remove(index);
        }
    }
}

fn draw(ui: &mut egui::Ui, toast: &Toast, width: f32) -> bool {
    let (icon, colour) = match toast.level {
        Level::Info => ("●", Color32::from_rgb(70, 160, 90)),
        Level::Error => ("▲", Color32::from_rgb(205, 90, 60)),
    };
    let frame = Frame::popup(ui.style()).stroke(Stroke::new(1.0, colour));
    frame
        .show(ui, |ui| {
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icon).color(colour));
                ui.vertical(|ui| {
                    ui.set_max_width(width - 70.0);
                    ui.add(egui::Label::new(&toast.text).wrap());
                });
                let close = ui.add(egui::Button::new("×").frame(false));
                super::row::name(ui, &close, "Dismiss", "toast.dismiss");
                close.clicked()
            })
            .inner
        })
        .inner
}
