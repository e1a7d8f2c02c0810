//! Whole clouds of the weather map: how far the one under a touch reaches, and the dabs that cover it.

use std::collections::VecDeque;

use glam::DVec2;

/// Bodies above which cloud is seen: thinner ones hold scraps at most.
const SEEN: f32 = 0.3;
/// Where clouds hang together over more than this share of the map, those with thicker cores are told apart.
const LARGEST: f64 = 0.2;
/// How much thicker, from one try to the next.
const THICKER: f32 = 0.1;
/// Texels around the touch where a cloud is looked for.
const NEAR: i32 = 6;
/// Dabs across the largest cloud.
const ACROSS: f64 = 16.0;

/// A cloud on the map, all in edges of the map.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WholeCloud {
    /// Its middle.
    pub(super) middle: DVec2,
    /// Radius of the circle about its middle that holds all of it.
    pub(super) radius: f64,
    /// Places, evenly spaced, that cover it.
    pub(super) places: Vec<DVec2>,
    /// How far apart they are.
    pub(super) spacing: f64,
}

/// The cloud at a place, or nearest to it within a few texels: `bodies` are the map's, a square, row by row.
pub(super) fn whole_cloud(bodies: &[f32], at: DVec2, is_endless: bool) -> Option<WholeCloud> {
    if bodies.is_empty() {
        return None;
    }
    let map = Map { bodies, side: bodies.len().isqrt(), is_endless };
    // Maps without end are counted from their tile: places far out have no texels to count.
    let tile = if is_endless { at.floor() } else { DVec2::ZERO };
    let begin = map.nearest(at - tile)?;
    let mut least = SEEN;
    let mut texels = map.connected(begin, least);
    while map.extent(&texels) > LARGEST {
        least += THICKER;
        // From its rim to the nearest core.
        let cores = texels.iter().filter(|texel| map.body(**texel).is_some_and(|body| body > least));
        let apart = |[x, y]: [i32; 2]| (x - begin[0]).pow(2) + (y - begin[1]).pow(2);
        let Some(core) = cores.min_by_key(|texel| apart(**texel)) else { break };
        texels = map.connected(*core, least);
    }
    let cloud = map.covered(&texels)?;
    let places = cloud.places.into_iter().map(|place| place + tile).collect();
    Some(WholeCloud { middle: cloud.middle + tile, places, ..cloud })
}

struct Map<'a> {
    bodies: &'a [f32],
    side: usize,
    is_endless: bool,
}

