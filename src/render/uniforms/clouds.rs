//! Cloud layers, wind and weather as shaders take them.

use glam::{DVec2, DVec3, Vec3, Vec4};

use super::camera::Eye;
use super::scene::{LayerUniforms, SceneUniforms};
use crate::plan::{KeyLight, Lighting};
use crate::scene::{
    BodyForm, Camera, CloudLayer, DensityModel, DomainKind, Frame, MAX_LAYERS, MapEdge, PhaseKind, Quality, Scattering,
    Scene, ShapeRole, Wind,
};

/// Velocity of the wind: east in x, south in y.
pub(crate) fn wind_mps(wind: &Wind) -> DVec2 {
    let from = f64::from(wind.from_deg).to_radians();
    DVec2::new(-from.sin(), from.cos()) * f64::from(wind.speed_mps)
}

/// Offsets in tiles, wrapped in f64 so that days of wind cost no precision.
fn wrapped(tiles: f64) -> f32 {
    (tiles - tiles.floor()) as f32
}

fn map_from_world(scene: &Scene, layer: &CloudLayer, eye: &Eye, time_secs: f64) -> Vec4 {
    let weather = &scene.weather;
    let size_m = f64::from(weather.size_m) * f64::from(layer.map_scale);
    let tiles = map_tiles(scene, layer, DVec2::new(eye.position.x, eye.position.z), time_secs);
    let per_metre = (1.0 / size_m) as f32;
    match weather.edge {
        MapEdge::Repeat => Vec4::new(wrapped(tiles.x), wrapped(tiles.y), per_metre, 0.0),
        MapEdge::Clamp | MapEdge::Clear => Vec4::new(tiles.x as f32, tiles.y as f32, per_metre, 0.0),
    }
}

/// Where a place at the base of a layer lies on the weather map at a time, in edges of the map from its corner.
fn map_tiles(scene: &Scene, layer: &CloudLayer, place_m: DVec2, time_secs: f64) -> DVec2 {
    let weather = &scene.weather;
    let drift = if weather.moves && weather.layers.iter().all(|map| map.source.drifts()) {
        wind_mps(&scene.wind) * time_secs * f64::from(layer.wind_scale)
    } else {
        DVec2::ZERO
    };
    let shift = DVec2::new(layer.map_east_m.into(), layer.map_south_m.into());
    let tiles = combed(&scene.wind, layer, place_m - drift - shift) / f64::from(weather.size_m * layer.map_scale);
    match weather.edge {
        MapEdge::Repeat => tiles,
        // A map that ends lies with its middle on the world's origin.
        MapEdge::Clamp | MapEdge::Clear => tiles + 0.5,
    }
}

/// Where a place in a layer lies on the weather map at a time, in edges of the map from its corner: twin of `map_uv` in
/// `pass/cloud_field.wgsl`, from metres east and south of the world's origin and above sea level.
pub fn map_place(scene: &Scene, layer: &CloudLayer, [east, up, south]: [f64; 3], time_secs: f64) -> DVec2 {
    let thickness_m = f64::from((layer.top_m - layer.base_m).max(1.0));
    let h = ((up - f64::from(layer.base_m)) / thickness_m).clamp(0.0, 1.0);
    let downwind = wind_mps(&scene.wind).normalize_or_zero() * f64::from(layer.lean_m);
    map_tiles(scene, layer, DVec2::new(east, south) - downwind * h * h, time_secs)
}

/// What is drawn out along the wind, pressed together again: twin of `combed` in `pass/cloud_field.wgsl`.
fn combed(wind: &Wind, layer: &CloudLayer, place_m: DVec2) -> DVec2 {
    let along = wind_mps(&Wind { speed_mps: 1.0, ..wind.clone() });
    place_m - along * (place_m.dot(along) * (1.0 - 1.0 / f64::from(layer.stretch)))
}

/// `place_m` is that of the eye in the noise, with the wind and what it has drawn out taken away.
fn noise_from_world(size_m: f32, place_m: DVec3) -> Vec4 {
    let size_m = f64::from(size_m);
    let tiles = place_m / size_m;
    Vec4::new(wrapped(tiles.x), wrapped(tiles.y), wrapped(tiles.z), (1.0 / size_m) as f32)
}

