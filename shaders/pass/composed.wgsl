// The finished light of a pixel: background through the clouds, the clouds, and sunshafts (their step 3).
#import "common/math.wgsl"
#import "generated/CameraUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(1) @binding(0) var background: texture_2d<f32>;
#if GLOW
#import "common/camera.wgsl"
#import "generated/GlowUniforms.wgsl"
@group(0) @binding(4) var<uniform> glow: GlowUniforms;
#endif
#if CLOUDS
@group(1) @binding(1) var cloud: texture_2d<f32>;
#endif
#if SHAFTS
@group(1) @binding(2) var shafts_light: texture_2d<f32>;
@group(1) @binding(3) var linear_clamp: sampler;
#endif

// The mean of all samples so far. Before the first there is nothing worth reading.
fn mean_with(before: vec4f, sample: vec4f) -> vec4f {
  return select(mix(before, sample, view.sample_share), sample, view.sample_share >= 1.0);
}

#if GLOW
// Light about the sun or moon that thin cloud is given (Thomann 2020, listing 16, by the angle; none where there is no cloud).
fn glow_at(pixel: vec2u, transmittance: f32) -> vec3f {
  let dir = ray_through(view.camera, (vec2f(pixel) + view.pixel_point) / vec2f(view.size));
  let angle = 2.0 * asin(clamp(0.5 * length(dir - glow.towards_light), 0.0, 1.0));
  let away = pow(smoothstep(0.0, glow.range, angle), glow.width);
  return glow.radiance * (1.0 - away) * transmittance * (1.0 - transmittance);
}
#endif

fn composed_light(pixel: vec2u) -> vec3f {
  var light = textureLoad(background, pixel, 0).rgb;
#if CLOUDS
  let seen = textureLoad(cloud, pixel, 0);
  light = light * seen.a + seen.rgb;
#if GLOW
  light += glow_at(pixel, clamp(seen.a, 0.0, 1.0));
#endif
#endif
#if SHAFTS
  light += textureSampleLevel(shafts_light, linear_clamp, (vec2f(pixel) + 0.5) / vec2f(view.size), 0.0).rgb;
#endif
  return light;
}
