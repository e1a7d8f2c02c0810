// The greatest density of the automaton in each cell of a coarse grid and the cells beside it, in whatever generation is shown.
@group(1) @binding(0) var automaton_cells: texture_3d<f32>;
@group(2) @binding(0) var bound_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let coarse = vec3i(textureDimensions(bound_out));
  if (any(vec3i(id) >= coarse)) {
    return;
  }
  let fine = vec3i(textureDimensions(automaton_cells));
  // Linear filtering reaches a cell beyond. Upwards, cells beside it are asked for by themselves.
  let beside = vec3i(1, 0, 1);
  let first = vec3i(floor(vec3f((vec3i(id) - beside) * fine) / vec3f(coarse))) - 1;
  let last = vec3i(ceil(vec3f((vec3i(id) + 1 + beside) * fine) / vec3f(coarse)));
  var greatest = 0.0;
  for (var z = first.z; z <= last.z; z++) {
    for (var y = max(first.y, 0); y <= min(last.y, fine.y - 1); y++) {
      for (var x = first.x; x <= last.x; x++) {
        let at = vec3i(((x % fine.x) + fine.x) % fine.x, y, ((z % fine.z) + fine.z) % fine.z);
        let shown = textureLoad(automaton_cells, at, 0);
        greatest = max(greatest, max(max(shown.x, shown.y), max(shown.z, shown.w)));
      }
    }
  }
  textureStore(bound_out, id, vec4f(greatest, 0.0, 0.0, 0.0));
}
