// What is kept of a ray of the converged march between dispatches.

struct MarchedRay {
  light: vec3f,
  // Optical depth of the cloud before the ray's place: an empty buffer is a fresh ray, and what little light comes through
  // thick cloud loses nothing between dispatches.
  depth: f32,
  // Where it goes on; 0 before its first step.
  distance_m: f32,
  // Sums for the mean distance of what is seen.
  distance_sum: f32,
  weight_sum: f32,
  // 1 when it has reached its end.
  is_done: u32,
}
