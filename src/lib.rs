//! An instrument for observing clouds.
pub mod app;
pub mod cli;
pub mod export;
pub mod files;
pub mod gpu;
pub mod images;
pub mod lab;
pub mod plan;
pub mod reference;
pub mod render;
pub mod scene;
pub mod shader;
pub mod ui;
