// A generated weather map: layered Worley cells of two families of size, layered Perlin noise that frays them, and a
// cloud type for each large cell (Koblížek 2019, section 2.1.1). Coverage is no input: it is a threshold on the result,
// which widens every cell as it grows. The third axis of the noises is time.
#import "cloud/map_field.wgsl"
#import "generated/BandUniforms.wgsl"

@group(0) @binding(0) var<uniform> band: BandUniforms;
@group(0) @binding(1) var<uniform> map: MapUniforms;
@group(2) @binding(0) var map_out: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let texel = vec2u(id.x, id.y + band.first_row);
  let size = textureDimensions(map_out);
  if (any(texel >= size) || id.y >= band.rows) {
    return;
  }
  let uv = (vec2f(texel) + 0.5) / vec2f(size);
  if (map.is_weather_texture == 1u) {
    textureStore(map_out, texel, weather_texture_at(uv, map));
  } else {
    textureStore(map_out, texel, map_texel_at(uv, map));
  }
}
