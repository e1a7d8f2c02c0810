//! The density models: against their twins, under their bound, and at the ends of coverage.

use bytemuck::Zeroable as _;
use glam::{Vec2, Vec3, Vec3Swizzles as _, Vec4};
use nephoscope::gpu::{ProgramKey, readback};
use nephoscope::reference::density::{self, Weather};
use nephoscope::render::uniforms::scene::{LayerUniforms, SceneUniforms};
use wgpu::util::DeviceExt as _;

use crate::common::field::{Field, linear_repeat, map_uniforms, run, view_of};
use crate::common::slab::{PRODUCT, PROFILE, THESIS, UNIFORM, noisy_layer, of_octaves};
use crate::common::{Case, Random, bits4, eval, eval_with, gpu};

/// A layer with anything a scene may ask for, and what textures may hold at a place.
#[derive(Clone, Copy, Debug)]
struct Input {
    layer: LayerUniforms,
    texel: Vec4,
    large: Vec4,
    small: Vec4,
    h: f32,
    fade: f32,
    bias: f32,
}

fn unit4(random: &mut Random) -> Vec4 {
    // The ends of the range are as likely as the rest together.
    Vec4::from_array(std::array::from_fn(|_| random.between(-0.5, 1.5).clamp(0.0, 1.0)))
}

impl Input {
    fn random(random: &mut Random) -> Self {
        let softness = random.pick(&[0.02, 0.26, 1.0]);
        let coverage = random.between(-0.2, 1.2).clamp(0.0, 1.0);
        let mut layer = noisy_layer(PROFILE, 1000.0, 3000.0, coverage);
        layer.body_scale = 1.0 / softness;
        layer.base_ramp = random.between(0.02, 0.25);
        layer.top_variation = random.between(0.0, 1.0);
        layer.anvil = random.pick(&[0.0, 0.3, 1.0]);
        layer.shape_strength = random.pick(&[0.0, 0.4, 1.0, 2.0]);
        layer.detail_strength = random.pick(&[0.0, 0.4, 0.9, 2.0]);
        layer.wispiness = random.between(0.0, 1.0);
        layer.sharpness = random.pick(&[0.1, 1.0, 4.0]);
        let kind = random.pick(&[Vec4::X, Vec4::Y, Vec4::Z, Vec4::new(0.2, 0.3, 0.5, 0.0)]);
        let mut texel = kind * random.between(0.0, 1.0);
        texel.w = random.between(0.0, 1.0);
        Self {
            layer,
            texel,
            large: unit4(random),
            small: unit4(random),
            h: random.between(0.001, 0.999),
            fade: random.between(-0.5, 1.5).clamp(0.0, 1.0),
            bias: -(1.0 - coverage * (1.0 + softness)) / softness,
        }
    }

    fn case(&self) -> Case {
        let place = [self.h, self.fade, self.bias, 0.0];
        [bits4(self.texel.to_array()), bits4(self.large.to_array()), bits4(self.small.to_array()), bits4(place)]
    }
}

fn inputs(seed: u32, count: usize) -> Vec<Input> {
    let mut random = Random::new(seed);
    (0..count).map(|_| Input::random(&mut random)).collect()
}

fn evaluated(entry_point: &str, inputs: &[Input]) -> Vec<[f32; 4]> {
    let cases: Vec<Case> = inputs.iter().map(Input::case).collect();
    let layers: Vec<LayerUniforms> = inputs.iter().map(|input| input.layer).collect();
    let bits = eval_with("density", entry_point, &cases, bytemuck::cast_slice(&layers));
    bits.into_iter().map(|bits| bits.map(f32::from_bits)).collect()
}

fn compare(entry_point: &str, twin: impl Fn(&Input) -> [f32; 4]) {
    let inputs = inputs(21, 4000);
    for (input, result) in inputs.iter().zip(evaluated(entry_point, &inputs)) {
        let expected = twin(input);
        for (value, expected) in result.iter().zip(expected) {
            let error = (value - expected).abs();
            assert!(error <= 2e-5 * (1.0 + expected.abs()), "{entry_point} {input:?}: {result:?}, not {expected:?}");
        }
    }
}

