//! What mouse and keyboard do to the camera and the sun.

use std::collections::BTreeSet;

use glam::Vec2;
use winit::dpi::PhysicalPosition;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::{CursorGrabMode, Window};

use super::Action;
use super::camera_control::{CameraControl, Push};
use super::document::Document;
use crate::ui::Gesture;

/// Keys that fly, by their place on the keyboard, so that they work on any layout.
const FLY_KEYS: [KeyCode; 6] =
    [KeyCode::KeyW, KeyCode::KeyA, KeyCode::KeyS, KeyCode::KeyD, KeyCode::KeyQ, KeyCode::KeyE];
/// Shift and Ctrl change the speed by this factor.
const FASTER: f64 = 5.0;
/// Turn of the sun per point of a drag, in degrees.
const SUN_DEGREES_PER_POINT: f32 = 0.15;

/// The state of the hands.
#[derive(Debug, Default)]
pub(super) struct Hands {
    control: CameraControl,
    /// Keys that are down, among those that matter here.
    down: BTreeSet<KeyCode>,
    /// Movement of the mouse since the last tick, in pixels.
    moved: Vec2,
    /// While looking: where the pointer was before.
    looking: Option<Option<PhysicalPosition<f64>>>,
    pointer: Option<PhysicalPosition<f64>>,
}

impl Hands {
    /// Notes an event; tells whether it was for the hands alone, and egui must not see it.
    pub(super) fn takes(&mut self, window: &Window, event: &WindowEvent, typing: bool) -> bool {
        match event {
            WindowEvent::KeyboardInput { event, .. } => {
                let PhysicalKey::Code(code) = event.physical_key else { return false };
                let fly = FLY_KEYS.contains(&code);
                let matters = fly || is_modifier(code);
                match event.state {
                    ElementState::Pressed if matters && !typing => self.down.insert(code),
                    ElementState::Pressed => false,
                    ElementState::Released => self.down.remove(&code),
                };
                fly && self.looking.is_some()
            }
            WindowEvent::MouseWheel { delta, .. } if self.looking.is_some() => {
                self.control.change_speed(match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(*lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / 40.0,
                });
                true
            }
            WindowEvent::CursorMoved { position, .. } => {
                if self.looking.is_none() {
                    self.pointer = Some(*position);
                }
                false
            }
            WindowEvent::MouseInput { state: ElementState::Released, button: MouseButton::Right, .. } => {
                self.stop_looking(window);
                false
            }
            WindowEvent::Focused(false) => {
                self.down.clear();
                self.stop_looking(window);
                false
            }
            _ => false,
        }
    }

    /// Notes a raw movement of the mouse.
    #[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
    pub(super) fn move_mouse(&mut self, (x, y): (f64, f64)) {
        if self.looking.is_some() {
            self.moved += Vec2::new(x as f32, y as f32);
        }
    }

    /// What a gesture over the picture, so many points large, asks of the document.
    pub(super) fn gesture(
        &mut self,
        window: &Window,
        (document, size_pt): (&Document, [u32; 2]),
        gesture: Gesture,
    ) -> Option<Action> {
        let mut camera = document.preset().scene.camera.clone();
        match gesture {
            Gesture::StartLook => {
                self.start_looking(window);
                None
            }
            Gesture::Orbit(drag) => {
                self.control.orbit(&mut camera, Vec2::new(drag.x, drag.y));
                Some(Action::MoveCamera(camera))
            }
            Gesture::Pan(drag) => {
                self.control.pan(&mut camera, Vec2::new(drag.x, drag.y), size_pt);
                Some(Action::MoveCamera(camera))
            }
            Gesture::Dolly(way) => {
                self.control.dolly(&mut camera, way);
                Some(Action::MoveCamera(camera))
            }
            Gesture::Walk(drag) => {
                self.control.walk(&mut camera, Vec2::new(drag.x, drag.y));
                Some(Action::MoveCamera(camera))
            }
            Gesture::DragSun(drag) => Some(Action::TurnSun {
                elevation_deg: -drag.y * SUN_DEGREES_PER_POINT,
                azimuth_deg: drag.x * SUN_DEGREES_PER_POINT,
            }),
        }
    }

    /// Moves the camera by what the hands did during the last seconds.
    pub(super) fn tick(&mut self, document: &Document, seconds: f64) -> Option<Action> {
        self.looking?;
        let before = &document.preset().scene.camera;
        let mut camera = before.clone();
        self.control.look(&mut camera, std::mem::take(&mut self.moved));
        let (push, factor) = self.push();
        if push != Push::default() {
            self.control.fly(&mut camera, push, factor, seconds);
        }
        (camera != *before).then_some(Action::MoveCamera(camera))
    }

    /// Whether the camera may be moving.
    pub(super) fn are_busy(&self) -> bool {
        self.looking.is_some()
    }

    /// The line over the picture while flying.
    pub(super) fn hud(&self) -> Option<String> {
        self.looking?;
        let speed = self.control.speed_mps() * self.push().1;
        Some(if speed >= 10.0 { format!("{speed:.0} m/s") } else { format!("{speed:.1} m/s") })
    }

    fn push(&self) -> (Push, f64) {
        let down = |code| f64::from(u8::from(self.down.contains(&code)));
        let push = Push {
            right: down(KeyCode::KeyD) - down(KeyCode::KeyA),
            up: down(KeyCode::KeyE) - down(KeyCode::KeyQ),
            forward: down(KeyCode::KeyW) - down(KeyCode::KeyS),
        };
        let either = |left, right| self.down.contains(&left) || self.down.contains(&right);
        let mut factor = 1.0;
        if either(KeyCode::ShiftLeft, KeyCode::ShiftRight) {
            factor *= FASTER;
        }
        if either(KeyCode::ControlLeft, KeyCode::ControlRight) {
            factor /= FASTER;
        }
        (push, factor)
    }

    fn start_looking(&mut self, window: &Window) {
        if self.looking.is_some() {
            return;
        }
        // X11 cannot lock the pointer and macOS cannot confine it; raw movements come either way.
        let grabbed = window.set_cursor_grab(CursorGrabMode::Locked);
        if grabbed.or_else(|_| window.set_cursor_grab(CursorGrabMode::Confined)).is_ok() {
            window.set_cursor_visible(false);
        }
        self.moved = Vec2::ZERO;
        self.looking = Some(self.pointer);
    }

    fn stop_looking(&mut self, window: &Window) {
        let Some(before) = self.looking.take() else { return };
        // Neither call can fail in a way that leaves anything to do.
        let _ = window.set_cursor_grab(CursorGrabMode::None);
        window.set_cursor_visible(true);
        if let Some(position) = before {
            let _ = window.set_cursor_position(position);
        }
    }
}

fn is_modifier(code: KeyCode) -> bool {
    matches!(code, KeyCode::ShiftLeft | KeyCode::ShiftRight | KeyCode::ControlLeft | KeyCode::ControlRight)
}
