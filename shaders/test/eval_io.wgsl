// Array in, array out, for the tests of functions: one case is four vectors in and one vector out, as raw bits, so that
// integers, NaN and denormals pass unchanged.

struct Case {
  a: vec4u,
  b: vec4u,
  c: vec4u,
  d: vec4u,
}

@group(0) @binding(0) var<storage, read> cases: array<Case>;
@group(0) @binding(1) var<storage, read_write> results: array<vec4u>;

fn is_case(id: vec3u) -> bool {
  return id.x < arrayLength(&cases);
}

fn store(id: vec3u, value: vec4f) {
  results[id.x] = bitcast<vec4u>(value);
}
