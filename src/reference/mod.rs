//! CPU twins of the WGSL functions, for tests: same names, same arguments.
//!
//! What is exact arithmetic on paper ([`math`], [`phase`], [`shell`]) is computed in `f64`, mostly in another form than
//! the shader's, so that the shader's rounding shows. Random numbers, noise and density ([`random`], [`noise`], [`density`]) mirror the
//! shader's `f32` and `u32` steps, so that lattice cells and hashes are the same bits; [`automaton`] is whole numbers in both.

pub mod air;
pub mod automaton;
pub mod density;
pub mod math;
pub mod noise;
pub mod phase;
pub mod random;
pub mod shell;
