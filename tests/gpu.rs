//! Tests that run shaders on the software driver (llvmpipe).

mod common;

mod gpu {
    mod math;
    mod noise;
    mod phase;
    mod random;
    mod shaders;
    mod shell;
}
