// All orders of scattering above the first as one isotropic radiance per unit illuminance (Hillaire 2020, eqs. 5 to 10):
// the second order gathered from many directions, and a geometric series for the rest. The ground takes part in both.

#import "light/air_march.wgsl"

@group(0) @binding(0) var<uniform> air: AirUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(0) @binding(2) var sky_transmittance: texture_2d<f32>;
@group(0) @binding(3) var sky_multiscatter_out: texture_storage_2d<rgba16float, write>;

const ELEVATIONS = 20u;
const AZIMUTHS = 8u;
const STEPS = 24u;

// What arrives along one direction: light scattered once, and the share of a uniform glow that is scattered into it.
struct Gathered {
  light: vec3f,
  share: vec3f,
}

fn gather(altitude_m: f32, cos_zenith: f32, dir: vec3f) -> Gathered {
  let towards = vec3f(sqrt(max(1.0 - cos_zenith * cos_zenith, 0.0)), cos_zenith, 0.0);
  let ray = air_ray(air, altitude_m, dir, 0.0);
  let cosine = dot(dir, towards);
  let start_radius = air.planet_radius_m + ray.altitude_m;
  var gathered: Gathered;
  var transmittance = vec3f(1.0);
  var start = 0.0;
  for (var i = 1u; i <= STEPS; i++) {
    let to = step_boundary(ray, f32(i), f32(STEPS));
    let middle = 0.5 * (start + to);
    let altitude = max(ray_altitude(air.planet_radius_m, ray.altitude_m, dir.y, middle), 0.0);
    let light_cosine = (start_radius * cos_zenith + middle * cosine) / (air.planet_radius_m + altitude);
    let medium = air_sample(air, altitude);
    let depth = medium.extinction * (to - start);
    let scattering = (medium.rayleigh + medium.mie) * (to - start) * air_slab_weight(depth) * transmittance;
    let direct = light_transmittance(sky_transmittance, linear_repeat, air, altitude, light_cosine);
    gathered.light += scattering * direct / (4.0 * PI);
    gathered.share += scattering;
    transmittance *= exp(-depth);
    start = to;
  }
  if ray.hits_ground {
    let light_cosine = (start_radius * cos_zenith + ray.end_m * cosine) / air.planet_radius_m;
    let direct = light_transmittance(sky_transmittance, linear_repeat, air, 0.0, light_cosine);
    gathered.light += transmittance * direct * max(light_cosine, 0.0) * air.ground_albedo / PI;
    gathered.share += transmittance * air.ground_albedo;
  }
  return gathered;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if id.x >= u32(MULTISCATTER_SIZE.x) || id.y >= u32(MULTISCATTER_SIZE.y) {
    return;
  }
  let place = multiscatter_place(air, id.xy);
  var light = vec3f(0.0);
  var share = vec3f(0.0);
  // Elevations crowd about the true horizon, where the arch of twilight stands: even spirals of hundreds of directions
  // miss it. Azimuths span half a turn, the other half being its image in the plane of the light.
  let horizon = -horizon_dip_sine(air.planet_radius_m, place.x);
  for (var row = 0u; row < ELEVATIONS; row++) {
    let x = 2.0 * (f32(row) + 0.5) / f32(ELEVATIONS) - 1.0;
    let reach = 1.0 - sign(x) * horizon;
    let y = horizon + x * abs(x) * reach;
    let level = sqrt(max(1.0 - y * y, 0.0));
    let weight = 2.0 * abs(x) * reach / f32(ELEVATIONS * AZIMUTHS);
    for (var column = 0u; column < AZIMUTHS; column++) {
      let azimuth = PI * (f32(column) + 0.5) / f32(AZIMUTHS);
      let gathered = gather(place.x, place.y, vec3f(level * cos(azimuth), y, level * sin(azimuth)));
      light += weight * gathered.light;
      share += weight * gathered.share;
    }
  }
  let all_orders = light / max(1.0 - share, vec3f(0.02));
  let kept = log2(max(all_orders, vec3f(1e-15))) + MULTISCATTER_OFFSET;
  textureStore(sky_multiscatter_out, id.xy, vec4f(kept, 1.0));
}
