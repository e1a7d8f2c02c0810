// What lies behind the clouds in plain light: the same radiance everywhere.
#import "common/math.wgsl"
#import "generated/BandUniforms.wgsl"
#import "generated/CameraUniforms.wgsl"
#import "generated/PlainUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var<uniform> band: BandUniforms;
@group(0) @binding(2) var<uniform> plain: PlainUniforms;
#if FLOAT
@group(2) @binding(0) var background_out: texture_storage_2d<rgba32float, write>;
#else
@group(2) @binding(0) var background_out: texture_storage_2d<rgba16float, write>;
#endif

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let pixel = vec2u(id.x, id.y + band.first_row);
  if (any(pixel >= view.size) || id.y >= band.rows) {
    return;
  }
#if FLOAT
  textureStore(background_out, pixel, vec4f(plain.sky_radiance, 1.0));
#else
  textureStore(background_out, pixel, sanitise4(vec4f(plain.sky_radiance, 1.0)));
#endif
}
