// Densities of all layers at the centres of voxels in the box, a channel each.
#import "generated/BandUniforms.wgsl"
#import "pass/cloud_field.wgsl"

@group(0) @binding(1) var<uniform> band: BandUniforms;
#if SINGLE
@group(2) @binding(0) var voxels_out: texture_storage_3d<r32float, write>;
#else
@group(2) @binding(0) var voxels_out: texture_storage_3d<rgba16float, write>;
#endif

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let voxel = id + vec3u(0u, 0u, band.first_row);
  let size = textureDimensions(voxels_out);
  if (any(voxel >= size) || id.z >= band.rows) {
    return;
  }
  let place = mix(scene.box_min, scene.box_max, (vec3f(voxel) + 0.5) / vec3f(size));
  textureStore(voxels_out, voxel, densities_at(place, Reading(0.0, true, 0.0, vec3f(0.0))));
}
