// Where a ray is inside a cloud domain: planet shell, infinite flat slab or box.
//
// Positions are metres relative to the sea-level point under the world's origin: x east, y up, z south. The planet's
// centre is (0, -radius_m, 0). Directions are unit vectors, and distances along them are metres.
// Planet-centred quadratics are off by metres at 6.4e6 m in f32; all forms here are local ones, in which the large
// radius cancels on paper (Haines, Guenther & Akenine-Moeller, "Precision Improvements for Ray/Sphere Intersection",
// Ray Tracing Gems, 2019, chapter 7, for the stable quadratic).

// "Without end" for flat domains; far beyond any distance cap, and small enough that sums stay finite.
const FAR_M: f32 = 1e12;

// Up to two stretches (start, end) of a ray, in order along it. A stretch with end <= start is empty, and the second
// is never filled while the first is empty.
struct Segments {
  first: vec2f,
  second: vec2f,
}

// r^2 - (R + H)^2 for a sphere at altitude H, which must not be computed from r and R. Differences of small numbers
// come first, so that it is exact to the last digits for a point right at the sphere.
fn squared_radius_excess(p: vec3f, layer_altitude_m: f32, radius_m: f32) -> f32 {
  let rise = (p.y - layer_altitude_m) * (2.0 * radius_m + (p.y + layer_altitude_m));
  return rise + (p.x * p.x + p.z * p.z);
}

// Altitude above sea level in metres: (r^2 - R^2) / (r + R).
fn altitude_at(p: vec3f, radius_m: f32) -> f32 {
  let excess = squared_radius_excess(p, 0.0, radius_m);
  return excess / (sqrt(radius_m * radius_m + excess) + radius_m);
}

// Unit vector away from the planet's centre.
fn up_at(p: vec3f, radius_m: f32) -> vec3f {
  return normalize(vec3f(p.x, p.y + radius_m, p.z));
}

// Distances (near, far) at which the ray meets the sphere at layer_altitude_m, negative behind p; (-1, -1) for a miss.
fn shell_roots(p: vec3f, dir: vec3f, layer_altitude_m: f32, radius_m: f32) -> vec2f {
  let b = dot(p, dir) + radius_m * dir.y;
  let c = squared_radius_excess(p, layer_altitude_m, radius_m);
  let discriminant = b * b - c;
  if (discriminant < 0.0) {
    return vec2f(-1.0);
  }
  let root = sqrt(discriminant);
  let q = -(b + select(-root, root, b >= 0.0));
  // q is 0 only when b, and with it c, is 0: the ray touches the sphere at p.
  let other = c / select(q, 1.0, q == 0.0);
  return vec2f(min(q, other), max(q, other));
}

// How much a way from a place rises or falls, at most, relative to its length.
fn steepest(p: vec3f, dir: vec3f, way: f32, radius_m: f32) -> f32 {
  let radius = length(vec3f(p.x, p.y + radius_m, p.z));
  return min((abs(dot(p, dir) + radius_m * dir.y) + way) / max(radius - way, 1.0), 1.0);
}

// How much longer a way may be in x, altitude and z, which are no right angles far out, than it is; ways that are told with a
// margin of a fiftieth are safe up to 0.04 radii from the origin.
fn flattening(p: vec3f, way: f32, radius_m: f32) -> f32 {
  let radius = length(vec3f(p.x, p.y + radius_m, p.z));
  let sine = min((length(p.xz) + way) / max(radius - way, 1.0), 1.0);
  return max(sqrt(1.0 + sine) * 0.98, 1.0);
}

// Drops empty stretches and moves a lone second one to the front.
fn ordered_segments(first: vec2f, second: vec2f) -> Segments {
  let has_first = first.y > first.x;
  let has_second = second.y > second.x;
  return Segments(
    select(select(vec2f(0.0), second, has_second), first, has_first),
    select(vec2f(0.0), second, has_first && has_second),
  );
}

// Where the ray is between the altitudes base_m and top_m, up to where it meets the ground at sea level. Two stretches
// when it leaves through the base and comes back. Nothing when top_m <= base_m.
fn shell_segments(p: vec3f, dir: vec3f, base_m: f32, top_m: f32, radius_m: f32) -> Segments {
  let outer = shell_roots(p, dir, top_m, radius_m);
  if (top_m <= base_m || outer.y <= 0.0) {
    return Segments(vec2f(0.0), vec2f(0.0));
  }
  let start = max(outer.x, 0.0);
  var end = outer.y;
  // Only a descending ray meets the ground; an eye that rounding put below sea level still sees up.
  let ground = shell_roots(p, dir, 0.0, radius_m);
  if (ground.y > 0.0 && dot(p, dir) + radius_m * dir.y < 0.0) {
    end = min(end, max(ground.x, 0.0));
  }
  let inner = shell_roots(p, dir, base_m, radius_m);
  if (inner.y <= 0.0) {
    return ordered_segments(vec2f(start, end), vec2f(0.0));
  }
  return ordered_segments(vec2f(start, min(end, inner.x)), vec2f(inner.y, end));
}

// dir with zero components nudged, so that 1 / dir is finite and 0 * inf cannot make NaN on a face.
fn without_zeros(dir: vec3f) -> vec3f {
  let nudge = select(vec3f(-1e-20), vec3f(1e-20), dir >= vec3f(0.0));
  return select(dir, nudge, abs(dir) < vec3f(1e-20));
}

// Where the ray is inside the box; the second stretch is empty.
fn box_segments(p: vec3f, dir: vec3f, box_min_m: vec3f, box_max_m: vec3f) -> Segments {
  let inverse = 1.0 / without_zeros(dir);
  let a = (box_min_m - p) * inverse;
  let b = (box_max_m - p) * inverse;
  let near = clamp(min(a, b), vec3f(0.0), vec3f(FAR_M));
  let far = clamp(max(a, b), vec3f(0.0), vec3f(FAR_M));
  let segment = vec2f(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
  let solid = all(box_max_m > box_min_m);
  return ordered_segments(select(vec2f(0.0), segment, solid), vec2f(0.0));
}

// Where the ray is between the heights base_m and top_m over a flat world; ends at FAR_M along a horizontal ray.
fn slab_segments(p: vec3f, dir: vec3f, base_m: f32, top_m: f32) -> Segments {
  let a = (base_m - p.y) / without_zeros(dir).y;
  let b = (top_m - p.y) / without_zeros(dir).y;
  let segment = clamp(vec2f(min(a, b), max(a, b)), vec2f(0.0), vec2f(FAR_M));
  return ordered_segments(select(vec2f(0.0), segment, top_m > base_m), vec2f(0.0));
}
