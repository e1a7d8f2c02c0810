// The share of the key light that clouds let through to the ground, on a map around the eye: straight in red, scattered
// downwards in green, and straight to the height of the highest solid thing in blue.
#import "generated/BandUniforms.wgsl"
#import "generated/GroundUniforms.wgsl"
#import "pass/sun_depth.wgsl"

@group(0) @binding(0) var<uniform> band: BandUniforms;
@group(0) @binding(1) var<uniform> ground: GroundUniforms;
@group(2) @binding(0) var shadow_out: texture_storage_2d<rgba16float, write>;

const SHADOW_STEPS: u32 = 14u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let texel = vec2u(id.x, id.y + band.first_row);
  let size = textureDimensions(shadow_out);
  if (any(texel >= size) || id.y >= band.rows) {
    return;
  }
  let uv = (vec2f(texel) + 0.5) / vec2f(size);
  let foot = (uv - ground.shadow_from_world.xy) / ground.shadow_from_world.z;
  let p = vec3f(foot.x, 0.0, foot.y);
  let segment = domain_segments(p, ground.towards_light).first;
  let length = min(segment.y - segment.x, 30000.0);
  var depth = 0.0;
  var above = 0.0;
  if (length > 0.0) {
    let step = length / f32(SHADOW_STEPS);
    for (var i = 0u; i < SHADOW_STEPS; i++) {
      let q = p + ground.towards_light * (segment.x + (f32(i) + 0.5) * step);
      let own = shadow_extinction(q, Reading(1.0, false, 1.0, vec3f(0.0))) * step;
      depth += own;
      above += select(0.0, own, altitude_of(q) > ground.receiver_m);
    }
  }
  // What droplets scatter downwards passes as through a two-stream layer of asymmetry 0.85.
  let direct = exp(-depth);
  let diffuse = 1.0 / (1.0 + 0.75 * 0.15 * depth) - direct;
  textureStore(shadow_out, texel, vec4f(direct, max(diffuse, 0.0), exp(-above), 0.0));
}
