// Evaluates cloud/phase_sample.wgsl. Case: a = view direction, b = bits to start from, c = g, back_g, back_mix, and the
// kind as an integer in c.w. Result: the direction drawn, and its cosine to the view direction.
#import "cloud/phase_sample.wgsl"
#import "test/eval_io.wgsl"

@compute @workgroup_size(64) fn eval_phase_sample(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let view_dir = bitcast<vec4f>(cases[id.x].a).xyz;
  let c = bitcast<vec4f>(cases[id.x].c);
  let dir = sample_phase(PhaseShape(cases[id.x].c.w, c.x, c.y, c.z), view_dir, cases[id.x].b.xyz);
  store(id, vec4f(dir, dot(dir, view_dir)));
}
