// What is kept of a pixel's path between dispatches, and the sums over its samples.

struct Path {
  position: vec3f,
  mode: u32,
  dir: vec3f,
  // How far it goes in this direction before it has left the domain for good.
  left_m: f32,
  // Where it last scattered, and where it goes from there once the light has been asked for.
  anchor: vec3f,
  // Transmittance towards the light so far.
  through: f32,
  next_dir: vec3f,
  // Distance of the first scattering from the eye.
  first_m: f32,
  throughput: vec3f,
  // Samples finished.
  samples: u32,
  light: vec3f,
  // Random numbers drawn for this sample.
  drawn: u32,
  // Light that waits for its transmittance.
  pending: vec3f,
  scatterings: u32,
  // Artists' gains of the first scattering: of the key light, of the sky.
  gains: vec2f,
  pixel: u32,
  pad: u32,
}

// Sums over a pixel's samples.
struct PathSums {
  light: vec3f,
  hits: f32,
  light_squared: vec3f,
  distance_m: f32,
}
