// The air between the eye and every distance up to 250 km or the ground: one invocation walks one direction outwards and
// leaves what it has gathered at each slice (Hillaire 2020, section 5.4).

#import "light/air_march.wgsl"

@group(0) @binding(0) var<uniform> air: AirUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(0) @binding(2) var sky_transmittance: texture_2d<f32>;
@group(0) @binding(3) var sky_multiscatter: texture_2d<f32>;
@group(0) @binding(4) var sky_aerial_light_out: texture_storage_3d<rgba16float, write>;
@group(0) @binding(5) var sky_aerial_transmittance_out: texture_storage_3d<rgba16float, write>;

const STEPS_PER_SLICE = 3u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if id.x >= u32(AERIAL_SIZE.x) || id.y >= u32(AERIAL_SIZE.y) {
    return;
  }
  let elevation = row_elevation(air, id.y, AERIAL_SIZE.y);
  let dir = direction_of(aerial_azimuth(air, f32(id.x) / AERIAL_SIZE.x), elevation.x);
  let ray = air_ray(air, air.eye_altitude_m, dir, elevation.y);
  // The row at the horizon belongs to the half that `elevation.y` says, whatever rounding makes of its sine.
  let reach = select(AERIAL_RANGE_M, clamp(ray.end_m, 1.0, AERIAL_RANGE_M), elevation.y < 0.0);
  var light = vec3f(0.0);
  var transmittance = vec3f(1.0);
  var start = 0.0;
  for (var slice = 0u; slice < u32(AERIAL_SIZE.z); slice++) {
    if slice > 0u {
      for (var part = 1u; part <= STEPS_PER_SLICE; part++) {
        let place = f32(slice - 1u) + f32(part) / f32(STEPS_PER_SLICE);
        let to = min(aerial_distance(place, reach), ray.end_m);
        let part_air = air_step(sky_transmittance, sky_multiscatter, linear_repeat, air, ray, vec2f(start, to));
        light += transmittance * part_air.light;
        transmittance *= part_air.transmittance;
        start = to;
      }
    }
    let texel = vec3u(id.xy, slice);
    textureStore(sky_aerial_light_out, texel, storable(light));
    textureStore(sky_aerial_transmittance_out, texel, storable(transmittance));
  }
}
