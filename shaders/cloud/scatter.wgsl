// Light scattered at a sample: octaves of the sun's, and the sky's from all around.
#import "common/math.wgsl"

// Light of the key light reaching the eye's direction, per unit of its irradiance, for one octave: energy times
// attenuation (Wrenninge, Kulla & Lundqvist 2013). The phase factor is the caller's.
fn octave_weight(optical_depth: f32, extinction_scale: f32, energy: f32) -> f32 {
  return energy * exp(-optical_depth * extinction_scale);
}

// Share of the sky's light from above at a height in the layer, kept out of dense cloud.
fn ambient_share(h: f32, base_share: f32, density: f32, occlusion: f32) -> f32 {
  return mix(base_share, 1.0, h) * exp(-density * occlusion * (1.0 - 0.6 * h));
}

// A ray that stops at transmittance T < limit counts as opaque: the rest is spread over what it saw, so that no grey
// film stays. Returns (T', factor on the light seen): T' = max(0, (T - limit) / (1 - limit)), L' = L (1 - T') / (1 - T).
fn after_early_exit(transmittance: f32, limit: f32) -> vec2f {
  if (transmittance > limit) {
    return vec2f((transmittance - limit) / (1.0 - limit), 1.0 / (1.0 - limit));
  }
  return vec2f(0.0, 1.0 / (1.0 - transmittance));
}
