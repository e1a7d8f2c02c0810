use super::*;

/// Writes a grid of 4³ voxels with a description, and opens it.
fn opened(json: &str) -> Result<Preset, FileError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let grid = VoxelGrid::new([4, 4, 4], vec![0.25; 64]).expect("sound");
    let npy = folder.path().join("cloud.npy");
    grid.write_npy(&mut std::fs::File::create(npy).expect("made")).expect("written");
    let path = folder.path().join("cloud.json");
    std::fs::write(&path, json).expect("written");
    open(&path)
}

const CUBE: &str = r#"{
  "format": "nephoscope-grid 1", "values": "cloud.npy", "box": [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]],
  "extinction_scale": 8, "albedo": 0.75, "phase": {"kind": "HenyeyGreenstein", "g": 0.5},
  "sun": {"irradiance": [2, 1, 0.5], "towards": [0, 3, -3]}, "sky_radiance": 0.25,
  "camera": {"origin": [0, 0, 4], "target": [0, 0, 0], "fov_x_deg": 30}
}"#;

#[test]
fn a_unit_cube_finds_its_place() {
    let scene = opened(CUBE).expect("sound").scene;
    let layer = &scene.layers[0];
    assert_eq!((layer.base_m, layer.top_m), (1000.0, 2000.0), "a kilometre, above sea level");
    assert_eq!((scene.domain.box_width_m, scene.domain.box_east_m), (1000.0, 0.0));
    // Eight times a quarter, per kilometre.
    assert!((layer.extinction_per_m() - 0.002).abs() < 1e-9, "{}", layer.extinction_per_m());
    assert!((layer.scattering_per_m / layer.extinction_per_m() - 0.75).abs() < 1e-6, "albedo");
    assert_eq!((layer.phase.kind, layer.phase.g), (PhaseKind::HenyeyGreenstein, 0.5));
    assert!((scene.sun.elevation_deg - 45.0).abs() < 1e-4 && scene.sun.azimuth_deg.abs() < 1e-4, "north, half way up");
    assert_eq!((scene.plain_light.sun_irradiance, scene.plain_light.sun_colour), (2.0, Colour(1.0, 0.5, 0.25)));
    assert_eq!(scene.plain_light.sky_radiance, 0.25);
    let camera = &scene.camera;
    assert_eq!([camera.east_m, camera.height_m, camera.south_m], [0.0, 1500.0, 4000.0]);
    assert!(camera.axes()[0].abs_diff_eq(glam::Vec3::NEG_Z, 1e-6), "it looks at the middle");
    assert_eq!((camera.field_of_view_deg, camera.field_of_view_axis), (30.0, FieldOfViewAxis::Horizontal));
    assert!(edit::faults(&scene).is_empty() && scene.problems().is_empty(), "and can be saved");
}

#[test]
fn refusals_name_what_is_wrong() {
    for (from, to, wanted) in [
        ("grid 1", "grid 2", "its format is"),
        ("\"albedo\": 0.75", "\"albedo\": 1.5", "albedo = 1.5 is outside 0 ..= 1"),
        ("\"albedo\": 0.75", "\"albdo\": 0.75", "unknown field `albdo`"),
        ("\"extinction_scale\": 8", "\"extinction_scale\": -8", "extinction_scale = -8"),
        ("[0.5, 0.5, 0.5]", "[0.5, -0.5, 0.5]", "second corner"),
        (", \"box\": [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]]", "", "give box"),
        ("\"towards\": [0, 3, -3]", "\"towards\": [0, 0, 0]", "sun.towards"),
        ("\"sky_radiance\": 0.25", "\"sky_radiance\": -1", "sky_radiance = -1"),
        ("\"target\": [0, 0, 0]", "\"target\": [0, 0, 4]", "camera.target"),
        ("\"fov_x_deg\": 30", "\"fov_x_deg\": 30, \"up\": [0, 0, 2]", "camera.up"),
        ("\"fov_x_deg\": 30", "\"fov_x_deg\": 0", "camera.fov_x_deg = 0 is outside"),
        ("\"g\": 0.5", "\"g\": 1.5", "layers.0.phase.g"),
        ("\"albedo\"", "\"metres_per_unit\": 1e9, \"albedo\"", "metres_per_unit"),
        ("cloud.npy", "clod.npy", "no such file"),
        ("\"extinction_scale\"", "\"extinction_scale", "line "),
    ] {
        let json = CUBE.replacen(from, to, 1);
        assert_ne!(json, CUBE, "{from} is there to be replaced");
        let error = opened(&json).expect_err(to).to_string();
        assert!(error.contains(wanted), "{to}: {error}");
        assert!(error.contains("cloud.json") || error.contains("clod.npy"), "the file is named: {error}");
    }
}

#[test]
fn odd_boxes_are_scaled_until_they_fit() {
    let flat = CUBE.replacen("-0.5, -0.5, -0.5", "-0.5, 0.49, -0.5", 1);
    assert!((opened(&flat).expect("sound").scene.layers[0].top_m - 2000.0).abs() < 700.0, "a plate");
    let dense = CUBE.replacen("\"extinction_scale\": 8", "\"extinction_scale\": 20000", 1);
    let scene = opened(&dense).expect("sound").scene;
    let depth = scene.layers[0].extinction_per_m() * scene.domain.box_width_m;
    assert!((depth / 5000.0 - 1.0).abs() < 1e-5, "an optical depth of 5000 across: {depth}");
}

#[test]
fn what_is_saved_opens_as_it_was() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut preset = Preset::new("Box", Scene::default());
    preset.scene.domain.kind = DomainKind::Box;
    preset.scene.camera.roll_deg = 20.0;
    let grid = VoxelGrid::new([2, 1, 2], vec![0.0, 0.01, 0.02, 0.005]).expect("sound");
    let bounds = [[-4000.0, 1200.0, -12000.0], [4000.0, 2700.0, -4000.0]];
    let path = folder.path().join("box.json");
    let files = save_grid(&path, (&grid, bounds), &preset, (VoxelFormat::Both, [200, 100])).expect("written");
    assert_eq!(files.len(), 3, "{files:?}");
    let scene = open(&path).expect("sound").scene;
    let layer = &scene.layers[0];
    assert_eq!((layer.base_m, layer.top_m, scene.domain.box_south_m), (1200.0, 2700.0, -8000.0));
    assert!((layer.extinction_per_m() - 0.02).abs() < 1e-8, "{}", layer.extinction_per_m());
    let (there, back) = (preset.scene.camera.axes(), scene.camera.axes());
    assert!(there.iter().zip(back).all(|(a, b)| a.abs_diff_eq(b, 1e-5)), "{there:?} {back:?}");
    let (there, back) = (preset.scene.camera.half_tangents([200, 100]), scene.camera.half_tangents([200, 100]));
    assert!((there[1] - back[1]).abs() < 1e-5, "{there:?} {back:?}");
    assert!(preset.scene.towards_sun().abs_diff_eq(scene.towards_sun(), 1e-5), "the sun stays");
    std::fs::remove_file(path.with_extension("npy")).expect("it was there");
    let text = std::fs::read_to_string(&path).expect("read").replace("box.npy", "box.vol");
    std::fs::write(&path, text).expect("written");
    assert_eq!(open(&path).expect("sound").scene.layers[0].base_m, 1200.0, "from the other format as well");
}
