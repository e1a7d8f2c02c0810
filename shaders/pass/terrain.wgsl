// The height of the ground, with its texture bound.
#import "generated/GroundUniforms.wgsl"

@group(1) @binding(10) var<uniform> ground: GroundUniforms;
#if TERRAIN
@group(1) @binding(11) var terrain_map: texture_2d<f32>;

// Height above sea level: ranges, hills between them, and the same again, small, so that near slopes are not smooth.
// The world's origin lies in a plain, so that a camera there sees.
fn terrain_height(p: vec2f, smp: sampler) -> f32 {
  let broad = textureSampleLevel(terrain_map, smp, p * ground.tile_from_world.z + ground.tile_from_world.xy, 0.0);
  let near_uv = p * ground.tile_from_world.z * 7.0 + ground.tile_from_world.xy * 7.0;
  let near = textureSampleLevel(terrain_map, smp, near_uv, 0.0);
  let ranges = broad.x * ground.mountains_m;
  let relief = ranges + (broad.y + 0.12 * near.y) * ground.hills_m + 0.10 * near.x * ranges;
  return relief * smoothstep(800.0, 7000.0, length(p - ground.plain_at));
}
#endif
