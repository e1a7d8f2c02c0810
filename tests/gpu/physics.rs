//! The production march against closed forms: homogeneous clouds whose answer is known, and the furnace, which holds for
//! any cloud.

use glam::{DVec3, Vec3};
use nephoscope::reference::shell;

use crate::common::slab::{BOX, FLAT, March, PROFILE, RADIUS_M, Seen, THESIS, noisy_layer, slab_light, uniform_layer};

const THICKNESS_M: f32 = 1000.0;
const SHELL: u32 = 0;

/// A direction at a slope, up or down.
fn sloped(mu: f32, up: bool) -> Vec3 {
    let flat = (1.0 - mu * mu).max(0.0).sqrt();
    Vec3::new(flat * 0.8, if up { mu } else { -mu }, flat * 0.6).normalize()
}

fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |worst, value| if value.is_nan() { f64::INFINITY } else { worst.max(value.abs()) })
}

#[test]
fn a_homogeneous_slab_lets_through_what_beers_law_says_at_any_jitter() {
    for tau in [0.01, 0.3, 1.0, 3.0, 10.0] {
        for mu in [1.0_f32, 0.5, 0.1] {
            for (step_m, step_depth) in [(7.0, 1e30), (33.3, 1e30), (640.0, 1e30), (33.3, 0.1), (640.0, 0.5)] {
                let mut march = March::slab(THICKNESS_M, tau / THICKNESS_M, sloped(mu, true));
                march.scene.step_m = step_m;
                march.scene.step_depth = step_depth;
                march.jittered = true;
                let expected = (-f64::from(tau) / f64::from(mu)).exp();
                let error = worst(march.run().rgba.iter().map(|texel| f64::from(texel[3]) - expected));
                assert!(error < 5e-5, "tau {tau}, mu {mu}, steps of {step_m} m: off by {error:e}");
            }
        }
    }
}

#[test]
fn a_ray_that_runs_out_of_steps_sees_through_nothing() {
    // Twenty steps of ten metres or two hundred, for a way of ten kilometres: even cloud absorbs along all of it.
    for (step_m, view_steps) in [(10.0, 20), (10.0, 4), (200.0, 20), (10.0, 200)] {
        let mut march = March::slab(THICKNESS_M, 2e-4, sloped(0.1, true));
        (march.scene.step_m, march.scene.view_steps, march.scene.empty_stride) = (step_m, view_steps, 1.5);
        march.jittered = true;
        let expected = (-2.0_f64).exp();
        let error = worst(march.run().rgba.iter().map(|texel| f64::from(texel[3]) - expected));
        assert!(error < 2e-3, "{view_steps} steps of {step_m} m: off by {error:e} of {expected}");
    }
}

#[test]
fn few_steps_are_enough_for_both_stretches_of_a_ray() {
    // Down through a shell and up out of it again, with a view from above that grazes the ground.
    let (base, top, extinction) = (500.0_f32, 2500.0_f32, 5e-6_f32);
    let dir = sloped(0.03, false);
    for view_steps in [4, 8, 160] {
        let mut march = March::slab(THICKNESS_M, extinction, dir);
        (march.domain, march.jittered, march.eye) = (SHELL, true, Vec3::Y * 3000.0);
        (march.scene.lowest_m, march.scene.highest_m) = (base, top);
        march.scene.layers[0] = uniform_layer(base, top, extinction);
        (march.scene.step_m, march.scene.view_steps, march.scene.empty_stride) = (10.0, view_steps, 1.5);
        let way = shell::shell_segments(
            DVec3::Y * 3000.0,
            dir.as_dvec3().normalize(),
            base.into(),
            top.into(),
            f64::from(RADIUS_M),
        );
        assert!(way.second.y > way.second.x, "one stretch: {way:?}");
        let length = way.first.y - way.first.x + way.second.y - way.second.x;
        let expected = (-f64::from(extinction) * length).exp();
        let error = worst(march.run().rgba.iter().map(|texel| f64::from(texel[3]) - expected));
        assert!(error < 5e-3, "{view_steps} steps: off by {error:e} of {expected}");
    }
}

