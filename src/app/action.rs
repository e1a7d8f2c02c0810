//! What a user can ask for. The panels return actions; only [`super::Document::apply`] changes the document.

use std::path::PathBuf;

use crate::choices;
use crate::lab::accuracy::Setting;
use crate::lab::bench::Rounds;
use crate::lab::suite::SuiteKind;
use crate::render::truth::Goal;
use crate::scene::{Animation, Bookmark, Camera, LARGEST_WHOLE_PX, Preset, Quality, QualityLevel, Scene};

/// One wish of the user.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A parameter of the scene was edited; the key is its path, such as `layers.0.base_m`.
    EditScene {
        /// The parameter.
        key: String,
        /// The scene with the edit.
        scene: Box<Scene>,
    },
    /// A parameter of the quality was edited.
    EditQuality {
        /// The parameter.
        key: String,
        /// The quality with the edit.
        quality: Box<Quality>,
    },
    /// Take the settings of a named level.
    SetQualityLevel(QualityLevel),
    /// The camera moved.
    MoveCamera(Camera),
    /// The camera goes somewhere at once.
    PlaceCamera(Camera),
    /// The camera returns to where the preset put it.
    ResetCamera,
    /// The camera goes to one that was kept, by its number from 0.
    GoToCamera(usize),
    /// The list of kept cameras was edited.
    EditCameras {
        /// What was done to it.
        step: &'static str,
        /// All of them.
        cameras: Vec<Bookmark>,
    },
    /// The sun was dragged by so many degrees of elevation and azimuth.
    TurnSun {
        /// Upwards, in degrees.
        elevation_deg: f32,
        /// Clockwise from above, in degrees.
        azimuth_deg: f32,
    },
    /// Exposure in stops, relative to now; positive is darker, as on a camera.
    ChangeExposure(f32),
    /// The same by the light meter, which leaves no step behind.
    MeterExposure(f32),
    /// The preset's name was edited.
    Rename(String),
    /// Time runs or stands.
    Play(bool),
    /// Back to the beginning of time.
    ResetTime,
    /// To a time, in seconds since the scene began.
    Seek(f64),
    /// Seconds of the scene per second of the clock.
    SetSpeed(f64),
    /// A parameter gets a key, where time is now, for what it is.
    SetKey(String),
    /// Keys were edited.
    EditAnimation {
        /// What was done to them.
        step: String,
        /// All keys.
        animation: Box<Animation>,
    },
    /// The sun goes from dawn to dusk.
    DayLapse {
        /// Length of the film in seconds of the clock.
        film_secs: f64,
        /// Seconds of the scene per second of the clock: how fast clouds go.
        speed: f64,
    },
    /// The sky of a snapshot, its camera included.
    Restore {
        /// What the step is called.
        name: String,
        /// The sky.
        preset: Box<Preset>,
        /// How it was computed.
        quality: Box<Quality>,
        /// Where it came from or was saved to.
        path: Option<PathBuf>,
        /// What that file held.
        saved: Box<Preset>,
        /// The time that it shows, in seconds since the scene began.
        time_secs: f64,
    },
    /// Take the last step back.
    Undo,
    /// Take it again.
    Redo,
    /// Go so many steps back (below 0) or forth in the history.
    TravelHistory(isize),
    /// The camera before the last flight.
    ViewBack,
    /// The camera after it.
    ViewForth,
    /// Anything that concerns files, windows and threads rather than the document.
    Ask(Request),
}

/// What becomes of a still, or of a sequence, that is being rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steering {
    /// It goes on.
    On,
    /// It waits; the processors are free meanwhile.
    Wait,
    /// It ends soon and is written: a picture with the samples of each pixel that it has, a sequence after the frame that is
    /// being made.
    End,
    /// It is given up.
    GiveUp,
}

