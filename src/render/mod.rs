//! From a frame to an image.

pub mod pass;
pub mod uniforms;
