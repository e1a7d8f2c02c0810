//! Nephoscope: a desktop studio for volumetric skies.
pub mod export;
pub mod gpu;
pub mod plan;
pub mod reference;
pub mod render;
pub mod scene;
pub mod shader;
