// Paths of light through the clouds, unbiased: delta tracking along the path (Woodcock et al. 1965), ratio tracking
// towards the key light (Novák, Selle & Jarosz, "Residual Ratio Tracking", 2014), phase functions sampled exactly,
// Russian roulette. No order of scattering is left out.
//
// One loop takes one tracking event per turn, whatever a path is doing, so that paths side by side do not wait for each
// other; what is left of a path waits in a buffer for the next dispatch. counters: pixels short of samples, events,
// places where density exceeds its majorant, paths cut short.
//
// Light: the key light through the air by altitude; the sky as it is seen from the clouds; the ground as a Lambertian
// plain that is lit by both, through the clouds, and seen through the air. Plain light (PLAIN) has neither air nor ground,
// and its sky is the ambient light of the scene's uniform. Only between the eye and the first scattering
// does the air add light, as it does in the march. Artists' gains act once, at the first scattering.
#import "cloud/phase_sample.wgsl"
#import "common/camera.wgsl"
#import "generated/BandUniforms.wgsl"
#import "generated/CameraUniforms.wgsl"
#import "generated/TruthUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"
#import "light/sky.wgsl"
#import "pass/majorant.wgsl"
#import "pass/path_state.wgsl"

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var<uniform> band: BandUniforms;
#if GROUND
@group(0) @binding(3) var ground_distance: texture_2d<f32>;
#endif
// Behind the scene's uniform: llvmpipe (Mesa 22.3) crashes when a dynamically indexed block is its fourth.
@group(1) @binding(14) var<uniform> truth: TruthUniforms;
#if PLAIN
#else
@group(1) @binding(12) var<uniform> air: AirUniforms;
@group(1) @binding(13) var<uniform> cloud_air: AirUniforms;
@group(0) @binding(6) var sky_transmittance: texture_2d<f32>;
@group(0) @binding(7) var cloud_sky_view: texture_2d<f32>;
#endif
#if AIR
@group(0) @binding(8) var sky_aerial_light: texture_3d<f32>;
@group(0) @binding(9) var sky_aerial_transmittance: texture_3d<f32>;
#endif

// What a path is doing. An empty buffer is a path to begin.
const BEGIN: u32 = 0u;
const FROM_EYE: u32 = 1u;
const TO_SKY: u32 = 2u;
const TO_GROUND: u32 = 3u;
const TO_LIGHT: u32 = 4u;

@group(2) @binding(0) var<storage, read_write> paths: array<Path>;

@group(2) @binding(1) var<storage, read_write> path_sums: array<PathSums>;
@group(2) @binding(2) var<storage, read_write> counters: array<atomic<u32>>;

// Scatterings after which a path plays Russian roulette whatever it carries, and its chance to go on.
const ROULETTE_AFTER: u32 = 64u;
const ROULETTE: f32 = 0.9;
// A shadow ray that lets less through plays too.
const FAINT: f32 = 0.02;

var<private> path: Path;
var<private> sums: PathSums;
var<private> exceeded: u32;
var<private> cut: u32;

fn random_bits() -> vec3u {
  path.drawn += 1u;
  return pcg3d(vec3u(path.pixel, path.samples + truth.seed * 0x9e3779b9u, path.drawn));
}

fn random2() -> vec2f {
  let bits = random_bits();
  return vec2f(unit_from_bits(bits.x), unit_from_bits(bits.y));
}

fn end_sample() {
  path.mode = BEGIN;
  path.samples += 1u;
  path.drawn = 0u;
}

// The sample met cloud, and its path has come to an end.
fn finish() {
  var light = path.light;
#if AIR
  let ahead = aerial_at(sky_aerial_light, sky_aerial_transmittance, linear_repeat, air,
    normalize(ray_through(view.camera, pixel_uv())), path.first_m);
  light = ahead.transmittance * light + ahead.light;
#endif
  if (all(vec3(is_finite_bits(light.x), is_finite_bits(light.y), is_finite_bits(light.z)))) {
    sums.light += light;
    sums.light_squared += light * light;
    sums.hits += 1.0;
    sums.distance_m += path.first_m;
  } else {
    cut += 1u;
  }
  end_sample();
}

fn pixel_uv() -> vec2f {
  let pixel = vec2u(path.pixel % view.size.x, path.pixel / view.size.x);
  return (vec2f(pixel) + view.pixel_point) / vec2f(view.size);
}

// Distance from a place above to the plain at sea level, or -1.
fn plain_distance(p: vec3f, dir: vec3f) -> f32 {
  if (DOMAIN == DOMAIN_SHELL) {
    let roots = shell_roots(p, dir, 0.0, scene.planet_radius_m);
    let descends = dot(p, dir) + scene.planet_radius_m * dir.y < 0.0;
    return select(-1.0, max(roots.x, 0.0), descends && roots.y > 0.0);
  }
  return select(-1.0, max(p.y, 0.0) / max(-dir.y, 1e-12), dir.y < 0.0);
}

