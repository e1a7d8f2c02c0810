// Optical depth from every altitude to the top of the air (Bruneton 2017, section "Transmittance"). The depth is kept, not
// its exponential: it interpolates better and does not underflow in thick haze.

#import "light/air.wgsl"

@group(0) @binding(0) var<uniform> air: AirUniforms;
@group(0) @binding(1) var sky_transmittance_out: texture_storage_2d<rgba16float, write>;

const STEPS = 96u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if id.x >= u32(TRANSMITTANCE_SIZE.x) || id.y >= u32(TRANSMITTANCE_SIZE.y) {
    return;
  }
  let place = transmittance_place(air, id.xy);
  let end_m = distance_to_top(air, place.x, place.y);
  // A ray that starts below the horizontal comes down first; steps crowd towards its lowest point.
  let lowest_m = clamp(-(air.planet_radius_m + place.x) * place.y, 0.0, end_m);
  var depth = vec3f(0.0);
  for (var i = 0u; i < STEPS; i++) {
    let x = (f32(i) + 0.5) / f32(STEPS);
    let up = end_m - lowest_m;
    depth += 2.0 * x * up * extinction_at(place, lowest_m + up * x * x);
    depth += 2.0 * x * lowest_m * extinction_at(place, lowest_m * (1.0 - x * x));
  }
  textureStore(sky_transmittance_out, id.xy, vec4f(min(depth / f32(STEPS), vec3f(65000.0)), 1.0));
}

fn extinction_at(place: vec2f, t: f32) -> vec3f {
  return air_sample(air, ray_altitude(air.planet_radius_m, place.x, place.y, t)).extinction;
}
