use super::super::random::randomise;
use super::*;

fn refused(text: &str) -> String {
    Preset::from_ron(text, "x.ron").expect_err(text).to_string()
}

#[test]
fn a_preset_says_only_what_differs() {
    let mut preset = Preset::new("Mist \"over\" Föhr\n", Scene::default());
    assert_eq!(preset.to_ron(), "(\n    version: 2,\n    name: \"Mist \\\"over\\\" Föhr\\n\",\n    scene: (),\n)\n");
    preset.tags = vec!["a".to_owned(), "b".to_owned()];
    preset.quality = Some(QualityLevel::High);
    preset.scene.layers[0].base_m = 900.0;
    preset.scene.layers.push(super::super::CloudLayer::default());
    let text = preset.to_ron();
    assert!(text.contains("    quality: High,\n"), "{text}");
    assert!(text.contains("        layers: [\n            (\n                base_m: 900.0,\n            ),\n            (),\n        ],\n"), "{text}");
    assert_eq!(Preset::from_ron(&text, "x.ron"), Ok(preset));
}

#[test]
fn any_scene_and_any_quality_come_back_bit_for_bit() {
    for seed in 0..200 {
        let mut preset = Preset::default();
        randomise(&mut preset.scene, seed);
        preset.scene.mend();
        assert_eq!(Preset::from_ron(&preset.to_ron(), "x.ron"), Ok(preset), "seed {seed}");
        let mut quality = Quality::default();
        randomise(&mut quality, seed);
        assert_eq!(quality_from_ron(&quality_to_ron(&quality), "q.ron"), Ok(quality), "seed {seed}");
    }
}

#[test]
fn an_empty_list_comes_back_empty() {
    let mut preset = Preset::default();
    preset.scene.layers.clear();
    assert_eq!(Preset::from_ron(&preset.to_ron(), "x.ron"), Ok(preset));
}

#[test]
fn values_out_of_range_are_named_with_place_and_range() {
    let text = "(\n  version: 2,\n  scene: (layers: [(),\n    (base_m: -5, top_m: 900)]),\n)";
    assert_eq!(refused(text), "x.ron:4:14: layers.1.base_m = -5 m is outside 0 m ..= 15000 m");
    for (value, words) in [
        ("NaN", "is not a finite number; allowed are 0 m ..= 15000 m"),
        ("-inf", "is not a finite number"),
        ("1e60", "is not a finite number"),
        ("\"5\"", "layers.0.base_m is a string, but must be a number"),
        ("true", "layers.0.base_m is `true`, but must be a number"),
        ("[1]", "layers.0.base_m is a list, but must be a number"),
    ] {
        let message = refused(&format!("(version: 2, scene: (layers: [(base_m: {value})]))"));
        assert!(message.starts_with("x.ron:1:40: layers.0.base_m ") && message.contains(words), "{message}");
    }
}

#[test]
fn every_kind_of_wrong_is_told_apart() {
    for (text, words) in [
        (
            "(version: 2, scene: (sun: (elevation: 5)))",
            "1:28: there is no parameter sun.elevation; did you mean elevation_deg?",
        ),
        ("(version: 2, nam: \"x\")", "1:14: there is no parameter nam; did you mean name?"),
        ("(version: 2, scene: (weather: 5))", "weather is `5`, but must be a group"),
        ("(version: 2, scene: (layers: ()))", "layers is a group of fields, but must be a list"),
        (
            "(version: 2, scene: (layers: [(model: Nice)]))",
            "layers.0.model is `Nice`, but must be one of Profile, Thesis",
        ),
        ("(version: 2, scene: (sun: (disc: 1)))", "sun.disc is `1`, but must be true or false"),
        ("(version: 2, scene: (sun: (day: 2.5)))", "sun.day is `2.5`, but must be a whole number"),
        ("(version: 2, scene: (sun: (colour: 1)))", "sun.colour is `1`, but must be a colour"),
        ("(version: 2, scene: (sun: (colour: (1, 2, NaN))))", "is not a finite number"),
        (
            "(version: 2, scene: (weather: (layers: [(image: 5)])))",
            "weather.layers.0.image is `5`, but must be a file name",
        ),
        ("(version: 2, quality: Best)", "quality is `Best`, but must be one of Draft, Preview, High, Final"),
        ("(version: 2, tags: [1])", "tags is `1`, but must be a list of strings"),
        ("(version: 2, name: 5)", "name is `5`, but must be a string"),
        ("(version: 2, scene: (sun: (day: 5, day: 6)))", "day"),
        ("(version: 3)", "1:11: version 3 is newer than this program, which knows 1 to 2"),
        ("(version: 0)", "version is 0, but must be 1 to 2"),
        ("(scene: ())", "the file has no version; write `version: 2` first"),
        ("(version: 2", "expected `,` or `)`, found the end of the file"),
        ("", "expected a value"),
    ] {
        let message = refused(text);
        assert!(message.contains(words) && message.starts_with("x.ron:1:"), "{text}: {message}");
    }
}

