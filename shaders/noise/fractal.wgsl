// Sums of octaves. Each octave doubles the period, so that sums tile as their parts do, and takes the next seed.
#import "noise/perlin.wgsl"
#import "noise/worley.wgsl"

// Octaves of perlin with halving amplitudes, normalised by their sum; within -1..1.
fn perlin_fbm(p: vec3f, period: i32, octaves: i32, seed: u32) -> f32 {
  var sum = 0.0;
  var weight = 0.0;
  var amplitude = 1.0;
  var octave_period = period;
  for (var i = 0; i < octaves; i++) {
    sum += amplitude * perlin(p, octave_period, seed + u32(i));
    weight += amplitude;
    amplitude *= 0.5;
    octave_period *= 2;
  }
  return sum / max(weight, 1e-4);
}

// Three octaves of worley; 0..1. Weights of Schneider, "The Real-Time Volumetric Cloudscapes of Horizon: Zero Dawn",
// Advances in Real-Time Rendering, SIGGRAPH 2015.
fn worley_fbm(p: vec3f, period: i32, seed: u32) -> f32 {
  return worley(p, period, seed) * 0.625
    + worley(p, period * 2, seed + 1u) * 0.25
    + worley(p, period * 4, seed + 2u) * 0.125;
}

// Perlin-Worley of the same talk: connected like Perlin noise, billowy like Worley noise; 0..1. Five octaves of Perlin
// noise lift the Worley sum at four cells per tile; the factor 0.9 keeps the Perlin sum from saturating.
fn perlin_worley(p: vec3f, seed: u32) -> f32 {
  let connected = clamp(perlin_fbm(p, 4, 5, seed) * 0.9 + 0.5, 0.0, 1.0);
  let billows = worley_fbm(p, 4, seed + 16u);
  return billows + connected * (1.0 - billows);
}
