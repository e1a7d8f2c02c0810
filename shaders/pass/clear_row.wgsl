// How far it is from each cell to the nearest one that may hold cloud, along the map from west to east, over whose end it
// repeats: two walks along each row, for one that looked round every cell would look far where there is nothing.
#import "generated/LayerUniforms.wgsl"
#import "generated/SceneUniforms.wgsl"
#import "pass/clear_way.wgsl"

override LAYERS: u32 = 1u;
// 0: from west to east, cells since the last that may hold cloud. 1: back, metres to the nearer of both.
override BACK: u32 = 0u;

@group(1) @binding(0) var<uniform> scene: SceneUniforms;
@group(2) @binding(0) var ways_before: texture_3d<f32>;
@group(2) @binding(1) var ways_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(ways_out);
  if (any(id.xy >= size.yz)) {
    return;
  }
  let cells = f32(size.x);
  var walls = vec4f(0.0);
  for (var i = 0u; i < LAYERS; i++) {
    walls[i] = 1.0 / (scene.layers[i].map_from_world.z * cells);
  }
  // Once round to know what came before the row's first cell, and once more.
  var since = vec4f(cells);
  for (var i = 0u; i < 2u * size.x; i++) {
    let along = i % size.x;
    let cell = vec3u(select(along, size.x - 1u - along, BACK == 1u), id.xy);
    let before = textureLoad(ways_before, cell, 0);
    since = select(min(since + 1.0, vec4f(cells)), vec4f(0.0), before == vec4f(0.0));
    if (i >= size.x) {
      let nearest = min(since, before);
      let metres = select(max(nearest - 1.0, vec4f(0.0)) * walls, vec4f(FARTHEST_M), nearest >= vec4f(cells));
      textureStore(ways_out, cell, select(since, min(metres, vec4f(FARTHEST_M)), BACK == 1u));
    }
  }
}
