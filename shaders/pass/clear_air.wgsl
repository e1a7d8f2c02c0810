// What places without cloud say of the air about them: how near a surface is, and how far no cloud is.
#import "common/shell.wgsl"
#import "generated/LayerUniforms.wgsl"

#if SKIP
@group(1) @binding(7) var clear_ways: texture_3d<f32>;
#endif

// How near the last place read was to a surface, where it was clear: 1 far away, towards 0 near. The march shortens its
// steps by it, so that thin edges are not met by some pixels and missed by others; less where that layer by itself is no denser
// than what a whole step may leap into, in 1/m, which the march says.
var<private> clearness: f32;
var<private> sparse_extinction: f32;

const LEAST_CLEARNESS: f32 = 0.25;

fn note_clearness(layer: LayerUniforms, of_layer: f32) {
  let extinction = max(layer.extinction_per_m * layer.density_scale, 1e-12);
  clearness = min(clearness, max(of_layer, clamp(sparse_extinction / extinction, LEAST_CLEARNESS, 1.0)));
}

// How far from the last place read, where it was clear, no cloud is promised in the direction that was asked for.
var<private> clear_way: f32;

#if MAPLESS
#else
#if SKIP
// How far the map promises clear air from a place, read in its cell. Through a leaning layer that is the shorter the
// steeper it is.
fn promised_way(index: u32, p: vec3f, h: f32, towards: vec3f) -> f32 {
  count_read();
  let layer = scene.layers[index];
  let uv = map_uv(layer, p.xz, h);
  let cells = vec3f(textureDimensions(clear_ways));
  let cell = vec3u(min(vec3f(uv - floor(uv), h).xzy * cells, cells - 1.0));
  let way = textureLoad(clear_ways, cell, 0)[index];
  // How far a place is carried at most as it rises, relative to how far it rises.
  let shear = 2.0 * length(layer.lean.xy) * layer.per_thickness;
  if (DOMAIN == DOMAIN_SHELL) {
    let slope = steepest(p, towards, way, scene.planet_radius_m);
    return way / ((1.0 + shear * slope) * flattening(p, way, scene.planet_radius_m));
  }
  return way / (1.0 + shear * abs(towards.y));
}
#endif

// From the end of one promised way the next is asked for, so often: a read is less than a sample. And so often along a
// whole ray, or many rays side by side that hop at different samples could use up the rounds that llvmpipe gives to loops.
const HOPS: u32 = 8u;
var<private> hops_left: u32 = 512u;

// Called where the map says that a layer has no cloud: asks for how far.
fn note_clear(index: u32, p: vec3f, h: f32, reading: Reading) {
  var way = 0.0;
#if SKIP
  if (any(reading.towards != vec3f(0.0))) {
    let layer = scene.layers[index];
    var there = p;
    var h_there = h;
    for (var hop = 0u; hop < HOPS; hop++) {
      let more = promised_way(index, there, h_there, reading.towards);
      way += more;
      there = p + reading.towards * way;
      h_there = (altitude_of(there) - layer.base_m) * layer.per_thickness;
      if (more <= 0.1 * way || way >= clear_way || abs(h_there - 0.5) >= 0.5 || hops_left == 0u) {
        break;
      }
      hops_left -= 1u;
    }
  }
#endif
  clear_way = min(clear_way, way);
}
#endif

// From a place outside of a layer to where a ray enters its heights.
fn way_to(layer: LayerUniforms, p: vec3f, dir: vec3f) -> f32 {
  let top_m = layer.base_m + 1.0 / layer.per_thickness;
  var ahead = Segments(vec2f(0.0), vec2f(0.0));
  if (DOMAIN == DOMAIN_SHELL) {
    ahead = shell_segments(p, dir, layer.base_m, top_m, scene.planet_radius_m);
  } else {
    ahead = slab_segments(p, dir, layer.base_m, top_m);
  }
  return select(FAR_M, ahead.first.x, ahead.first.y > ahead.first.x);
}
