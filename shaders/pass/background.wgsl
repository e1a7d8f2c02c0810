// What lies behind the clouds: sky, sun and moon, and ground with hills, mountains and the shadows of clouds.
#import "common/camera.wgsl"
#import "common/ground_cover.wgsl"
#import "common/random.wgsl"
#import "common/shell.wgsl"
#import "generated/BandUniforms.wgsl"
#import "generated/CameraUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"
#import "light/sky.wgsl"
#if GROUND
#import "pass/terrain.wgsl"
#endif
#if SOLIDS
#import "pass/solids.wgsl"
#endif

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var<uniform> band: BandUniforms;
@group(0) @binding(2) var<uniform> air: AirUniforms;
@group(0) @binding(4) var sky_view: texture_2d<f32>;
@group(0) @binding(5) var sky_transmittance: texture_2d<f32>;
@group(0) @binding(6) var linear_repeat: sampler;
#if GROUND
@group(0) @binding(7) var sky_ambient: texture_2d<f32>;
@group(0) @binding(8) var sky_aerial_light: texture_3d<f32>;
@group(0) @binding(9) var sky_aerial_transmittance: texture_3d<f32>;
@group(2) @binding(1) var ground_distance_out: texture_storage_2d<r32float, write>;
#endif
// Rows that lie above all ground: only its distance is told, which there is none of.
#if OPEN
@group(2) @binding(1) var ground_distance_out: texture_storage_2d<r32float, write>;
#endif
#if SHADOW
@group(0) @binding(3) var linear_clamp: sampler;
@group(0) @binding(10) var cloud_shadow: texture_2d<f32>;
#endif
#if FLOAT
@group(2) @binding(0) var background_out: texture_storage_2d<rgba32float, write>;
#else
@group(2) @binding(0) var background_out: texture_storage_2d<rgba16float, write>;
#endif

// Room for a soft edge of the discs, in radians.
const DISC_MARGIN: f32 = 0.1;

fn sky_with_lights(dir: vec3f) -> vec3f {
  let altitude = max(view.camera.eye.y, 0.0);
  var light = sky_radiance(sky_view, linear_repeat, air, dir);
  // The discs are small: most directions need not look closer.
#if SUN_DISC
  if (dot(dir, air.towards_sun) > cos(air.sun_angular_radius + DISC_MARGIN)) {
    let disc = sun_disc(air, dir, view.sample_angle);
    light += disc * air_transmittance(sky_transmittance, linear_repeat, air, altitude, dir.y);
  }
#endif
#if MOON_DISC
  if (dot(dir, air.towards_moon) > cos(air.moon_angular_radius + DISC_MARGIN)) {
    let disc = moon_disc(air, dir, view.sample_angle);
    light += disc * air_transmittance(sky_transmittance, linear_repeat, air, altitude, dir.y);
  }
#endif
#if STARS
  light += stars(dir) * air_transmittance(sky_transmittance, linear_repeat, air, altitude, dir.y);
#endif
  return light;
}

#if STARS
// A few thousand points, one to a cell of a cube of directions, brighter ones rarer. Cells across an edge of the cube
// belong to no face alone and stay empty.
fn stars(dir: vec3f) -> vec3f {
  let a = abs(dir);
  let major = max(a.x, max(a.y, a.z));
  let q = dir / major * 96.5;
  let cell = vec3i(floor(q + 0.5));
  let random = hash_cell(cell, 77u);
  let centre = normalize(vec3f(cell) + (random - 0.5) * 0.6);
  let miss = length(dir - centre) / max(view.pixel_angle, 4e-4);
  let draw = hash_cell(cell, 78u);
  let magnitude = pow(draw.y, 9.0) + 0.03;
  let tint = mix(vec3f(1.0, 0.82, 0.66), vec3f(0.72, 0.85, 1.1), draw.z);
  return tint * step(0.86, draw.x) * magnitude * view.star_radiance * exp(-miss * miss * 1.6) * step(0.0, dir.y);
}
#endif

#if GROUND
fn ground_height(p: vec2f, distance_m: f32) -> f32 {
#if TERRAIN
  return terrain_height(p, distance_m, linear_repeat);
#else
  return 0.0;
#endif
}

#if TERRAIN
fn clearance_at(p: vec3f, distance_m: f32) -> f32 {
  return altitude_at(p, ground.planet_radius_m) - ground_height(p.xz, distance_m);
}

