// Clear air: what it is made of, how it scatters, the geometry of rays in it, and how its tables are laid out.
//
// Frame: metres, y up at the eye; the planet's surface is at altitude 0, its centre `planet_radius_m` below. Radii are
// never squared and subtracted in f32: every root and altitude is formed from differences, which stay exact.
// Media after Bruneton 2017; ozone as a tent.

#import "common/math.wgsl"
#import "generated/AirUniforms.wgsl"

const TRANSMITTANCE_SIZE = vec2f(256.0, 128.0);
const MULTISCATTER_SIZE = vec2f(64.0, 32.0);
// Added to the binary logarithm in that table, so that the values of day, not those of twilight, are small and exact.
const MULTISCATTER_OFFSET = 6.0;
const SKY_VIEW_SIZE = vec2f(256.0, 144.0);
const AERIAL_SIZE = vec3f(48.0, 40.0, 32.0);
// Distance of the last slice of the aerial tables, where the ground is not nearer.
const AERIAL_RANGE_M = 250000.0;
// Cosine of the light's zenith angle about which the table of multiple scattering is finest.
const MULTISCATTER_MIDDLE = -0.08;
// How strongly the aerial tables gather their azimuths about the main light; below 1.
const AERIAL_GATHERING = 0.6;

struct AirSample {
  // Scattering per metre.
  rayleigh: vec3f,
  mie: vec3f,
  // Scattering and absorption per metre.
  extinction: vec3f,
}

// The air at an altitude in metres; below sea level as at sea level.
fn air_sample(air: AirUniforms, altitude_m: f32) -> AirSample {
  let altitude = max(altitude_m, 0.0);
  let mie = exp(-altitude / air.mie_scale_height_m);
  let ozone = max(0.0, 1.0 - abs(altitude - air.ozone_centre_m) / air.ozone_half_width_m);
  var medium: AirSample;
  medium.rayleigh = air.rayleigh_scattering_per_m * exp(-altitude / air.rayleigh_scale_height_m);
  medium.mie = air.mie_scattering_per_m * mie;
  medium.extinction = medium.rayleigh + medium.mie + air.mie_absorption_per_m * mie
    + air.ozone_absorption_per_m * ozone;
  return medium;
}

// Rayleigh's phase function, 1/sr.
fn rayleigh_phase(cosine: f32) -> f32 {
  return 3.0 / (16.0 * PI) * (1.0 + cosine * cosine);
}

// 1 + g² − 2 g cos, each part non-negative, so that nothing cancels near the forward peak.
fn lobe_distance2(cosine: f32, g: f32) -> f32 {
  return (1.0 - g) * (1.0 - g) + 2.0 * g * max(1.0 - cosine, 0.0);
}

// Aerosols, 1/sr: Cornette and Shanks 1992 for the aureole, and a broad Henyey-Greenstein lobe for the veil far from the
// light. `cosine` is of the angle between the view ray and the direction towards the light.
fn aerosol_phase(air: AirUniforms, cosine: f32) -> f32 {
  let g = air.mie_anisotropy;
  let narrow_d2 = lobe_distance2(cosine, g);
  let narrow = 3.0 / (8.0 * PI) * (1.0 - g * g) * (1.0 + cosine * cosine)
    / ((2.0 + g * g) * narrow_d2 * sqrt(narrow_d2));
  let b = air.mie_broad_anisotropy;
  let broad_d2 = lobe_distance2(cosine, b);
  let broad = (1.0 - b * b) / (4.0 * PI * broad_d2 * sqrt(broad_d2));
  return mix(narrow, broad, air.mie_broad_share);
}

// (1 − exp(−x)) / x for each channel.
fn air_slab_weight(x: vec3f) -> vec3f {
  return vec3f(absorption_weight(x.r), absorption_weight(x.g), absorption_weight(x.b));
}

// Altitude after `t` metres along a ray that starts at `altitude_m` with sine of elevation `s`.
fn ray_altitude(radius_m: f32, altitude_m: f32, s: f32, t: f32) -> f32 {
  let excess = altitude_m * (2.0 * radius_m + altitude_m) + t * (2.0 * (radius_m + altitude_m) * s + t);
  return excess / (sqrt(max(radius_m * radius_m + excess, 0.0)) + radius_m);
}

// Sine of the dip of the true horizon below the eye's horizontal; 0 at sea level.
fn horizon_dip_sine(radius_m: f32, altitude_m: f32) -> f32 {
  let altitude = max(altitude_m, 0.0);
  return sqrt(altitude * (2.0 * radius_m + altitude)) / (radius_m + altitude);
}

