// A tileable flow without sources or sinks (Bridson, Houriham & Nordenstam, "Curl-Noise for Procedural Fluid Flow",
// SIGGRAPH 2007, section 2): the curl of gradient noise, differentiated analytically, so that it is divergence-free
// exactly and not only up to a difference quotient. Positions are in tiles: p and p + 1 give the same flow.
#import "common/random.wgsl"
#import "noise/perlin.wgsl"

// Flow (x, y) per lattice cell of the potential; length about 0.6 on average, below 3.
fn curl2(p: vec2f, period: i32, seed: u32) -> vec2f {
  let q = p * f32(period);
  let cell = wrap_cell(vec3i(vec2i(floor(q)), 0), period);
  let f = q - floor(q);
  let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  let slope = 30.0 * f * f * (f * (f - 2.0) + 1.0);
  var gradient = vec2f(0.0);
  for (var i = 0; i < 4; i++) {
    let corner = vec2i(i & 1, i >> 1u);
    let random = hash_cell(wrap_neighbour(cell + vec3i(corner, 0), period), seed).xy * 2.0 - 1.0;
    let value = dot(random, f - vec2f(corner));
    let weight = select(1.0 - w, w, corner == vec2i(1));
    let weight_slope = select(-slope, slope, corner == vec2i(1));
    gradient += weight.x * weight.y * random + value * weight_slope * weight.yx;
  }
  return vec2f(gradient.y, -gradient.x);
}