#[test]
fn the_models_follow_their_twins() {
    let weather = |input: &Input| Weather::from_texel(input.texel, &input.layer, input.bias);
    compare("eval_weather", |input| {
        let Weather { body, types, .. } = weather(input);
        [body, types.x, types.y, types.z]
    });
    compare("eval_profile", |input| {
        let (weather, layer) = (weather(input), &input.layer);
        let profile = density::height_profile(&weather, layer, input.h);
        let field = density::billowed(profile, input.large, &weather, layer);
        let firm = density::firmness(profile, input.large, &weather, layer);
        [firm, profile, field, density::erosion(input.small, firm, layer, input.h, input.fade)]
    });
    compare("eval_thesis", |input| {
        let weather = weather(input);
        let profile = density::thesis_profile(&weather, input.h);
        let field = density::thesis_field(profile, input.large, &weather, &input.layer);
        [profile.x, profile.y, profile.z, field]
    });
}

#[test]
fn the_densities_follow_their_twins() {
    let inputs = inputs(22, 4000);
    let profile = evaluated("eval_profile_density", &inputs);
    let thesis = evaluated("eval_thesis_density", &inputs);
    for ((input, profile), thesis) in inputs.iter().zip(&profile).zip(&thesis) {
        let (weather, layer) = (Weather::from_texel(input.texel, &input.layer, input.bias), &input.layer);
        let allowed = density::height_profile(&weather, layer, input.h);
        let field = density::billowed(allowed, input.large, &weather, layer);
        let firm = density::firmness(allowed, input.large, &weather, layer);
        let amount = density::erosion(input.small, firm, layer, input.h, input.fade);
        let expected = density::profile_density(density::eroded(field, amount, firm), firm, layer, input.h);
        // Ten times steeper than the field at the greatest sharpness.
        assert!((profile[0] - expected).abs() < 5e-4, "profile {input:?}: {} not {expected}", profile[0]);
        let field = density::thesis_field(density::thesis_profile(&weather, input.h), input.large, &weather, layer);
        let eroded = density::thesis_eroded(field, input.small, layer, input.fade);
        let expected = density::thesis_density(eroded, layer);
        assert!((thesis[0] - expected).abs() < 5e-4, "thesis {input:?}: {} not {expected}", thesis[0]);
    }
}

#[test]
fn no_density_exceeds_its_bound() {
    let inputs = inputs(23, 60_000);
    for (model, entry_point) in [("profile", "eval_profile_density"), ("thesis", "eval_thesis_density")] {
        let mut dense = 0;
        for (input, [density, bound, smooth, _]) in inputs.iter().zip(evaluated(entry_point, &inputs)) {
            assert!(
                density <= bound + 1e-5 && smooth <= bound + 1e-5,
                "{model} {input:?}: {density}, {smooth} > {bound}"
            );
            assert!((0.0..=1.0).contains(&density), "{model} {input:?}: {density}");
            dense += usize::from(density > 0.1);
        }
        assert!(dense > 500, "only {dense} samples of {model} held cloud");
    }
}

#[test]
fn the_model_of_weather_textures_follows_its_twin_under_its_bound() {
    let mut random = Random::new(31);
    let mut inputs = inputs(26, 4000);
    for input in &mut inputs {
        input.texel = unit4(&mut random);
        // Above and below the cloud, and clouds without height.
        input.texel.y = random.pick(&[0.0, 0.3, 1.0]);
    }
    let mut dense = 0;
    for (input, [shaped, value, bound, _]) in inputs.iter().zip(evaluated("eval_costa", &inputs)) {
        let coverage = (input.texel.x * input.layer.body_scale + input.bias).clamp(0.0, 1.0);
        let at = (input.h, input.fade);
        let [expected, expected_density] =
            density::costa(coverage, input.texel, [input.large, input.small], &input.layer, at);
        assert!((shaped - expected).abs() < 2e-5, "{input:?}: {shaped}, not {expected}");
        assert!((value - expected_density).abs() < 1e-4, "{input:?}: {value}, not {expected_density}");
        assert!(value <= bound + 1e-6, "{input:?}: {value} over {bound}");
        assert!(input.texel.y > 0.0 || value == 0.0, "{input:?}: no height, no cloud");
        dense += u32::from(value > 0.1);
    }
    assert!(dense > 100, "{dense} of 4000 are dense");
}