/// Scale and offset that make a body of the map's field where clouds cover a share of the sky.
///
/// The thesis's coverage is the radius of the cells (Koblížek 2019, section 2.1.1): clouds grow round their middles, which
/// stay as deep as ever; and so is that of a weather texture, whose red is itself at coverage 1. The others lower a
/// threshold under the field, whose edge is as soft as the layer says.
fn body(layer: &CloudLayer, coverage: f32) -> (f32, f32) {
    let coverage = (coverage + layer.coverage_offset).clamp(0.0, 1.0);
    match layer.model {
        DensityModel::Thesis | DensityModel::Texture if coverage > 0.0 => (1.0 / coverage, 1.0 - 1.0 / coverage),
        DensityModel::Thesis | DensityModel::Texture | DensityModel::Grid | DensityModel::Shapes => (0.0, 0.0),
        DensityModel::Profile | DensityModel::Uniform | DensityModel::Product | DensityModel::Automaton => {
            let softness = layer.edge_softness;
            (1.0 / softness, -(1.0 - coverage * (1.0 + softness)) / softness)
        }
    }
}

/// Cells across a tile of the octaves' noise: `CELLS` in `pass/bake_octave.wgsl`.
const OCTAVE_CELLS: f32 = 8.0;
/// The fixed factor of Thomann's listing 15.
const PRODUCT_BOOST: f32 = 2.0;

/// As far as nothing lies.
const BEYOND_ALL_M: f32 = 1e7;

/// How far from a place the map's bound there holds in every direction.
///
/// The bound covers the place's cell and those around it, so a cell's width is safe on the map, less the texels that
/// linear filtering reaches beyond it. A layer that leans shifts its map by `lean · h²`, at most 2 `lean` over its
/// thickness for each metre of height.
fn bound_reach_m(scene: &Scene, layer: &CloudLayer, thickness_m: f32) -> f32 {
    if !layer.reads_map() {
        return BEYOND_ALL_M;
    }
    let cell_m = scene.weather.size_m * layer.map_scale / super::super::weather::CELLS as f32;
    0.9 * cell_m / (1.0 + 2.0 * layer.lean_m / thickness_m)
}

/// Number, persistence, lacunarity and threshold of the sums of Perlin and of Voronoi noise.
fn sums(layer: &CloudLayer) -> [Vec4; 2] {
    let (perlin, voronoi) = (&layer.perlin, &layer.voronoi);
    [
        Vec4::new(perlin.octaves as f32, perlin.persistence, perlin.lacunarity as f32, perlin.threshold),
        Vec4::new(voronoi.octaves as f32, voronoi.persistence, voronoi.lacunarity as f32, voronoi.threshold),
    ]
}

/// As `cloud_field.wgsl` numbers the models.
fn model_index(model: DensityModel) -> u32 {
    match model {
        DensityModel::Profile => 0,
        DensityModel::Thesis => 1,
        DensityModel::Uniform => 2,
        DensityModel::Texture => 3,
        DensityModel::Grid => 4,
        DensityModel::Product => 5,
        DensityModel::Automaton => 6,
        DensityModel::Shapes => 7,
    }
}

/// As `cloud/phase.wgsl` numbers the phase functions.
fn phase_index(kind: PhaseKind) -> u32 {
    match kind {
        PhaseKind::Isotropic => 0,
        PhaseKind::HenyeyGreenstein => 1,
        PhaseKind::TwoLobe => 2,
        PhaseKind::CornetteShanks => 3,
        PhaseKind::Schlick => 4,
        PhaseKind::Rayleigh => 5,
    }
}

/// See [`LayerUniforms::combing`].
fn combing(scene: &Scene, layer: &CloudLayer) -> Vec4 {
    if layer.stretch <= 1.0 {
        // The wind may turn without anything to be made anew.
        return Vec4::ZERO;
    }
    let along = wind_mps(&Wind { speed_mps: 1.0, ..scene.wind.clone() }).as_vec2();
    along.extend(1.0 - 1.0 / layer.stretch).extend(0.0)
}

