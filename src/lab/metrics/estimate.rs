//! Figures over the pixels of a picture, with the standard error that comes from having no more pixels than these.
//!
//! Neighbouring pixels err alike: they see the same cloud, share rays and lookups, or were filled in from one another.
//! Treating them as independent makes a standard error several times too small. So the unit here is a tile of 8×8 pixels:
//! a figure is computed again without each tile in turn, and the spread of the results gives its error (block jackknife:
//! Künsch 1989; tiles at the rim of the picture or of a mask have fewer pixels, for which the weights of Busing, Meijer
//! and van der Leeden 1999, "Delete-m jackknife for unequal m", allow).
//!
//! This is the error of a figure as one about skies of this kind: it also holds how the error differs from place to place
//! in the picture, and so is greater than what another seed would change. On the other hand, what errs alike over much more
//! than 8 pixels, such as one cloud that is too dark as a whole, counts as many measurements and is one. To know how far a
//! figure moves from noise alone, repeat it with other seeds.

use super::super::bench::quantile;

/// Width and height of a tile in pixels.
pub const TILE: usize = 8;

/// A figure and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The figure.
    pub value: f64,
    /// Its standard error. `None` where all pixels lie in one tile.
    pub std_error: Option<f64>,
}

/// What one pixel adds to a figure that is a sum divided by a sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Index of the pixel.
    pub(super) pixel: usize,
    /// Added above the line.
    pub(super) above: f64,
    /// Added below the line; 1 for a mean.
    pub(super) below: f64,
}

/// Sums over a tile.
#[derive(Clone, Copy, Debug, Default)]
struct Tile {
    pixels: f64,
    above: f64,
    below: f64,
}

impl Tile {
    fn add(self, other: Self) -> Self {
        Self { pixels: self.pixels + other.pixels, above: self.above + other.above, below: self.below + other.below }
    }
}

/// A sum over pixels divided by another, Σ above / Σ below. `None` without samples.
pub(super) fn ratio(width: usize, samples: impl IntoIterator<Item = Sample>) -> Option<Estimate> {
    let mut tiles: Vec<Tile> = Vec::new();
    for Sample { pixel, above, below } in samples {
        let index = pixel / width / TILE * width.div_ceil(TILE) + pixel % width / TILE;
        if index >= tiles.len() {
            tiles.resize(index + 1, Tile::default());
        }
        tiles[index] = tiles[index].add(Tile { pixels: 1.0, above, below });
    }
    tiles.retain(|tile| tile.pixels > 0.0);
    let whole = tiles.iter().fold(Tile::default(), |sum, tile| sum.add(*tile));
    (!tiles.is_empty()).then(|| Estimate { value: whole.above / whole.below, std_error: jackknife(&tiles, whole) })
}

/// A mean over pixels. `None` without samples.
pub(super) fn mean(width: usize, samples: impl IntoIterator<Item = (usize, f64)>) -> Option<Estimate> {
    ratio(width, samples.into_iter().map(|(pixel, above)| Sample { pixel, above, below: 1.0 }))
}

fn jackknife(tiles: &[Tile], whole: Tile) -> Option<f64> {
    if tiles.len() < 2 {
        return None;
    }
    let (count, value) = (tiles.len() as f64, whole.above / whole.below);
    let without = |tile: &Tile| (whole.above - tile.above) / (whole.below - tile.below);
    let kept = |tile: &Tile| 1.0 - tile.pixels / whole.pixels;
    let centre = count * value - tiles.iter().map(|tile| kept(tile) * without(tile)).sum::<f64>();
    let square = |tile: &Tile| {
        let parts = whole.pixels / tile.pixels;
        let pseudo = parts * value - (parts - 1.0) * without(tile);
        (pseudo - centre).powi(2) / (parts - 1.0)
    };
    let variance = tiles.iter().map(square).sum::<f64>() / count;
    Some(variance.sqrt()).filter(|error| error.is_finite())
}