#[test]
fn what_is_not_near_the_surface_needs_no_detail() {
    let inputs = inputs(24, 20_000);
    for (model, entry_point) in [("profile", "eval_profile_density"), ("thesis", "eval_thesis_density")] {
        for (input, [density, _, smooth, near]) in inputs.iter().zip(evaluated(entry_point, &inputs)) {
            // The thesis reads detail below 0.45 only, so what it loses above is smaller than what it keeps; the
            // profile model loses nothing.
            let loses = (density - smooth).abs() > 1e-6 && near < 0.5 && model == "profile";
            assert!(!loses, "{model} {input:?}: {smooth} would become {density}");
        }
    }
}

#[test]
fn the_weather_map_follows_its_twin() {
    let mut random = Random::new(25);
    let mut close = 0;
    for seed in [0, 1, 999_999] {
        let map =
            nephoscope::render::uniforms::other::MapUniforms { phase: random.between(0.0, 1.0), ..map_uniforms(seed) };
        let places: Vec<Vec2> =
            (0..1500).map(|_| Vec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0))).collect();
        let case = |uv: &Vec2, is_weather_texture: bool| {
            let counts = [map.seed, map.large_cells, map.small_share.to_bits(), map.fray.to_bits()];
            let weights = [map.contrast, map.cumulus, map.stratus, map.stratocumulus];
            let form = f32::from(u8::from(is_weather_texture));
            [bits4([uv.x, uv.y, map.phase, form]), counts, bits4(weights), [0; 4]]
        };
        let cases: Vec<Case> = places.iter().map(|uv| case(uv, true)).collect();
        for (uv, result) in places.iter().zip(eval("density", "eval_map", &cases)) {
            let expected = density::weather_texture(*uv, &map);
            // The root is steep where the coverage is small.
            assert!(
                (Vec4::from_array(result) - expected).abs().max_element() < 2e-4,
                "{uv}: {result:?}, not {expected}"
            );
            assert!(result[1] + result[2] <= 1.0 && result.iter().all(|value| *value >= 0.0), "{uv}: {result:?}");
        }
        let cases: Vec<Case> = places.iter().map(|uv| case(uv, false)).collect();
        for (uv, result) in places.iter().zip(eval("density", "eval_map", &cases)) {
            let expected = density::map_texel(*uv, &map);
            // Between two cells either may be the nearest, and their types differ; all the rest agrees.
            let sums = [result[0] + result[1] + result[2], expected.x + expected.y + expected.z];
            assert!((sums[0] - sums[1]).abs() < 5e-5, "{uv}: {result:?}, not {expected}");
            close += usize::from((Vec4::from_array(result) - expected).abs().max_element() < 5e-5);
        }
    }
    assert!(close > 4490, "only {close} of 4500 texels are those of the twin");
}

/// Density, bound, body and height at places of a layer with real textures.
fn field_samples(layer: LayerUniforms, places: &[Vec3]) -> Vec<[f32; 4]> {
    let mut scene = SceneUniforms { planet_radius_m: 6.36e6, highest_m: 1e5, ..SceneUniforms::zeroed() };
    scene.layers[0] = layer;
    let cases: Vec<Case> = places.iter().map(|p| [bits4([p.x, p.y, p.z, 0.0]), [0; 4], [0; 4], [0; 4]]).collect();
    let buffer = |contents: &[u8]| {
        gpu().device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("cases"),
            contents,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        })
    };
    let (cases, results) = (buffer(bytemuck::cast_slice(&cases)), buffer(&vec![0; places.len() * 16]));
    let scene = gpu().uniform("scene", bytemuck::bytes_of(&scene));
    let mut bound = Field::baked().noises();
    bound.extend([
        ("cases", cases.as_entire_binding()),
        ("results", results.as_entire_binding()),
        ("scene", scene.as_entire_binding()),
        ("weather_map", view_of(&Field::baked().map)),
        ("linear_repeat", wgpu::BindingResource::Sampler(linear_repeat())),
    ]);
    let key = ProgramKey::plain("test/eval_field.wgsl")
        .with_flags(["BILLOWS", "PROFILE", "THESIS", "UNIFORM", "PRODUCT", "DETAIL", "CURL"])
        .with_constant("DOMAIN", 1);
    run(&key, &bound, [512, u32::try_from(places.len().div_ceil(512)).expect("few"), 1]);
    bytemuck::cast_slice(&readback::buffer(gpu(), &results).expect("it can be read")).to_vec()
}

