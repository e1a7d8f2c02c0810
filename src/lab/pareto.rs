//! Which settings are worth their cost: the Pareto front of points of cost and error, and choices from it.
//!
//! Lower is better in both. A point is *dominated* if another one is no worse in both and better in one. The front are
//! the points that none dominates (Vilfredo Pareto's optimum, 1906).
//!
//! Points whose cost or error is NaN or infinite are left out everywhere.

use std::cmp::Ordering;

/// One setting as measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// What it takes, such as milliseconds or texture reads.
    pub cost: f64,
    /// How far it is from the reference, such as relRMSE.
    pub error: f64,
}

impl Point {
    fn is_finite(self) -> bool {
        self.cost.is_finite() && self.error.is_finite()
    }

    fn by_cost(self, other: Self) -> Ordering {
        self.cost.total_cmp(&other.cost).then(self.error.total_cmp(&other.error))
    }

    fn by_error(self, other: Self) -> Ordering {
        self.error.total_cmp(&other.error).then(self.cost.total_cmp(&other.cost))
    }
}

/// What a budget allows: an index into the points that were asked about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// This point keeps the budget.
    Within(usize),
    /// No point keeps the budget; this one comes nearest.
    Nearest(usize),
}

impl Choice {
    /// The point, whether it keeps the budget or not.
    pub fn index(self) -> usize {
        match self {
            Self::Within(index) | Self::Nearest(index) => index,
        }
    }
}

/// Indices of the points on the front, from the cheapest to the most accurate. Cost rises and error falls strictly; of
/// equal points the first stands for all.
pub fn front(points: &[Point]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).filter(|index| points[*index].is_finite()).collect();
    // The sort is stable, so equal points stay in their order.
    order.sort_by(|a, b| points[*a].by_cost(points[*b]));
    let mut least = f64::INFINITY;
    order.retain(|index| {
        let better = points[*index].error < least;
        least = least.min(points[*index].error);
        better
    });
    order
}

/// The cheapest point with an error of at most `max_error`; of equally cheap ones the most accurate. If there is none, the
/// most accurate point of all. `None` without points.
pub fn cheapest_within_error(points: &[Point], max_error: f64) -> Option<Choice> {
    choose(points, |point| point.error <= max_error, Point::by_cost, Point::by_error)
}

/// The most accurate point with a cost of at most `max_cost`; of equally accurate ones the cheapest. If there is none, the
/// cheapest point of all. `None` without points.
pub fn most_accurate_within_cost(points: &[Point], max_cost: f64) -> Option<Choice> {
    choose(points, |point| point.cost <= max_cost, Point::by_error, Point::by_cost)
}

fn choose(
    points: &[Point],
    keeps: impl Fn(Point) -> bool,
    best: impl Fn(Point, Point) -> Ordering,
    nearest: impl Fn(Point, Point) -> Ordering,
) -> Option<Choice> {
    let finite = || (0..points.len()).filter(|index| points[*index].is_finite());
    let within = finite().filter(|index| keeps(points[*index])).min_by(|a, b| best(points[*a], points[*b]));
    let fallback = || finite().min_by(|a, b| nearest(points[*a], points[*b]));
    within.map(Choice::Within).or_else(|| fallback().map(Choice::Nearest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(pairs: &[(f64, f64)]) -> Vec<Point> {
        pairs.iter().map(|(cost, error)| Point { cost: *cost, error: *error }).collect()
    }

    /// Samples per pixel and relRMSE of a march with growing step counts, and of a poorly balanced one ("64 × 6").
    const MEASURED: [(f64, f64); 6] =
        [(90.0, 0.108), (19.8, 0.333), (150.0, 0.038), (45.8, 0.132), (78.0, 0.066), (307.0, 0.011)];

    #[test]
    fn the_front_leaves_out_what_is_worse_in_both() {
        assert_eq!(front(&points(&MEASURED)), [1, 3, 4, 2, 5], "64 × 6 is dearer and worse than 48 × 8");
    }

    #[test]
    fn the_front_is_what_the_definition_says() {
        // All pairs of a small grid in a shuffled order, many of them equal in one coordinate.
        let shuffled = |index: u32| (index * 37 + 11) % 101;
        let grid: Vec<Point> = (0..101)
            .map(|index| {
                let cost = shuffled(index) % 9;
                Point { cost: f64::from(cost), error: f64::from(20 - 2 * cost + (shuffled(index) * 7 + index) % 5) }
            })
            .collect();
        let dominates = |a: Point, b: Point| a.cost <= b.cost && a.error <= b.error && a != b;
        let undominated = |index: &usize| !grid.iter().any(|other| dominates(*other, grid[*index]));
        let first = |index: &usize| !grid[..*index].contains(&grid[*index]);
        let expected: Vec<usize> = (0..grid.len()).filter(undominated).filter(first).collect();
        let mut found = front(&grid);
        assert!(found.len() > 5, "a long front: {found:?}");
        assert!(found.windows(2).all(|pair| grid[pair[0]].cost < grid[pair[1]].cost), "cost rises");
        found.sort_unstable();
        assert_eq!(found, expected);
    }

    #[test]
    fn ties_go_to_the_better_and_then_to_the_first() {
        let tied = points(&[(2.0, 5.0), (2.0, 3.0), (2.0, 3.0), (4.0, 3.0)]);
        assert_eq!(front(&tied), [1]);
        assert_eq!(cheapest_within_error(&tied, 6.0), Some(Choice::Within(1)));
        assert_eq!(most_accurate_within_cost(&tied, 9.0), Some(Choice::Within(1)));
    }

    #[test]
    fn budgets_include_their_ends() {
        let points = points(&MEASURED);
        assert_eq!(cheapest_within_error(&points, 0.066), Some(Choice::Within(4)));
        assert_eq!(cheapest_within_error(&points, 0.0659), Some(Choice::Within(2)));
        assert_eq!(most_accurate_within_cost(&points, 78.0), Some(Choice::Within(4)));
        assert_eq!(most_accurate_within_cost(&points, 100.0), Some(Choice::Within(4)), "not the 64 × 6 that is nearer");
    }

    #[test]
    fn a_budget_that_nothing_keeps_names_the_nearest() {
        let points = points(&MEASURED);
        assert_eq!(cheapest_within_error(&points, 1e-3), Some(Choice::Nearest(5)));
        assert_eq!(most_accurate_within_cost(&points, 1.0), Some(Choice::Nearest(1)));
        assert_eq!(cheapest_within_error(&points, f64::NAN).map(Choice::index), Some(5));
    }

    #[test]
    fn what_was_not_measured_is_never_chosen() {
        let broken =
            points(&[(f64::NAN, 0.0), (0.0, f64::NAN), (f64::NEG_INFINITY, 1.0), (3.0, 4.0), (5.0, f64::INFINITY)]);
        assert_eq!(front(&broken), [3]);
        assert_eq!(cheapest_within_error(&broken, 1.0), Some(Choice::Nearest(3)));
        assert_eq!(most_accurate_within_cost(&broken, 10.0), Some(Choice::Within(3)));
        for empty in [points(&[]), points(&[(f64::NAN, 1.0)])] {
            assert_eq!(front(&empty), Vec::<usize>::new());
            assert_eq!(cheapest_within_error(&empty, 1.0), None);
            assert_eq!(most_accurate_within_cost(&empty, 1.0), None);
        }
    }
}
