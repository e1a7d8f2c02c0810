// Distances to all shapes of a role, for whatever has bound them as `shapes`.
#import "cloud/shapes.wgsl"
#import "generated/ShapesUniforms.wgsl"

// Distance to shapes from the first to before the end, joined one after the other.
fn joined_distance(p: vec3f, first: u32, end: u32) -> f32 {
  var distance = NO_SHAPE_M;
  for (var i = first; i < end; i++) {
    distance = joined(distance, shapes.list[i], p);
  }
  return distance;
}

// What curvature and rounding may add to a distance where heights are measured from a round sea.
const TRUSTED: f32 = 0.95;

// Distance to clouds.
fn cloud_shapes_distance(p: vec3f) -> f32 {
  return joined_distance(p, 0u, shapes.clouds) * TRUSTED;
}

// Distance to solid things.
fn solid_shapes_distance(p: vec3f) -> f32 {
  return joined_distance(p, shapes.clouds, shapes.clouds + shapes.solids) * TRUSTED;
}
