// Distances to all shapes of a role, for whatever has bound them as `shapes`.
#import "cloud/shapes.wgsl"
#import "generated/ShapesUniforms.wgsl"

// Shapes that one round of the loop takes: rounds are counted where a driver ends loops that are too long.
const SHAPES_PER_ROUND: u32 = 4u;

// Distance to shapes from the first to before the end, joined one after the other.
fn joined_distance(p: vec3f, first: u32, end: u32) -> f32 {
  var distance = NO_SHAPE_M;
  for (var i = first; i < end; i += SHAPES_PER_ROUND) {
    distance = joined(distance, shapes.list[i], p);
    if (i + 1u < end) {
      distance = joined(distance, shapes.list[i + 1u], p);
    }
    if (i + 2u < end) {
      distance = joined(distance, shapes.list[i + 2u], p);
    }
    if (i + 3u < end) {
      distance = joined(distance, shapes.list[i + 3u], p);
    }
  }
  return distance;
}

// What rounding may add to a distance; and curvature, where heights are measured from a round sea: up to half of the way
// over the planet's radius, from where the sea is level to where the distance ends.
const TRUSTED: f32 = 0.95;
const FLAT_WAY: f32 = 0.05;

fn trusted(p: vec3f, distance: f32) -> f32 {
  let way = 0.5 * (length(p.xz) + abs(distance)) * shapes.per_radius;
  return distance * TRUSTED / (1.0 + max(way - FLAT_WAY, 0.0));
}

// Distance to clouds.
fn cloud_shapes_distance(p: vec3f) -> f32 {
  return trusted(p, joined_distance(p, 0u, shapes.clouds));
}

// Distance to solid things.
fn solid_shapes_distance(p: vec3f) -> f32 {
  return trusted(p, joined_distance(p, shapes.clouds, shapes.clouds + shapes.solids));
}
