//! The structs of the smaller passes.

use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};

use crate::gpu_struct;

gpu_struct! {
    /// The ground and the shadows on it.
    pub struct GroundUniforms {
        /// Colour of the plains.
        pub albedo: Vec3,
        /// Radius of the planet.
        pub planet_radius_m: f32,
        /// Colour of heights.
        pub rock: Vec3,
        /// Height of the mountains.
        pub mountains_m: f32,
        /// Unit vector towards the key light.
        pub towards_light: Vec3,
        /// Height of the hills.
        pub hills_m: f32,
        /// Irradiance of the key light above the air, in working units.
        pub light_illuminance: Vec3,
        /// No ground is higher than this.
        pub highest_m: f32,
        /// Tile coordinates of the relief: offset in xy, tiles per metre in z.
        pub tile_from_world: Vec4,
        /// Coordinates on the shadow map: offset in xy, maps per metre in z.
        pub shadow_from_world: Vec4,
        /// Where the plain at the world's origin lies.
        pub plain_at: Vec2,
        /// Light that passes the clouds on average, beyond the map.
        pub mean_shadow: f32,
        /// The artist's strength of cloud shadows.
        pub shadow_strength: f32,
        /// Distance beyond which the ground is smooth.
        pub reach_m: f32,
        /// Height of the highest solid thing, for which shadows of clouds are mapped as for the ground.
        pub receiver_m: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad1: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad2: f32,
    }

    /// The artists' glow of thin cloud about the light.
    pub struct GlowUniforms {
        /// Unit vector towards the light.
        pub towards_light: Vec3,
        /// Angle at which it ends, in radians.
        pub range: f32,
        /// Radiance at the light itself, in working units.
        pub radiance: Vec3,
        /// How it falls off.
        pub width: f32,
    }

    /// How a layer reads the weather map of which a picture is drawn.
    pub struct MapViewUniforms {
        /// Types that stand for the map's own in xyz, and how much they do in w.
        pub form: Vec4,
        /// What coverage makes of the map's field: see `body_of`.
        pub cover: Vec2,
        /// 1 if red alone says where cloud is.
        pub is_texture: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: f32,
    }

    /// What a generated weather map is made of.
    pub struct MapUniforms {
        /// Seed.
        pub seed: u32,
        /// Large cells across the map.
        pub large_cells: u32,
        /// Share of small puffs.
        pub small_share: f32,
        /// Strength of the fraying.
        pub fray: f32,
        /// Difference of regions.
        pub contrast: f32,
        /// Weight of cumulus.
        pub cumulus: f32,
        /// Weight of stratus.
        pub stratus: f32,
        /// Weight of stratocumulus.
        pub stratocumulus: f32,
        /// Place on the noises' third axis, in tiles.
        pub phase: f32,
        /// 1 for the channels of a weather texture: coverage, height, altitude.
        pub is_weather_texture: u32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad1: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad2: f32,
    }

    /// A generation of the cellular automaton. Chances are parts of 65536.
    pub struct AutomatonUniforms {
        /// How far the wind carries the tops on in a generation, in 65536ths of a cell: east and south.
        pub shear: IVec2,
        /// Cells across the map.
        pub cells: u32,
        /// Cells from base to top.
        pub levels: u32,
        /// Seed of the favourable air.
        pub seed: u32,
        /// Places across the map where air rises.
        pub patches: u32,
        /// Where on the noise's second axis, in 4096ths of a patch.
        pub phase: u32,
        /// Below this the noise has no favourable air at the base.
        pub threshold: i32,
        /// 256ths of reserve for what the noise has beyond it.
        pub gain: i32,
        /// 256ths of reserve that the whole height costs.
        pub slope: i32,
        /// Chance to become humid.
        pub vapour: u32,
        /// Chance to condense by itself.
        pub activation: u32,
        /// Chance to vanish in favourable air.
        pub extinction: u32,
        /// Chance to vanish elsewhere.
        pub dissolution: u32,
        /// Which generation of the run this becomes.
        pub index: u32,
        /// Random bits of the run.
        pub run: u32,
    }

    /// One shape.
    pub struct ShapeUniforms {
        /// Its middle: east and south of the eye, and above sea level.
        pub centre: Vec3,
        /// Which kind.
        pub kind: u32,
        /// Half its extent along its own axes.
        pub half_size: Vec3,
        /// Over what distance it melts into those before it.
        pub blend_m: f32,
        /// Quaternion that turns the world's axes to its own.
        pub local_from_world: Vec4,
        /// Colour of a solid thing.
        pub colour: Vec3,
        /// How it joins those before it.
        pub join: u32,
        /// Radius of its edges.
        pub rounding_m: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad1: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad2: f32,
    }

    /// All shapes: clouds, then solid things.
    pub struct ShapesUniforms {
        /// How many are clouds.
        pub clouds: u32,
        /// How many are solid.
        pub solids: u32,
        /// 1 over the depth inside of a cloud at which its profile is full.
        pub per_edge: f32,
        /// Apparent radius of the key light, in radians.
        pub light_radius: f32,
        /// 1 over the planet's radius; 0 where the world is flat.
        pub per_radius: f32,
        /// Keeps the shapes apart.
        pub pad0: f32,
        /// Keeps the shapes apart.
        pub pad1: f32,
        /// Keeps the shapes apart.
        pub pad2: f32,
        /// The shapes.
        pub list: [ShapeUniforms; 64],
    }

    /// Dabs of one stroke on the weather map.
    pub struct PaintUniforms {
        /// What a texel becomes.
        pub goal: Vec4,
        /// Whether clouds become it, and how they vary.
        pub reaches: Vec2,
        /// The first texel that they reach; it may lie beyond the map's edge.
        pub first: IVec2,
        /// How many texels they reach, across and down.
        pub extent: UVec2,
        /// Radius of a dab, in edges of the map.
        pub radius: f32,
        /// Share of the radius over which it fades.
        pub softness: f32,
        /// How far one dab goes.
        pub strength: f32,
        /// How many there are.
        pub count: u32,
        /// Texels along an edge of the map.
        pub side: u32,
        /// 1 if they take paint away.
        pub restores: u32,
        /// What lies beyond the map's edge, as `edge_index` numbers it.
        pub edge: u32,
        /// How much a dab draws its surroundings apart, or together where negative; 0 moves them along the stroke.
        pub grows: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad1: u32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad2: u32,
    }

    /// A flow that carries the map below.
    pub struct FlowUniforms {
        /// Its place on the map.
        pub centre: Vec2,
        /// Where it flows.
        pub along: Vec2,
        /// Across it; its lines come again after 1.
        pub across: Vec2,
        /// How far each of two has come: radians of a vortex, edges of the map of the others.
        pub amounts: Vec2,
        /// How much the first of them counts.
        pub share: f32,
        /// Its radius, in edges of the map.
        pub radius: f32,
        /// Which kind.
        pub kind: u32,
        /// What lies beyond the edge of the map.
        pub edge: u32,
    }

    /// A map that grows out of an image.
    pub struct GrowUniforms {
        /// Seed of the patches.
        pub seed: u32,
        /// Cells of the patches' lattice across the map.
        pub cells: u32,
        /// How often the map has become another.
        pub epoch: u32,
        /// And how far it is towards the next, 0..1.
        pub phase: f32,
        /// Width of the image relative to the map.
        pub image_share: f32,
        /// How much of the image itself is left, 0..1.
        pub image_weight: f32,
        /// Width of a patch relative to the image.
        pub patch_share: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: f32,
    }

    /// How two states of a map join.
    pub struct BlendUniforms {
        /// Share of the later one.
        pub share: f32,
        /// How the layer joins those below it.
        pub mode: u32,
        /// How much of it counts.
        pub opacity: f32,
        /// What lies beyond the map's edge, as `edge_index` numbers it.
        pub edge: u32,
    }

    /// What the relief is made of.
    pub struct ReliefUniforms {
        /// Seed.
        pub seed: u32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: u32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad1: u32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad2: u32,
    }

    /// What lies behind the clouds in plain light.
    pub struct PlainUniforms {
        /// The same from all directions.
        pub sky_radiance: Vec3,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: f32,
    }

    /// Streaks of light.
    pub struct ShaftUniforms {
        /// Unit vector towards the light.
        pub towards_light: Vec3,
        /// Length of the streaks.
        pub length_rad: f32,
        /// Radiance of a full streak, in working units.
        pub light: Vec3,
        /// Samples along a streak.
        pub samples: u32,
    }

    /// What a reference integrator is told beside the scene.
    pub struct TruthUniforms {
        /// First row of the part of the picture whose rays or paths the buffers hold.
        pub first_row: u32,
        /// Most steps of a ray, or tracking events of a path, in one dispatch.
        pub per_dispatch: u32,
        /// Paths that each pixel is to have in the end.
        pub samples: u32,
        /// Most scatterings of a path; 1 is single scattering.
        pub scattering_limit: u32,
        /// Seed of the paths.
        pub seed: u32,
        /// Steps towards the light.
        pub light_steps: u32,
        /// First step along a ray.
        pub view_step_m: f32,
        /// Growth of the step, in metres per metre.
        pub view_growth: f32,
        /// Where rays end that meet nothing.
        pub furthest_m: f32,
        /// Steps of a ray and towards the light together, after which a dispatch leaves it for the next.
        pub work_per_dispatch: u32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad1: f32,
    }

    /// From light to display.
    pub struct DisplayUniforms {
        /// Factor from working units to the curve's input, white balance included.
        pub exposure: Vec3,
        /// Contrast.
        pub contrast: f32,
        /// Saturation.
        pub saturation: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad0: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad1: f32,
        /// Keeps the size a multiple of 16 bytes.
        pub pad2: f32,
    }
}
