//! Blue noise for jitter and dither, by void and cluster (Ulichney 1993): each texel is a rank, and texels of near rank
//! lie far apart.

/// Edge length of the tile.
pub(super) const SIDE_PX: u32 = 64;
const SIDE: usize = SIDE_PX as usize;

const TEXELS: usize = SIDE * SIDE;
const SIGMA: f32 = 1.9;

/// How much each texel is crowded by the chosen ones, on a torus.
struct Energy {
    kernel: Vec<f32>,
    values: Vec<f32>,
}

impl Energy {
    fn new() -> Self {
        let wrapped = |d: usize| d.min(SIDE - d) as f32;
        let kernel = (0..TEXELS)
            .map(|at| {
                let (x, y) = (wrapped(at % SIDE), wrapped(at / SIDE));
                (-(x * x + y * y) / (2.0 * SIGMA * SIGMA)).exp()
            })
            .collect();
        Self { kernel, values: vec![0.0; TEXELS] }
    }

    fn add(&mut self, place: usize, sign: f32) {
        let (px, py) = (place % SIDE, place / SIDE);
        for y in 0..SIDE {
            let row = (y + SIDE - py) % SIDE * SIDE;
            for x in 0..SIDE {
                self.values[y * SIDE + x] += sign * self.kernel[row + (x + SIDE - px) % SIDE];
            }
        }
    }

    /// The texel among those for which `chosen` says `wanted` with the most (`sign` 1) or the least (−1) crowding.
    fn extreme(&self, chosen: &[bool], wanted: bool, sign: f32) -> usize {
        let mut best = (0, f32::NEG_INFINITY);
        for (place, value) in self.values.iter().enumerate() {
            if chosen[place] == wanted && sign * value > best.1 {
                best = (place, sign * value);
            }
        }
        best.0
    }
}

/// Ranks 0 to 4095 of a 64×64 tile, row by row.
pub(super) fn ranks() -> Vec<u16> {
    let mut energy = Energy::new();
    let mut chosen = vec![false; TEXELS];
    // A start pattern of one texel in ten, from a small generator, evened out by moving the worst into the largest void.
    let mut state = 0x2545_f491_u32;
    let start_count = TEXELS / 10;
    let mut count = 0;
    while count < start_count {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let place = (state >> 12) as usize % TEXELS;
        if !chosen[place] {
            chosen[place] = true;
            energy.add(place, 1.0);
            count += 1;
        }
    }
    loop {
        let worst = energy.extreme(&chosen, true, 1.0);
        chosen[worst] = false;
        energy.add(worst, -1.0);
        let void = energy.extreme(&chosen, false, -1.0);
        chosen[void] = true;
        energy.add(void, 1.0);
        if void == worst {
            break;
        }
    }
    rank(energy, chosen, start_count)
}

/// Takes the start pattern apart for the low ranks, then fills voids for the others.
#[allow(clippy::cast_possible_truncation, reason = "ranks are below the number of texels, 4096")]
fn rank(mut energy: Energy, mut chosen: Vec<bool>, start_count: usize) -> Vec<u16> {
    let mut ranks = vec![0_u16; TEXELS];
    let start = (chosen.clone(), energy.values.clone());
    for rank in (0..start_count).rev() {
        let worst = energy.extreme(&chosen, true, 1.0);
        chosen[worst] = false;
        energy.add(worst, -1.0);
        ranks[worst] = rank as u16;
    }
    (chosen, energy.values) = start;
    for rank in start_count..TEXELS {
        let void = energy.extreme(&chosen, false, -1.0);
        chosen[void] = true;
        energy.add(void, 1.0);
        ranks[void] = rank as u16;
    }
    ranks
}

/// Values (rank + ½) / 4096 as the texels of an `R32Float` texture: their mean is exactly ½.
pub(super) fn values() -> Vec<f32> {
    ranks().into_iter().map(|rank| (f32::from(rank) + 0.5) / TEXELS as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rank_occurs_once_and_neighbours_differ() {
        let ranks = ranks();
        let mut sorted = ranks.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(index, rank)| index == usize::from(*rank)), "a permutation");
        let difference = |dx: usize, dy: usize| {
            let sum: f64 = (0..TEXELS)
                .map(|at| {
                    let other = (at / SIDE + dy) % SIDE * SIDE + (at % SIDE + dx) % SIDE;
                    f64::from(ranks[at].abs_diff(ranks[other]))
                })
                .sum();
            sum / TEXELS as f64 / TEXELS as f64
        };
        // White noise differs by a third on average.
        assert!(difference(1, 0) > 0.38 && difference(0, 1) > 0.38, "{} {}", difference(1, 0), difference(0, 1));
    }
}
