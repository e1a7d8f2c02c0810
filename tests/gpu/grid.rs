//! Voxel grids in plain light, from the file to the picture: against closed forms and quadrature on the processor.

use std::path::Path;
use std::time::Duration;

use glam::{DVec3, Vec3};
use nephoscope::files;
use nephoscope::images::voxels::VoxelGrid;
use nephoscope::render::truth::{Goal, TruthCounts, TruthPicture};
use nephoscope::scene::{CloudLayer, DensityModel, DomainKind, Frame, Output, Quality, Scene};

use crate::common::Random;
use crate::common::sky::{frame, quick, renderer};

const SIZE: [u32; 2] = [24, 16];
const ISOTROPIC: f64 = 1.0 / (4.0 * std::f64::consts::PI);

/// Values by index along x, y and z.
fn grid(size: [u32; 3], value: impl Fn([u32; 3]) -> f32) -> VoxelGrid {
    let [x, y, z] = size;
    let all = (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k])));
    VoxelGrid::new(size, all.map(value).collect()).expect("a sound grid")
}

/// The scene of a grid with a description, as it is opened from the disk. The folder has to stay while it is rendered.
fn scene(folder: &Path, grid: &VoxelGrid, description: &str) -> Scene {
    let mut file = std::fs::File::create(folder.join("cloud.npy")).expect("made");
    grid.write_npy(&mut file).expect("written");
    let path = folder.join("cloud.json");
    let json = format!(r#"{{"format": "nephoscope-grid 1", "values": "cloud.npy", {description}}}"#);
    std::fs::write(&path, json).expect("written");
    files::open(&path).unwrap_or_else(|error| panic!("{error}")).preset.scene
}

fn truth(scene: &Scene, quality: &Quality, goal: Goal, output: Output) -> (TruthPicture, TruthCounts) {
    let mut renderer = renderer();
    let mut truth = renderer.begin_truth(&frame(scene, quality, SIZE, output), goal, 1).expect("it can be begun");
    let second = Duration::from_secs(1);
    while !truth.advance(&renderer, second, second).expect("it goes on").is_done {}
    (truth.picture(&renderer).expect("it can be read"), truth.progress().counts)
}

fn traced(scene: &Scene, samples: u32, scatterings: Option<u32>) -> TruthPicture {
    let goal = Goal::PathTraced { tolerance: 0.0, samples, scatterings, seed: 5 };
    let (picture, counts) = truth(scene, &quick(), goal, Output::Linear);
    assert_eq!((counts.exceeded, counts.cut), (0, 0), "no place over its bound, no path cut");
    picture
}

fn converged(scene: &Scene, tolerance: f32) -> TruthPicture {
    let quality = Quality { octaves: 0, ..quick() };
    truth(scene, &quality, Goal::Converged { tolerance, levels: 8 }, Output::CloudsAlone).0
}

/// The trilinear value at a place of a box from −½ to ½ along each axis.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "indices of voxels")]
fn value_at(grid: &VoxelGrid, p: DVec3) -> f64 {
    let size = grid.size();
    let mut cells = [[(0_usize, 0.0); 2]; 3];
    for axis in 0..3 {
        if p[axis].abs() > 0.5 {
            return 0.0;
        }
        let last = f64::from(size[axis] - 1);
        let at = ((p[axis] + 0.5) * f64::from(size[axis]) - 0.5).clamp(0.0, last);
        let low = at.floor();
        cells[axis] = [(low as usize, 1.0 - (at - low)), ((low + 1.0).min(last) as usize, at - low)];
    }
    let mut value = 0.0;
    for (x, a) in cells[0] {
        for (y, b) in cells[1] {
            for (z, c) in cells[2] {
                let index = (z * size[1] as usize + y) * size[0] as usize + x;
                value += a * b * c * f64::from(grid.values()[index]);
            }
        }
    }
    value
}

/// Transmittance along the rays of a lens that looks at the middle of that box from `origin`, with y up.
fn transmittances(grid: &VoxelGrid, scale: f64, origin: DVec3, fov_x_deg: f64) -> Vec<f64> {
    let forward = -origin.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let across = (0.5 * fov_x_deg).to_radians().tan();
    let [width, height] = SIZE.map(f64::from);
    let mut all = Vec::new();
    for row in 0..SIZE[1] {
        for column in 0..SIZE[0] {
            let (u, v) = ((f64::from(column) + 0.5) / width, (f64::from(row) + 0.5) / height);
            let dir = (forward + right * across * (2.0 * u - 1.0) - up * across * height / width * (2.0 * v - 1.0))
                .normalize();
            let (start, steps) = (origin.length() - 1.0, 4000);
            let step = 2.0 / f64::from(steps);
            let depth: f64 =
                (0..steps).map(|i| value_at(grid, origin + dir * (start + (f64::from(i) + 0.5) * step)) * step).sum();
            all.push((-scale * depth).exp());
        }
    }
    all
}

const CUBE: &str = r#""box": [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]]"#;

/// A ball of Gaussian profile, on a grid with another number of voxels on each side.
fn ball() -> VoxelGrid {
    let size = [20, 12, 28];
    grid(size, |at| {
        let p = [0, 1, 2].map(|axis| (at[axis] as f32 + 0.5) / size[axis] as f32 - 0.5);
        (-(p[0] * p[0] + (p[1] + 0.1) * (p[1] + 0.1) + (p[2] - 0.1) * (p[2] - 0.1)) / (2.0 * 0.15 * 0.15)).exp()
    })
}

/// Scattered voxels, most of them empty.
fn scraps() -> VoxelGrid {
    let random = std::cell::RefCell::new(Random::new(17));
    grid([14, 13, 15], |_| {
        let draw = random.borrow_mut().between(0.0, 1.0);
        if draw > 0.85 { draw } else { 0.0 }
    })
}

#[test]
fn a_grid_lets_through_what_quadrature_says() {
    let origin = DVec3::new(1.2, 0.7, 1.9);
    for (name, grid, scale) in [("ball", ball(), 9.0), ("scraps", scraps(), 8.0)] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let camera = r#""camera": {"origin": [1.2, 0.7, 1.9], "target": [0, 0, 0], "fov_x_deg": 28}"#;
        let light = r#""sky_radiance": 1"#;
        let scene = scene(folder.path(), &grid, &format!(r#"{CUBE}, "extinction_scale": {scale}, {light}, {camera}"#));
        let expected = transmittances(&grid, scale, origin, 28.0);
        let dark = expected.iter().filter(|through| **through < 0.5).count();
        assert!(dark > 30 && dark < expected.len() - 30, "{name}: {dark} rays meet much");
        let march = converged(&scene, 1e-4).clouds;
        let paths = traced(&scene, 64, Some(1));
        let (mut wrong, mut squares, mut judged) = (0.0_f64, 0.0_f64, 0);
        for ((march, expected), (path, variance)) in
            march.iter().zip(&expected).zip(paths.clouds.iter().zip(&paths.variance))
        {
            wrong = wrong.max((f64::from(march[3]) - expected).abs());
            // Where one path of 64 that meets cloud, or does not, is nothing unusual.
            if (0.05..0.95).contains(expected) {
                let spread = f64::from(variance[3]).max(expected * (1.0 - expected) / 64.0);
                squares += (f64::from(path[3]) - expected).powi(2) / spread;
                judged += 1;
            }
        }
        assert!(wrong < 2e-3, "{name}: the march is off by {wrong}");
        let chi = squares / f64::from(judged);
        assert!(judged > 60 && chi < 1.25, "{name}: {judged} pixels are off by {chi} times their variance");
    }
}

#[test]
fn a_full_grid_scatters_once_as_its_closed_form_says() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // A plate ten times as wide as high, seen and lit from above.
    let scene = scene(
        folder.path(),
        &grid([5, 2, 3], |_| 0.5),
        r#""box": [[-5, 2, -5], [5, 3, 5]], "extinction_scale": 3, "albedo": 0.8,
           "sun": {"irradiance": [2, 4, 8], "towards": [0, 1, 0]},
           "camera": {"origin": [0, 9, 0], "target": [0, 2, 0], "up": [0, 0, -1], "fov_x_deg": 1}"#,
    );
    // The optical depth is 1.5, and light crosses it twice.
    let expected = 0.8 * ISOTROPIC * -(-2.0 * 1.5_f64).exp_m1() / 2.0;
    let mean = |pixels: &[[f32; 4]], channel: usize| {
        pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / pixels.len() as f64
    };
    let (march, paths) = (converged(&scene, 1e-4), traced(&scene, 2048, Some(1)));
    for (channel, irradiance) in [2.0, 4.0, 8.0].into_iter().enumerate() {
        let seen = mean(&march.image.rgba, channel) / irradiance;
        assert!((seen / expected - 1.0).abs() < 1e-3, "march, channel {channel}: {seen} instead of {expected}");
        let seen = mean(&paths.image.rgba, channel) / irradiance;
        assert!((seen / expected - 1.0).abs() < 4e-3, "paths, channel {channel}: {seen} instead of {expected}");
    }
}

#[test]
fn a_grid_in_a_furnace_cannot_be_seen() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (grid, phase) in [(ball(), r#"{"kind": "HenyeyGreenstein", "g": 0.8}"#), (scraps(), r#"{"kind": "Rayleigh"}"#)]
    {
        let scene = scene(
            folder.path(),
            &grid,
            &format!(
                r#"{CUBE}, "extinction_scale": 12, "phase": {phase}, "sky_radiance": 1,
                   "camera": {{"origin": [0, 0, 2], "target": [0, 0, 0], "fov_x_deg": 40}}"#
            ),
        );
        let picture = traced(&scene, 32, None);
        let worst = picture.image.rgba.iter().map(|pixel| (pixel[1] - 1.0).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-3, "{phase}: off 1 by {worst}");
    }
}

/// A sky in a box that three models fill.
fn boxed() -> Scene {
    let mut scene = Scene::default();
    scene.domain.kind = DomainKind::Box;
    scene.plain_light.enabled = true;
    scene.weather.coverage = 0.6;
    (scene.camera.south_m, scene.camera.height_m, scene.camera.pitch_deg) = (4000.0, 2000.0, 0.0);
    scene
}

#[test]
fn baked_clouds_look_like_the_clouds_they_were_baked_from() {
    let mut scene = boxed();
    // Nothing finer than the voxels of the larger grid.
    (scene.layers[0].detail_strength, scene.layers[0].shape_size_m) = (0.0, 8000.0);
    let at = |voxels: u32| {
        let quality = Quality { grid_voxels: voxels, ..quick() };
        truth(&scene, &quality, Goal::Converged { tolerance: 3e-3, levels: 5 }, Output::Linear).0.image.rgba
    };
    let plain = at(0);
    let off = |baked: &[[f32; 4]]| {
        let pairs = plain.iter().zip(baked);
        (pairs.map(|(a, b)| (a[1] - b[1]).powi(2)).sum::<f32>() / plain.len() as f32).sqrt()
    };
    let (coarse, fine) = (off(&at(16)), off(&at(192)));
    let mean = plain.iter().map(|pixel| pixel[1]).sum::<f32>() / plain.len() as f32;
    assert!(fine < 0.02 * mean && fine < 0.4 * coarse, "of {mean}: 16 voxels are {coarse} off, 192 are {fine}");
}

#[test]
fn voxels_baked_from_voxels_are_the_same() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let random = std::cell::RefCell::new(Random::new(3));
    let before = grid([16, 8, 16], |_| random.borrow_mut().between(0.0, 2.0));
    let scene = scene(folder.path(), &before, r#""box": [[-1, -1, -1], [1, 0, 1]], "extinction_scale": 3"#);
    let quality = Quality { grid_voxels: 16, ..quick() };
    let baked = renderer().bake_extinction(&frame(&scene, &quality, SIZE, Output::Linear)).expect("it can be baked");
    let (after, bounds) = baked.expect("there is cloud");
    assert_eq!(after.size(), before.size());
    let metres = (bounds[1][0] - bounds[0][0]) / 2.0;
    for (after, before) in after.values().iter().zip(before.values()) {
        assert!((after * metres - 3.0 * before).abs() < 2e-5, "{} instead of {}", after * metres, 3.0 * before);
    }
}

#[test]
fn plain_light_makes_no_air_and_a_grid_reads_no_map() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = scene(folder.path(), &ball(), CUBE);
    let mut fresh = nephoscope::render::Renderer::new(crate::common::gpu()).expect("it fits");
    let before = fresh.memory_bytes();
    let quality = quick();
    let shown = Frame { size: [1, 1], ..frame(&scene, &quality, SIZE, Output::Display) };
    let report = fresh.render(&shown).expect("it can be rendered");
    let ran: Vec<&str> = report.passes.iter().map(|pass| pass.pass).collect();
    assert_eq!(ran, ["background", "march", "tonemap"], "and nothing else");
    let voxels = 4 * ball().values().len() as u64;
    let held = fresh.memory_bytes() - before;
    assert!((voxels..voxels + 256).contains(&held), "{held} bytes for {voxels} of voxels and a picture of one pixel");
}

#[test]
fn a_tilted_picture_is_the_upright_one_turned() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |up: &str| {
        let camera = format!(r#""camera": {{"origin": [0, 0, 2], "target": [0, 0, 0], "fov_x_deg": 40, "up": {up}}}"#);
        let sun = r#""sun": {"irradiance": 3, "towards": [1, 2, 3]}"#;
        let scene = scene(folder.path(), &ball(), &format!(r#"{CUBE}, "extinction_scale": 12, {sun}, {camera}"#));
        // The march's offsets belong to pixels; without them a ray sees the same wherever its pixel lies.
        converged(&scene, 1e-3).clouds
    };
    let (upright, upside_down) = (at("[0, 1, 0]"), at("[0, -1, 0]"));
    let turned: Vec<[f32; 4]> = upside_down.iter().rev().copied().collect();
    let off = upright.iter().zip(&turned).map(|(a, b)| Vec3::new(a[0] - b[0], a[3] - b[3], 0.0).length());
    let worst = off.fold(0.0, f32::max);
    let lit = upright.iter().map(|pixel| pixel[0]).fold(0.0, f32::max);
    assert!(lit > 0.05 && worst < 2e-3, "{worst} of {lit}");
    let straight: f32 = upright.iter().zip(&upside_down).map(|(a, b)| (a[3] - b[3]).abs()).fold(0.0, f32::max);
    assert!(straight > 0.05, "unturned they differ: {straight}");
}

#[test]
fn a_grid_among_other_layers_stays_under_its_majorant() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let light = r#""sky_radiance": 1, "camera": {"origin": [0, 0, 2.5], "target": [0, 0, 0], "fov_x_deg": 30}"#;
    // Full in the lowest of its cells alone, which are eight voxels high.
    let lower = grid([32, 32, 32], |at| if at[1] < 6 { 1.0 } else { 0.0 });
    let mut scene = scene(folder.path(), &lower, &format!(r#"{CUBE}, "extinction_scale": 8, {light}"#));
    // Haze from below the grid to above it.
    let grid = scene.layers[0].clone();
    scene.layers.push(CloudLayer {
        model: DensityModel::Uniform,
        base_m: grid.base_m - 400.0,
        top_m: grid.top_m + 700.0,
        scattering_per_m: 0.0005,
        lean_m: 0.0,
        ..CloudLayer::default()
    });
    scene.weather.coverage = 1.0;
    for order in 0..2 {
        let march = converged(&scene, 1e-3).clouds;
        let paths = traced(&scene, 128, Some(1)).clouds;
        let mean = |pixels: &[[f32; 4]]| pixels.iter().map(|pixel| pixel[3]).sum::<f32>() / pixels.len() as f32;
        let (march, paths) = (mean(&march), mean(&paths));
        assert!((march - paths).abs() < 0.01, "order {order}: {march} passes the march, {paths} the paths");
        scene.layers.reverse();
    }
}

#[test]
fn a_file_that_has_changed_is_read_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let camera = r#""camera": {"origin": [0, 0, 2], "target": [0, 0, 0], "fov_x_deg": 20}"#;
    let description = format!(r#"{CUBE}, "extinction_scale": 5, {camera}"#);
    let at = |size: [u32; 3]| {
        let half = grid(size, |at| if at[0] < size[0] / 2 { 1.0 } else { 0.0 });
        let scene = scene(folder.path(), &half, &description);
        let mut renderer = renderer();
        let quality = quick();
        renderer.render(&frame(&scene, &quality, SIZE, Output::Linear)).expect("it can be rendered");
        renderer.clouds().expect("it can be read")
    };
    let (coarse, fine) = (at([2, 2, 2]), at([32, 2, 2]));
    let differ = coarse.iter().zip(&fine).filter(|(a, b)| (a[3] - b[3]).abs() > 0.05).count();
    assert!(differ > 20, "the edge is sharper: {differ} pixels differ");
}
