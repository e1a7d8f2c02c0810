// The next mip level of a 3D noise: the mean of eight texels.
@group(1) @binding(0) var finer: texture_3d<f32>;
@group(2) @binding(0) var noise_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (any(id >= textureDimensions(noise_out))) {
    return;
  }
  var sum = vec4f(0.0);
  for (var i = 0u; i < 8u; i++) {
    sum += textureLoad(finer, 2u * id + vec3u(i & 1u, (i >> 1u) & 1u, i >> 2u), 0);
  }
  textureStore(noise_out, id, sum / 8.0);
}
