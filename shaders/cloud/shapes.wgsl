// Signed distances of shapes, and how they join (Thomann 2020, section 4.5; Hart 1996). Places are east of the eye, above sea
// level, and south of the eye. No distance changes by more than the way between two places: a sphere about a place with its
// distance as radius holds no surface.
#import "generated/ShapeUniforms.wgsl"

const SHAPE_SPHERE: u32 = 0u;
const SHAPE_ELLIPSOID: u32 = 1u;
const SHAPE_BOX: u32 = 2u;
const SHAPE_CYLINDER: u32 = 3u;
const JOIN_UNION: u32 = 0u;
const JOIN_DIFFERENCE: u32 = 1u;

// Farther than any shape.
const NO_SHAPE_M: f32 = 1e6;

// A vector turned by a quaternion.
fn turned(v: vec3f, q: vec4f) -> vec3f {
  return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

// Distance to one shape's surface, negative inside.
fn shape_distance(shape: ShapeUniforms, p: vec3f) -> f32 {
  let q = turned(p - shape.centre, shape.local_from_world);
  let half = shape.half_size;
  switch (shape.kind) {
    case SHAPE_SPHERE: {
      return length(q) - half.x;
    }
    case SHAPE_ELLIPSOID: {
      // Less than the distance, and exact along the shortest axis.
      return (length(q / half) - 1.0) * min(half.x, min(half.y, half.z));
    }
    case SHAPE_BOX: {
      let rounding = min(shape.rounding_m, min(half.x, min(half.y, half.z)));
      let d = abs(q) - half + rounding;
      return length(max(d, vec3f(0.0))) + min(max(d.x, max(d.y, d.z)), 0.0) - rounding;
    }
    case SHAPE_CYLINDER: {
      let d = vec2f(length(q.xz) - half.x, abs(q.y) - half.y);
      return length(max(d, vec2f(0.0))) + min(max(d.x, d.y), 0.0);
    }
    default: {
      let straight = max(half.y - half.x, 0.0);
      return length(vec3f(q.x, q.y - clamp(q.y, -straight, straight), q.z)) - half.x;
    }
  }
}

// The lesser of two distances, rounded where they differ by less than `blend` (polynomial of second order: Quilez 2013).
fn blended_least(a: f32, b: f32, blend: f32) -> f32 {
  let near = max(blend - abs(a - b), 0.0) / max(blend, 1e-3);
  return min(a, b) - 0.25 * near * near * blend;
}

// A distance to shapes with one more of them.
fn joined(before: f32, shape: ShapeUniforms, p: vec3f) -> f32 {
  let own = shape_distance(shape, p);
  if (shape.join == JOIN_UNION) {
    return blended_least(before, own, shape.blend_m);
  }
  let other = select(own, -own, shape.join == JOIN_DIFFERENCE);
  return -blended_least(-before, -other, shape.blend_m);
}
