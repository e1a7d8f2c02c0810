// Cloudy cells as density: the mean around each, weighted 1 2 3 2 1 along every axis. A channel for the generation that is shown,
// the one after it, and the same of the run that hands over.
#import "cloud/automaton.wgsl"
#import "generated/BandUniforms.wgsl"

@group(0) @binding(0) var<uniform> band: BandUniforms;
@group(1) @binding(0) var<uniform> automaton: AutomatonUniforms;
@group(1) @binding(1) var<storage, read> cells_now: array<vec4u>;
@group(1) @binding(2) var<storage, read> cells_next: array<vec4u>;
#if HANDOVER
@group(1) @binding(3) var<storage, read> cells_before: array<vec4u>;
@group(1) @binding(4) var<storage, read> cells_before_next: array<vec4u>;
#endif
@group(2) @binding(0) var density_out: texture_storage_3d<rgba16float, write>;

const REACH: i32 = 2;
// Sum of the weights along an axis.
const WEIGHTS: f32 = 9.0;

fn cloudy(index: u32) -> vec4u {
#if HANDOVER
  return vec4u(cells_now[index].z, cells_next[index].z, cells_before[index].z, cells_before_next[index].z);
#else
  return vec4u(cells_now[index].z, cells_next[index].z, 0u, 0u);
#endif
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let column = vec2i(vec2u(id.x, id.y + band.first_row));
  if (any(column >= vec2i(i32(automaton.cells))) || id.y >= band.rows) {
    return;
  }
  let count = words(automaton);
  for (var word = 0u; word < count; word++) {
    var sums: array<vec4u, 32>;
    for (var y = -REACH; y <= REACH; y++) {
      for (var x = -REACH; x <= REACH; x++) {
        let beside = column + vec2i(x, y);
        let weight = u32((3 - abs(x)) * (3 - abs(y)));
        let own = cloudy(word_index(automaton, beside, word));
        var below = vec4u(0u);
        if (word > 0u) {
          below = cloudy(word_index(automaton, beside, word - 1u));
        }
        var above = vec4u(0u);
        if (word + 1u < count) {
          above = cloudy(word_index(automaton, beside, word + 1u));
        }
        if (all((own | below | above) == vec4u(0u))) {
          continue;
        }
        // Bit b + 2 of the first is cell b, and so on: the two cells below and the two above.
        let low = (own << vec4u(2u)) | (below >> vec4u(30u));
        let high = (own >> vec4u(2u)) | (above << vec4u(30u));
        for (var bit = 0u; bit < PER_WORD; bit++) {
          // Five cells around this one, the lowest first.
          let five = select((high >> vec4u(max(bit, 4u) - 4u)) & vec4u(31u), (low >> vec4u(bit)) & vec4u(31u), vec4<bool>(bit < 28u));
          let weighted = countOneBits(five) + countOneBits(five & vec4u(14u)) + countOneBits(five & vec4u(4u));
          sums[bit] += weighted * weight;
        }
      }
    }
    for (var bit = 0u; bit < min(PER_WORD, automaton.levels - word * PER_WORD); bit++) {
      let density = vec4f(sums[bit]) / (WEIGHTS * WEIGHTS * WEIGHTS);
      textureStore(density_out, vec3i(column.x, i32(word * PER_WORD + bit), column.y), density);
    }
  }
}
