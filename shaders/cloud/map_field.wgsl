// What a generated weather map holds at a place; see cloud/weather.wgsl for the channels.
#import "generated/MapUniforms.wgsl"
#import "noise/fractal.wgsl"

// The raw field is roughly normal; this spreads it so that the share above 1 - c is about c.
fn spread_evenly(field: f32) -> f32 {
  return 1.0 / (1.0 + exp(-9.5 * (field - 0.455)));
}

// Cumulus, stratus or stratocumulus, drawn for a cell by the user's weights.
fn type_of_cell(id: u32, map: MapUniforms) -> vec3f {
  let sum = max(map.cumulus + map.stratus + map.stratocumulus, 1e-6);
  let draw = unit_from_bits(pcg3d(vec3u(id, map.seed, 5u)).x) * sum;
  if (draw < map.stratus) {
    return vec3f(0.0, 1.0, 0.0);
  }
  if (draw < map.stratus + map.stratocumulus) {
    return vec3f(0.0, 0.0, 1.0);
  }
  return vec3f(1.0, 0.0, 0.0);
}

fn map_texel_at(uv: vec2f, map: MapUniforms) -> vec4f {
  let p = vec3f(uv, map.phase);
  let cells = i32(map.large_cells);
  let region = clamp(perlin_fbm(p, 3, 4, map.seed * 16u) * 1.1 + 0.5, 0.0, 1.0);
  let large = worley_cell(p, cells, map.seed * 16u + 5u);
  let w1 = clamp(1.0 - large.f1, 0.0, 1.0);
  let w2 = worley(p, cells * 7 / 3, map.seed * 16u + 6u);
  let w3 = worley(p, cells * 5, map.seed * 16u + 7u);
  let fray = clamp(perlin_fbm(p, 12, 4, map.seed * 16u + 8u) + 0.5, 0.0, 1.0) - 0.5;
  let fields = w1 * 0.55 + w2 * 0.3 + w3 * 0.15;
  let puffs = w2 * 0.55 + w3 * 0.45;
  let middle = mix(-0.2, 1.2, map.small_share);
  let size = smoothstep(middle - 0.15, middle + 0.15, region);
  let cellular = mix(puffs * 0.92, fields * 1.06, size);
  let field = mix(cellular, region, 0.8 * map.contrast) + fray * 0.63 * map.fray;
  let variation = smoothstep(0.3, 0.75, region);
  return vec4f(spread_evenly(field) * type_of_cell(large.id, map), variation);
}