#[test]
fn shell_and_box_absorb_along_their_true_length() {
    let extinction = 4e-4_f32;
    for (domain, dir) in [
        (SHELL, sloped(1.0, true)),
        (SHELL, sloped(0.2, true)),
        (SHELL, sloped(0.02, true)),
        (BOX, sloped(0.7, true)),
        (BOX, Vec3::new(0.9, 0.3, 0.1).normalize()),
    ] {
        let mut march = March::slab(THICKNESS_M, extinction, dir);
        (march.domain, march.jittered) = (domain, true);
        march.scene.lowest_m = 1500.0;
        march.scene.highest_m = 2500.0;
        march.scene.layers[0] = uniform_layer(1500.0, 2500.0, extinction);
        march.scene.step_growth = 0.003;
        (march.scene.box_min, march.scene.box_max) = (Vec3::new(-4e3, 1500.0, -4e3), Vec3::new(9e3, 2500.0, 6e3));
        let exact = dir.as_dvec3().normalize();
        let way = if domain == SHELL {
            shell::shell_segments(DVec3::ZERO, exact, 1500.0, 2500.0, f64::from(RADIUS_M))
        } else {
            shell::box_segments(DVec3::ZERO, exact, march.scene.box_min.as_dvec3(), march.scene.box_max.as_dvec3())
        };
        let length = (way.first.y - way.first.x).max(0.0);
        let expected = (-f64::from(extinction) * length).exp();
        let error = worst(march.run().rgba.iter().map(|texel| f64::from(texel[3]) - expected));
        assert!(error < 5e-5, "domain {domain}, {dir}, {length} m: off by {error:e} of {expected}");
    }
}

#[test]
fn a_slab_scatters_exactly_as_its_discrete_closed_form() {
    for tau in [0.01, 0.5, 2.0, 8.0, 30.0] {
        for cells in [8_u32, 61, 512] {
            for (mu, mu0) in [(1.0_f32, 1.0_f32), (1.0, 0.3), (0.4, 0.9), (0.25, 0.25), (0.7, 0.05)] {
                for up in [false, true] {
                    let mut march = March::slab(THICKNESS_M, tau / THICKNESS_M, sloped(mu, up));
                    march.scene.step_m = THICKNESS_M / (mu * cells as f32);
                    march.scene.towards_light = sloped(mu0, true);
                    march.scene.light_illuminance = Vec3::splat(4.0 * std::f32::consts::PI);
                    march.scene.layers[0].albedo = 0.9;
                    let expected = 0.9 * slab_light(tau.into(), cells, (mu.into(), mu0.into()), up);
                    let seen = march.run();
                    let error = worst(seen.rgba.iter().flat_map(|t| [t[0], t[2]]).map(|l| f64::from(l) - expected));
                    let case = format!("tau {tau}, {cells} cells, mu {mu}, mu0 {mu0}, up {up}");
                    assert!(error < 3e-5, "{case}: {} is off {expected} by {error:e}", seen.rgba[0][0]);
                }
            }
        }
    }
}

#[test]
fn the_closed_form_tends_to_the_integral() {
    // Down: p E / (1 + mu / mu0) (1 - exp(-tau (1/mu + 1/mu0))), Chandrasekhar's single scattering.
    let (tau, mu, mu0) = (2.0_f64, 0.6_f64, 0.8_f64);
    let exact = (1.0 - (-tau * (1.0 / mu + 1.0 / mu0)).exp()) / (1.0 + mu / mu0);
    assert!((slab_light(tau, 8192, (mu, mu0), false) - exact).abs() < 1e-5, "the form of this test is the right one");
}

