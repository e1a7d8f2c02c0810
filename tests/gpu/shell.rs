//! `common/shell.wgsl` against planet-centred arithmetic in f64.

use glam::{DVec2, DVec3, Vec3};
use nephoscope::reference::shell::{self, Segments};

use crate::common::{Case, Random, bits3, bits4, eval, exact_direction};

const RADIUS_M: f32 = 6.36e6;
const BASE_M: f32 = 1500.0;
const TOP_M: f32 = 4000.0;

/// A camera at `altitude_m` above the sea, `away_m` metres along the ground from the origin, and a ray of it.
fn ray(random: &mut Random, altitude_m: f32, away_m: f32, elevation_deg: f32) -> (Vec3, Vec3) {
    let angle = f64::from(away_m) / f64::from(RADIUS_M);
    let (bearing_sin, bearing_cos) = f64::from(random.between(0.0, std::f32::consts::TAU)).sin_cos();
    let out = DVec3::new(bearing_cos, 0.0, bearing_sin);
    let up = DVec3::Y * angle.cos() + out * angle.sin();
    let radius = f64::from(RADIUS_M) + f64::from(altitude_m);
    let p = up * radius - DVec3::Y * f64::from(RADIUS_M);
    let level = up.cross(random.direction().as_dvec3()).normalize();
    let elevation = f64::from(elevation_deg).to_radians();
    (p.as_vec3(), (level * elevation.cos() + up * elevation.sin()).as_vec3())
}

struct Regime {
    name: &'static str,
    altitude_m: f32,
    away_m: f32,
    layer_m: f32,
    elevations_deg: (f32, f32),
    tolerance_m: f64,
}

const REGIMES: [Regime; 6] = [
    Regime {
        name: "from the ground, near the horizon",
        altitude_m: 2.0,
        away_m: 0.0,
        layer_m: BASE_M,
        elevations_deg: (0.0, 2.0),
        tolerance_m: 0.05,
    },
    Regime {
        name: "from the ground",
        altitude_m: 0.0,
        away_m: 0.0,
        layer_m: BASE_M,
        elevations_deg: (0.0, 90.0),
        tolerance_m: 0.05,
    },
    Regime {
        name: "from the ground, 200 km from the origin",
        altitude_m: 2.0,
        away_m: 2e5,
        layer_m: BASE_M,
        elevations_deg: (0.5, 90.0),
        tolerance_m: 0.1,
    },
    Regime {
        name: "one metre under the base",
        altitude_m: BASE_M - 1.0,
        away_m: 0.0,
        layer_m: BASE_M,
        elevations_deg: (0.0, 90.0),
        tolerance_m: 0.01,
    },
    Regime {
        name: "from 2 km down to the base",
        altitude_m: 2000.0,
        away_m: 0.0,
        layer_m: BASE_M,
        elevations_deg: (-3.0, -0.8),
        tolerance_m: 0.1,
    },
    Regime {
        name: "from 10 km to a layer at 4 km",
        altitude_m: 1e4,
        away_m: 0.0,
        layer_m: TOP_M,
        elevations_deg: (-90.0, -2.6),
        tolerance_m: 0.1,
    },
];

