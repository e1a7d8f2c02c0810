// Scalar helpers that every pass shares. Arguments are plain numbers; radiance is linear Rec.709.

const PI: f32 = 3.14159265358979;

// Largest finite half float: what an rgba16float texture can hold.
const MAX_HALF: f32 = 65504.0;

// Where x lies between a and b, clamped to 0..1; a == b and a > b give a step at b instead of inf or NaN.
fn remap01(x: f32, a: f32, b: f32) -> f32 {
  return clamp((x - a) / max(b - a, 1e-4), 0.0, 1.0);
}

// (1 - exp(-x)) / x below x = 0.5 by its series of degree 7. The quotient itself loses all digits there, and llvmpipe's
// exp(-1e-12) is off by 6e-8, which the division turns into a factor of 60,000.
fn absorption_series(x: f32) -> f32 {
  return 1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0
    - x * (1.0 / 720.0 - x * (1.0 / 5040.0 - x / 40320.0))))));
}

// W(x) = (1 - exp(-x)) / x for an optical depth x >= 0; W(0) = 1.
fn absorption_weight(x: f32) -> f32 {
  return select((1.0 - exp(-x)) / max(x, 0.5), absorption_series(x), x < 0.5);
}

// The share 1 - exp(-x) that an optical depth x >= 0 takes out of a ray. With transmittance *= 1 - absorbed(x) the sum
// of all shares and the last transmittance telescope to 1, whatever the rounding. Never above 1.
fn absorbed(x: f32) -> f32 {
  return select(1.0 - exp(-x), x * absorption_series(x), x < 0.5);
}

// By the exponent's bits: x != x is false for NaN through naga, and compilers may assume that NaN does not occur.
fn is_finite_bits(x: f32) -> bool {
  return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

fn sanitise(x: f32) -> f32 {
  return select(0.0, clamp(x, 0.0, MAX_HALF), is_finite_bits(x));
}

// Non-finite components become 0, the others are clamped to 0..65504, so that one bad sample cannot poison a history.
fn sanitise3(v: vec3f) -> vec3f {
  return vec3f(sanitise(v.x), sanitise(v.y), sanitise(v.z));
}

fn sanitise4(v: vec4f) -> vec4f {
  return vec4f(sanitise3(v.xyz), sanitise(v.w));
}

// Luminance of linear Rec.709 (ITU-R BT.709-6, item 3.2).
fn luminance709(rgb: vec3f) -> f32 {
  return dot(rgb, vec3f(0.2126, 0.7152, 0.0722));
}
