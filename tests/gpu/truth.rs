//! The reference integrators against closed forms, tabulated multiple scattering, and each other.

use glam::{Vec3, Vec4};
use nephoscope::gpu::ProgramKey;

use crate::common::field::{Field, evaluated, linear_repeat, view_of};
use crate::common::slab::{FLAT, March, PRODUCT, PROFILE, THESIS, UNIFORM, noisy_layer, of_octaves, slab_light};
use crate::common::truth::{Mean, baked_bounds, blind_bounds, bounds_of, named};
use crate::common::{Case, Random, bits3, gpu, thorough};

const THICKNESS_M: f32 = 1000.0;
const ISOTROPIC: f64 = 1.0 / (4.0 * std::f64::consts::PI);
/// Standard errors within which a mean has to lie; seeds are fixed, so a pass stays a pass.
const SIGMAS: f64 = 3.0;

/// A direction at a slope, up or down, at an azimuth from that of the sun, in degrees.
fn towards(mu: f32, up: bool, azimuth_deg: f32) -> Vec3 {
    let flat = (1.0 - mu * mu).max(0.0).sqrt();
    let (sin, cos) = azimuth_deg.to_radians().sin_cos();
    Vec3::new(flat * cos, if up { mu } else { -mu }, flat * sin)
}

/// A slab lit by a sun of irradiance 1 at a slope, without any other light.
fn lit_slab(tau: f32, albedo: f32, g: Option<f32>, mu0: f32, view: Vec3) -> March {
    let mut march = March::slab(THICKNESS_M, tau / THICKNESS_M, view);
    march.scene.towards_light = towards(mu0, true, 0.0);
    march.scene.light_illuminance = Vec3::ONE;
    march.scene.layers[0].albedo = albedo;
    if let Some(g) = g {
        march.scene.layers[0].phase_kind = 1;
        march.scene.layers[0].g = g;
    }
    march
}

fn check(name: &str, value: f64, error: f64, expected: f64) {
    let sigmas = (value - expected).abs() / error.max(1e-12);
    assert!(sigmas < SIGMAS, "{name}: {value} ± {error}, not {expected} ({sigmas:.1} standard errors)");
}

#[test]
fn the_converged_march_gives_a_slab_its_discrete_closed_form_however_it_is_split() {
    for tau in [0.01_f32, 1.0, 8.0, 30.0] {
        for (cells, per_dispatch) in [(8_u32, 3_u32), (64, 64), (256, 100)] {
            for (mu, mu0) in [(1.0_f32, 1.0_f32), (0.4, 0.9), (0.7, 0.05)] {
                for up in [false, true] {
                    let mut march = lit_slab(tau, 0.9, None, mu0, towards(mu, up, 40.0));
                    march.scene.light_illuminance = Vec3::splat(4.0 * std::f32::consts::PI);
                    let step = THICKNESS_M / (mu * cells as f32);
                    let (rays, counted) = march.converged(step, 16, per_dispatch);
                    let seen = rays[0];
                    let expected = 0.9 * slab_light(tau.into(), cells, (mu.into(), mu0.into()), up);
                    let error = (f64::from(seen[0]) - expected).abs();
                    let case = format!("tau {tau}, {cells} cells, mu {mu}, mu0 {mu0}, up {up}");
                    assert!(error < 3e-5, "{case}: {} is off {expected} by {error:e}", seen[0]);
                    let through = (-f64::from(tau) / f64::from(mu)).exp();
                    let left = f64::from(seen[3]);
                    // Also of the little that thick cloud lets through, until the march takes it for none.
                    let floor = if through > 1e-5 { 0.0 } else { 1e-5 };
                    assert!((left - through).abs() < 5e-5 * through + floor, "{case}: {left} passes, not {through}");
                    assert_eq!(counted[3], 0, "{case}: no iteration is lost");
                }
            }
        }
    }
}

