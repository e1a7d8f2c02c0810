// The density model of Costa, "Modeling and rendering of volumetric clouds" (2023), section 3.1: one image says the
// coverage (red), the height (green) and the altitude (blue) of the cloud above a place, and noises give it its shape.
// Heights h are 0 at the layer's base and 1 at its top.
#import "cloud/weather.wgsl"
#import "generated/LayerUniforms.wgsl"

// Equation 3.1: a parabola between a cloud's base and its top; nothing outside, nor where the cloud has no height.
fn height_signal(texel: vec4f, h: f32) -> f32 {
  let a = (h - texel.b) / max(texel.g, 1e-6);
  return select(max(4.0 * a * (1.0 - a), 0.0), 0.0, texel.g <= 0.0);
}

// Weights of the octaves in equations 3.2 and 3.3, scaled so that they sum to 1.
const COSTA_WEIGHTS: vec3f = vec3f(0.5, 0.25, 0.125) / 0.875;

// Equation 3.2. Below 1 the factor mixes the noise in, above it multiplies.
fn costa_shaped(density: f32, noise: vec4f, layer: LayerUniforms) -> f32 {
  let shape = dot(noise.gba, COSTA_WEIGHTS) * noise.r;
  return density * mix(1.0, shape, min(layer.shape_strength, 1.0)) * max(layer.shape_strength, 1.0);
}

// Mean of the small noise, which stands for it where it is not read, and to which it fades with distance.
const COSTA_MEAN_DETAIL: f32 = 0.5;

// Equation 3.3, where the percentage is that of the erosion.
fn costa_eroded(density: f32, noise: vec4f, layer: LayerUniforms, fade: f32) -> f32 {
  return density - mix(dot(noise.arg, COSTA_WEIGHTS), COSTA_MEAN_DETAIL, fade) * layer.detail_strength;
}

fn costa_density(density: f32, layer: LayerUniforms) -> f32 {
  return clamp(density * layer.sharpness, 0.0, 1.0);
}

// Never below the density where the coverage is at most so much.
fn costa_bound(coverage: f32, layer: LayerUniforms) -> f32 {
  return costa_density(coverage * max(layer.shape_strength, 1.0), layer);
}
