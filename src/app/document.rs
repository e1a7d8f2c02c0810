//! The document: the sky being edited. [`Document::apply`] is its only writer.

use std::path::PathBuf;

use glam::{DMat2, DVec2};

use super::action::Action;
use super::history::{History, Scope, State, Views};
use crate::render::uniforms::map_place;
use crate::scene::{Animation, Frame, Output, Preset, Quality, QualityLevel, SPEED_RANGE, Scene, SunPlacement};

/// The sky being edited, how it is computed, and where it came from.
#[derive(Clone, Debug)]
pub struct Document {
    preset: Preset,
    quality: Quality,
    path: Option<PathBuf>,
    saved: Preset,
    time_secs: f64,
    playing: bool,
    history: History,
    views: Views,
}

impl Document {
    /// A document that shows a preset which is not a file of the user's, with time standing.
    pub fn new(preset: Preset, quality: Quality) -> Self {
        Self {
            saved: preset.clone(),
            preset,
            quality,
            path: None,
            time_secs: 0.0,
            playing: false,
            history: History::default(),
            views: Views::default(),
        }
    }

    /// The same for a preset that was read from, and is saved to, `path`.
    pub fn from_file(preset: Preset, quality: Quality, path: PathBuf) -> Self {
        Self { path: Some(path), ..Self::new(preset, quality) }
    }

    /// The preset as edited.
    pub fn preset(&self) -> &Preset {
        &self.preset
    }

    /// How the sky is computed.
    pub fn quality(&self) -> &Quality {
        &self.quality
    }

    /// The level whose settings the quality has, if it has those of any.
    pub fn quality_level(&self) -> Option<QualityLevel> {
        use crate::scene::param::Choice;
        QualityLevel::ALL.iter().copied().find(|level| Quality::level(*level) == self.quality)
    }

    /// Where it was loaded from or saved to.
    pub fn path(&self) -> Option<&PathBuf> {
        self.path.as_ref()
    }

    /// Seconds since the scene began.
    pub fn time_secs(&self) -> f64 {
        self.time_secs
    }

    /// Whether time runs.
    pub fn is_playing(&self) -> bool {
        self.playing
    }

    /// What changes with time.
    pub fn animation(&self) -> &Animation {
        &self.preset.animation
    }

    /// Whether there is anything to save.
    pub fn is_modified(&self) -> bool {
        if self.preset.animation.is_moving() { self.preset.at_rest() != self.saved } else { self.preset != self.saved }
    }

    /// Name and unsaved mark, for the title of the window.
    pub fn title(&self) -> String {
        let mark = if self.is_modified() { "*" } else { "" };
        format!("{}{mark}", self.name())
    }

    /// The preset's name, or what stands for it.
    pub fn name(&self) -> &str {
        if self.preset.name.is_empty() { "Untitled" } else { &self.preset.name }
    }

