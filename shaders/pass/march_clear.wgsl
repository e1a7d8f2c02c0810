// What the march would find in rows that no cloud can be in: nothing.
#import "generated/BandUniforms.wgsl"
#import "generated/CameraUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var<uniform> band: BandUniforms;
#if FLOAT
@group(2) @binding(0) var cloud_out: texture_storage_2d<rgba32float, write>;
#else
@group(2) @binding(0) var cloud_out: texture_storage_2d<rgba16float, write>;
#endif
#if DISTANCE
@group(2) @binding(1) var distance_out: texture_storage_2d<r32float, write>;
#endif

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let ray = vec2u(id.x, id.y + band.first_row);
  if (any(ray >= view.ray_count) || id.y >= band.rows) {
    return;
  }
  textureStore(cloud_out, ray, vec4f(0.0, 0.0, 0.0, 1.0));
#if DISTANCE
  textureStore(distance_out, ray, vec4f(0.0));
#endif
}
