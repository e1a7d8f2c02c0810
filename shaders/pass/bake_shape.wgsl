// The large 3D noise: Perlin-Worley in red, inverted Worley sums of 5, 10 and 20 cells per tile in green, blue, alpha.
// Octaves that two channels share are computed once.
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
  let w5 = worley(p, 5, 101u);
  let w10 = worley(p, 10, 102u);
  let w20 = worley(p, 20, 103u);
  let w40 = worley(p, 40, 104u);
  let billows = w5 * 0.625 + w10 * 0.25 + w20 * 0.125;
  // As perlin_worley, but lifted from the cells that green holds: three Worley octaves less.
  let connected = clamp(perlin_fbm(p, 4, 5, 7u) * 0.9 + 0.5, 0.0, 1.0);
  textureStore(noise_out, texel, vec4f(
    billows + connected * (1.0 - billows),
    billows,
    w10 * 0.625 + w20 * 0.25 + w40 * 0.125,
    w20 * 0.7 + w40 * 0.3,
  ));
}
