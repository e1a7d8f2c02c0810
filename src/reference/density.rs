//! Twins of `cloud/{weather,profile,thesis,map_field}.wgsl`: functions of values that were already read from textures.

use glam::{Vec2, Vec3, Vec4, Vec4Swizzles as _};

use super::noise::{perlin, perlin_fbm, worley, worley_cell};
use super::random::{pcg3d, unit_from_bits};
use crate::render::uniforms::other::MapUniforms;
use crate::render::uniforms::scene::LayerUniforms;

/// Mean of the erosion noise, to which it fades with distance.
const MEAN_EROSION: f32 = 0.5;
/// How far the erosion noise is spread about its mean.
const EROSION_CONTRAST: f32 = 2.2;
/// Mean of each of the large noise's sums of billows.
const MEAN_BILLOW: f32 = 0.48;
/// What the thesis's model subtracts from its shape (Koblížek 2019, equation 2.2).
const THESIS_THRESHOLD: f32 = 0.2;

fn mix(a: f32, b: f32, share: f32) -> f32 {
    a + (b - a) * share
}

fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// What a texel of the weather map means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weather {
    /// How far inside a cloud, 0 outside to 1 in the middle.
    pub body: f32,
    /// Shares of cumulus, stratus and stratocumulus.
    pub types: Vec3,
    /// Slow variation of the height of tops, 0 to 1.
    pub variation: f32,
}

impl Weather {
    /// Twin of `weather_from_texel`.
    #[must_use]
    pub fn from_texel(texel: Vec4, layer: &LayerUniforms, bias: f32) -> Self {
        let field = texel.x + texel.y + texel.z;
        let body = (field * layer.body_scale + bias).clamp(0.0, 1.0);
        Self { body, types: texel.xyz() / field.max(1e-4), variation: texel.w }
    }
}

/// Height of the tops over the layer, 0 to 1.
#[must_use]
pub fn top_height(weather: &Weather, layer: &LayerUniforms) -> f32 {
    let lift = 1.0 - layer.top_variation * (1.0 - weather.variation);
    let towering = mix(0.4, 1.0, weather.body.sqrt()) * lift;
    let flat = mix(0.75, 1.0, weather.body);
    weather.types.dot(Vec3::new(towering, 0.30 * flat, 0.55 * flat)).max(0.02)
}

/// How much cloud the map allows at a height `h`, 0 at the base to 1 at the top.
#[must_use]
pub fn height_profile(weather: &Weather, layer: &LayerUniforms, h: f32) -> f32 {
    let spread = layer.anvil * smoothstep(0.55, 0.85, h);
    let body = mix(weather.body, weather.body.sqrt(), spread);
    let base = smoothstep(0.0, layer.base_ramp, h);
    let shoulder = mix(0.62, 0.25, weather.types.x) + 0.3 * spread;
    let crown = 1.0 - smoothstep(shoulder.min(0.9), 1.0, h / top_height(weather, layer));
    body * base * crown.max(0.0).sqrt()
}

fn signed_field(profile: f32, lumps: f32, weather: &Weather, layer: &LayerUniforms) -> f32 {
    let strength = layer.shape_strength * weather.types.dot(Vec3::new(1.0, 0.7, 0.9));
    (1.2 * profile - 0.23 + strength * (lumps * smoothstep(0.04, 0.58, profile) - 0.65)) * 2.2
}

/// How firmly a place is held by the cloud it belongs to, 0 to 1.
#[must_use]
pub fn firmness(profile: f32, noise: Vec4, weather: &Weather, layer: &LayerUniforms) -> f32 {
    let lumps = 0.8 * mix(MEAN_BILLOW, noise.y, 0.9) + 0.15;
    smoothstep(-0.2, 1.2, signed_field(profile, lumps, weather, layer))
}

/// Signed field after the large noise, positive inside.
#[must_use]
pub fn billowed(profile: f32, noise: Vec4, weather: &Weather, layer: &LayerUniforms) -> f32 {
    let domes = noise.y - MEAN_BILLOW;
    let knobs = noise.zw().dot(Vec2::new(0.58, 0.42)) - MEAN_BILLOW;
    let connected = (noise.x - noise.y) / (1.0 - noise.y).max(0.1);
    let rough = smoothstep(-0.22, 0.12, domes) * mix(0.5, 1.2, smoothstep(0.38, 0.60, connected));
    let billows = (MEAN_BILLOW + 1.5 * domes + 2.2 * rough * knobs).clamp(0.0, 1.0);
    let lumps = billows * 0.8 + noise.x * 0.2;
    signed_field(profile, lumps, weather, layer)
}