#[test]
fn the_converged_march_is_of_second_order() {
    // A field that vanishes at both ends of the ray: clouds in a taller domain.
    let mut march = March::slab(3000.0, 0.04, towards(0.5, true, 0.0));
    march.scene.layers[0] = noisy_layer(PROFILE, 600.0, 2800.0, 0.75);
    march.scene.layers[0].extinction_per_m = 0.004;
    march.scene.layers[0].detail_strength = 0.0;
    march.scene.towards_light = towards(0.8, true, 0.0);
    march.scene.light_illuminance = Vec3::splat(4.0 * std::f32::consts::PI);
    (march.mapped, march.flags) = (true, vec!["BILLOWS", "PROFILE"]);
    march.spread = 0.4;
    let at = |step: f32, light: u32| march.converged(step, light, 60).0;
    let exact = at(2.0, 256);
    let light = exact.iter().map(|ray| f64::from(ray[0])).sum::<f64>() / exact.len() as f64;
    assert!(light > 0.05, "the rays must meet cloud: {light}");
    let errors: Vec<f64> = [(32.0, 16), (16.0, 32), (8.0, 64)]
        .map(|(step, light_steps)| {
            let rays = at(step, light_steps);
            let squares = rays.iter().zip(&exact).map(|(ray, exact)| f64::from(ray[0] - exact[0]).powi(2));
            (squares.sum::<f64>() / exact.len() as f64).sqrt()
        })
        .into();
    let order = (errors[0] / errors[2]).log2() / 2.0;
    assert!(order > 1.7, "errors {errors:?} of {light} fall with order {order}");
}

#[test]
fn single_scattering_of_a_slab_is_that_of_its_closed_form() {
    for (tau, mu, mu0, up) in [(0.5_f32, 0.7_f32, 0.6_f32, false), (2.0, 0.4, 0.9, true), (8.0, 0.8, 0.5, false)] {
        let mut march = lit_slab(tau, 0.9, None, mu0, towards(mu, up, 60.0));
        for bound in ["tight", "twice the extinction"] {
            if bound != "tight" {
                // Half the density of twice the extinction, under a bound that takes the field for twice of what it is.
                let layer = &mut march.scene.layers[0];
                (layer.body_scale, layer.body_bias) = (0.5, 0.0);
                (layer.body_scale_beyond, layer.body_bias_beyond) = (0.5, 0.0);
                layer.extinction_per_m *= 2.0;
            }
            let bounds = if bound == "tight" { blind_bounds() } else { bounds_of(2.0) };
            let (mean, counted) = march.traced(128, 1, &bounds);
            let expected = 0.9 * ISOTROPIC * slab_light(tau.into(), 100_000, (mu.into(), mu0.into()), up);
            let name = format!("tau {tau}, mu {mu}, mu0 {mu0}, up {up}, bound {bound}");
            check(&name, mean.light, mean.light_error, expected);
            let opacity = -(-f64::from(tau) / f64::from(mu)).exp_m1();
            check(&name, mean.opacity, mean.opacity_error, opacity);
            assert_eq!(counted[2..], [0, 0], "{name}: nothing over its majorant, nothing cut");
        }
    }
}

/// Radiances of DISORT with 64 streams for slabs over black ground, sun of irradiance 1: optical depth, albedo, g, slope
/// of the sun; slope and azimuth of the view, whether it looks up; radiance.
type Disort = ([f32; 4], [f32; 2], bool, f64);
const DISORT: [Disort; 12] = [
    ([1.0, 0.9, 0.5, 0.6], [0.7, 0.0], true, 0.182_925),
    ([1.0, 0.9, 0.5, 0.6], [0.4, 60.0], true, 0.088_897),
    ([1.0, 0.9, 0.5, 0.6], [0.7, 0.0], false, 0.055_735),
    ([1.0, 0.9, 0.5, 0.6], [0.4, 90.0], false, 0.054_954),
    ([4.0, 0.999, 0.85, 0.6], [0.7, 0.0], true, 0.390_291),
    ([4.0, 0.999, 0.85, 0.6], [0.4, 60.0], true, 0.124_507),
    ([4.0, 0.999, 0.85, 0.6], [0.7, 0.0], false, 0.097_280),
    ([4.0, 0.999, 0.85, 0.6], [0.4, 90.0], false, 0.079_008),
    ([16.0, 0.999, 0.85, 0.5], [0.7, 0.0], true, 0.048_525),
    ([16.0, 0.999, 0.85, 0.5], [0.4, 60.0], true, 0.036_160),
    ([16.0, 0.999, 0.85, 0.5], [0.7, 0.0], false, 0.142_165),
    ([16.0, 0.999, 0.85, 0.5], [0.4, 90.0], false, 0.108_428),
];

