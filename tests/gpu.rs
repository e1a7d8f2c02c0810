//! Tests that run shaders on the software driver (llvmpipe).

mod common;

mod gpu {
    mod automaton;
    mod clearance;
    mod density;
    mod display;
    mod effects;
    mod faults;
    mod flow;
    mod frames;
    mod grid;
    mod grown;
    mod lab;
    mod math;
    mod noise;
    mod painting;
    mod phase;
    mod phase_sample;
    mod physics;
    mod random;
    mod rows;
    mod shaders;
    mod shapes;
    mod shell;
    mod stills;
    mod sun_grid;
    mod temporal;
    mod textures;
    mod transitions;
    mod truth;
    mod verify;
}
