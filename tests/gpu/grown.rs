//! Weather maps that grow out of an image.

use std::path::Path;

use nephoscope::render::Renderer;
use nephoscope::render::tables::TableKind;
use nephoscope::scene::{MapSource, Scene};

use crate::common::sky::table;
use crate::common::{Random, gpu};

const SIDE: usize = 512;
/// The image lies texel on texel in the middle half.
const IMAGE: usize = 256;

/// Heaps of some size in clear air, of two kinds.
fn image() -> Vec<[f32; 4]> {
    let mut random = Random::new(5);
    let heaps: Vec<[f32; 4]> = (0..120)
        .map(|_| {
            [random.between(0.0, 1.0), random.between(0.0, 1.0), random.between(0.02, 0.07), random.between(0.0, 1.0)]
        })
        .collect();
    let texel = |index: usize| {
        let at = [(index % IMAGE) as f32, (index / IMAGE) as f32].map(|at| (at + 0.5) / IMAGE as f32);
        let mut texel = [0.0f32, 0.0, 0.0, 0.6];
        for [x, y, radius, kind] in &heaps {
            let near = 1.0 - (at[0] - x).hypot(at[1] - y) / radius;
            let channel = if *kind < 0.7 { 0 } else { 2 };
            texel[channel] = texel[channel].max(near);
        }
        texel
    };
    (0..IMAGE * IMAGE).map(texel).collect()
}

fn saved(folder: &Path, pixels: &[[f32; 4]]) -> String {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "values of 0 to 1")]
    let words: Vec<u16> = pixels.iter().flatten().map(|value| (value * 65_535.0).round() as u16).collect();
    let side = IMAGE.try_into().expect("small");
    let image = image::ImageBuffer::<image::Rgba<u16>, _>::from_raw(side, side, words).expect("as many as it says");
    let path = folder.join("map.png");
    image.save(&path).expect("written");
    path.display().to_string()
}

fn map(renderer: &mut Renderer, scene: &Scene, time_secs: f64) -> Vec<[f32; 4]> {
    table(renderer, scene, time_secs, TableKind::WeatherMap).rgba
}

/// Values that shares of all texels lie below, of a channel.
fn quantiles(rgba: &[[f32; 4]], channel: usize) -> [f32; 5] {
    let mut values: Vec<f32> = rgba.iter().map(|texel| texel[channel]).collect();
    values.sort_by(f32::total_cmp);
    [50, 65, 75, 85, 95].map(|share| values[values.len() * share / 100])
}

/// How alike texels are so many apart: the correlation.
fn likeness(rgba: &[[f32; 4]], side: usize, apart: usize) -> f64 {
    let at = |x: usize, y: usize| f64::from(rgba[y * side + x % side][0]);
    let all = || (0..side).flat_map(|y| (0..side - apart).map(move |x| (x, y)));
    let count = all().count() as f64;
    let mean = all().map(|(x, y)| at(x, y)).sum::<f64>() / count;
    let product = |apart: usize| all().map(|(x, y)| (at(x, y) - mean) * (at(x + apart, y) - mean)).sum::<f64>();
    product(apart) / product(0)
}

