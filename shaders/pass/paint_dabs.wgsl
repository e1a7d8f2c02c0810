// Dabs of one stroke on a painted layer of the weather map. Two vectors to a texel: what was added, and how much of what lies
// below was taken away, of the clouds in x and of how they vary in y.
#import "generated/PaintUniforms.wgsl"

@group(1) @binding(0) var<uniform> paint: PaintUniforms;
@group(1) @binding(1) var<storage, read> dabs: array<vec2f>;
@group(2) @binding(0) var<storage, read_write> painted: array<vec4f>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (any(id.xy >= paint.extent)) {
    return;
  }
  let side = i32(paint.side);
  let texel = ((paint.first + vec2i(id.xy)) % side + side) % side;
  let index = 2 * (texel.y * side + texel.x);
  var added = painted[index];
  var taken = painted[index + 1].xy;
  for (var i = 0u; i < paint.count; i++) {
    // Where the map repeats, the nearest of the dab's copies.
    let apart = (vec2f(texel) + 0.5 - dabs[i]) / f32(side);
    let distance = length(apart - select(vec2f(0.0), round(apart), paint.repeats != 0u)) / paint.radius;
    let inside = clamp((1.0 - distance) / max(paint.softness, 1e-3), 0.0, 1.0);
    let share = paint.strength * inside * inside * (3.0 - 2.0 * inside);
    if (paint.restores != 0u) {
      taken *= 1.0 - share;
      added *= 1.0 - share;
    } else {
      taken += share * paint.reaches * (1.0 - taken);
      let reached = share * paint.reaches.xxxy;
      added += reached * (paint.goal - added);
    }
  }
  painted[index] = added;
  painted[index + 1] = vec4f(taken, 0.0, 0.0);
}
