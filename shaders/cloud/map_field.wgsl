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

struct MapField {
  // How deep inside a cloud, 0..1; the share of places above 1 - c is about c.
  depth: f32,
  // The cell that the place belongs to.
  cell: u32,
  // Slow variation, 0..1.
  region: f32,
}

fn map_field_at(p: vec3f, map: MapUniforms) -> MapField {
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
  return MapField(spread_evenly(field), large.id, region);
}

// The channels of cloud/weather.wgsl.
fn map_texel_at(uv: vec2f, map: MapUniforms) -> vec4f {
  let field = map_field_at(vec3f(uv, map.phase), map);
  return vec4f(field.depth * type_of_cell(field.cell, map), smoothstep(0.3, 0.75, field.region));
}

// The channels of cloud/costa.wgsl: Perlin noise makes bases less polished and tops diverse (Costa 2023, section 3.1.1).
// Altitude and height together stay below 1.
fn weather_texture_at(uv: vec2f, map: MapUniforms) -> vec4f {
  let p = vec3f(uv, map.phase);
  let field = map_field_at(p, map);
  let rough = clamp(perlin_fbm(p, 12, 3, map.seed * 16u + 12u) + 0.5, 0.0, 1.0);
  let altitude = 0.3 * smoothstep(0.25, 0.8, rough);
  let height = (0.25 + 0.45 * smoothstep(0.3, 0.75, field.region) + 0.3 * rough) * sqrt(field.depth);
  return vec4f(field.depth, min(height, 1.0 - altitude), altitude, 0.0);
}
