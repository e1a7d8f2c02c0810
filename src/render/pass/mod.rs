//! Passes that own their textures.

pub mod sky;
