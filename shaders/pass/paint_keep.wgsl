// A painted layer as it is, kept: what a stroke moves and smooths is taken from there.
#import "pass/painted.wgsl"

@group(1) @binding(0) var<uniform> paint: PaintUniforms;
@group(1) @binding(1) var<storage, read> painted: array<Painted>;
@group(2) @binding(0) var<storage, read_write> kept: array<Painted>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (any(id.xy >= vec2u(paint.side))) {
    return;
  }
  let index = id.y * paint.side + id.x;
  kept[index] = painted[index];
}
