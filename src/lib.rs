//! An instrument for observing clouds.
pub mod export;
pub mod gpu;
pub mod plan;
pub mod render;
pub mod scene;
pub mod shader;
