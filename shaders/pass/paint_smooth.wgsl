// Dabs of one stroke that smooth what was painted, and the map below it.
#import "common/spiral.wgsl"
#import "pass/painted.wgsl"

@group(1) @binding(0) var<uniform> paint: PaintUniforms;
@group(1) @binding(1) var<storage, read> dabs: array<vec2f>;
@group(1) @binding(2) var<storage, read> kept: array<Painted>;
@group(2) @binding(0) var<storage, read_write> painted: array<Painted>;

// The dabs of a call smooth over so much of their radius, and over no more than so many texels; the map below is not smoothed
// over more by all strokes together.
const WIDTH: f32 = 0.25;
const WIDEST: f32 = 8.0;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (any(id.xy >= paint.extent)) {
    return;
  }
  let side = i32(paint.side);
  let texel = on_map(side, paint.first + vec2i(id.xy));
  var rest = 1.0;
  for (var i = 1u; i < paint.count; i++) {
    rest *= 1.0 - share_of(paint, vec2f(texel) + 0.5 - dabs[i]);
  }
  let index = texel.y * side + texel.x;
  var here = kept[index];
  let width = min(WIDTH * paint.radius * f32(paint.side), WIDEST) * (1.0 - rest);
  if (width > 0.0) {
    var sum = Painted();
    for (var i = 0u; i < SPIRAL_COUNT; i++) {
      let near = kept[index_of(side, paint.edge == REPEATS, texel + vec2i(round(spiral(i) * width)))];
      sum.added += near.added;
      sum.taken += near.taken;
      sum.shift += near.shift;
      sum.smoothing += near.smoothing;
    }
    let part = 1.0 / f32(SPIRAL_COUNT);
    let mean = sum.smoothing * part;
    let smoothing = max(mean, min(mean + width * width, WIDEST * WIDEST));
    here = Painted(sum.added * part, sum.taken * part, sum.shift * part, smoothing, 0.0, 0.0, 0.0);
  }
  painted[index] = here;
}
