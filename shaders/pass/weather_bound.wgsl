// The greatest field of the weather map in each cell and the cells around it: where it is too low for a body, a ray may
// take a step as long as a cell.
@group(1) @binding(0) var weather_map: texture_2d<f32>;
@group(2) @binding(0) var bound_out: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let cells = textureDimensions(bound_out);
  if (any(id.xy >= cells)) {
    return;
  }
  let size = vec2i(textureDimensions(weather_map));
  let cell = size / vec2i(cells);
  let corner = (vec2i(id.xy) - 1) * cell;
  var greatest = 0.0;
  for (var y = 0; y < 3 * cell.y; y++) {
    for (var x = 0; x < 3 * cell.x; x++) {
      let texel = textureLoad(weather_map, (corner + vec2i(x, y) + size) % size, 0);
      greatest = max(greatest, texel.r + texel.g + texel.b);
    }
  }
  textureStore(bound_out, id.xy, vec4f(greatest, 0.0, 0.0, 0.0));
}
