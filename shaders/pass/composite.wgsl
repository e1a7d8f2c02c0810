// Linear light for a file: the composed picture, or the clouds alone with their opacity.
#import "pass/composed.wgsl"

#if SAMPLES
@group(1) @binding(4) var linear_before: texture_2d<f32>;
#endif
@group(2) @binding(0) var linear_out: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (any(id.xy >= view.size)) {
    return;
  }
#if ALONE
  let seen = textureLoad(cloud, id.xy, 0);
  var light = vec4f(seen.rgb, 1.0 - seen.a);
#else
  var light = vec4f(composed_light(id.xy), 1.0);
#endif
#if SAMPLES
  light = mean_with(textureLoad(linear_before, id.xy, 0), light);
#endif
  textureStore(linear_out, id.xy, light);
}
