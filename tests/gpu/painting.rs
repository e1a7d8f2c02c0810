//! Painted layers of the weather map.

use std::sync::Arc;

use nephoscope::render::Renderer;
use nephoscope::render::tables::{Table, TableKind};
use nephoscope::render::uniforms::map_place;
use nephoscope::scene::{Brush, CloudKind, MapBlend, MapEdge, MapLayer, MapSource, Scene, Stroke, Strokes};

use crate::common::sky::table;
use crate::common::{Random, gpu};

fn sky(strokes: Vec<Stroke>, over_generated: bool) -> Scene {
    let mut scene = Scene::default();
    scene.weather.evolution_secs = 0.0;
    if !over_generated {
        scene.weather.layers.clear();
    }
    let strokes = Strokes(strokes.into_iter().map(Arc::new).collect());
    scene.weather.layers.push(MapLayer { source: MapSource::Painted, strokes, ..MapLayer::default() });
    scene
}

fn map(renderer: &mut Renderer, scene: &Scene) -> Table {
    table(renderer, scene, 0.0, TableKind::WeatherMap)
}

fn renderer() -> Renderer {
    Renderer::new(gpu()).expect("it fits")
}

fn any_stroke(random: &mut Random) -> Stroke {
    let brushes = [Brush::Add, Brush::Erase, Brush::Raise, Brush::Lower, Brush::Restore];
    let kinds = [CloudKind::Cumulus, CloudKind::Stratus, CloudKind::Stratocumulus];
    let mut at = |low, high| random.between(low, high);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    let [brush, kind] = [at(0.0, 4.99) as usize, at(0.0, 2.99) as usize];
    // Some lie beyond the edge of the map, which repeats.
    let (start, step) = ([at(-0.5, 1.5), at(-0.5, 1.5)], [at(-0.05, 0.05), at(-0.05, 0.05)]);
    let dabs = (0..8).map(|i| [start[0] + step[0] * i as f32, start[1] + step[1] * i as f32]).collect();
    Stroke {
        brush: brushes[brush],
        kind: kinds[kind],
        radius: at(0.01, 0.3),
        strength: at(0.1, 1.0),
        softness: at(0.0, 1.0),
        amount: at(0.2, 1.0),
        dabs,
    }
}

/// The map by definition: every texel through every dab.
fn by_hand(strokes: &[Stroke], below: &dyn Fn(usize) -> [f32; 4]) -> Vec<[f32; 4]> {
    let side = 512;
    let texel = |index: usize| {
        let at = [(index % side) as f32 + 0.5, (index / side) as f32 + 0.5].map(|at| at / side as f32);
        let mut value = below(index);
        let unpainted = value;
        let (mut added, mut taken) = ([0.0_f32; 4], [0.0_f32; 2]);
        for stroke in strokes {
            for dab in &stroke.dabs {
                let apart = [0, 1].map(|axis| at[axis] - dab[axis]).map(|apart| apart - apart.round());
                let inside =
                    ((1.0 - apart[0].hypot(apart[1]) / stroke.radius) / stroke.softness.max(1e-3)).clamp(0.0, 1.0);
                let share = stroke.strength * inside * inside * (3.0 - 2.0 * inside);
                let mut goal = [0.0; 4];
                let reach = match stroke.brush {
                    Brush::Add => {
                        goal[stroke.kind as usize] = stroke.amount;
                        [share, 0.0]
                    }
                    Brush::Erase => [share, 0.0],
                    Brush::Raise => {
                        goal[3] = 1.0;
                        [0.0, share]
                    }
                    Brush::Lower => [0.0, share],
                    Brush::Restore => {
                        added = added.map(|value| value * (1.0 - share));
                        taken = taken.map(|value| value * (1.0 - share));
                        continue;
                    }
                };
                for channel in 0..4 {
                    let reach = reach[usize::from(channel == 3)];
                    added[channel] += reach * (goal[channel] - added[channel]);
                }
                for part in 0..2 {
                    taken[part] += reach[part] * (1.0 - taken[part]);
                }
            }
        }
        for channel in 0..4 {
            value[channel] = unpainted[channel] * (1.0 - taken[usize::from(channel == 3)]) + added[channel];
        }
        value
    };
    (0..side * side).map(texel).collect()
}

#[test]
fn strokes_are_what_their_dabs_say_and_repeat_with_the_map() {
    let mut random = Random::new(71);
    for over_generated in [false, true] {
        let strokes: Vec<Stroke> = (0..7).map(|_| any_stroke(&mut random)).collect();
        let bare = map(&mut renderer(), &sky(Vec::new(), over_generated));
        let painted = map(&mut renderer(), &sky(strokes.clone(), over_generated));
        let expected = by_hand(&strokes, &|index| bare.rgba[index]);
        for (index, (seen, expected)) in painted.rgba.iter().zip(&expected).enumerate() {
            for channel in 0..4 {
                let off = (seen[channel] - expected[channel]).abs();
                assert!(off < 2e-3, "texel {index}, channel {channel}: {seen:?}, by hand {expected:?}");
            }
        }
        assert!(painted != bare, "something was painted");
    }
}

