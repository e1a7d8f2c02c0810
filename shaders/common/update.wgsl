// Which pixel each ray of a partial update computes (Koblížek 2019, section 3.2).
#import "generated/CameraUniforms.wgsl"
#import "generated/ViewUniforms.wgsl"

// The pixel of a ray; at the right and bottom edge of odd sizes several rays may share the last one.
fn pixel_of_ray(ray: vec2u, view: ViewUniforms) -> vec2u {
  var offset = view.update_offset;
  if (view.update_checkerboard == 1u) {
    offset.x = (ray.y + view.update_offset.x) & 1u;
  }
  return min(ray * view.update_block + offset, view.size - vec2u(1u));
}

// The ray whose block holds a pixel.
fn ray_of_pixel(pixel: vec2u, view: ViewUniforms) -> vec2u {
  return min(pixel / view.update_block, view.ray_count - vec2u(1u));
}
