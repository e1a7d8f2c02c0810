// Asks the tables of the clear sky: one query is a direction and a number, one answer six vectors.

#import "light/sky.wgsl"

@group(0) @binding(0) var<uniform> air: AirUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(0) @binding(2) var sky_transmittance: texture_2d<f32>;
@group(0) @binding(3) var sky_view: texture_2d<f32>;
@group(0) @binding(4) var sky_aerial_light: texture_3d<f32>;
@group(0) @binding(5) var sky_aerial_transmittance: texture_3d<f32>;
// xyz a direction; w a distance, and an altitude for the fourth part of the answer.
@group(0) @binding(6) var<storage, read> queries: array<vec4f>;

// The six parts of an answer.
struct Answer {
  sky: vec4f,
  air_light: vec4f,
  air_transmittance: vec4f,
  // From the altitude w towards a light at the zenith cosine y.
  light_transmittance: vec4f,
  sun_disc: vec4f,
  moon_disc: vec4f,
}

@group(0) @binding(7) var<storage, read_write> answers: array<Answer>;

const PIXEL_ANGLE = 0.0123;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if id.x >= arrayLength(&queries) {
    return;
  }
  let dir = queries[id.x].xyz;
  let w = queries[id.x].w;
  let aerial = aerial_at(sky_aerial_light, sky_aerial_transmittance, linear_repeat, air, dir, w);
  let seen = air_transmittance(sky_transmittance, linear_repeat, air, air.eye_altitude_m, dir.y);
  let reached = light_transmittance(sky_transmittance, linear_repeat, air, w, dir.y);
  var answer: Answer;
  answer.sky = vec4f(sky_radiance(sky_view, linear_repeat, air, dir), 0.0);
  answer.air_light = vec4f(aerial.light, 0.0);
  answer.air_transmittance = vec4f(aerial.transmittance, 0.0);
  answer.light_transmittance = vec4f(reached, 0.0);
  answer.sun_disc = vec4f(sun_disc(air, dir, PIXEL_ANGLE) * seen, 0.0);
  answer.moon_disc = vec4f(moon_disc(air, dir, PIXEL_ANGLE) * seen, 0.0);
  answers[id.x] = answer;
}
