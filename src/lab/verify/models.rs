//! Hard cases of what clouds are modelled with: every density model, shapes, and painted maps.

use std::sync::Arc;

use super::VerifyError;
use super::hard::{Finding, SIZE, quality, show_at};
use crate::render::Renderer;
use crate::scene::{
    Automaton, Brush, CloudKind, DensityModel, MAX_SHAPES, MapBlend, MapLayer, MapSource, Quality, Scene, Shape,
    ShapeJoin, ShapeKind, ShapeRole, Stroke, Strokes,
};

/// A sky whose clouds have a model, from below them.
fn sky(model: DensityModel) -> Scene {
    let mut scene = Scene::default();
    scene.layers[0].model = model;
    (scene.weather.coverage, scene.camera.pitch_deg) = (0.6, 20.0);
    scene
}

/// Renders all of them, and says which first showed what is no light.
fn all_finite(
    renderer: &mut Renderer,
    cases: impl IntoIterator<Item = (String, Scene, f64)>,
    least_opacity: f64,
) -> Result<Finding, VerifyError> {
    let (mut tried, mut cloudy) = (0, 0);
    for (name, scene, time_secs) in cases {
        renderer.forget_history();
        let shown = show_at(renderer, (&scene, &quality()), [16, 9], time_secs)?;
        if let Some(fault) = shown.fault() {
            return Ok(Finding::that(false, "finite light", format!("{name}: {fault}")));
        }
        tried += 1;
        cloudy += usize::from(shown.opacity() > least_opacity);
    }
    let holds = cloudy * 3 >= tried;
    Ok(Finding::that(holds, "finite light, and cloud in a third", format!("{tried} skies, {cloudy} with cloud")))
}

/// The automaton at the ends of its parameters, and at times that nobody waits for.
pub(super) fn automata(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let small = Automaton { cells: 31, levels: 9, coverage: 0.7, ..Automaton::default() };
    let kinds = [
        ("as it comes", small.clone()),
        ("of every chance", Automaton { vapour: 1.0, activation: 1.0, extinction: 1.0, ..small.clone() }),
        ("of no chance", Automaton { vapour: 0.0, activation: 0.0, extinction: 0.0, ..small.clone() }),
        ("without favour", Automaton { coverage: 0.0, height: 0.05, ..small.clone() }),
        ("all favour", Automaton { coverage: 1.0, height: 1.0, patches: 64, change: 10.0, ..small.clone() }),
        ("sheared", Automaton { shear: -1.0, levels: 64, cells: 16, patches: 1, ..small }),
    ];
    let times = [0.0, -1e5, 3.2e13, -3.2e13];
    let cases = kinds.iter().flat_map(|(name, automaton)| {
        times.map(|time_secs| {
            let mut scene = sky(DensityModel::Automaton);
            scene.layers[0].automaton = automaton.clone();
            scene.weather.coverage = 1.0;
            (format!("an automaton {name} at {time_secs} s"), scene, time_secs)
        })
    });
    all_finite(renderer, cases, 0.01)
}

/// The grid of sun depth under low and high light, from below, inside, above and beside thin and tall clouds on small and
/// large planets.
pub(super) fn sun_grids(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let (mut tried, mut worst) = (0, 0.0_f64);
    for (index, elevation_deg) in [-5.0, 0.0, 0.5, 20.4, 20.6, 90.0].into_iter().enumerate() {
        for (height_m, top_m) in [(2.0, 1001.5), (1500.0, 3000.0), (19_000.0, 20_000.0)] {
            let mut scene = sky(DensityModel::Profile);
            (scene.sun.elevation_deg, scene.camera.height_m) = (elevation_deg, height_m);
            (scene.layers[0].base_m, scene.layers[0].top_m) = (1000.0, top_m);
            scene.domain.planet_radius_m = if index % 2 == 0 { 6_371_000.0 } else { 300_000.0 };
            (scene.camera.east_m, scene.camera.pitch_deg) = (150_000.0, if height_m > top_m { -20.0 } else { 15.0 });
            // Enough steps that it is the grid which is compared, and not the first few steps before it.
            let with = |light_grid: u32| Quality { light_grid, light_steps: 24, ..quality() };
            // Under the lowest sun the tallest clouds show little that is lit, much brighter than the rest: enough pixels
            // that it is no chance.
            let size = if top_m > 10_000.0 && (0.1..1.0).contains(&elevation_deg) { [64, 36] } else { SIZE };
            let [all, coarse, grid] = [0, 16, 160].map(|nodes| show_at(renderer, (&scene, &with(nodes)), size, 0.0));
            let (all, coarse, grid) = (all?, coarse?, grid?);
            if let Some(fault) = grid.fault().or_else(|| coarse.fault()) {
                let name = format!("a sun at {elevation_deg}° seen from {height_m} m");
                return Ok(Finding::that(false, "finite light", format!("{name}: {fault}")));
            }
            tried += 1;
            worst = worst.max((grid.mean() / all.mean().max(1e-12) - 1.0).abs());
        }
    }
    let seen = format!("{tried} skies, at most {:.1} % apart", 100.0 * worst);
    Ok(Finding::that(worst < 0.05, "finite light, within 5 % of that of all steps", seen))
}

