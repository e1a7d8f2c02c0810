//! An instrument for observing clouds.
pub mod gpu;
pub mod shader;
