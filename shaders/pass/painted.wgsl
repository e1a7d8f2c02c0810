// What was painted on a texel of the weather map: the map below, seen from where it was moved, smoothed and in part taken
// away, and what was added over it.
#import "generated/PaintUniforms.wgsl"

struct Painted {
  added: vec4f,
  // How much of what lies below was taken away: of the clouds, and of how they vary.
  taken: vec2f,
  // Where the map below is read, from here, in edges of the map.
  shift: vec2f,
  // Over how many texels the map below is smoothed: the square of the standard deviation.
  smoothing: f32,
  pad0: f32,
  pad1: f32,
  pad2: f32,
}

// What lies beyond the map's edge: the map again, its outermost texels, or nothing.
const REPEATS: u32 = 0u;
const CLEAR: u32 = 2u;

// A way between two places in texels; where the map repeats, the shortest.
fn shortest(paint: PaintUniforms, way: vec2f) -> vec2f {
  let side = f32(paint.side);
  return way - select(vec2f(0.0), round(way / side) * side, paint.edge == REPEATS);
}

// How much of a dab there is so far from its middle, in texels.
fn share_of(paint: PaintUniforms, apart: vec2f) -> f32 {
  let distance = length(shortest(paint, apart)) / (paint.radius * f32(paint.side));
  let inside = clamp((1.0 - distance) / max(paint.softness, 1e-3), 0.0, 1.0);
  return paint.strength * inside * inside * (3.0 - 2.0 * inside);
}

// The texel of the map that one beyond its edge is, where it repeats.
fn on_map(side: i32, texel: vec2i) -> vec2i {
  return ((texel % side) + side) % side;
}

// The index of a texel that may lie beyond the map's edge.
fn index_of(side: i32, repeats: bool, texel: vec2i) -> i32 {
  let inside = select(clamp(texel, vec2i(0), vec2i(side - 1)), on_map(side, texel), repeats);
  return inside.y * side + inside.x;
}
