// The thesis's shape noise: layered Worley noise of four frequencies in four channels, 64 texels on a side.
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
  let layered = vec4f(worley(p, 3, 201u), worley(p, 6, 202u), worley(p, 11, 203u), worley(p, 20, 204u));
  textureStore(noise_out, texel, clamp(layered * vec4f(1.25, 1.25, 1.3, 1.3), vec4f(0.0), vec4f(1.0)));
}
