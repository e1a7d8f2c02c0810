// The density model of Thomann, "Cloud Shader" (2020), listing 15: sums of octaves of Perlin and of Voronoi noise, each less a
// threshold, multiplied. The weather map is the mask over the box (section 6.5.1).
#import "generated/LayerUniforms.wgsl"

// Both noises are 0..1; clamped, as extinction has an upper end here and artists' multipliers come after.
fn product_density(perlin: f32, voronoi: f32, mask: f32, layer: LayerUniforms) -> f32 {
  let above = max(vec2f(perlin, voronoi) - vec2f(layer.perlin_octaves.w, layer.voronoi_octaves.w), vec2f(0.0));
  return clamp(layer.product_gain.x * above.x * above.y, 0.0, 1.0) * mask;
}

// Never below the density where the mask is at most so much.
fn product_bound(mask: f32, layer: LayerUniforms) -> f32 {
  return product_density(1.0, 1.0, mask, layer);
}
