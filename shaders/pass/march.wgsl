// The march: light and opacity of the clouds along each ray of this frame.
//
// Steps are short inside cloud and long outside, with a way back on entry (Koblížek 2019, section 3.1.4), which halves
// until it has found the surface; each takes the energy-conserving share 1 - exp(-x) of what is left (Hillaire 2016), from
// a stable series. The start is jittered by the pixel alone, so that a still scene is a still picture.
#import "common/camera.wgsl"
#import "common/update.wgsl"
#import "generated/BandUniforms.wgsl"
#import "pass/cloud_light.wgsl"

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var<uniform> band: BandUniforms;
@group(0) @binding(2) var blue_noise: texture_2d<f32>;
#if GROUND
@group(0) @binding(3) var ground_distance: texture_2d<f32>;
#endif
#if FLOAT
@group(2) @binding(0) var cloud_out: texture_storage_2d<rgba32float, write>;
#else
@group(2) @binding(0) var cloud_out: texture_storage_2d<rgba16float, write>;
#endif
#if DISTANCE
@group(2) @binding(1) var distance_out: texture_storage_2d<r32float, write>;
#endif
#if COUNT
@group(2) @binding(2) var<storage, read_write> counters: array<atomic<u32>>;
#endif

struct Seen {
  light: vec3f,
  transmittance: f32,
  // Sum of distances weighted by opacity, and the weights.
  distance_sum: f32,
  weight_sum: f32,
}

// The air between the eye and the sample, read again when the distance has grown by a twelfth.
#if AIR
var<private> air_ahead: Aerial;
var<private> air_known_to: f32;

fn air_before(dir: vec3f, distance_m: f32) -> Aerial {
  if (distance_m > air_known_to) {
    let middle = distance_m * 1.04;
    air_ahead = aerial_at(sky_aerial_light, sky_aerial_transmittance, linear_repeat, air, dir, middle);
    air_known_to = distance_m * 1.08;
  }
  return air_ahead;
}
#endif

#if LIT
// The key light's irradiance at a place, cloud left out; read again when the place has moved far enough up or along.
var<private> key_light: vec3f;
var<private> key_light_altitude: f32;
var<private> key_light_distance: f32;

fn key_light_near(p: vec3f, altitude: f32, distance_m: f32) -> vec3f {
  let moved = abs(altitude - key_light_altitude) > 150.0 || distance_m > key_light_distance;
  if (moved) {
    key_light = key_light_at(p, altitude);
    key_light_altitude = altitude;
    key_light_distance = distance_m * 1.1 + 500.0;
  }
  return key_light;
}
#endif

fn usual_step(distance_m: f32) -> f32 {
  return scene.step_m + scene.step_growth * distance_m;
}

// An ordinary step at a height: layers that share it share the mean of theirs, as what they hold there is not known yet.
fn step_at(distance_m: f32, altitude: f32) -> f32 {
  var scales = 0.0;
  var count = 0.0;
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    let h = (altitude - layer.base_m) * layer.per_thickness;
    // Rays begin on the layers' ends, but for rounding.
    let is_here = abs(h - 0.5) < 0.51;
    scales += select(0.0, layer.step_scale, is_here);
    count += select(0.0, 1.0, is_here);
  }
  return usual_step(distance_m) * select(scales / max(count, 1.0), 1.0, count == 0.0);
}

// In cloud each layer has a say in the step by its part in the extinction.
fn step_in(distance_m: f32, densities: vec4f) -> f32 {
  var scaled = 0.0;
  var whole = 0.0;
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    let extinction = densities[i] * layer.extinction_per_m;
    scaled += extinction * layer.step_scale;
    whole += extinction;
  }
  return usual_step(distance_m) * select(1.0, scaled / whole, whole > 1e-20);
}

// Detail is whole up to half the distance at which it has faded to its mean.
fn detail_fade(distance_m: f32) -> f32 {
  return clamp(2.0 * distance_m / scene.detail_distance_m - 1.0, 0.0, 1.0);
}

fn noise_level(step: f32) -> f32 {
  return max(0.0, log2(max(step / FINEST_STEP_M, 1.0)) * 0.5 + scene.noise_level_bias);
}

// Samples that follow each other inside cloud are lit as one, at their common centre, until they send scene.light_share of
// what the eye sees: light changes slowly along the ray, and marching towards the light costs more than a sample. And no
// farther than over so many ordinary steps.
const LIT_STEPS: f32 = 8.0;

// Sums over samples that are lit together, each weighted by its share.
struct Group {
  share: f32,
  distance: f32,
  densities: vec4f,
  // Where the first of them is.
  begin: f32,
}

// Groups wait here for their light. Rays that run side by side meet cloud at different steps; lit one after the other
// they would wait for each other, lit together they do not. All rays light theirs at the same steps for the same reason,
// which also bounds the rounds of all loops by view steps times light steps.
const WAITING: u32 = 8u;
var<private> waiting_count: u32;
var<private> waiting_distance: array<f32, 8>;
var<private> waiting_share: array<f32, 8>;
var<private> waiting_densities: array<vec4f, 8>;

