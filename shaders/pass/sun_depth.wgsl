// How much cloud lies towards the key light.
#import "pass/cloud_field.wgsl"
#if SUN_GRID
#import "pass/sun_grid.wgsl"

@group(1) @binding(9) var sun_depths: texture_3d<f32>;
#endif

// Longest step at which noise is read at its finest level, in metres.
const FINEST_STEP_M: f32 = 250.0;

// Extinction of all layers at a place towards the key light, in 1/m.
fn shadow_extinction(p: vec3f, reading: Reading) -> f32 {
  let densities = densities_at(p, reading);
  var extinction = 0.0;
  for (var i = 0u; i < LAYERS; i++) {
    extinction += densities[i] * scene.layers[i].extinction_per_m * scene.layers[i].shadow_extinction_scale;
  }
  return extinction;
}

// Steps towards the light that grow geometrically and together cover a way: the first one, and the growth. From the
// first to beyond the last they grow by 1 + spread times the way: long ways need long steps far off, and short ones near.
fn light_steps_over(way: f32, count: u32, spread_per_m: f32) -> vec2f {
  let spread = way * spread_per_m;
  let growth = pow(1.0 + spread, 1.0 / f32(count));
  return vec2f(select(way * (growth - 1.0) / spread, way / f32(count), spread < 1e-2), select(growth, 1.0, spread < 1e-2));
}

// How much longer a step towards the light becomes for each unit of optical depth that the one before it found: behind
// much cloud a step matters less. Equal steps stay equal.
const LIGHT_GROWTH_BY_DEPTH: f32 = 0.1;
// Most of it that counts.
const LIGHT_DEPTH_THAT_COUNTS: f32 = 4.0;

#if SUN_GRID
// Steps are taken over so many cells before the grid is read: its cells are blurred into each other.
const NEAR_CELLS: f32 = 3.5;
const USUAL_WAY_M: f32 = 3000.0;

fn sun_depth_beyond(q: vec3f) -> f32 {
  count_read();
  let size = vec3f(textureDimensions(sun_depths));
  return sun_grid_depth(textureSampleLevel(sun_depths, linear_repeat, (sun_grid_node(q) + 0.5) / size, 0.0).x);
}
#endif

// Steps towards the light from a place: fewer tell as much where all layers are thin that it lies in or that are before it.
fn light_steps_of(altitude: f32, densities: vec4f) -> u32 {
  let rises = scene.towards_light.y > 0.0;
  var share = 0.0;
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    let is_ahead = select(altitude > layer.base_m, altitude < layer.base_m + 1.0 / layer.per_thickness, rises);
    share = max(share, select(0.0, layer.light_steps_share, densities[i] > 0.0 || is_ahead));
  }
  return max(u32(ceil(f32(scene.light_steps) * share)), 1u);
}

// Optical depth from a place towards the key light: the only way to ask for the sun's visibility through cloud.
// Steps have each its own length (errata 6) and are sampled in their middle; they cover the reach, or the way out of the
// domain where that is shorter.
fn sun_optical_depth(p: vec3f, level: f32, count: u32) -> f32 {
  let way = min(domain_exit(p, scene.towards_light), scene.light_reach_m);
#if SUN_GRID
  let near = select(FAR_M, NEAR_CELLS * sun_grid_cell(p), sun_grid_holds(p));
  // The steps before the grid is read are those of a usual way, however long it is.
  let steps = light_steps_over(min(way, max(near, USUAL_WAY_M)), count, scene.light_spread_per_m);
#else
  let steps = light_steps_over(way, count, scene.light_spread_per_m);
#endif
  let by_depth = select(0.0, LIGHT_GROWTH_BY_DEPTH, steps.y > 1.0);
  var step = steps.x;
  var t = 0.0;
  var depth = 0.0;
  for (var i = 0u; i < count; i++) {
    let q = p + scene.towards_light * (t + 0.5 * step);
    let own = shadow_extinction(q, Reading(level, i < scene.light_detail_steps, 0.0, vec3f(0.0))) * step;
#if COUNT
    counted_light_steps += 1u;
#endif
    depth += own;
    t += step;
    if (depth > scene.opaque_sun_depth || t >= way) {
      break;
    }
#if SUN_GRID
    if (t >= near) {
#if COUNT
      counted_light_steps += 1u;
#endif
      depth += sun_depth_beyond(p + scene.towards_light * t);
      break;
    }
#endif
    step = min(step * steps.y * (1.0 + by_depth * min(own, LIGHT_DEPTH_THAT_COUNTS)), way - t);
  }
  return depth;
}
