//! Twins of `cloud/automaton.wgsl` and of the passes that call it, cell by cell: bit for bit the same clouds.

use glam::{IVec3, UVec2, UVec3};

use super::random::{hash_cell_bits, pcg3d};
use crate::render::uniforms::other::AutomatonUniforms;

const ONE: i32 = 65_536;

/// What a cell is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// Its air is humid.
    pub humid: bool,
    /// It condenses.
    pub condensing: bool,
    /// It holds cloud.
    pub cloudy: bool,
}

/// All cells of a generation: across, down, and then up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cells {
    across: i32,
    levels: i32,
    cells: Vec<Cell>,
}

impl Cells {
    /// Clear air.
    #[must_use]
    pub fn clear(automaton: &AutomatonUniforms) -> Self {
        let (across, levels) = (automaton.cells, automaton.levels);
        let cells = vec![Cell::default(); (across * across * levels) as usize];
        Self { across: across as i32, levels: levels as i32, cells }
    }

    /// The cell at a place: east, south, up. Cells repeat sideways; below and above all is clear.
    #[must_use]
    pub fn at(&self, place: IVec3) -> Cell {
        if place.z < 0 || place.z >= self.levels {
            return Cell::default();
        }
        let [x, y] = [place.x, place.y].map(|side| side.rem_euclid(self.across));
        self.cells[((y * self.across + x) * self.levels + place.z) as usize]
    }

    /// Every cell anew, from its place.
    #[allow(clippy::cast_possible_truncation, reason = "no more than some million cells")]
    fn anew(&self, cell: impl Fn(IVec3) -> Cell) -> Self {
        let places = (0..self.cells.len() as i32).map(|index| {
            let column = index / self.levels;
            IVec3::new(column % self.across, column / self.across, index % self.levels)
        });
        Self { cells: places.map(cell).collect(), ..*self }
    }

    /// The generation after this one, which the uniforms are of; `favour` is that of [`favour`].
    #[must_use]
    pub fn next(&self, automaton: &AutomatonUniforms, favour: &[u32]) -> Self {
        let drifted = self.anew(|place| {
            let [x, y] = automaton.shear.to_array().map(|shear| {
                let way = shear * place.z / self.levels;
                let index = automaton.index as i32;
                ((way * index) >> 16) - ((way * (index - 1)) >> 16)
            });
            self.at(place - IVec3::new(x, y, 0))
        });
        drifted.anew(|place| {
            let before = drifted.at(place);
            let condenses = |step: [i32; 3]| drifted.at(place + IVec3::from_array(step)).condensing;
            let near = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
            let far = [[2, 0, 0], [-2, 0, 0], [0, 2, 0], [0, -2, 0], [0, 0, -2]];
            let is_kindled = near.into_iter().chain(far).any(condenses);
            let index = ((place.y * self.across + place.x) * self.levels + place.z) as u32;
            let favour = favour[index as usize];
            let dice = pcg3d(UVec3::new(index, automaton.index, automaton.run)).to_array().map(|bits| bits >> 16);
            let chance = |chance: u32, favour: u32| (chance * favour) >> 16;
            let vanishes =
                dice[0] < chance(automaton.extinction, favour) + chance(automaton.dissolution, ONE as u32 - favour);
            Cell {
                humid: before.humid && !before.condensing || dice[1] < chance(automaton.vapour, favour),
                condensing: !before.condensing && before.humid && is_kindled
                    || dice[2] < chance(automaton.activation, favour),
                cloudy: (before.cloudy || before.condensing) && !vanishes,
            }
        })
    }

    /// Density at a cell: cloudy cells around it, weighted 1 2 3 2 1 along every axis.
    #[must_use]
    pub fn density(&self, place: IVec3) -> f32 {
        let mut sum = 0;
        for z in -2_i32..=2 {
            for y in -2_i32..=2 {
                for x in -2_i32..=2 {
                    let weight = (3 - x.abs()) * (3 - y.abs()) * (3 - z.abs());
                    sum += weight * i32::from(self.at(place + IVec3::new(x, y, z)).cloudy);
                }
            }
        }
        sum as f32 / 729.0
    }
}

fn corner(cell: UVec3, period: u32, seed: u32) -> i32 {
    let wrapped = UVec3::new(cell.x % period, cell.y & 0xf_ffff, cell.z % period);
    (hash_cell_bits(wrapped.as_ivec3(), seed).x >> 16) as i32
}

fn between(a: i32, b: i32, share: i32) -> i32 {
    a + (((b - a) * share) >> 12)
}

/// Noise of random values, 0 to 65536, whose cubes have 4096 steps along each edge.
#[must_use]
pub fn whole_noise(cell: UVec3, step: UVec3, period: u32, seed: u32) -> i32 {
    let w = step.to_array().map(|step| {
        let t = step as i32;
        (((t * t) >> 12) * (3 * 4096 - 2 * t)) >> 12
    });
    let at = |x: u32, y: u32, z: u32| corner(cell.wrapping_add(UVec3::new(x, y, z)), period, seed);
    let row = |y: u32, z: u32| between(at(0, y, z), at(1, y, z), w[0]);
    let layer = |z: u32| between(row(0, z), row(1, z), w[1]);
    between(layer(0), layer(1), w[2])
}

fn noise_at(automaton: &AutomatonUniforms, column: UVec2, height: u32, patches: u32, seed: u32) -> i32 {
    let along = column * patches;
    let cell: UVec2 = along / automaton.cells;
    let step: UVec2 = ((along % automaton.cells) << 12) / automaton.cells;
    let place = UVec3::new(cell.x, height >> 12, cell.y);
    whole_noise(place, UVec3::new(step.x, height & 4095, step.y), patches, seed)
}

/// How favourable each cell's air is, 0 to 65536: across, down, and then up.
#[must_use]
pub fn favour(automaton: &AutomatonUniforms) -> Vec<u32> {
    let (across, levels) = (automaton.cells, automaton.levels);
    let mut favour = Vec::new();
    for column in (0..across * across).map(|index| UVec2::new(index % across, index / across)) {
        let broad = (0..3).map(|octave| {
            let (height, patches) = (automaton.phase << octave, automaton.patches << octave);
            noise_at(automaton, column, height, patches, automaton.seed + octave) << (2 - octave)
        });
        let broad = broad.sum::<i32>() / 7;
        for level in 0..levels {
            let up = ((level * automaton.patches) << 12) / across;
            let height = automaton.phase.wrapping_mul(3).wrapping_add(3 * up);
            let own = noise_at(automaton, column, height, 3 * automaton.patches, automaton.seed + 71);
            let h = ((level << 12) / levels) as i32;
            let cost = (((h * h) >> 8) * automaton.slope) >> 8;
            let reserve = ((broad - automaton.threshold) * automaton.gain) >> 8;
            let own = (6 * (reserve + (((own - ONE / 2) * 3) >> 3) - cost)).clamp(0, ONE);
            favour.push(if level + 2 >= levels { 0 } else { own as u32 });
        }
    }
    favour
}
