//! The structs that describe clouds and camera to the shaders. Angles are radians, positions are metres from the
//! sea-level point under the *eye*, so that f32 keeps its precision anywhere in the world.

use glam::{UVec2, Vec2, Vec3, Vec4};

use crate::gpu_struct;

gpu_struct! {
    /// The eye and how directions map onto its picture.
    pub struct CameraUniforms {
        /// Position.
        pub eye: Vec3,
        /// Which of the projections.
        pub projection: u32,
        /// Unit vector into the picture's middle.
        pub forward: Vec3,
        /// Azimuth of the picture's middle.
        pub heading_rad: f32,
        /// Towards the picture's right edge.
        pub right: Vec3,
        /// Keeps the vectors apart.
        pub pad0: f32,
        /// Towards the picture's upper edge.
        pub up: Vec3,
        /// Keeps the vectors apart.
        pub pad1: f32,
        /// Where the picture begins in the whole that it may be a part of, 0 to 1.
        pub window_offset: Vec2,
        /// Its size in that whole.
        pub window_size: Vec2,
    }

    /// One picture: sizes, cameras, and which pixels are computed.
    pub struct ViewUniforms {
        /// The camera.
        pub camera: CameraUniforms,
        /// The camera of the picture before, relative to this one's origin.
        pub previous: CameraUniforms,
        /// How far the clouds have moved since the picture before.
        pub cloud_motion_m: Vec3,
        /// 1 when neither camera nor clouds have moved.
        pub is_still: u32,
        /// Size of the picture.
        pub size: UVec2,
        /// Rays of this frame, across and down.
        pub ray_count: UVec2,
        /// Pixels per ray, across and down.
        pub update_block: UVec2,
        /// The pixel of each block whose turn it is.
        pub update_offset: UVec2,
        /// Factor and offset of the march's jitter, which wraps at 1.
        pub jitter: Vec2,
        /// Where in a pixel its rays pass, 0 to 1.
        pub pixel_point: Vec2,
        /// 1 when every other row takes the other pixel.
        pub update_checkerboard: u32,
        /// Angle that one pixel spans.
        pub pixel_angle: f32,
        /// Radiance of the brightest stars.
        pub star_radiance: f32,
        /// What this sample counts in the mean of all samples so far.
        pub sample_share: f32,
        /// Angle that one sample spans: a pixel's over the root of their number.
        pub sample_angle: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad1: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad2: f32,
    }

    /// The rows that one job computes.
    pub struct BandUniforms {
        /// The first of them.
        pub first_row: u32,
        /// How many.
        pub rows: u32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: u32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad1: u32,
    }

    /// One cloud layer.
    pub struct LayerUniforms {
        /// Tile coordinates of the weather map: offset in xy, tiles per metre in z.
        pub map_from_world: Vec4,
        /// Tile coordinates of the large noise: offset in xyz, tiles per metre in w.
        pub shape_from_world: Vec4,
        /// The same of the small noise.
        pub detail_from_world: Vec4,
        /// Curl noise: offset in xy, tiles per metre in z, strength in tiles of the small noise in w.
        pub curl_from_world: Vec4,
        /// Displacement of the tops, downwind, in metres: east in x, south in y. In z how far from a place the bound of its
        /// cell of the map holds.
        pub lean: Vec4,
        /// Direction of the wind, east in x and south in y, and in z 1 - 1/stretch: what is taken from places along it.
        pub combing: Vec4,
        /// Shares of cumulus, stratus and stratocumulus, and 1 in w if they replace the map's.
        pub form: Vec4,
        /// Tile coordinates of the octaves of Perlin noise, as of the large noise.
        pub perlin_from_world: Vec4,
        /// Their number, persistence and lacunarity, and the threshold in w.
        pub perlin_octaves: Vec4,
        /// The same of Voronoi noise.
        pub voronoi_from_world: Vec4,
        /// The same of Voronoi noise.
        pub voronoi_octaves: Vec4,
        /// In x the factor of both noises' product.
        pub product_gain: Vec4,
        /// Height of the base.
        pub base_m: f32,
        /// 1 over the thickness.
        pub per_thickness: f32,
        /// Part of the thickness over which the base sets in.
        pub base_ramp: f32,
        /// Variation of the tops.
        pub top_variation: f32,
        /// Factor from map to body.
        pub body_scale: f32,
        /// Offset from map to body: minus the threshold that coverage sets.
        pub body_bias: f32,
        /// Offset beyond the front.
        pub body_bias_beyond: f32,
        /// Spread of the tops.
        pub anvil: f32,
        /// Strength of the large noise.
        pub shape_strength: f32,
        /// Strength of the small noise.
        pub detail_strength: f32,
        /// Wispiness of the erosion.
        pub wispiness: f32,
        /// Steepness of the surface.
        pub sharpness: f32,
        /// The artist's multiplier of density.
        pub density_scale: f32,
        /// Extinction at density 1, in 1/m.
        pub extinction_per_m: f32,
        /// Scattering over extinction.
        pub albedo: f32,
        /// Extinction towards the light relative to the true one.
        pub shadow_extinction_scale: f32,
        /// Gain of the scattered key light.
        pub sun_gain: f32,
        /// Gain of the ambient light.
        pub ambient_gain: f32,
        /// Which density model.
        pub model: u32,
        /// Which phase function.
        pub phase_kind: u32,
        /// Its asymmetry.
        pub g: f32,
        /// Asymmetry of its second lobe.
        pub back_g: f32,
        /// Share of its second lobe.
        pub back_mix: f32,
        /// Factor from map to body beyond the front.
        pub body_scale_beyond: f32,
        /// Length of the steps along a ray in this layer, relative to ordinary ones.
        pub step_scale: f32,
        /// How many steps towards the light its places take, relative to those of dense cloud.
        pub light_steps_share: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: f32,
        /// The same.
        pub pad1: f32,
    }

    /// All cloud layers, the light on them, and how they are marched.
    pub struct SceneUniforms {
        /// Unit vector towards the key light.
        pub towards_light: Vec3,
        /// Radius of the planet.
        pub planet_radius_m: f32,
        /// Irradiance of the key light above the air, in working units.
        pub light_illuminance: Vec3,
        /// Height of the lowest base.
        pub lowest_m: f32,
        /// Tint of the light from above, times its strength.
        pub ambient_top: Vec3,
        /// Height of the highest top.
        pub highest_m: f32,
        /// Tint of the light from below, times its strength.
        pub ambient_bottom: Vec3,
        /// Share of the light from above at the base.
        pub ambient_base_share: f32,
        /// Lower corner of the box.
        pub box_min: Vec3,
        /// How dense cloud keeps ambient light out.
        pub ambient_occlusion: f32,
        /// Upper corner of the box.
        pub box_max: Vec3,
        /// What lies beyond the edge of the map.
        pub map_edge: u32,
        /// Unit vector upwind in xy, 1 over the width in z, distance of the front in w.
        pub front: Vec4,
        /// Shares of the generations in the automaton's channels.
        pub automaton_shares: Vec4,
        /// Middle of the grid of sun depth in xy, unit vector along the light's azimuth in zw.
        pub sun_grid_place: Vec4,
        /// Its finest length, hyperbolic angle of its edge, nodes across and upwards.
        pub sun_grid_form: Vec4,
        /// Extinction of an octave relative to the one before.
        pub octave_extinction: f32,
        /// Energy of an octave relative to the one before.
        pub octave_energy: f32,
        /// Anisotropy of an octave relative to the one before.
        pub octave_anisotropy: f32,
        /// Transmittance at which a ray ends.
        pub early_exit: f32,
        /// Most steps along a ray.
        pub view_steps: u32,
        /// First step inside cloud.
        pub step_m: f32,
        /// Growth of the step per metre of distance.
        pub step_growth: f32,
        /// Length of a step in clear air relative to one in cloud.
        pub empty_stride: f32,
        /// Steps towards the light.
        pub light_steps: u32,
        /// How much they grow over their whole way: by 1 and this for each metre of it.
        pub light_spread_per_m: f32,
        /// Longest way they cover.
        pub light_reach_m: f32,
        /// Light steps that read the small noise.
        pub light_detail_steps: u32,
        /// Distance at which the small noise has faded.
        pub detail_distance_m: f32,
        /// Offset of the noises' mip level.
        pub noise_level_bias: f32,
        /// Distance at which clouds end.
        pub max_distance_m: f32,
        /// Optical depth of a step inside cloud.
        pub step_depth: f32,
        /// What samples that are lit together may send, relative to all light that reaches the eye.
        pub light_share: f32,
        /// Whether planes of the grid of sun depth follow each other sideways, as for low light.
        pub sun_grid_is_low: u32,
        /// Optical depth towards the light behind which nothing is seen of it.
        pub opaque_sun_depth: f32,
        /// Keeps the layers apart.
        pub pad2: f32,
        /// The layers; as many as the program was compiled for count.
        pub layers: [LayerUniforms; 4],
    }
}
