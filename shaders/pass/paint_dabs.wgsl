// Dabs of one stroke on a painted layer of the weather map: those that add, and those that take away.
#import "pass/painted.wgsl"

@group(1) @binding(0) var<uniform> paint: PaintUniforms;
@group(1) @binding(1) var<storage, read> dabs: array<vec2f>;
@group(2) @binding(0) var<storage, read_write> painted: array<Painted>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (any(id.xy >= paint.extent)) {
    return;
  }
  let side = i32(paint.side);
  let texel = on_map(side, paint.first + vec2i(id.xy));
  let index = texel.y * side + texel.x;
  var here = painted[index];
  for (var i = 0u; i < paint.count; i++) {
    let share = share_of(paint, vec2f(texel) + 0.5 - dabs[i]);
    if (paint.restores != 0u) {
      here.taken *= 1.0 - share;
      here.added *= 1.0 - share;
      here.shift *= 1.0 - share;
      here.smoothing *= (1.0 - share) * (1.0 - share);
    } else {
      here.taken += share * paint.reaches * (1.0 - here.taken);
      let reached = share * paint.reaches.xxxy;
      here.added += reached * (paint.goal - here.added);
    }
  }
  painted[index] = here;
}
