// Evaluates common/math.wgsl.
#import "common/math.wgsl"
#import "test/eval_io.wgsl"

@compute @workgroup_size(64) fn eval_remap01(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let a = bitcast<vec4f>(cases[id.x].a);
  store(id, vec4f(remap01(a.x, a.y, a.z)));
}

@compute @workgroup_size(64) fn eval_absorption(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let x = bitcast<f32>(cases[id.x].a.x);
  store(id, vec4f(absorption_weight(x), absorbed(x), 0.0, 0.0));
}

@compute @workgroup_size(64) fn eval_sanitise(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let a = bitcast<vec4f>(cases[id.x].a);
  store(id, sanitise4(a));
}

@compute @workgroup_size(64) fn eval_luminance709(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  store(id, vec4f(luminance709(bitcast<vec4f>(cases[id.x].a).xyz)));
}
