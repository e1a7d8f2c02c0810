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

// Half floats round, and altitude over a round planet is not quite a coordinate.
const SAFE: f32 = 0.98;

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let here = id + vec3u(0u, 0u, band.first_row);
  let size = vec3i(textureDimensions(ways_out));
  if (any(vec3i(here) >= size) || id.z >= band.rows) {
    return;
  }
  var wall = vec4f(0.0);
  // Channels without a layer ask for nothing.
  var nearest = vec4f(0.0);
  for (var i = 0u; i < LAYERS; i++) {
    let layer = scene.layers[i];
    wall[i] = select(1.0 / layer.map_from_world.z, 1.0 / layer.per_thickness, AXIS == 1u) / f32(size[AXIS]);
    nearest[i] = FARTHEST_M;
  }
  let reach = select(size[AXIS] / 2, size[AXIS] - 1, AXIS == 1u);
  for (var d = 0; d <= reach; d++) {
    let gap = f32(max(d - 1, 0)) * wall;
    // Cells farther away are no nearer to cloud.
    if (all(gap >= nearest)) {
      break;
    }
    for (var side = -1; side <= 1; side += 2) {
      var cell = vec3i(here);
      cell[AXIS] += side * d;
      if (AXIS != 1u || (cell.y >= 0 && cell.y < size.y)) {
        let before = textureLoad(ways_before, (cell + size) % size, 0);
        nearest = min(nearest, sqrt(before * before + gap * gap));
      }
    }
  }
  if (AXIS == 2u) {
    nearest *= SAFE;
  }
  textureStore(ways_out, here, nearest);
}
