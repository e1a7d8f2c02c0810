// Local majorants of the density field, from the greatest body of cells of the weather map and the heights within reach:
// what delta tracking steps by (Woodcock et al. 1965; Kutz et al., "Spectral and Decomposition Tracking for Rendering
// Heterogeneous Volumes", 2017).
#if AUTOMATON
#import "pass/automaton_greatest.wgsl"
#endif
#import "cloud/voxels.wgsl"
#import "pass/cloud_field.wgsl"

struct Majorant {
  // Never below the extinction of all layers anywhere within reach, in 1/m.
  extinction_per_m: f32,
  // How far from the place it holds: along the ray for voxels, in every direction for the rest.
  reach_m: f32,
}

#if GRID
// The greatest value of the voxels in cells of them, each with the voxels around it that the value in it depends on.
@group(1) @binding(19) var voxel_bound: texture_3d<f32>;
// A cell's value holds for half a voxel beyond it: what a ray goes past the wall into the next, in voxels.
const PAST_WALL: f32 = 0.1;

fn voxel_majorant(p: vec3f, altitude: f32, dir: vec3f) -> Majorant {
  var low = scene.box_min;
  var high = scene.box_max;
#if BAKED
#else
  // A file fills its own layer, which may be thinner than all layers together.
  var of_file = scene.layers[0];
  for (var i = 1u; i < LAYERS; i++) {
    if (of_file.model != MODEL_GRID) {
      of_file = scene.layers[i];
    }
  }
  low.y = of_file.base_m;
  high.y = of_file.base_m + 1.0 / of_file.per_thickness;
#endif
  let at = vec3f(p.x, altitude, p.z);
  let inside = box_segments(at, dir, low, high).first;
  let voxel = (high - low) / vec3f(textureDimensions(voxels));
  let past = PAST_WALL * min(voxel.x, min(voxel.y, voxel.z));
  // Outside there is nothing up to where the ray enters, if it ever does.
  if (inside.y <= inside.x) {
    return Majorant(0.0, FAR_M);
  }
  if (inside.x > past) {
    return Majorant(0.0, inside.x - 0.5 * past);
  }
  let cell = voxel * f32(VOXELS_PER_CELL);
  let index = clamp(floor((at - low) / cell), vec3f(0.0), vec3f(textureDimensions(voxel_bound)) - 1.0);
  // How far along the ray each wall is that it goes towards.
  let wall = select(index, index + 1.0, dir >= vec3f(0.0)) * cell;
  let ways = (wall - (at - low)) / without_zeros(dir);
  let greatest = textureLoad(voxel_bound, vec3i(index), 0);
#if BAKED
  var extinction = 0.0;
  for (var i = 0u; i < LAYERS; i++) {
    extinction += greatest[i] * scene.layers[i].extinction_per_m;
  }
#else
  let extinction = greatest.x * of_file.density_scale * of_file.extinction_per_m;
#endif
  return Majorant(extinction, max(min(ways.x, min(ways.y, ways.z)), 0.0) + past);
}
#endif

#if SHAPES
// Nearer than this to a shape, its inside is within reach.
const NEAREST_SHAPE_M: f32 = 20.0;

// The distance to shapes is a reach that they are out of, or else says how deep inside of them a place within reach can be.
fn shapes_majorant(p: vec3f, altitude: f32) -> Majorant {
  let distance = cloud_shapes_distance(vec3f(p.x, altitude, p.z));
  if (distance > NEAREST_SHAPE_M) {
    return Majorant(0.0, distance);
  }
  let reach = NEAREST_SHAPE_M + max(-0.5 * distance, 0.0);
  let profile = shapes_profile(distance - reach);
  var extinction = 0.0;
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    let low = (altitude - reach - layer.base_m) * layer.per_thickness;
    let high = (altitude + reach - layer.base_m) * layer.per_thickness;
    if (layer.model == MODEL_SHAPES && low < 1.0 && high > 0.0) {
      extinction += density_bound(layer, profile) * layer.extinction_per_m;
    }
  }
  return Majorant(extinction, reach);
}
#endif

