// Evaluates cloud/{weather,profile,thesis,map_field}.wgsl. Case: a = texel of the weather map; b = large noise;
// c = small noise; d = h, fade, bias. The layer of each case is in an array of its own. For `eval_map`: a = uv, phase, 1 for a weather texture;
// b = seed, large cells as integers, small share, fray; c = contrast and the weights of the types.
#import "cloud/costa.wgsl"
#import "cloud/map_field.wgsl"
#import "cloud/profile.wgsl"
#import "cloud/thesis.wgsl"
#import "test/eval_io.wgsl"

@group(0) @binding(2) var<storage, read> layers: array<LayerUniforms>;

struct Place {
  weather: Weather,
  layer: LayerUniforms,
  large: vec4f,
  small: vec4f,
  h: f32,
  fade: f32,
}

fn place(id: vec3u) -> Place {
  let layer = layers[id.x];
  let d = bitcast<vec4f>(cases[id.x].d);
  let weather = weather_from_texel(bitcast<vec4f>(cases[id.x].a), vec2f(layer.body_scale, d.z));
  return Place(weather, layer, bitcast<vec4f>(cases[id.x].b), bitcast<vec4f>(cases[id.x].c), d.x, d.y);
}

@compute @workgroup_size(64) fn eval_weather(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let at = place(id);
  store(id, vec4f(at.weather.body, at.weather.types));
}

@compute @workgroup_size(64) fn eval_profile(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let at = place(id);
  let profile = height_profile(at.weather, at.layer, at.h);
  let field = billowed(profile, at.large, at.weather, at.layer);
  let firm = firmness(profile, at.large, at.weather, at.layer);
  store(id, vec4f(firm, profile, field, erosion(at.small, firm, at.layer, at.h, at.fade)));
}

// Density, bound, and the density without erosion.
@compute @workgroup_size(64) fn eval_profile_density(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let at = place(id);
  let profile = height_profile(at.weather, at.layer, at.h);
  let field = billowed(profile, at.large, at.weather, at.layer);
  let firm = firmness(profile, at.large, at.weather, at.layer);
  let amount = erosion(at.small, firm, at.layer, at.h, at.fade);
  let density = profile_density(eroded(field, amount, firm), firm, at.layer, at.h);
  store(id, vec4f(density, profile_bound(at.weather.body, at.layer), profile_density(field, firm, at.layer, at.h),
    select(0.0, 1.0, near_surface(field, firm, at.layer))));
}

@compute @workgroup_size(64) fn eval_thesis(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let at = place(id);
  let profile = thesis_profile(at.weather, at.h);
  store(id, vec4f(profile, thesis_field(profile, at.large, at.weather, at.layer)));
}

@compute @workgroup_size(64) fn eval_thesis_density(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let at = place(id);
  let field = thesis_field(thesis_profile(at.weather, at.h), at.large, at.weather, at.layer);
  let density = thesis_density(thesis_eroded(field, at.small, at.layer, at.fade), at.layer);
  store(id, vec4f(density, thesis_bound(at.weather.body, at.layer), thesis_density(field, at.layer),
    select(0.0, 1.0, thesis_near_surface(field, at.layer))));
}

// After the large noise, the density, its bound, and the bound of the coverage alone.
@compute @workgroup_size(64) fn eval_costa(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let at = place(id);
  let texel = bitcast<vec4f>(cases[id.x].a);
  let coverage = body_of(texel.r, vec2f(at.layer.body_scale, bitcast<vec4f>(cases[id.x].d).z));
  let shaped = costa_shaped(coverage * height_signal(texel, at.h), at.large, at.layer);
  let density = costa_density(costa_eroded(shaped, at.small, at.layer, at.fade), at.layer);
  store(id, vec4f(shaped, density, costa_bound(coverage, at.layer), 0.0));
}

@compute @workgroup_size(64) fn eval_map(@builtin(global_invocation_id) id: vec3u) {
  if (!is_case(id)) { return; }
  let a = bitcast<vec4f>(cases[id.x].a);
  let b = bitcast<vec4f>(cases[id.x].b);
  let c = bitcast<vec4f>(cases[id.x].c);
  var map: MapUniforms;
  map.phase = a.z;
  map.seed = cases[id.x].b.x;
  map.large_cells = cases[id.x].b.y;
  map.small_share = b.z;
  map.fray = b.w;
  map.contrast = c.x;
  map.cumulus = c.y;
  map.stratus = c.z;
  map.stratocumulus = c.w;
  if (a.w == 1.0) {
    store(id, weather_texture_at(a.xy, map));
  } else {
    store(id, map_texel_at(a.xy, map));
  }
}
