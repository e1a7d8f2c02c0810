//! Flows that carry the weather map.

use nephoscope::render::Renderer;
use nephoscope::render::tables::TableKind;
use nephoscope::scene::{FlowKind, MapBlend, MapEdge, MapLayer, MapSource, Scene};

use crate::common::gpu;
use crate::common::sky::table;

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
    table(renderer, scene, time_secs, TableKind::WeatherMap).rgba
}

/// The map that the flows carry.
fn below(renderer: &mut Renderer) -> Vec<[f32; 4]> {
    let mut still = sky(FlowKind::Vortex);
    still.weather.layers.pop();
    map(renderer, &still, 0.0)
}

fn mean(map: &[[f32; 4]]) -> f64 {
    map.iter().map(|texel| f64::from(texel[0])).sum::<f64>() / map.len() as f64
}

/// The share of the map that is cloud where a third should be.
fn cover(map: &[[f32; 4]]) -> f64 {
    map.iter().filter(|texel| texel[0] > 0.67).count() as f64 / map.len() as f64
}

fn apart(a: &[[f32; 4]], b: &[[f32; 4]]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from((a[0] - b[0]).abs())).sum::<f64>() / a.len() as f64
}

#[test]
fn flows_make_no_cloud_and_lose_none_and_any_time_is_reached_directly() {
    let mut renderer = Renderer::new(gpu()).expect("it fits");
    let below = below(&mut renderer);
    for flow in [FlowKind::Uniform, FlowKind::Vortex, FlowKind::Band, FlowKind::Shear] {
        let scene = sky(flow);
        // Where the first of the two counts alone, it has just begun.
        let start = if flow == FlowKind::Uniform { 0.0 } else { 500.0 };
        assert!(apart(&map(&mut renderer, &scene, start), &below) < 1e-3, "{flow:?} begins with the map as it is");
        let later = map(&mut renderer, &scene, start + 180.0);
        assert!(apart(&later, &below) > 0.005, "{flow:?} carries the map");
        assert!((mean(&later) / mean(&below) - 1.0).abs() < 2e-2, "{flow:?}: {} and {}", mean(&later), mean(&below));
        // While two take turns that have gone far apart, as much is cloud as ever.
        for age in [120.0, 250.0, 400.0] {
            let (seen, expected) = (cover(&map(&mut renderer, &scene, start + age)), cover(&below));
            println!("{flow:?} after {age} s: {seen:.3} of the map is above the threshold, {expected:.3} before");
            assert!((seen - expected).abs() < 0.03, "{flow:?} after {age} s: {seen} is cloud, not {expected}");
        }
        assert!(later.iter().flatten().all(|value| (0.0..=1.0).contains(value)), "{flow:?}");
        let far = map(&mut renderer, &scene, -3.0e13);
        assert!((mean(&far) / mean(&below) - 1.0).abs() < 2e-2, "{flow:?} a million years ago");
        for time in [-500.0, 0.0, 250.0, 500.0, 680.0, 1000.0] {
            let [before, after] = [-0.6, 0.6].map(|apart| map(&mut renderer, &scene, time + apart));
            assert!(apart(&before, &after) < 0.1 * apart(&below, &later), "{flow:?} jumps at {time} s");
        }
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
    let below = below(&mut renderer);
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
    // A vortex leaves alone what is beyond its radius.
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

/// A map with one round cloud on it, and where that is on a map.
fn spot(folder: &std::path::Path, [east, south]: [f32; 2]) -> String {
    let image = image::GrayImage::from_fn(256, 256, |x, y| {
        let [x, y] = [x, y].map(|at| (at as f32 + 0.5) / 256.0);
        image::Luma([if (x - east).hypot(y - south) < 0.03 { 255 } else { 0 }])
    });
    let path = folder.join("spot.png");
    image.save(&path).expect("written");
    path.display().to_string()
}

fn middle(map: &[[f32; 4]]) -> [f64; 2] {
    let weighed = |place: &dyn Fn(usize) -> usize| {
        let sum =
            |weight: &dyn Fn(usize) -> f64| (0..map.len()).map(|at| f64::from(map[at][0]) * weight(at)).sum::<f64>();
        sum(&|at| (place(at) as f64 + 0.5) / SIDE as f64) / sum(&|_| 1.0)
    };
    [weighed(&|at| at % SIDE), weighed(&|at| at / SIDE)]
}

#[test]
fn one_cloud_is_carried_where_the_flow_goes() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut renderer = Renderer::new(gpu()).expect("it fits");
    // (flow, heading, m/s) and where a cloud that was east of the middle comes to after 1000 s.
    let edge = |mps: f32| f64::from(mps) * 1000.0 / 24_000.0;
    // By radius over a third of its own a vortex has turned a quarter: bell(1/3) / (0.3 * 0.2862) of its speed.
    let quarter = 24.0 * std::f32::consts::FRAC_PI_2 * 0.3 * 0.286_217 / 0.790_12;
    // Beside the middle of a band it is slower: bell(0.1 / sqrt(2) / 0.3).
    let aside = 0.892 * edge(2.4) * std::f64::consts::FRAC_1_SQRT_2;
    for (flow, heading, mps, expected) in [
        (FlowKind::Vortex, 0.0, quarter, [0.5, 0.6]),
        (FlowKind::Vortex, 0.0, -quarter, [0.5, 0.4]),
        (FlowKind::Band, 90.0, 2.4, [0.6 + edge(2.4), 0.5]),
        (FlowKind::Band, 45.0, 2.4, [0.6 + aside, 0.5 - aside]),
        (FlowKind::Shear, 0.0, 2.4, [0.6, 0.5 - edge(2.4) * f64::cos(0.2 * std::f64::consts::PI)]),
    ] {
        let mut scene = sky(flow);
        scene.weather.layers[0].source = MapSource::Image;
        scene.weather.layers[0].image.0 = spot(folder.path(), [0.6, 0.5]);
        let layer = &mut scene.weather.layers[1];
        (layer.flow_east, layer.flow_south, layer.flow_heading_deg, layer.flow_mps) = (0.5, 0.5, heading, mps);
        layer.flow_begun_secs = 1000.0;
        let seen = middle(&map(&mut renderer, &scene, 500.0));
        let off = (seen[0] - expected[0]).hypot(seen[1] - expected[1]);
        assert!(off < 0.01, "{flow:?} at {mps} m/s towards {heading}° carries it to {seen:?}, not {expected:?}");
    }
}

#[test]
fn without_layers_and_under_flows_alone_the_map_is_clear() {
    let mut renderer = Renderer::new(gpu()).expect("it fits");
    let mut scene = sky(FlowKind::Vortex);
    assert!(mean(&map(&mut renderer, &scene, 300.0)) > 0.1, "there is cloud to lose");
    let is_clear = |renderer: &mut Renderer, scene: &Scene| {
        map(renderer, scene, 300.0).iter().flatten().all(|value| *value == 0.0)
    };
    scene.weather.layers.remove(0);
    assert!(is_clear(&mut renderer, &scene), "a flow carries nothing");
    scene.weather.layers[0].flow_mps = 0.0;
    assert!(is_clear(&mut renderer, &scene), "a flow that stands still");
    // Nor does one hide from the next layer that it is the lowest.
    let own = MapLayer { blend: MapBlend::Subtract, ..MapLayer::default() };
    scene.weather.layers.push(own);
    let over = map(&mut renderer, &scene, 300.0);
    scene.weather.layers[0].flow_mps = 20.0;
    assert!(map(&mut renderer, &scene, 300.0) == over, "a flow over nothing, moving or not");
    scene.weather.layers.remove(0);
    assert!(map(&mut renderer, &scene, 300.0) == over && mean(&over) > 0.1, "as without it");
    scene.weather.layers.clear();
    assert!(is_clear(&mut renderer, &scene), "no layer");
}