// The majorants of what the map does not place, beside that of what it does.
fn with_the_unmapped(mapped: Majorant, p: vec3f, altitude: f32, dir: vec3f) -> Majorant {
  var all = mapped;
#if GRID
  let of_voxels = voxel_majorant(p, altitude, dir);
  all = Majorant(all.extinction_per_m + of_voxels.extinction_per_m, min(all.reach_m, of_voxels.reach_m));
#endif
#if SHAPES
  let of_shapes = shapes_majorant(p, altitude);
  all = Majorant(all.extinction_per_m + of_shapes.extinction_per_m, min(all.reach_m, of_shapes.reach_m));
#endif
  return all;
}

#if MAPLESS
fn majorant_at(p: vec3f, dir: vec3f) -> Majorant {
  return with_the_unmapped(Majorant(0.0, FAR_M), p, altitude_of(p), dir);
}
#else
// The greatest field of the map in cells of four sizes and the cells around them, each half as wide as the one before.
@group(1) @binding(15) var bound_of_32: texture_2d<f32>;
@group(1) @binding(16) var bound_of_64: texture_2d<f32>;
@group(1) @binding(17) var bound_of_128: texture_2d<f32>;
@group(1) @binding(18) var bound_of_256: texture_2d<f32>;
const FINEST: u32 = 3u;

// Tentative events that a reach may cost before smaller cells are asked.
const FEW_EVENTS: f32 = 0.7;

fn greatest_field(uv: vec2f, level: u32) -> f32 {
  let cells = f32(32u << level);
  let at = vec2u(min(uv * cells, vec2f(cells - 1.0)));
  switch (level) {
    case 0u: {
      return textureLoad(bound_of_32, at, 0).x;
    }
    case 1u: {
      return textureLoad(bound_of_64, at, 0).x;
    }
    case 2u: {
      return textureLoad(bound_of_128, at, 0).x;
    }
    default: {
      return textureLoad(bound_of_256, at, 0).x;
    }
  }
}

// The bound from cells of one size.
fn majorant_of(p: vec3f, altitude: f32, level: u32) -> Majorant {
  var reach = FAR_M;
  for (var i = 0u; i < LAYERS; i++) {
    // The layer's own reach is that of 64 cells, and no other is known of an automaton.
    let cells = select(level, max(level, 1u), scene.layers[i].model == MODEL_AUTOMATON);
    reach = min(reach, scene.layers[i].lean.z * 2.0 / f32(1u << cells));
  }
  var extinction = 0.0;
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    let low = (altitude - reach - layer.base_m) * layer.per_thickness;
    let high = (altitude + reach - layer.base_m) * layer.per_thickness;
    if (low < 1.0 && high > 0.0 && layer.model != MODEL_GRID && layer.model != MODEL_SHAPES) {
      let uv = map_uv(layer, p.xz, clamp((altitude - layer.base_m) * layer.per_thickness, 0.0, 1.0));
      let on_map = select(clamp(uv, vec2f(0.0), vec2f(1.0)), uv - floor(uv), scene.map_edge == EDGE_REPEAT);
      var body = greatest_body(layer, greatest_field(on_map, level));
#if AUTOMATON
      if (layer.model == MODEL_AUTOMATON) {
        body *= greatest_of_automaton(uv, low, high);
      }
#endif
      extinction += density_bound_between(layer, body, ANY_TYPES, low, high) * layer.extinction_per_m;
    }
  }
  return Majorant(extinction, reach);
}

// From large cells to small ones, until crossing the cell costs few tentative events.
fn majorant_at(p: vec3f, dir: vec3f) -> Majorant {
  let altitude = altitude_of(p);
  var gap = FAR_M;
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    gap = min(gap, max(layer.base_m - altitude, altitude - layer.base_m - 1.0 / layer.per_thickness));
  }
  var majorant = majorant_of(p, altitude, 0u);
  for (var level = 1u; level <= FINEST; level++) {
    if (majorant.extinction_per_m * majorant.reach_m > FEW_EVENTS) {
      majorant = majorant_of(p, altitude, level);
    }
  }
  // Above or below all layers nothing is nearer than the gap.
  majorant = Majorant(select(majorant.extinction_per_m, 0.0, gap > majorant.reach_m), max(majorant.reach_m, gap));
  return with_the_unmapped(majorant, p, altitude, dir);
}
#endif
