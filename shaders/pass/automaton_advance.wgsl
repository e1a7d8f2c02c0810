// One generation of the automaton.
#import "cloud/automaton.wgsl"
#import "generated/BandUniforms.wgsl"

@group(0) @binding(0) var<uniform> band: BandUniforms;
@group(1) @binding(0) var<uniform> automaton: AutomatonUniforms;
@group(1) @binding(1) var<storage, read> cells_before: array<vec4u>;
@group(1) @binding(2) var<storage, read> favour: array<u32>;
@group(2) @binding(0) var<storage, read_write> cells_out: array<vec4u>;

fn condensing(column: vec2i, word: u32) -> u32 {
  return cells_before[word_index(automaton, column, word)].y;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let column = vec2i(vec2u(id.x, id.y + band.first_row));
  if (any(column >= vec2i(i32(automaton.cells))) || id.y >= band.rows) {
    return;
  }
  let count = words(automaton);
  let first = (u32(column.y) * automaton.cells + u32(column.x)) * automaton.levels;
  for (var word = 0u; word < count; word++) {
    let cells = cells_before[word_index(automaton, column, word)];
    var beside = 0u;
    for (var step = 1; step <= 2; step++) {
      beside |= condensing(column + vec2i(step, 0), word) | condensing(column - vec2i(step, 0), word);
      beside |= condensing(column + vec2i(0, step), word) | condensing(column - vec2i(0, step), word);
    }
    var below = 0u;
    if (word > 0u) {
      below = condensing(column, word - 1u);
    }
    var above = 0u;
    if (word + 1u < count) {
      above = condensing(column, word + 1u);
    }
    var vanishing = 0u;
    var humid = 0u;
    var condensed = 0u;
    for (var bit = 0u; bit < min(PER_WORD, automaton.levels - word * PER_WORD); bit++) {
      let cell = first + word * PER_WORD + bit;
      let happens = select(vec3u(0u), vec3u(1u << bit), dice(automaton, cell, favour[cell]));
      vanishing |= happens.x;
      humid |= happens.y;
      condensed |= happens.z;
    }
    let next = by_chance(grown(cells, kindled(cells.y, beside, below, above)), vanishing, humid, condensed);
    cells_out[word_index(automaton, column, word)] = next;
  }
}
