//! Flows on the weather map: layers that carry what lies below them.
//!
//! All of them are without divergence, and where they carry a place in a time is known in closed form: a vortex turns circles, the
//! others push lines along themselves. So any time is reached directly, and cloud is neither made nor lost.

use std::f64::consts::SQRT_2;

use glam::{DVec2, Vec2};

use super::uniforms::other::FlowUniforms;
use crate::gpu::ProgramKey;
use crate::scene::{FlowKind, MapEdge, MapLayer, Weather};

/// Steps of a flow's course: between them the map does not change.
const STEPS: f64 = 2048.0;
/// The greatest of `q (1 - q²)²`, a vortex's speed by its radius.
const FASTEST: f64 = 0.286_217;

/// The program of all flows.
pub(super) fn key() -> ProgramKey {
    ProgramKey::plain("pass/weather_flow.wgsl")
}

/// What a flow has done at a time.
#[allow(clippy::cast_possible_truncation, reason = "places on the map, to single precision")]
pub(super) fn at(layer: &MapLayer, weather: &Weather, time_secs: f64) -> FlowUniforms {
    // Whole ways round the map are none.
    let speed = f64::from(layer.flow_mps) / f64::from(weather.size_m);
    let period = f64::from(layer.flow_secs);
    let course = (time_secs / period * STEPS).floor() / STEPS;
    // Two that take turns; each is at its start when it counts most, so that it is carried as far back as on.
    let ages = [course, course + 0.5].map(|course| (course.rem_euclid(1.0) - 0.5) * period);
    let heading = f64::from(layer.flow_heading_deg);
    let (along, across) = match layer.flow {
        FlowKind::Uniform => (towards(heading), DVec2::ZERO),
        _ => along_the_map(heading),
    };
    let (amounts, share) = match layer.flow {
        FlowKind::Uniform => ([(speed * course * period).rem_euclid(1e4); 2], 1.0),
        FlowKind::Vortex => {
            (ages.map(|age| speed * age / (f64::from(layer.flow_radius) * FASTEST)), turns(ages, period))
        }
        FlowKind::Band | FlowKind::Shear => (ages.map(|age| speed * age), turns(ages, period)),
    };
    FlowUniforms {
        centre: Vec2::new(layer.flow_east, layer.flow_south),
        along: along.as_vec2(),
        across: across.as_vec2(),
        amounts: Vec2::new(amounts[0] as f32, amounts[1] as f32),
        share: share as f32,
        radius: layer.flow_radius,
        kind: index(layer.flow),
        repeats: u32::from(weather.edge == MapEdge::Repeat),
    }
}

/// How much the first of the two counts.
fn turns(ages: [f64; 2], period: f64) -> f64 {
    1.0 - 2.0 * ages[0].abs() / period
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
    fn two_take_turns_and_begin_anew_unseen() {
        let layer = MapLayer { flow: FlowKind::Vortex, flow_secs: 1000.0, ..MapLayer::default() };
        let weather = Weather::default();
        let (start, later) = (at(&layer, &weather, 500.0), at(&layer, &weather, 999.9));
        assert!((start.share - 1.0).abs() < 1e-6 && start.amounts.x.abs() < 1e-6, "{start:?}");
        assert!(later.share < 0.002 && later.amounts.x > 0.1 && later.amounts.y.abs() < 0.01, "{later:?}");
        let far = at(&layer, &weather, 3.0e13 + 250.0);
        assert!(far.amounts.is_finite() && (0.0..=1.0).contains(&far.share), "{far:?}");
    }
}
