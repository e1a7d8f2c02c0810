//! The GPU, without a word about clouds.

pub mod gpu_struct;
