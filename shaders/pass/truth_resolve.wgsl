// The picture of a reference integrator so far, as the march leaves its own: light and transmittance, and distance. Of
// paths also the variance of the means: of the finished picture's light, and of the opacity.
#import "common/math.wgsl"
#import "generated/BandUniforms.wgsl"
#import "generated/CameraUniforms.wgsl"
#import "generated/TruthUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"
#if PATHS
#import "pass/path_state.wgsl"
#else
#import "pass/march_state.wgsl"
#endif

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var<uniform> band: BandUniforms;
@group(0) @binding(2) var<uniform> truth: TruthUniforms;
#if PATHS
@group(1) @binding(0) var<storage, read> paths: array<Path>;
@group(1) @binding(1) var<storage, read> path_sums: array<PathSums>;
@group(1) @binding(2) var background: texture_2d<f32>;
@group(2) @binding(2) var variance_out: texture_storage_2d<rgba32float, write>;
#else
@group(1) @binding(0) var<storage, read> marched_rays: array<MarchedRay>;
#endif
#if FLOAT
@group(2) @binding(0) var cloud_out: texture_storage_2d<rgba32float, write>;
#else
@group(2) @binding(0) var cloud_out: texture_storage_2d<rgba16float, write>;
#endif
#if DISTANCE
@group(2) @binding(1) var distance_out: texture_storage_2d<r32float, write>;
#endif

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let pixel = vec2u(id.x, id.y + band.first_row);
  if (any(pixel >= view.size) || id.y >= band.rows) {
    return;
  }
  let index = (pixel.y - truth.first_row) * view.size.x + pixel.x;
#if PATHS
  let sums = path_sums[index];
  let count = f32(max(paths[index].samples, 1u));
  let light = sums.light / count;
  let opacity = sums.hits / count;
  let transmittance = 1.0 - opacity;
  let distance_m = sums.distance_m / max(sums.hits, 1.0);
  // A sample's light is either the cloud's or the background's: L + (1 - O) b with L = L O.
  let behind = textureLoad(background, pixel, 0).rgb;
  let squares = max(sums.light_squared / count - light * light, vec3f(0.0));
  let bernoulli = opacity * (1.0 - opacity);
  let spread = squares - 2.0 * behind * light * (1.0 - opacity) + behind * behind * bernoulli;
  textureStore(variance_out, pixel, vec4f(max(spread, vec3f(0.0)), bernoulli) / max(count - 1.0, 1.0));
#else
  let ray = marched_rays[index];
  let light = ray.light;
  let transmittance = exp(-ray.depth);
  let distance_m = ray.distance_sum / max(ray.weight_sum, 1e-6);
#endif
#if FLOAT
  textureStore(cloud_out, pixel, vec4f(light, transmittance));
#else
  textureStore(cloud_out, pixel, sanitise4(vec4f(light, transmittance)));
#endif
#if DISTANCE
  textureStore(distance_out, pixel, vec4f(distance_m, 0.0, 0.0, 0.0));
#endif
}
