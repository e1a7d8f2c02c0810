// Bounds of the density over a range of heights, for tracking and for crossing clear air: never below the density anywhere
// between the heights low and high, 0..1 in the layer, where the map's body is at most so much.
#import "cloud/profile.wgsl"
#import "cloud/thesis.wgsl"

// What types there may be.
struct PossibleTypes {
  // 1 for cumulus, stratus and stratocumulus where they may be, 0 where they are not.
  types: vec3f,
  // At most so much of the slow variation that raises tops, 0..1.
  variation: f32,
}

const ANY_TYPES: PossibleTypes = PossibleTypes(vec3f(1.0), 1.0);

// Tops of a mixture of types are a mixture of their tops: see top_height.
fn greatest_top(body: f32, possible: PossibleTypes, layer: LayerUniforms) -> f32 {
  let lift = 1.0 - layer.top_variation * (1.0 - possible.variation);
  let flat = mix(0.75, 1.0, body);
  let tops = possible.types * vec3f(mix(0.4, 1.0, sqrt(body)) * lift, 0.30 * flat, 0.55 * flat);
  return max(max(tops.x, max(tops.y, tops.z)), 0.02);
}

// height_profile with every part at its greatest: the base at the upper end, the crown at the lower end under the
// highest top that any mixture of types can have.
fn greatest_profile(body: f32, possible: PossibleTypes, layer: LayerUniforms, low: f32, high: f32) -> f32 {
  let spread = layer.anvil * smoothstep(0.55, 0.85, high);
  let top = greatest_top(body, possible, layer);
  let base = smoothstep(0.0, layer.base_ramp, high);
  // Shoulders are lowest where all is cumulus; where the map has nothing and coverage makes cloud of it, it has no type.
  var bias = layer.body_bias;
#if FRONT
  bias = max(bias, layer.body_bias_beyond);
#endif
  let is_cumulus = bias <= 0.0 && possible.types.y + possible.types.z <= 0.0;
  let shoulder = select(FLAT_SHOULDER, CUMULUS_SHOULDER, is_cumulus) + 0.3 * spread;
  let crown = 1.0 - smoothstep(min(shoulder, 0.9), 1.0, low / top);
  return mix(body, sqrt(body), spread) * base * sqrt(max(crown, 0.0));
}

fn profile_bound_between(body: f32, possible: PossibleTypes, layer: LayerUniforms, low: f32, high: f32) -> f32 {
  let profile = greatest_profile(body, possible, layer, low, high);
  return profile_bound(profile, layer) * mix(0.45, 1.0, clamp(high * 1.2, 0.0, 1.0));
}

fn greatest_trapezoid(low: f32, high: f32, abcd: vec4f) -> f32 {
  return smoothstep(abcd.x, abcd.y, high) * (1.0 - smoothstep(abcd.z, abcd.w, low));
}

fn thesis_bound_between(body: f32, possible: PossibleTypes, layer: LayerUniforms, low: f32, high: f32) -> f32 {
  let heights = possible.types * vec3f(greatest_trapezoid(low, high, THESIS_CUMULUS),
    greatest_trapezoid(low, high, THESIS_STRATUS), greatest_trapezoid(low, high, THESIS_STRATOCUMULUS));
  return thesis_bound(body * max(heights.x, max(heights.y, heights.z)), layer);
}
