// The density field with its textures bound: the one place where clouds are read.
#import "cloud/bound.wgsl"
#import "cloud/costa.wgsl"
#import "cloud/product.wgsl"
#import "cloud/profile.wgsl"
#import "cloud/thesis.wgsl"
#import "cloud/weather.wgsl"
#if SHAPES
#import "pass/cloud_shapes.wgsl"
#endif
#import "pass/clear_air.wgsl"
#import "common/shell.wgsl"
#import "common/trilinear.wgsl"
#import "generated/LayerUniforms.wgsl"
#import "generated/SceneUniforms.wgsl"

const MODEL_PROFILE: u32 = 0u;
const MODEL_THESIS: u32 = 1u;
const MODEL_UNIFORM: u32 = 2u;
const MODEL_TEXTURE: u32 = 3u;
const MODEL_GRID: u32 = 4u;
const MODEL_PRODUCT: u32 = 5u;
const MODEL_AUTOMATON: u32 = 6u;
const MODEL_SHAPES: u32 = 7u;
const DOMAIN_SHELL: u32 = 0u;
const DOMAIN_FLAT: u32 = 1u;
const DOMAIN_BOX: u32 = 2u;
const EDGE_REPEAT: u32 = 0u;
const EDGE_CLAMP: u32 = 1u;

override DOMAIN: u32 = 0u;
override LAYERS: u32 = 1u;

@group(1) @binding(0) var<uniform> scene: SceneUniforms;
#if MAPLESS
#else
@group(1) @binding(1) var weather_map: texture_2d<f32>;
#endif
@group(1) @binding(2) var linear_repeat: sampler;
#if BILLOWS
@group(1) @binding(3) var shape_noise: texture_3d<f32>;
#else
#if TEXTURE
@group(1) @binding(3) var shape_noise: texture_3d<f32>;
#endif
#endif
#if THESIS
@group(1) @binding(4) var worley_noise: texture_3d<f32>;
#endif
#if DETAIL
@group(1) @binding(5) var detail_noise: texture_3d<f32>;
#endif
#if CURL
@group(1) @binding(6) var curl_noise: texture_2d<f32>;
#endif
// Voxels in the box: of the one layer that is a file; or, baked, of all layers, a channel each.
#if GRID
@group(1) @binding(8) var voxels: texture_3d<f32>;
#endif

#if PRODUCT
@group(1) @binding(20) var octave_noise: texture_3d<f32>;
#endif
// Density of the automaton's cells over the map: see pass/automaton_smooth.wgsl.
#if AUTOMATON
@group(1) @binding(21) var automaton_cells: texture_3d<f32>;
#endif

// How a place is read: what Quality leaves out for speed. Truths read everything at level 0.
struct Reading {
  // Mip level of the large noise; the small one follows.
  level: f32,
  // Whether the small noise is read; its mean stands in otherwise.
  detail: bool,
  // How far the small noise has faded to its mean, 0..1.
  fade: f32,
  // Along which direction clear_way is asked for; 0 if it is not.
  towards: vec3f,
}

#if COUNT
var<private> counted_reads: u32;
var<private> counted_light_steps: u32;
#endif

fn count_read() {
#if COUNT
  counted_reads += 1u;
#endif
}

fn altitude_of(p: vec3f) -> f32 {
  if (DOMAIN == DOMAIN_SHELL) {
    return altitude_at(p, scene.planet_radius_m);
  }
  return p.y;
}

// Where a ray can meet cloud at all.
fn domain_segments(p: vec3f, dir: vec3f) -> Segments {
  switch (DOMAIN) {
    case DOMAIN_FLAT: {
      return slab_segments(p, dir, scene.lowest_m, scene.highest_m);
    }
    case DOMAIN_BOX: {
      return box_segments(p, dir, scene.box_min, scene.box_max);
    }
    default: {
      return shell_segments(p, dir, scene.lowest_m, scene.highest_m, scene.planet_radius_m);
    }
  }
}

// Distance from a place inside the domain to where a ray leaves it for good.
fn domain_exit(p: vec3f, dir: vec3f) -> f32 {
  switch (DOMAIN) {
    case DOMAIN_FLAT: {
      return slab_segments(p, dir, scene.lowest_m, scene.highest_m).first.y;
    }
    case DOMAIN_BOX: {
      return box_segments(p, dir, scene.box_min, scene.box_max).first.y;
    }
    default: {
      return max(shell_roots(p, dir, scene.highest_m, scene.planet_radius_m).y, 0.0);
    }
  }
}