fn places(seed: u32, count: usize) -> Vec<Vec3> {
    let mut random = Random::new(seed);
    let flat = |random: &mut Random| random.between(-40_000.0, 40_000.0);
    (0..count).map(|_| Vec3::new(flat(&mut random), random.between(950.0, 3050.0), flat(&mut random))).collect()
}

#[test]
fn the_baked_field_stays_under_its_bound_and_inside_its_layer() {
    let places = places(31, 40_000);
    for model in [PROFILE, THESIS, UNIFORM] {
        for coverage in [0.2, 0.5, 0.9] {
            let mut layer = noisy_layer(model, 1000.0, 3000.0, coverage);
            layer.density_scale = 1.7;
            let mut cloudy = 0;
            for (p, [density, bound, body, h]) in places.iter().zip(field_samples(layer, &places)) {
                assert!(
                    density >= 0.0 && density <= bound + 1e-5,
                    "model {model} at {p}: {density} > {bound}, body {body}"
                );
                assert!(density == 0.0 || (0.0..1.0).contains(&h), "model {model} at {p}: cloud outside its layer");
                cloudy += usize::from(density > 0.0);
            }
            assert!(cloudy > 100, "model {model} at coverage {coverage} holds cloud at {cloudy} places only");
        }
    }
}

#[test]
fn no_coverage_is_empty_and_full_coverage_is_full() {
    let places = places(32, 20_000);
    for model in [PROFILE, THESIS, UNIFORM] {
        let samples = field_samples(noisy_layer(model, 1000.0, 3000.0, 0.0), &places);
        assert!(samples.iter().all(|sample| sample[0] == 0.0), "model {model} has cloud at coverage 0");
    }
    for [density, _, body, h] in field_samples(noisy_layer(UNIFORM, 1000.0, 3000.0, 1.0), &places) {
        assert_eq!(body, 1.0, "full coverage is a body of 1 everywhere");
        assert!(density == 1.0 || h <= 0.0 || h >= 1.0, "{density} at {h}");
    }
}

#[test]
fn a_stretched_field_is_the_same_field_drawn_out_along_the_wind() {
    let places = places(33, 20_000);
    let mut plain = noisy_layer(PROFILE, 1000.0, 3000.0, 0.5);
    plain.lean = Vec4::ZERO;
    plain.curl_from_world.w = 0.0;
    let (along, stretch) = (Vec2::new(0.6, -0.8), 7.0);
    let stretched = LayerUniforms { combing: along.extend(1.0 - 1.0 / stretch).extend(0.0), ..plain };
    let drawn_out = |p: &Vec3| {
        let across = p.xz() + along * (p.xz().dot(along) * (stretch - 1.0));
        Vec3::new(across.x, p.y, across.y)
    };
    let far: Vec<Vec3> = places.iter().map(drawn_out).collect();
    let pairs = field_samples(plain, &places).into_iter().zip(field_samples(stretched, &far));
    let gaps: Vec<f32> = pairs.map(|(one, other)| (one[0] - other[0]).abs()).collect();
    // Places far out are rounded to centimetres, and filters take steps of a 256th of a texel.
    let off = gaps.iter().filter(|gap| **gap > 0.05).count();
    assert!(off * 500 < gaps.len(), "{off} of {} places differ", gaps.len());
    let unmoved = field_samples(stretched, &places).into_iter().zip(field_samples(plain, &places));
    assert!(unmoved.filter(|(one, other)| (one[0] - other[0]).abs() > 0.05).count() > 1000, "and it is another one");
}

