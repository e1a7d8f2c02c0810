// Evaluates pass/majorant.wgsl where it is bound to real textures. Case: a = position, b = an offset of length 0..1.
// Results: the majorant at the position, its reach, and the extinction at the position moved by reach times the offset.
#import "pass/majorant.wgsl"
#import "test/eval_io.wgsl"

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) at: vec3u) {
  let id = vec3u(at.x + at.y * 512u, 0u, 0u);
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let offset = bitcast<vec4f>(cases[id.x].b).xyz;
  let majorant = majorant_at(p, normalize(offset));
  let q = p + offset * min(majorant.reach_m, 5000.0);
  let extinction = extinction_of(densities_at(q, Reading(0.0, true, 0.0, vec3f(0.0))));
  store(id, vec4f(majorant.extinction_per_m, majorant.reach_m, extinction, 0.0));
}
