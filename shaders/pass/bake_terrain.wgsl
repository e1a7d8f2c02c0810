// The relief of the ground: mountain ranges in red, hills in green, patches of colour in blue.
#import "generated/BandUniforms.wgsl"
#import "generated/ReliefUniforms.wgsl"
#import "noise/fractal.wgsl"

@group(0) @binding(0) var<uniform> band: BandUniforms;
@group(0) @binding(1) var<uniform> relief: ReliefUniforms;
@group(2) @binding(0) var relief_out: texture_storage_2d<rgba16float, write>;

// Ridged multifractal (Musgrave, "Texturing & Modeling", 2003, chapter 16): crests where gradient noise crosses zero,
// each octave strongest on the crests of the one before.
fn ridges(p: vec3f, period: i32, seed: u32) -> f32 {
  var sum = 0.0;
  var weight = 1.0;
  var amplitude = 0.55;
  var octave_period = period;
  for (var i = 0u; i < 6u; i++) {
    let crest = 1.0 - abs(perlin(p, octave_period, seed + i)) * 1.9;
    let signal = clamp(crest, 0.0, 1.0) * clamp(crest, 0.0, 1.0) * weight;
    weight = clamp(signal * 1.8, 0.0, 1.0);
    sum += amplitude * signal;
    amplitude *= 0.5;
    octave_period *= 2;
  }
  return sum;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let texel = vec2u(id.x, id.y + band.first_row);
  let size = textureDimensions(relief_out);
  if (any(texel >= size) || id.y >= band.rows) {
    return;
  }
  let p = vec3f((vec2f(texel) + 0.5) / vec2f(size), 0.37);
  let seed = relief.seed * 32u;
  // Ranges stand in regions, with plains between.
  let region = smoothstep(-0.10, 0.14, perlin_fbm(p, 4, 3, seed));
  let ranges = region * clamp(ridges(p, 7, seed + 8u) * 1.7 - 0.25, 0.0, 1.0);
  let hills = clamp(perlin_fbm(p, 24, 4, seed + 16u) * 0.9 + 0.5, 0.0, 1.0);
  let patches = clamp(perlin_fbm(p, 16, 5, seed + 24u) + 0.5, 0.0, 1.0);
  textureStore(relief_out, texel, vec4f(ranges, hills, patches, 0.0));
}
