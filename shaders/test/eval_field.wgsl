// Evaluates pass/cloud_field.wgsl where it is bound to real textures. Case: a = position; results: density of layer 0,
// its bound from the map's body there, the body, and the height in the layer.
#import "pass/cloud_field.wgsl"
#import "test/eval_io.wgsl"

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) at: vec3u) {
  let id = vec3u(at.x + at.y * 512u, 0u, 0u);
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let layer = scene.layers[0];
  let h = (p.y - layer.base_m) * layer.per_thickness;
  let body = weather_at(layer, p.xz, h).body;
  let density = layer_density(0u, p, altitude_of(p), Reading(0.0, true, 0.0, vec3f(0.0)));
  store(id, vec4f(density, density_bound(layer, body), body, h));
}
