// The height of the ground, with its texture bound.
#import "generated/GroundUniforms.wgsl"

@group(1) @binding(10) var<uniform> ground: GroundUniforms;
#if TERRAIN
@group(1) @binding(11) var terrain_map: texture_2d<f32>;

// The world's origin lies in a plain, so that a camera there sees: no relief within the first radius, all ranges from
// the second on, all hills from the third. Hills that stood nearer would end the view of someone who stands in the plain
// where the air is still clear, a hard dark edge under the hazy sky.
const PLAIN_M: f32 = 800.0;
const RANGES_FROM_M: f32 = 7000.0;
const HILLS_FROM_M: f32 = 24000.0;
// Distance to which the small copy of the relief is read.
const FINE_RELIEF_M: f32 = 2500.0;

// Height above sea level, seen from a distance: ranges, hills between them, and near the eye the same again, small, so
// that near slopes are not smooth.
fn terrain_height(p: vec2f, distance_m: f32, smp: sampler) -> f32 {
  let out = length(p - ground.plain_at);
  if (out < PLAIN_M) {
    return 0.0;
  }
  let uv = p * ground.tile_from_world.z + ground.tile_from_world.xy;
  let broad = textureSampleLevel(terrain_map, smp, uv, 0.0);
  let ranges = broad.x * ground.mountains_m * smoothstep(PLAIN_M, RANGES_FROM_M, out);
  let hills_m = ground.hills_m * smoothstep(PLAIN_M, HILLS_FROM_M, out);
  var relief = ranges + broad.y * hills_m;
  if (distance_m < FINE_RELIEF_M) {
    let fine = textureSampleLevel(terrain_map, smp, uv * 7.0, 0.0);
    let fade = 1.0 - distance_m / FINE_RELIEF_M;
    relief += fade * (0.12 * (fine.y - 0.5) * hills_m + 0.10 * fine.x * ranges);
  }
  return relief;
}
#endif
