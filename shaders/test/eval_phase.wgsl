// Evaluates cloud/phase.wgsl. Case: a = view direction, b = direction to the sun and the anisotropy scale,
// c = g, back_g, back_mix, and the kind as an integer in c.w.
#import "cloud/phase.wgsl"
#import "test/eval_io.wgsl"

@compute @workgroup_size(64) fn eval_phase(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let view_dir = bitcast<vec4f>(cases[id.x].a).xyz;
  let sun = bitcast<vec4f>(cases[id.x].b);
  let c = bitcast<vec4f>(cases[id.x].c);
  let shape = PhaseShape(cases[id.x].c.w, c.x, c.y, c.z);
  store(id, vec4f(phase(shape, view_dir, sun.xyz), phase_scaled(shape, sun.w, view_dir, sun.xyz), 0.0, 0.0));
}
