//! Shapes by signed distance: their distances, as clouds, and as solid things.

use std::time::Duration;

use bytemuck::Zeroable as _;
use glam::{Quat, Vec3, Vec4};
use nephoscope::render::truth::Goal;
use nephoscope::render::uniforms::other::{ShapeUniforms, ShapesUniforms};
use nephoscope::scene::{DensityModel, Output, Quality, Scene, Shape, ShapeJoin, ShapeKind, ShapeRole};

use crate::common::sky::{frame, linear, quick, renderer};
use crate::common::{Random, bits3, eval_with};

const KINDS: u32 = 5;
/// As `TRUSTED` in the shader.
const TRUSTED: f32 = 0.95;

fn any_shape(random: &mut Random, kind: u32) -> ShapeUniforms {
    let mut place = |low: f32, high: f32| random.between(low, high);
    let turn = Quat::from_rotation_y(place(-3.0, 3.0)) * Quat::from_rotation_x(place(-3.0, 3.0));
    ShapeUniforms {
        centre: Vec3::new(place(-800.0, 800.0), place(0.0, 900.0), place(-800.0, 800.0)),
        kind,
        half_size: Vec3::new(place(20.0, 400.0), place(20.0, 400.0), place(20.0, 400.0)),
        local_from_world: Vec4::from(turn.conjugate()),
        rounding_m: place(0.0, 15.0),
        ..ShapeUniforms::zeroed()
    }
}

fn shapes(list: &[ShapeUniforms], solids: u32) -> ShapesUniforms {
    let mut all = ShapesUniforms::zeroed();
    all.list[..list.len()].copy_from_slice(list);
    (all.clouds, all.solids) = (u32::try_from(list.len()).expect("few") - solids, solids);
    all
}

fn distances(shapes: &ShapesUniforms, places: &[Vec3]) -> Vec<[f32; 4]> {
    let cases: Vec<_> = places.iter().map(|p| [bits3(*p), [0; 4], [0; 4], [0; 4]]).collect();
    let bits = eval_with("shapes", "eval_shapes", &cases, bytemuck::bytes_of(shapes));
    bits.into_iter().map(|bits| bits.map(f32::from_bits)).collect()
}

fn places(random: &mut Random, count: usize) -> Vec<Vec3> {
    let mut at = || random.between(-1800.0, 1800.0);
    (0..count).map(|_| Vec3::new(at(), at(), at())).collect()
}

/// Whether a place is inside, from the shape's own definition.
fn is_inside(shape: &ShapeUniforms, p: Vec3) -> bool {
    let q = Quat::from_vec4(shape.local_from_world) * (p - shape.centre);
    let half = shape.half_size;
    match shape.kind {
        0 => q.length() < half.x,
        1 => (q / half).length() < 1.0,
        2 => {
            let rounding = shape.rounding_m.min(half.min_element());
            let core = half - rounding;
            q.distance(q.clamp(-core, core)) < rounding || (rounding <= 0.0 && q.abs().cmplt(half).all())
        }
        3 => q.x.hypot(q.z) < half.x && q.y.abs() < half.y,
        _ => {
            let straight = (half.y - half.x).max(0.0);
            q.distance(Vec3::new(0.0, q.y.clamp(-straight, straight), 0.0)) < half.x
        }
    }
}

#[test]
fn distances_are_those_to_the_surface() {
    let mut random = Random::new(61);
    for kind in 0..KINDS {
        for _ in 0..8 {
            let shape = any_shape(&mut random, kind);
            let places = places(&mut random, 500);
            for (p, [_, _, own, _]) in places.iter().zip(distances(&shapes(&[shape], 0), &places)) {
                // Not at the surface itself, where rounding decides.
                if own.abs() > 0.05 {
                    assert_eq!(own < 0.0, is_inside(&shape, *p), "kind {kind} at {p}: {own}");
                }
                // Nothing inside is nearer than the distance: look around the place on a sphere a little smaller.
                for _ in 0..4 {
                    let near = *p + random.direction() * own.abs() * 0.999;
                    assert!(own.abs() < 0.05 || is_inside(&shape, near) == (own < 0.0), "kind {kind}: {near} from {p}");
                }
            }
        }
    }
}

#[test]
fn joined_distances_never_change_by_more_than_the_way() {
    let mut random = Random::new(62);
    for round in 0..12 {
        let mut list: Vec<ShapeUniforms> =
            (0..6).map(|index| any_shape(&mut random, (index + round) % KINDS)).collect();
        for (shape, join) in list.iter_mut().zip([0, 0, 1, 0, 2, 0]) {
            (shape.join, shape.blend_m) = (join, if round % 2 == 0 { 0.0 } else { random.between(1.0, 300.0) });
        }
        let all = shapes(&list, 0);
        let from = places(&mut random, 800);
        let to: Vec<Vec3> = from.iter().map(|p| *p + random.direction() * random.between(0.1, 200.0)).collect();
        for ((from, a), (to, b)) in from.iter().zip(distances(&all, &from)).zip(to.iter().zip(distances(&all, &to))) {
            let way = from.distance(*to);
            assert!((a[0] - b[0]).abs() <= way * 1.0001 + 0.01, "round {round}: {} and {} over {way}", a[0], b[0]);
        }
    }
}

