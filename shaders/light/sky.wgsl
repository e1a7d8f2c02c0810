// Looks into the tables of the clear sky, for every shader that needs light or air. Radiance is in working units
// (cd/m² divided by the frame's `candela_per_unit`), linear Rec.709.
//
// Every sampler named `samp` is linear and repeats: azimuths wrap, and the other coordinates stay on texel centres.

#import "light/air.wgsl"

// exp(−optical depth) from an altitude to the top of the air along a direction; rays below the horizon as the horizon.
fn air_transmittance(lut: texture_2d<f32>, samp: sampler, air: AirUniforms, altitude_m: f32, cos_zenith: f32) -> vec3f {
  let depth = textureSampleLevel(lut, samp, transmittance_uv(air, altitude_m, cos_zenith), 0.0).rgb;
  return exp(-depth);
}

// The share of a light's disc, of `angular_radius` radians, that stands above the planet's edge; the area of a circular
// segment, so the terminator is as wide as the disc.
fn disc_above_horizon(air: AirUniforms, altitude_m: f32, cos_zenith: f32, angular_radius: f32) -> f32 {
  let dip = asin(horizon_dip_sine(air.planet_radius_m, altitude_m));
  let height = asin(clamp(cos_zenith, -1.0, 1.0)) + dip;
  let x = clamp(height / max(angular_radius, 1e-4), -1.0, 1.0);
  return clamp(0.5 + (x * sqrt(max(1.0 - x * x, 0.0)) + asin(x)) / PI, 0.0, 1.0);
}

// What part of the sun's or the moon's light reaches a point at `altitude_m` that sees it at `cos_zenith`.
fn light_transmittance(lut: texture_2d<f32>, samp: sampler, air: AirUniforms, altitude_m: f32, cos_zenith: f32) -> vec3f {
  let share = disc_above_horizon(air, altitude_m, cos_zenith, air.sun_angular_radius);
  return share * air_transmittance(lut, samp, air, altitude_m, cos_zenith);
}

// Isotropic radiance of all orders of scattering above the first, per unit illuminance of the light (Hillaire 2020).
// The table keeps its logarithm: through twilight it falls as an exponential does, and half floats have no room for it.
fn multiple_scattering(lut: texture_2d<f32>, samp: sampler, air: AirUniforms, altitude_m: f32, cos_zenith: f32) -> vec3f {
  let kept = textureSampleLevel(lut, samp, multiscatter_uv(air, altitude_m, cos_zenith), 0.0).rgb;
  return exp2(kept - MULTISCATTER_OFFSET);
}

// Radiance of the clear sky in a direction, without the discs; below the horizon that of the air before the ground.
fn sky_radiance(lut: texture_2d<f32>, samp: sampler, air: AirUniforms, dir: vec3f) -> vec3f {
  // Texel centres stand at whole multiples of the azimuth step, hence the half texel.
  let turn = azimuth_of(dir) / (2.0 * PI) + 0.5 / SKY_VIEW_SIZE.x;
  return textureSampleLevel(lut, samp, vec2f(turn, elevation_row(air, dir.y, SKY_VIEW_SIZE.y)), 0.0).rgb;
}

// The air between the eye and a point: its own light, and what it lets through.
struct Aerial {
  light: vec3f,
  transmittance: vec3f,
}

// The air over `distance_m` metres from the eye. Between two slices both change in proportion to the distance itself.
fn aerial_at(
  light_lut: texture_3d<f32>,
  transmittance_lut: texture_3d<f32>,
  samp: sampler,
  air: AirUniforms,
  dir: vec3f,
  distance_m: f32,
) -> Aerial {
  let reach = aerial_reach(air, dir.y);
  let distance = clamp(distance_m, 0.0, reach);
  let last = AERIAL_SIZE.z - 1.0;
  let slice = min(floor(sqrt(distance / reach) * last), last - 1.0);
  let near = aerial_distance(slice, reach);
  let thickness = aerial_distance(slice + 1.0, reach) - near;
  let depth = slice + clamp((distance - near) / thickness, 0.0, 1.0);
  let turn = aerial_turn(air, azimuth_of(dir)) + 0.5 / AERIAL_SIZE.x;
  let place = vec3f(turn, elevation_row(air, dir.y, AERIAL_SIZE.y), (depth + 0.5) / AERIAL_SIZE.z);
  var aerial: Aerial;
  aerial.light = textureSampleLevel(light_lut, samp, place, 0.0).rgb;
  aerial.transmittance = textureSampleLevel(transmittance_lut, samp, place, 0.0).rgb;
  return aerial;
}

// Angle in radians between two unit vectors, exact for small angles.
fn small_angle(a: vec3f, b: vec3f) -> f32 {
  return 2.0 * asin(min(0.5 * length(a - b), 1.0));
}

// Share of a pixel of `pixel_angle` radians that a disc's edge leaves covered, `angle` from the disc's centre.
fn disc_coverage(angle: f32, angular_radius: f32, pixel_angle: f32) -> f32 {
  return clamp((angular_radius - angle) / max(pixel_angle, 1e-6) + 0.5, 0.0, 1.0);
}

// Mean radiance of a disc that gives `illuminance`.
fn disc_radiance(illuminance: vec3f, angular_radius: f32) -> vec3f {
  let sine = sin(max(angular_radius, 1e-4));
  return illuminance / (PI * sine * sine);
}

// Radiance of the sun's disc before the air, limb-darkened as μ^a (Hestroffer and Magnan 1998), whose mean over the disc
// is 1/(1 + a/2), so that the disc gives exactly `sun_illuminance`.
fn sun_disc(air: AirUniforms, dir: vec3f, pixel_angle: f32) -> vec3f {
  let angle = small_angle(dir, air.towards_sun);
  let coverage = disc_coverage(angle, air.sun_angular_radius, pixel_angle);
  if coverage <= 0.0 {
    return vec3f(0.0);
  }
  let r = min(angle / max(air.sun_angular_radius, 1e-4), 1.0);
  let cosine = sqrt(max(1.0 - r * r, 1e-4));
  let power = vec3f(0.397, 0.503, 0.652);
  let limb = pow(vec3f(cosine), power) * (1.0 + 0.5 * power);
  return coverage * limb * disc_radiance(air.sun_illuminance, air.sun_angular_radius);
}

// Radiance of the moon's disc before the air: a Lommel-Seeliger sphere lit from the sun's direction, flat when full. A
// thin crescent is held to ten times the radiance that the whole disc would need.
fn moon_disc(air: AirUniforms, dir: vec3f, pixel_angle: f32) -> vec3f {
  let angle = small_angle(dir, air.towards_moon);
  let coverage = disc_coverage(angle, air.moon_angular_radius, pixel_angle);
  if coverage <= 0.0 {
    return vec3f(0.0);
  }
  let offset = (dir - air.towards_moon * dot(dir, air.towards_moon)) / sin(max(air.moon_angular_radius, 1e-4));
  let facing = sqrt(max(1.0 - dot(offset, offset), 0.0));
  let normal = offset - air.towards_moon * facing;
  let lit = max(dot(normal, air.towards_sun), 0.0);
  let shade = 2.0 * lit / max(lit + facing, 1e-3);
  let lit_share = 0.5 * (1.0 - dot(air.towards_sun, air.towards_moon));
  return coverage * shade / max(lit_share, 0.1) * disc_radiance(air.moon_illuminance, air.moon_angular_radius);
}