/// A wish that the document alone cannot fulfil.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Start from the default scene.
    New,
    /// Open a preset, an EXR or PNG that holds one, or a built-in preset by its short name.
    Open(PathBuf),
    /// Save where it came from.
    Save,
    /// Save under a path.
    SaveAs(PathBuf),
    /// The answer to the question about unsaved changes.
    Answer(Answer),
    /// Show the system's file dialog.
    Browse(Browse),
    /// Write what the window shows as PNG.
    Screenshot,
    /// Put what the window shows into the clipboard.
    CopyPicture,
    /// Put what this machine is into the clipboard.
    CopySystem,
    /// Keep the sky with the picture that the window shows.
    Snapshot,
    /// Render a still and write it.
    Export(Export),
    /// What becomes of the still that is being rendered.
    Steer(Steering),
    /// Take one of the copies that a crash left behind, the newest being 0, or none of them.
    Recover(Option<usize>),
    /// Take one part of another sky.
    TakeOver {
        /// A preset's file or the short name of a built-in one.
        source: PathBuf,
        /// Which part.
        part: Part,
    },
    /// Begin to change the sky towards another one.
    Morph(PathBuf),
    /// Keep a small picture of a preset that was saved.
    KeepPicture(PathBuf),
    /// Put text from the clipboard into a parameter or section; without one it is a whole sky.
    Paste {
        /// The parameter's or section's key.
        key: Option<String>,
        /// The text.
        text: String,
    },
    /// Something about measuring.
    Lab(Lab),
    /// Full screen on or off.
    ToggleFullScreen,
    /// Close the window.
    Quit,
}

choices! {
    /// A part of a sky that can be taken over alone.
    pub enum Part {
        /// Layers and the space that they lie in.
        Clouds ("Clouds"),
        /// Where clouds are, and the wind.
        Weather ("Weather and wind"),
        /// Sun, moon, air and how clouds scatter.
        Light ("Light and air"),
        /// The ground.
        Ground ("Ground"),
        /// Where the eye is.
        Camera ("Camera"),
        /// How light becomes the picture.
        Display ("Display"),
    }
}

impl Part {
    /// Gives `scene` this part of `other`.
    pub fn take_over(self, scene: &mut Scene, other: &Scene) {
        let other = other.clone();
        match self {
            Self::Clouds => (scene.layers, scene.domain) = (other.layers, other.domain),
            Self::Weather => (scene.weather, scene.wind) = (other.weather, other.wind),
            Self::Light => {
                (scene.sun, scene.moon, scene.air) = (other.sun, other.moon, other.air);
                (scene.scattering, scene.plain_light) = (other.scattering, other.plain_light);
                scene.sunshafts = other.sunshafts;
            }
            Self::Ground => scene.ground = other.ground,
            Self::Camera => scene.camera = other.camera,
            Self::Display => scene.display = other.display,
        }
    }
}

/// A wish about measuring.
#[derive(Clone, Debug, PartialEq)]
pub enum Lab {
    /// Measure this; what was being measured is left.
    Start(Box<Order>),
    /// Wait, and keep what was measured.
    Pause,
    /// Go on.
    Resume,
    /// Leave it, and keep what was measured.
    Stop,
}

/// What is to be measured.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// Settings of quality, of the document's sky as it is.
    Sweep {
        /// The settings; the first is the one in use.
        settings: Vec<Setting>,
        /// Truths to measure against.
        goals: Vec<Goal>,
        /// Width and height in pixels.
        size: [u32; 2],
        /// Timed rounds.
        rounds: u32,
    },
    /// A fixed set.
    Suite(SuiteKind, Rounds, Box<Quality>),
}

/// What to do with unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Save them, then go on.
    Save,
    /// Lose them and go on.
    Discard,
    /// Stay.
    Cancel,
}

/// What a file dialog is for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Browse {
    /// A preset or an EXR to open.
    Open,
    /// Where to save the preset.
    SaveAs,
    /// Where to write a still.
    Export,
    /// The file of a parameter, by its key.
    Parameter(String),
}

choices! {
    /// What a still holds and how it is stored.
    pub enum Still {
        /// The whole picture as linear light.
        Exr ("EXR, linear light"),
        /// The same with layers of light beside it, which sum to the picture.
        LayersExr ("EXR, layers of light"),
        /// The clouds alone with their opacity.
        CloudsExr ("EXR, clouds alone"),
        /// Linear light with a common exponent for the three colours; holds no sky.
        Radiance ("Radiance HDR"),
        /// The picture as on the screen.
        Png ("PNG, as shown"),
        /// The same, finer: for grading.
        Png16 ("PNG, 16 bits"),
    }
}

choices! {
    /// What directions a still shows.
    pub enum Shape {
        /// What the preset's camera does.
        Camera ("As the camera"),
        /// All: longitude across, latitude down, the camera's heading in the middle.
        Panorama ("Panorama"),
        /// All, as six square files: px is east, py up, pz north.
        CubeFaces ("Cube, six files"),
        /// All, as one file: a lying cross with north in its middle.
        CubeCross ("Cube, cross"),
    }
}

/// The frames of a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sequence {
    /// The first frame; it shows this many frames after the beginning of time.
    pub first: u32,
    /// The last one.
    pub last: u32,
    /// From one to the next.
    pub step: u32,
    /// Frames per second of the clock.
    pub fps: f64,
    /// Whether files that exist are left as they are.
    pub keeps: bool,
}