// What a layer draws out along the wind, pressed together again: never farther apart than the places themselves, so that
// bounds of the map hold.
fn combed(layer: LayerUniforms, p: vec2f) -> vec2f {
  return p - layer.combing.xy * (dot(p, layer.combing.xy) * layer.combing.z);
}

// Where noises are read for a place: fibres lean as the map does, and billows stand upright.
fn noise_place(layer: LayerUniforms, p: vec3f, h: f32) -> vec3f {
  let across = combed(layer, p.xz - layer.lean.xy * (h * h * layer.combing.z));
  return vec3f(across.x, p.y, across.y);
}

#if MAPLESS
#else
fn map_uv(layer: LayerUniforms, p: vec2f, h: f32) -> vec2f {
  return combed(layer, p - layer.lean.xy * h * h) * layer.map_from_world.z + layer.map_from_world.xy;
}


// The greatest body where the map's field is at most so much.
fn greatest_body(layer: LayerUniforms, field: f32) -> f32 {
  let body = body_of(field, vec2f(layer.body_scale, layer.body_bias));
#if FRONT
  return max(body, body_of(field, vec2f(layer.body_scale_beyond, layer.body_bias_beyond)));
#else
  return body;
#endif
}

fn map_texel(layer: LayerUniforms, p: vec2f, h: f32) -> vec4f {
  var uv = map_uv(layer, p, h);
  if (scene.map_edge == EDGE_CLAMP) {
    uv = clamp(uv, vec2f(0.001), vec2f(0.999));
  } else if (scene.map_edge != EDGE_REPEAT && any(abs(uv - 0.5) > vec2f(0.5))) {
    return vec4f(0.0);
  }
  count_read();
  return textureSampleLevel(weather_map, linear_repeat, uv, 0.0);
}

// What coverage makes of the map's field at a place; see body_of.
fn cover_at(layer: LayerUniforms, p: vec2f) -> vec2f {
  var cover = vec2f(layer.body_scale, layer.body_bias);
#if FRONT
  let ahead = (dot(p, scene.front.xy) - scene.front.w) * scene.front.z + 0.5;
  cover = mix(cover, vec2f(layer.body_scale_beyond, layer.body_bias_beyond), smoothstep(0.0, 1.0, ahead));
#endif
  return cover;
}

fn weather_at(layer: LayerUniforms, p: vec2f, h: f32) -> Weather {
  let weather = weather_from_texel(map_texel(layer, p, h), cover_at(layer, p));
  return Weather(weather.body, mix(weather.types, layer.form.xyz, layer.form.w), weather.variation);
}
#endif

// Where the small noise has faded by this much, nobody sees that it was dragged.
const CURL_FADE: f32 = 0.4;

#if DETAIL
fn detail_texel(layer: LayerUniforms, p: vec3f, h: f32, reading: Reading) -> vec4f {
  var q = noise_place(layer, p, h) * layer.detail_from_world.w + layer.detail_from_world.xyz;
#if CURL
  if (layer.curl_from_world.w > 0.0 && reading.fade < CURL_FADE) {
    count_read();
    let uv = (p.xz + p.y * vec2f(0.37, 0.19)) * layer.curl_from_world.z + layer.curl_from_world.xy;
    let flow = textureSampleLevel(curl_noise, linear_repeat, uv, 0.0).xyz;
    q += flow * layer.curl_from_world.w * (1.0 - 0.7 * h) * (1.0 - reading.fade / CURL_FADE);
  }
#endif
  count_read();
  return textureSampleLevel(detail_noise, linear_repeat, q, reading.level);
}
#endif

#if PROFILE
fn profile_at(index: u32, layer: LayerUniforms, p: vec3f, h: f32, reading: Reading) -> f32 {
  let weather = weather_at(layer, p.xz, h);
  if (weather.body <= 0.0) {
    note_clear(index, p, h, reading);
    return 0.0;
  }
  let profile = height_profile(weather, layer, h);
  if (profile_bound(profile, layer) <= 0.0) {
    note_clear(index, p, h, reading);
    return 0.0;
  }
  return formed_at(layer, p, h, profile, weather, reading);
}
#endif

