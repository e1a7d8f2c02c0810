// Where the nodes of the grid of sun depth lie: along the light's azimuth, upwards, and across it. Nodes lie on the ends
// of all three axes. Sideways they are the farther apart the farther from the middle they are (a hyperbolic sine), so that
// near clouds have small cells and far ones have any.
#import "pass/cloud_field.wgsl"

// Lengths along the light's azimuth and across it, by how far a node is from the middle: -1..1.
fn sun_grid_offset(s: vec2f) -> vec2f {
  let x = s * scene.sun_grid_form.y;
  return scene.sun_grid_form.x * 0.5 * (exp(x) - exp(-x));
}

// And back.
fn sun_grid_share(offset: vec2f) -> vec2f {
  let x = abs(offset) / scene.sun_grid_form.x;
  return sign(offset) * log(x + sqrt(x * x + 1.0)) / scene.sun_grid_form.y;
}

// From the middle, along the light's azimuth and across it, to x and z; both ways, as the turn is a mirror.
fn sun_grid_turned(v: vec2f) -> vec2f {
  let azimuth = scene.sun_grid_place.zw;
  return vec2f(dot(v, azimuth), v.x * azimuth.y - v.y * azimuth.x);
}

// The node at a place, as a fraction.
fn sun_grid_node(p: vec3f) -> vec3f {
  let last = scene.sun_grid_form.zw - 1.0;
  let share = sun_grid_share(sun_grid_turned(p.xz - scene.sun_grid_place.xy));
  let h = (altitude_of(p) - scene.lowest_m) / max(scene.highest_m - scene.lowest_m, 1e-3);
  return clamp(vec3f(0.5 + 0.5 * share, h), vec3f(0.0), vec3f(1.0)).xzy * last.xyx;
}

// The place of a node.
fn sun_grid_position(node: vec3f) -> vec3f {
  let last = scene.sun_grid_form.zw - 1.0;
  let share = 2.0 * node.xz / last.x - 1.0;
  let xz = scene.sun_grid_place.xy + sun_grid_turned(sun_grid_offset(share));
  let altitude = mix(scene.lowest_m, scene.highest_m, node.y / last.y);
  if (DOMAIN != DOMAIN_SHELL) {
    return vec3f(xz.x, altitude, xz.y);
  }
  // On the sphere of that altitude: (R + y)^2 = (R + altitude)^2 - r^2, where the large radius cancels.
  let radius = scene.planet_radius_m + altitude;
  let squared = dot(xz, xz);
  let sagitta = squared / (radius + sqrt(max(radius * radius - squared, 0.0)));
  return vec3f(xz.x, altitude - sagitta, xz.y);
}

// The longest side of the cell about a place.
fn sun_grid_cell(p: vec3f) -> f32 {
  let last = scene.sun_grid_form.zw - 1.0;
  let out = sun_grid_turned(p.xz - scene.sun_grid_place.xy) / scene.sun_grid_form.x;
  let far = max(abs(out.x), abs(out.y));
  let across = 2.0 * scene.sun_grid_form.x * scene.sun_grid_form.y / last.x * sqrt(1.0 + far * far);
  return max(across, (scene.highest_m - scene.lowest_m) / last.y);
}

// Nodes hold ln(1 + depth): between a node in the sun and one behind much cloud light comes through, as it does through part
// of what lies between them, where the mean of their depths would let none.
fn sun_grid_depth(value: f32) -> f32 {
  return exp(value) - 1.0;
}

// Whether the grid reaches as far as a place.
fn sun_grid_holds(p: vec3f) -> bool {
  let share = sun_grid_share(sun_grid_turned(p.xz - scene.sun_grid_place.xy));
  return all(abs(share) < vec2f(0.93));
}
