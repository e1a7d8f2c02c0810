// The weather map as a picture: clear air, and how deep inside which kinds of cloud a place lies.
#import "cloud/weather.wgsl"
#import "generated/MapViewUniforms.wgsl"

@group(0) @binding(0) var<uniform> map_view: MapViewUniforms;
@group(0) @binding(1) var weather_map: texture_2d<f32>;
@group(2) @binding(0) var picture_out: texture_storage_2d<rgba8unorm, write>;

// As the screen shows them.
const CLEAR: vec3f = vec3f(0.13, 0.26, 0.44);
const CUMULUS: vec3f = vec3f(0.98, 0.98, 0.98);
const STRATUS: vec3f = vec3f(0.66, 0.72, 0.80);
const STRATOCUMULUS: vec3f = vec3f(0.93, 0.85, 0.70);

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(picture_out);
  if (any(id.xy >= size)) {
    return;
  }
  let texel = textureLoad(weather_map, id.xy * textureDimensions(weather_map) / size, 0);
  var weather = weather_from_texel(texel, map_view.cover);
  if (map_view.is_texture > 0.0) {
    // Of coverage, height and altitude the first says where cloud is.
    weather = Weather(body_of(texel.r, map_view.cover), vec3f(1.0, 0.0, 0.0), 0.0);
  }
  let types = mix(weather.types, map_view.form.xyz, map_view.form.w);
  let cloud = types.x * CUMULUS + types.y * STRATUS + types.z * STRATOCUMULUS;
  // Thin cloud is cloud: its edge has to be seen.
  let colour = mix(CLEAR, cloud, sqrt(weather.body));
  textureStore(picture_out, id.xy, vec4f(colour, 1.0));
}