// Distance to the relief between start and end, or -1: steps by clearance, then halves the last one. Where the ray ends
// in the sea it has met land before, if only in the last step.
fn relief_hit(origin: vec3f, dir: vec3f, start: f32, end: f32, ends_in_sea: bool) -> f32 {
  var t = start;
  var before = start;
  var is_hit = false;
  for (var i = 0u; i < 56u; i++) {
    if (t >= end) {
      t = end;
      is_hit = ends_in_sea;
      break;
    }
    let clearance = clearance_at(origin + dir * t, t);
    if (clearance < 0.001 * t) {
      is_hit = true;
      break;
    }
    before = t;
    t += max(clearance * 0.7, 40.0 + 0.08 * t);
  }
  for (var k = 0u; k < 5u && is_hit; k++) {
    let middle = 0.5 * (before + t);
    let is_above = clearance_at(origin + dir * middle, middle) > 0.0;
    before = select(before, middle, is_above);
    t = select(middle, t, is_above);
  }
  return select(-1.0, max(t, 0.1), is_hit);
}
#endif

// Distance to the ground along a ray, or -1.
fn ground_hit(origin: vec3f, dir: vec3f) -> f32 {
  let sea = shell_roots(origin, dir, 0.0, ground.planet_radius_m);
  let is_down = sea.y > 0.0 && dot(origin, dir) + ground.planet_radius_m * dir.y < 0.0;
  let sea_distance = select(-1.0, max(sea.x, 0.0), is_down);
#if TERRAIN
  let ceiling = shell_roots(origin, dir, ground.highest_m, ground.planet_radius_m);
  let is_above = altitude_at(origin, ground.planet_radius_m) > ground.highest_m;
  let start = select(0.0, max(ceiling.x, 0.0), is_above);
  let end = min(select(max(ceiling.y, 0.0), sea_distance, is_down), ground.reach_m);
  // A ray that stays over the plain, or until it leaves it, meets no relief.
  let flat = max(length(dir.xz), 1e-4);
  let plain_until = max(PLAIN_M - length(ground.plain_at), 0.0) / flat;
  var relief = -1.0;
  if (ground.highest_m > 0.0 && ceiling.y > 0.0 && !(is_down && sea_distance < plain_until)) {
    relief = relief_hit(origin, dir, max(start, plain_until), end, is_down && end == sea_distance);
  }
  return select(sea_distance, relief, relief >= 0.0);
#else
  return sea_distance;
#endif
}

fn ground_normal(p: vec3f, distance_m: f32) -> vec3f {
  var normal = up_at(p, ground.planet_radius_m);
#if TERRAIN
  let e = max(20.0, distance_m * 0.004);
  let here = ground_height(p.xz, distance_m);
  let east = ground_height(p.xz + vec2f(e, 0.0), distance_m) - here;
  let south = ground_height(p.xz + vec2f(0.0, e), distance_m) - here;
  normal -= vec3f(east, 0.0, south) / e;
#endif
  return normalize(normal);
}

// Rock where it is steep or high.
fn with_rock(albedo: vec3f, p: vec3f, normal: vec3f) -> vec3f {
  let height = max(altitude_at(p, ground.planet_radius_m), 0.0);
  let rocky = smoothstep(0.90, 0.72, normal.y) + smoothstep(0.35, 0.8, height / max(ground.mountains_m, 1.0));
  return mix(albedo, ground.rock, clamp(rocky, 0.0, 1.0) * step(1.0, ground.mountains_m));
}

#if SHADOW
// Light that reaches the ground from the sides and bases of clouds, as a part of the sunlight that they keep from it:
// with broken cumulus the sky gives about a third of all light, in clear air a sixth.
const CLOUD_REFLECTION: f32 = 0.6;

// Share of the key light that cloud lets through to a place on the ground, or so far up to the highest solid thing: straight,
// and scattered downwards.
fn light_through_cloud(p: vec3f, raised: f32) -> vec2f {
  let foot = p - ground.towards_light * (p.y / max(ground.towards_light.y, 0.05));
  let uv = foot.xz * ground.shadow_from_world.z + ground.shadow_from_world.xy;
  let edge = clamp((0.5 - max(abs(uv.x - 0.5), abs(uv.y - 0.5))) * 8.0, 0.0, 1.0);
  let texel = textureSampleLevel(cloud_shadow, linear_clamp, uv, 0.0);
  let mapped = mix(texel.xy, vec2f(texel.z, 0.0), raised);
  let beyond = vec2f(ground.mean_shadow, 0.4 * (1.0 - ground.mean_shadow));
  return mix(vec2f(1.0, 0.0), mix(beyond, mapped, edge), ground.shadow_strength);
}
#endif