    /// The next picture of it, `size` pixels large.
    pub fn frame(&self, size: [u32; 2], output: Output) -> Frame<'_> {
        Frame {
            scene: &self.preset.scene,
            quality: &self.quality,
            size,
            time_secs: self.time_secs,
            output,
            window: None,
        }
    }

    /// Lets time run for some seconds of the clock.
    pub fn advance_clock(&mut self, seconds: f64) {
        if self.playing {
            let (time_secs, has_ended) = self.preset.animation.after(self.time_secs, seconds);
            self.playing = !has_ended;
            self.seek(time_secs);
        }
    }

    /// Goes to a time of the scene.
    fn seek(&mut self, time_secs: f64) {
        self.time_secs = time_secs;
        self.preset.play(time_secs);
    }

    /// The preset as it was opened or saved last.
    pub fn saved(&self) -> &Preset {
        &self.saved
    }

    /// Remembers that the preset as it is now lies in `path`.
    pub fn mark_saved(&mut self, path: PathBuf) {
        self.path = Some(path);
        self.saved = self.preset.at_rest();
    }

    /// Makes the document count as unsaved whatever it holds, as after a recovery or a paste.
    pub fn mark_unsaved(&mut self) {
        self.saved = Preset::default();
        self.saved.name.push_str("before recovery");
    }

    /// Becomes another document; the step can be undone.
    pub fn replace_by(&mut self, other: Self, step: impl Into<String>) {
        let before = self.state();
        let mut history = std::mem::take(&mut self.history);
        history.record(step.into(), Scope::Document, before);
        // Cameras of another sky lead nowhere in this one.
        *self = Self { history, views: Views::default(), ..other };
    }

    /// Carries out an action and remembers how to undo it. Requests are not for the document and change nothing.
    pub fn apply(&mut self, action: &Action) {
        match action {
            Action::Undo => self.travel(-1),
            Action::Redo => self.travel(1),
            Action::TravelHistory(steps) => self.travel(*steps),
            Action::ViewBack | Action::ViewForth if !self.has_camera_keys() => self.change(action),
            Action::MeterExposure(_) => self.change(action),
            Action::MoveCamera(_) | Action::PlaceCamera(_) | Action::ResetCamera | Action::GoToCamera(_)
                if !self.has_camera_keys() =>
            {
                let before = self.preset.scene.camera.clone();
                self.change(action);
                if self.preset.scene.camera != before {
                    self.views.leave(&before, !matches!(action, Action::MoveCamera(_)));
                }
            }
            Action::Play(_) | Action::ResetTime | Action::Seek(_) => self.change(action),
            _ => {
                let before = self.state();
                self.change(action);
                let (animation, layers) = (&mut self.preset.animation, &self.preset.scene.layers);
                if let Action::EditScene { key, .. } = action
                    && key == "genus"
                {
                    // It brings layers and weather of its own.
                    animation.override_by(["layers", "weather", "domain"]);
                } else if let Action::EditScene { key, .. } = action {
                    animation.follow(key, "layers", &before.preset.scene.layers, layers);
                    let maps = [&before.preset.scene, &self.preset.scene].map(|scene| &scene.weather.layers);
                    animation.follow(key, "weather.layers", maps[0], maps[1]);
                    animation.follow(key, "shapes", &before.preset.scene.shapes, &self.preset.scene.shapes);
                }
                animation.keep_only_what_is_in(&self.preset.scene);
                if action.is_edit_of_scene() {
                    // What is edited while it has keys gets one at this time.
                    animation.absorb(&self.preset.scene, self.time_secs);
                }
                self.preset.play(self.time_secs);
                if self.preset != before.preset || self.quality != before.quality {
                    let scope = match action {
                        Action::Restore { .. } => Scope::Document,
                        _ if self.preset.scene.camera != before.preset.scene.camera => Scope::Camera,
                        _ => Scope::Sky,
                    };
                    self.history.record(action.name(), scope, before);
                }
            }
        }
    }

    /// Says whether the pointer is held: what it does until it is let go is one step.
    pub fn hold(&mut self, is_held: bool) {
        self.history.hold(is_held);
    }

    /// Names of the steps that can be undone, the oldest first, and of those that can be redone, the next first.
    pub fn steps(&self) -> (Vec<&str>, Vec<&str>) {
        self.history.names()
    }

    /// Whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        self.history.depth().0 > 0
    }

    /// Whether there is a step to redo.
    pub fn can_redo(&self) -> bool {
        self.history.depth().1 > 0
    }

    /// Whether there is a camera to go back to.
    pub fn can_go_back(&self) -> bool {
        self.views.depth().0 > 0
    }

    /// Whether there is a camera to go forth to.
    pub fn can_go_forth(&self) -> bool {
        self.views.depth().1 > 0
    }

    /// Goes so many steps back (below 0) or forth, as far as there are any.
    fn travel(&mut self, steps: isize) {
        for _ in 0..steps.unsigned_abs() {
            let now = self.state();
            let step = if steps < 0 { self.history.undo(now) } else { self.history.redo(now) };
            let Some((scope, state)) = step else { return };
            let camera = self.preset.scene.camera.clone();
            self.preset = state.preset;
            self.quality = state.quality;
            match scope {
                Scope::Sky => self.preset.scene.camera = camera,
                Scope::Camera => {}
                Scope::Document => {
                    (self.path, self.saved) = (state.path, state.saved);
                    (self.time_secs, self.playing) = state.time;
                    self.views = Views::default();
                }
            }
            // Time goes on: what has keys is as they say now.
            self.preset.play(self.time_secs);
        }
    }

    fn has_camera_keys(&self) -> bool {
        self.preset.animation.tracks.iter().any(|track| track.key.starts_with("camera."))
    }

    fn state(&self) -> State {
        State {
            preset: self.preset.clone(),
            quality: self.quality.clone(),
            path: self.path.clone(),
            saved: self.saved.clone(),
            time: (self.time_secs, self.playing),
        }
    }

    fn change(&mut self, action: &Action) {
        let scene = &mut self.preset.scene;
        match action {
            Action::EditScene { scene: edited, .. } => {
                *scene = (**edited).clone();
                // What is saved has to open again.
                scene.mend();
            }
            Action::EditQuality { quality, .. } => self.quality = (**quality).clone(),
            Action::SetQualityLevel(level) => self.quality = Quality::level(*level),
            Action::MoveCamera(camera) | Action::PlaceCamera(camera) => scene.camera = camera.clone(),
            Action::ResetCamera => scene.camera = self.saved.at(self.time_secs).camera,
            Action::GoToCamera(index) => {
                if let Some(kept) = self.preset.cameras.get(*index) {
                    scene.camera = kept.camera.clone();
                }
            }
            Action::EditCameras { cameras, .. } => self.preset.cameras.clone_from(cameras),
            Action::TurnSun { elevation_deg, azimuth_deg } => self.turn_sun(*elevation_deg, *azimuth_deg),
            Action::ChangeExposure(stops) => {
                scene.display.exposure_ev = (scene.display.exposure_ev + stops).clamp(-12.0, 24.0);
            }
            Action::Restore { preset, quality, path, saved, time_secs, .. } => {
                self.preset = (**preset).clone();
                self.time_secs = *time_secs;
                self.quality = (**quality).clone();
                self.path.clone_from(path);
                self.saved = (**saved).clone();
            }
            Action::Rename(name) => self.preset.name.clone_from(name),
            Action::Play(playing) => {
                self.playing = *playing;
                let animation = &self.preset.animation;
                let has_ended =
                    animation.is_moving() && !animation.repeats && self.time_secs >= animation.duration_secs;
                if *playing && has_ended {
                    self.seek(0.0);
                }
            }
            Action::ViewBack | Action::ViewForth => {
                let now = &scene.camera;
                let camera = if *action == Action::ViewBack { self.views.back(now) } else { self.views.forth(now) };
                if let Some(camera) = camera {
                    scene.camera = camera;
                }
            }
            Action::MeterExposure(stops) => {
                scene.display.exposure_ev = (scene.display.exposure_ev + stops).clamp(-12.0, 24.0);
            }
            Action::ResetTime => self.seek(0.0),
            Action::Seek(time_secs) => self.seek(*time_secs),
            Action::SetSpeed(speed) => {
                self.preset.animation.speed = speed.clamp(*SPEED_RANGE.start(), *SPEED_RANGE.end());
            }
            Action::SetKey(key) => self.preset.animation.set_key(&self.preset.scene, key, self.time_secs),
            Action::EditAnimation { animation, .. } => self.preset.animation = (**animation).clone(),
            Action::DayLapse { film_secs, speed } => {
                if let Some(day) = self.preset.animation.day(&self.preset.scene.sun, *film_secs, *speed) {
                    self.preset.scene.sun.placement = SunPlacement::Hour;
                    self.preset.animation = day;
                    self.playing = true;
                    self.time_secs = 0.0;
                }
            }
            Action::Undo | Action::Redo | Action::TravelHistory(_) | Action::Ask(_) => {}
        }
    }

    /// Dragging the sun gives its place by direction, wherever the hour had put it.
    fn turn_sun(&mut self, elevation_deg: f32, azimuth_deg: f32) {
        let towards = self.preset.scene.towards_sun();
        let sun = &mut self.preset.scene.sun;
        if sun.placement != SunPlacement::Direction {
            sun.placement = SunPlacement::Direction;
            sun.elevation_deg = towards.y.clamp(-1.0, 1.0).asin().to_degrees();
            sun.azimuth_deg = towards.x.atan2(-towards.z).to_degrees().rem_euclid(360.0);
        }
        sun.elevation_deg = (sun.elevation_deg + elevation_deg).clamp(-90.0, 90.0);
        sun.azimuth_deg = (sun.azimuth_deg + azimuth_deg).rem_euclid(360.0);
    }
}

/// Where the eye is on the weather map, for the panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeOnMap {
    /// Edges of the map from its corner.
    pub eye: DVec2,
    /// How far a metre to the east and one to the south go.
    pub per_metre: DMat2,
}

/// The same of a scene at a time, as the layer reads the map that stands on it; `None` where none does.
pub fn eye_on_map(scene: &Scene, time_secs: f64) -> Option<EyeOnMap> {
    let (_, layer) = scene.layer_on_map()?;
    let camera = &scene.camera;
    let [east, south] = [f64::from(camera.east_m), f64::from(camera.south_m)];
    let place = |by: DVec2| map_place(scene, layer, [east + by.x, f64::from(layer.base_m), south + by.y], time_secs);
    let eye = place(DVec2::ZERO);
    // The map is straight: far enough apart for single precision.
    let far = 1e4;
    let [x, y] = [DVec2::X, DVec2::Y].map(|axis| (place(axis * far) - eye) / far);
    Some(EyeOnMap { eye, per_metre: DMat2::from_cols(x, y) })
}

#[cfg(test)]
mod tests;
