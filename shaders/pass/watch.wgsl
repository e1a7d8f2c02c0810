// Counts the values of a texture that are not finite, by their exponents: comparisons with NaN are not the same on all
// drivers.

#if VOLUME
@group(0) @binding(0) var watched: texture_3d<f32>;
#else
@group(0) @binding(0) var watched: texture_2d<f32>;
#endif
@group(2) @binding(0) var<storage, read_write> counters: array<atomic<u32>>;

fn is_finite(value: vec4f) -> vec4<bool> {
  return (bitcast<vec4u>(value) & vec4u(0x7f800000u)) != vec4u(0x7f800000u);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(watched);
  if (any(id.xy >= size.xy)) {
    return;
  }
  var broken = 0u;
#if VOLUME
  for (var z = 0u; z < size.z; z++) {
    broken += u32(!all(is_finite(textureLoad(watched, vec3u(id.xy, z), 0))));
  }
#else
  broken = u32(!all(is_finite(textureLoad(watched, id.xy, 0))));
#endif
  if (broken > 0u) {
    atomicAdd(&counters[0], broken);
  }
}