fn disort(case: &Disort, samples: u32) -> Mean {
    let ([tau, albedo, g, mu0], [mu, azimuth_deg], up, _) = *case;
    let march = lit_slab(tau, albedo, Some(g), mu0, towards(mu, up, azimuth_deg));
    let (mean, counted) = march.traced(samples, u32::MAX, &blind_bounds());
    assert_eq!(counted[2..], [0, 0], "nothing over its majorant, nothing cut");
    mean
}

#[test]
fn multiple_scattering_of_slabs_is_that_of_disort() {
    let every = if thorough() { 1 } else { 3 };
    for (index, case) in DISORT.iter().enumerate().step_by(every) {
        // Light that has crossed the thickest slab is noisy.
        let mean = disort(case, if index < 8 { 1000 } else { 3400 });
        assert!(mean.light_error < 0.005 * case.3, "case {index}: an error of {} says little", mean.light_error);
        check(&format!("case {index}"), mean.light, mean.light_error, case.3);
    }
}

/// Noise of a model over a slab, with light from all around.
fn furnace(models: &[u32], view: Vec3) -> March {
    let mut march = March::slab(3000.0, 0.04, view).in_a_furnace();
    for (slot, model) in march.scene.layers.iter_mut().zip(models) {
        *slot = noisy_layer(*model, 600.0, 2800.0, 0.7);
        slot.phase_kind = 2;
        (slot.g, slot.back_g, slot.back_mix) = (0.8, -0.25, 0.25);
    }
    march.layers = u32::try_from(models.len()).expect("few layers");
    (march.mapped, march.domain) = (true, FLAT);
    march.flags = vec!["BILLOWS", "PROFILE", "THESIS", "DETAIL", "CURL"];
    march
}

#[test]
fn in_a_furnace_paths_see_no_cloud() {
    for models in [&[PROFILE][..], &[PROFILE, THESIS]] {
        let march = furnace(models, towards(0.6, true, 30.0));
        let (mean, counted) = march.traced(24, u32::MAX, baked_bounds());
        assert!(mean.opacity > 0.2, "the furnace must hold cloud: {mean:?}");
        let seen = mean.light + 1.0 - mean.opacity;
        assert!((seen - 1.0).abs() < 1e-3 + SIGMAS * mean.light_error, "models {models:?}: {seen}, {mean:?}");
        assert_eq!(counted[2..], [0, 0], "nothing over its majorant, nothing cut");
    }
}

#[test]
fn paths_do_not_depend_on_the_majorant() {
    let mut march = furnace(&[PROFILE], towards(0.3, true, 100.0));
    march.scene.layers[0] = noisy_layer(PROFILE, 600.0, 2800.0, 0.35);
    march.scene.ambient_top = Vec3::ZERO;
    march.scene.towards_light = towards(0.7, true, 0.0);
    march.scene.light_illuminance = Vec3::splat(10.0);
    let (tight, counted) = march.traced(64, u32::MAX, baked_bounds());
    let (loose, more) = march.traced(64, u32::MAX, &blind_bounds());
    let error = tight.light_error.hypot(loose.light_error);
    check("light", tight.light, error, loose.light);
    check("opacity", tight.opacity, tight.opacity_error.hypot(loose.opacity_error), loose.opacity);
    assert!(
        f64::from(more[1]) > 1.05 * f64::from(counted[1]),
        "tight bounds save events: {} of {}",
        counted[1],
        more[1]
    );
}

