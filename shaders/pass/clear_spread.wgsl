// How far it is from each cell to the nearest one that may hold cloud, from how far it is along the rows, one axis after the
// other (Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions", 2012, by brute force): gaps between the
// cells' walls, so that a way holds from anywhere in the cell. Across the map it repeats. A leaning layer is sheared: see
// promised_way.
#import "generated/BandUniforms.wgsl"
#import "generated/LayerUniforms.wgsl"
#import "generated/SceneUniforms.wgsl"
#import "pass/clear_way.wgsl"

override LAYERS: u32 = 1u;
// 1 upwards, then 2 from north to south.
override AXIS: u32 = 1u;

@group(0) @binding(1) var<uniform> band: BandUniforms;
@group(1) @binding(0) var<uniform> scene: SceneUniforms;
@group(2) @binding(0) var ways_before: texture_3d<f32>;
@group(2) @binding(1) var ways_out: texture_storage_3d<rgba16float, write>;

// Cells in a row along the axis that look round together, so that each place is read once for all of them: reading is what
// this costs. Four are written out below, and lines have a multiple of that.
const TOGETHER: i32 = 4;
// Half floats round, and altitude over a round planet is not quite a coordinate.
const SAFE: f32 = 0.98;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = vec3i(textureDimensions(ways_out));
  let length = size[AXIS];
  // Invocations beside each other look along parallel ways. Rows are those of the third axis, once for each block.
  let row = i32(id.y + band.first_row);
  var at = vec3i(0);
  at.x = i32(id.x);
  at[3u - AXIS] = row % size[3u - AXIS];
  let first = row / size[3u - AXIS] * TOGETHER;
  if (at.x >= size.x || first >= length || id.y >= band.rows) {
    return;
  }
  var wall = vec4f(0.0);
  // Channels without a layer ask for nothing.
  var far = vec4f(0.0);
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    wall[i] = select(1.0 / layer.map_from_world.z, 1.0 / layer.per_thickness, AXIS == 1u) / f32(length);
    far[i] = FARTHEST_M * FARTHEST_M;
  }
  var nearest = array<vec4f, TOGETHER>(far, far, far, far);
  // First these cells themselves, then one after the other on both sides.
  let reach = select(length / 2, length - 1, AXIS == 1u);
  for (var d = 1 - TOGETHER / 2; d <= reach; d++) {
    let gap = f32(max(d - 1, 0)) * wall;
    let greatest = max(max(nearest[0], nearest[1]), max(nearest[2], nearest[3]));
    // Cells farther away are no nearer to cloud for any of these.
    if (d > 0 && all(gap * gap >= greatest)) {
      break;
    }
    for (var side = 0; side < 2; side++) {
      let cell = select(first - d, first + TOGETHER - 1 + d, side == 1);
      // Above the highest and below the lowest cell these are asked again, which are nearer than they seem then.
      at[AXIS] = select((cell + length) % length, clamp(cell, 0, length - 1), AXIS == 1u);
      let before = textureLoad(ways_before, at, 0);
      for (var k = 0; k < TOGETHER; k++) {
        let apart = f32(max(abs(cell - first - k) - 1, 0)) * wall;
        nearest[k] = min(nearest[k], before * before + apart * apart);
      }
    }
  }
  for (var k = 0; k < TOGETHER; k++) {
    at[AXIS] = first + k;
    textureStore(ways_out, at, sqrt(nearest[k]) * select(1.0, SAFE, AXIS == 2u));
  }
}
