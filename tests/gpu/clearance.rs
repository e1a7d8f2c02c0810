//! The ways that the weather map promises to be clear, against the density field itself.

use glam::{Vec3, Vec4};
use nephoscope::gpu::{ProgramKey, Texture};
use nephoscope::render::Renderer;
use nephoscope::render::tables::{Table, TableKind};
use nephoscope::render::uniforms::map_place;
use nephoscope::scene::builtin::BUILTINS;
use nephoscope::scene::{CloudLayer, DomainKind, Output, Quality, Scene};

use crate::common::field::{Bound, Field, evaluated, linear_repeat, read, run, view_of};
use crate::common::sky::{frame, renderer};
use crate::common::slab::{FLAT, March, PRODUCT, PROFILE, SHELL, THESIS, noisy_layer, of_octaves};
use crate::common::{Case, Random, bits3, gpu};

/// As many cells as the renderer has.
const CELLS: [u32; 3] = [256, 16, 256];

fn key(file: &'static str, (domain, layers): (u32, usize)) -> ProgramKey {
    ProgramKey::plain(file)
        .with_flags(["BILLOWS", "PROFILE", "THESIS", "PRODUCT", "DETAIL", "CURL"])
        .with_constant("DOMAIN", domain)
        .with_constant("LAYERS", u32::try_from(layers).expect("few layers"))
}

fn ways_texture() -> Texture {
    Texture::new_3d(gpu(), "ways", CELLS, (1, wgpu::TextureFormat::Rgba16Float))
}

/// The cells over the baked map that may hold cloud, by the production pass.
fn cells(scene: &wgpu::Buffer, layers: usize) -> Texture {
    let cells = ways_texture();
    let map = &Field::baked().map;
    let bound =
        vec![("scene", scene.as_entire_binding()), ("weather_map", view_of(map)), ("ways_out", view_of(&cells))];
    run(&key("pass/clear_cells.wgsl", (FLAT, layers)), &bound, [CELLS[0], CELLS[2], 1]);
    cells
}

/// The ways to such cells, made by the production passes.
fn ways(scene: &wgpu::Buffer, layers: usize, cells: &Texture) -> Texture {
    let [there, back] = [(); 2].map(|()| ways_texture());
    let spreading = |file| ProgramKey::plain(file).with_constant("LAYERS", u32::try_from(layers).expect("few layers"));
    let between = |before, after| {
        vec![("scene", scene.as_entire_binding()), ("ways_before", view_of(before)), ("ways_out", view_of(after))]
    };
    for (is_back, bound) in [(0, between(cells, &back)), (1, between(&back, &there))] {
        let key = spreading("pass/clear_row.wgsl").with_constant("BACK", is_back);
        run(&key, &bound, [CELLS[1], CELLS[2], 1]);
    }
    for (axis, bound) in [(1, between(&there, &back)), (2, between(&back, &there))] {
        // Four cells look round together.
        let rows = CELLS[1] * CELLS[2] / 4;
        run(&spreading("pass/clear_spread.wgsl").with_constant("AXIS", axis), &bound, [CELLS[0], rows, 1]);
    }
    there
}

/// Cells of two layers of which so many may hold cloud, anywhere.
fn few_cells(random: &mut Random, counts: [usize; 2]) -> Texture {
    /// 60,000 as a half float, the farthest way.
    const FAR: u16 = 0x7b53;
    let mut halves = vec![[FAR, FAR, 0, 0]; CELLS.iter().product::<u32>() as usize];
    for (layer, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let index = random.bits() as usize % halves.len();
            halves[index][layer] = 0;
        }
    }
    let cells = ways_texture();
    gpu().queue.write_texture(
        cells.texture.as_image_copy(),
        bytemuck::cast_slice(&halves),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(CELLS[0] * 8), rows_per_image: Some(CELLS[1]) },
        cells.texture.size(),
    );
    cells
}