#[test]
fn roots_are_right_to_centimetres() {
    let mut random = Random::new(10);
    for regime in &REGIMES {
        let (low, high) = regime.elevations_deg;
        let rays: Vec<(Vec3, Vec3)> = (0..4000)
            .map(|_| {
                let elevation = random.between(low, high);
                ray(&mut random, regime.altitude_m, regime.away_m, elevation)
            })
            .collect();
        let numbers = bits4([regime.layer_m, RADIUS_M, 0.0, 0.0]);
        let cases: Vec<Case> = rays.iter().map(|(p, dir)| [bits3(*p), bits3(*dir), numbers, [0; 4]]).collect();
        let mut worst = 0.0_f64;
        for ((p, dir), result) in rays.iter().zip(eval("shell", "eval_shell_roots", &cases)) {
            let (p, dir) = (p.as_dvec3(), exact_direction(*dir));
            let radius = f64::from(RADIUS_M);
            let expected = shell::shell_roots(p, dir, f64::from(regime.layer_m), radius);
            // The root that a ray meets first in front of it is the one that a march starts at.
            let (value, expected) =
                if expected.x > 0.0 { (f64::from(result[0]), expected.x) } else { (f64::from(result[1]), expected.y) };
            let error = (value - expected).abs();
            worst = worst.max(error);
            let name = regime.name;
            assert!(error <= regime.tolerance_m, "{name}: {value} m, not {expected} m along {dir} from {p}");
            let altitude = shell::altitude_at(p, radius);
            assert!((f64::from(result[2]) - altitude).abs() < 4e-3, "{name}: altitude {}, not {altitude}", result[2]);
            let up = (p.y + radius) / (altitude + radius);
            assert!((f64::from(result[3]) - up).abs() < 1e-6, "{name}: up.y {}, not {up}", result[3]);
        }
        println!("{}: worst error {worst:.5} m", regime.name);
    }
}

/// Asserts that the stretches cover what the twin's cover, except within the rounding of a surface.
fn assert_covers(name: &str, found: [f32; 4], expected: Segments, distance_to_surface: impl Fn(f64) -> f64) {
    let [a, b, c, d] = found.map(f64::from);
    let found = Segments { first: DVec2::new(a, b), second: DVec2::new(c, d) };
    assert!([a, b, c, d].iter().all(|t| t.is_finite() && *t >= 0.0), "{name}: {found:?}");
    assert!(found.second == DVec2::ZERO || found.first.y <= found.second.x, "{name}: out of order {found:?}");
    assert_eq!(found, Segments::ordered(found.first, found.second), "{name}: an empty stretch is (0, 0) and last");
    let ends = [found.first, found.second, expected.first, expected.second].map(|s| [s.x, s.y]);
    let around = ends.into_iter().flatten().flat_map(|t| [t * 0.999 - 0.5, t - 1e-3, t + 1e-3, t * 1.001 + 0.5]);
    let along = (0..120).map(|i| f64::from(i).powi(3) * 0.4);
    for t in around.chain(along).filter(|t| (0.0..1e7).contains(t)) {
        if found.contains(t) != expected.contains(t) {
            let gap = distance_to_surface(t);
            // Distances are f32: half a centimetre at 100 km.
            assert!(gap < 0.05 + 3e-7 * t, "{name}: at {t} m, {gap} m from a surface: {found:?}, not {expected:?}");
        }
    }
}

/// Rays from below, inside, above and right on the boundaries of a layer.
fn rays_about(base_m: f32, top_m: f32) -> Vec<(Vec3, Vec3)> {
    let mut random = Random::new(11);
    let mut rays = Vec::new();
    let around_base = [base_m - 1e-3, base_m, base_m + 1e-3].map(|altitude| altitude.max(0.0));
    let around_top = [top_m - 1e-3, top_m, top_m + 1.0];
    let elsewhere = [0.0, 2.0, 0.5 * (base_m + top_m), 1e4, 4e5];
    for altitude in around_base.into_iter().chain(around_top).chain(elsewhere) {
        for elevation in [-90.0, -60.0, -20.0, -2.0, -1.0, -0.3, 0.0, 0.3, 1.0, 20.0, 60.0, 90.0] {
            for away in [0.0, 0.0, 3e4, 2e5] {
                rays.push(ray(&mut random, altitude, away, elevation + random_tilt(away)));
            }
        }
        for _ in 0..200 {
            let elevation = random.between(-5.0, 5.0);
            rays.push(ray(&mut random, altitude, 0.0, elevation));
        }
    }
    rays
}

