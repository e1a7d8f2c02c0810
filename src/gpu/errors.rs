//! What can go wrong between the program and the driver.

use crate::shader::ShaderError;

/// A failure of the device, of a shader, or of a request to either.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter on this machine fits.
    #[error(
        "no usable graphics adapter{wanted}; found: {found}. Install a Vulkan driver \
         (on Debian: `apt install mesa-vulkan-drivers`), or name another adapter with --adapter"
    )]
    NoAdapter {
        /// What was asked for, as a phrase, or nothing.
        wanted: String,
        /// The adapters that are there.
        found: String,
    },
    /// The adapter refused to open a device.
    #[error("the adapter {adapter} could not be opened: {message}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// The driver's words.
        message: String,
    },
    /// A shader does not compose or validate.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// The driver refused a pipeline.
    #[error("pipeline {program}: {message}")]
    Pipeline {
        /// The entry file and its flags.
        program: String,
        /// The driver's words.
        message: String,
    },
    /// A pass forgot to supply a resource that its shader names.
    #[error("pass {pass}: no resource named {name:?} was supplied")]
    MissingResource {
        /// The pass.
        pass: &'static str,
        /// The shader's name for it.
        name: String,
    },
    /// The size of an image is outside what the device can hold.
    #[error("{what} of {width}×{height} pixels does not fit this device (at most {limit} on a side)")]
    TooLarge {
        /// What was asked for.
        what: &'static str,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// The device's limit.
        limit: u32,
    },
    /// The device was lost or ran out of memory while working.
    #[error("the graphics device failed: {0}")]
    Device(String),
}
