// Dabs of one stroke that move what a painted layer and the map below it have: along the stroke, or about each dab's middle.
// Every texel goes back the way that the dabs have moved it, the last one first, and takes what was there.
#import "pass/painted.wgsl"

@group(1) @binding(0) var<uniform> paint: PaintUniforms;
@group(1) @binding(1) var<storage, read> dabs: array<vec2f>;
@group(1) @binding(2) var<storage, read> kept: array<Painted>;
@group(2) @binding(0) var<storage, read_write> painted: array<Painted>;

// The first dab of the array is where the stroke was before; with 0 for `grows` dabs move along it.
fn moved_by(i: u32, at: vec2f) -> vec2f {
  if (paint.grows != 0.0) {
    return shortest(paint, at - dabs[i]) * paint.grows * share_of(paint, at - dabs[i]);
  }
  let way = shortest(paint, dabs[i] - dabs[i - 1u]);
  // Farther apart the stroke was interrupted.
  let is_way = length(way) <= paint.radius * f32(paint.side);
  return select(vec2f(0.0), way, is_way) * share_of(paint, at - dabs[i]);
}

fn between(a: Painted, b: Painted, share: f32) -> Painted {
  return Painted(
    mix(a.added, b.added, share), mix(a.taken, b.taken, share), mix(a.shift, b.shift, share),
    mix(a.smoothing, b.smoothing, share), 0.0, 0.0, 0.0,
  );
}

fn kept_at(at: vec2f) -> Painted {
  let corner = floor(at - 0.5);
  let share = at - 0.5 - corner;
  let side = i32(paint.side);
  let repeats = paint.edge == REPEATS;
  var rows: array<Painted, 2>;
  for (var y = 0; y < 2; y++) {
    let left = kept[index_of(side, repeats, vec2i(corner) + vec2i(0, y))];
    let right = kept[index_of(side, repeats, vec2i(corner) + vec2i(1, y))];
    rows[y] = between(left, right, share.x);
  }
  return between(rows[0], rows[1], share.y);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (any(id.xy >= paint.extent)) {
    return;
  }
  let side = i32(paint.side);
  let texel = on_map(side, paint.first + vec2i(id.xy));
  let here = vec2f(texel) + 0.5;
  var at = here;
  for (var i = paint.count; i > 1u; i--) {
    at -= moved_by(i - 1u, at);
  }
  let index = texel.y * side + texel.x;
  if (all(at == here)) {
    painted[index] = kept[index];
  } else if (paint.edge == CLEAR && any(at != clamp(at, vec2f(0.0), vec2f(f32(paint.side))))) {
    // From beyond a map that ends comes no cloud.
    let before = kept[index];
    let taken = vec2f(1.0, before.taken.y);
    painted[index] = Painted(before.added * vec4f(0.0, 0.0, 0.0, 1.0), taken, vec2f(0.0), 0.0, 0.0, 0.0, 0.0);
  } else {
    var moved = kept_at(at);
    moved.shift += (at - here) / f32(paint.side);
    painted[index] = moved;
  }
}