// How far a ray from anywhere may go before it has left the layers for good: to the plain, or out at the top.
fn way_out(p: vec3f, dir: vec3f, plain_m: f32) -> f32 {
  var way = 0.0;
  switch (DOMAIN) {
    case DOMAIN_FLAT: {
      let segment = slab_segments(p, dir, scene.lowest_m, scene.highest_m).first;
      way = segment.y;
    }
    case DOMAIN_BOX: {
      way = box_segments(p, dir, scene.box_min, scene.box_max).first.y;
    }
    default: {
      way = max(shell_roots(p, dir, scene.highest_m, scene.planet_radius_m).y, 0.0);
      way = select(way, min(way, plain_m), plain_m >= 0.0);
    }
  }
  return way;
}

fn fly(start: vec3f, dir: vec3f) {
  path.position = start;
  path.dir = dir;
  var plain = -1.0;
#if EARTH
  plain = plain_distance(start, dir);
#endif
  path.mode = select(TO_SKY, TO_GROUND, plain >= 0.0);
  path.left_m = way_out(start, dir, plain);
  // Level flight in an endless slab.
  if (path.left_m > truth.furthest_m) {
    path.left_m = truth.furthest_m;
  }
}

// Asks for the light at the path's place before it goes on.
fn ask_for_light(pending: vec3f, next_dir: vec3f) {
  path.anchor = path.position;
  path.next_dir = next_dir;
  path.pending = pending;
  path.through = 1.0;
  if (all(pending <= vec3f(0.0))) {
    fly(path.position, next_dir);
    return;
  }
  path.dir = scene.towards_light;
  path.left_m = min(way_out(path.position, scene.towards_light, -1.0), truth.furthest_m);
  path.mode = TO_LIGHT;
}

fn key_light_here(altitude: f32) -> vec3f {
#if PLAIN
  return scene.light_illuminance;
#else
  let cosine = light_cos_zenith(path.position, scene.towards_light, scene.planet_radius_m);
  return scene.light_illuminance * light_transmittance(sky_transmittance, linear_repeat, air, altitude, cosine);
#endif
}

// Radiance of the sky in a direction, as seen from the clouds.
fn sky_here(dir: vec3f) -> vec3f {
#if PLAIN
  return vec3f(1.0);
#else
  return sky_radiance(cloud_sky_view, linear_repeat, cloud_air, dir);
#endif
}

fn scatter(densities: vec4f, extinction: f32, draw: f32) {
  if (path.mode == FROM_EYE) {
    path.first_m = length(path.position - view.camera.eye);
  }
  if (path.scatterings >= truth.scattering_limit) {
    finish();
    return;
  }
  path.scatterings += 1u;
  // Which layer it met.
  var left = draw * extinction;
  var which = 0u;
  for (var i = 0u; i + 1u < LAYERS; i++) {
    left -= densities[i] * scene.layers[i].extinction_per_m;
    if (left >= 0.0 && which == i) {
      which = i + 1u;
    }
  }
  let layer = scene.layers[which];
  if (path.mode == FROM_EYE) {
    path.gains = vec2f(layer.sun_gain, layer.ambient_gain);
  }
  path.throughput *= layer.albedo;
  let chance = max(path.throughput.x, max(path.throughput.y, path.throughput.z))
    * select(1.0, ROULETTE, path.scatterings > ROULETTE_AFTER);
  if (chance < 1.0) {
    if (random2().x >= chance) {
      finish();
      return;
    }
    path.throughput /= chance;
  }
  let shape = PhaseShape(layer.phase_kind, layer.g, layer.back_g, layer.back_mix);
  let key = key_light_here(altitude_of(path.position)) * phase(shape, path.dir, scene.towards_light);
  ask_for_light(path.throughput * key * path.gains.x, sample_phase(shape, path.dir, random_bits()));
}

#if EARTH
// Transmittance of the air between an altitude and the plain, along a ray that meets it at a cosine.
fn air_below(altitude: f32, cosine_above: f32, cosine_ground: f32) -> vec3f {
  let whole = textureSampleLevel(sky_transmittance, linear_repeat, transmittance_uv(air, 0.0, cosine_ground), 0.0).rgb;
  let above = textureSampleLevel(sky_transmittance, linear_repeat, transmittance_uv(air, altitude, cosine_above), 0.0).rgb;
  return exp(-max(whole - above, vec3f(0.0)));
}

