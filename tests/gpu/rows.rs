//! Rows of the picture that are left out are those that nothing is in.

use nephoscope::plan::{FramePlan, GroundPlan};
use nephoscope::scene::{DomainKind, Frame, Output, Projection, Quality, Scene};

use crate::common::Random;
use crate::common::sky::{frame, quick, renderer};

/// Every bit of a frame's light.
fn bits(frame: &Frame<'_>, plan: FramePlan) -> Vec<[u32; 4]> {
    let mut renderer = renderer();
    renderer.render_as_planned(frame, plan).unwrap_or_else(|error| panic!("{error}"));
    let rgba = renderer.linear().unwrap_or_else(|error| panic!("{error}")).rgba;
    rgba.iter().map(|texel| texel.map(f32::to_bits)).collect()
}

#[test]
fn rows_above_the_ground_are_the_same_without_it() {
    let mut random = Random::new(31);
    let mut left_out = 0;
    for projection in [Projection::Perspective, Projection::Perspective, Projection::Equirect, Projection::Dome] {
        for relief_m in [[0.0, 0.0], [300.0, 0.0], [60.0, 2500.0]] {
            let (mut scene, quality) = (Scene::default(), quick());
            scene.weather.coverage = 0.0;
            [scene.ground.hills_m, scene.ground.mountains_m] = relief_m;
            let camera = &mut scene.camera;
            camera.projection = projection;
            (camera.heading_deg, camera.pitch_deg) = (random.between(0.0, 360.0), random.between(-30.0, 60.0));
            (camera.field_of_view_deg, camera.height_m) =
                (random.between(20.0, 110.0), random.pick(&[2.0, 40.0, 4000.0]));
            (camera.east_m, camera.south_m) = (random.pick(&[0.0, 500.0]), random.pick(&[0.0, -1500.0]));
            let frame = frame(&scene, &quality, [96, 54], Output::Linear);
            let planned = FramePlan::new(&frame);
            let Some(ground) = planned.ground else { continue };
            left_out += ground.open_rows;
            let everywhere = FramePlan { ground: Some(GroundPlan { open_rows: 0, ..ground }), ..planned.clone() };
            let (with, without) = (bits(&frame, everywhere), bits(&frame, planned));
            assert!(with == without, "{:?}, relief {relief_m:?}: {} rows", scene.camera, ground.open_rows);
        }
    }
    assert!(left_out > 150, "ground was left out of {left_out} rows only");
}

#[test]
fn rows_that_miss_the_clouds_are_the_same_without_them() {
    let mut random = Random::new(47);
    let (mut left_out, mut marched) = (0, 0);
    for index in 0..48 {
        let (mut scene, quality) = (Scene::default(), Quality { max_distance_m: 60_000.0, ..quick() });
        scene.weather.coverage = 1.0;
        scene.domain.kind = random.pick(&[DomainKind::Shell, DomainKind::Shell, DomainKind::Flat, DomainKind::Box]);
        scene.domain.planet_radius_m = random.pick(&[6.36e6, 3e5]);
        scene.ground.visible = index % 4 != 0;
        let camera = &mut scene.camera;
        camera.projection =
            random.pick(&[Projection::Perspective, Projection::Perspective, Projection::Equirect, Projection::Dome]);
        (camera.heading_deg, camera.pitch_deg) = (random.between(0.0, 360.0), random.between(-50.0, 50.0));
        (camera.roll_deg, camera.field_of_view_deg) = (random.pick(&[0.0, 20.0, -75.0]), random.between(20.0, 110.0));
        camera.height_m = random.pick(&[0.0, 2.0, 1199.9, 1200.0, 2000.0, 2700.1, 9000.0, 40_000.0]);
        let frame = frame(&scene, &quality, [40, 30], Output::Linear);
        let planned = FramePlan::new(&frame);
        if !planned.has_clouds() {
            continue;
        }
        left_out += 30 - planned.cloud_rows.len();
        marched += planned.cloud_rows.len();
        let everywhere = FramePlan { cloud_rows: 0..30, ..planned.clone() };
        let rows = planned.cloud_rows.clone();
        assert!(bits(&frame, everywhere) == bits(&frame, planned), "{:?}, rows {rows:?}", scene.camera);
    }
    assert!(left_out > 200 && marched > 200, "left out of {left_out} rows, marched in {marched}");
}
