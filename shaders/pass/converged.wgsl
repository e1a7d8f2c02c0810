// The march's own model by brute force: plain midpoint steps without skipping, with all detail at the finest level, to where
// nothing passes any more; and a march towards the light to there or to the end of the domain. What is left of an error falls
// as the square of the steps.
//
// One dispatch takes a ray so many steps further and leaves it in a buffer: llvmpipe ends an invocation after 65,535
// loop iterations without a word. counters: rays under way, view steps, light steps, rays that lost iterations.
#import "common/camera.wgsl"
#import "generated/BandUniforms.wgsl"
#import "generated/CameraUniforms.wgsl"
#import "generated/TruthUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"
#import "pass/cloud_light.wgsl"
#import "pass/march_state.wgsl"

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var<uniform> band: BandUniforms;
#if GROUND
@group(0) @binding(3) var ground_distance: texture_2d<f32>;
#endif
// Behind the scene's, as air is.
@group(1) @binding(14) var<uniform> truth: TruthUniforms;

@group(2) @binding(0) var<storage, read_write> marched_rays: array<MarchedRay>;
@group(2) @binding(2) var<storage, read_write> counters: array<atomic<u32>>;

// A ray of which less is left ends, and nothing of it passes.
const OPAQUE: f32 = 0x1p-17;

// Light steps that were taken, and that were not although they should have been.
var<private> light_steps: u32;
var<private> lost: u32;

// How steps towards the light spread: by their way over this length.
const LIGHT_SPREAD_PER_M: f32 = 0.01;

// Behind which no light is.
const NO_LIGHT_DEPTH: f32 = 1e9;

// Optical depth towards the key light over the whole way out of the domain, or one that no light passes.
fn converged_sun_depth(p: vec3f) -> f32 {
  let steps = light_steps_over(domain_exit(p, scene.towards_light), truth.light_steps, LIGHT_SPREAD_PER_M);
  var step = steps.x;
  var t = 0.0;
  var depth = 0.0;
  var taken = 0u;
  for (var i = 0u; i < truth.light_steps; i++) {
    depth += shadow_extinction(p + scene.towards_light * (t + 0.5 * step), Reading(0.0, true, 0.0, vec3f(0.0))) * step;
    t += step;
    step *= steps.y;
    taken += 1u;
    if (depth > scene.opaque_sun_depth) {
      depth = NO_LIGHT_DEPTH;
      break;
    }
  }
  light_steps += taken;
  lost += select(truth.light_steps - taken, 0u, depth == NO_LIGHT_DEPTH);
  return depth;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let pixel = vec2u(id.x, id.y + band.first_row);
  if (any(pixel >= view.size) || id.y >= band.rows) {
    return;
  }
  let index = (pixel.y - truth.first_row) * view.size.x + pixel.x;
  var ray = marched_rays[index];
  if (ray.is_done == 1u) {
    return;
  }
  let dir = ray_through(view.camera, (vec2f(pixel) + view.pixel_point) / vec2f(view.size));
  let origin = view.camera.eye;
  let segments = domain_segments(origin, dir);
  var limit = truth.furthest_m;
#if GROUND
  let ground = textureLoad(ground_distance, pixel, 0).x;
  limit = select(limit, min(limit, ground), ground >= 0.0);
#endif
  let first_end = min(segments.first.y, limit);
  let second_end = min(segments.second.y, limit);
  prepare_light(dir);
  var transmittance = exp(-ray.depth);
  var t = max(ray.distance_m, segments.first.x);
  var steps = 0u;
  var is_paused = false;
  for (var i = 0u; i < truth.per_dispatch; i++) {
    if (steps + light_steps >= truth.work_per_dispatch) {
      is_paused = true;
      break;
    }
    if (t >= first_end) {
      t = max(t, segments.second.x);
    }
    let end = select(second_end, first_end, t < first_end);
    if (t >= end || transmittance < OPAQUE) {
      ray.is_done = 1u;
      break;
    }
    steps += 1u;
    let step = min(truth.view_step_m + truth.view_growth * t, end - t);
    let middle = t + 0.5 * step;
    let p = origin + dir * middle;
    let densities = densities_at(p, Reading(0.0, true, 0.0, vec3f(0.0)));
    let extinction = extinction_of(densities);
    if (extinction > 0.0) {
      let altitude = altitude_of(p);
#if LIT
      var source = source_of(key_light_at(p, altitude), converged_sun_depth(p), altitude, densities);
#else
      var source = source_of(vec3f(0.0), 0.0, altitude, densities);
#endif
#if AIR
      let ahead = aerial_at(sky_aerial_light, sky_aerial_transmittance, linear_repeat, air, dir, middle);
      source = ahead.transmittance * source + ahead.light;
#endif
      let alpha = absorbed(extinction * step);
      let share = transmittance * alpha;
      ray.light += share * source;
      ray.distance_sum += share * middle;
      ray.weight_sum += share;
      transmittance *= 1.0 - alpha;
      transmittance = select(0.0, transmittance, transmittance >= OPAQUE);
    }
    // A step that rounding loses would never end.
    t = max(t + step, t * (1.0 + 0x1p-23));
  }
  if (ray.is_done == 0u) {
    atomicAdd(&counters[0], 1u);
    lost += select(truth.per_dispatch - steps, 0u, is_paused);
  }
  ray.depth = -log(max(transmittance, 1e-30));
  ray.distance_m = t;
  marched_rays[index] = ray;
  atomicAdd(&counters[1], steps);
  atomicAdd(&counters[2], light_steps);
  if (lost > 0u) {
    atomicAdd(&counters[3], 1u);
  }
}