#[test]
fn ways_are_the_gaps_to_the_nearest_cell_that_may_hold_cloud() {
    let mut march = March::slab(3000.0, 0.04, Vec3::Y);
    march.scene.layers[0] = noisy_layer(PROFILE, 600.0, 2800.0, 0.4);
    march.scene.layers[1] = noisy_layer(THESIS, 900.0, 2000.0, 0.4);
    let scene = gpu().uniform("scene", bytemuck::bytes_of(&march.scene));
    let mut random = Random::new(7);
    let mut over_the_end = 0;
    for cells in [cells(&scene, 2), few_cells(&mut random, [3, 40])] {
        let [cloud, found] = [read(&cells), read(&ways(&scene, 2, &cells))];
        let at = |index: usize| {
            let [x, y, _] = CELLS.map(|count| count as usize);
            [index % x, index / x % y, index / (x * y)]
        };
        for layer in 0..2 {
            let held: Vec<[usize; 3]> = (0..cloud.len()).filter(|i| cloud[*i][layer] == 0.0).map(at).collect();
            assert!((1..cloud.len() / 2).contains(&held.len()), "{} of {} cells", held.len(), cloud.len());
            let slot = &march.scene.layers[layer];
            let across = 1.0 / (slot.map_from_world.z * CELLS[0] as f32);
            let walls = [across, 1.0 / (slot.per_thickness * CELLS[1] as f32), across];
            let mut far = 0;
            for _ in 0..100 {
                let index = random.bits() as usize % found.len();
                let here = at(index);
                let gap = |cell: &[usize; 3]| {
                    let squares = [0, 1, 2].map(|axis| {
                        let apart = here[axis].abs_diff(cell[axis]);
                        // Across the map it repeats.
                        let apart = if axis == 1 { apart } else { apart.min(CELLS[axis] as usize - apart) };
                        (apart.saturating_sub(1) as f32 * walls[axis]).powi(2)
                    });
                    squares.iter().sum::<f32>()
                };
                let nearest = held.iter().min_by(|a, b| gap(a).total_cmp(&gap(b))).expect("some are held");
                over_the_end += usize::from(here[2].abs_diff(nearest[2]) > CELLS[2] as usize / 2);
                let expected = 0.98 * gap(nearest).sqrt();
                let way = found[index][layer];
                let is_near = (way - expected).abs() <= 2e-3 * expected;
                assert!(is_near, "layer {layer}, cell {here:?}: a way of {way} m, not {expected}");
                far += usize::from(way > 0.0);
            }
            assert!(far > 30, "{far} of 100 cells have a way");
        }
    }
    assert!(over_the_end > 10, "{over_the_end} ways lead over the end of the map");
}

/// Results of `test/eval_clear.wgsl`.
fn evaluate(march: &March, (domain, layers): (u32, usize), cases: &[Case]) -> Vec<[f32; 4]> {
    let scene = gpu().uniform("scene", bytemuck::bytes_of(&march.scene));
    let ways = ways(&scene, layers, &cells(&scene, layers));
    let mut read: Bound<'_> = vec![
        ("scene", scene.as_entire_binding()),
        ("weather_map", view_of(&Field::baked().map)),
        ("clear_ways", view_of(&ways)),
        ("linear_repeat", wgpu::BindingResource::Sampler(linear_repeat())),
    ];
    read.extend(Field::baked().noises());
    evaluated(&key("test/eval_clear.wgsl", (domain, layers)).with_flags(["SKIP"]), &read, cases)
}

/// A place at an altitude, so far to the east and to the south.
fn place(domain: u32, radius_m: f32, [east, altitude, south]: [f32; 3]) -> Vec3 {
    if domain == FLAT {
        return Vec3::new(east, altitude, south);
    }
    let [radius, x, h, z] = [radius_m, east, altitude, south].map(f64::from);
    let y = ((radius + h).powi(2) - x * x - z * z).max(0.0).sqrt() - radius;
    #[allow(clippy::cast_possible_truncation, reason = "a place, to single precision")]
    let y = y as f32;
    Vec3::new(east, y, south)
}

/// Over a flat world, over a small planet, and over the earth as far out as clouds are drawn.
const WORLDS: [(u32, f32, f32); 3] = [(FLAT, 6.36e6, 2e4), (SHELL, 1e5, 3e4), (SHELL, 6.36e6, 2.4e5)];

#[test]
fn no_cloud_stands_where_the_map_promises_clear_air() {
    let mut random = Random::new(41);
    for (domain, radius_m, span_m) in WORLDS {
        for models in [&[PROFILE][..], &[THESIS], &[PROFILE, THESIS], &[PRODUCT, PROFILE]] {
            // How far the layers lean, and how many ways have to end near cloud at least: a strong shear shortens them.
            for (coverage, anvil, lean, near) in [(0.25, 0.0, 500.0, 20), (0.5, 0.7, 4000.0, 5), (0.75, 0.2, 500.0, 20)]
            {
                let mut march = March::slab(3000.0, 0.04, Vec3::Y);
                march.scene.planet_radius_m = radius_m;
                for (index, (slot, model)) in march.scene.layers.iter_mut().zip(models).enumerate() {
                    // The second layer stands higher and its map is another.
                    let base_m = 600.0 + 500.0 * index as f32;
                    *slot = noisy_layer(*model, base_m, base_m + 2200.0, coverage);
                    slot.lean = Vec4::new(lean, -0.4 * lean, slot.lean.z, 0.0);
                    slot.map_from_world += Vec4::new(0.3, 0.1, 0.0, 0.0) * index as f32;
                    slot.anvil = anvil;
                    if *model == PRODUCT {
                        *slot = of_octaves(*slot);
                    } else if models[0] == PRODUCT {
                        // Fibres of a form of their own.
                        slot.form = Vec4::new(0.0, 0.0, 1.0, 1.0);
                        slot.combing = Vec4::new(0.6, -0.8, 1.0 - 1.0 / 7.0, 0.0);
                    }
                }
                let mut cases: Vec<Case> = Vec::new();
                for _ in 0..100_000 {
                    let at = [(-span_m, span_m), (300.0, 3600.0), (-span_m, span_m)];
                    let p = place(domain, radius_m, at.map(|(low, high)| random.between(low, high)));
                    let offset = random.direction() * random.between(0.0, 0.999);
                    cases.push([bits3(p), bits3(offset), [0; 4], [0; 4]]);
                }
                let (mut promised, mut beyond) = (0, 0);
                let found = evaluate(&march, (domain, models.len()), &cases);
                for ([way, there, farther, here], case) in found.into_iter().zip(&cases) {
                    assert!((0.0..1e5).contains(&way), "models {models:?}: a way of {way} m");
                    assert!(there <= 0.0 || here > 0.0, "{models:?}, {coverage}: cloud within {way} m of {case:?}");
                    promised += u32::from(way > 100.0);
                    beyond += u32::from(way > 100.0 && farther > 0.0);
                }
                assert!(promised > 10_000, "models {models:?}, {coverage}: only {promised} places have a way");
                assert!(
                    beyond > near,
                    "models {models:?}, {coverage}: cloud is far from every way ({beyond} are near)"
                );
            }
        }
    }
}