#[test]
fn shell_segments_hold_below_inside_above_and_on_the_boundary() {
    let radius = f64::from(RADIUS_M);
    for (base_m, top_m, least_with_two) in [(BASE_M, TOP_M, 50), (0.0, 300.0, 0), (-50.0, 300.0, 0)] {
        let rays = rays_about(base_m, top_m);
        let numbers = bits4([base_m, top_m, RADIUS_M, 0.0]);
        let cases: Vec<Case> = rays.iter().map(|(p, dir)| [bits3(*p), bits3(*dir), numbers, [0; 4]]).collect();
        let mut with_two = 0;
        for ((p, dir), result) in rays.iter().zip(eval("shell", "eval_shell_segments", &cases)) {
            let (p, dir) = (p.as_dvec3(), exact_direction(*dir));
            let expected = shell::shell_segments(p, dir, f64::from(base_m), f64::from(top_m), radius);
            with_two += usize::from(expected.second.y > 0.0);
            assert_covers(&format!("{base_m} m: {p} {dir}"), result, expected, |t| {
                let altitude = shell::altitude_at(p + dir * t, radius);
                // A ray that grazes the ground may miss it by the rounding.
                let graze = shell::altitude_at(p - dir * (p + DVec3::Y * radius).dot(dir), radius);
                let surfaces = [0.0, f64::from(base_m), f64::from(top_m)];
                let here = surfaces.iter().map(|s| (altitude - s).abs()).fold(f64::MAX, f64::min);
                here.min(graze.abs())
            });
        }
        assert!(with_two >= least_with_two, "only {with_two} rays cross the layer twice");
    }
}

/// Rays far from the origin are tilted a little, so that they are not all alike.
fn random_tilt(away_m: f32) -> f32 {
    away_m * 1e-6
}

#[test]
fn a_layer_without_thickness_is_empty() {
    let flat = |base: f32, top: f32| [bits3(Vec3::ZERO), bits3(Vec3::Y), bits4([base, top, RADIUS_M, 0.0]), [0; 4]];
    let cases = [flat(1500.0, 1500.0), flat(4000.0, 1500.0), flat(0.0, 0.0)];
    for entry_point in ["eval_shell_segments", "eval_slab_segments"] {
        assert_eq!(eval("shell", entry_point, &cases), [[0.0; 4]; 3], "{entry_point}");
    }
}

fn flat_rays(seed: u32) -> Vec<(Vec3, Vec3)> {
    let mut random = Random::new(seed);
    let places = [-200.0, 0.0, 50.0, 100.0, 250.0];
    let mut rays = Vec::new();
    for _ in 0..3000 {
        let p = Vec3::from_array(std::array::from_fn(|_| random.pick(&places)));
        let mut dir = random.direction();
        for axis in 0..3 {
            if random.pick(&[true, false, false]) {
                dir[axis] = random.pick(&[0.0, -0.0]);
            }
        }
        if dir != Vec3::ZERO {
            rays.push((p, dir.normalize()));
        }
    }
    rays
}

#[test]
fn box_and_slab_hold_for_axis_aligned_rays_on_faces() {
    let (low, high) = (Vec3::new(0.0, -50.0, 0.0), Vec3::splat(100.0));
    let rays = flat_rays(12);
    let case = |c, d| -> Vec<Case> { rays.iter().map(|(p, dir)| [bits3(*p), bits3(*dir), c, d]).collect() };
    let boxes = eval("shell", "eval_box_segments", &case(bits3(low), bits3(high)));
    let slabs = eval("shell", "eval_slab_segments", &case(bits4([-50.0, 100.0, 0.0, 0.0]), [0; 4]));
    for (((p, dir), in_box), in_slab) in rays.iter().zip(boxes).zip(slabs) {
        let name = format!("{p} {dir}");
        let (p, dir) = (p.as_dvec3(), dir.as_dvec3());
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let expected = shell::box_segments(p, dir, low, high);
        assert_covers(&name, in_box, expected, |t| {
            let q = p + dir * t;
            (q - low).abs().min((q - high).abs()).min_element()
        });
        let expected = shell::slab_segments(p, dir, -50.0, 100.0);
        assert_covers(&name, in_slab, expected, |t| {
            let y = (p + dir * t).y;
            (y + 50.0).abs().min((y - 100.0).abs())
        });
    }
}
