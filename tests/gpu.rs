//! Tests that run shaders on the software driver (llvmpipe).

mod common;

mod gpu {
    mod math;
    mod noise;
    mod phase;
    mod physics;
    mod random;
    mod shaders;
    mod shell;
}
