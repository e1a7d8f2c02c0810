//! Tests that run shaders on the software driver (llvmpipe).

mod common;

mod gpu {
    mod density;
    mod math;
    mod noise;
    mod phase;
    mod physics;
    mod random;
    mod shaders;
    mod shell;
    mod textures;
}
