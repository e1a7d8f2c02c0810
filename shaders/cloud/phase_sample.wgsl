// Directions drawn from the phase functions of cloud/phase.wgsl, each exactly: no weight is left over.
#import "cloud/phase.wgsl"
#import "common/random.wgsl"

// Tries of the one phase function that is sampled by rejection; each is kept with a chance of at least a half.
const PHASE_TRIES: u32 = 32u;

// Henyey & Greenstein's cosine for u in 0..1: their inversion, multiplied out so that nothing cancels at g = 0.
fn henyey_greenstein_cosine(asymmetry: f32, u: f32) -> f32 {
  let g = clamp(asymmetry, -0.99, 0.99);
  let s = 2.0 * u - 1.0;
  let d = 1.0 + g * s;
  return clamp((s + 0.5 * g * (s * s + 3.0) + g * g * s + 0.5 * g * g * g * (s * s - 1.0)) / (d * d), -1.0, 1.0);
}

// Of Henyey & Greenstein's cosines those that Cornette & Shanks's factor (1 + cos^2) / 2 keeps.
fn cornette_shanks_cosine(asymmetry: f32, seed: vec3u) -> f32 {
  var cosine = 0.0;
  for (var i = 0u; i < PHASE_TRIES; i++) {
    let bits = pcg3d(seed + vec3u(0u, 0u, i * 0x9e3779b9u));
    cosine = henyey_greenstein_cosine(asymmetry, unit_from_bits(bits.x));
    if (2.0 * unit_from_bits(bits.y) < 1.0 + cosine * cosine) {
      break;
    }
  }
  return cosine;
}

// The distribution function of (1 - k^2) / (2 (1 - k cos)^2), inverted.
fn schlick_cosine(asymmetry: f32, u: f32) -> f32 {
  let g = clamp(asymmetry, -0.99, 0.99);
  let k = clamp(1.55 * g - 0.55 * g * g * g, -0.999, 0.999);
  let s = 2.0 * u - 1.0;
  return clamp((s + k) / (1.0 + k * s), -1.0, 1.0);
}

// The real root of cos^3 + 3 cos = 8 u - 4 (Frisvad, "Importance sampling the Rayleigh phase function", JOSA A 28(12), 2011).
fn rayleigh_cosine(u: f32) -> f32 {
  let q = 4.0 * u - 2.0;
  // The root is odd in q; for q < 0 the sum below would cancel.
  let a = pow(abs(q) + sqrt(q * q + 1.0), 1.0 / 3.0);
  return clamp(select(-1.0, 1.0, q >= 0.0) * (a - 1.0 / a), -1.0, 1.0);
}

// The direction at a cosine and an azimuth (turns, 0..1) about a unit vector.
fn direction_about(axis: vec3f, cosine: f32, turn: f32) -> vec3f {
  // Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
  let side = select(-1.0, 1.0, axis.z >= 0.0);
  let a = -1.0 / (side + axis.z);
  let b = axis.x * axis.y * a;
  let x = vec3f(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
  let y = vec3f(b, side + axis.y * axis.y * a, -axis.y);
  let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
  let angle = 2.0 * PI * turn;
  return normalize(x * (sine * cos(angle)) + y * (sine * sin(angle)) + axis * cosine);
}

// The direction in which light that travels along view_dir goes on. Three numbers come from each seed.
fn sample_phase(shape: PhaseShape, view_dir: vec3f, seed: vec3u) -> vec3f {
  let bits = pcg3d(seed);
  let u = unit_from_bits(bits.x);
  var cosine: f32;
  switch (shape.kind) {
#if PHASE_ONE_LOBE
    case PHASE_HENYEY_GREENSTEIN: {
      cosine = henyey_greenstein_cosine(shape.g, u);
    }
#endif
#if PHASE_TWO_LOBES
    case PHASE_TWO_LOBES: {
      let back = unit_from_bits(bits.z) < shape.back_mix;
      cosine = henyey_greenstein_cosine(select(shape.g, shape.back_g, back), u);
    }
#endif
#if PHASE_CORNETTE_SHANKS
    case PHASE_CORNETTE_SHANKS: {
      cosine = cornette_shanks_cosine(shape.g, seed + vec3u(0u, 0x85ebca6bu, 0u));
    }
#endif
#if PHASE_SCHLICK
    case PHASE_SCHLICK: {
      cosine = schlick_cosine(shape.g, u);
    }
#endif
#if PHASE_RAYLEIGH
    case PHASE_RAYLEIGH: {
      cosine = rayleigh_cosine(u);
    }
#endif
    default: {
      cosine = 2.0 * u - 1.0;
    }
  }
  return direction_about(view_dir, cosine, unit_from_bits(bits.y));
}
