// Bounds of the density over a range of heights, for tracking: never below the density anywhere between the heights low
// and high, 0..1 in the layer, where the map's body is at most so much.
#import "cloud/profile.wgsl"
#import "cloud/thesis.wgsl"

// height_profile with every part at its greatest: the base at the upper end, the crown at the lower end under the
// highest top that any mixture of types can have.
fn greatest_profile(body: f32, layer: LayerUniforms, low: f32, high: f32) -> f32 {
  let spread = layer.anvil * smoothstep(0.55, 0.85, high);
  let top = max(max(mix(0.4, 1.0, sqrt(body)), 0.55 * mix(0.75, 1.0, body)), 0.02);
  let base = smoothstep(0.0, layer.base_ramp, high);
  let crown = 1.0 - smoothstep(min(0.62 + 0.3 * spread, 0.9), 1.0, low / top);
  return mix(body, sqrt(body), spread) * base * sqrt(max(crown, 0.0));
}

fn profile_bound_between(body: f32, layer: LayerUniforms, low: f32, high: f32) -> f32 {
  let profile = greatest_profile(body, layer, low, high);
  return profile_bound(profile, layer) * mix(0.45, 1.0, clamp(high * 1.2, 0.0, 1.0));
}

fn greatest_trapezoid(low: f32, high: f32, abcd: vec4f) -> f32 {
  return smoothstep(abcd.x, abcd.y, high) * (1.0 - smoothstep(abcd.z, abcd.w, low));
}

fn thesis_bound_between(body: f32, layer: LayerUniforms, low: f32, high: f32) -> f32 {
  let heights = max(greatest_trapezoid(low, high, THESIS_CUMULUS),
    max(greatest_trapezoid(low, high, THESIS_STRATUS), greatest_trapezoid(low, high, THESIS_STRATOCUMULUS)));
  return thesis_bound(body * heights, layer);
}
