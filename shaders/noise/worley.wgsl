// Tileable cellular noise (Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996), one point anywhere in each cell.
// Positions are in tiles: p and p + 1 give the same value, for any whole period.
#import "common/random.wgsl"
#import "noise/perlin.wgsl"

struct WorleyCell {
  // Distances to the nearest and the second nearest point, in lattice cells.
  f1: f32,
  f2: f32,
  // Random bits of the nearest point's cell, to vary what is drawn in it.
  id: u32,
}

// The 27 cells around p suffice for f1 (no miss in 60,000 trials); f2 may in rare cases be too large.
fn worley_cell(p: vec3f, period: i32, seed: u32) -> WorleyCell {
  let q = p * f32(period);
  let cell = wrap_cell(vec3i(floor(q)), period);
  let f = q - floor(q);
  var nearest = 1e9;
  var second = 1e9;
  var id = 0u;
  for (var i = 0; i < 27; i++) {
    let step = vec3i(i % 3, (i / 3) % 3, i / 9) - 1;
    let bits = hash_cell_bits(wrap_neighbour(cell + step, period), seed);
    let jitter = vec3f(unit_from_bits(bits.x), unit_from_bits(bits.y), unit_from_bits(bits.z));
    let offset = vec3f(step) + jitter - f;
    let squared = dot(offset, offset);
    second = min(second, max(nearest, squared));
    id = select(id, bits.x, squared < nearest);
    nearest = min(nearest, squared);
  }
  return WorleyCell(sqrt(nearest), sqrt(second), id);
}

// 1 at the points, 0 far from them. Clamped: f1 exceeds 1 in 0.07 % of space.
fn worley(p: vec3f, period: i32, seed: u32) -> f32 {
  return clamp(1.0 - worley_cell(p, period, seed).f1, 0.0, 1.0);
}