fn layer_uniforms(
    (scene, quality): (&Scene, &Quality),
    layer: &CloudLayer,
    eye: &Eye,
    time_secs: f64,
) -> LayerUniforms {
    let wind = wind_mps(&scene.wind) * f64::from(layer.wind_scale);
    let place = |speed: f32, rise: f32, is_combed: bool| {
        let here = DVec2::new(eye.position.x, eye.position.z) - wind * f64::from(speed) * time_secs;
        let here = if is_combed { combed(&scene.wind, layer, here) } else { here };
        DVec3::new(here.x, -f64::from(rise) * time_secs, here.y)
    };
    let thickness_m = (layer.top_m - layer.base_m).max(1.0);
    let downwind = wind_mps(&scene.wind).normalize_or_zero() * f64::from(layer.lean_m);
    let (body_scale, body_bias) = body(layer, scene.weather.coverage);
    let (body_scale_beyond, body_bias_beyond) = body(layer, scene.weather.coverage_change_to);
    let octaves = sums(layer);
    let octave = |size_m: f32, shift_m: f32| {
        let shift = DVec3::new(0.61, 0.37, 0.70) * f64::from(shift_m);
        noise_from_world(OCTAVE_CELLS * size_m, place(scene.wind.shape_speed, scene.wind.rise_mps, true) - shift)
    };
    let curl = noise_from_world(layer.curl_size_m, place(scene.wind.detail_speed, 0.0, false));
    LayerUniforms {
        map_from_world: map_from_world(scene, layer, eye, time_secs),
        shape_from_world: noise_from_world(
            layer.shape_size_m,
            place(scene.wind.shape_speed, scene.wind.rise_mps, true),
        ),
        detail_from_world: noise_from_world(
            layer.detail_size_m,
            place(scene.wind.detail_speed, scene.wind.rise_mps, true),
        ),
        curl_from_world: Vec4::new(curl.x, curl.z, curl.w, layer.curl_m / layer.detail_size_m),
        lean: Vec4::new(downwind.x as f32, downwind.y as f32, bound_reach_m(scene, layer, thickness_m), 0.0),
        combing: combing(scene, layer),
        perlin_from_world: octave(layer.perlin.size_m, layer.perlin.shift_m),
        voronoi_from_world: octave(layer.voronoi.size_m, layer.voronoi.shift_m),
        perlin_octaves: octaves[0],
        voronoi_octaves: octaves[1],
        product_gain: Vec4::new(PRODUCT_BOOST * layer.perlin.multiplier * layer.voronoi.multiplier, 0.0, 0.0, 0.0),
        form: match layer.form {
            BodyForm::Map => Vec4::ZERO,
            BodyForm::Cumulus => Vec4::new(1.0, 0.0, 0.0, 1.0),
            BodyForm::Stratus => Vec4::new(0.0, 1.0, 0.0, 1.0),
            BodyForm::Stratocumulus => Vec4::new(0.0, 0.0, 1.0, 1.0),
        },
        base_m: layer.base_m,
        per_thickness: 1.0 / thickness_m,
        base_ramp: (200.0 / thickness_m).clamp(0.02, 0.3),
        top_variation: layer.top_variation,
        body_scale,
        body_bias,
        body_bias_beyond,
        anvil: layer.anvil,
        shape_strength: layer.shape_strength,
        detail_strength: layer.detail_strength,
        wispiness: layer.wispiness,
        sharpness: layer.sharpness,
        density_scale: layer.density,
        extinction_per_m: layer.extinction_per_m(),
        albedo: layer.scattering() / layer.extinction_per_m(),
        shadow_extinction_scale: layer.shadow_extinction_scale,
        sun_gain: layer.phase_gain * layer.brightness,
        ambient_gain: layer.brightness,
        model: model_index(layer.model),
        phase_kind: phase_index(layer.phase.effective_kind()),
        g: layer.phase.g,
        back_g: layer.phase.back_g,
        back_mix: layer.phase.back_mix,
        body_scale_beyond,
        step_scale: step_scale(layer, quality),
        light_steps_share: light_steps_share(layer),
        pad0: 0.0,
        pad1: 0.0,
    }
}

