// Carries each level of the automaton on with the wind, in whole cells.
#import "cloud/automaton.wgsl"
#import "generated/BandUniforms.wgsl"

@group(0) @binding(0) var<uniform> band: BandUniforms;
@group(1) @binding(0) var<uniform> automaton: AutomatonUniforms;
@group(1) @binding(1) var<storage, read> cells_before: array<vec4u>;
@group(2) @binding(0) var<storage, read_write> cells_out: array<vec4u>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let column = vec2i(vec2u(id.x, id.y + band.first_row));
  if (any(column >= vec2i(i32(automaton.cells))) || id.y >= band.rows) {
    return;
  }
  for (var word = 0u; word < words(automaton); word++) {
    var cells = Cells(0u);
    for (var bit = 0u; bit < min(PER_WORD, automaton.levels - word * PER_WORD); bit++) {
      let upwind = column - carried(automaton, word * PER_WORD + bit);
      cells |= cells_before[word_index(automaton, upwind, word)] & vec4u(1u << bit);
    }
    cells_out[word_index(automaton, column, word)] = cells;
  }
}
