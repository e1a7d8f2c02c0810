//! The closed lists behind every shader: flags, and structs shared with Rust.

use super::uniforms::air::AirUniforms;
use super::uniforms::other::{
    BlendUniforms, DisplayUniforms, GroundUniforms, MapUniforms, ReliefUniforms, ShaftUniforms, TruthUniforms,
};
use super::uniforms::scene::{BandUniforms, CameraUniforms, LayerUniforms, SceneUniforms, ViewUniforms};
use crate::gpu::ShaderTable;

/// All flags and structs.
pub const TABLE: ShaderTable = ShaderTable {
    flags: &[
        "AIR", "ALONE", "BELOW", "CLOUDS", "COUNT", "CURL", "DETAIL", "EARTH", "FLOAT", "FRONT", "GROUND", "HISTORY",
        "OPEN", "PATHS", "PROFILE", "SAMPLES", "SHADOW", "SHAFTS", "SKIP", "STARS", "TERRAIN", "THESIS", "UNIFORM",
    ],
    structs: &[
        AirUniforms::GENERATED,
        BandUniforms::GENERATED,
        BlendUniforms::GENERATED,
        CameraUniforms::GENERATED,
        DisplayUniforms::GENERATED,
        GroundUniforms::GENERATED,
        LayerUniforms::GENERATED,
        MapUniforms::GENERATED,
        TruthUniforms::GENERATED,
        ReliefUniforms::GENERATED,
        SceneUniforms::GENERATED,
        ShaftUniforms::GENERATED,
        ViewUniforms::GENERATED,
    ],
};