#if BILLOWS
// What billows and erosion make of a profile.
fn formed_at(layer: LayerUniforms, p: vec3f, h: f32, profile: f32, weather: Weather, reading: Reading) -> f32 {
  clear_way = 0.0;
  count_read();
  let tile = noise_place(layer, p, h) * layer.shape_from_world.w + layer.shape_from_world.xyz;
  let noise = textureSampleLevel(shape_noise, linear_repeat, tile, reading.level);
  var field = billowed(profile, noise, weather, layer);
  if (field <= 0.0) {
    note_clearness(layer, -4.0 * field);
    return 0.0;
  }
  let firm = firmness(profile, noise, weather, layer);
  if (near_surface(field, firm, layer) && layer.detail_strength > 0.0) {
    var amount = MEAN_EROSION * layer.detail_strength;
#if DETAIL
    if (reading.detail) {
      amount = erosion(detail_texel(layer, p, h, reading), firm, layer, h, reading.fade);
    }
#endif
    field = eroded(field, amount, firm);
    // Air that erosion has cleared lies deep in the field: steps in it need not all be short.
    note_clearness(layer, max(-0.35 * field, 0.0));
  }
  return profile_density(field, firm, layer, h);
}
#endif

#if AUTOMATON
fn automaton_at(index: u32, layer: LayerUniforms, p: vec3f, h: f32, reading: Reading) -> f32 {
  let weather = weather_at(layer, p.xz, h);
  if (weather.body <= 0.0) {
    note_clear(index, p, h, reading);
    return 0.0;
  }
  count_read();
  // Neither end runs over into the other.
  let margin = 0.5 / f32(textureDimensions(automaton_cells).y);
  let place = vec3f(map_uv(layer, p.xz, h), clamp(h, margin, 1.0 - margin)).xzy;
  let cells = textureSampleLevel(automaton_cells, linear_repeat, place, 0.0);
  let profile = automaton_profile(dot(cells, scene.automaton_shares), weather, layer, h);
  if (profile_bound(profile, layer) <= 0.0) {
    note_clear(index, p, h, reading);
    return 0.0;
  }
  return formed_at(layer, p, h, profile, weather, reading);
}
#endif

#if SHAPES
fn shapes_at(layer: LayerUniforms, p: vec3f, altitude: f32, h: f32, reading: Reading) -> f32 {
  let distance = cloud_shapes_distance(vec3f(p.x, altitude, p.z));
  var way = max(distance, 0.0);
  if (DOMAIN == DOMAIN_SHELL) {
    way /= flattening(p, way, scene.planet_radius_m);
  }
  clear_way = min(clear_way, way);
  let profile = shapes_profile(distance);
  if (profile_bound(profile, layer) <= 0.0) {
    return 0.0;
  }
  let types = mix(vec3f(1.0, 0.0, 0.0), layer.form.xyz, layer.form.w);
  return formed_at(layer, p, h, profile, Weather(1.0, types, 0.5), reading);
}
#endif

#if THESIS
fn thesis_at(index: u32, layer: LayerUniforms, p: vec3f, h: f32, reading: Reading) -> f32 {
  let weather = weather_at(layer, p.xz, h);
  if (weather.body <= 0.0) {
    note_clear(index, p, h, reading);
    return 0.0;
  }
  let profile = thesis_profile(weather, h);
  if (max(profile.x, max(profile.y, profile.z)) < THESIS_THRESHOLD) {
    note_clear(index, p, h, reading);
    return 0.0;
  }
  clear_way = 0.0;
  count_read();
  let tile = noise_place(layer, p, h) * layer.shape_from_world.w + layer.shape_from_world.xyz;
  var field = thesis_field(profile, textureSampleLevel(worley_noise, linear_repeat, tile, reading.level), weather, layer);
#if DETAIL
  if (field > 0.0 && thesis_near_surface(field, layer) && layer.detail_strength > 0.0) {
    var noise = vec4f(MEAN_DETAIL);
    if (reading.detail) {
      noise = detail_texel(layer, p, h, reading);
    }
    field = thesis_eroded(field, noise, layer, reading.fade);
  }
#endif
  note_clearness(layer, select(1.0, -10.0 * field, field <= 0.0));
  return thesis_density(field, layer);
}
#endif

