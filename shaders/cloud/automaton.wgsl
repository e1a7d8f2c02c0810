// The rules of a cellular automaton for clouds (Dobashi, Kaneda, Yamashita, Okita and Nishita, "A simple, efficient method for
// realistic animation of clouds", 2000, section 4), for a column of cells at once: a bit for each, the lowest first.
//
// All of it is in whole numbers, so that every driver comes to the same clouds: ONE stands for 1.
#import "common/random.wgsl"
#import "generated/AutomatonUniforms.wgsl"

// A column's humid, condensing and cloudy cells, 32 of them; w is not used.
alias Cells = vec4u;

// Cells to a word.
const PER_WORD: u32 = 32u;
const ONE: i32 = 65536;

fn words(automaton: AutomatonUniforms) -> u32 {
  return (automaton.levels + PER_WORD - 1u) / PER_WORD;
}

// Where a word of a column lies; columns repeat beyond the edges.
fn word_index(automaton: AutomatonUniforms, column: vec2i, word: u32) -> u32 {
  let n = i32(automaton.cells);
  let at = vec2u(((column % n) + n) % n);
  return (word * automaton.cells + at.y) * automaton.cells + at.x;
}

// Cells beside which one condenses: its six neighbours, and the next but one on all sides but above. `beside` is what condenses
// in the columns around, `below` and `above` in the words below and above of its own.
fn kindled(own: u32, beside: u32, below: u32, above: u32) -> u32 {
  let up = (own << 1u) | (below >> 31u) | (own << 2u) | (below >> 30u);
  let down = (own >> 1u) | (above << 31u);
  return beside | up | down;
}

// Equations 1 to 3 of the paper: what is humid condenses where something condenses beside it, and is cloud from then on.
fn grown(cells: Cells, kindled: u32) -> Cells {
  let humid = cells.x & ~cells.y;
  let condensing = ~cells.y & cells.x & kindled;
  return Cells(humid, condensing, cells.z | cells.y, 0u);
}

// Equations 4 to 6: cloud vanishes, air becomes humid, and it condenses by itself, each by chance.
fn by_chance(cells: Cells, vanishing: u32, humid: u32, condensing: u32) -> Cells {
  return Cells(cells.x | humid, cells.y | condensing, cells.z & ~vanishing, 0u);
}

// Which of the three happen to a cell in this generation; its chances follow how favourable its air is, 0 to ONE.
fn dice(automaton: AutomatonUniforms, cell: u32, favour: u32) -> vec3<bool> {
  let thrown = pcg3d(vec3u(cell, automaton.index, automaton.run)) >> vec3u(16u);
  let outside = u32(ONE) - favour;
  let chances = vec3u(
    ((automaton.extinction * favour) >> 16u) + ((automaton.dissolution * outside) >> 16u),
    (automaton.vapour * favour) >> 16u,
    (automaton.activation * favour) >> 16u,
  );
  return thrown < chances;
}

// How far the wind has carried a level on in this generation, in whole cells.
fn carried(automaton: AutomatonUniforms, level: u32) -> vec2i {
  let way = automaton.shear * i32(level) / i32(automaton.levels);
  return ((way * i32(automaton.index)) >> vec2u(16u)) - ((way * i32(automaton.index - 1u)) >> vec2u(16u));
}

// A lattice that repeats after so many cells along its second axis.
const FAR: u32 = 0xfffffu;

fn corner(cell: vec3u, period: u32, seed: u32) -> i32 {
  let wrapped = vec3u(cell.x % period, cell.y & FAR, cell.z % period);
  return i32(hash_cell_bits(bitcast<vec3i>(wrapped), seed).x >> 16u);
}

fn between(a: i32, b: i32, share: i32) -> i32 {
  return a + (((b - a) * share) >> 12u);
}

// Noise of random values, 0 to ONE, whose cubes have 4096 steps along each edge.
fn whole_noise(cell: vec3u, step: vec3u, period: u32, seed: u32) -> i32 {
  let t = vec3i(step);
  let w = (((t * t) >> vec3u(12u)) * (3 * 4096 - 2 * t)) >> vec3u(12u);
  let far = cell + 1u;
  let near_low = between(corner(cell, period, seed), corner(vec3u(far.x, cell.yz), period, seed), w.x);
  let near_high = between(
    corner(vec3u(cell.x, far.y, cell.z), period, seed), corner(vec3u(far.xy, cell.z), period, seed), w.x);
  let far_low = between(
    corner(vec3u(cell.xy, far.z), period, seed), corner(vec3u(far.x, cell.y, far.z), period, seed), w.x);
  let far_high = between(corner(vec3u(cell.x, far.yz), period, seed), corner(far, period, seed), w.x);
  return between(between(near_low, near_high, w.y), between(far_low, far_high, w.y), w.z);
}

// The noise of a column with so many patches across the map, at a height in 4096ths of one.
fn noise_at(automaton: AutomatonUniforms, column: vec2u, height: u32, patches: u32, seed: u32) -> i32 {
  let along = column * patches;
  let cell = along / automaton.cells;
  let step = ((along % automaton.cells) << vec2u(12u)) / automaton.cells;
  return whole_noise(vec3u(cell.x, height >> 12u, cell.y), vec3u(step.x, height & 4095u, step.y), patches, seed);
}

// The broad noise of a column, which says how high air rises in it.
fn broad_noise(automaton: AutomatonUniforms, column: vec2u) -> i32 {
  var sum = 0;
  for (var octave = 0u; octave < 3u; octave++) {
    let own = noise_at(automaton, column, automaton.phase << octave, automaton.patches << octave, automaton.seed + octave);
    sum += own << (2u - octave);
  }
  return sum / 7;
}

// How favourable a cell's air is, 0 to ONE, from the broad noise of its column and its own: more at the base than above.
fn favour_of(automaton: AutomatonUniforms, column: vec2u, broad: i32, level: u32) -> u32 {
  let up = (level * automaton.patches << 12u) / automaton.cells;
  let own = noise_at(automaton, column, automaton.phase * 3u + 3u * up, 3u * automaton.patches, automaton.seed + 71u);
  let h = i32(level << 12u) / i32(automaton.levels);
  let cost = (((h * h) >> 8u) * automaton.slope) >> 8u;
  let reserve = ((broad - automaton.threshold) * automaton.gain) >> 8u;
  // Nothing grows in the two highest levels, so that density ends there.
  if (level + 2u >= automaton.levels) {
    return 0u;
  }
  return u32(clamp(6 * (reserve + (((own - ONE / 2) * 3) >> 3u) - cost), 0, ONE));
}