/// A march through noise: both models, erosion, curl, growing steps, jitter.
fn noisy(models: &[u32], dir: Vec3) -> March {
    let mut march = March::slab(3000.0, 0.04, dir);
    for (slot, model) in march.scene.layers.iter_mut().zip(models) {
        *slot = noisy_layer(*model, 600.0, 2800.0, 0.7);
    }
    march.layers = u32::try_from(models.len()).expect("few layers");
    (march.jittered, march.mapped) = (true, true);
    march.flags = vec!["BILLOWS", "PROFILE", "THESIS", "DETAIL", "CURL"];
    (march.scene.step_m, march.scene.step_growth, march.scene.empty_stride) = (25.0, 0.004, 3.0);
    march.scene.step_depth = 0.3;
    march
}

fn furnace_error(seen: &Seen) -> f64 {
    worst(seen.rgba.iter().flat_map(|t| [0, 1, 2].map(|c| f64::from(t[c]) + f64::from(t[3]) - 1.0)))
}

#[test]
fn in_a_furnace_no_cloud_can_be_seen() {
    let mut darkest = 1.0_f32;
    for early_exit in [0.0, 0.01, 0.2] {
        for (step_m, extinction) in [(3.0, 0.002), (20.0, 0.04), (400.0, 0.5)] {
            let mut march = March::slab(THICKNESS_M, extinction, sloped(0.5, true)).in_a_furnace();
            (march.jittered, march.scene.step_m, march.scene.early_exit) = (true, step_m, early_exit);
            let error = furnace_error(&march.run());
            assert!(error < 1e-5, "slab, steps of {step_m} m, exit {early_exit}: off by {error:e}");
        }
        for models in [&[PROFILE][..], &[THESIS], &[PROFILE, THESIS]] {
            for slope in [0.9, 0.3, 0.06] {
                let mut march = noisy(models, sloped(slope, true)).in_a_furnace();
                march.scene.early_exit = early_exit;
                let seen = march.run();
                let error = furnace_error(&seen);
                assert!(error < 1e-5, "models {models:?}, slope {slope}, exit {early_exit}: off by {error:e}");
                darkest = seen.rgba.iter().fold(darkest, |least, texel| least.min(texel[3]));
            }
        }
    }
    assert!(darkest < 0.5, "the furnace must have held clouds, but the least transmittance is {darkest}");
}

#[test]
fn an_early_exit_leaves_no_film_and_keeps_colour() {
    let limit = 0.05_f32;
    for tau in [0.1, 1.0, 2.5, 9.0] {
        let run = |early_exit| {
            let mut march = March::slab(THICKNESS_M, tau / THICKNESS_M, sloped(1.0, true));
            march.scene.light_illuminance = Vec3::splat(4.0 * std::f32::consts::PI);
            march.scene.early_exit = early_exit;
            march.run().rgba[0]
        };
        let (whole, ended) = (run(0.0), run(limit));
        let left = ((whole[3] - limit) / (1.0 - limit)).max(0.0);
        assert!((ended[3] - left).abs() < 1e-6, "tau {tau}: {} is left, not {left}", ended[3]);
        if whole[3] > limit {
            let light = whole[0] * (1.0 - left) / (1.0 - whole[3]);
            assert!((ended[0] / light - 1.0).abs() < 1e-4, "tau {tau}: light {}, not {light}", ended[0]);
        } else {
            assert_eq!(ended[3], 0.0, "an ended ray is opaque");
        }
    }
}

#[test]
fn where_there_is_no_cloud_nothing_is_seen_at_all() {
    let mut empty = noisy(&[PROFILE, THESIS], sloped(0.4, true)).in_a_furnace();
    empty.scene.light_illuminance = Vec3::ONE;
    for layer in &mut empty.scene.layers {
        layer.body_bias = -10.0;
    }
    let mut uncovered = March::slab(THICKNESS_M, 0.05, Vec3::Y).in_a_furnace();
    uncovered.scene.layers[0].body_bias = 0.0;
    let mut beside = March::slab(THICKNESS_M, 0.05, sloped(0.5, false)).in_a_furnace();
    beside.eye = Vec3::ZERO;
    for (name, march) in [("no body", empty), ("coverage 0", uncovered), ("looking away", beside)] {
        let seen = march.run();
        assert!(seen.rgba.iter().all(|texel| *texel == [0.0, 0.0, 0.0, 1.0]), "{name}: {:?}", seen.rgba[0]);
        assert!(seen.distance_m.iter().all(|distance| *distance == 0.0), "{name} has no distance");
    }
}

