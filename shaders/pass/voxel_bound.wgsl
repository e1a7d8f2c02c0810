// The greatest value of the voxels in each cell of them, with those around it that a trilinear value in it depends on.
#import "cloud/voxels.wgsl"

@group(0) @binding(0) var voxels: texture_3d<f32>;
#if SINGLE
@group(2) @binding(0) var bound_out: texture_storage_3d<r32float, write>;
#else
@group(2) @binding(0) var bound_out: texture_storage_3d<rgba16float, write>;
#endif

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (any(id >= textureDimensions(bound_out))) {
    return;
  }
  let last = vec3i(textureDimensions(voxels)) - 1;
  let first = vec3i(id * VOXELS_PER_CELL) - 1;
  var greatest = vec4f(0.0);
  for (var z = 0; z < i32(VOXELS_PER_CELL) + 2; z++) {
    for (var y = 0; y < i32(VOXELS_PER_CELL) + 2; y++) {
      for (var x = 0; x < i32(VOXELS_PER_CELL) + 2; x++) {
        greatest = max(greatest, textureLoad(voxels, clamp(first + vec3i(x, y, z), vec3i(0), last), 0));
      }
    }
  }
  textureStore(bound_out, id, greatest);
}