// Metres from an altitude below the top of the air to the top.
fn distance_to_top(air: AirUniforms, altitude_m: f32, s: f32) -> f32 {
  let b = (air.planet_radius_m + altitude_m) * s;
  let c = (air.top_altitude_m - altitude_m) * (2.0 * air.planet_radius_m + altitude_m + air.top_altitude_m);
  let root = sqrt(max(b * b + c, 0.0));
  return select(root - b, c / max(root + b, 1.0), b > 0.0);
}

// Metres to the ground, or −1 where the ray misses it.
fn distance_to_ground(air: AirUniforms, altitude_m: f32, s: f32) -> f32 {
  let b = (air.planet_radius_m + altitude_m) * s;
  let c = altitude_m * (2.0 * air.planet_radius_m + altitude_m);
  let discriminant = b * b - c;
  if b >= 0.0 || discriminant < 0.0 {
    return -1.0;
  }
  return c / (sqrt(discriminant) - b);
}

// The altitude used for tables: within the air, and above the ground.
fn table_altitude(air: AirUniforms, altitude_m: f32) -> f32 {
  return clamp(altitude_m, 0.0, air.top_altitude_m - 1.0);
}

// The cosine of the zenith angle of a far light seen from `p`, metres in the world frame.
fn light_cos_zenith(p: vec3f, towards: vec3f, radius_m: f32) -> f32 {
  let excess = dot(p, p) + 2.0 * radius_m * p.y;
  let distance_to_centre = sqrt(max(radius_m * radius_m + excess, 1.0));
  return clamp((dot(p, towards) + radius_m * towards.y) / distance_to_centre, -1.0, 1.0);
}

// Texture coordinates whose texel centres include both ends of 0..1.
fn to_centres(unit: f32, size: f32) -> f32 {
  return (clamp(unit, 0.0, 1.0) * (size - 1.0) + 0.5) / size;
}

// 0..1 from a texel.
fn from_centre(texel: u32, size: f32) -> f32 {
  return f32(texel) / (size - 1.0);
}

// Where the optical depth to the top of the air is kept (Bruneton 2017): linear in distance to the top and to the horizon.
// Rays below the horizon are taken as the horizon.
fn transmittance_uv(air: AirUniforms, altitude_m: f32, cos_zenith: f32) -> vec2f {
  let radius = air.planet_radius_m;
  let altitude = table_altitude(air, altitude_m);
  let cosine = max(cos_zenith, -horizon_dip_sine(radius, altitude));
  let horizon_of_top = sqrt(air.top_altitude_m * (2.0 * radius + air.top_altitude_m));
  let horizon = sqrt(altitude * (2.0 * radius + altitude));
  let nearest = air.top_altitude_m - altitude;
  let farthest = horizon + horizon_of_top;
  let along = (distance_to_top(air, altitude, cosine) - nearest) / (farthest - nearest);
  return vec2f(to_centres(along, TRANSMITTANCE_SIZE.x), to_centres(horizon / horizon_of_top, TRANSMITTANCE_SIZE.y));
}

// The inverse: (altitude in metres, cosine of the zenith angle) of a texel.
fn transmittance_place(air: AirUniforms, texel: vec2u) -> vec2f {
  let radius = air.planet_radius_m;
  let top = air.top_altitude_m;
  let horizon_of_top = sqrt(top * (2.0 * radius + top));
  let horizon = horizon_of_top * from_centre(texel.y, TRANSMITTANCE_SIZE.y);
  let altitude = min(horizon * horizon / (sqrt(radius * radius + horizon * horizon) + radius), top);
  let nearest = top - altitude;
  let distance = mix(nearest, horizon + horizon_of_top, from_centre(texel.x, TRANSMITTANCE_SIZE.x));
  let cosine = ((top - altitude) * (2.0 * radius + top + altitude) - distance * distance)
    / (2.0 * (radius + altitude) * max(distance, 1.0));
  return vec2f(altitude, select(clamp(cosine, -1.0, 1.0), 1.0, distance <= 1.0));
}

// Altitude and cosine of the light in the table of multiple scattering; both gather where the light changes fastest,
// near the ground and in twilight.
fn multiscatter_uv(air: AirUniforms, altitude_m: f32, cos_zenith: f32) -> vec2f {
  let from_middle = clamp(cos_zenith, -1.0, 1.0) - MULTISCATTER_MIDDLE;
  let x = 0.5 + 0.5 * sign(from_middle) * sqrt(abs(from_middle) / (1.0 - sign(from_middle) * MULTISCATTER_MIDDLE));
  let y = sqrt(table_altitude(air, altitude_m) / air.top_altitude_m);
  return vec2f(to_centres(x, MULTISCATTER_SIZE.x), to_centres(y, MULTISCATTER_SIZE.y));
}

