// Solid things on the ground and in the air: where rays meet them, how they are lit, and what they keep from what is around
// them (Thomann 2020, sections 4.5 to 4.9).
#import "pass/shapes_distance.wgsl"
#import "common/shell.wgsl"

@group(0) @binding(11) var<uniform> shapes: ShapesUniforms;

const MOST_SOLID_STEPS: u32 = 160u;
const MOST_SHADOW_STEPS: u32 = 48u;
// Nearer than this part of the way, a ray has met a thing.
const SOLID_TOUCH: f32 = 2e-4;

fn solid_distance(p: vec3f, planet_radius_m: f32) -> f32 {
  return solid_shapes_distance(vec3f(p.x, altitude_at(p, planet_radius_m), p.z));
}

// Distance along a ray to the first thing before `end`, or -1.
fn solid_hit(origin: vec3f, dir: vec3f, end: f32, planet_radius_m: f32) -> f32 {
  var t = 0.0;
  for (var i = 0u; i < MOST_SOLID_STEPS; i++) {
    let distance = solid_distance(origin + dir * t, planet_radius_m);
    let touch = max(SOLID_TOUCH * t, 0.05);
    if (distance < touch) {
      return max(t, 0.1);
    }
    t += distance;
    if (t > end) {
      return -1.0;
    }
  }
  // Along a surface steps are short: what they have come to is as near as can be told.
  return select(-1.0, t, solid_distance(origin + dir * t, planet_radius_m) < 0.01 * t);
}

// Outwards from a surface, by differences over an edge of so many metres.
fn solid_normal(p: vec3f, edge: f32, planet_radius_m: f32) -> vec3f {
  let e = vec2f(edge, -edge);
  // Four corners of a cube are enough for a gradient.
  let gradient = e.xyy * solid_distance(p + e.xyy, planet_radius_m) + e.yyx * solid_distance(p + e.yyx, planet_radius_m)
    + e.yxy * solid_distance(p + e.yxy, planet_radius_m) + e.xxx * solid_distance(p + e.xxx, planet_radius_m);
  let size = length(gradient);
  return select(vec3f(0.0, 1.0, 0.0), gradient / max(size, 1e-20), size > 1e-20);
}

// Share of a light's disc that things leave free from a place, 0..1: how near they come to the ray, over the way to there
// (Thomann 2020, section 4.7, with the disc's own radius for its factor).
fn solid_shadow(p: vec3f, towards: vec3f, angular_radius: f32, planet_radius_m: f32) -> f32 {
  var t = 1.0;
  var free = 1.0;
  for (var i = 0u; i < MOST_SHADOW_STEPS; i++) {
    let distance = solid_distance(p + towards * t, planet_radius_m);
    free = min(free, 0.5 + 0.5 * distance / (max(angular_radius, 1e-3) * t));
    if (free <= 0.0 || t > 60000.0) {
      break;
    }
    t += max(distance, 0.5 + 0.01 * t);
  }
  let share = clamp(free, 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

// Share of the sky that things leave free above a surface, 0..1: whether distances grow as fast as the way along the normal
// (Thomann 2020, section 4.9).
fn solid_openness(p: vec3f, normal: vec3f, planet_radius_m: f32) -> f32 {
  var covered = 0.0;
  var weight = 0.5;
  var way = 4.0;
  for (var i = 0u; i < 5u; i++) {
    covered += weight * max(way - solid_distance(p + normal * way, planet_radius_m), 0.0) / way;
    weight *= 0.62;
    way *= 3.0;
  }
  return clamp(1.0 - covered * 0.85, 0.0, 1.0);
}
