//! Structs shared with the shaders.

pub mod air;
