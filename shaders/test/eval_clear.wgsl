// Evaluates the promise of clear air. Case: a = position, b = an offset of length 0..1. Results: how far from the position
// towards the offset the map promises no cloud, and the extinction at the position moved by that way times the offset, and by three ways.
#import "pass/cloud_field.wgsl"
#import "test/eval_io.wgsl"

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) at: vec3u) {
  let id = vec3u(at.x + at.y * 512u, 0u, 0u);
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let offset = bitcast<vec4f>(cases[id.x].b).xyz;
  let all = Reading(0.0, true, 0.0, normalize(offset));
  clear_way = FAR_M;
  let here = extinction_of(densities_at(p, all));
  // Without end where no layer is ahead before the ground.
  var ahead = min(clear_way, 60000.0);
  let ground = shell_roots(p, normalize(offset), 0.0, scene.planet_radius_m);
  if (DOMAIN == DOMAIN_SHELL && ground.x > 0.0) {
    ahead = min(ahead, ground.x);
  }
  let way = select(ahead, 0.0, here > 0.0);
  let there = extinction_of(densities_at(p + offset * way, all));
  let beyond = extinction_of(densities_at(p + offset * 3.0 * way, all));
  store(id, vec4f(way, there, beyond, here));
}
