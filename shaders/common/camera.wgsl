// Rays of the picture, and where a direction falls on it.
//
// `right` and `up` of a perspective camera are scaled so that the picture spans -1..1; the others keep unit axes.
#import "common/math.wgsl"
#import "generated/CameraUniforms.wgsl"

const PROJECTION_PERSPECTIVE: u32 = 0u;
const PROJECTION_EQUIRECT: u32 = 1u;
const PROJECTION_DOME: u32 = 2u;

// Unit direction through a point of the picture, which may be a part of a larger one; 0..1 from its top left.
fn ray_through(camera: CameraUniforms, part_uv: vec2f) -> vec3f {
  let uv = camera.window_offset + part_uv * camera.window_size;
  if (camera.projection == PROJECTION_PERSPECTIVE) {
    let v = uv * 2.0 - 1.0;
    return normalize(camera.forward + v.x * camera.right - v.y * camera.up);
  }
  let azimuth = camera.heading_rad + (uv.x - 0.5) * 2.0 * PI;
  let elevation = select(0.5 - uv.y, 0.5 - 0.5 * uv.y, camera.projection == PROJECTION_DOME) * PI;
  let flat = cos(elevation);
  return vec3f(flat * sin(azimuth), sin(elevation), -flat * cos(azimuth));
}

// Where a direction falls: uv, and 1 in z when it lies on the picture's side at all.
fn picture_point(camera: CameraUniforms, dir: vec3f) -> vec3f {
  if (camera.projection == PROJECTION_PERSPECTIVE) {
    let depth = dot(dir, camera.forward);
    let x = dot(dir, camera.right) / dot(camera.right, camera.right);
    let y = dot(dir, camera.up) / dot(camera.up, camera.up);
    let uv = vec2f(x, -y) / max(depth, 1e-6) * 0.5 + 0.5;
    return vec3f((uv - camera.window_offset) / camera.window_size, select(0.0, 1.0, depth > 1e-4));
  }
  let flat = length(dir.xz);
  // atan2(0, 0) differs between drivers: straight up has any azimuth.
  let azimuth = select(0.0, atan2(dir.x, -dir.z), flat > 1e-7);
  let turn = (azimuth - camera.heading_rad) / (2.0 * PI) + 0.5;
  let elevation = atan2(dir.y, max(flat, 1e-12)) / PI;
  let v = select(0.5 - elevation, 1.0 - 2.0 * elevation, camera.projection == PROJECTION_DOME);
  return vec3f((vec2f(turn - floor(turn), v) - camera.window_offset) / camera.window_size, 1.0);
}
