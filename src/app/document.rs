//! The document: the sky being edited. [`Document::apply`] is its only writer.

use std::path::PathBuf;

use super::action::Action;

use crate::scene::{Camera, Frame, Output, Preset, Quality, QualityLevel, SunPlacement};

/// Slowest and fastest that time may run, in seconds of the scene per second of the clock.
pub const TIME_FACTOR_RANGE: std::ops::RangeInclusive<f64> = 0.0..=10_000.0;

/// The sky being edited, how it is computed, and where it came from.
#[derive(Clone, Debug)]
pub struct Document {
    preset: Preset,
    quality: Quality,
    path: Option<PathBuf>,
    saved: Preset,
    time_secs: f64,
    playing: bool,
    time_factor: f64,
}

impl Document {
    /// A document that shows a preset which is not a file of the user's, with time standing.
    pub fn new(preset: Preset, quality: Quality) -> Self {
        Self { saved: preset.clone(), preset, quality, path: None, time_secs: 0.0, playing: false, time_factor: 1.0 }
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

    /// Seconds of the scene per second of the clock.
    pub fn time_factor(&self) -> f64 {
        self.time_factor
    }

    /// Whether there is anything to save.
    pub fn is_modified(&self) -> bool {
        self.preset != self.saved
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
        Frame { scene: &self.preset.scene, quality: &self.quality, size, time_secs: self.time_secs, output }
    }

    /// Lets time run for some seconds of the clock.
    pub fn advance_clock(&mut self, seconds: f64) {
        if self.playing {
            self.time_secs += seconds * self.time_factor;
        }
    }

    /// The preset as it was opened or saved last.
    pub fn saved(&self) -> &Preset {
        &self.saved
    }

    /// Remembers that the preset as it is now lies in `path`.
    pub fn mark_saved(&mut self, path: PathBuf) {
        self.path = Some(path);
        self.saved = self.preset.clone();
    }

    /// Makes the document count as unsaved whatever it holds, as after a recovery.
    pub fn mark_recovered(&mut self) {
        self.saved = Preset::default();
        self.saved.name.push_str("before recovery");
    }

    /// Carries out an action. Requests are not for the document and change nothing.
    pub fn apply(&mut self, action: &Action) {
        let scene = &mut self.preset.scene;
        match action {
            Action::EditScene { scene: edited, .. } => {
                *scene = (**edited).clone();
                scene.give_grids_a_box();
            }
            Action::EditQuality { quality, .. } => self.quality = (**quality).clone(),
            Action::SetQualityLevel(level) => self.quality = Quality::level(*level),
            Action::MoveCamera(camera) => scene.camera = camera.clone(),
            Action::ResetCamera => scene.camera = self.saved.scene.camera.clone(),
            Action::TurnSun { elevation_deg, azimuth_deg } => self.turn_sun(*elevation_deg, *azimuth_deg),
            Action::ChangeExposure(stops) => {
                scene.display.exposure_ev = (scene.display.exposure_ev + stops).clamp(-12.0, 24.0);
            }
            Action::Rename(name) => self.preset.name.clone_from(name),
            Action::Play(playing) => self.playing = *playing,
            Action::ResetTime => self.time_secs = 0.0,
            Action::SetTimeFactor(factor) => {
                self.time_factor = factor.clamp(*TIME_FACTOR_RANGE.start(), *TIME_FACTOR_RANGE.end());
            }
            Action::Ask(_) => {}
        }
    }

    /// Where the camera was when the preset was loaded or last saved.
    pub fn home_camera(&self) -> &Camera {
        &self.saved.scene.camera
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

#[cfg(test)]
mod tests {
    use super::*;

    fn document() -> Document {
        Document::new(Preset::default(), Quality::default())
    }

    #[test]
    fn an_edit_marks_and_its_undoing_clears_the_mark() {
        let mut document = document();
        assert!(!document.is_modified(), "fresh");
        let before = document.preset().scene.clone();
        let mut edited = before.clone();
        edited.weather.coverage = 0.9;
        document.apply(&Action::EditScene { key: "weather.coverage".to_owned(), scene: Box::new(edited) });
        assert!(document.is_modified() && document.title().ends_with('*'), "{}", document.title());
        document.apply(&Action::EditScene { key: "weather.coverage".to_owned(), scene: Box::new(before) });
        assert!(!document.is_modified(), "back to what is saved");
    }

    #[test]
    fn time_runs_only_while_playing_and_by_its_factor() {
        let mut document = document();
        document.advance_clock(2.0);
        assert_eq!(document.time_secs(), 0.0);
        document.apply(&Action::Play(true));
        document.apply(&Action::SetTimeFactor(10.0));
        document.advance_clock(2.0);
        assert_eq!(document.time_secs(), 20.0);
        document.apply(&Action::ResetTime);
        assert_eq!(document.time_secs(), 0.0);
    }

    #[test]
    fn a_dragged_sun_starts_from_where_the_hour_put_it() {
        let mut document = document();
        let mut scene = document.preset().scene.clone();
        scene.sun.placement = SunPlacement::Hour;
        document.apply(&Action::EditScene { key: "sun.placement".to_owned(), scene: Box::new(scene) });
        let before = document.preset().scene.towards_sun();
        document.apply(&Action::TurnSun { elevation_deg: 0.0, azimuth_deg: 0.0 });
        let after = document.preset().scene.towards_sun();
        assert!(before.abs_diff_eq(after, 1e-4), "{before} became {after}");
    }
}