#[test]
fn a_stroke_that_is_taken_back_leaves_nothing_and_one_that_grows_is_one() {
    let mut random = Random::new(72);
    let strokes: Vec<Stroke> = (0..5).map(|_| any_stroke(&mut random)).collect();
    let (mut kept, mut other) = (renderer(), renderer());
    let mut afresh = |strokes: &[Stroke]| {
        other.forget_everything().expect("nothing is under way");
        map(&mut other, &sky(strokes.to_vec(), true))
    };
    let fresh: Vec<Table> = (0..=5).map(|count| afresh(&strokes[..count])).collect();
    // There and back again, one step and several at once.
    for count in [0, 1, 2, 3, 4, 5, 4, 3, 5, 1, 0, 5, 2] {
        assert!(map(&mut kept, &sky(strokes[..count].to_vec(), true)) == fresh[count], "{count} strokes");
    }
    // Under the brush.
    for dabs in 1..=8 {
        let mut under_way = strokes[..3].to_vec();
        under_way[2].dabs.truncate(dabs);
        let grown = map(&mut kept, &sky(under_way, true));
        assert!(dabs < 8 || grown == fresh[3], "the whole stroke");
    }
    // Another stroke in its place.
    let mut changed = strokes[..3].to_vec();
    changed[1].radius *= 0.5;
    let drawn_anew = afresh(&changed);
    assert!(map(&mut kept, &sky(changed, true)) == drawn_anew, "it is drawn anew");
}

#[test]
fn layers_join_as_their_blend_says() {
    let single = |seed: u32| {
        let mut scene = sky(Vec::new(), false);
        scene.weather.layers = vec![MapLayer { seed, stratus: 0.5, ..MapLayer::default() }];
        scene
    };
    let mut renderer = renderer();
    let [below, own] = [1, 2].map(|seed| map(&mut renderer, &single(seed)));
    for (blend, opacity) in [
        (MapBlend::Densest, 1.0),
        (MapBlend::Replace, 1.0),
        (MapBlend::Replace, 0.25),
        (MapBlend::Add, 0.5),
        (MapBlend::Subtract, 1.0),
        (MapBlend::Mask, 1.0),
        (MapBlend::Mask, 0.0),
    ] {
        let mut both = single(1);
        both.weather.layers.push(MapLayer { seed: 2, stratus: 0.5, blend, opacity, ..MapLayer::default() });
        let seen = map(&mut renderer, &both);
        for (index, (below, own)) in below.rgba.iter().zip(&own.rgba).enumerate() {
            let cloud = own[..3].iter().sum::<f32>().min(1.0);
            for channel in 0..4 {
                let (b, o, is_cloud) = (below[channel], own[channel], channel < 3);
                let joined = match blend {
                    MapBlend::Densest => b.max(o),
                    MapBlend::Replace => o,
                    MapBlend::Add => (b + o).min(1.0),
                    MapBlend::Subtract if is_cloud => (b - o).max(0.0),
                    MapBlend::Mask if is_cloud => b * cloud,
                    MapBlend::Subtract | MapBlend::Mask => b,
                };
                let expected = b + opacity * (joined - b);
                let off = (seen.rgba[index][channel] - expected).abs();
                assert!(off < 2e-3, "{blend:?} at {index}, channel {channel}: off by {off}");
            }
        }
    }
}

#[test]
fn a_place_in_the_sky_is_the_place_on_the_map_that_it_shows() {
    let mut scene = sky(Vec::new(), false);
    let size_m = f64::from(scene.weather.size_m);
    (scene.wind.from_deg, scene.wind.speed_mps) = (270.0, 10.0);
    scene.layers[0].lean_m = 400.0;
    let layer = scene.layers[0].clone();
    let at = |scene: &Scene, place, time| map_place(scene, &layer, place, time);
    let base = f64::from(layer.base_m);
    let top = f64::from(layer.top_m);
    let corner = at(&scene, [0.0, base, 0.0], 0.0);
    assert!(corner.length() < 1e-9, "{corner}");
    let east = at(&scene, [0.25 * size_m, base, 0.0], 0.0);
    assert!((east.x - 0.25).abs() < 1e-9, "{east}");
    let later = at(&scene, [1000.0, base, 0.0], 100.0);
    assert!(later.length() < 1e-9, "a kilometre of wind: {later}");
    let leaning = at(&scene, [400.0, top, 0.0], 0.0);
    assert!(leaning.length() < 1e-9, "tops lean downwind: {leaning}");
    scene.weather.edge = MapEdge::Clear;
    let middle = at(&scene, [0.0, base, 0.0], 0.0);
    assert!((middle - 0.5).length() < 1e-9, "a map that ends has its middle there: {middle}");
    scene.weather.moves = false;
    let held = at(&scene, [0.0, base, 0.0], 1e6);
    assert!((held - 0.5).length() < 1e-9, "{held}");
}
