// Evaluates common/random.wgsl.
#import "common/random.wgsl"
#import "test/eval_io.wgsl"

@compute @workgroup_size(64) fn eval_pcg3d(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  results[id.x] = vec4u(pcg3d(cases[id.x].a.xyz), 0u);
}

@compute @workgroup_size(64) fn eval_hash_cell(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let a = cases[id.x].a;
  store(id, vec4f(hash_cell(bitcast<vec3i>(a.xyz), a.w), unit_from_bits(a.w)));
}
