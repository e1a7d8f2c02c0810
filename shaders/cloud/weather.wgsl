// What a texel of the weather map means.
//
// Red, green and blue hold how deep inside a cumulus, stratus or stratocumulus field a place lies, 0..1; coverage is a
// threshold on their sum, applied here, so that it can change from place to place and under a slider without a bake.
// Alpha is a slow variation that makes some fields tower and others stay low.

struct Weather {
  // How far inside a cloud, 0 outside to 1 in the middle.
  body: f32,
  // Shares of cumulus, stratus and stratocumulus; they sum to 1.
  types: vec3f,
  // Slow variation of the height of tops, 0..1.
  variation: f32,
}

// Body of a field 0..1: `cover` is the factor and the offset that coverage makes.
fn body_of(field: f32, cover: vec2f) -> f32 {
  return clamp(field * cover.x + cover.y, 0.0, 1.0);
}

fn weather_from_texel(texel: vec4f, cover: vec2f) -> Weather {
  let field = texel.r + texel.g + texel.b;
  return Weather(body_of(field, cover), texel.rgb / max(field, 1e-4), texel.a);
}