/// Shapes of no size, of all sizes, in and around the eye, and as many as there may be.
pub(super) fn shapes(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let sizes = [0.0, 1.0, 3000.0, 100_000.0];
    let kinds = [ShapeKind::Sphere, ShapeKind::Ellipsoid, ShapeKind::Box, ShapeKind::Cylinder, ShapeKind::Capsule];
    let cases = kinds.into_iter().flat_map(|kind| {
        sizes.map(|size_m| {
            let mut scene = sky(DensityModel::Shapes);
            let shape = Shape {
                kind,
                width_m: size_m,
                length_m: 0.5 * size_m,
                tall_m: (2.0 * size_m).min(20_000.0),
                rounding_m: 5000.0,
                tilt_deg: 90.0,
                ..Shape::default()
            };
            let all = (0..=u8::MAX).take(MAX_SHAPES).map(|index| {
                let is_solid = index % 2 == 1;
                let join = match index {
                    20 => ShapeJoin::Difference,
                    21 => ShapeJoin::Intersection,
                    _ => ShapeJoin::Union,
                };
                Shape {
                    role: if is_solid { ShapeRole::Solid } else { ShapeRole::Cloud },
                    join,
                    blend_m: if index % 3 == 0 { 5000.0 } else { 0.0 },
                    // Solid things stand behind the clouds, or would hide them.
                    south_m: if is_solid { -60_000.0 } else { -2000.0 - 100.0 * f32::from(index) },
                    ..shape.clone()
                }
            });
            scene.shapes = all.collect();
            scene.shape_edge_m = 1.0;
            (format!("{kind:?} of {size_m} m"), scene, 0.0)
        })
    });
    all_finite(renderer, cases, 0.01)
}

/// Brushes of all kinds at their ends, and layers of the map that take away from each other.
pub(super) fn paintings(renderer: &mut Renderer) -> Result<Finding, VerifyError> {
    let brushes = [Brush::Add, Brush::Erase, Brush::Raise, Brush::Lower, Brush::Restore];
    let cases = brushes.into_iter().flat_map(|brush| {
        [(1e-4, 0.0, MapBlend::Add), (0.5, 1.0, MapBlend::Mask), (0.5, 0.0, MapBlend::Subtract)].map(
            |(radius, softness, blend)| {
                let mut scene = sky(DensityModel::Profile);
                let dabs = vec![[0.0, 0.0], [1.0, 1.0], [-3.5, 0.5], [0.5, 0.999_999]];
                let kind = CloudKind::Stratus;
                let stroke = Stroke { brush, kind, radius, strength: 1.0, softness, amount: 1.0, dabs };
                let strokes = Strokes((0..8).map(|_| Arc::new(stroke.clone())).collect());
                let maps = &mut scene.weather.layers;
                maps.push(MapLayer { seed: 9, blend, opacity: 0.5, ..MapLayer::default() });
                maps.push(MapLayer { source: MapSource::Painted, strokes, ..MapLayer::default() });
                (format!("{brush:?} with a radius of {radius}"), scene, 0.0)
            },
        )
    });
    all_finite(renderer, cases, 0.01)
}
