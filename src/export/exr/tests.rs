use super::*;
use crate::images::map::read_exr;

/// A small picture with values that half and float treat differently.
fn picture() -> FloatImage {
    let rgba = (0..5 * 3_u8).map(|i| [f32::from(i) / 7.0, 1.0e-6, 60000.0 - f32::from(i), 1.0]).collect();
    let depth = (0..5 * 3_u8).map(|i| 20000.0 + f32::from(i) / 3.0).collect();
    FloatImage { width: 5, height: 3, rgba, depth: Some(depth), crop: None }
}

fn write(image: &FloatImage, options: ExrOptions) -> (tempfile::TempDir, Result<ExrDepth, ExportError>) {
    let folder = tempfile::tempdir().unwrap();
    let written = write_exr(&folder.path().join("sky.exr"), image, &ExrMetadata::default(), options);
    (folder, written)
}

#[test]
fn floats_come_back_bit_for_bit_with_every_codec() {
    for compression in [ExrCompression::Zip, ExrCompression::Zips, ExrCompression::Piz, ExrCompression::None] {
        let (folder, written) = write(&picture(), ExrOptions { depth: ExrDepth::Float, compression });
        assert_eq!(written.unwrap(), ExrDepth::Float);
        assert_eq!(read_exr(&folder.path().join("sky.exr")).unwrap(), picture(), "{compression:?}");
    }
}

#[test]
fn dwaa_loses_little_light_and_no_data() {
    let size = 64_u16;
    let smooth = |x: u16, y: u16| 0.5 + 0.4 * (f32::from(x) * 0.1).sin() * (f32::from(y) * 0.07).cos();
    let places = || (0..size).flat_map(|y| (0..size).map(move |x| (x, y)));
    let rgba = places().map(|(x, y)| [smooth(x, y), smooth(y, x), 2.0 * smooth(x, y), f32::from(x) / 64.0]).collect();
    let depth = places().map(|(x, y)| 20_000.0 + f32::from(x) / 3.0 + f32::from(y)).collect();
    let side = u32::from(size);
    let image = FloatImage { width: side, height: side, rgba, depth: Some(depth), crop: None };
    let options = ExrOptions { compression: ExrCompression::Dwaa, depth: ExrDepth::Half };
    let (folder, written) = write(&image, options);
    written.expect("written");
    let back = read_exr(&folder.path().join("sky.exr")).expect("read");
    assert_eq!(back.depth, image.depth, "distances are data");
    for (seen, expected) in back.rgba.iter().zip(&image.rgba) {
        assert!(seen.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.02), "{seen:?}, not {expected:?}");
        assert_eq!(seen[3], f16::from_f32(expected[3]).to_f32(), "opacity is lossless");
    }
}

#[test]
fn half_rounds_colour_and_keeps_depth() {
    let (folder, written) = write(&picture(), ExrOptions::default());
    assert_eq!(written.unwrap(), ExrDepth::Half, "everything here fits into half");
    let back = read_exr(&folder.path().join("sky.exr")).unwrap();
    let rounded: Vec<_> = picture().rgba.iter().map(|pixel| pixel.map(|value| f16::from_f32(value).to_f32())).collect();
    assert_eq!(back.rgba, rounded);
    assert_eq!(back.depth, picture().depth);
}

#[test]
fn a_sun_beyond_half_makes_the_file_float() {
    let mut image = picture();
    image.rgba[7][1] = -70000.0;
    assert_eq!(write(&image, ExrOptions::default()).1.unwrap(), ExrDepth::Float);
    let (folder, forced) = write(&image, ExrOptions { depth: ExrDepth::Half, ..Default::default() });
    assert!(matches!(forced, Err(ExportError::BeyondHalf { x: 2, y: 1, .. })), "{forced:?}");
    assert!(!folder.path().join("sky.exr").exists(), "a refused picture must leave no file");
    image.rgba[7][1] = 65504.0;
    assert_eq!(write(&image, ExrOptions::default()).1.unwrap(), ExrDepth::Half);
}

#[test]
fn pixels_that_are_not_finite_are_refused_and_counted() {
    let mut image = picture();
    image.rgba[6][2] = f32::NAN;
    image.rgba[9] = [f32::INFINITY; 4];
    let (folder, written) = write(&image, ExrOptions::default());
    let expected = matches!(written, Err(ExportError::NonFinite { count: 2, x: 1, y: 1, channel: 'B', .. }));
    assert!(expected, "{written:?}");
    assert!(!folder.path().join("sky.exr").exists(), "a refused picture must leave no file");

    let mut image = picture();
    image.depth = Some(vec![f32::INFINITY; 15]);
    let (_folder, written) = write(&image, ExrOptions::default());
    assert!(matches!(written, Err(ExportError::NonFinite { count: 15, channel: 'Z', .. })), "{written:?}");
}