var<private> group: Group;

// Less than this nobody sees, and its mean densities would be lost to rounding.
const LEAST_SHARE: f32 = 1e-12;

fn close_group() {
  if (group.share > LEAST_SHARE) {
    waiting_distance[waiting_count] = group.distance / group.share;
    waiting_share[waiting_count] = group.share;
    waiting_densities[waiting_count] = group.densities / group.share;
    waiting_count += 1u;
  }
  group = Group(0.0, 0.0, vec4f(0.0), 0.0);
}

// Light of the groups that wait, seen through the air and the cloud before them.
fn light_of_waiting(origin: vec3f, dir: vec3f) -> vec3f {
  var light = vec3f(0.0);
  for (var k = 0u; k < waiting_count; k++) {
    let t = waiting_distance[k];
    let p = origin + dir * t;
    let altitude = altitude_of(p);
#if LIT
    let depth = sun_optical_depth(p, noise_level(step_at(t, altitude)), light_steps_of(altitude, waiting_densities[k]));
    let source = source_of(key_light_near(p, altitude, t), depth, altitude, waiting_densities[k]);
#else
    let source = source_of(vec3f(0.0), 0.0, altitude, waiting_densities[k]);
#endif
#if AIR
    let ahead = air_before(dir, t);
    light += waiting_share[k] * (ahead.transmittance * source + ahead.light);
#else
    light += waiting_share[k] * source;
#endif
  }
  waiting_count = 0u;
  return light;
}

var<private> steps_left: u32;

// Rays along a layer must not see through what they have no steps left for, so the second half of their steps is for
// whatever way is left, however long: ordinary steps are at least this, by which the way they cover grows with their
// number's fourth power. Few of them are so long where cloud is dense or broken; the last ones are, and share what is left.
const LAST_STEPS: u32 = 8u;

fn least_step(way_left: f32, steps: u32) -> f32 {
  let half = 0.5 * f32(scene.view_steps);
  let taken = max(1.0 - f32(steps) / half, 0.0);
  let cubed = taken * taken * taken;
  return way_left * min(4.0 * cubed / (half * max(1.0 - cubed * taken, 1e-3)), 1.0);
}

// Shortest step that looks for a surface, relative to ordinary ones.
const SURFACE_STEP: f32 = 0.1;
// And in ordinary optical depths: the light in cloud that is far denser than water is lies in its first centimetres.
const SURFACE_DEPTH: f32 = 0.5;
// Clear samples after which steps become longer.
const CLEAR_SAMPLES: u32 = 4u;
// How deep, in ordinary optical depths, an ordinary step may leap into cloud.
const NEAREST_DEPTH: f32 = 0.25;
// Steps inside begin short and grow by this: clouds are thin at their surface, where the light is, and by its extinction
// alone the first sample would stand for a long way into denser cloud.
const GROWTH_INSIDE: f32 = 1.5;