#[test]
fn one_scattering_of_paths_is_the_converged_march() {
    for models in [&[PROFILE][..], &[PROFILE, THESIS]] {
        let mut march = furnace(models, towards(0.35, true, 20.0));
        march.scene.ambient_top = Vec3::ZERO;
        march.scene.towards_light = towards(0.6, true, 0.0);
        march.scene.light_illuminance = Vec3::splat(10.0);
        let (rays, counted) = march.converged(2.0, 128, 60);
        let seen = rays[0];
        assert_eq!(counted[3], 0, "no iteration is lost");
        let (mean, _) = march.traced(160, 1, baked_bounds());
        let error = mean.light_error.hypot(0.004 * f64::from(seen[0]));
        check(&format!("light, models {models:?}"), mean.light, error, seen[0].into());
        check("opacity", mean.opacity, mean.opacity_error.hypot(0.002), f64::from(1.0 - seen[3]));
    }
}

#[test]
fn no_density_within_reach_exceeds_its_majorant() {
    let mut random = Random::new(77);
    for (model, stretch, form) in [
        (PROFILE, 1.0, Vec4::ZERO),
        (PROFILE, 7.0, Vec4::new(0.0, 0.0, 1.0, 1.0)),
        (THESIS, 1.0, Vec4::ZERO),
        (UNIFORM, 1.0, Vec4::ZERO),
        (PRODUCT, 3.0, Vec4::ZERO),
    ] {
        let mut march = furnace(&[model], Vec3::Y);
        let layer = &mut march.scene.layers[0];
        *layer = of_octaves(*layer);
        layer.form = form;
        layer.combing = if stretch > 1.0 { Vec4::new(0.6, -0.8, 1.0 - 1.0 / stretch, 0.0) } else { Vec4::ZERO };
        // Some reach, lean and coverage that a scene gives; a cell of 64 is 375 m wide.
        layer.lean = Vec4::new(500.0, -200.0, 0.9 * 375.0 / (1.0 + 2.0 * 540.0 / 2200.0), 0.0);
        layer.anvil = random.pick(&[0.0, 0.6, 1.0]);
        let (mut cases, mut close): (Vec<Case>, u32) = (Vec::new(), 0);
        for _ in 0..100_000 {
            let p = Vec3::new(random.between(-2e4, 2e4), random.between(300.0, 3200.0), random.between(-2e4, 2e4));
            let offset = random.direction() * random.between(0.0, 0.999);
            cases.push([bits3(p), bits3(offset), [0; 4], [0; 4]]);
        }
        for [majorant, reach, extinction, _] in majorants(&march, &cases) {
            assert!(reach > 0.0 && majorant >= 0.0, "model {model}: majorant {majorant} within {reach} m");
            assert!(extinction <= majorant * 1.0001, "model {model}: {extinction} over {majorant} within {reach} m");
            close += u32::from(extinction > 0.5 * majorant && extinction > 0.0);
        }
        assert!(close > 300, "model {model}: the bound is far from every density ({close} are close)");
    }
}

/// Results of `test/eval_majorant.wgsl` over the baked field.
fn majorants(march: &March, cases: &[Case]) -> Vec<[f32; 4]> {
    let scene = gpu().uniform("scene", bytemuck::bytes_of(&march.scene));
    let mut read = vec![
        ("scene", scene.as_entire_binding()),
        ("weather_map", view_of(&Field::baked().map)),
        ("linear_repeat", wgpu::BindingResource::Sampler(linear_repeat())),
    ];
    read.extend(Field::baked().noises());
    read.extend(named(baked_bounds()));
    let key = ProgramKey::plain("test/eval_majorant.wgsl")
        .with_flags(["BILLOWS", "PROFILE", "THESIS", "UNIFORM", "PRODUCT", "DETAIL", "CURL"])
        .with_constant("DOMAIN", FLAT)
        .with_constant("LAYERS", 1);
    evaluated(&key, &read, cases)
}