/// Where the front of another coverage lies: see [`SceneUniforms::front`].
fn front(scene: &Scene, eye: &Eye, time_secs: f64) -> Vec4 {
    let velocity = wind_mps(&scene.wind);
    let upwind = if velocity == DVec2::ZERO { DVec2::X } else { -velocity.normalize() };
    let travelled = velocity.length() * time_secs;
    let here = DVec2::new(eye.position.x, eye.position.z).dot(upwind);
    let distance = f64::from(scene.weather.front_distance_m) - travelled - here;
    Vec4::new(upwind.x as f32, upwind.y as f32, 1.0 / scene.weather.front_width_m, distance as f32)
}

/// Shares of the automaton's generations.
fn automaton_shares(layers: &[&CloudLayer], time_secs: f64) -> Vec4 {
    let living = layers.iter().find(|layer| layer.model == DensityModel::Automaton);
    living.map_or(Vec4::ZERO, |layer| Vec4::from_array(layer.automaton.at(time_secs).shares))
}

/// Way through the clouds, in metres, up to which the steps towards the light are as many as the quality says.
const USUAL_WAY_M: f32 = 3000.0;
/// How many times as many there are for the longest ways.
const MOST_LIGHT_STEPS: f32 = 5.0;
/// Sine of the light's elevation below which it is low: ways through broken cloud then alternate between cloud and clear air
/// far beyond the first cloud, where steps are long.
const LOW_LIGHT: f32 = 0.2;

/// Light steps that all view steps of a ray may take together. llvmpipe ends all loops of an invocation after 65,535 rounds,
/// and no card should be asked for more of one pixel in one dispatch. Hops over clear air have the rest (`hops_left` in
/// `pass/clear_air.wgsl`).
const MOST_ITERATIONS: u32 = 48_000;

/// Shapes that one round of a loop takes: `SHAPES_PER_ROUND` in `pass/shapes_distance.wgsl`.
const SHAPES_PER_ROUND: u32 = 4;

/// Rounds of loops whose number no compiler knows, in one density at a place, and one for the density itself.
#[allow(clippy::cast_possible_truncation, reason = "no more than there may be shapes")]
pub(crate) fn density_rounds(scene: &Scene) -> u32 {
    let clouds = scene.shapes.iter().filter(|shape| shape.role == ShapeRole::Cloud).count() as u32;
    let rounds = scene.visible_layers().map(|layer| match layer.model {
        DensityModel::Shapes => clouds.div_ceil(SHAPES_PER_ROUND),
        DensityModel::Product => layer.perlin.octaves + layer.voronoi.octaves,
        _ => 0,
    });
    1 + rounds.sum::<u32>()
}

/// View steps for densities of so many rounds: as many as may be with one light step for each.
fn view_rounds(rounds: u32, wanted: u32) -> u32 {
    wanted.clamp(1, (MOST_ITERATIONS / rounds / 2).max(1))
}

/// Light steps for each of these view steps, where all of them together with the view steps are as many as may be.
fn light_rounds(rounds: u32, view_steps: u32) -> u32 {
    (MOST_ITERATIONS / rounds / view_steps).saturating_sub(1).max(1)
}

/// Extinction below which clouds are thin: fewer steps towards the light tell as much, down to a third of them.
const THIN_PER_M: f32 = 0.015;

/// Extinction of a layer where it is densest, in 1/m.
fn greatest_extinction(layer: &CloudLayer) -> f32 {
    (layer.extinction_per_m() * layer.density).max(1e-12)
}

/// How many steps towards the light a layer takes, relative to a dense one.
fn light_steps_share(layer: &CloudLayer) -> f32 {
    (greatest_extinction(layer) / THIN_PER_M).sqrt().clamp(1.0 / 3.0, 1.0)
}

/// Steps towards the light: more where layers are thick or the light is low. A way six times as long has twice as many, and
/// up to twice as many again if that is because the light is low.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, and clamped")]
fn light_steps(usual: u32, thickness_m: f32, light_sine: f32) -> u32 {
    let sine = light_sine.abs().max(0.02);
    let long = (thickness_m / sine / USUAL_WAY_M).powf(0.4).max(1.0);
    let low = (LOW_LIGHT / sine).powf(0.3).max(1.0);
    let more = (long * low).min(MOST_LIGHT_STEPS);
    ((usual as f32 * more).round() as u32).clamp(1, 128)
}