// The path meets the plain, and goes on from there.
fn meet_ground() {
  let altitude = altitude_of(path.position);
  let up_above = up_at(path.position, scene.planet_radius_m);
  path.light += path.throughput * path.gains.y * scene.ambient_bottom * sky_here(path.dir);
  path.position += path.dir * max(plain_distance(path.position, path.dir), 0.0);
  let up = select(vec3f(0.0, 1.0, 0.0), up_at(path.position, scene.planet_radius_m), DOMAIN == DOMAIN_SHELL);
  path.position += up;
  path.throughput *= air.ground_albedo * scene.ambient_bottom
    * air_below(max(altitude, 0.0), -dot(path.dir, up_above), -dot(path.dir, up));
  let key = key_light_here(0.0) * max(dot(up, scene.towards_light), 0.0) / PI;
  let u = random2();
  ask_for_light(path.throughput * key * path.gains.y, direction_about(up, sqrt(u.x), u.y));
}
#endif

// The ray has left the domain for good.
fn leave() {
  switch (path.mode) {
    case TO_LIGHT: {
      path.light += path.pending * path.through;
      fly(path.anchor, path.next_dir);
    }
    case TO_SKY: {
      path.light += path.throughput * path.gains.y * scene.ambient_top * sky_here(path.dir);
      finish();
    }
#if EARTH
    case TO_GROUND: {
      meet_ground();
    }
#endif
    default: {
      // From the eye to the background: no cloud is met.
      end_sample();
    }
  }
}

fn begin(dir: vec3f, start_m: f32, end_m: f32) {
  path.light = vec3f(0.0);
  path.throughput = vec3f(1.0);
  path.scatterings = 0u;
  path.gains = vec2f(1.0);
  path.dir = dir;
  path.position = view.camera.eye + dir * start_m;
  path.left_m = end_m - start_m;
  path.mode = FROM_EYE;
}

// One event of the ratio or the delta tracking at the path's new place, where the majorant is known.
fn meet(majorant: Majorant, draw: f32) {
  let densities = densities_at(path.position, Reading(0.0, true, 0.0, vec3f(0.0)));
  let extinction = extinction_of(densities);
  if (extinction > majorant.extinction_per_m * 1.0001) {
    exceeded += 1u;
  }
  let share = min(extinction / majorant.extinction_per_m, 1.0);
  if (path.mode == TO_LIGHT) {
    path.through *= 1.0 - share;
    if (path.through < FAINT) {
      let goes_on = draw * FAINT < path.through;
      path.through = select(0.0, FAINT, goes_on);
      path.left_m = select(0.0, path.left_m, goes_on);
    }
  } else if (draw < share) {
    scatter(densities, extinction, draw / share);
  }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let pixel = vec2u(id.x, id.y + band.first_row);
  if (any(pixel >= view.size) || id.y >= band.rows) {
    return;
  }
  let index = (pixel.y - truth.first_row) * view.size.x + pixel.x;
  path = paths[index];
  if (path.samples >= truth.samples) {
    return;
  }
  sums = path_sums[index];
  path.pixel = pixel.y * view.size.x + pixel.x;
  let dir = ray_through(view.camera, (vec2f(pixel) + view.pixel_point) / vec2f(view.size));
  let segments = domain_segments(view.camera.eye, dir);
  var limit = truth.furthest_m;
#if GROUND
  let ground = textureLoad(ground_distance, pixel, 0).x;
  limit = select(limit, min(limit, ground), ground >= 0.0);
#endif
  let start = segments.first.x;
  let end = min(max(segments.first.y, segments.second.y), limit);
  var events = 0u;
  for (var i = 0u; i < truth.per_dispatch; i++) {
    if (path.samples >= truth.samples) {
      break;
    }
    events += 1u;
    if (path.mode == BEGIN) {
      begin(dir, start, end);
    }
    let majorant = majorant_at(path.position, path.dir);
    let draws = random2();
    let free_m = select(FAR_M, -log(1.0 - draws.x) / majorant.extinction_per_m, majorant.extinction_per_m > 0.0);
    let reach_m = min(majorant.reach_m, path.left_m);
    let advanced = max(min(free_m, reach_m), 0.0);
    path.position += path.dir * advanced;
    path.left_m -= advanced;
    if (free_m < reach_m) {
      meet(majorant, draws.y);
    }
    if (path.left_m <= 0.0 && path.mode != BEGIN) {
      leave();
    }
  }
  paths[index] = path;
  path_sums[index] = sums;
  if (path.samples < truth.samples) {
    atomicAdd(&counters[0], 1u);
    // Fewer events than were asked for, and yet not done: the driver has ended the loop.
    cut += select(0u, 1u, events < truth.per_dispatch);
  }
  atomicAdd(&counters[1], events);
  atomicAdd(&counters[2], exceeded);
  atomicAdd(&counters[3], cut);
}