/// What erosion takes from the surface; `fade` is how far the noise has faded to its mean.
#[must_use]
pub fn erosion(noise: Vec4, firm: f32, layer: &LayerUniforms, h: f32, fade: f32) -> f32 {
    let cells = noise.xyz().dot(Vec3::new(0.45, 0.33, 0.22));
    let wisps = noise.w * 0.6 + 0.4 * cells;
    let wispy = (1.0 - smoothstep(0.0, 0.22, h)).max(1.0 - firm).max(layer.wispiness);
    let carved = MEAN_EROSION + EROSION_CONTRAST * (mix(1.0 - cells, wisps, wispy) - 0.5);
    mix(carved.clamp(0.0, 1.0), MEAN_EROSION, fade) * layer.detail_strength
}

/// The signed field after erosion.
#[must_use]
pub fn eroded(field: f32, amount: f32, firm: f32) -> f32 {
    field - amount * mix(1.5, 1.0, firm) * 3.0 * (1.0 - (field / 3.0).clamp(0.0, 1.0))
}

/// Density of the profile model, 0 to 1.
#[must_use]
pub fn profile_density(field: f32, firm: f32, layer: &LayerUniforms, h: f32) -> f32 {
    let solid = smoothstep(0.0, 1.0, field * 1.7 * layer.sharpness) * mix(0.01, 1.0, firm * firm);
    solid * mix(0.45, 1.0, (h * 1.2).clamp(0.0, 1.0))
}

fn trapezoid(h: f32, [a, b, c, d]: [f32; 4]) -> f32 {
    smoothstep(a, b, h) * (1.0 - smoothstep(c, d, h))
}

/// Cloud map times height function of the thesis's three types (its figure 2.3).
#[must_use]
pub fn thesis_profile(weather: &Weather, h: f32) -> Vec3 {
    let heights = Vec3::new(
        trapezoid(h, [0.0, 0.12, 0.35, 1.0]),
        trapezoid(h, [0.0, 0.06, 0.14, 0.26]),
        trapezoid(h, [0.0, 0.12, 0.30, 0.58]),
    );
    weather.body * weather.types * heights
}

/// Equations 2.1 and 2.2 of the thesis.
#[must_use]
pub fn thesis_field(profile: Vec3, noise: Vec4, weather: &Weather, layer: &LayerUniforms) -> f32 {
    let shape = mix(1.0, noise.dot(Vec4::new(0.25, 0.25, 0.45, 0.05)), layer.shape_strength.min(1.0));
    ((shape * profile - THESIS_THRESHOLD) * Vec3::new(2.0, weather.body, 2.0)).max_element()
}

/// The thesis's detail, subtracted.
#[must_use]
pub fn thesis_eroded(field: f32, noise: Vec4, layer: &LayerUniforms, fade: f32) -> f32 {
    let detail = mix(noise.xyz().dot(Vec3::new(0.5, 0.3, 0.2)), 0.5, fade);
    field - (1.0 - detail) * 0.35 * layer.detail_strength
}

/// Density of the thesis's model, 0 to 1.
#[must_use]
pub fn thesis_density(field: f32, layer: &LayerUniforms) -> f32 {
    (field * layer.sharpness).clamp(0.0, 1.0)
}

/// Depth inside a cloud, cell and slow variation of a generated map.
fn map_field(p: Vec3, map: &MapUniforms) -> (f32, u32, f32) {
    let seed = |offset: u32| map.seed.wrapping_mul(16).wrapping_add(offset);
    let cells = map.large_cells.cast_signed();
    let region = (perlin_fbm(p, 3, 4, seed(0)) * 1.1 + 0.5).clamp(0.0, 1.0);
    let large = worley_cell(p, cells, seed(5));
    let w1 = (1.0 - large.f1).clamp(0.0, 1.0);
    let w2 = worley(p, cells * 7 / 3, seed(6));
    let w3 = worley(p, cells * 5, seed(7));
    let fray = (perlin_fbm(p, 12, 4, seed(8)) + 0.5).clamp(0.0, 1.0) - 0.5;
    let fields = w1 * 0.55 + w2 * 0.3 + w3 * 0.15;
    let puffs = w2 * 0.55 + w3 * 0.45;
    let middle = mix(-0.2, 1.2, map.small_share);
    let size = smoothstep(middle - 0.15, middle + 0.15, region);
    let cellular = mix(puffs * 0.92, fields * 1.06, size);
    let field = mix(cellular, region, 0.8 * map.contrast) + fray * 0.63 * map.fray;
    let spread = 1.0 / (1.0 + (-9.5 * (field - 0.455)).exp());
    (spread, large.id, region)
}