/// Thickness of a layer up to which steps along the ray are as long as the quality says, and how many times as long they
/// are in the thickest.
const USUAL_THICKNESS_M: f32 = 1200.0;
const LONGEST_IN_THICK: f32 = 2.05;
/// And how many times as long in the thinnest layer: of bodies from the map, and of a product of noises, whose surface has
/// no erosion to be seen.
const SHORTEST_IN_THIN_LAYERS: f32 = 0.85;
const SHORTEST_IN_THIN_PRODUCTS: f32 = 0.92;
/// Way over which the density of a soft layer changes, from which on steps are longer, and at most by how much.
const USUAL_SLOPE_M: f32 = 3000.0;
const LONGEST_IN_SOFT: f32 = 1.6;
/// Optical depth of a layer about which that begins: of a thin one all is seen.
const THICK_DEPTH: f32 = 4.0;
/// Extinction down to which they are, and how many times as long they are in the thinnest cloud.
const USUAL_EXTINCTION_PER_M: f32 = 0.001;
const LONGEST_IN_THIN: f32 = 1.15;

/// Length of the steps along a ray in a layer relative to what the quality says: tall clouds are broad as well, and seen
/// from far away; soft sheets of large shapes change slowly; and a step through thin cloud sees little of it. Where all
/// steps are to be equal, they are as told.
fn step_scale(layer: &CloudLayer, quality: &Quality) -> f32 {
    // A layer is as thick as its shapes need room, however small they are.
    let is_of_shapes = layer.model == DensityModel::Shapes;
    let thickness_m = if is_of_shapes { USUAL_THICKNESS_M } else { layer.top_m - layer.base_m };
    let is_product = layer.model == DensityModel::Product;
    let shortest = if is_product { SHORTEST_IN_THIN_PRODUCTS } else { SHORTEST_IN_THIN_LAYERS };
    let by_thickness = (thickness_m / USUAL_THICKNESS_M).sqrt().clamp(shortest, LONGEST_IN_THICK);
    let by_extinction = (USUAL_EXTINCTION_PER_M / greatest_extinction(layer)).powf(0.25).clamp(1.0, LONGEST_IN_THIN);
    let slope_m = layer.edge_softness * layer.shape_size_m / layer.shape_strength.max(1e-3);
    let is_profile = layer.model == DensityModel::Profile;
    let depth = greatest_extinction(layer) * thickness_m;
    let by_slope = if is_profile { (slope_m / USUAL_SLOPE_M).clamp(1.0, LONGEST_IN_SOFT) } else { 1.0 };
    let by_slope = by_slope.powf(1.0 - (-depth / THICK_DEPTH).exp());
    if quality.empty_stride > 1.0 { by_thickness * by_slope * by_extinction } else { 1.0 }
}

/// Radiance of the sky where the light is plain.
pub(crate) fn plain_sky(scene: &Scene) -> Option<Vec3> {
    let light = &scene.plain_light;
    light.enabled.then(|| light.sky_colour.vec() * light.sky_radiance)
}

/// What voxels of the clouds depend on: everything the shaders are told but the eye, the light, and how they march.
pub(crate) fn field_uniforms(frame: &Frame<'_>) -> SceneUniforms {
    let origin = Camera { height_m: frame.scene.camera.height_m, ..Camera::default() };
    let quality = Quality::default();
    let field = Frame { quality: &quality, ..*frame };
    let dark = Lighting {
        key: KeyLight::None,
        towards_key: Vec3::Y,
        key_lux: Vec3::ZERO,
        towards_sun: Vec3::Y,
        towards_moon: Vec3::Y,
        sun_lux: Vec3::ZERO,
        moon_lux: Vec3::ZERO,
        daylight_lux: 0.0,
        candela_per_unit: 1.0,
    };
    scene_uniforms(&field, &dark, &Eye::new(&origin))
}

/// As shaders number what lies beyond the edge of the map.
pub(crate) fn edge_index(edge: MapEdge) -> u32 {
    match edge {
        MapEdge::Repeat => 0,
        MapEdge::Clamp => 1,
        MapEdge::Clear => 2,
    }
}

