// Tileable gradient noise. Positions are in tiles: p and p + 1 give the same value, for any whole period.
#import "common/random.wgsl"

// The cell of a lattice that repeats after period cells; also right for negative cells.
fn wrap_cell(cell: vec3i, period: i32) -> vec3i {
  return ((cell % period) + period) % period;
}

// wrap_cell for a neighbour, at most one cell outside of 0..period, without the two slow integer divisions.
fn wrap_neighbour(cell: vec3i, period: i32) -> vec3i {
  let n = vec3i(period);
  return select(select(cell, cell + n, cell < vec3i(0)), cell - n, cell >= n);
}

// The quintic of Perlin, "Improving Noise", 2002: zero first and second derivatives at both ends.
fn fade3(t: vec3f) -> vec3f {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

fn corner_gradient(cell: vec3i, period: i32, seed: u32, offset: vec3f) -> f32 {
  return dot(hash_cell(wrap_neighbour(cell, period), seed) * 2.0 - 1.0, offset);
}

// Gradient noise with period lattice cells per tile; within -1..1, deviation about 0.2.
fn perlin(p: vec3f, period: i32, seed: u32) -> f32 {
  let q = p * f32(period);
  let cell = wrap_cell(vec3i(floor(q)), period);
  let f = q - floor(q);
  let w = fade3(f);
  let c000 = corner_gradient(cell, period, seed, f);
  let c100 = corner_gradient(cell + vec3i(1, 0, 0), period, seed, f - vec3f(1.0, 0.0, 0.0));
  let c010 = corner_gradient(cell + vec3i(0, 1, 0), period, seed, f - vec3f(0.0, 1.0, 0.0));
  let c110 = corner_gradient(cell + vec3i(1, 1, 0), period, seed, f - vec3f(1.0, 1.0, 0.0));
  let c001 = corner_gradient(cell + vec3i(0, 0, 1), period, seed, f - vec3f(0.0, 0.0, 1.0));
  let c101 = corner_gradient(cell + vec3i(1, 0, 1), period, seed, f - vec3f(1.0, 0.0, 1.0));
  let c011 = corner_gradient(cell + vec3i(0, 1, 1), period, seed, f - vec3f(0.0, 1.0, 1.0));
  let c111 = corner_gradient(cell + vec3i(1, 1, 1), period, seed, f - vec3f(1.0, 1.0, 1.0));
  let low = mix(mix(c000, c100, w.x), mix(c010, c110, w.x), w.y);
  let high = mix(mix(c001, c101, w.x), mix(c011, c111, w.x), w.y);
  return mix(low, high, w.z);
}
