// The greatest density of the automaton about a place of the map and between two heights of its layer, 0..1: of its cells in
// the same 64th of the map and those beside it.
@group(1) @binding(22) var automaton_bound: texture_3d<f32>;

// Shares of generations sum to 1 but for rounding.
const ROUNDING: f32 = 1.0001;

fn greatest_of_automaton(uv: vec2f, low: f32, high: f32) -> f32 {
  let size = vec3i(textureDimensions(automaton_bound));
  let at = min(vec2i((uv - floor(uv)) * vec2f(size.xz)), size.xz - 1);
  let first = clamp(i32(floor(low * f32(size.y))), 0, size.y - 1);
  let last = clamp(i32(floor(high * f32(size.y))), 0, size.y - 1);
  var greatest = 0.0;
  for (var k = first; k <= last; k++) {
    greatest = max(greatest, textureLoad(automaton_bound, vec3i(at.x, k, at.y), 0).x);
  }
  return greatest * ROUNDING;
}
