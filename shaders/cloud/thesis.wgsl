// The density model of Koblížek, "Volumetric clouds" (2019), section 2.1: cloud map times height function times layered
// Worley noise, minus a threshold, minus detail. Heights h are 0 at the layer's base and 1 at its top.
#import "cloud/weather.wgsl"
#import "generated/LayerUniforms.wgsl"

const THESIS_THRESHOLD: f32 = 0.2;

// Rises from a to b, stays 1, falls from c to d.
fn trapezoid(h: f32, abcd: vec4f) -> f32 {
  return smoothstep(abcd.x, abcd.y, h) * (1.0 - smoothstep(abcd.z, abcd.w, h));
}

// Where clouds of a type begin, are densest, and end (figure 2.3).
const THESIS_CUMULUS: vec4f = vec4f(0.0, 0.12, 0.35, 1.0);
const THESIS_STRATUS: vec4f = vec4f(0.0, 0.06, 0.14, 0.26);
const THESIS_STRATOCUMULUS: vec4f = vec4f(0.0, 0.12, 0.30, 0.58);

// Chance of cloud by height for cumulus, stratus, stratocumulus.
fn thesis_heights(h: f32) -> vec3f {
  return vec3f(trapezoid(h, THESIS_CUMULUS), trapezoid(h, THESIS_STRATUS), trapezoid(h, THESIS_STRATOCUMULUS));
}

// Cloud map times height function for each type, 0 where both say that nothing can be there.
fn thesis_profile(weather: Weather, h: f32) -> vec3f {
  return weather.body * weather.types * thesis_heights(h);
}

// Equations 2.1 and 2.2 with the factors by type, clamped at 0 only after detail.
fn thesis_field(profile: vec3f, noise: vec4f, weather: Weather, layer: LayerUniforms) -> f32 {
  let shape = mix(1.0, dot(noise, vec4f(0.25, 0.25, 0.45, 0.05)), min(layer.shape_strength, 1.0));
  let samples = shape * profile - THESIS_THRESHOLD;
  let fields = samples * vec3f(2.0, weather.body, 2.0);
  return max(fields.x, max(fields.y, fields.z));
}

// Mean of the detail, which stands for it where it is not read, and to which it fades with distance: clouds without any
// would be denser.
const MEAN_DETAIL: f32 = 0.5;

// Detail is subtracted, which adds wisps, and matters only near the surface (section 3.1.1).
fn thesis_eroded(field: f32, noise: vec4f, layer: LayerUniforms, fade: f32) -> f32 {
  let detail = mix(dot(noise.rgb, vec3f(0.5, 0.3, 0.2)), MEAN_DETAIL, fade);
  return field - (1.0 - detail) * 0.35 * layer.detail_strength;
}

fn thesis_near_surface(field: f32, layer: LayerUniforms) -> bool {
  return field < 0.45 * max(layer.detail_strength, 1.0);
}

fn thesis_density(field: f32, layer: LayerUniforms) -> f32 {
  return clamp(field * layer.sharpness, 0.0, 1.0);
}

fn thesis_bound(greatest_body: f32, layer: LayerUniforms) -> f32 {
  let greatest = greatest_body - THESIS_THRESHOLD;
  return clamp(2.0 * greatest * layer.sharpness, 0.0, 1.0);
}