#[test]
fn rules_between_fields_point_at_the_field() {
    let message = refused("(version: 2, scene: (layers: [(),\n (base_m: 900, top_m: 800)]))");
    assert!(message.starts_with("x.ron:2:23: layers.1.top_m = 800 m lies below"), "{message}");
    let message = refused("(version: 2, scene: (layers: [(),(),(),(),()]))");
    assert!(message.starts_with("x.ron:1:30: layers: 5 cloud layers"), "{message}");
}

#[test]
fn quality_files_are_checked_alike() {
    let message = quality_from_ron("(version: 2, quality: (view_steps: 2))", "q.ron").expect_err("too few");
    assert_eq!(message.to_string(), "q.ron:1:36: view_steps = 2 is outside 4 ..= 1024");
    let message = quality_from_ron("(version: 2, quality: (steps: 2))", "q.ron").expect_err("unknown");
    assert!(message.to_string().contains("view_steps"), "{message}");
}

#[test]
fn errors_in_old_files_stand_where_the_old_text_stands() {
    let message = refused("(version: 1, scene: (layers: [(bottom_m: -1)]))");
    assert_eq!(message, "x.ron:1:42: layers.0.base_m = -1 m is outside 0 m ..= 15000 m");
}

/// Files as version 1 wrote them, and what they must mean for ever.
#[test]
fn files_of_version_1_load() {
    let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/presets_v1"));
    let load = |name: &str| {
        let text = std::fs::read_to_string(folder.join(name)).expect(name);
        Preset::from_ron(&text, name).unwrap_or_else(|error| panic!("{error}"))
    };
    let mut expected = Preset::new("Two sheets", Scene::default());
    expected.description = "A low deck under a thin high one.".to_owned();
    expected.tags = vec!["fixture".to_owned()];
    expected.quality = Some(QualityLevel::Draft);
    let scene = &mut expected.scene;
    scene.layers[0].base_m = 700.0;
    scene.layers[0].top_m = 1300.0;
    scene.layers.push(super::super::CloudLayer { base_m: 3200.0, top_m: 3600.0, density: 0.4, ..Default::default() });
    scene.weather.coverage = 0.85;
    scene.camera.height_m = 150.0;
    assert_eq!(load("two_sheets.ron"), expected);

    let mut expected = Preset::new("From the old summit", Scene::default());
    expected.scene.camera.height_m = 2963.0;
    expected.scene.weather.coverage = 0.125;
    expected.scene.sun.elevation_deg = 7.5;
    assert_eq!(load("summit.ron"), expected);
}

#[test]
fn damaged_text_is_refused_without_a_panic() {
    let text = super::super::builtin::BUILTINS[0].ron;
    for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)) {
        let refused = Preset::from_ron(&text[..end], "x.ron");
        assert!(refused.is_err() || text[end..].trim().is_empty(), "cut at {end}");
    }
    for at in 0..text.len() {
        for other in [b'(', b')', b'"', b',', b'9', b'r', b'/', b'\n', b'-'] {
            let mut bytes = text.as_bytes().to_vec();
            bytes[at] = other;
            if let Ok(text) = std::str::from_utf8(&bytes) {
                // Either outcome is right, as long as there is one.
                let _ = Preset::from_ron(text, "x.ron");
            }
        }
    }
}

#[test]
fn every_text_comes_back() {
    let text = "\u{1}\u{7f}\u{85}\u{2028}\u{feff}\\'\"\n\r\t\0 雲 {}() // /* */";
    let preset = Preset { description: text.to_owned(), tags: vec![text.to_owned()], ..Preset::default() };
    assert_eq!(Preset::from_ron(&preset.to_ron(), "x.ron"), Ok(preset));
}

#[test]
fn kept_cameras_come_back_and_faulty_ones_are_named() {
    let mut preset = Preset::new("Seen from", Scene::default());
    preset.cameras = vec![
        Bookmark { name: "The \"hill\"".to_owned(), camera: Camera { height_m: 300.0, ..Camera::default() } },
        Bookmark { name: String::new(), camera: Camera::default() },
    ];
    let text = preset.to_ron();
    let read = Preset::from_ron(&text, "seen.ron").expect("it was just written");
    assert_eq!((&read, read.to_ron()), (&preset, text.clone()));
    for (from, to, says) in [
        ("300.0", "-300.0", "height_m"),
        ("height_m", "hight_m", "height_m"),
        ("300.0", "high", "a number"),
        ("name:", "title:", "title"),
    ] {
        let broken = text.replacen(from, to, 1);
        let broken = if from == "name:" { text.replace("(name:", "(title:") } else { broken };
        let error = Preset::from_ron(&broken, "seen.ron").expect_err(says).to_string();
        assert!(error.starts_with("seen.ron:") && error.contains(says), "{from}: {error}");
    }
    for (cameras, says) in [("3", "cameras is `3`"), ("[7]", "cameras is `7`")] {
        let broken = format!("(version: 2, cameras: {cameras})");
        let error = Preset::from_ron(&broken, "seen.ron").expect_err(says).to_string();
        assert!(error.starts_with("seen.ron:1:") && error.contains(says), "{error}");
    }
    preset.cameras = vec![Bookmark::default(); 10];
    let error = Preset::from_ron(&preset.to_ron(), "many.ron").expect_err("ten").to_string();
    assert!(error.contains("at most 9"), "{error}");
}