/// The value that a share of the pixels stays below. `None` without samples.
///
/// The jackknife fails for quantiles (Efron 1982). Its error is that of the share of pixels below the value, which is a
/// mean, read on the scale of values: (Q(share + s) − Q(share − s)) / 2 (Woodruff 1952, "Confidence Intervals for Medians
/// and Other Position Measures").
pub(super) fn share_below(width: usize, samples: &[(usize, f64)], share: f64) -> Option<Estimate> {
    let mut sorted: Vec<f64> = samples.iter().map(|sample| sample.1).collect();
    sorted.sort_by(f64::total_cmp);
    let value = quantile(&sorted, share)?;
    let below = mean(width, samples.iter().map(|(pixel, sample)| (*pixel, f64::from(u8::from(*sample < value)))));
    let std_error = below.and_then(|below| below.std_error).and_then(|error| {
        let at = |share: f64| quantile(&sorted, share.clamp(0.0, 1.0));
        Some((at(share + error)? - at(share - error)?) / 2.0)
    });
    Some(Estimate { value, std_error })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from 0 to 1 that only the seed decides (Steele, Lea and Flood 2014, `SplitMix64`).
    fn random(seed: u64) -> f64 {
        let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    const WIDTH: usize = 60;
    const RUNS: u64 = 300;

    /// Skewed noise that all pixels of a 4×4 block share, and a mask like a cloud: some tiles are full, many hold a part.
    fn field(run: u64) -> Vec<(usize, f64)> {
        let masked = |pixel: &usize| {
            let (x, y) = ((pixel % WIDTH) as f64, (pixel / WIDTH) as f64);
            (x - 25.0).hypot(1.3 * (y - 22.0)) < 27.0
        };
        let value = |pixel: usize| {
            let block = (pixel / WIDTH / 4 * WIDTH + pixel % WIDTH / 4) as u64;
            -random(run * 100_000 + block).max(1e-12).ln()
        };
        (0..WIDTH * 44).filter(masked).map(|pixel| (pixel, value(pixel))).collect()
    }

    /// Standard deviation of a figure over runs, and the mean of what it says of itself.
    fn spread(figure: impl Fn(u64) -> Estimate) -> (f64, f64) {
        let runs: Vec<Estimate> = (0..RUNS).map(figure).collect();
        let count = RUNS as f64;
        let mean = runs.iter().map(|run| run.value).sum::<f64>() / count;
        let square = runs.iter().map(|run| (run.value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let said = runs.iter().filter_map(|run| run.std_error).map(|error| error * error).sum::<f64>() / count;
        (square.sqrt(), said.sqrt())
    }

    #[test]
    fn standard_errors_are_the_spread_over_repeated_measurements() {
        let (seen, said) = spread(|run| mean(WIDTH, field(run)).expect("samples"));
        assert!((said / seen - 1.0).abs() < 0.15, "a mean: {said} said, {seen} seen");
        // As independent pixels they would be known four times as well.
        let samples = field(0);
        let naive = 1.0 / (samples.len() as f64).sqrt();
        assert!(said > 2.5 * naive, "{said} is that of blocks, not of pixels ({naive})");

        let (seen, said) = spread(|run| share_below(WIDTH, &field(run), 0.95).expect("samples"));
        assert!((said / seen - 1.0).abs() < 0.25, "a quantile: {said} said, {seen} seen");

        let (seen, said) = spread(|run| {
            let block = |pixel: usize| (pixel / WIDTH / 4 * WIDTH + pixel % WIDTH / 4) as u64;
            let below = |pixel: usize| 0.5 + random(run * 100_000 + 50_000 + block(pixel));
            let samples = field(run).into_iter().map(|(pixel, above)| Sample { pixel, above, below: below(pixel) });
            ratio(WIDTH, samples).expect("samples")
        });
        assert!((said / seen - 1.0).abs() < 0.15, "a ratio: {said} said, {seen} seen");
    }

    #[test]
    fn equal_tiles_give_the_textbook_error_of_a_mean() {
        // Four tiles in a row with means 1, 2, 3 and 6: s² = 14/3 and the error of the mean is √(s²/4).
        let value = |pixel: usize| [1.0, 2.0, 3.0, 6.0][pixel % 32 / TILE];
        let estimate = mean(32, (0..32 * 8).map(|pixel| (pixel, value(pixel)))).expect("samples");
        assert!((estimate.value - 3.0).abs() < 1e-12, "{estimate:?}");
        let error = estimate.std_error.expect("four tiles");
        assert!((error - (14.0_f64 / 12.0).sqrt()).abs() < 1e-12, "{error}");
    }

    #[test]
    fn tiles_end_with_rows_and_not_with_memory() {
        // In a picture of 12 columns, pixel 8 starts the second tile and pixel 12 the second row of the first.
        let samples = [(0, 1.0), (12, 1.0), (8, 3.0), (20, 3.0)];
        let estimate = mean(12, samples).expect("samples");
        assert_eq!(estimate, Estimate { value: 2.0, std_error: Some(1.0) });
        assert_eq!(mean(12, [(0, 1.0), (13, 3.0)]).and_then(|estimate| estimate.std_error), None, "one tile");
        assert_eq!(mean(12, []), None);
        assert_eq!(share_below(12, &[], 0.5), None);
    }
}
