// Temporal reprojection (Koblížek 2019, section 3.2): this frame's rays fill their own pixels; every other pixel is
// fetched from where its cloud was in the picture before. The position comes from the marched distance of the nearest
// fresh ray, not from a constant height of 900 m (errata 9).
#import "common/camera.wgsl"
#import "common/math.wgsl"
#import "common/update.wgsl"
#import "generated/BandUniforms.wgsl"

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var<uniform> band: BandUniforms;
@group(1) @binding(0) var fresh_cloud: texture_2d<f32>;
@group(1) @binding(1) var fresh_distance: texture_2d<f32>;
#if HISTORY
@group(1) @binding(2) var history_cloud: texture_2d<f32>;
@group(1) @binding(4) var linear_clamp: sampler;
#endif
@group(2) @binding(0) var cloud_out: texture_storage_2d<rgba16float, write>;

// The four fresh rays around a pixel: blended, they stand in wherever there is no history, and history of what moved
// lies within what they show.
struct Fresh {
  blend: vec4f,
  low: vec4f,
  high: vec4f,
}

fn fresh_around(pixel: vec2u) -> Fresh {
  let place = (vec2f(pixel) - vec2f(view.update_offset)) / vec2f(view.update_block);
  let corner = vec2i(floor(place));
  let f = place - vec2f(corner);
  let last = vec2i(view.ray_count) - 1;
  let a = textureLoad(fresh_cloud, clamp(corner, vec2i(0), last), 0);
  let b = textureLoad(fresh_cloud, clamp(corner + vec2i(1, 0), vec2i(0), last), 0);
  let c = textureLoad(fresh_cloud, clamp(corner + vec2i(0, 1), vec2i(0), last), 0);
  let d = textureLoad(fresh_cloud, clamp(corner + vec2i(1, 1), vec2i(0), last), 0);
  let low = min(min(a, b), min(c, d));
  let high = max(max(a, b), max(c, d));
  let slack = (high - low) * 0.15;
  return Fresh(mix(mix(a, b, f.x), mix(c, d, f.x), f.y), low - slack, high + slack);
}

#if HISTORY
fn is_finite4(v: vec4f) -> bool {
  return is_finite_bits(v.x) && is_finite_bits(v.y) && is_finite_bits(v.z) && is_finite_bits(v.w);
}

struct Moved {
  cloud: vec4f,
  is_found: bool,
}

// What the picture before shows where the cloud of a pixel was then.
fn from_history(pixel: vec2u, distance_m: f32) -> Moved {
  // Clear sky has no distance: far away stands in for it.
  let reach = select(distance_m, 30000.0, distance_m <= 0.0);
  let dir = ray_through(view.camera, (vec2f(pixel) + 0.5) / vec2f(view.size));
  let place = view.camera.eye + dir * reach - view.cloud_motion_m;
  let before = picture_point(view.previous, normalize(place - view.previous.eye));
  let inside = before.z > 0.0 && all(before.xy >= vec2f(0.0)) && all(before.xy <= vec2f(1.0));
  let history = textureSampleLevel(history_cloud, linear_clamp, before.xy, 0.0);
  return Moved(history, inside && is_finite4(history));
}
#endif

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let pixel = vec2u(id.x, id.y + band.first_row);
  if (any(pixel >= view.size) || id.y >= band.rows) {
    return;
  }
  let ray = ray_of_pixel(pixel, view);
  var cloud: vec4f;
  if (all(pixel_of_ray(ray, view) == pixel)) {
    cloud = textureLoad(fresh_cloud, ray, 0);
  } else {
#if HISTORY
    if (view.is_still == 1u) {
      cloud = textureLoad(history_cloud, pixel, 0);
      if (!is_finite4(cloud)) {
        cloud = fresh_around(pixel).blend;
      }
    } else {
      let fresh = fresh_around(pixel);
      cloud = fresh.blend;
      // Where all around is the same, as in clear sky and before the ground, history could say nothing else.
      if (any(fresh.low != fresh.high)) {
        let moved = from_history(pixel, textureLoad(fresh_distance, ray, 0).x);
        if (moved.is_found) {
          cloud = clamp(moved.cloud, fresh.low, fresh.high);
        }
      }
    }
#else
    cloud = fresh_around(pixel).blend;
#endif
  }
  textureStore(cloud_out, pixel, sanitise4(cloud));
}