// The inverse: (altitude in metres, cosine of the zenith angle of the light).
fn multiscatter_place(air: AirUniforms, texel: vec2u) -> vec2f {
  let x = 2.0 * from_centre(texel.x, MULTISCATTER_SIZE.x) - 1.0;
  let y = from_centre(texel.y, MULTISCATTER_SIZE.y);
  let cosine = MULTISCATTER_MIDDLE + x * abs(x) * (1.0 - sign(x) * MULTISCATTER_MIDDLE);
  return vec2f(table_altitude(air, y * y * air.top_altitude_m), clamp(cosine, -1.0, 1.0));
}

// Azimuth clockwise from north (−z), radians in −π..π; 0 straight up and down.
fn azimuth_of(dir: vec3f) -> f32 {
  let level = abs(dir.x) + abs(dir.z) < 1e-12;
  return select(atan2(dir.x, -dir.z), 0.0, level);
}

// Elevation in radians above the true horizon of the eye.
fn above_horizon(air: AirUniforms, dir_y: f32) -> f32 {
  return asin(clamp(dir_y, -1.0, 1.0)) + asin(horizon_dip_sine(air.planet_radius_m, air.eye_altitude_m));
}

// Row of a direction: the lower half of the table lies below the true horizon, the upper half above it, both with rows
// that crowd towards it; no row mixes the two, for the horizon is an edge. Below it they crowd the more, for the ground
// comes near quickly, and between two rows that meet it far apart the air would be too bright: a light line.
fn elevation_row(air: AirUniforms, dir_y: f32, rows: f32) -> f32 {
  let horizon = -asin(horizon_dip_sine(air.planet_radius_m, air.eye_altitude_m));
  let above = above_horizon(air, dir_y);
  let half_rows = 0.5 * rows;
  let up = half_rows + (half_rows - 1.0) * sqrt(clamp(above / (0.5 * PI - horizon), 0.0, 1.0));
  let down = (half_rows - 1.0) * (1.0 - pow(clamp(-above / (0.5 * PI + horizon), 0.0, 1.0), 1.0 / 3.0));
  return (select(down, up, above >= 0.0) + 0.5) / rows;
}

// Elevation in radians of a row, and +1 if it is above the true horizon, −1 if below.
fn row_elevation(air: AirUniforms, row: u32, rows: f32) -> vec2f {
  let horizon = -asin(horizon_dip_sine(air.planet_radius_m, air.eye_altitude_m));
  let half_rows = 0.5 * rows;
  if f32(row) >= half_rows {
    let x = (f32(row) - half_rows) / (half_rows - 1.0);
    return vec2f(horizon + x * x * (0.5 * PI - horizon), 1.0);
  }
  let x = 1.0 - f32(row) / (half_rows - 1.0);
  return vec2f(horizon - x * x * x * (0.5 * PI + horizon), -1.0);
}

// Azimuth coordinate 0..1 of the aerial tables, finest about the main light, where the aureole is.
fn aerial_turn(air: AirUniforms, azimuth: f32) -> f32 {
  let relative = azimuth - air.main_azimuth;
  return fract((relative + AERIAL_GATHERING * sin(relative)) / (2.0 * PI));
}

// The inverse of `aerial_turn`, by Newton's method.
fn aerial_azimuth(air: AirUniforms, turn: f32) -> f32 {
  let target_angle = 2.0 * PI * select(turn, turn - 1.0, turn > 0.5);
  var relative = target_angle;
  for (var i = 0u; i < 12u; i++) {
    let residual = relative + AERIAL_GATHERING * sin(relative) - target_angle;
    relative = clamp(relative - residual / (1.0 + AERIAL_GATHERING * cos(relative)), -PI, PI);
  }
  return relative + air.main_azimuth;
}

// Distance in metres of the last slice in a direction. Below the horizon it is the ground: rows next to each other meet
// the ground at very different distances, and rows that stopped at metres would give the air before far ground too little
// light, a dark line under the sky.
fn aerial_reach(air: AirUniforms, dir_y: f32) -> f32 {
  let altitude = table_altitude(air, air.eye_altitude_m);
  let b = (air.planet_radius_m + altitude) * min(dir_y, 0.0);
  let c = altitude * (2.0 * air.planet_radius_m + altitude);
  let to_ground = c / (sqrt(max(b * b - c, 0.0)) - b + 1e-3);
  return select(clamp(to_ground, 1.0, AERIAL_RANGE_M), AERIAL_RANGE_M, above_horizon(air, dir_y) >= 0.0);
}

// Distance in metres of a slice of the aerial tables, the last at `reach_m`; 0 for the first.
fn aerial_distance(slice: f32, reach_m: f32) -> f32 {
  let x = slice / (AERIAL_SIZE.z - 1.0);
  return reach_m * x * x;
}

// Direction of an azimuth and an elevation, both in radians.
fn direction_of(azimuth: f32, elevation: f32) -> vec3f {
  return vec3f(cos(elevation) * sin(azimuth), sin(elevation), -cos(elevation) * cos(azimuth));
}
