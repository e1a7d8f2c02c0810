// Sunshafts, step 2: the mask blurred away from the light, along great circles, so that it works in every projection.
#import "common/camera.wgsl"
#import "common/math.wgsl"
#import "generated/ShaftUniforms.wgsl"
#import "generated/CameraUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var<uniform> shafts: ShaftUniforms;
@group(0) @binding(2) var linear_clamp: sampler;
@group(0) @binding(3) var blue_noise: texture_2d<f32>;
@group(1) @binding(0) var shafts_mask: texture_2d<f32>;
@group(2) @binding(0) var shafts_out: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(shafts_out);
  if (any(id.xy >= size)) {
    return;
  }
  let dir = ray_through(view.camera, (vec2f(id.xy) + 0.5) / vec2f(size));
  let cosine = clamp(dot(dir, shafts.towards_light), -1.0, 1.0);
  let away = sqrt(max(0.0, 2.0 - 2.0 * cosine));
  // Mie-like glow round the light, gone at the length of the streaks.
  let reach = 1.0 - smoothstep(0.0, shafts.length_rad, away);
  if (reach <= 0.0) {
    textureStore(shafts_out, id.xy, vec4f(0.0));
    return;
  }
  let jitter = textureLoad(blue_noise, id.xy % textureDimensions(blue_noise), 0).x;
  var sum = 0.0;
  var weights = 0.0;
  for (var i = 0u; i < shafts.samples; i++) {
    let f = (f32(i) + jitter) / f32(shafts.samples);
    let place = picture_point(view.camera, normalize(mix(dir, shafts.towards_light, f)));
    let weight = 1.0 - 0.6 * f;
    if (place.z > 0.0 && all(place.xy >= vec2f(0.0)) && all(place.xy <= vec2f(1.0))) {
      sum += weight * textureSampleLevel(shafts_mask, linear_clamp, place.xy, 0.0).x;
    }
    weights += weight;
  }
  let streak = sum / max(weights, 1e-4);
  textureStore(shafts_out, id.xy, vec4f(shafts.light * streak * reach * reach, 1.0));
}
