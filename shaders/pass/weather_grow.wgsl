// A weather map that grows out of an image: patches of it, each about a vertex of a lattice and changing with time, blended
// by their normal values so that the sum of them is normal again, and taken back to the image's own distribution (Heitz and
// Neyret 2018, sections 3 and 4; a square lattice in place of triangles, so that the map repeats). The image itself lies in
// the middle, while it lasts.
#import "common/random.wgsl"
#import "generated/GrowUniforms.wgsl"

@group(0) @binding(0) var<uniform> grow: GrowUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(1) @binding(0) var example: texture_2d<f32>;
@group(1) @binding(1) var example_normal: texture_2d<f32>;
@group(1) @binding(2) var example_back: texture_2d<f32>;
@group(2) @binding(0) var map_out: texture_storage_2d<rgba16float, write>;

// Over this part of its width the image goes over into what grows about it.
const BORDER: f32 = 0.15;

// Normal values, less their mean, weighted, and the sum of the squared weights.
struct Blended {
  sum: vec4f,
  squares: f32,
}

// Adds a vertex's patch of an epoch. `apart` is the way from the vertex in cells, -1..1.
fn with_patch(blended: Blended, vertex: vec2i, apart: vec2f, epoch: u32, weight: f32) -> Blended {
  let drawn = pcg3d(vec3u(vec2u(vertex), epoch ^ (grow.seed * 0x9e3779b9u)));
  let centre = vec2f(unit_from_bits(drawn.x), unit_from_bits(drawn.y));
  let place = centre + 0.5 * apart * grow.patch_share;
  // Mirrored at the image's edge, where it need not fit itself; all of it is drawn as often.
  let mirrored = 1.0 - abs(1.0 - abs(place));
  let half_texel = 0.5 / vec2f(textureDimensions(example_normal));
  let value = textureSampleLevel(example_normal, linear_repeat, clamp(mirrored, half_texel, 1.0 - half_texel), 0.0);
  return Blended(blended.sum + weight * (value - 0.5), blended.squares + weight * weight);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(map_out);
  if (any(id.xy >= size)) {
    return;
  }
  let uv = (vec2f(id.xy) + 0.5) / vec2f(size);
  let in_image = (uv - 0.5) / grow.image_share + 0.5;
  let inside = min(min(in_image.x, in_image.y), min(1.0 - in_image.x, 1.0 - in_image.y));
  let own = grow.image_weight * smoothstep(0.0, BORDER, inside);
  let half_texel = 0.5 / vec2f(textureDimensions(example));
  let place = clamp(in_image, half_texel, 1.0 - half_texel);
  var blended = Blended(vec4f(0.0), 0.0);
  if (own > 0.0) {
    blended = Blended(own * (textureSampleLevel(example_normal, linear_repeat, place, 0.0) - 0.5), own * own);
  }
  let at = uv * f32(grow.cells);
  let cell = vec2i(floor(at));
  for (var k = 0; k < 4; k++) {
    let corner = cell + vec2i(k & 1, k >> 1);
    let apart = at - vec2f(corner);
    let near = smoothstep(vec2f(0.0), vec2f(1.0), 1.0 - abs(apart));
    let share = (1.0 - own) * near.x * near.y;
    let vertex = corner % i32(grow.cells);
    // Each has its own moment to begin anew.
    let phase = grow.phase + unit_from_bits(pcg3d(vec3u(vec2u(vertex), grow.seed + 77u)).z);
    let epoch = grow.epoch + u32(floor(phase));
    let later = smoothstep(0.0, 1.0, fract(phase));
    blended = with_patch(blended, vertex, apart, epoch, share * (1.0 - later));
    blended = with_patch(blended, vertex, apart, epoch + 1u, share * later);
  }
  let normal = clamp(0.5 + blended.sum * inverseSqrt(max(blended.squares, 1e-12)), vec4f(0.0), vec4f(1.0));
  let table = f32(textureDimensions(example_back).x);
  var texel = vec4f(0.0);
  for (var channel = 0; channel < 4; channel++) {
    let entry = vec2f((normal[channel] * (table - 1.0) + 0.5) / table, 0.5);
    texel[channel] = textureSampleLevel(example_back, linear_repeat, entry, 0.0)[channel];
  }
  // Where it is alone, the image as it is.
  let whole = smoothstep(0.9, 1.0, own);
  textureStore(map_out, id.xy, mix(texel, textureSampleLevel(example, linear_repeat, place, 0.0), whole));
}
