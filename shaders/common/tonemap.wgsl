// Curves from scene-linear Rec.709 to display.
#import "common/math.wgsl"

// IEC 61966-2-1.
fn srgb_encoded(linear: vec3f) -> vec3f {
  let c = clamp(linear, vec3f(0.0), vec3f(1.0));
  return select(1.055 * pow(max(c, vec3f(1e-8)), vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

fn srgb_decoded(encoded: vec3f) -> vec3f {
  let c = clamp(encoded, vec3f(0.0), vec3f(1.0));
  return select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045));
}

// Contrast round middle grey and saturation, on light.
fn graded(light: vec3f, contrast: f32, saturation: f32) -> vec3f {
#if GRADED
  let c = 0.18 * pow(max(light, vec3f(1e-8)) / 0.18, vec3f(contrast));
  let grey = luminance709(c);
  return max(mix(vec3f(grey), c, saturation), vec3f(0.0));
#else
  return max(light, vec3f(0.0));
#endif
}

// Khronos PBR Neutral (ToneMapping specification 1.0): hue kept, highlights compressed from 0.8 on.
fn khronos_neutral(light: vec3f) -> vec3f {
  let start = 0.8 - 0.04;
  let desaturation = 0.15;
  let x = min(light.r, min(light.g, light.b));
  let offset = select(0.04, x - 6.25 * x * x, x < 0.08);
  let colour = light - offset;
  let peak = max(colour.r, max(colour.g, colour.b));
  if (peak < start) {
    return max(colour, vec3f(0.0));
  }
  let d = 1.0 - start;
  let compressed = 1.0 - d * d / (peak + d - start);
  let g = 1.0 - 1.0 / (desaturation * (peak - compressed) + 1.0);
  return mix(colour * compressed / peak, vec3f(compressed), g);
}

// The Academy's reference and output transforms for sRGB, fitted by Stephen Hill (BakingLab, 2016), after a gain of 1/0.6
// that most programs put before it, so that middle grey stays near its place. It bends hues as film does.
fn aces_fit(light: vec3f) -> vec3f {
  let into = mat3x3f(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
  let back = mat3x3f(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
  // Beyond this the curve has long reached white, and squares would overflow.
  let v = into * min(light / 0.6, vec3f(1e6));
  let curve = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
  return clamp(back * curve, vec3f(0.0), vec3f(1.0));
}

// AgX by Troy Sobotka, with the polynomial fit of its curve by Benjamin Wrensch ("Minimal AgX implementation", 2023).
// The result is display-encoded.
fn agx(light: vec3f, contrast: f32, saturation: f32) -> vec3f {
  let inset = mat3x3f(
    0.842479062253094, 0.0423282422610123, 0.0423756549057051,
    0.0784335999999992, 0.878468636469772, 0.0784336,
    0.0792237451477643, 0.0791661274605434, 0.879142973793104);
  let outset = mat3x3f(
    1.19687900512017, -0.0528968517574562, -0.0529716355144438,
    -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
    -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
  let stops = clamp((log2(max(inset * light, vec3f(1e-10))) + 12.47393) / 16.5, vec3f(0.0), vec3f(1.0));
  let x2 = stops * stops;
  let x4 = x2 * x2;
  let curve = 15.5 * x4 * x2 - 40.14 * x4 * stops + 31.96 * x4 - 6.868 * x2 * stops + 0.4298 * x2 + 0.1191 * stops - 0.00232;
#if GRADED
  let powered = pow(max(curve, vec3f(1e-8)), vec3f(contrast));
  let saturated = mix(vec3f(luminance709(powered)), powered, saturation);
#else
  let saturated = max(curve, vec3f(1e-8));
#endif
  return clamp(outset * saturated, vec3f(0.0), vec3f(1.0));
}

// Stops relative to middle grey as bands of colour, display-encoded; the table is `FALSE_COLOURS` in `scene/place.rs`.
fn false_colour(light: vec3f) -> vec3f {
  let stops = log2(max(luminance709(light), 1e-12) / 0.18);
  let ends = array(-6.0, -4.0, -2.0, -1.0, -0.5, 0.5, 1.0, 2.0, 3.0, 4.5);
  var colours = array(
    vec3f(38.0, 10.0, 64.0), vec3f(40.0, 50.0, 160.0), vec3f(30.0, 120.0, 200.0), vec3f(30.0, 150.0, 150.0),
    vec3f(40.0, 140.0, 70.0), vec3f(128.0, 128.0, 128.0), vec3f(120.0, 190.0, 80.0), vec3f(220.0, 220.0, 70.0),
    vec3f(240.0, 160.0, 50.0), vec3f(220.0, 60.0, 40.0), vec3f(255.0, 255.0, 255.0));
  var band = 0u;
  for (var end = 0u; end < 10u; end++) {
    band += u32(stops >= ends[end]);
  }
  return colours[band] / 255.0;
}
