// The weather map with a painted layer over those below it.
#import "generated/BlendUniforms.wgsl"

@group(0) @binding(0) var<uniform> blend: BlendUniforms;
@group(1) @binding(0) var<storage, read> painted: array<vec4f>;
#if BELOW
@group(1) @binding(2) var map_below: texture_2d<f32>;
#endif
@group(2) @binding(0) var map_out: texture_storage_2d<rgba16float, write>;

// How clouds vary where nothing else says so.
const USUAL_VARIATION: f32 = 0.6;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(map_out);
  if (any(id.xy >= size)) {
    return;
  }
  var below = vec4f(0.0, 0.0, 0.0, USUAL_VARIATION);
#if BELOW
  below = textureLoad(map_below, id.xy, 0);
#endif
  let index = 2u * (id.y * size.x + id.x);
  let over = below * (1.0 - painted[index + 1u].xxxy) + painted[index];
  textureStore(map_out, id.xy, mix(below, over, blend.opacity));
}
