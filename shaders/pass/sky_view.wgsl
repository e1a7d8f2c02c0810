// The clear sky in all directions from the eye's altitude (Hillaire 2020, section 5.3, with the moon and the full azimuth).

#import "light/air_march.wgsl"

@group(0) @binding(0) var<uniform> air: AirUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(0) @binding(2) var sky_transmittance: texture_2d<f32>;
@group(0) @binding(3) var sky_multiscatter: texture_2d<f32>;
@group(0) @binding(4) var sky_view_out: texture_storage_2d<rgba16float, write>;

const STEPS = 40u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if id.x >= u32(SKY_VIEW_SIZE.x) || id.y >= u32(SKY_VIEW_SIZE.y) {
    return;
  }
  let elevation = row_elevation(air, id.y, SKY_VIEW_SIZE.y);
  let dir = direction_of(2.0 * PI * f32(id.x) / SKY_VIEW_SIZE.x, elevation.x);
  let ray = air_ray(air, air.eye_altitude_m, dir, elevation.y);
  let seen = air_light(sky_transmittance, sky_multiscatter, linear_repeat, air, ray, STEPS);
  textureStore(sky_view_out, id.xy, storable(seen.light + night_glow_light(air, ray, seen.transmittance)));
}
