// The program's own density model: bodies from the map, a height profile by cloud type, billows, erosion.
//
// All functions take values that were already read from textures, so that the march, the bound and the tests share
// them. Heights h are 0 at the layer's base and 1 at its top. The chain is: profile -> billowed -> eroded -> density.
#import "cloud/weather.wgsl"
#import "common/math.wgsl"
#import "generated/LayerUniforms.wgsl"

// Mean of the erosion noise, to which it fades with distance.
const MEAN_EROSION: f32 = 0.5;
// Sums of octaves huddle about their mean; this spreads them, or surfaces would look like dough.
const EROSION_CONTRAST: f32 = 2.2;

// Height of the tops over the layer, 0..1: cumulus towers with its body, the others stay flat.
fn top_height(weather: Weather, layer: LayerUniforms) -> f32 {
  let lift = 1.0 - layer.top_variation * (1.0 - weather.variation);
  let towering = mix(0.4, 1.0, sqrt(weather.body)) * lift;
  let flat = mix(0.75, 1.0, weather.body);
  return max(dot(weather.types, vec3f(towering, 0.30 * flat, 0.55 * flat)), 0.02);
}

// Where clouds begin to grow narrower upwards, as a part of their height.
const FLAT_SHOULDER: f32 = 0.62;
const CUMULUS_SHOULDER: f32 = 0.25;

// How much cloud the map allows at a height, 0..1.
fn height_profile(weather: Weather, layer: LayerUniforms, h: f32) -> f32 {
  let spread = layer.anvil * smoothstep(0.55, 0.85, h);
  let body = mix(weather.body, sqrt(weather.body), spread);
  let hh = h / top_height(weather, layer);
  let base = smoothstep(0.0, layer.base_ramp, h);
  let shoulder = mix(FLAT_SHOULDER, CUMULUS_SHOULDER, weather.types.x) + 0.3 * spread;
  let crown = 1.0 - smoothstep(min(shoulder, 0.9), 1.0, hh);
  return body * base * sqrt(max(crown, 0.0));
}

// The same where an automaton's cells, 0..1, stand for it: they have tops of their own.
fn automaton_profile(cells: f32, weather: Weather, layer: LayerUniforms, h: f32) -> f32 {
  return weather.body * cells * smoothstep(0.0, layer.base_ramp, h);
}

// Mean of each of the large noise's sums of billows.
const MEAN_BILLOW: f32 = 0.48;
// And, nearly, of its Perlin-Worley noise: half of what the billows leave is added to them.
const MEAN_PERLIN_WORLEY: f32 = 0.75;

// What is taken from every profile, so that clear air is clear.
const THINNEST_PROFILE: f32 = 0.23;

// How much of the large noise counts: it falls where the profile is thin, which keeps pebbles from floating beside the
// bodies.
fn noise_amplitude(profile: f32) -> f32 {
  return smoothstep(0.04, 0.58, profile);
}

// The profile and the large noise together: positive inside. `lumps` is 0..1.
fn signed_field(profile: f32, lumps: f32, weather: Weather, layer: LayerUniforms) -> f32 {
  let strength = layer.shape_strength * dot(weather.types, vec3f(1.0, 0.7, 0.9));
  return (1.2 * profile - THINNEST_PROFILE + strength * (lumps * noise_amplitude(profile) - 0.65)) * 2.2;
}

// Signed field after the large noise. Noise is added, not multiplied. Knobs sit on domes and not in the hollows between
// them: a cloud of one roughness looks like foam, and knobs beside a dome would float.
fn billowed(profile: f32, noise: vec4f, weather: Weather, layer: LayerUniforms) -> f32 {
  let domes = noise.g - MEAN_BILLOW;
  let knobs = dot(noise.ba, vec2f(0.58, 0.42)) - MEAN_BILLOW;
  let connected = (noise.r - noise.g) / max(1.0 - noise.g, 0.1);
  let rough = smoothstep(-0.22, 0.12, domes) * mix(0.5, 1.2, smoothstep(0.38, 0.60, connected));
  let billows = clamp(MEAN_BILLOW + 1.5 * domes + 2.2 * rough * knobs, 0.0, 1.0);
  let lumps = billows * 0.8 + noise.r * 0.2;
  return signed_field(profile, lumps, weather, layer);
}

