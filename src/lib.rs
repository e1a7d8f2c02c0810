//! Nephoscope: a desktop studio for volumetric skies.

pub mod gpu;
pub mod reference;
pub mod shader;