#[test]
fn what_grows_about_an_image_is_of_its_kind_and_the_image_is_in_its_middle() {
    let folder = tempfile::tempdir().expect("a folder");
    let pixels = image();
    let mut scene = Scene::default();
    scene.weather.evolution_secs = 800.0;
    let layer = &mut scene.weather.layers[0];
    layer.source = MapSource::Grown;
    layer.image.0 = saved(folder.path(), &pixels);
    layer.image_share = 0.5;
    let mut renderer = Renderer::new(gpu()).expect("it fits");
    let at_once = map(&mut renderer, &scene, 0.0);
    // Away from its border, which grows together with what is about it.
    for y in 48..IMAGE - 48 {
        for x in 48..IMAGE - 48 {
            let (seen, expected) = (at_once[(y + 128) * SIDE + x + 128], pixels[y * IMAGE + x]);
            let off = seen.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 1e-3, "{seen:?} at {x}, {y}, where the image has {expected:?}");
        }
    }
    let later = map(&mut renderer, &scene, 2000.0);
    for (name, grown) in [("at once", &at_once), ("later", &later)] {
        for channel in [0, 2] {
            let (seen, expected) = (quantiles(grown, channel), quantiles(&pixels, channel));
            println!("{name}, channel {channel}: {seen:.3?}, the image has {expected:.3?}");
            let off = seen.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 0.07, "{name}, channel {channel}: {seen:?}, the image has {expected:?}");
        }
        for apart in [3, 8, 16] {
            let (seen, expected) = (likeness(grown, SIDE, apart), likeness(&pixels, IMAGE, apart));
            println!("{name}: texels {apart} apart are alike by {seen:.2}, in the image by {expected:.2}");
            assert!((seen - expected).abs() < 0.15, "{name}: texels {apart} apart are alike by {seen}, not {expected}");
        }
        // Across the map's edge, where it repeats, as anywhere else.
        let step =
            |x: usize| (0..SIDE).map(move |y| (grown[y * SIDE + x][0] - grown[y * SIDE + (x + 1) % SIDE][0]).abs());
        let mean = |x: usize| step(x).sum::<f32>() / SIDE as f32;
        let within = (0..SIDE - 1).map(mean).fold(0.0, f32::max);
        assert!(mean(SIDE - 1) <= within, "{name}: {} across the edge, at most {within} elsewhere", mean(SIDE - 1));
    }
    let middle = (SIDE / 2 - 60..SIDE / 2 + 60).map(|x| (later[256 * SIDE + x][0] - at_once[256 * SIDE + x][0]).abs());
    assert!(middle.fold(0.0, f32::max) > 0.3, "in time the image becomes another");
}

#[test]
fn a_map_that_grows_is_the_same_however_its_time_is_reached_and_never_jumps() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut scene = Scene::default();
    scene.weather.evolution_secs = 160.0;
    let layer = &mut scene.weather.layers[0];
    layer.source = MapSource::Grown;
    layer.image.0 = saved(folder.path(), &image());
    layer.image_share = 0.3;
    let mut renderer = Renderer::new(gpu()).expect("it fits");
    let forwards: Vec<_> = (0..12).map(|k| map(&mut renderer, &scene, f64::from(k) * 16.0)).collect();
    for k in [8, 3, 0, 10] {
        assert!(
            map(&mut renderer, &scene, f64::from(k) * 16.0) == forwards[k as usize],
            "time {k} is another backwards"
        );
    }
    let mut afresh = Renderer::new(gpu()).expect("it fits");
    assert!(map(&mut afresh, &scene, 160.0) == forwards[10], "straight to a time it is another");
    let far = map(&mut renderer, &scene, -3.0e13);
    assert!(far.iter().flatten().all(|value| (0.0..=1.0).contains(value)), "a million years ago");
    let change = |a: &[[f32; 4]], b: &[[f32; 4]]| -> f64 {
        a.iter().zip(b).map(|(a, b)| f64::from((a[0] - b[0]).abs())).sum::<f64>() / a.len() as f64
    };
    let steps: Vec<f64> = forwards.windows(2).map(|pair| change(&pair[0], &pair[1])).collect();
    let whole = change(&forwards[0], &forwards[11]);
    // Every patch ends and begins in a time like this: a quarter of a state at once.
    let fine: Vec<_> = (0..24).map(|k| map(&mut renderer, &scene, 200.0 + f64::from(k) * 2.5)).collect();
    let fine: Vec<f64> = fine.windows(2).map(|pair| change(&pair[0], &pair[1])).collect();
    let (least, largest) =
        fine.iter().fold((f64::MAX, 0.0f64), |(least, most), step| (least.min(*step), most.max(*step)));
    assert!(largest < 2.5 * least, "steps of {least} to {largest}");
    let most = steps.iter().copied().fold(0.0, f64::max);
    println!("a tenth of the time changes texels by at most {most:.4} in the mean, all of it by {whole:.4}");
    assert!(most < 0.35 * whole, "{steps:?}");
}
