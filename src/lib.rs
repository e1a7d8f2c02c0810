//! An instrument for observing clouds.
pub mod gpu;
pub mod render;
pub mod shader;
pub mod plan;
pub mod scene;
