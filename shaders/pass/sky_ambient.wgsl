// Four means of the clear sky in four texels:
// 0: radiance from the upper hemisphere at `cloud_altitude_m`, a mean over solid angle (not cosine-weighted);
// 1: radiance from the lower hemisphere there, the ground lit by sun, moon and sky seen through the air, over solid angle;
// 2: radiance of the lowest 6° above the true horizon at the eye;
// 3: irradiance of level ground at altitude 0 from the sky without the discs, divided by π.

#import "light/air_march.wgsl"

@group(0) @binding(0) var<uniform> air: AirUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(0) @binding(2) var sky_transmittance: texture_2d<f32>;
@group(0) @binding(3) var sky_multiscatter: texture_2d<f32>;
@group(0) @binding(4) var sky_ambient_out: texture_storage_2d<rgba32float, write>;

const LANES = 64u;
const RAYS_PER_LANE = 4u;
const STEPS = 24u;

var<workgroup> lane_values: array<vec3f, 64>;

fn seen_from(altitude_m: f32, dir: vec3f, ground: vec3f) -> vec3f {
  let ray = air_ray(air, altitude_m, dir, 0.0);
  let seen = air_light(sky_transmittance, sky_multiscatter, linear_repeat, air, ray, STEPS);
  if !ray.hits_ground {
    return seen.light + night_glow_light(air, ray, seen.transmittance);
  }
  var lit = ground;
  lit += lit_by(air.sun_illuminance, air.towards_sun, ray);
#if MOONLIT
  lit += lit_by(air.moon_illuminance, air.towards_moon, ray);
#endif
  return seen.light + seen.transmittance * air.ground_albedo * lit;
}

// Irradiance divided by π of the ground at the end of a ray.
fn lit_by(illuminance: vec3f, towards: vec3f, ray: AirRay) -> vec3f {
  let start_radius = air.planet_radius_m + ray.altitude_m;
  let cosine = (start_radius * towards.y + ray.end_m * dot(ray.dir, towards)) / air.planet_radius_m;
  let direct = light_transmittance(sky_transmittance, linear_repeat, air, 0.0, cosine);
  return illuminance * direct * max(cosine, 0.0) / PI;
}

// The mean of all lanes' values; every lane has to come here.
fn mean_over_lanes(lane: u32, value: vec3f) -> vec3f {
  lane_values[lane] = value;
  for (var reach = LANES / 2u; reach > 0u; reach /= 2u) {
    workgroupBarrier();
    if lane < reach {
      lane_values[lane] += lane_values[lane + reach];
    }
  }
  workgroupBarrier();
  let mean = lane_values[0] / f32(LANES);
  workgroupBarrier();
  return mean;
}

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32) {
  let count = f32(LANES * RAYS_PER_LANE);
  let horizon = -asin(horizon_dip_sine(air.planet_radius_m, air.eye_altitude_m));
  var on_ground = vec3f(0.0);
  var above = vec3f(0.0);
  var band = vec3f(0.0);
  for (var i = 0u; i < RAYS_PER_LANE; i++) {
    let number = f32(lane + LANES * i);
    let azimuth = 2.3999632 * number;
    let unit = (number + 0.5) / count;
    on_ground += seen_from(0.0, direction_of(azimuth, asin(sqrt(unit))), vec3f(0.0));
    above += seen_from(air.cloud_altitude_m, direction_of(azimuth, asin(unit)), vec3f(0.0));
    band += seen_from(air.eye_altitude_m, direction_of(azimuth, horizon + 0.001 + 0.104 * unit), vec3f(0.0));
  }
  let sky_on_ground = mean_over_lanes(lane, on_ground / f32(RAYS_PER_LANE));
  let mean_above = mean_over_lanes(lane, above / f32(RAYS_PER_LANE));
  let mean_band = mean_over_lanes(lane, band / f32(RAYS_PER_LANE));
  var below = vec3f(0.0);
  for (var i = 0u; i < RAYS_PER_LANE; i++) {
    let number = f32(lane + LANES * i);
    let elevation = -asin((number + 0.5) / count);
    below += seen_from(air.cloud_altitude_m, direction_of(2.3999632 * number, elevation), sky_on_ground);
  }
  let mean_below = mean_over_lanes(lane, below / f32(RAYS_PER_LANE));
  if lane == 0u {
    textureStore(sky_ambient_out, vec2u(0u, 0u), vec4f(mean_above, 1.0));
    textureStore(sky_ambient_out, vec2u(1u, 0u), vec4f(mean_below, 1.0));
    textureStore(sky_ambient_out, vec2u(2u, 0u), vec4f(mean_band, 1.0));
    textureStore(sky_ambient_out, vec2u(3u, 0u), vec4f(sky_on_ground, 1.0));
  }
}