#[test]
fn a_crop_becomes_the_data_window() {
    let crop = Some(Crop { x: 10, y: 4, full_width: 32, full_height: 18 });
    let image = FloatImage { crop, ..picture() };
    let (folder, written) = write(&image, ExrOptions { depth: ExrDepth::Float, ..Default::default() });
    written.unwrap();
    assert_eq!(read_exr(&folder.path().join("sky.exr")).unwrap(), image);
    let outside = FloatImage { crop: Some(Crop { x: 28, y: 4, full_width: 32, full_height: 18 }), ..picture() };
    assert!(matches!(write(&outside, ExrOptions::default()).1, Err(ExportError::BadImage { .. })));
}

#[test]
fn arrays_of_the_wrong_length_are_refused() {
    let bad = [
        FloatImage { width: 4, ..picture() },
        FloatImage { depth: Some(vec![0.0; 3]), ..picture() },
        FloatImage { width: 0, rgba: Vec::new(), depth: None, ..picture() },
    ];
    for image in bad {
        assert!(matches!(write(&image, ExrOptions::default()).1, Err(ExportError::BadImage { .. })));
    }
}

#[test]
fn standard_attributes_are_written_where_others_look() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.exr");
    let rows: [[f32; 4]; 4] = std::array::from_fn(|row| std::array::from_fn(|column| (4 * row + column) as f32));
    let metadata = ExrMetadata {
        comments: "Föhn".into(),
        cap_date: "2026:11:22 18:30:00".into(),
        candela_per_unit: 1234.5,
        world_to_camera: Some(rows),
        extra: vec![("adapter".into(), "llvmpipe".into())],
        ..Default::default()
    };
    write_exr(&path, &picture(), &metadata, ExrOptions::default()).unwrap();
    let header = ::exr::meta::MetaData::read_from_file(&path, true).unwrap().headers.remove(0);
    let names: Vec<_> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    assert_eq!(names, ["A", "B", "G", "R", "Z"]);
    let own = &header.own_attributes;
    assert_eq!(own.layer_name, None, "a name would prefix the channels in some viewers");
    assert_eq!(own.software_name, Some(text(&ExrMetadata::default().software)));
    assert_eq!(own.comments, Some(text("Föhn")));
    assert_eq!(own.capture_date, Some(text("2026:11:22 18:30:00")));
    assert_eq!(own.world_to_camera, Some(std::array::from_fn(|index| index as f32)));
    assert_eq!(own.world_to_normalized_device, None);
    let custom = |name: &str| own.other.get(name.as_bytes()).cloned();
    assert_eq!(custom("colorInteropID"), Some(AttributeValue::Text(text("lin_rec709_scene"))));
    assert_eq!(custom(LUMINANCE_SCALE), Some(AttributeValue::F32(1234.5)));
    assert_eq!(custom("nephoscope:adapter"), Some(AttributeValue::Text(text("llvmpipe"))));
    assert_eq!(custom(PRESET), None);
}

#[test]
fn metadata_that_cannot_be_stored_is_named() {
    let twice = vec![("a".to_owned(), String::new()), ("a".to_owned(), String::new())];
    let mut not_finite = [[0.0; 4]; 4];
    not_finite[1][2] = f32::NAN;
    let bad = [
        (ExrMetadata { cap_date: "22.11.2026".into(), ..Default::default() }, "capDate"),
        (ExrMetadata { candela_per_unit: 0.0, ..Default::default() }, LUMINANCE_SCALE),
        (ExrMetadata { extra: twice, ..Default::default() }, "nephoscope:a"),
        (ExrMetadata { extra: vec![(String::new(), "x".into())], ..Default::default() }, PREFIX),
        (ExrMetadata { world_to_ndc: Some(not_finite), ..Default::default() }, "worldToNDC"),
        (ExrMetadata { files: vec![EmbeddedFile::new("", vec![1])], ..Default::default() }, SHA256_PREFIX),
        (ExrMetadata { preset_ron: "()".into(), preset_version: u32::MAX, ..Default::default() }, PRESET_VERSION),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (metadata, expected) in bad {
        let written = write_exr(&folder.path().join("sky.exr"), &picture(), &metadata, ExrOptions::default());
        let Err(ExportError::BadMetadata { name, .. }) = written else { panic!("{expected}: {written:?}") };
        assert_eq!(name, expected);
    }
}
