//! What is lost, and what is not, when the device fails.

use nephoscope::files::KeptPrograms;
use nephoscope::gpu::{Gpu, Texture, readback};
use nephoscope::render::{LinearImage, Renderer};
use nephoscope::scene::{MapSource, Output, Scene};

use crate::common::field::run;
use crate::common::gpu;
use crate::common::sky::{frame, quick, renderer};

fn light(renderer: &mut Renderer, scene: &Scene) -> Result<LinearImage, Box<dyn std::error::Error>> {
    renderer.render(&frame(scene, &quick(), [32, 18], Output::Linear))?;
    Ok(renderer.linear()?)
}

#[test]
fn a_lost_device_is_an_error_and_another_one_shows_the_same_picture() {
    let scene = Scene::default();
    let expected = light(&mut renderer(), &scene).unwrap_or_else(|error| panic!("{error}"));
    let lost = Gpu::software().expect("llvmpipe is installed");
    let mut broken = Renderer::new(&lost).unwrap_or_else(|error| panic!("{error}"));
    light(&mut broken, &scene).unwrap_or_else(|error| panic!("{error}"));
    lost.device.destroy();
    for _ in 0..2 {
        let error = light(&mut broken, &scene).expect_err("nothing can be drawn");
        assert!(!error.to_string().is_empty(), "and it says why");
    }
    drop(broken);
    let fresh = Gpu::software().expect("a device is opened again");
    let mut fresh = Renderer::new(&fresh).unwrap_or_else(|error| panic!("{error}"));
    let seen = light(&mut fresh, &scene).unwrap_or_else(|error| panic!("{error}"));
    assert!(seen.rgba == expected.rgba, "everything is made anew from the scene");
}

#[test]
fn kept_programs_draw_the_same_picture_whatever_is_in_their_file() {
    let scene = Scene::default();
    let expected = light(&mut renderer(), &scene).unwrap_or_else(|error| panic!("{error}"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    for junk in [None, Some(&b""[..]), Some(&[0xA5; 5000][..])] {
        let device = Gpu::software().expect("llvmpipe is installed");
        let mut kept = KeptPrograms::begin_in(folder.path(), &device).expect("Vulkan has pipeline caches");
        let mut fresh = Renderer::new(&device).unwrap_or_else(|error| panic!("{error}"));
        let seen = light(&mut fresh, &scene).unwrap_or_else(|error| panic!("{error}"));
        assert!(seen.rgba == expected.rgba, "the same picture");
        let is_written = kept.keep(&device);
        assert!(!is_written || kept.path().exists(), "a file of its own");
        assert!(!kept.keep(&device), "nothing was compiled since");
        if let Some(junk) = junk {
            std::fs::write(kept.path(), junk).expect("the folder is ours");
        }
    }
}

#[test]
fn a_picture_that_no_device_holds_is_refused_and_the_next_one_is_drawn() {
    let (scene, quality) = (Scene::default(), quick());
    let mut renderer = renderer();
    let too_wide = renderer.render(&frame(&scene, &quality, [200_000, 4], Output::Display));
    let error = too_wide.expect_err("no device is that wide").to_string();
    assert!(error.contains("200000") && error.contains("at most"), "{error}");
    light(&mut renderer, &scene).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn what_a_refused_picture_was_to_make_is_made_for_the_next() {
    let scene = Scene::default();
    let expected = light(&mut renderer(), &scene).unwrap_or_else(|error| panic!("{error}"));
    let mut nowhere = Scene::default();
    nowhere.weather.layers[0].source = MapSource::Image;
    nowhere.weather.layers[0].image.0 = "/nowhere/map.png".to_owned();
    for (refused, size) in [(&scene, [200_000, 4]), (&nowhere, [32, 18])] {
        // It has no tables yet, which the refused picture needs first.
        let mut fresh = Renderer::new(gpu()).unwrap_or_else(|error| panic!("{error}"));
        fresh.render(&frame(refused, &quick(), size, Output::Linear)).expect_err("it is refused");
        let seen = light(&mut fresh, &scene).unwrap_or_else(|error| panic!("{error}"));
        assert!(seen.rgba == expected.rgba, "as if nothing had been refused");
    }
}

#[test]
fn the_watch_counts_what_is_not_finite_and_finds_nothing_in_a_sound_frame() {
    let values = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 0.0, -1.0, 1e-40, 65504.0];
    let size = [4, 2];
    let texture = Texture::new_2d(gpu(), "watched", size, wgpu::TextureFormat::R32Float).expect("it fits");
    gpu().queue.write_texture(
        texture.texture.as_image_copy(),
        bytemuck::cast_slice(&values),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16), rows_per_image: None },
        texture.texture.size(),
    );
    let counters = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("counters"),
        size: 16,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let bound = vec![
        ("watched", wgpu::BindingResource::TextureView(&texture.view)),
        ("counters", counters.as_entire_binding()),
    ];
    run(&nephoscope::gpu::ProgramKey::plain("pass/watch.wgsl"), &bound, [4, 2, 1]);
    let bytes = readback::buffer(gpu(), &counters).expect("it can be read");
    assert_eq!(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]), 3, "NaN and both infinities");

    let mut renderer = renderer();
    light(&mut renderer, &Scene::default()).unwrap_or_else(|error| panic!("{error}"));
    let broken = renderer.find_broken().unwrap_or_else(|error| panic!("{error}"));
    assert!(broken.is_empty(), "{broken:?}");
}

#[test]
fn what_was_made_for_clouds_is_kept_while_nobody_looks_at_them() {
    let mut renderer = renderer();
    let mut passes_at = |pitch_deg: f32, cloud_shadows: f32| -> Vec<&'static str> {
        let mut scene = Scene::default();
        (scene.camera.pitch_deg, scene.ground.cloud_shadows) = (pitch_deg, cloud_shadows);
        let quality = quick();
        let report = renderer.render(&frame(&scene, &quality, [32, 18], Output::Linear));
        report.unwrap_or_else(|error| panic!("{error}")).passes.iter().map(|time| time.pass).collect()
    };
    passes_at(14.0, 1.0);
    for cloud_shadows in [1.0, 0.0] {
        assert!(!passes_at(-80.0, cloud_shadows).contains(&"march"), "the view misses the clouds");
        let again = passes_at(14.0, cloud_shadows);
        let made: Vec<&&str> = again
            .iter()
            .filter(|pass| pass.starts_with("bake") || pass.starts_with("clear") || **pass == "weather_map")
            .collect();
        assert!(again.contains(&"march") && made.is_empty(), "made anew: {made:?}");
    }
}