// One stretch of the ray. Clear air is crossed as far as the map promises it, else in steps that are shorter near
// surfaces; on meeting cloud half of the last step is taken back, and so on, until its surface is found; inside, steps grow
// until they have equal optical depth, longer where little is left to see. An empty_stride of 1 makes all steps equal.
fn march_segment(seen_before: Seen, origin: vec3f, dir: vec3f, segment: vec2f, way_after: f32, jitter: f32) -> Seen {
  var seen = seen_before;
  let is_varied = scene.empty_stride > 1.0;
  // How much of the way before a sample counts as its own, so that even cloud absorbs what the whole stretch absorbs,
  // whatever the jitter.
  var inside_step = step_at(segment.x, altitude_of(origin + dir * segment.x));
  var behind = jitter * inside_step;
  var t = segment.x + behind;
  // How much of the last step nothing was known of: at first the way to the first sample, before which there may be a
  // surface, that of fog or of a box that cuts through cloud.
  var unseen = behind;
  // The nearest place that has cloud, where the surface is before it.
  var met = 0.0;
  var clear_samples = CLEAR_SAMPLES;
  // One step is for what comes after.
  let reserved = select(0u, 1u, is_varied && way_after > 0.0 && steps_left > 1u);
  while (t < segment.y && steps_left > reserved && seen.transmittance > scene.early_exit) {
    steps_left -= 1u;
    if (waiting_count == WAITING || steps_left % WAITING == 0u) {
      seen.light += light_of_waiting(origin, dir);
    }
#if COUNT
    atomicAdd(&counters[1], 1u);
#endif
    let p = origin + dir * t;
    let steps = steps_left - reserved;
    let least = select(0.0, least_step(segment.y - t + way_after, steps), is_varied);
    let takes_least = is_varied && steps < LAST_STEPS;
    let step = max(step_at(t, altitude_of(p)), least);
    let fade = detail_fade(t);
    clearness = 1.0;
    sparse_extinction = NEAREST_DEPTH * scene.step_depth / step;
    clear_way = FAR_M;
    let densities = densities_at(p, Reading(noise_level(step), fade < 1.0, fade, dir));
    let extinction = extinction_of(densities);
    let within_depth = max(SURFACE_DEPTH * scene.step_depth / max(extinction, 1e-9), 1e-6 * t);
    let surface_step = select(step, min(step * SURFACE_STEP, within_depth), is_varied);
    if (extinction <= 0.0) {
      close_group();
      inside_step = 0.0;
      clear_samples += 1u;
      let stride = select(1.0, scene.empty_stride, clear_samples > CLEAR_SAMPLES);
      let near = max(step * select(1.0, stride * clearness, is_varied), select(0.0, least, takes_least));
      var ahead = near;
      if (is_varied && clear_way > near) {
        // Where the map promises clear air, all of that way and a share of a step there, or neighbours would go on in rows.
        let there = min(t + clear_way, segment.y);
        ahead = clear_way + jitter * max(near, step_at(there, altitude_of(origin + dir * there)));
      }
      let advanced = select(ahead, min(max(0.5 * (met - t), surface_step), met - t), t < met);
      unseen = advanced - min(clear_way, advanced);
      // On average cloud begins half way through what was not seen.
      behind = 0.5 * unseen;
      t += advanced;
    } else if (!takes_least && unseen > 1.5 * surface_step && extinction * step > 0.5 * scene.step_depth) {
      // Entered a dense cloud from clear air.
      met = t;
      unseen *= 0.5;
      t -= unseen;
      behind = 0.5 * unseen;
      clear_samples = 0u;
    } else {
      clear_samples = 0u;
      unseen = 0.0;
      let by_depth = max(scene.step_depth / (extinction * max(seen.transmittance, 0.15)), surface_step);
      let longest = max(step_in(t, densities), least);
      let grown = min(min(longest, by_depth), max(GROWTH_INSIDE * inside_step, surface_step));
      let wanted = max(grown, select(0.0, least, takes_least));
      inside_step = wanted;
      // A sample stands for the way half to its neighbours on both sides, the last one for all that is left.
      let length = behind + select(0.5 * wanted, segment.y - t, t + wanted >= segment.y);
      behind = 0.5 * wanted;
      let alpha = absorbed(extinction * length);
      let share = seen.transmittance * alpha;
      group.begin = select(group.begin, t, group.share <= 0.0);
      group.share += share;
      group.distance += share * t;
      group.densities += share * densities;
      if (group.share > scene.light_share || t - group.begin > LIT_STEPS * step) {
        close_group();
      }
      seen.distance_sum += share * t;
      seen.weight_sum += share;
      seen.transmittance *= 1.0 - alpha;
      t += wanted;
    }
  }
  close_group();
  return seen;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let ray = vec2u(id.x, id.y + band.first_row);
  if (any(ray >= view.ray_count) || id.y >= band.rows) {
    return;
  }
  let pixel = pixel_of_ray(ray, view);
  let dir = ray_through(view.camera, (vec2f(pixel) + view.pixel_point) / vec2f(view.size));
  let origin = view.camera.eye;
  let segments = domain_segments(origin, dir);
  var limit = scene.max_distance_m;
#if GROUND
  let ground = textureLoad(ground_distance, pixel, 0).x;
  limit = select(limit, min(limit, ground), ground >= 0.0);
#endif
  var seen = Seen(vec3f(0.0), 1.0, 0.0, 0.0);
  if (segments.first.y > segments.first.x && segments.first.x < limit) {
    prepare_light(dir);
    let noise = textureLoad(blue_noise, pixel % textureDimensions(blue_noise), 0).x;
    let jitter = fract(noise * view.jitter.x + view.jitter.y);
    steps_left = scene.view_steps;
#if LIT
    key_light_altitude = -1e9;
#endif
    let first = vec2f(segments.first.x, min(segments.first.y, limit));
    let second = vec2f(segments.second.x, min(segments.second.y, limit));
    seen = march_segment(seen, origin, dir, first, max(second.y - second.x, 0.0), jitter);
    if (second.y > second.x) {
      seen = march_segment(seen, origin, dir, second, 0.0, jitter);
    }
    seen.light += light_of_waiting(origin, dir);
  }
  let opened = after_early_exit(seen.transmittance, scene.early_exit);
  let transmittance = opened.x;
  textureStore(cloud_out, ray, sanitise4(vec4f(seen.light * opened.y, transmittance)));
#if DISTANCE
  let mean_distance = select(0.0, seen.distance_sum / max(seen.weight_sum, 1e-6), seen.weight_sum > 0.0);
  textureStore(distance_out, ray, vec4f(mean_distance, 0.0, 0.0, 0.0));
#endif
#if COUNT
  atomicAdd(&counters[0], 1u);
  atomicAdd(&counters[2], counted_light_steps);
  atomicAdd(&counters[3], counted_reads);
#endif
}
