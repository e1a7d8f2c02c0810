// The weather map of this moment: between two states of each of its layers; where several layers have cloud, the
// densest counts.
#import "generated/BlendUniforms.wgsl"

@group(0) @binding(0) var<uniform> blend: BlendUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(1) @binding(0) var map_before: texture_2d<f32>;
@group(1) @binding(1) var map_after: texture_2d<f32>;
#if BELOW
@group(1) @binding(2) var map_below: texture_2d<f32>;
#endif
@group(2) @binding(0) var map_out: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(map_out);
  if (any(id.xy >= size)) {
    return;
  }
  let uv = (vec2f(id.xy) + 0.5) / vec2f(size);
  let before = textureSampleLevel(map_before, linear_repeat, uv, 0.0);
  let after = textureSampleLevel(map_after, linear_repeat, uv, 0.0);
  var texel = mix(before, after, blend.share);
#if BELOW
  texel = max(texel, textureLoad(map_below, id.xy, 0));
#endif
  textureStore(map_out, id.xy, texel);
}
