// One octave of Perlin noise (red, blue) and of Voronoi noise (green, alpha), two of each that differ, 64 texels on a side and 8
// cells across. Sums of octaves read it again and again.
#import "generated/BandUniforms.wgsl"
#import "noise/fractal.wgsl"

@group(0) @binding(0) var<uniform> band: BandUniforms;
@group(2) @binding(0) var noise_out: texture_storage_3d<rgba16float, write>;

const CELLS: i32 = 8;

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let texel = id + vec3u(0u, 0u, band.first_row);
  let size = textureDimensions(noise_out);
  if (any(texel >= size) || id.z >= band.rows) {
    return;
  }
  let p = (vec3f(texel) + 0.5) / vec3f(size);
  let hills = vec2f(perlin(p, CELLS, 301u), perlin(p, CELLS, 302u)) * 1.2 + 0.5;
  let heaps = vec2f(worley(p, CELLS, 303u), worley(p, CELLS, 304u));
  textureStore(noise_out, texel, clamp(vec4f(hills.x, heaps.x, hills.y, heaps.y), vec4f(0.0), vec4f(1.0)));
}
