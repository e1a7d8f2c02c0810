// Integrates the light of sun and moon that the air scatters along a ray from an altitude (Hillaire 2020, eqs. 1 and 11).

#import "light/sky.wgsl"

// A ray in the air and how its steps are spread: they crowd towards its lowest point, where the air is densest.
struct AirRay {
  altitude_m: f32,
  dir: vec3f,
  // Metres to its end, and to its lowest point before that.
  end_m: f32,
  lowest_m: f32,
  hits_ground: bool,
}

// A ray up to the ground or the top of the air. `side` is +1 to pass the horizon above, −1 below, 0 to decide by the ray;
// rows exactly at the horizon need it, where rounding would decide.
fn air_ray(air: AirUniforms, altitude_m: f32, dir: vec3f, side: f32) -> AirRay {
  var ray: AirRay;
  ray.altitude_m = table_altitude(air, altitude_m);
  ray.dir = dir;
  let radius = air.planet_radius_m + ray.altitude_m;
  let to_top = distance_to_top(air, ray.altitude_m, dir.y);
  var to_ground = distance_to_ground(air, ray.altitude_m, dir.y);
  if side < 0.0 && to_ground < 0.0 {
    to_ground = max(-radius * dir.y, 0.0);
  }
  ray.hits_ground = to_ground >= 0.0 && side <= 0.0;
  ray.end_m = select(to_top, to_ground, ray.hits_ground);
  ray.lowest_m = clamp(-radius * dir.y, 0.0, ray.end_m);
  return ray;
}

// The boundary between steps `i − 1` and `i` of `count`, metres along the ray: the first half of the steps comes down to
// the lowest point, the second climbs from it; a ray that only climbs or only falls spends all steps on that.
fn step_boundary(ray: AirRay, i: f32, count: f32) -> f32 {
  let falls = ray.lowest_m > 1e-3 * ray.end_m;
  let climbs = ray.lowest_m < 0.999 * ray.end_m;
  let turning = select(select(0.0, count, falls), 0.5 * count, falls && climbs);
  if i < turning {
    let x = 1.0 - i / turning;
    return ray.lowest_m * (1.0 - x * x);
  }
  let low = select(0.0, ray.lowest_m, falls);
  let x = (i - turning) / max(count - turning, 1.0);
  return low + (ray.end_m - low) * x * x;
}

// What a light adds per metre of a point's scattering: once scattered, and all further orders.
fn scattered(
  transmittance_lut: texture_2d<f32>,
  multiscatter_lut: texture_2d<f32>,
  samp: sampler,
  air: AirUniforms,
  place: ScatterPlace,
) -> vec3f {
  let direct = light_transmittance(transmittance_lut, samp, air, place.altitude_m, place.cos_zenith);
  let indirect = multiple_scattering(multiscatter_lut, samp, air, place.altitude_m, place.cos_zenith);
  let once = place.medium.rayleigh * place.phases.x + place.medium.mie * place.phases.y;
  return direct * once + indirect * (place.medium.rayleigh + place.medium.mie);
}

// Where light is scattered, and through which phases (Rayleigh, aerosol).
struct ScatterPlace {
  medium: AirSample,
  altitude_m: f32,
  cos_zenith: f32,
  phases: vec2f,
}

// Light and transmittance of the air between two distances along the ray, in one part.
fn air_step(
  transmittance_lut: texture_2d<f32>,
  multiscatter_lut: texture_2d<f32>,
  samp: sampler,
  air: AirUniforms,
  ray: AirRay,
  span: vec2f,
) -> Aerial {
  let middle = 0.5 * (span.x + span.y);
  let altitude = max(ray_altitude(air.planet_radius_m, ray.altitude_m, ray.dir.y, middle), 0.0);
  let radius = air.planet_radius_m + altitude;
  let start_radius = air.planet_radius_m + ray.altitude_m;
  var place: ScatterPlace;
  place.medium = air_sample(air, altitude);
  place.altitude_m = altitude;
  var source = vec3f(0.0);
  {
    let cosine = clamp(dot(ray.dir, air.towards_sun), -1.0, 1.0);
    place.cos_zenith = (start_radius * air.towards_sun.y + middle * cosine) / radius;
    place.phases = vec2f(rayleigh_phase(cosine), aerosol_phase(air, cosine));
    source += air.sun_illuminance * scattered(transmittance_lut, multiscatter_lut, samp, air, place);
  }
#if MOONLIT
  {
    let cosine = clamp(dot(ray.dir, air.towards_moon), -1.0, 1.0);
    place.cos_zenith = (start_radius * air.towards_moon.y + middle * cosine) / radius;
    place.phases = vec2f(rayleigh_phase(cosine), aerosol_phase(air, cosine));
    source += air.moon_illuminance * scattered(transmittance_lut, multiscatter_lut, samp, air, place);
  }
#endif
  let length_m = span.y - span.x;
  let depth = place.medium.extinction * length_m;
  var result: Aerial;
  result.light = source * length_m * air_slab_weight(depth);
  result.transmittance = exp(-depth);
  return result;
}

// The whole ray in `count` steps.
fn air_light(
  transmittance_lut: texture_2d<f32>,
  multiscatter_lut: texture_2d<f32>,
  samp: sampler,
  air: AirUniforms,
  ray: AirRay,
  count: u32,
) -> Aerial {
  var total: Aerial;
  total.light = vec3f(0.0);
  total.transmittance = vec3f(1.0);
  var start = 0.0;
  for (var i = 1u; i <= count; i++) {
    let to = step_boundary(ray, f32(i), f32(count));
    let part = air_step(transmittance_lut, multiscatter_lut, samp, air, ray, vec2f(start, to));
    total.light += total.transmittance * part.light;
    total.transmittance *= part.transmittance;
    start = to;
  }
  return total;
}

// Airglow and starlight: `night_glow` at the zenith, brighter towards the horizon as a thin layer at 90 km is seen more
// obliquely (van Rhijn 1921), dimmed by the air; nothing below the horizon.
fn night_glow_light(air: AirUniforms, ray: AirRay, transmittance: vec3f) -> vec3f {
  let share = (air.planet_radius_m + ray.altitude_m) / (air.planet_radius_m + max(90000.0, ray.altitude_m + 1000.0));
  let cos2 = 1.0 - share * share * max(1.0 - ray.dir.y * ray.dir.y, 0.0);
  let oblique = inverseSqrt(max(cos2, 1e-3));
  return select(air.night_glow * oblique * transmittance, vec3f(0.0), ray.hits_ground);
}

// A value that a half float holds.
fn storable(light: vec3f) -> vec4f {
  return vec4f(clamp(light, vec3f(0.0), vec3f(65000.0)), 1.0);
}
