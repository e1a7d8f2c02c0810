// The weather map with a painted layer over those below it.
#import "common/spiral.wgsl"
#import "generated/BlendUniforms.wgsl"
#import "pass/painted.wgsl"

@group(0) @binding(0) var<uniform> blend: BlendUniforms;
@group(1) @binding(0) var<storage, read> painted: array<Painted>;
#if BELOW
@group(1) @binding(2) var map_below: texture_2d<f32>;
#endif
@group(2) @binding(0) var map_out: texture_storage_2d<rgba16float, write>;

// How clouds vary where nothing else says so.
const USUAL_VARIATION: f32 = 0.6;

#if BELOW
fn texel_below(texel: vec2i) -> vec4f {
  let side = i32(textureDimensions(map_out).x);
  let index = index_of(side, blend.edge == REPEATS, texel);
  let there = textureLoad(map_below, vec2i(index % side, index / side), 0);
  let is_nothing = blend.edge == CLEAR && any(texel != clamp(texel, vec2i(0), vec2i(side - 1)));
  return there * select(vec4f(1.0), vec4f(0.0, 0.0, 0.0, 1.0), is_nothing);
}

// Between texels.
fn below_at(at: vec2f) -> vec4f {
  let corner = floor(at - 0.5);
  let share = at - 0.5 - corner;
  let texel = vec2i(corner);
  let upper = mix(texel_below(texel), texel_below(texel + vec2i(1, 0)), share.x);
  let lower = mix(texel_below(texel + vec2i(0, 1)), texel_below(texel + vec2i(1, 1)), share.x);
  return mix(upper, lower, share.y);
}

// What lies below as it was moved and smoothed.
fn below(texel: vec2i, here: Painted) -> vec4f {
  if (all(here.shift == vec2f(0.0)) && here.smoothing <= 0.0) {
    return texel_below(texel);
  }
  let at = vec2f(texel) + 0.5 + here.shift * f32(textureDimensions(map_out).x);
  if (here.smoothing <= 0.0) {
    return below_at(at);
  }
  var sum = vec4f(0.0);
  for (var i = 0u; i < SPIRAL_COUNT; i++) {
    sum += below_at(at + spiral(i) * sqrt(here.smoothing));
  }
  return sum / f32(SPIRAL_COUNT);
}
#else
fn texel_below(texel: vec2i) -> vec4f {
  return vec4f(0.0, 0.0, 0.0, USUAL_VARIATION);
}

fn below(texel: vec2i, here: Painted) -> vec4f {
  return texel_below(texel);
}
#endif

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(map_out);
  if (any(id.xy >= size)) {
    return;
  }
  let texel = vec2i(id.xy);
  let here = painted[id.y * size.x + id.x];
  let over = below(texel, here) * (1.0 - here.taken.xxxy) + here.added;
  textureStore(map_out, id.xy, mix(texel_below(texel), over, blend.opacity));
}
