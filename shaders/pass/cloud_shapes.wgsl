// Clouds that are shapes: how far inside of them a place is stands for the profile of the program's own model.
#import "cloud/profile.wgsl"
#import "pass/shapes_distance.wgsl"

@group(1) @binding(23) var<uniform> shapes: ShapesUniforms;

// How much profile there is so far inside.
fn shapes_profile(distance: f32) -> f32 {
  return clamp(-distance * shapes.per_edge, 0.0, 1.0);
}