// Light that a surface sends on; `raised` says how far up it is to the highest solid thing, which stands above some clouds.
fn surface_light(p: vec3f, normal: vec3f, albedo: vec3f, raised: f32) -> vec3f {
  let altitude = max(altitude_at(p, ground.planet_radius_m), 0.0);
  let cosine = light_cos_zenith(p, ground.towards_light, ground.planet_radius_m);
  var key = ground.light_illuminance * light_transmittance(sky_transmittance, linear_repeat, air, altitude, cosine);
  var scattered = vec3f(0.0);
  var from_clouds = vec3f(0.0);
#if SHADOW
  // The sides of the clouds round about light the ground as well, in their shadows most of all.
  from_clouds = key * max(ground.towards_light.y, 0.0) / PI * (1.0 - ground.mean_shadow) * CLOUD_REFLECTION
    * ground.shadow_strength;
  let through = light_through_cloud(p, raised);
  scattered = key * through.y * max(ground.towards_light.y, 0.0) / PI;
  key *= through.x;
#endif
  var sky = (textureLoad(sky_ambient, vec2u(3u, 0u), 0).rgb + from_clouds) * (0.6 + 0.4 * normal.y);
#if SOLIDS
  let open = solid_openness(p, normal, ground.planet_radius_m);
  sky *= open;
  scattered *= open;
  if (dot(normal, ground.towards_light) > 0.0) {
    key *= solid_shadow(p + normal * 0.5, ground.towards_light, shapes.light_radius, ground.planet_radius_m);
  }
#endif
  return albedo * (key * max(dot(normal, ground.towards_light), 0.0) / PI + scattered + sky);
}

#if SOLIDS
// The colour of the solid thing that is nearest to a place.
fn solid_colour(p: vec3f) -> vec3f {
  let place = vec3f(p.x, altitude_at(p, ground.planet_radius_m), p.z);
  var nearest = NO_SHAPE_M;
  var colour = vec3f(0.5);
  for (var i = shapes.clouds; i < shapes.clouds + shapes.solids; i++) {
    let distance = abs(shape_distance(shapes.list[i], place));
    colour = select(colour, shapes.list[i].colour, distance < nearest);
    nearest = min(nearest, distance);
  }
  return colour;
}
#endif

fn ground_light(p: vec3f, dir: vec3f, distance_m: f32) -> vec3f {
  let flat_normal = ground_normal(p, distance_m);
  let place = p.xz - ground.plain_at;
  var wet = 0.5;
#if TERRAIN
  let uv = p.xz * ground.tile_from_world.z + ground.tile_from_world.xy;
  wet = select(wet, textureSampleLevel(terrain_map, linear_repeat, uv, 0.0).z, ground.highest_m > 0.0);
#endif
  let footprint = distance_m * view.sample_angle / max(-dot(flat_normal, dir), 0.01);
  let cover = ground_cover(place, footprint, wet);
  let normal = normalize(flat_normal - vec3f(cover.slope.x, 0.0, cover.slope.y));
  return surface_light(p, normal, with_rock(ground.albedo * cover.tint, p, flat_normal), 0.0);
}
#endif

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let pixel = vec2u(id.x, id.y + band.first_row);
  if (any(pixel >= view.size) || id.y >= band.rows) {
    return;
  }
  let dir = ray_through(view.camera, (vec2f(pixel) + view.pixel_point) / vec2f(view.size));
#if GROUND
  var eye = view.camera.eye;
#if TERRAIN
  // An eye inside a hill sees from above it.
  eye.y = select(eye.y, max(eye.y, ground_height(vec2f(0.0), 0.0) + 2.0), ground.highest_m > 0.0);
#endif
  var hit = ground_hit(eye, dir);
#if SOLIDS
  let solid = solid_hit(eye, dir, select(NO_SHAPE_M, hit, hit >= 0.0), ground.planet_radius_m);
  hit = select(hit, solid, solid >= 0.0);
#endif
  var light: vec3f;
  if (hit >= 0.0) {
    let ahead = aerial_at(sky_aerial_light, sky_aerial_transmittance, linear_repeat, air, dir, hit);
    let p = eye + dir * hit;
#if SOLIDS
    if (solid >= 0.0) {
      let raised = clamp(altitude_at(p, ground.planet_radius_m) / max(ground.receiver_m, 1.0), 0.0, 1.0);
      let normal = solid_normal(p, max(0.5, 3e-4 * hit), ground.planet_radius_m);
      light = surface_light(p, normal, solid_colour(p), raised);
    } else {
      light = ground_light(p, dir, hit);
    }
#else
    light = ground_light(p, dir, hit);
#endif
    light = light * ahead.transmittance + ahead.light;
  } else {
    light = sky_with_lights(dir);
  }
  textureStore(ground_distance_out, pixel, vec4f(hit, 0.0, 0.0, 0.0));
#else
  let light = sky_with_lights(dir);
#endif
#if OPEN
  textureStore(ground_distance_out, pixel, vec4f(-1.0, 0.0, 0.0, 0.0));
#endif
#if FLOAT
  textureStore(background_out, pixel, vec4f(max(light, vec3f(0.0)), 1.0));
#else
  textureStore(background_out, pixel, sanitise4(vec4f(light, 1.0)));
#endif
}