/// The way that a layer's cell promises about a place.
fn way_at(ways: &Table, scene: &Scene, layer: &CloudLayer, place: [f32; 3]) -> f32 {
    let tiles = map_place(scene, layer, place.map(f64::from), 0.0);
    let h = (place[1] - layer.base_m) / (layer.top_m - layer.base_m);
    let at = [tiles.x - tiles.x.floor(), f64::from(h), tiles.y - tiles.y.floor()];
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "indices of cells")]
    let [x, y, z] = std::array::from_fn(|axis| ((at[axis] * f64::from(CELLS[axis])) as u32).min(CELLS[axis] - 1));
    ways.rgba[((z * CELLS[1] + y) * CELLS[0] + x) as usize][0]
}

/// A built-in sky over a flat world, where places have their altitude.
fn builtin(name: &str) -> Scene {
    let found = BUILTINS.iter().find(|builtin| builtin.name == name).expect("a built-in sky");
    let mut scene = found.preset().expect("it is sound").scene;
    scene.domain.kind = DomainKind::Flat;
    scene
}

/// Places in the first layer and over the weather map, with their extinction in 1/m.
fn places(scene: &Scene, renderer: &mut Renderer, count: usize) -> Vec<([f32; 3], f32)> {
    let (layer, size_m) = (&scene.layers[0], scene.weather.size_m);
    let quality = Quality::default();
    let frame = frame(scene, &quality, [32, 18], Output::Display);
    // Its shader is compiled on another thread.
    let is_ready = (0..2000).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(5));
        renderer.probe(&frame, [0.0; 3]).expect("it can be looked at").is_some()
    });
    assert!(is_ready, "the probe is compiled in the end");
    let mut random = Random::new(91);
    let mut place =
        || [random.between(0.0, size_m), random.between(layer.base_m, layer.top_m), random.between(0.0, size_m)];
    let places: Vec<[f32; 3]> = (0..count).map(|_| place()).collect();
    let looked = places.into_iter().map(|place| {
        let probe = renderer.probe(&frame, place).expect("it can be looked at").expect("it is compiled");
        (place, probe.extinction_per_m)
    });
    looked.collect()
}

fn clear_ways(scene: &Scene, renderer: &mut Renderer) -> Table {
    let quality = Quality::default();
    let frame = frame(scene, &quality, [32, 18], Output::Display);
    let ways = renderer.table(&frame, TableKind::ClearWays).expect("they are made").expect("the sky has a map");
    assert_eq!(ways.size, [CELLS[0], CELLS[1] * CELLS[2]], "slices from north to south");
    ways
}

#[test]
fn the_automaton_has_no_cloud_where_a_way_is_promised() {
    let scene = builtin("living_cumulus");
    let mut renderer = renderer();
    let ways = clear_ways(&scene, &mut renderer);
    let way = |place| way_at(&ways, &scene, &scene.layers[0], place);
    let (cloudy, clear): (Vec<_>, Vec<_>) =
        places(&scene, &mut renderer, 1500).into_iter().partition(|(_, extinction)| *extinction > 0.0);
    assert!(cloudy.len() > 50, "{} cloudy places", cloudy.len());
    for (place, extinction) in &cloudy {
        assert_eq!(way(*place), 0.0, "cloud of {extinction} /m at {place:?}");
    }
    let promised = clear.iter().filter(|(place, _)| way(*place) > 0.0).count();
    assert!(promised * 3 > clear.len(), "{promised} of {} clear places", clear.len());
}

#[test]
fn most_of_the_clear_air_between_fair_weather_clouds_is_crossed_at_once() {
    let scene = builtin("fair_weather");
    let mut renderer = renderer();
    let ways = clear_ways(&scene, &mut renderer);
    let mut clear = places(&scene, &mut renderer, 800);
    clear.retain(|(_, extinction)| *extinction <= 0.0);
    let skipped = clear.iter().filter(|(place, _)| way_at(&ways, &scene, &scene.layers[0], *place) > 0.0).count();
    println!("{skipped} of {} clear places lie in cells that are crossed at once", clear.len());
    // Of the rest most lies inside of bodies, where the noise alone keeps it clear.
    assert!(clear.len() > 400 && skipped * 100 >= clear.len() * 60, "{skipped} of {}", clear.len());
}
