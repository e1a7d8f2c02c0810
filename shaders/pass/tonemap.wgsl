// From light to display colour: exposure, a curve, sRGB encoding, and dither against banding.
#import "common/tonemap.wgsl"
#import "generated/BandUniforms.wgsl"
#import "generated/DisplayUniforms.wgsl"
#import "pass/composed.wgsl"

@group(0) @binding(1) var<uniform> display: DisplayUniforms;
@group(0) @binding(2) var blue_noise: texture_2d<f32>;
@group(0) @binding(3) var<uniform> band: BandUniforms;
#if SAMPLES
@group(1) @binding(4) var shown_before: texture_2d<f32>;
@group(2) @binding(1) var shown_out: texture_storage_2d<rgba16float, write>;
#endif
@group(2) @binding(0) var display_out: texture_storage_2d<rgba8unorm, write>;

override TONE_MAP: u32 = 0u;
// 1 draws stripes over what clips.
override STRIPES: u32 = 0u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let pixel = vec2u(id.x, id.y + band.first_row);
  if (any(pixel >= view.size) || id.y >= band.rows) {
    return;
  }
  var light = sanitise3(composed_light(pixel) * display.exposure);
  var colour: vec3f;
  switch (TONE_MAP) {
    case 0u: {
      colour = agx(light, display.contrast, display.saturation);
    }
    case 1u: {
      colour = srgb_encoded(graded(khronos_neutral(light), display.contrast, display.saturation));
    }
    case 3u: {
      colour = false_colour(light);
    }
    case 4u: {
      colour = srgb_encoded(graded(aces_fit(light), display.contrast, display.saturation));
    }
    default: {
      colour = srgb_encoded(clamp(graded(light, display.contrast, display.saturation), vec3f(0.0), vec3f(1.0)));
    }
  }
#if SAMPLES
  let shown = mean_with(textureLoad(shown_before, pixel, 0), vec4f(srgb_decoded(colour), 1.0));
  textureStore(shown_out, pixel, shown);
  colour = srgb_encoded(shown.rgb);
#endif
  if (STRIPES == 1u && any(colour >= vec3f(254.5 / 255.0))) {
    colour = select(colour, vec3f(0.85, 0.0, 0.35), (pixel.x + pixel.y) / 4u % 2u == 0u);
  }
  let noise = textureLoad(blue_noise, pixel % textureDimensions(blue_noise), 0).x;
  let dithered = clamp(colour, vec3f(0.0), vec3f(1.0)) * 255.0 + noise;
  textureStore(display_out, pixel, vec4f(floor(dithered) / 255.0, 1.0));
}
