// How favourable each cell's air is to clouds.
#import "cloud/automaton.wgsl"
#import "generated/BandUniforms.wgsl"

@group(0) @binding(0) var<uniform> band: BandUniforms;
@group(1) @binding(0) var<uniform> automaton: AutomatonUniforms;
@group(2) @binding(0) var<storage, read_write> favour_out: array<u32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let column = vec2u(id.x, id.y + band.first_row);
  if (any(column >= vec2u(automaton.cells)) || id.y >= band.rows) {
    return;
  }
  let broad = broad_noise(automaton, column);
  let first = (column.y * automaton.cells + column.x) * automaton.levels;
  for (var level = 0u; level < automaton.levels; level++) {
    favour_out[first + level] = favour_of(automaton, column, broad, level);
  }
}
