// The light that a place in a cloud sends to the eye, with the tables it reads bound: what the march and the converged
// march of the same model share.
#import "cloud/phase.wgsl"
#import "cloud/scatter.wgsl"
#import "light/sky.wgsl"
#import "pass/sun_depth.wgsl"

override OCTAVES: u32 = 1u;

#if PLAIN
#else
// Behind the scene's uniform: llvmpipe (Mesa 22.3) crashes when a dynamically indexed block is its fourth.
@group(1) @binding(12) var<uniform> air: AirUniforms;
#if LIT
@group(0) @binding(6) var sky_transmittance: texture_2d<f32>;
#endif
#if AMBIENT
@group(0) @binding(7) var sky_ambient: texture_2d<f32>;
#endif
#endif
#if AIR
@group(0) @binding(8) var sky_aerial_light: texture_3d<f32>;
@group(0) @binding(9) var sky_aerial_transmittance: texture_3d<f32>;
#endif

#if LIT
// Phase function of each layer and octave, the same all along the ray: the light is far away.
var<private> phases: array<f32, 32>;
#endif

#if AMBIENT
// Ambient light of the whole sky: from above, from below. The same all along the ray.
var<private> ambient_above: vec3f;
var<private> ambient_below: vec3f;
#endif

// What is the same all along a ray.
fn prepare_light(dir: vec3f) {
#if LIT
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    let shape = PhaseShape(layer.phase_kind, layer.g, layer.back_g, layer.back_mix);
    var anisotropy = 1.0;
    for (var o = 0u; o <= OCTAVES; o++) {
      phases[i * 8u + o] = phase_scaled(shape, anisotropy, dir, scene.towards_light);
      anisotropy *= scene.octave_anisotropy;
    }
  }
#endif
#if AMBIENT
  ambient_above = scene.ambient_top;
  ambient_below = scene.ambient_bottom;
#if PLAIN
#else
  ambient_above *= textureLoad(sky_ambient, vec2u(0u, 0u), 0).rgb;
  ambient_below *= textureLoad(sky_ambient, vec2u(1u, 0u), 0).rgb;
#endif
#endif
}

#if LIT

// The key light's irradiance at a place, cloud left out.
fn key_light_at(p: vec3f, altitude: f32) -> vec3f {
#if PLAIN
  return scene.light_illuminance;
#else
  let cosine = light_cos_zenith(p, scene.towards_light, scene.planet_radius_m);
  return scene.light_illuminance * light_transmittance(sky_transmittance, linear_repeat, air, altitude, cosine);
#endif
}
#endif

// Light of all layers at a place that has cloud, sent to the eye per unit of optical depth: the key light's irradiance
// there behind an optical depth of cloud, and the light of the sky.
fn source_of(light: vec3f, sun_depth: f32, altitude: f32, densities: vec4f) -> vec3f {
#if LIT
  var octaves: array<f32, 8>;
  var scale = 1.0;
  var energy = 1.0;
  for (var o = 0u; o <= OCTAVES; o++) {
    octaves[o] = octave_weight(sun_depth, scale, energy);
    scale *= scene.octave_extinction;
    energy *= scene.octave_energy;
  }
#endif
  let extinction = extinction_of(densities);
  var source = vec3f(0.0);
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    let share = densities[i] * layer.extinction_per_m / extinction * layer.albedo;
#if LIT
    var scattered = 0.0;
    for (var o = 0u; o <= OCTAVES; o++) {
      scattered += octaves[o] * phases[i * 8u + o];
    }
    source += share * light * scattered * layer.sun_gain;
#endif
#if AMBIENT
    let h = clamp((altitude - layer.base_m) * layer.per_thickness, 0.0, 1.0);
    let above = ambient_share(h, scene.ambient_base_share, densities[i], scene.ambient_occlusion);
    let around = ambient_above * above + ambient_below * (1.0 - h) * exp(-densities[i] * scene.ambient_occlusion);
    source += share * around * layer.ambient_gain;
#endif
  }
  return source;
}