#[test]
fn long_steps_through_clear_air_lose_no_more_than_one_short_step_of_cloud() {
    let (extinction, step_m) = (0.001_f32, 40.0_f32);
    for stride in [1.0, 3.0, 8.0] {
        for base_m in [0.0, 1511.0, 1700.0, 1903.0] {
            let mut march = March::slab(THICKNESS_M, extinction, Vec3::Y);
            (march.domain, march.jittered) = (FLAT, true);
            march.scene.highest_m = base_m + THICKNESS_M;
            march.scene.layers[0] = uniform_layer(base_m, base_m + THICKNESS_M, extinction);
            (march.scene.step_m, march.scene.empty_stride) = (step_m, stride);
            // Every cloud is dense enough to look for its surface.
            march.scene.step_depth = 0.01;
            for texel in march.run().rgba {
                let seen_m = -texel[3].ln() / extinction;
                let error = (seen_m - THICKNESS_M).abs();
                assert!(error <= step_m * 1.01, "stride {stride}, base {base_m} m: {seen_m} m of {THICKNESS_M} m");
            }
        }
    }
}

#[test]
fn the_light_march_reads_the_middle_of_its_steps() {
    // Level along the bottom of a cloud whose top lies inside a step of the light: half a step is the most it may err.
    for top_m in [900.0, 1100.0, 1240.0, 1260.0, 1400.0] {
        let mut march = March::slab(2000.0, 0.001, Vec3::X);
        march.eye = Vec3::Y;
        march.scene.layers[0] = uniform_layer(0.0, top_m, 0.001);
        march.scene.step_m = 100.0;
        march.scene.light_illuminance = Vec3::splat(4.0 * std::f32::consts::PI);
        let depth_m = -march.run().rgba[0][0].ln() / 0.001;
        assert!((depth_m - top_m).abs() <= 126.0, "{depth_m} m of cloud under {top_m} m, in steps of 250 m");
    }
}

#[test]
fn the_distance_kept_for_reprojection_is_that_of_the_light() {
    // Mean of t with weight exp(-t / L) over a slab that is opaque: L, the free path.
    let mut march = March::slab(40_000.0, 0.01, Vec3::Y);
    march.scene.step_m = 1.0;
    let distance = march.run().distance_m[0];
    assert!((distance - 100.0).abs() < 1.0, "{distance} m, not a free path of 100 m");
}

#[test]
fn samples_that_are_lit_together_send_about_the_light_that_each_would() {
    for tau in [1e-5, 1e-3, 0.1, 1.0, 8.0, 30.0] {
        for (mu, mu0, up) in [(1.0, 0.5, false), (0.3, 0.9, true), (0.6, 0.2, false)] {
            let light = |share: f32| {
                let mut march = March::slab(THICKNESS_M, tau / THICKNESS_M, sloped(mu, up));
                march.scene.step_m = 5.0 / tau.clamp(0.5, 5.0);
                march.scene.towards_light = sloped(mu0, true);
                march.scene.light_illuminance = Vec3::splat(4.0 * std::f32::consts::PI);
                march.scene.light_share = share;
                f64::from(march.run().rgba[0][0])
            };
            let (each, together) = (light(0.0), light(0.33));
            // Eight steps at most are lit as one: where cloud is thin, light hardly changes over them.
            let allowed = if tau < 0.5 { 0.005 } else { 0.05 };
            assert!(each > 0.0, "tau {tau}: there is light");
            assert!((together / each - 1.0).abs() < allowed, "tau {tau}, mu {mu}, mu0 {mu0}: {together} for {each}");
        }
    }
}
