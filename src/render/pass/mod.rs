//! The passes, one file each.

pub mod sky;