/// Everything the cloud shaders are told.
pub(crate) fn scene_uniforms(frame: &Frame<'_>, lighting: &Lighting, eye: &Eye) -> SceneUniforms {
    let (scene, quality) = (frame.scene, frame.quality);
    let visible: Vec<&CloudLayer> = scene.visible_layers().collect();
    let lowest_m = visible.iter().map(|layer| layer.base_m).fold(f32::INFINITY, f32::min);
    let highest_m = visible.iter().map(|layer| layer.top_m).fold(0.0, f32::max);
    let lowest_m = if lowest_m.is_finite() { lowest_m } else { 0.0 };
    let mut layers = [LayerUniforms::default_empty(); MAX_LAYERS];
    for (slot, layer) in layers.iter_mut().zip(&visible) {
        *slot = layer_uniforms((scene, quality), layer, eye, frame.time_secs);
    }
    let domain = &scene.domain;
    let centre = [f64::from(domain.box_east_m) - eye.position.x, f64::from(domain.box_south_m) - eye.position.z];
    let corner = |sign: f64, height: f32| {
        let x = centre[0] + sign * 0.5 * f64::from(domain.box_width_m);
        let z = centre[1] + sign * 0.5 * f64::from(domain.box_length_m);
        Vec3::new(x as f32, height, z as f32)
    };
    let light = &scene.scattering;
    let is_baked = quality.grid_voxels > 0 && domain.kind == DomainKind::Box;
    let rounds = if is_baked { 1 } else { density_rounds(scene) };
    let view_steps = view_rounds(rounds, quality.view_steps);
    let sky = plain_sky(scene).unwrap_or(Vec3::ONE);
    SceneUniforms {
        towards_light: lighting.towards_key,
        planet_radius_m: domain.planet_radius_m,
        light_illuminance: lighting.key_lux / lighting.candela_per_unit,
        lowest_m,
        ambient_top: light.ambient_top.vec() * light.ambient * sky,
        highest_m,
        ambient_bottom: light.ambient_bottom.vec() * light.ambient * sky,
        ambient_base_share: light.ambient_base_share,
        box_min: corner(-1.0, lowest_m),
        ambient_occlusion: light.ambient_occlusion,
        box_max: corner(1.0, highest_m),
        map_edge: edge_index(scene.weather.edge),
        front: front(scene, eye, frame.time_secs),
        automaton_shares: automaton_shares(&visible, frame.time_secs),
        sun_grid_place: Vec4::ZERO,
        sun_grid_form: Vec4::ZERO,
        octave_extinction: light.octave_extinction,
        octave_energy: light.octave_energy,
        octave_anisotropy: light.octave_anisotropy,
        early_exit: quality.early_exit,
        view_steps,
        step_m: quality.step_m,
        step_growth: quality.step_growth,
        empty_stride: quality.empty_stride,
        light_steps: light_steps(quality.light_steps, highest_m - lowest_m, lighting.towards_key.y)
            .min(light_rounds(rounds, view_steps)),
        light_spread_per_m: quality.light_spread_per_m(),
        light_reach_m: quality.light_reach_m,
        light_detail_steps: quality.light_detail_steps,
        detail_distance_m: quality.detail_distance_m,
        noise_level_bias: quality.noise_level_bias,
        max_distance_m: quality.max_distance_m,
        step_depth: quality.step_depth,
        light_share: quality.light_share,
        sun_grid_is_low: 0,
        opaque_sun_depth: opaque_sun_depth(light, quality.octaves),
        pad2: 0.0,
        layers,
    }
}

/// Optical depth towards the light behind which even the widest octave passes less than 2⁻¹⁷ of it.
fn opaque_sun_depth(light: &Scattering, octaves: u32) -> f32 {
    // Where it is 0 depth matters to the first alone.
    let is_wider = light.octave_extinction > 0.0;
    let widest = if is_wider { light.octave_extinction.powi(octaves.cast_signed()) } else { 1.0 };
    17.0 * std::f32::consts::LN_2 / widest.clamp(1e-6, 1.0)
}

