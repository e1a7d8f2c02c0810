// Counts the pixels of a picture by the logarithm of their luminance, for the histogram and the exposure meter.
#import "pass/composed.wgsl"

const BINS = 320u;
const BINS_PER_STOP = 8.0;
const LOWEST_STOP = -24.0;

@group(2) @binding(0) var<storage, read_write> bins: array<atomic<u32>>;

var<workgroup> own: array<atomic<u32>, BINS>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) index: u32) {
  for (var bin = index; bin < BINS; bin += 64u) {
    atomicStore(&own[bin], 0u);
  }
  workgroupBarrier();
  if (all(id.xy < view.size)) {
    let stops = log2(max(luminance709(composed_light(id.xy)), 1e-12)) - LOWEST_STOP;
    atomicAdd(&own[u32(clamp(stops * BINS_PER_STOP, 0.0, f32(BINS - 1u)))], 1u);
  }
  workgroupBarrier();
  for (var bin = index; bin < BINS; bin += 64u) {
    let count = atomicLoad(&own[bin]);
    if (count > 0u) {
      atomicAdd(&bins[bin], count);
    }
  }
}
