//! Painted layers of the weather map.

use std::sync::Arc;

use nephoscope::render::Renderer;
use nephoscope::render::tables::{Table, TableKind};
use nephoscope::render::uniforms::map_place;
use nephoscope::scene::{
    Brush, CloudKind, DensityModel, Frame, MapBlend, MapEdge, MapLayer, MapSource, Output, Quality, Scene, Stroke,
    Strokes,
};

use crate::common::sky::{frame, table};
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

/// Brushes that change each place by itself, and those that take from around it.
const BY_PLACE: [Brush; 5] = [Brush::Add, Brush::Erase, Brush::Raise, Brush::Lower, Brush::Restore];
const FROM_AROUND: [Brush; 4] = [Brush::Move, Brush::Grow, Brush::Shrink, Brush::Smooth];

fn any_stroke(random: &mut Random, brushes: &[Brush]) -> Stroke {
    let kinds = [CloudKind::Cumulus, CloudKind::Stratus, CloudKind::Stratocumulus];
    let mut at = |low, high| random.between(low, high);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    let [brush, kind] = [at(0.0, brushes.len() as f32 - 0.01) as usize, at(0.0, 2.99) as usize];
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
                    Brush::Move | Brush::Grow | Brush::Shrink | Brush::Smooth => unreachable!("they are not drawn"),
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
        let strokes: Vec<Stroke> = (0..7).map(|_| any_stroke(&mut random, &BY_PLACE)).collect();
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
    let all = [BY_PLACE.as_slice(), &FROM_AROUND].concat();
    let mut strokes: Vec<Stroke> = (0..5).map(|_| any_stroke(&mut random, &all)).collect();
    // Whatever is drawn, some of it moves what was there.
    (strokes[1].brush, strokes[3].brush) = (Brush::Move, Brush::Smooth);
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

/// A stroke to the east, so many texels from dab to dab.
fn eastwards(brush: Brush, count: u8, spacing: f32) -> Stroke {
    let dabs = (0..count).map(|i| [0.4 + spacing * f32::from(i) / 512.0, 0.5]).collect();
    Stroke { brush, kind: CloudKind::Cumulus, radius: 0.1, strength: 1.0, softness: 0.5, amount: 1.0, dabs }
}

/// Places of a map's texels by their distance from a place, in edges of the map.
fn within(centre: [f32; 2], radius: f32) -> impl Iterator<Item = usize> {
    let distance = move |index: usize| {
        let at = [(index % 512) as f32 + 0.5, (index / 512) as f32 + 0.5];
        (at[0] / 512.0 - centre[0]).hypot(at[1] / 512.0 - centre[1])
    };
    (0..512 * 512).filter(move |index| distance(*index) < radius)
}

#[test]
fn what_a_stroke_moves_is_where_it_ends_and_the_rest_where_it_was() {
    let mut renderer = renderer();
    let bare = map(&mut renderer, &sky(Vec::new(), true));
    let moved = map(&mut renderer, &sky(vec![eastwards(Brush::Move, 9, 8.0)], true));
    // Its inner half has no falloff.
    for index in within([0.4 + 64.0 / 512.0, 0.5], 0.045) {
        for (seen, expected) in moved.rgba[index].iter().zip(bare.rgba[index - 64]) {
            assert!((seen - expected).abs() < 2e-3, "texel {index}: {seen}, {expected} where it came from");
        }
    }
    let touched: Vec<usize> = (0..=8_u8).flat_map(|i| within([0.4 + f32::from(i) / 64.0, 0.5], 0.101)).collect();
    let touched = std::collections::BTreeSet::from_iter(touched);
    let changed = (0..512 * 512).filter(|index| moved.rgba[*index] != bare.rgba[*index]);
    let (inside, outside): (Vec<usize>, Vec<usize>) = changed.partition(|index| touched.contains(index));
    assert!(inside.len() > 2000 && outside.is_empty(), "{} and {}", inside.len(), outside.len());
    // What was painted goes along.
    let dot = Stroke { radius: 0.01, ..eastwards(Brush::Add, 1, 0.0) };
    let carried = map(&mut renderer, &sky(vec![dot, eastwards(Brush::Move, 9, 8.0)], false));
    let cloud = |east: f32| within([east, 0.5], 0.02).map(|index| carried.rgba[index][0]).sum::<f32>();
    assert!(cloud(0.4) < 1e-3 && cloud(0.4 + 64.0 / 512.0) > 20.0, "{}, {}", cloud(0.4), cloud(0.4 + 64.0 / 512.0));
}

#[test]
fn strokes_that_move_are_the_same_however_they_grew_and_leave_nothing() {
    let (mut kept, mut other) = (renderer(), renderer());
    let bare = map(&mut kept, &sky(Vec::new(), true));
    for brush in [Brush::Move, Brush::Smooth] {
        let whole = eastwards(brush, 150, 0.7);
        let first = eastwards(Brush::Add, 3, 9.0);
        for count in [64, 65, 150] {
            let part = Stroke { dabs: whole.dabs[..count].to_vec(), ..whole.clone() };
            let grown = map(&mut kept, &sky(vec![first.clone(), part.clone()], true));
            other.forget_everything().expect("nothing is under way");
            let fresh = map(&mut other, &sky(vec![first.clone(), part], true));
            assert!(grown == fresh, "{brush:?}: {count} dabs are not what they are at once");
        }
        assert!(map(&mut kept, &sky(Vec::new(), true)) == bare, "{brush:?} left something behind");
        // Another stroke below, and another of its kind at its place.
        let others = |radius| vec![Stroke { radius, ..first.clone() }, Stroke { radius, ..eastwards(brush, 9, 8.0) }];
        map(&mut kept, &sky(others(0.08), true));
        other.forget_everything().expect("nothing is under way");
        let fresh = map(&mut other, &sky(others(0.05), true));
        assert!(map(&mut kept, &sky(others(0.05), true)) == fresh, "{brush:?} is of what was painted before");
    }
}

#[test]
fn moved_cloud_crosses_edges_as_the_map_says_and_comes_back() {
    let mut renderer = renderer();
    let bare = map(&mut renderer, &sky(Vec::new(), true));
    let from_edge = |east: f32| {
        let dabs = (0..9_u8).map(|i| [(east + f32::from(i) / 64.0).fract(), 0.5]).collect();
        Stroke { dabs, ..eastwards(Brush::Move, 0, 0.0) }
    };
    // Over the edge of a map that repeats.
    let over = map(&mut renderer, &sky(vec![from_edge(0.95)], true));
    for index in within([0.95 + 0.125 - 1.0, 0.5], 0.045) {
        let from = index / 512 * 512 + (index % 512 + 512 - 64) % 512;
        let apart = [0, 1, 2, 3].map(|channel| (over.rgba[index][channel] - bare.rgba[from][channel]).abs());
        assert!(apart.iter().all(|apart| *apart < 2e-3), "texel {index}: {apart:?}");
    }
    // From beyond the edge of one that ends comes no cloud.
    let mut ending = sky(vec![Stroke { softness: 0.0, ..from_edge(0.0) }], true);
    ending.weather.edge = MapEdge::Clear;
    let inwards = map(&mut renderer, &ending);
    let column: f32 = (250..262).flat_map(|row| inwards.rgba[row * 512 + 8][..3].to_vec()).sum();
    assert_eq!(column, 0.0, "cloud that was nowhere");
    // Painting that is taken away takes its moves along.
    let hard = |brush, radius| Stroke { radius, softness: 0.0, ..eastwards(brush, 9, 8.0) };
    let strokes = vec![hard(Brush::Move, 0.05), eastwards(Brush::Smooth, 3, 8.0), hard(Brush::Restore, 0.2)];
    assert!(map(&mut renderer, &sky(strokes, true)) == bare, "something is left of it");
}

#[test]
fn clouds_grow_shrink_and_are_smoothed_under_the_brush() {
    let mut renderer = renderer();
    let dot = Stroke { radius: 0.03, softness: 0.1, ..eastwards(Brush::Add, 1, 0.0) };
    let mut of = |brush: Brush, count: u8| {
        let strokes = vec![dot.clone(), eastwards(brush, count, 0.0)];
        let map = map(&mut renderer, &sky(strokes, false));
        let cloud: f32 = map.rgba.iter().map(|texel| texel[0]).sum();
        let steepest = within([0.4, 0.5], 0.1).map(|index| (map.rgba[index][0] - map.rgba[index + 1][0]).abs());
        (cloud, steepest.fold(0.0, f32::max))
    };
    let ((plain, edge), (grown, _), (shrunk, _)) = (of(Brush::Move, 1), of(Brush::Grow, 4), of(Brush::Shrink, 4));
    // In its middle four dabs draw apart by 1 / 0.92 each.
    let wanted = 0.92_f32.powi(-8);
    assert!((grown / plain / wanted - 1.0).abs() < 0.05, "{} of {wanted}", grown / plain);
    assert!((shrunk / plain / 1.08_f32.powi(-8) - 1.0).abs() < 0.05, "{}", shrunk / plain);
    let (smoothed, soft_edge) = of(Brush::Smooth, 1);
    // Where the brush fades less of what is spread arrives.
    assert!((0.9..1.02).contains(&(smoothed / plain)), "{}", smoothed / plain);
    assert!(soft_edge < 0.5 * edge, "{soft_edge} of {edge}");
    // The map below is smoothed as well.
    let mut roughness = |strokes| {
        let map = map(&mut renderer, &sky(strokes, true));
        let apart = |index: usize| (map.rgba[index][0] - map.rgba[index + 4][0]).powi(2);
        within([0.4, 0.5], 0.045).map(apart).sum::<f32>()
    };
    let (rough, smooth) = (roughness(Vec::new()), roughness(vec![eastwards(Brush::Smooth, 1, 0.0)]));
    assert!(smooth < 0.6 * rough, "{smooth} of {rough}");
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

/// The map from above, as the screen shows it.
fn from_above(renderer: &mut Renderer, frame: &Frame<'_>) -> Vec<u8> {
    // Its shader is compiled on another thread.
    let mut drawn = (0..2000).filter_map(|_| {
        std::thread::sleep(std::time::Duration::from_millis(5));
        renderer.map_view(frame).expect("it can be drawn").cloned()
    });
    let picture = drawn.next().expect("it is drawn in the end");
    drop(drawn);
    let (size, rgba8) = renderer.rgba8_of(&picture).expect("it can be read");
    assert_eq!(size, [512, 512], "as many pixels as texels");
    rgba8
}

fn is_clear_on(rgba8: &[u8], texel: usize) -> bool {
    rgba8[4 * texel] <= 34
}

/// How many texels have cloud on the map from above, which are those whose field is above a threshold.
fn clouded_above(rgba8: &[u8], texels: &[[f32; 4]], field: fn(&[f32; 4]) -> f32) -> usize {
    let fields = texels.iter().map(field).enumerate();
    let (clear, cloudy): (Vec<_>, Vec<_>) = fields.partition(|(index, _)| is_clear_on(rgba8, *index));
    let fullest = clear.iter().map(|(_, field)| *field).fold(0.0, f32::max);
    let emptiest = cloudy.iter().map(|(_, field)| *field).fold(f32::INFINITY, f32::min);
    assert!(fullest <= emptiest + 1e-3, "clear up to {fullest}, cloud from {emptiest}");
    cloudy.len()
}

#[test]
fn on_the_map_from_above_of_a_weather_texture_coverage_alone_is_cloud() {
    // Stratus is painted into the channel that a weather texture has its height in.
    let (kind, radius, strength, softness, amount) = (CloudKind::Stratus, 0.2, 1.0, 0.5, 1.0);
    let stroke = Stroke { brush: Brush::Add, kind, radius, strength, softness, amount, dabs: vec![[0.7, 0.7]] };
    let mut scene = sky(vec![stroke], true);
    scene.layers[0].model = DensityModel::Texture;
    let mut renderer = renderer();
    let texels = map(&mut renderer, &scene).rgba;
    let quality = Quality::default();
    let rgba8 = from_above(&mut renderer, &frame(&scene, &quality, [32, 18], Output::Display));
    let clouded = clouded_above(&rgba8, &texels, |texel| texel[0]);
    assert!((10_000..texels.len() - 10_000).contains(&clouded), "{clouded} texels");
    let least = texels.iter().enumerate().filter(|(index, _)| !is_clear_on(&rgba8, *index));
    let least = least.map(|(_, texel)| texel[0]).fold(f32::INFINITY, f32::min);
    let others = texels.iter().filter(|texel| texel[0] < least && texel[0] + texel[1] + texel[2] > least + 1e-3);
    assert!(others.count() > 1000, "where height alone is high is no cloud, or the sum of the channels would do");
}

#[test]
fn the_map_from_above_is_the_map_that_clouds_stand_on() {
    let stroke = |brush, at| {
        let (kind, radius, strength, softness, amount) = (CloudKind::Stratus, 0.2, 1.0, 0.5, 1.0);
        Stroke { brush, kind, radius, strength, softness, amount, dabs: vec![at] }
    };
    let mut renderer = renderer();
    let mut scene = sky(vec![stroke(Brush::Erase, [0.3, 0.3]), stroke(Brush::Add, [0.7, 0.7])], true);
    let quality = Quality::default();
    let mut clouded = Vec::new();
    for coverage in [0.36, 0.6] {
        scene.weather.coverage = coverage;
        let texels = map(&mut renderer, &scene).rgba;
        let frame = frame(&scene, &quality, [32, 18], Output::Display);
        let rgba8 = from_above(&mut renderer, &frame);
        let is_clear = |texel: usize| is_clear_on(&rgba8, texel);
        // Coverage is a threshold of the map's field.
        clouded.push(clouded_above(&rgba8, &texels, |texel| texel[0] + texel[1] + texel[2]));
        // Stratus was painted, a bluer grey than the cumulus of the map.
        let painted = &rgba8[4 * (358 * 512 + 358)..][..3];
        assert!(painted[2] > painted[0] + 20, "{painted:?}");
        let erased = 154 * 512 + 154;
        assert!(is_clear(erased), "it was erased");
        let layer = &scene.layers[0];
        let mut random = Random::new(31);
        let mut looked = 0;
        for _ in 0..20_000 {
            if looked == 60 {
                break;
            }
            let place = [random.between(-9e3, 9e3), 0.5 * (layer.base_m + layer.top_m), random.between(-9e3, 9e3)];
            let at = map_place(&scene, layer, place.map(f64::from), 0.0);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "indices of texels")]
            let [x, y] = (at - at.floor()).to_array().map(|at| (at * 512.0) as usize % 512);
            // Linear reads reach the neighbours.
            let around = [[0, 0], [1, 0], [511, 0], [0, 1], [0, 511]];
            if !around.iter().all(|[dx, dy]| is_clear((y + dy) % 512 * 512 + (x + dx) % 512)) {
                continue;
            }
            let Some(probe) = renderer.probe(&frame, place).expect("it can be looked at") else {
                std::thread::sleep(std::time::Duration::from_millis(1));
                continue;
            };
            looked += 1;
            assert_eq!(probe.extinction_per_m, 0.0, "the map is clear over {place:?}");
        }
        assert_eq!(looked, 60, "places in clear air");
    }
    assert!(clouded[0] > 10_000 && clouded[1] > clouded[0] + 20_000, "{clouded:?} texels");
    scene.weather.coverage = 0.0;
    let clear = frame(&scene, &quality, [32, 18], Output::Display);
    assert!(renderer.map_view(&clear).expect("nothing fails").is_none(), "no layer has cloud");
}