#[test]
fn shapes_join_as_sets_do() {
    let mut random = Random::new(63);
    let places = places(&mut random, 2000);
    for join in 0..3 {
        let [a, mut b] = [(); 2].map(|()| ShapeUniforms {
            centre: Vec3::new(random.between(-200.0, 200.0), 100.0, 0.0),
            half_size: Vec3::splat(500.0),
            ..any_shape(&mut random, 1)
        });
        b.join = join;
        for (p, [joined, solid, ..]) in places.iter().zip(distances(&shapes(&[a, b], 0), &places)) {
            let (in_a, in_b) = (is_inside(&a, *p), is_inside(&b, *p));
            let expected = [in_a || in_b, in_a && !in_b, in_a && in_b][join as usize];
            assert!(joined.abs() < 0.1 || (joined < 0.0) == expected, "join {join} at {p}: {joined}");
            assert!(solid > 9e5 * TRUSTED, "nothing is solid: {solid}");
        }
    }
}

/// A sky of shapes, in view.
pub(crate) fn sky() -> Scene {
    let mut scene = Scene::default();
    (scene.layers[0].model, scene.layers[0].curl_m) = (DensityModel::Shapes, 0.0);
    (scene.layers[0].base_m, scene.layers[0].top_m) = (900.0, 3200.0);
    let body = Shape { heading_deg: 40.0, tilt_deg: 20.0, ..Shape::default() };
    let ball = Shape { kind: ShapeKind::Sphere, east_m: 900.0, blend_m: 300.0, width_m: 1300.0, ..Shape::default() };
    let cut =
        Shape { kind: ShapeKind::Box, join: ShapeJoin::Difference, height_m: 800.0, blend_m: 100.0, ..ball.clone() };
    scene.shapes = vec![body, ball, cut];
    scene.camera.pitch_deg = 18.0;
    scene
}

#[test]
fn no_path_finds_more_than_the_bound() {
    let scene = sky();
    let quality = Quality::default();
    let renderer = &mut renderer();
    let second = Duration::from_secs(1);
    let goal = Goal::PathTraced { tolerance: 0.0, samples: 8, scatterings: Some(6), seed: 1 };
    let mut truth =
        renderer.begin_truth(&frame(&scene, &quality, [48, 27], Output::Linear), goal, 1).expect("it begins");
    while !truth.advance(renderer, second, second).expect("it goes on").is_done {}
    let counts = truth.progress().counts;
    assert_eq!((counts.exceeded, counts.cut), (0, 0), "{counts:?}");
    assert!(counts.steps > 50_000, "paths meet cloud: {counts:?}");
}

#[test]
fn many_shapes_and_shapes_of_no_size_are_finite() {
    let mut scene = sky();
    for kind in [ShapeKind::Sphere, ShapeKind::Ellipsoid, ShapeKind::Box, ShapeKind::Cylinder, ShapeKind::Capsule] {
        for role in [ShapeRole::Cloud, ShapeRole::Solid] {
            let none = Shape { kind, role, width_m: 0.0, length_m: 0.0, tall_m: 0.0, ..Shape::default() };
            scene.shapes.push(Shape { rounding_m: 5000.0, blend_m: 5000.0, ..none.clone() });
            scene.shapes.push(Shape { width_m: 100_000.0, south_m: 0.0, height_m: 0.0, ..none });
        }
    }
    while scene.shapes.len() < nephoscope::scene::MAX_SHAPES {
        let at = scene.shapes.len() as f32;
        scene.shapes.push(Shape {
            role: ShapeRole::Solid,
            east_m: 90.0 * at - 2000.0,
            width_m: at,
            ..Shape::default()
        });
    }
    assert!(scene.problems().is_empty(), "{:?}", scene.problems());
    let image = linear(&scene, &quick(), [32, 18]);
    assert!(image.rgba.iter().flatten().all(|value| value.is_finite() && *value >= 0.0), "light");
    scene.shapes.push(Shape::default());
    assert!(scene.problems()[0].contains("at most 64"), "{:?}", scene.problems());
}

#[test]
fn solid_things_stand_before_what_lies_behind_and_cast_shadows() {
    let mut scene = Scene::default();
    scene.layers.clear();
    (scene.sun.elevation_deg, scene.sun.azimuth_deg) = (35.0, 90.0);
    (scene.camera.height_m, scene.camera.pitch_deg, scene.camera.heading_deg) = (400.0, -30.0, 0.0);
    scene.ground.hills_m = 0.0;
    let without = linear(&scene, &quick(), [48, 27]);
    let ball = Shape {
        kind: ShapeKind::Sphere,
        role: ShapeRole::Solid,
        south_m: -700.0,
        height_m: 60.0,
        width_m: 120.0,
        ..Shape::default()
    };
    scene.shapes = vec![ball];
    let with = linear(&scene, &quick(), [48, 27]);
    // To its west lies its shadow, beside it.
    let darker = with.rgba.iter().zip(&without.rgba).filter(|(with, without)| with[1] < 0.7 * without[1]).count();
    let brighter = with.rgba.iter().zip(&without.rgba).filter(|(with, without)| with[1] > 1.3 * without[1]).count();
    assert!(darker > 3 && brighter > 3, "{darker} pixels in shadow, {brighter} of the lit ball");
    let far = with.rgba.iter().zip(&without.rgba).filter(|(with, without)| with == without).count();
    assert!(far > 48 * 27 / 3, "most of the ground is as before: {far}");
}