impl Map<'_> {
    /// The body of a texel, which may lie over the edge of a map without end; nothing beyond that of another.
    #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "a map has far fewer texels")]
    fn body(&self, [x, y]: [i32; 2]) -> Option<f32> {
        let side = self.side as i32;
        let is_on_map = (0..side).contains(&x) && (0..side).contains(&y);
        let index = self.index([x.rem_euclid(side), y.rem_euclid(side)]);
        self.bodies.get(index).copied().filter(|_| is_on_map || self.is_endless)
    }

    #[allow(clippy::cast_sign_loss, reason = "a place on the map")]
    fn index(&self, [x, y]: [i32; 2]) -> usize {
        y as usize * self.side + x as usize
    }

    #[allow(clippy::cast_possible_truncation, reason = "a place on the map")]
    fn nearest(&self, at: DVec2) -> Option<[i32; 2]> {
        let texel = (at * self.side as f64).floor();
        let [x, y] = [texel.x as i32, texel.y as i32];
        let around = (-NEAR..=NEAR).flat_map(|dy| (-NEAR..=NEAR).map(move |dx| [dx, dy]));
        let found = around.filter(|[dx, dy]| self.body([x + dx, y + dy]).is_some_and(|body| body > SEEN));
        found.min_by_key(|[dx, dy]| dx * dx + dy * dy).map(|[dx, dy]| [x + dx, y + dy])
    }

    /// All texels that hang together with one by bodies above the least, not wrapped; at most one turn of a map without end.
    #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "a map has far fewer texels")]
    fn connected(&self, begin: [i32; 2], least: f32) -> Vec<[i32; 2]> {
        let side = self.side as i32;
        let is_in = |at: [i32; 2]| self.body(at).is_some_and(|body| body > least);
        let mut seen = vec![false; self.bodies.len()];
        let mut texels = Vec::new();
        let mut next: VecDeque<_> = is_in(begin).then_some(begin).into_iter().collect();
        while let Some([x, y]) = next.pop_front() {
            let index = self.index([x.rem_euclid(side), y.rem_euclid(side)]);
            if seen.get_mut(index).is_none_or(|seen| std::mem::replace(seen, true)) {
                continue;
            }
            texels.push([x, y]);
            next.extend([[x + 1, y], [x - 1, y], [x, y + 1], [x, y - 1]].into_iter().filter(|at| is_in(*at)));
        }
        texels
    }

    /// The longer side of the rectangle that holds texels, in edges of the map.
    fn extent(&self, texels: &[[i32; 2]]) -> f64 {
        let along = |axis: usize| {
            let all = || texels.iter().map(|texel| texel[axis]);
            all().max().zip(all().min()).map_or(0, |(most, least)| most - least + 1)
        };
        f64::from(along(0).max(along(1))) / self.side as f64
    }

    fn covered(&self, texels: &[[i32; 2]]) -> Option<WholeCloud> {
        if texels.is_empty() {
            return None;
        }
        let side = self.side as f64;
        let place = |[x, y]: [i32; 2]| (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / side;
        let middle = texels.iter().map(|texel| place(*texel)).sum::<DVec2>() / texels.len() as f64;
        let radius = texels.iter().map(|texel| (place(*texel) - middle).length()).fold(0.0, f64::max) + 1.0 / side;
        #[allow(clippy::cast_possible_truncation, reason = "a few texels")]
        let step = ((self.extent(texels) * side / ACROSS).ceil() as i32).max(2);
        // Cells of a lattice that hold any of it: their middles.
        let cells: std::collections::BTreeSet<_> =
            texels.iter().map(|texel| texel.map(|at| at.div_euclid(step))).collect();
        let spacing = f64::from(step) / side;
        let places = cells.into_iter().map(|[x, y]| (DVec2::new(f64::from(x), f64::from(y)) + 0.5) * spacing);
        // The last cells of a map that ends may reach over it.
        let places = places.map(|place| if self.is_endless { place } else { place.min(DVec2::ONE) });
        Some(WholeCloud { middle, radius, places: places.collect(), spacing })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 64;

    /// Round clouds, by their middles and radii in texels.
    fn map(clouds: &[([f64; 2], f64)]) -> Vec<f32> {
        let body = |index: usize| {
            let at = DVec2::new((index % SIDE) as f64 + 0.5, (index / SIDE) as f64 + 0.5);
            let inside = clouds.iter().map(|(middle, radius)| {
                let apart = at - DVec2::from_array(*middle);
                let side = SIDE as f64;
                let apart = apart - (apart / side).round() * side;
                1.5 - apart.length() / radius
            });
            #[allow(clippy::cast_possible_truncation, reason = "0 to 1")]
            let body = inside.fold(0.0, f64::max).min(1.0) as f32;
            body
        };
        (0..SIDE * SIDE).map(body).collect()
    }

    fn at(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y) / SIDE as f64
    }

    #[test]
    fn a_cloud_is_what_hangs_together_over_the_edge_of_a_map_that_repeats() {
        let bodies = map(&[([2.0, 30.0], 4.0), ([40.0, 30.0], 3.0)]);
        let cloud = whole_cloud(&bodies, at(62.5, 30.5), true).expect("there is one");
        // Bodies above 0.3 reach 1.2 radii.
        assert!((cloud.middle - at(66.0, 30.0)).length() < 0.3 / SIDE as f64, "{:?}", cloud.middle * SIDE as f64);
        assert!((3.8..6.2).contains(&(cloud.radius * SIDE as f64)), "{}", cloud.radius * SIDE as f64);
        let covers = |x: f64, y: f64| {
            cloud.places.iter().any(|place| (*place - at(x, y)).abs().max_element() <= 0.5 * cloud.spacing + 1e-9)
        };
        assert!(covers(63.0, 30.0) && covers(68.5, 30.5) && covers(66.0, 33.0) && !covers(40.0, 30.0));
        // Of a map that ends the other half is beyond it.
        let half = whole_cloud(&bodies, at(1.5, 30.5), false).expect("there is one");
        assert!(half.places.iter().all(|place| place.x >= 0.0), "{:?}", half.places);
        assert_eq!(whole_cloud(&bodies, at(20.0, 30.0), true), None, "clear air");
        assert!(whole_cloud(&bodies, at(40.0, 37.5), true).is_some(), "beside the cloud");
        // Cells of a lattice need not end where the map does.
        let wall: Vec<f32> = (0..SIDE * SIDE).map(|index| f32::from(u8::from(index % SIDE > 62))).collect();
        let edge = whole_cloud(&wall, at(63.5, 9.5), false).expect("there is one");
        assert!(edge.places.iter().all(|place| (0.0..=1.0).contains(&place.x)), "{:?}", edge.places);
        assert_eq!(whole_cloud(&[], at(1.0, 1.0), true), None);
    }

    #[test]
    fn of_clouds_that_run_into_each_other_one_is_picked() {
        // A row of them across all of the map.
        let row: Vec<_> = (0..8).map(|i| ([8.0 * f64::from(i) + 4.0, 20.0], 4.0)).collect();
        // In its middle, at its rim, and far out on a map that repeats.
        for (x, y, tile) in [(20.5, 20.5, 0.0), (20.5, 24.2, 0.0), (20.5, 20.5, 3e7)] {
            let tile = DVec2::splat(tile);
            let cloud = whole_cloud(&map(&row), at(x, y) + tile, true).expect("there is one");
            let middle = cloud.middle - tile;
            assert!((middle - at(20.0, 20.0)).length() < 1.0 / SIDE as f64, "{:?}", middle * SIDE as f64);
            assert!(cloud.radius * (SIDE as f64) < 6.0, "{}", cloud.radius);
        }
        // An overcast is all of a piece.
        let overcast = whole_cloud(&vec![1.0; SIDE * SIDE], at(20.5, 20.5), true).expect("there is one");
        assert!(overcast.places.len() <= 20 * 20, "{}", overcast.places.len());
    }
}
