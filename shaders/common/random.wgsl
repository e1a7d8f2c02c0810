// Random numbers from integers, bit-identical on every driver (no fract(sin()), which none agree about).

// pcg3d: Jarzynski & Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020, listing in section 4.2.
fn pcg3d(seed: vec3u) -> vec3u {
  var v = seed * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v ^= v >> vec3u(16u);
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v;
}

// Uniform in [0, 1): 24 bits, because bits * 2^-32 can round up to 1.
fn unit_from_bits(bits: u32) -> f32 {
  return f32(bits >> 8u) * 0x1p-24;
}

// The random bits of a lattice cell. The seed moves the lattice by a different large odd step along each axis:
// one step for all three would make the noise of the next seed the same noise, moved along the diagonal.
fn hash_cell_bits(cell: vec3i, seed: u32) -> vec3u {
  return pcg3d(bitcast<vec3u>(cell) + seed * vec3u(0x9e3779b9u, 0x85ebca6bu, 0xc2b2ae35u));
}

// Three independent numbers in [0, 1) for a lattice cell.
fn hash_cell(cell: vec3i, seed: u32) -> vec3f {
  let bits = hash_cell_bits(cell, seed);
  return vec3f(unit_from_bits(bits.x), unit_from_bits(bits.y), unit_from_bits(bits.z));
}
