//! An instrument for observing clouds: volumetric skies, from a preset to a window, a PNG or an OpenEXR frame.
//!
//! [`scene`] says what a sky is and how it is computed, [`plan`] what one frame of it needs, and [`render`] makes the
//! picture with the tools of [`gpu`] and [`shader`]. [`files`] and [`export`] put skies and pictures on the disk, [`lab`]
//! measures, [`reference`](mod@reference) holds twins of shader functions for tests. [`app`] is the editor, [`cli`] the
//! commands.
//!
//! ```
//! use nephoscope::plan::FramePlan;
//! use nephoscope::scene::{Frame, Output, Quality, Scene};
//!
//! let (scene, quality) = (Scene::default(), Quality::default());
//! let frame = Frame { scene: &scene, quality: &quality, size: [960, 540], time_secs: 0.0, output: Output::Display, window: None };
//! for verdict in FramePlan::new(&frame).verdicts {
//!     println!("{}: {} because {}", verdict.effect.info().name, if verdict.runs { "yes" } else { "no" }, verdict.because);
//! }
//! ```
//!
//! The map of the whole stands in `docs/architecture.md`.

pub mod app;
pub mod cli;
pub mod export;
pub mod files;
pub mod gpu;
pub mod images;
pub mod lab;
pub mod plan;
pub mod reference;
pub mod render;
pub mod scene;
pub mod shader;
pub mod ui;