/// A still to be rendered, or a sequence of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// What it holds.
    pub still: Still,
    /// Width and height in pixels; of a face, if it is a cube.
    pub size: [u32; 2],
    /// What it shows.
    pub shape: Shape,
    /// The quality; `None` for that of the viewport.
    pub level: Option<QualityLevel>,
    /// Its frames, if it is a sequence; then the path has a run of `#`.
    pub frames: Option<Sequence>,
    /// Where light is compressed to, in units of the file; `None` where it ends nowhere.
    pub brightest: Option<f32>,
    /// The part of it that is rendered: left, top, right and bottom, 0 to 1.
    pub region: Option<[f32; 4]>,
    /// Where it goes.
    pub path: PathBuf,
}

impl Export {
    /// Whether it is made of parts that are rendered one after the other: faces, or bands.
    pub fn is_in_parts(&self) -> bool {
        let [width, height] = self.size.map(u64::from);
        matches!(self.shape, Shape::CubeFaces | Shape::CubeCross) || width * height > LARGEST_WHOLE_PX
    }
}

impl Action {
    /// Whether it changes the scene as somebody would by hand, so that what has keys gets another one.
    pub(super) fn is_edit_of_scene(&self) -> bool {
        matches!(
            self,
            Self::EditScene { .. }
                | Self::MoveCamera(_)
                | Self::PlaceCamera(_)
                | Self::ResetCamera
                | Self::GoToCamera(_)
                | Self::ViewBack
                | Self::ViewForth
                | Self::TurnSun { .. }
                | Self::ChangeExposure(_)
        )
    }

    /// What the action is called in histories and messages.
    pub fn name(&self) -> String {
        match self {
            Self::EditScene { key, .. } if key == "vary" => "vary the sky".to_owned(),
            Self::EditScene { key, .. } if key.ends_with(".strokes") => "paint".to_owned(),
            Self::EditScene { key, .. } => format!("edit {key}"),
            Self::EditQuality { key, .. } => format!("edit quality.{key}"),
            Self::SetQualityLevel(_) => "set the quality level".to_owned(),
            Self::MoveCamera(_) | Self::PlaceCamera(_) => "move the camera".to_owned(),
            Self::ResetCamera => "reset the camera".to_owned(),
            Self::GoToCamera(_) => "go to a camera".to_owned(),
            Self::EditCameras { step, .. } => (*step).to_owned(),
            Self::TurnSun { .. } => "move the sun".to_owned(),
            Self::ChangeExposure(_) => "change the exposure".to_owned(),
            Self::MeterExposure(_) => "meter the light".to_owned(),
            Self::Rename(_) => "rename".to_owned(),
            Self::Play(true) => "play".to_owned(),
            Self::Play(false) => "pause".to_owned(),
            Self::ResetTime => "reset the time".to_owned(),
            Self::Seek(_) => "go to a time".to_owned(),
            Self::SetSpeed(_) => "set the speed of time".to_owned(),
            Self::SetKey(key) => format!("keyframe {key}"),
            Self::EditAnimation { step, .. } => step.clone(),
            Self::DayLapse { .. } => "time-lapse of a day".to_owned(),
            Self::Restore { name, .. } => name.clone(),
            Self::Undo => "undo".to_owned(),
            Self::Redo => "redo".to_owned(),
            Self::TravelHistory(_) => "go through the history".to_owned(),
            Self::ViewBack => "camera back".to_owned(),
            Self::ViewForth => "camera forth".to_owned(),
            Self::Ask(request) => request.name().to_owned(),
        }
    }
}

impl Request {
    /// What the request is called.
    pub fn name(&self) -> &'static str {
        match self {
            Self::New => "new",
            Self::Open(_) => "open",
            Self::Save => "save",
            Self::SaveAs(_) => "save as",
            Self::Answer(_) => "answer",
            Self::Browse(_) => "browse",
            Self::Screenshot => "screenshot",
            Self::CopyPicture => "copy the picture",
            Self::CopySystem => "copy what the machine is",
            Self::Snapshot => "snapshot",
            Self::Export(_) => "export",
            Self::Steer(_) => "steer a still",
            Self::Recover(_) => "recover",
            Self::TakeOver { .. } => "take over",
            Self::Morph(_) => "morph",
            Self::KeepPicture(_) => "keep a picture",
            Self::Paste { .. } => "paste",
            Self::Lab(_) => "measure",
            Self::ToggleFullScreen => "full screen",
            Self::Quit => "quit",
        }
    }
}
