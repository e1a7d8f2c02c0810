// One plane of the grid of sun depth, from the plane before it on the side of the light: the cloud between the two along
// the light, and what the plane before it has behind that (short characteristics; Kunasz & Auer 1988). Planes follow each
// other downwards, or for low light along its azimuth.
#import "generated/BandUniforms.wgsl"
#import "pass/sun_depth.wgsl"
#import "pass/sun_grid.wgsl"

// Which plane.
@group(0) @binding(0) var<uniform> band: BandUniforms;
// Two planes that take turns.
@group(2) @binding(0) var<storage, read_write> planes: array<f32>;
@group(2) @binding(1) var sun_depths_out: texture_storage_3d<rgba16float, write>;

// A sample stands for so much of the way, relative to a cell; and most samples between two planes.
const SAMPLE_CELLS: f32 = 0.75;
const MOST_SAMPLES: u32 = 8u;
// Samples from the first plane out of the clouds, where that is not their top.
const FIRST_SAMPLES: u32 = 16u;
// Keeps depths finite.
const DEEPEST: f32 = 1e6;

fn plane_value(at: vec2u, plane: u32, size: vec2u) -> f32 {
  return planes[((plane & 1u) * size.y + at.y) * size.x + at.x];
}

// Weights of four nodes at a fraction between the middle two, nodes `low` and the next (Catmull & Rom 1974). Beyond the
// first and the last node values go on as between the two before.
fn cubic_weights(f: f32, low: u32, last: u32) -> vec4f {
  let g = 1.0 - f;
  let w = vec4f(-0.5 * f * g * g, 1.0 + f * f * (1.5 * f - 2.5), 1.0 + g * g * (1.5 * g - 2.5), -0.5 * g * f * f);
  let before = select(0.0, w.x, low == 0u);
  let behind = select(0.0, w.w, low + 2u > last);
  return w + vec4f(-before, 2.0 * before - behind, 2.0 * behind - before, -behind);
}

// Cubic, as linear reads would blur the planes a little more each time; never beyond the four nodes about the place.
fn value_ahead(node: vec2f, plane: u32, size: vec2u) -> f32 {
  let low = min(vec2u(node), size - 1u);
  let f = node - vec2f(low);
  let across = cubic_weights(f.x, low.x, size.x - 1u);
  let along = cubic_weights(f.y, low.y, size.y - 1u);
  var value = 0.0;
  var least = 1e9;
  var most = 0.0;
  for (var j = 0u; j < 4u; j++) {
    for (var i = 0u; i < 4u; i++) {
      let at = min(max(low + vec2u(i, j), vec2u(1u)) - 1u, size - 1u);
      let own = plane_value(at, plane, size);
      value += across[i] * along[j] * own;
      if ((i == 1u || i == 2u) && (j == 1u || j == 2u)) {
        least = min(least, own);
        most = max(most, own);
      }
    }
  }
  return clamp(value, least, most);
}

// Distance along the light to the plane ahead.
fn way_ahead(p: vec3f, node: vec3u) -> f32 {
  let last = scene.sun_grid_form.zw - 1.0;
  if (scene.sun_grid_is_low == 0u) {
    let altitude = mix(scene.lowest_m, scene.highest_m, f32(node.y + 1u) / last.y);
    if (DOMAIN == DOMAIN_SHELL) {
      return max(shell_roots(p, scene.towards_light, altitude, scene.planet_radius_m).y, 0.0);
    }
    return (altitude - p.y) / scene.towards_light.y;
  }
  let ends = sun_grid_offset(2.0 * vec2f(f32(node.x), f32(node.x + 1u)) / last.x - 1.0);
  return (ends.y - ends.x) / length(scene.towards_light.xz);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let cells = vec2u(scene.sun_grid_form.zw);
  let size = select(cells, cells.xx, scene.sun_grid_is_low == 0u);
  if (any(id.xy >= size)) {
    return;
  }
  let plane = band.first_row;
  let node = select(vec3u(plane, id.y, id.x), vec3u(id.x, plane, id.y), scene.sun_grid_is_low == 0u);
  let is_first = plane + 1u == select(cells.x, cells.y, scene.sun_grid_is_low == 0u);
  let p = sun_grid_position(vec3f(node));
  let out = domain_exit(p, scene.towards_light);
  var way = min(out, scene.light_reach_m);
  var samples = FIRST_SAMPLES;
  if (!is_first) {
    way = min(way_ahead(p, node), out);
    samples = clamp(u32(ceil(way / (SAMPLE_CELLS * sun_grid_cell(p)))), 1u, MOST_SAMPLES);
  }
  let step = way / f32(samples);
  let level = max(0.0, log2(step / FINEST_STEP_M) * 0.5);
  var depth = 0.0;
  if (!is_first || scene.sun_grid_is_low == 1u) {
    for (var i = 0u; i < samples; i++) {
      let q = p + scene.towards_light * ((f32(i) + 0.5) * step);
      depth += shadow_extinction(q, Reading(level, false, 0.0, vec3f(0.0))) * step;
    }
  }
  if (!is_first) {
    let ahead = sun_grid_node(p + scene.towards_light * way);
    depth += sun_grid_depth(value_ahead(select(ahead.zy, ahead.xz, scene.sun_grid_is_low == 0u), plane + 1u, size));
  }
  depth = min(depth, DEEPEST);
  let value = log(1.0 + depth);
  planes[((plane & 1u) * size.y + id.y) * size.x + id.x] = value;
  textureStore(sun_depths_out, node, vec4f(value));
}
