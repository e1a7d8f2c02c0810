//! Flows that carry the weather map.

use nephoscope::render::Renderer;
use nephoscope::render::tables::TableKind;
use nephoscope::scene::{FlowKind, Frame, MapEdge, MapLayer, MapSource, Output, Quality, Scene};

use crate::common::gpu;

const SIDE: usize = 512;

fn sky(flow: FlowKind) -> Scene {
    let mut scene = Scene::default();
    scene.weather.evolution_secs = 0.0;
    scene.weather.layers.push(MapLayer {
        source: MapSource::Flow,
        flow,
        flow_east: 0.4,
        flow_south: 0.9,
        flow_radius: 0.3,
        flow_heading_deg: 90.0,
        flow_mps: 12.0,
        flow_secs: 1000.0,
        ..MapLayer::default()
    });
    scene
}

fn map(renderer: &mut Renderer, scene: &Scene, time_secs: f64) -> Vec<[f32; 4]> {
    let quality = Quality::default();
    let frame = Frame { scene, quality: &quality, size: [32, 18], time_secs, output: Output::Display, window: None };
    renderer.table(&frame, TableKind::WeatherMap).expect("it is made").expect("the sky has a map").rgba
}

fn mean(map: &[[f32; 4]]) -> f64 {
    map.iter().map(|texel| f64::from(texel[0])).sum::<f64>() / map.len() as f64
}

fn apart(a: &[[f32; 4]], b: &[[f32; 4]]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from((a[0] - b[0]).abs())).sum::<f64>() / a.len() as f64
}

#[test]
fn flows_make_no_cloud_and_lose_none_and_any_time_is_reached_directly() {
    let mut renderer = Renderer::new(gpu()).expect("it fits");
    let mut still = sky(FlowKind::Vortex);
    still.weather.layers.pop();
    let below = map(&mut renderer, &still, 0.0);
    for flow in [FlowKind::Uniform, FlowKind::Vortex, FlowKind::Band, FlowKind::Shear] {
        let scene = sky(flow);
        // Where the first of the two counts alone, it has just begun.
        let start = if flow == FlowKind::Uniform { 0.0 } else { 500.0 };
        assert!(apart(&map(&mut renderer, &scene, start), &below) < 1e-3, "{flow:?} begins with the map as it is");
        let later = map(&mut renderer, &scene, start + 180.0);
        assert!(apart(&later, &below) > 0.005, "{flow:?} carries the map");
        assert!((mean(&later) / mean(&below) - 1.0).abs() < 4e-3, "{flow:?}: {} and {}", mean(&later), mean(&below));
        assert!(later.iter().flatten().all(|value| (0.0..=1.0).contains(value)), "{flow:?}");
        let far = map(&mut renderer, &scene, -3.0e13);
        assert!((mean(&far) / mean(&below) - 1.0).abs() < 2e-2, "{flow:?} a million years ago");
        let before = map(&mut renderer, &scene, start + 179.5);
        assert!(apart(&before, &later) < 0.2 * apart(&below, &later), "{flow:?} does not jump");
        assert!(map(&mut renderer, &scene, start + 180.0) == later, "{flow:?}: the same, however it is reached");
        // Across the map's edge as elsewhere.
        let step = |x: usize, y: usize| (later[y * SIDE + x][0] - later[y * SIDE + (x + 1) % SIDE][0]).abs();
        let seam = |x: usize| (0..SIDE).map(|y| step(x, y)).sum::<f32>();
        let within = (0..SIDE - 1).map(seam).fold(0.0, f32::max);
        assert!(seam(SIDE - 1) <= within, "{flow:?} breaks at the edge of the map");
    }
}

#[test]
fn flows_go_where_they_are_told_and_nothing_comes_over_the_edge_of_maps_that_end() {
    let mut renderer = Renderer::new(gpu()).expect("it fits");
    let mut still = sky(FlowKind::Uniform);
    still.weather.layers.pop();
    let below = map(&mut renderer, &still, 0.0);
    // A whole number of texels to the east: 24 km are 512 of them.
    let mut scene = sky(FlowKind::Uniform);
    scene.weather.layers[1].flow_mps = 93.75;
    scene.weather.layers[1].flow_secs = 1024.0;
    let east = map(&mut renderer, &scene, 10.0);
    let off = (0..SIDE * SIDE).map(|at| {
        let (x, y) = (at % SIDE, at / SIDE);
        (east[y * SIDE + (x + 20) % SIDE][0] - below[at][0]).abs()
    });
    assert!(off.fold(0.0, f32::max) < 2e-3, "twenty texels to the east");
    scene.weather.edge = MapEdge::Clear;
    let ended = map(&mut renderer, &scene, 10.0);
    let came: f32 = (0..SIDE).flat_map(|y| (0..20).map(move |x| y * SIDE + x)).map(|at| ended[at][0]).sum();
    assert!(came <= 0.0, "nothing comes from beyond the western edge");
    // A vortex leaves alone what is beyond its radius, and turns clockwise.
    let mut scene = sky(FlowKind::Vortex);
    scene.weather.layers[1].flow_south = 0.5;
    scene.weather.layers[1].flow_radius = 0.2;
    let turned = map(&mut renderer, &scene, 540.0);
    let outside = (0..SIDE * SIDE).filter(|at| {
        let [x, y] = [at % SIDE, at / SIDE].map(|i| (i as f32 + 0.5) / SIDE as f32);
        (x - 0.4).hypot(y - 0.5) > 0.21
    });
    let most = outside.map(|at| (turned[at][0] - below[at][0]).abs()).fold(0.0, f32::max);
    assert!(most < 1e-3, "beyond its radius a vortex changes {most}");
}
