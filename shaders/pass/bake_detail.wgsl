// The small 3D noise: three Worley sums, and Perlin noise for wisps in alpha.
#import "generated/BandUniforms.wgsl"
#import "noise/fractal.wgsl"

@group(0) @binding(0) var<uniform> band: BandUniforms;
@group(2) @binding(0) var noise_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let texel = id + vec3u(0u, 0u, band.first_row);
  let size = textureDimensions(noise_out);
  if (any(texel >= size) || id.z >= band.rows) {
    return;
  }
  let p = (vec3f(texel) + 0.5) / vec3f(size);
  let wisps = clamp(perlin_fbm(p, 4, 3, 304u) + 0.5, 0.0, 1.0);
  textureStore(noise_out, texel, vec4f(worley_fbm(p, 2, 301u), worley_fbm(p, 4, 311u), worley_fbm(p, 7, 321u), wisps));
}
