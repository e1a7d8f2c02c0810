// Phase functions, all in 1/sr: each integrates to 1 over the sphere.
//
// view_dir points from the eye into the scene, towards_sun from the sample to the sun, so that looking at the sun is
// scattering straight on (cosine +1). Both are unit vectors. Denominators come from |view_dir - towards_sun|^2
// because 1 + g^2 - 2 g cos cancels: 39 % off at g = 0.999 in f32.
#import "common/math.wgsl"

const PHASE_ISOTROPIC: u32 = 0u;
const PHASE_HENYEY_GREENSTEIN: u32 = 1u;
const PHASE_TWO_LOBES: u32 = 2u;
const PHASE_CORNETTE_SHANKS: u32 = 3u;
const PHASE_SCHLICK: u32 = 4u;
const PHASE_RAYLEIGH: u32 = 5u;

struct PhaseShape {
  // One of the PHASE_ constants.
  kind: u32,
  // Asymmetry -1..1, clamped to +-0.99; the mean cosine for kinds 1 and 2 only.
  g: f32,
  // Asymmetry of the second lobe (kind 2), usually negative.
  back_g: f32,
  // Share 0..1 of the second lobe (kind 2).
  back_mix: f32,
}

// 1 + g^2 - 2 g cos without cancellation for either sign of g.
fn phase_denominator(g: f32, view_dir: vec3f, towards_sun: vec3f) -> f32 {
  let k = abs(g);
  let e = view_dir - select(-1.0, 1.0, g >= 0.0) * towards_sun;
  return (1.0 - k) * (1.0 - k) + k * dot(e, e);
}

// Henyey & Greenstein, "Diffuse Radiation in the Galaxy", 1941, with the 1/(4 pi) that makes it a density.
fn henyey_greenstein(asymmetry: f32, view_dir: vec3f, towards_sun: vec3f) -> f32 {
  let g = clamp(asymmetry, -0.99, 0.99);
  let d = phase_denominator(g, view_dir, towards_sun);
  return (1.0 - g) * (1.0 + g) / (4.0 * PI * d * sqrt(d));
}

// Cornette & Shanks, "Physically Reasonable Analytic Expression for the Single-Scattering Phase Function", Applied
// Optics 31(16), 1992, equation 8. Its mean cosine is 3 g (4 + g^2) / (5 (2 + g^2)), not g.
fn cornette_shanks(asymmetry: f32, view_dir: vec3f, towards_sun: vec3f) -> f32 {
  let g = clamp(asymmetry, -0.99, 0.99);
  let cosine = clamp(dot(view_dir, towards_sun), -1.0, 1.0);
  return henyey_greenstein(g, view_dir, towards_sun) * 1.5 * (1.0 + cosine * cosine) / (2.0 + g * g);
}

// Blasi, Le Saec & Schlick, "A Rendering Algorithm for Discrete Volume Density Objects", 1993, with the sign that
// scatters forward for k > 0. Their k = 1.55 g - 0.55 g^3 passes 1 at g = 0.938, where the function has a pole.
fn schlick(asymmetry: f32, view_dir: vec3f, towards_sun: vec3f) -> f32 {
  let g = clamp(asymmetry, -0.99, 0.99);
  let k = clamp(1.55 * g - 0.55 * g * g * g, -0.999, 0.999);
  let e = view_dir - select(-1.0, 1.0, k >= 0.0) * towards_sun;
  let d = (1.0 - abs(k)) + 0.5 * abs(k) * dot(e, e);
  return (1.0 - k) * (1.0 + k) / (4.0 * PI * d * d);
}

fn rayleigh(view_dir: vec3f, towards_sun: vec3f) -> f32 {
  let cosine = clamp(dot(view_dir, towards_sun), -1.0, 1.0);
  return 3.0 / (16.0 * PI) * (1.0 + cosine * cosine);
}

// The phase function of one scattering order: both asymmetries times anisotropy_scale (0..1), as the octaves of
// Wrenninge, Kulla & Lundqvist, "Oz: The Great and Volumetric", SIGGRAPH 2013 Talks, flatten theirs.
fn phase_scaled(shape: PhaseShape, anisotropy_scale: f32, view_dir: vec3f, towards_sun: vec3f) -> f32 {
  let g = shape.g * anisotropy_scale;
  switch (shape.kind) {
#if PHASE_ONE_LOBE
    case PHASE_HENYEY_GREENSTEIN: {
      return henyey_greenstein(g, view_dir, towards_sun);
    }
#endif
#if PHASE_TWO_LOBES
    case PHASE_TWO_LOBES: {
      let back = henyey_greenstein(shape.back_g * anisotropy_scale, view_dir, towards_sun);
      return mix(henyey_greenstein(g, view_dir, towards_sun), back, shape.back_mix);
    }
#endif
#if PHASE_CORNETTE_SHANKS
    case PHASE_CORNETTE_SHANKS: {
      return cornette_shanks(g, view_dir, towards_sun);
    }
#endif
#if PHASE_SCHLICK
    case PHASE_SCHLICK: {
      return schlick(g, view_dir, towards_sun);
    }
#endif
#if PHASE_RAYLEIGH
    case PHASE_RAYLEIGH: {
      return rayleigh(view_dir, towards_sun);
    }
#endif
    default: {
      return 1.0 / (4.0 * PI);
    }
  }
}

fn phase(shape: PhaseShape, view_dir: vec3f, towards_sun: vec3f) -> f32 {
  return phase_scaled(shape, 1.0, view_dir, towards_sun);
}
