// Evaluates noise/*.wgsl. Case: a = position; b = period, octaves, seed as integers.
#import "noise/fractal.wgsl"
#import "noise/curl.wgsl"
#import "test/eval_io.wgsl"

@compute @workgroup_size(64) fn eval_single(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let period = i32(cases[id.x].b.x);
  let seed = cases[id.x].b.z;
  store(id, vec4f(perlin(p, period, seed), worley(p, period, seed), curl2(p.xy, period, seed)));
}

@compute @workgroup_size(64) fn eval_worley_cell(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let cell = worley_cell(p, i32(cases[id.x].b.x), cases[id.x].b.z);
  results[id.x] = vec4u(bitcast<u32>(cell.f1), bitcast<u32>(cell.f2), cell.id, 0u);
}

@compute @workgroup_size(64) fn eval_fractal(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  let period = i32(cases[id.x].b.x);
  let seed = cases[id.x].b.z;
  let perlin_sum = perlin_fbm(p, period, i32(cases[id.x].b.y), seed);
  store(id, vec4f(perlin_sum, worley_fbm(p, period, seed), perlin_worley(p, seed), 0.0));
}