#if TEXTURE
fn texture_at(index: u32, layer: LayerUniforms, p: vec3f, h: f32, reading: Reading) -> f32 {
  let texel = map_texel(layer, p.xz, h);
  var density = body_of(texel.r, cover_at(layer, p.xz));
  if (density <= 0.0) {
    note_clear(index, p, h, reading);
    return 0.0;
  }
  clear_way = 0.0;
  density *= height_signal(texel, h);
  if (density <= 0.0) {
    return 0.0;
  }
  count_read();
  let tile = noise_place(layer, p, h) * layer.shape_from_world.w + layer.shape_from_world.xyz;
  density = costa_shaped(density, textureSampleLevel(shape_noise, linear_repeat, tile, reading.level), layer);
#if DETAIL
  if (density > 0.0 && layer.detail_strength > 0.0) {
    var noise = vec4f(COSTA_MEAN_DETAIL);
    if (reading.detail) {
      noise = detail_texel(layer, p, h, reading);
    }
    density = costa_eroded(density, noise, layer, reading.fade);
  }
#endif
  return costa_density(density, layer);
}
#endif

#if PRODUCT
// The large noise's texels are 150/8 m wide where layers are as they come, those of the octaves' noise an eighth of a cell. Where the
// march reads the former coarser, it reads octaves whose texels are smaller than those coarser by as much more: this over the
// size of a cell, in metres times the 8 cells of a tile.
const FINEST_OCTAVE: f32 = 1200.0;
// From the first of these levels to the second octaves go over to their mean: cells are smaller than what a step sees.
const COARSEST_OCTAVES: vec2f = vec2f(2.5, 3.5);
// Means of the noises in pass/bake_octave.wgsl.
const MEAN_OCTAVES: vec2f = vec2f(0.5, 0.45);

// A sum of octaves, 0..1: of Perlin noise in channels 0 and 2, of Voronoi noise in 1 and 3, which take turns.
fn octaves_at(q: vec3f, from_world: vec4f, octaves: vec4f, channel: u32, level: f32) -> f32 {
  var sum = 0.0;
  var weight = 0.0;
  var amplitude = 1.0;
  var frequency = 1.0;
  let place = q * from_world.w + from_world.xyz;
  for (var i = 0u; i < u32(octaves.x); i++) {
    // At level 0 everything is read as fine as it is.
    let own = max(level + min(level, 1.0) * log2(FINEST_OCTAVE * from_world.w * frequency), 0.0);
    let mean = smoothstep(COARSEST_OCTAVES.x, COARSEST_OCTAVES.y, own);
    if (mean < 1.0) {
      count_read();
      let noise = textureSampleLevel(octave_noise, linear_repeat, place * frequency, own);
      sum += amplitude * mix(noise[channel + 2u * (i % 2u)], MEAN_OCTAVES[channel], mean);
    } else {
      sum += amplitude * MEAN_OCTAVES[channel];
    }
    weight += amplitude;
    amplitude *= octaves.y;
    frequency *= octaves.z;
  }
  return sum / max(weight, 1e-6);
}

fn product_at(index: u32, layer: LayerUniforms, p: vec3f, h: f32, reading: Reading) -> f32 {
  let mask = weather_at(layer, p.xz, h).body;
  if (mask <= 0.0) {
    note_clear(index, p, h, reading);
    return 0.0;
  }
  clear_way = 0.0;
  let q = noise_place(layer, p, h);
  let voronoi = octaves_at(q, layer.voronoi_from_world, layer.voronoi_octaves, 1u, reading.level);
  if (voronoi <= layer.voronoi_octaves.w) {
    note_clearness(layer, 4.0 * (layer.voronoi_octaves.w - voronoi));
    return 0.0;
  }
  let perlin = octaves_at(q, layer.perlin_from_world, layer.perlin_octaves, 0u, reading.level);
  note_clearness(layer, max(4.0 * (layer.perlin_octaves.w - perlin), 0.0));
  return product_density(perlin, voronoi, mask, layer);
}
#endif

#if GRID
// The voxels' value at a place: a vertical coordinate 0..1 in their box, and zero outside of it.
fn voxels_at(p: vec2f, h: f32) -> vec4f {
  let uv = (p - scene.box_min.xz) / (scene.box_max.xz - scene.box_min.xz);
  if (any(abs(uv - 0.5) > vec2f(0.5)) || abs(h - 0.5) > 0.5) {
    return vec4f(0.0);
  }
#if COUNT
  counted_reads += 8u;
#endif
  return trilinear(voxels, vec3f(uv.x, h, uv.y));
}
#endif

