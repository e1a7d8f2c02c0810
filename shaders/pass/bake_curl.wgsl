// A flow that drags the small noise: two octaves of curl noise across, a little Perlin noise up and down.
#import "noise/curl.wgsl"

@group(2) @binding(0) var noise_out: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(noise_out);
  if (any(id.xy >= size)) {
    return;
  }
  let p = (vec2f(id.xy) + 0.5) / vec2f(size);
  let flow = curl2(p, 4, 401u) + 0.5 * curl2(p, 9, 402u);
  textureStore(noise_out, id.xy, vec4f(flow.x, perlin(vec3f(p, 0.37), 5, 403u), flow.y, 0.0));
}