impl LayerUniforms {
    /// A layer that holds nothing.
    fn default_empty() -> Self {
        bytemuck::Zeroable::zeroed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_octave_passes_what_is_opaque() {
        let at = |octave_extinction, octaves| {
            opaque_sun_depth(&Scattering { octave_extinction, ..Scattering::default() }, octaves)
        };
        assert!((at(0.35, 0) - 11.78).abs() < 0.01 && at(1.0, 5) == at(0.35, 0), "the first is the widest");
        assert!(((-at(0.35, 5) * 0.35_f32.powi(5)).exp() * 131_072.0 - 1.0).abs() < 1e-3, "of the fifth passes 2⁻¹⁷");
        assert!(at(0.0, 7) == at(0.35, 0), "wider ones do not see depth");
        assert!(at(1e-9, 7).is_finite(), "and none is infinitely wide");
    }

    #[test]
    fn a_west_wind_blows_to_the_east() {
        let velocity = wind_mps(&Wind { from_deg: 270.0, speed_mps: 10.0, ..Wind::default() });
        assert!((velocity - DVec2::new(10.0, 0.0)).length() < 1e-9, "{velocity}");
    }

    fn body_at(model: DensityModel, coverage: f32, field: f32) -> f32 {
        let (scale, bias) = body(&CloudLayer { model, edge_softness: 0.25, ..CloudLayer::default() }, coverage);
        (field * scale + bias).clamp(0.0, 1.0)
    }

    #[test]
    fn no_ray_has_more_rounds_than_a_driver_goes() {
        for rounds in 1..=80 {
            for wanted in [1, 4, 160, 1000, 1024] {
                let view = view_rounds(rounds, wanted);
                let all = rounds * view * (1 + light_rounds(rounds, view));
                assert!((1..=MOST_ITERATIONS).contains(&all), "{rounds} x {wanted}: {all}");
            }
        }
        assert_eq!((view_rounds(1, 1024), light_rounds(1, 160)), (1024, 299), "simple clouds are as they were told");
    }

    #[test]
    fn long_ways_towards_the_light_have_more_steps() {
        assert_eq!(light_steps(10, 1500.0, 0.7), 10, "a high sun over cumulus");
        assert_eq!(light_steps(10, 8500.0, 0.5), 20, "a little under six times the usual way");
        assert_eq!(light_steps(10, 900.0, 0.038), 38, "a deck at sunset");
        assert_eq!((light_steps(10, 3000.0, 0.0), light_steps(10, 3000.0, -0.02)), (50, 50), "the horizon");
        assert_eq!((light_steps(1, 0.0, 1.0), light_steps(128, 9000.0, 0.1)), (1, 128), "at the ends");
    }

    #[test]
    fn coverage_is_a_threshold() {
        let at = |coverage, field| body_at(DensityModel::Profile, coverage, field);
        assert_eq!(at(0.0, 1.0), 0.0, "coverage 0 is empty");
        assert_eq!(at(1.0, 0.0), 1.0, "coverage 1 is full");
        assert!(at(0.5, 0.6) > at(0.4, 0.6), "more coverage, more body");
    }

    #[test]
    fn coverage_of_the_thesis_is_a_radius() {
        let at = |coverage, field| body_at(DensityModel::Thesis, coverage, field);
        assert_eq!(at(0.0, 1.0), 0.0, "coverage 0 is empty");
        for coverage in [0.1, 0.5, 1.0] {
            assert_eq!(at(coverage, 1.0), 1.0, "a cloud's middle is as deep at any coverage");
            assert!(at(coverage, 1.0 - coverage).abs() < 1e-6, "its edge lies at the radius");
        }
        assert_eq!(at(1.0, 0.4), 0.4, "coverage 1 is the map itself, not a closed sheet");
    }

    #[test]
    fn a_month_of_wind_keeps_its_precision() {
        let scene = Scene::default();
        let eye = Eye::new(&scene.camera);
        let tile = |time: f64| map_from_world(&scene, &scene.layers[0], &eye, time).x;
        let month = 30.0 * 86_400.0;
        let period = f64::from(scene.weather.size_m) / f64::from(scene.wind.speed_mps);
        let whole = (month / period).round() * period;
        assert!((tile(whole) - tile(0.0)).abs() < 1e-5, "{} {}", tile(whole), tile(0.0));
    }
}
