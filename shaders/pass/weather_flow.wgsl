// The weather map below, carried by a flow without sources or sinks: every place is taken back to where it was before. After a
// while that would wind everything up, so two of them take turns, each beginning anew where its weight is zero.
#import "generated/FlowUniforms.wgsl"

@group(0) @binding(0) var<uniform> flow: FlowUniforms;
@group(0) @binding(1) var linear_repeat: sampler;
@group(1) @binding(2) var map_below: texture_2d<f32>;
@group(2) @binding(0) var map_out: texture_storage_2d<rgba16float, write>;

const FLOW_UNIFORM: u32 = 0u;
const FLOW_VORTEX: u32 = 1u;
const FLOW_BAND: u32 = 2u;

// Falls from 1 to 0 over a radius, smoothly at both ends.
fn bell(q: f32) -> f32 {
  let rest = max(1.0 - q * q, 0.0);
  return rest * rest;
}

// The nearest of a coordinate's copies, where the map repeats.
fn nearest(x: vec2f) -> vec2f {
  return x - select(vec2f(0.0), round(x), flow.repeats != 0u);
}

// Where the cloud at a place was, after so much of the flow.
fn before(uv: vec2f, amount: f32) -> vec2f {
  let apart = nearest(uv - flow.centre);
  switch (flow.kind) {
    case FLOW_UNIFORM: {
      return uv - flow.along * amount;
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
      return uv - flow.along * (amount * sin(6.283185307 * dot(uv - flow.centre, flow.across)));
    }
  }
}

fn carried(uv: vec2f, amount: f32) -> vec4f {
  let place = before(uv, amount);
  let texel = textureSampleLevel(map_below, linear_repeat, place, 0.0);
  let is_outside = flow.repeats == 0u && any(abs(place - 0.5) > vec2f(0.5));
  return select(texel, vec4f(0.0, 0.0, 0.0, texel.a), is_outside);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(map_out);
  if (any(id.xy >= size)) {
    return;
  }
  let uv = (vec2f(id.xy) + 0.5) / vec2f(size);
  textureStore(map_out, id.xy, mix(carried(uv, flow.amounts.y), carried(uv, flow.amounts.x), flow.share));
}
