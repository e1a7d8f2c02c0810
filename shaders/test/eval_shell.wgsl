// Evaluates common/shell.wgsl. Case: a = position, b = direction, then the numbers of the domain.
#import "common/shell.wgsl"
#import "test/eval_io.wgsl"

fn store_segments(id: vec3u, segments: Segments) {
  store(id, vec4f(segments.first, segments.second));
}

// c = layer altitude, radius.
@compute @workgroup_size(64) fn eval_shell_roots(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let dir = bitcast<vec4f>(cases[id.x].b).xyz;
  let c = bitcast<vec4f>(cases[id.x].c);
  store(id, vec4f(shell_roots(p, dir, c.x, c.y), altitude_at(p, c.y), up_at(p, c.y).y));
}

// c = base, top, radius.
@compute @workgroup_size(64) fn eval_shell_segments(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let dir = bitcast<vec4f>(cases[id.x].b).xyz;
  let c = bitcast<vec4f>(cases[id.x].c);
  store_segments(id, shell_segments(p, dir, c.x, c.y, c.z));
}

// c = base, top.
@compute @workgroup_size(64) fn eval_slab_segments(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let dir = bitcast<vec4f>(cases[id.x].b).xyz;
  let c = bitcast<vec4f>(cases[id.x].c);
  store_segments(id, slab_segments(p, dir, c.x, c.y));
}

// c = lower corner, d = upper corner.
@compute @workgroup_size(64) fn eval_box_segments(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let dir = bitcast<vec4f>(cases[id.x].b).xyz;
  let low = bitcast<vec4f>(cases[id.x].c).xyz;
  let high = bitcast<vec4f>(cases[id.x].d).xyz;
  store_segments(id, box_segments(p, dir, low, high));
}