#[test]
fn a_form_holds_whatever_the_map_says() {
    let places = places(34, 20_000);
    let sheet = LayerUniforms { form: Vec4::new(0.0, 1.0, 0.0, 1.0), ..noisy_layer(PROFILE, 1000.0, 3000.0, 0.9) };
    let mut cloudy = 0;
    for (p, [density, bound, ..]) in places.iter().zip(field_samples(sheet, &places)) {
        assert!(density <= bound + 1e-5, "{p}: {density} over {bound}");
        assert!(density == 0.0 || p.y < 1600.5, "{p}: a sheet ends at three tenths of its layer");
        cloudy += usize::from(density > 0.0);
    }
    let mixed = field_samples(noisy_layer(PROFILE, 1000.0, 3000.0, 0.9), &places);
    let high = places.iter().zip(mixed).filter(|(p, sample)| p.y > 1600.5 && sample[0] > 0.0).count();
    assert!(cloudy > 1000 && high > 1000, "{cloudy} and {high}");
}

/// A layer of Perlin times Voronoi noise.
fn product_layer(octaves: f32, lacunarity: f32) -> LayerUniforms {
    let mut layer = of_octaves(noisy_layer(PRODUCT, 1000.0, 3000.0, 0.6));
    (layer.perlin_octaves.x, layer.voronoi_octaves.x) = (octaves, octaves);
    (layer.perlin_octaves.z, layer.voronoi_octaves.z) = (lacunarity, lacunarity);
    LayerUniforms { lean: Vec4::ZERO, ..layer }
}

#[test]
fn perlin_times_voronoi_follows_its_twin() {
    // Middles of texels, where filtering does nothing.
    let texel_m = 8.0 * 900.0 / 64.0;
    let mut random = Random::new(35);
    let middles = (0..3000).map(|_| {
        let at = |random: &mut Random, low: f32, high: f32| (random.between(low, high).floor() + 0.5) * texel_m;
        Vec3::new(at(&mut random, -300.0, 300.0), at(&mut random, 9.0, 26.0), at(&mut random, -300.0, 300.0))
    });
    let places: Vec<Vec3> = middles.collect();
    // A second octave of the same frequency is read at the same places.
    for octaves in [1.0, 2.0] {
        let layer = product_layer(octaves, 1.0);
        let mut cloudy = 0;
        for (p, [density, bound, body, _]) in places.iter().zip(field_samples(layer, &places)) {
            let [even, odd] = density::octave(*p * layer.perlin_from_world.w);
            let sum = |channel: usize, persistence: f32| {
                if octaves < 2.0 {
                    even[channel]
                } else {
                    (even[channel] + persistence * odd[channel]) / (1.0 + persistence)
                }
            };
            let own = density::product(sum(0, 0.5), sum(1, 0.4), body, &layer);
            assert!((density - own).abs() < 0.02, "{octaves} octaves at {p}: {density}, by the twin {own}");
            assert!(density <= bound + 1e-5, "{p}: {density} over {bound}");
            cloudy += usize::from(density > 0.1);
        }
        assert!(cloudy > 100, "{octaves} octaves hold cloud at {cloudy} places only");
    }
}

#[test]
fn octaves_without_weight_change_nothing_and_others_do() {
    let places = places(36, 5000);
    let one = field_samples(product_layer(1.0, 2.0), &places);
    let mut weightless = product_layer(4.0, 2.0);
    (weightless.perlin_octaves.y, weightless.voronoi_octaves.y) = (0.0, 0.0);
    assert!(field_samples(weightless, &places) == one, "a persistence of 0 leaves the first octave");
    let four = field_samples(product_layer(4.0, 2.0), &places);
    let changed = one.iter().zip(&four).filter(|(one, four)| (one[0] - four[0]).abs() > 0.05).count();
    assert!(changed > 500, "{changed} places");
    for (p, [density, bound, ..]) in places.iter().zip(four) {
        assert!(density <= bound + 1e-5, "{p}: {density} over {bound}");
    }
}
