//! The graphics device and the few tools every pass needs. Nothing in this module knows what a cloud is.
//!
//! A pass is *data* before it runs: [`Program`] is a compiled shader that knows its bindings by name, [`Job`] is one
//! dispatch with everything bound, and [`run`](job::run) executes a list of jobs and times each of them.

mod device;
pub mod errors;
pub mod gpu_struct;
pub mod job;
pub mod program;
pub mod readback;
pub mod texture;
mod unchecked;

pub use device::{AdapterChoice, Gpu};
pub use errors::GpuError;
pub use job::{Job, PassTime, TimingSource};
pub use program::{Program, ProgramCache, ProgramKey, ShaderTable};
pub use texture::Texture;
pub use unchecked::ShaderChecks;
