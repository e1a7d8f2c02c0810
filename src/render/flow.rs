//! Flows on the weather map: layers that carry what lies below them.
//!
//! All of them are without divergence, and how they advect a place in a time is known in closed form: a vortex turns circles, the
//! others push lines along themselves. So any time is reached directly, and cloud is neither made nor lost.

use std::f64::consts::SQRT_2;

use glam::{DVec2, Vec2};

use super::uniforms::edge_index;
use super::uniforms::other::FlowUniforms;
use super::weather::SIDE;
use crate::gpu::ProgramKey;
use crate::scene::{FlowKind, MapEdge, MapLayer, Weather};

/// Steps of a flow, in edges of the map that its fastest places move in one: a quarter of a texel. Between them the map does not
/// change. And the shortest, in seconds.
const STEP: f64 = 0.25 / SIDE as f64;
const SHORTEST_SECS: f64 = 1.0 / 30.0;
/// The greatest of `q (1 - q²)²`, a vortex's speed by its radius.
const FASTEST: f64 = 0.286_217;

/// The program of all flows.
pub(super) fn key() -> ProgramKey {
    ProgramKey::plain("pass/weather_flow.wgsl")
}

/// What a flow has done at a time.
#[allow(clippy::cast_possible_truncation, reason = "places on the map, to single precision")]
pub(super) fn at(layer: &MapLayer, weather: &Weather, time_secs: f64) -> FlowUniforms {
    let speed = f64::from(layer.flow_mps * layer.opacity) / f64::from(weather.size_m);
    let step_secs = (STEP / speed.abs().max(1e-12)).max(SHORTEST_SECS);
    // What stands still never changes.
    let since_secs = if speed == 0.0 { 0.0 } else { time_secs - f64::from(layer.flow_at_secs) };
    let since_secs = (since_secs / step_secs).floor() * step_secs;
    let begun_secs = f64::from(layer.flow_begun_secs);
    let period = f64::from(layer.flow_secs);
    // Two that take turns, each over its period about the age at which it counts most.
    let turns = [0.0, 0.5].map(|begin| (since_secs / period + begin).rem_euclid(1.0) - 0.5);
    let share = 1.0 - 2.0 * turns[0].abs();
    let ages = turns.map(|turn| begun_secs + turn * period);
    let heading = f64::from(layer.flow_heading_deg);
    let (along, across) = match layer.flow {
        FlowKind::Uniform => (shift(towards(heading) * speed * (begun_secs + since_secs), weather.edge), DVec2::ZERO),
        _ => along_the_map(heading),
    };
    let (ages, share) = if layer.flow == FlowKind::Uniform { ([0.0; 2], 1.0) } else { (ages, share) };
    let per_edge = if layer.flow == FlowKind::Vortex { 1.0 / (f64::from(layer.flow_radius) * FASTEST) } else { 1.0 };
    let amounts = ages.map(|age| (speed * age * per_edge) as f32);
    FlowUniforms {
        centre: Vec2::new(layer.flow_east, layer.flow_south),
        along: along.as_vec2(),
        across: across.as_vec2(),
        amounts: Vec2::from_array(amounts),
        share: share as f32,
        radius: layer.flow_radius,
        kind: index(layer.flow),
        edge: edge_index(weather.edge),
    }
}

/// How far all of the map has come; whole ways round one that repeats are none, and beyond its end it is gone.
fn shift(way: DVec2, edge: MapEdge) -> DVec2 {
    if edge == MapEdge::Repeat { way - way.floor() } else { way.clamp(DVec2::splat(-2.0), DVec2::splat(2.0)) }
}

/// A heading on the map, clockwise from north: east and south.
fn towards(heading_deg: f64) -> DVec2 {
    let (sin, cos) = heading_deg.to_radians().sin_cos();
    DVec2::new(sin, -cos)
}

/// The nearest eighth of a turn, on which lines close where the map repeats; and the direction across it in which they come again
/// after 1.
fn along_the_map(heading_deg: f64) -> (DVec2, DVec2) {
    let eighth = (heading_deg / 45.0).round() * 45.0;
    let along = towards(eighth);
    let across = DVec2::new(-along.y, along.x);
    // Diagonals come again after half a diagonal.
    let scale = if (along.x * along.y).abs() > 0.1 { SQRT_2 } else { 1.0 };
    (along, (across * scale).round())
}

/// As `pass/weather_flow.wgsl` numbers them.
fn index(kind: FlowKind) -> u32 {
    match kind {
        FlowKind::Uniform => 0,
        FlowKind::Vortex => 1,
        FlowKind::Band => 2,
        FlowKind::Shear => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_run_in_eighths_of_a_turn_and_close() {
        for (heading, expected) in [(0.0, [0.0, -1.0]), (100.0, [1.0, 0.0]), (181.0, [0.0, 1.0]), (359.0, [0.0, -1.0])]
        {
            let (along, across) = along_the_map(heading);
            assert!(along.distance(DVec2::from_array(expected)) < 1e-9, "{heading}: {along}");
            assert!(along.dot(across).abs() < 1e-9 && (across.length() - 1.0).abs() < 1e-9, "{heading}: {across}");
        }
        let (along, across) = along_the_map(50.0);
        assert!((along - DVec2::new(1.0, -1.0) / SQRT_2).length() < 1e-9, "{along}");
        assert_eq!(across, DVec2::new(1.0, 1.0), "whole numbers, so that copies of the map agree");
    }

    #[test]
    fn a_uniform_flow_goes_on_evenly_in_any_direction_and_at_any_time() {
        let layer = MapLayer { flow: FlowKind::Uniform, flow_heading_deg: 45.0, flow_mps: 12.0, ..MapLayer::default() };
        for edge in [MapEdge::Repeat, MapEdge::Clear] {
            let weather = Weather { edge, ..Weather::default() };
            for time in [-1e9, -500.0, 0.0, 777.0, 3e7] {
                let [a, b] = [time - 5.0, time + 5.0].map(|time| at(&layer, &weather, time).along);
                let apart = b - a;
                let apart = if edge == MapEdge::Repeat { apart - apart.round() } else { apart };
                let is_gone = edge == MapEdge::Clear && f64::abs(time) > 1e4;
                let expected = if is_gone { 0.0 } else { 120.0 / 24_000.0 };
                assert!((apart.length() - expected).abs() < 6e-4, "{edge:?}, {time}: {apart}");
            }
        }
    }

    #[test]
    fn two_take_turns_and_begin_anew_unseen() {
        let layer = MapLayer { flow: FlowKind::Vortex, flow_secs: 1000.0, ..MapLayer::default() };
        let weather = Weather::default();
        let (start, later) = (at(&layer, &weather, 500.0), at(&layer, &weather, 999.9));
        // To a step.
        assert!((start.share - 1.0).abs() < 3e-3 && start.amounts.x.abs() < 1e-2, "{start:?}");
        assert!(later.share < 0.005 && later.amounts.x > 0.1 && later.amounts.y.abs() < 0.01, "{later:?}");
        let still = MapLayer { flow_mps: 0.0, ..layer.clone() };
        assert_eq!(at(&still, &weather, 7.0), at(&still, &weather, 700.0), "nothing to make anew");
        let far = at(&layer, &weather, 3.0e13 + 250.0);
        assert!(far.amounts.is_finite() && (0.0..=1.0).contains(&far.share), "{far:?}");
    }
}
