//! The closed lists behind every shader: flags, and structs shared with Rust.

use super::uniforms::air::AirUniforms;
use super::uniforms::other::{
    BlendUniforms, DisplayUniforms, GroundUniforms, MapUniforms, PlainUniforms, ReliefUniforms, ShaftUniforms,
    TruthUniforms,
};
use super::uniforms::scene::{BandUniforms, CameraUniforms, LayerUniforms, SceneUniforms, ViewUniforms};
use crate::gpu::ShaderTable;

/// All flags and structs.
pub const TABLE: ShaderTable = ShaderTable {
    flags: &[
        "AIR", "ALONE", "BAKED", "BELOW", "CLOUDS", "COUNT", "CURL", "DETAIL", "EARTH", "FLOAT", "FRONT", "GRID",
        "GROUND", "HISTORY", "MAPLESS", "OPEN", "PATHS", "PLAIN", "PROFILE", "SAMPLES", "SHADOW", "SHAFTS", "SINGLE",
        "SKIP", "STARS", "TERRAIN", "TEXTURE", "THESIS", "UNIFORM",
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
        PlainUniforms::GENERATED,
        TruthUniforms::GENERATED,
        ReliefUniforms::GENERATED,
        SceneUniforms::GENERATED,
        ShaftUniforms::GENERATED,
        ViewUniforms::GENERATED,
    ],
};
