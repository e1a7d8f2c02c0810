// The weather map of this moment: between two states of each of its layers, joined to those below it.
#import "generated/BlendUniforms.wgsl"

@group(0) @binding(0) var<uniform> blend: BlendUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(1) @binding(0) var map_before: texture_2d<f32>;
@group(1) @binding(1) var map_after: texture_2d<f32>;
#if BELOW
@group(1) @binding(2) var map_below: texture_2d<f32>;
#endif
@group(2) @binding(0) var map_out: texture_storage_2d<rgba16float, write>;

#if BELOW
const MODE_REPLACE: u32 = 1u;
const MODE_ADD: u32 = 2u;
const MODE_SUBTRACT: u32 = 3u;
const MODE_MASK: u32 = 4u;

// A layer over what lies below it.
fn joined(below: vec4f, own: vec4f) -> vec4f {
  switch (blend.mode) {
    case MODE_REPLACE: {
      return own;
    }
    case MODE_ADD: {
      return min(below + own, vec4f(1.0));
    }
    case MODE_SUBTRACT: {
      return vec4f(max(below.rgb - own.rgb, vec3f(0.0)), below.a);
    }
    case MODE_MASK: {
      return vec4f(below.rgb * min(own.r + own.g + own.b, 1.0), below.a);
    }
    default: {
      return max(below, own);
    }
  }
}
#endif

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(map_out);
  if (any(id.xy >= size)) {
    return;
  }
  let uv = (vec2f(id.xy) + 0.5) / vec2f(size);
  let before = textureSampleLevel(map_before, linear_repeat, uv, 0.0);
  let after = textureSampleLevel(map_after, linear_repeat, uv, 0.0);
  let own = mix(before, after, blend.share);
#if BELOW
  let below = textureLoad(map_below, id.xy, 0);
  let texel = mix(below, joined(below, own), blend.opacity);
#else
  // The lowest one has nothing to join.
  let texel = vec4f(own.rgb * blend.opacity, own.a);
#endif
  textureStore(map_out, id.xy, texel);
}
