// The weather map below, advected by a flow without divergence: every place is taken back to where it was before. After a while
// that would wind everything up, so two of them take turns, each beginning anew where its weight is zero (Max and Becker, "Flow
// Visualization Using Moving Textures", 1995; Neyret, "Advected Textures", 2003).
#import "generated/FlowUniforms.wgsl"

@group(0) @binding(0) var<uniform> flow: FlowUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(1) @binding(2) var map_below: texture_2d<f32>;
@group(2) @binding(0) var map_out: texture_storage_2d<rgba16float, write>;

const FLOW_UNIFORM: u32 = 0u;
const FLOW_VORTEX: u32 = 1u;
const FLOW_BAND: u32 = 2u;

const EDGE_REPEAT: u32 = 0u;
const EDGE_CLEAR: u32 = 2u;

// Places so far apart on the map, in its edges, have little to do with each other.
const CORRELATED: f32 = 0.04;

// Falls from 1 to 0 over a radius, smoothly at both ends.
fn bell(q: f32) -> f32 {
  let rest = max(1.0 - q * q, 0.0);
  return rest * rest;
}

// The nearest of a coordinate's copies, where the map repeats.
fn nearest(x: vec2f) -> vec2f {
  return x - select(vec2f(0.0), round(x), flow.edge == EDGE_REPEAT);
}

// Where the cloud at a place was, after so much of the flow.
fn before(uv: vec2f, amount: f32) -> vec2f {
  let apart = nearest(uv - flow.centre);
  switch (flow.kind) {
    case FLOW_UNIFORM: {
      return uv - flow.along;
    }
    case FLOW_VORTEX: {
      // Circles turn as a whole, the inner ones faster.
      let turn = -amount * bell(length(apart) / flow.radius);
      let turned = vec2f(apart.x * cos(turn) - apart.y * sin(turn), apart.x * sin(turn) + apart.y * cos(turn));
      return uv + turned - apart;
    }
    case FLOW_BAND: {
      let across = nearest(vec2f(dot(uv - flow.centre, flow.across))).x / length(flow.across);
      return uv - flow.along * (amount * bell(across / flow.radius));
    }
    default: {
      return uv - flow.along * (amount * cos(6.283185307 * dot(uv - flow.centre, flow.across)));
    }
  }
}

fn texel_at(place: vec2f) -> vec4f {
  if (flow.edge == EDGE_REPEAT) {
    return textureSampleLevel(map_below, linear_repeat, place, 0.0);
  }
  let half_texel = 0.5 / vec2f(textureDimensions(map_below));
  let texel = textureSampleLevel(map_below, linear_repeat, clamp(place, half_texel, 1.0 - half_texel), 0.0);
  let is_nothing = flow.edge == EDGE_CLEAR && any(abs(place - 0.5) > vec2f(0.5));
  return select(texel, vec4f(0.0, 0.0, 0.0, texel.a), is_nothing);
}

// Texels across the map whose mean stands for that of all.
const SAMPLED: u32 = 32u;
var<workgroup> sums: array<vec4f, 64>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
  let size = textureDimensions(map_out);
  let below = textureDimensions(map_below);
  var sum = vec4f(0.0);
  for (var i = lane; i < SAMPLED * SAMPLED; i += 64u) {
    sum += textureLoad(map_below, vec2u(i % SAMPLED, i / SAMPLED) * below / SAMPLED, 0);
  }
  sums[lane] = sum;
  workgroupBarrier();
  var mean = vec4f(0.0);
  for (var i = 0u; i < 64u; i++) {
    mean += sums[i] / f32(SAMPLED * SAMPLED);
  }
  if (any(id.xy >= size)) {
    return;
  }
  let uv = (vec2f(id.xy) + 0.5) / vec2f(size);
  let places = array(before(uv, flow.amounts.x), before(uv, flow.amounts.y));
  let weights = vec2f(flow.share, 1.0 - flow.share);
  // A mean of what has nothing to do with each other varies less than either, and less of it would be cloud: as much as they
  // differ in place, it is spread again.
  let apart = length(nearest(places[0] - places[1])) / CORRELATED;
  let alike = exp(-apart * apart);
  let spread = inverseSqrt(dot(weights, weights) + 2.0 * alike * weights.x * weights.y);
  let blended = weights.x * (texel_at(places[0]) - mean) + weights.y * (texel_at(places[1]) - mean);
  textureStore(map_out, id.xy, clamp(mean + blended * spread, vec4f(0.0), vec4f(1.0)));
}
