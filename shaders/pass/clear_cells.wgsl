// Where layers may have cloud: 0 in cells of the weather map and of heights that may hold some, far in all others; a
// channel for each layer. From this pass/clear_row.wgsl and pass/clear_spread.wgsl find how far it is to cloud.
#if AUTOMATON
#import "pass/automaton_greatest.wgsl"
#endif
#import "pass/cloud_field.wgsl"
#import "generated/BandUniforms.wgsl"
#import "pass/clear_way.wgsl"

@group(0) @binding(1) var<uniform> band: BandUniforms;
@group(2) @binding(0) var ways_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let cells = textureDimensions(ways_out);
  let at = id.xy + vec2u(0u, band.first_row);
  if (any(at >= cells.xz) || id.y >= band.rows) {
    return;
  }
  // Linear filtering reaches a texel beyond the cell.
  let size = vec2i(textureDimensions(weather_map));
  let across = size / vec2i(cells.xz);
  let corner = vec2i(at) * across - 1;
  var field = 0.0;
  var possible = PossibleTypes(vec3f(0.0), 0.0);
  for (var y = 0; y < across.y + 2; y++) {
    for (var x = 0; x < across.x + 2; x++) {
      let texel = textureLoad(weather_map, (corner + vec2i(x, y) + size) % size, 0);
      field = max(field, texel.r + texel.g + texel.b);
      possible.types = max(possible.types, step(vec3f(1e-6), texel.rgb));
      possible.variation = max(possible.variation, texel.a);
    }
  }
  for (var k = 0u; k < cells.y; k++) {
    let heights = vec2f(f32(k), f32(k) + 1.0) / f32(cells.y);
    var way = vec4f(FARTHEST_M);
    for (var i = 0u; i < LAYERS; i++) {
      let layer = scene.layers[i];
      var body = greatest_body(layer, field);
#if AUTOMATON
      if (layer.model == MODEL_AUTOMATON) {
        let uv = (vec2f(at) + 0.5) / vec2f(cells.xz);
        body *= greatest_of_automaton(uv, heights.x, heights.y);
      }
#endif
      if (density_bound_between(layer, body, possible, heights.x, heights.y) > 0.0) {
        way[i] = 0.0;
      }
    }
    textureStore(ways_out, vec3u(at.x, k, at.y), way);
  }
}