// Density of one layer, 0..1 times the artist's multiplier.
fn layer_density(index: u32, p: vec3f, altitude: f32, reading: Reading) -> f32 {
  let layer = scene.layers[index];
  let h = (altitude - layer.base_m) * layer.per_thickness;
  if (h <= 0.0 || h >= 1.0) {
    if (any(reading.towards != vec3f(0.0))) {
      clear_way = min(clear_way, way_to(layer, p, reading.towards));
    }
    return 0.0;
  }
  var density = 0.0;
#if PROFILE
  if (layer.model == MODEL_PROFILE) {
    density = profile_at(index, layer, p, h, reading);
  }
#endif
#if THESIS
  if (layer.model == MODEL_THESIS) {
    density = thesis_at(index, layer, p, h, reading);
  }
#endif
#if TEXTURE
  if (layer.model == MODEL_TEXTURE) {
    density = texture_at(index, layer, p, h, reading);
  }
#endif
#if GRID
  if (layer.model == MODEL_GRID) {
    density = voxels_at(p.xz, h).x;
    clear_way = 0.0;
  }
#endif
#if PRODUCT
  if (layer.model == MODEL_PRODUCT) {
    density = product_at(index, layer, p, h, reading);
  }
#endif
#if AUTOMATON
  if (layer.model == MODEL_AUTOMATON) {
    density = automaton_at(index, layer, p, h, reading);
  }
#endif
#if SHAPES
  if (layer.model == MODEL_SHAPES) {
    density = shapes_at(layer, p, altitude, h, reading);
  }
#endif
#if UNIFORM
  if (layer.model == MODEL_UNIFORM) {
    density = weather_at(layer, p.xz, h).body;
    clear_way = 0.0;
  }
#endif
  return density * layer.density_scale;
}

// Densities of all layers at a place.
fn densities_at(p: vec3f, reading: Reading) -> vec4f {
  let altitude = altitude_of(p);
#if BAKED
  clear_way = 0.0;
  return voxels_at(p.xz, (altitude - scene.box_min.y) / (scene.box_max.y - scene.box_min.y));
#else
  var densities = vec4f(0.0);
  for (var i = 0u; i < LAYERS; i++) {
    densities[i] = layer_density(i, p, altitude, reading);
  }
  return densities;
#endif
}

// Extinction of all layers together, in 1/m.
fn extinction_of(densities: vec4f) -> f32 {
  var extinction = 0.0;
  for (var i = 0u; i < LAYERS; i++) {
    extinction += densities[i] * scene.layers[i].extinction_per_m;
  }
  return extinction;
}

// Never below the density of a layer anywhere in a cell of the map, whose greatest body is given: the only majorant.
fn density_bound(layer: LayerUniforms, greatest_body: f32) -> f32 {
  var bound = greatest_body;
  if (layer.model == MODEL_PROFILE || layer.model == MODEL_AUTOMATON || layer.model == MODEL_SHAPES) {
    bound = profile_bound(greatest_body, layer);
  }
  if (layer.model == MODEL_THESIS) {
    bound = thesis_bound(greatest_body, layer);
  }
  if (layer.model == MODEL_TEXTURE) {
    bound = costa_bound(greatest_body, layer);
  }
  if (layer.model == MODEL_PRODUCT) {
    bound = product_bound(greatest_body, layer);
  }
  return bound * layer.density_scale;
}

// The same between two heights of the layer, of what types there may be.
fn density_bound_between(
  layer: LayerUniforms,
  body: f32,
  possible: PossibleTypes,
  low: f32,
  high: f32,
) -> f32 {
  if (body <= 0.0 || low >= 1.0 || high <= 0.0) {
    return 0.0;
  }
  let lowest = clamp(low, 0.0, 1.0);
  let highest = clamp(high, 0.0, 1.0);
  let types = mix(possible.types, layer.form.xyz, layer.form.w);
  let formed = PossibleTypes(types, possible.variation);
  var bound = body;
  if (layer.model == MODEL_PROFILE) {
    bound = profile_bound_between(body, formed, layer, lowest, highest);
  }
  if (layer.model == MODEL_THESIS) {
    bound = thesis_bound_between(body, formed, layer, lowest, highest);
  }
  if (layer.model == MODEL_TEXTURE) {
    bound = costa_bound(body, layer);
  }
  if (layer.model == MODEL_PRODUCT) {
    bound = product_bound(body, layer);
  }
  if (layer.model == MODEL_AUTOMATON) {
    bound = profile_bound(body * smoothstep(0.0, layer.base_ramp, highest), layer);
  }
  return bound * layer.density_scale;
}
