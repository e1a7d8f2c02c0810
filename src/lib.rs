//! Nephoscope: a desktop studio for volumetric skies.

pub mod gpu;
pub mod reference;
pub mod render;
pub mod shader;