// How firmly a place is held by the cloud that it belongs to, 0..1: whether there were cloud even if domes were three
// fifths as high as in `billowed`, had no knobs, and Perlin-Worley noise were everywhere at its mean. Towers and middles
// are firm; scraps that the noise lifts out of clear air are not, and mix with it: erosion goes through them and leaves
// little water.
fn firmness(profile: f32, noise: vec4f, weather: Weather, layer: LayerUniforms) -> f32 {
  let lumps = 0.8 * mix(MEAN_BILLOW, noise.g, 0.9) + 0.2 * MEAN_PERLIN_WORLEY;
  return smoothstep(-0.2, 1.2, signed_field(profile, lumps, weather, layer));
}

// What erosion takes from the surface: billowy above, wispy below, in scraps and where the user wants it.
fn erosion(noise: vec4f, firm: f32, layer: LayerUniforms, h: f32, fade: f32) -> f32 {
  let cells = dot(noise.rgb, vec3f(0.45, 0.33, 0.22));
  let wisps = noise.a * 0.6 + 0.4 * cells;
  let wispy = max(max(1.0 - smoothstep(0.0, 0.22, h), 1.0 - firm), layer.wispiness);
  let carved = MEAN_EROSION + EROSION_CONTRAST * (mix(1.0 - cells, wisps, wispy) - 0.5);
  return mix(clamp(carved, 0.0, 1.0), MEAN_EROSION, fade) * layer.detail_strength;
}

// How deep into the field erosion goes: below this it takes something everywhere, most at the surface.
const EROSION_DEPTH: f32 = 3.0;
// Erosion of a scrap relative to that of a body, and a scrap's density.
const SCRAP_EROSION: f32 = 1.5;
const SCRAP_DENSITY: f32 = 0.01;

// The signed field after erosion.
fn eroded(field: f32, amount: f32, firm: f32) -> f32 {
  let deepest = amount * mix(SCRAP_EROSION, 1.0, firm) * EROSION_DEPTH;
  return field - deepest * (1.0 - clamp(field / EROSION_DEPTH, 0.0, 1.0));
}

// Steepness of the density over the signed field.
const STEEPNESS: f32 = 1.7;

// Whether erosion can change the density at this value: where even the strongest leaves full density, it cannot.
fn near_surface(field: f32, firm: f32, layer: LayerUniforms) -> bool {
  return eroded(field, layer.detail_strength, firm) * STEEPNESS * layer.sharpness < 1.0;
}

// Density 0..1. Liquid water grows with height above the base, nearly as its power 2/3 (Brenguier et al. 2000).
fn profile_density(field: f32, firm: f32, layer: LayerUniforms, h: f32) -> f32 {
  let solid = smoothstep(0.0, 1.0, field * STEEPNESS * layer.sharpness) * mix(SCRAP_DENSITY, 1.0, firm * firm);
  return solid * mix(0.45, 1.0, clamp(h * 1.2, 0.0, 1.0));
}

// Never below the density anywhere in a cell whose greatest map body is given.
fn profile_bound(greatest_body: f32, layer: LayerUniforms) -> f32 {
  let body = mix(greatest_body, sqrt(greatest_body), layer.anvil);
  let strength = max(layer.shape_strength, 0.0);
  let lumps = noise_amplitude(body);
  let field = (1.2 * body - THINNEST_PROFILE + max(strength * (lumps - 0.65), 0.7 * strength * (lumps - 0.65))) * 2.2;
  return smoothstep(0.0, 1.0, field * STEEPNESS * layer.sharpness);
}
