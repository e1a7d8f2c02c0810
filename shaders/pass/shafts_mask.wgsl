// Sunshafts, step 1 (Koblížek 2019, section 2.2.2): the clear sky that can send light past the edges of things.
#import "common/camera.wgsl"
#import "generated/CameraUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"

@group(0) @binding(0) var<uniform> view: ViewUniforms;
#if CLOUDS
@group(1) @binding(0) var cloud: texture_2d<f32>;
#endif
#if GROUND
@group(1) @binding(1) var ground_distance: texture_2d<f32>;
#endif
@group(2) @binding(0) var mask_out: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(mask_out);
  if (any(id.xy >= size)) {
    return;
  }
  // The mean of four pixels spread over the texel.
  let scale = vec2f(view.size) / vec2f(size);
  var clear = 0.0;
  for (var i = 0u; i < 4u; i++) {
    let offset = (vec2f(f32(i & 1u), f32(i >> 1u)) + 0.5) * 0.5;
    let pixel = min(vec2u((vec2f(id.xy) + offset) * scale), view.size - vec2u(1u));
    var open = 1.0;
#if CLOUDS
    open = textureLoad(cloud, pixel, 0).a;
#endif
#if GROUND
    open = select(open, 0.0, textureLoad(ground_distance, pixel, 0).x >= 0.0);
#endif
    clear += 0.25 * open;
  }
  textureStore(mask_out, id.xy, vec4f(clear, 0.0, 0.0, 0.0));
}