/// Twin of `map_texel_at`; `uv` in tiles.
#[must_use]
pub fn map_texel(uv: Vec2, map: &MapUniforms) -> Vec4 {
    let (depth, cell, region) = map_field(uv.extend(map.phase), map);
    (depth * type_of_cell(cell, map)).extend(smoothstep(0.3, 0.75, region))
}

/// Twin of `weather_texture_at`; `uv` in tiles.
#[must_use]
pub fn weather_texture(uv: Vec2, map: &MapUniforms) -> Vec4 {
    let p = uv.extend(map.phase);
    let (depth, _, region) = map_field(p, map);
    let rough = (perlin_fbm(p, 12, 3, map.seed.wrapping_mul(16).wrapping_add(12)) + 0.5).clamp(0.0, 1.0);
    let altitude = 0.3 * smoothstep(0.25, 0.8, rough);
    let height = (0.25 + 0.45 * smoothstep(0.3, 0.75, region) + 0.3 * rough) * depth.sqrt();
    Vec4::new(depth, height.min(1.0 - altitude), altitude, 0.0)
}

/// Twin of Costa's model (2023, equations 3.1 to 3.3) for a coverage: after the large noise, and the density.
#[must_use]
pub fn costa(coverage: f32, texel: Vec4, noises: [Vec4; 2], layer: &LayerUniforms, (h, fade): (f32, f32)) -> [f32; 2] {
    let a = (h - texel.z) / texel.y.max(1e-6);
    let signal = if texel.y > 0.0 { (4.0 * a * (1.0 - a)).max(0.0) } else { 0.0 };
    let octaves = |x: f32, y: f32, z: f32| (0.5 * x + 0.25 * y + 0.125 * z) / 0.875;
    let [large, small] = noises;
    let shape = octaves(large.y, large.z, large.w) * large.x;
    let shaped = coverage * signal * mix(1.0, shape, layer.shape_strength.min(1.0)) * layer.shape_strength.max(1.0);
    let eroded = shaped - mix(octaves(small.w, small.x, small.y), 0.5, fade) * layer.detail_strength;
    [shaped, (eroded * layer.sharpness).clamp(0.0, 1.0)]
}

/// Twin of `product_density`: both noises above their thresholds, multiplied (Thomann 2020, listing 15).
#[must_use]
pub fn product(perlin: f32, voronoi: f32, mask: f32, layer: &LayerUniforms) -> f32 {
    let hills = (perlin - layer.perlin_octaves.w).max(0.0);
    let heaps = (voronoi - layer.voronoi_octaves.w).max(0.0);
    (layer.product_gain.x * hills * heaps).clamp(0.0, 1.0) * mask
}

/// What `pass/bake_octave.wgsl` holds at a place in tiles: Perlin noise and Voronoi noise of even and of odd octaves.
#[must_use]
pub fn octave(p: Vec3) -> [[f32; 2]; 2] {
    let pair = |seed: u32| [(perlin(p, 8, seed) * 1.2 + 0.5).clamp(0.0, 1.0), worley(p, 8, seed + 2)];
    [pair(301), pair(302)]
}

fn type_of_cell(id: u32, map: &MapUniforms) -> Vec3 {
    let sum = (map.cumulus + map.stratus + map.stratocumulus).max(1e-6);
    let draw = unit_from_bits(pcg3d(glam::UVec3::new(id, map.seed, 5)).x) * sum;
    if draw < map.stratus {
        Vec3::Y
    } else if draw < map.stratus + map.stratocumulus {
        Vec3::Z
    } else {
        Vec3::X
    }
}
