// What grows on the ground: woods, parcels of fields with hedges between them, tufts near the eye. Everything is drawn
// from cells of the world, so that nothing tiles, and fades to its own mean before a pixel is as wide as it is, so that
// nothing shimmers.
#import "common/random.wgsl"

struct GroundCover {
  // Factor of the plain's albedo, about 1 on average.
  tint: vec3f,
  // Rise of the surface towards +x and +z.
  slope: vec2f,
}

const REGION_M: f32 = 900.0;
const WOOD_TINT: vec3f = vec3f(0.46, 0.52, 0.62);
const MEAN_FIELD: vec3f = vec3f(1.12, 1.05, 1.07);
const MEAN_WOODS: f32 = 0.3;

// Smooth noise of one lattice: its value, 0..1, and its slope per cell.
fn lattice_noise(p: vec2f, seed: u32) -> vec3f {
  let low = floor(p);
  let cell = vec2i(low);
  let f = p - low;
  let w = f * f * (3.0 - 2.0 * f);
  let rise = 6.0 * f * (1.0 - f);
  let a = unit_from_bits(hash_cell_bits(vec3i(cell, 0), seed).x);
  let b = unit_from_bits(hash_cell_bits(vec3i(cell + vec2i(1, 0), 0), seed).x);
  let c = unit_from_bits(hash_cell_bits(vec3i(cell + vec2i(0, 1), 0), seed).x);
  let d = unit_from_bits(hash_cell_bits(vec3i(cell + vec2i(1, 1), 0), seed).x);
  let twist = a - b - c + d;
  return vec3f(
    a + (b - a) * w.x + (c - a) * w.y + twist * w.x * w.y,
    rise * vec2f(b - a + twist * w.y, c - a + twist * w.x),
  );
}

// How much is left of a detail of that size where a pixel covers `footprint_m` of ground.
fn shown(size_m: f32, footprint_m: f32) -> f32 {
  return 1.0 - smoothstep(0.3, 1.1, footprint_m / size_m);
}

// Tint of a parcel: meadow, young crop, ripe crop or soil.
fn crop_tint(draw: vec3f) -> vec3f {
  let green = mix(vec3f(0.80, 0.88, 0.82), vec3f(1.14, 1.12, 1.08), draw.y);
  let dry = mix(vec3f(1.25, 0.98, 1.10), vec3f(1.62, 1.32, 1.42), draw.y);
  return mix(green, dry, smoothstep(0.58, 0.66, draw.x)) * (0.9 + 0.2 * draw.z);
}

// Fields: regions with an own direction, cut into parcels.
fn fields(p: vec2f, footprint_m: f32) -> vec3f {
  let q = p / REGION_M + vec2f(0.37, 0.81);
  let low = floor(q);
  var nearest = 1e9;
  var bits = vec3u(0u);
  for (var i = 0; i < 9; i++) {
    let cell = vec2i(low) + vec2i(i % 3, i / 3) - 1;
    let random = hash_cell_bits(vec3i(cell, 1), 901u);
    let offset = vec2f(cell) + vec2f(unit_from_bits(random.x), unit_from_bits(random.y)) - q;
    let squared = dot(offset, offset);
    bits = select(bits, random, squared < nearest);
    nearest = min(nearest, squared);
  }
  let angle = unit_from_bits(bits.z) * 3.14159265;
  let along = vec2f(cos(angle), sin(angle));
  let size = vec2f(90.0, 210.0) * (1.0 + unit_from_bits(bits.x));
  var local = vec2f(dot(p, along), dot(p, vec2f(-along.y, along.x))) / size;
  let strip = i32(floor(local.x));
  // Parcels of neighbouring strips do not end on one line.
  local.y += unit_from_bits(hash_cell_bits(vec3i(strip, 0, 2), bits.z).x);
  let draw = hash_cell(vec3i(strip, i32(floor(local.y)), 3), bits.z);
  let inside = (0.5 - abs(local - floor(local) - 0.5)) * size;
  // Two parcels in three have one, one to three metres to each side.
  let hedge_m = 4.5 * max(draw.z - 0.33, 0.0);
  let edge = min(inside.x, inside.y);
  let covered = min(hedge_m / (0.7 * footprint_m + 1.0), 1.0);
  let hedge = (1.0 - smoothstep(0.6 * hedge_m, hedge_m + 0.5 + footprint_m, edge)) * covered;
  let parcel = mix(crop_tint(draw), WOOD_TINT, 0.8 * hedge);
  return mix(MEAN_FIELD, parcel, shown(140.0, footprint_m));
}

// `p` in metres in the world; a pixel covers `footprint_m` of ground the long way; `wet`, 0..1, says where woods are
// many.
fn ground_cover(p: vec2f, footprint_m: f32, wet: f32) -> GroundCover {
  let wide = lattice_noise(p / 760.0, 902u);
  let middle = lattice_noise(p / 230.0, 903u);
  let small = lattice_noise(p / 47.0, 904u);
  // Bends what would be straight, as streams and old paths do.
  let bent = p + (middle.yz * 14.0 + small.yz * 3.0);
  let mottle = 0.22 * (middle.x - 0.5) + 0.25 * (small.x - 0.5) * shown(47.0, footprint_m);
  let field_tint = fields(bent, footprint_m) * (1.0 + mottle);
  let wood_field = wide.x * 0.55 + middle.x * 0.33 + small.x * 0.12 + 0.45 * (wet - 0.5);
  let soft = 0.012 + 0.0012 * min(footprint_m, 300.0);
  let mask = smoothstep(0.60 - soft, 0.60 + soft, wood_field);
  let woods = mix(MEAN_WOODS + 0.6 * (wet - 0.5), mask, shown(650.0, footprint_m));
  var tint = mix(field_tint, WOOD_TINT, clamp(woods, 0.0, 1.0));
  var slope = vec2f(0.0);
  let near = shown(11.0, footprint_m);
  if (near > 0.0) {
    // Crowns of trees, or lumps of a meadow; then tufts. Two lattices at an angle, bent, show no rows of either.
    let turned = vec2f(0.8 * bent.x + 0.6 * bent.y, 0.8 * bent.y - 0.6 * bent.x);
    let crowns = lattice_noise(turned / 7.3, 907u);
    let turned_back = vec3f(crowns.x, 0.8 * crowns.yz - 0.6 * vec2f(crowns.z, -crowns.y));
    let lumps = mix(lattice_noise(bent / 11.0, 905u), turned_back, 0.5);
    let tufts = lattice_noise(p / 2.7, 906u);
    let finest = shown(2.7, footprint_m);
    tint *= 1.0 + near * 0.35 * (lumps.x - 0.5) + finest * 0.5 * (tufts.x - 0.5);
    slope = lumps.yz * near * mix(0.08, 0.3, woods) + tufts.yz * finest * 0.22;
  }
  return GroundCover(tint, slope);
}
