// Evaluates cloud/shapes.wgsl. Case: a = position.
#import "pass/shapes_distance.wgsl"
#import "test/eval_io.wgsl"

@group(0) @binding(2) var<storage, read> shapes: ShapesUniforms;

// Distances to the clouds, to the solid things, and to the first shape alone.
@compute @workgroup_size(64) fn eval_shapes(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let p = bitcast<vec4f>(cases[id.x].a).xyz;
  store(id, vec4f(cloud_shapes_distance(p), solid_shapes_distance(p), shape_distance(shapes.list[0], p), 0.0));
}
