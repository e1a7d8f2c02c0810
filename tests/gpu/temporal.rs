//! Temporal reprojection: a still sky becomes the full picture bit for bit, edits start over, and poison heals.

use std::time::Duration;

use bytemuck::Zeroable as _;
use glam::{UVec2, Vec3};
use nephoscope::gpu::{ProgramKey, Texture, readback};
use nephoscope::plan::UpdatePattern;
use nephoscope::render::Renderer;
use nephoscope::render::truth::Goal;
use nephoscope::render::uniforms::scene::ViewUniforms;
use nephoscope::scene::{Frame, Output, Quality, Scene, UpdateFraction, UpdateOrder};

use crate::common::field::{image, run, scalars, view_of};
use crate::common::gpu;
use crate::common::sky::{frame, quick, render, renderer};

const PATTERNS: [(UpdateFraction, UpdateOrder); 5] = [
    (UpdateFraction::Half, UpdateOrder::Cross),
    (UpdateFraction::Quarter, UpdateOrder::Cross),
    (UpdateFraction::Sixteenth, UpdateOrder::Cross),
    (UpdateFraction::Sixteenth, UpdateOrder::Sevens),
    (UpdateFraction::Sixteenth, UpdateOrder::Naive),
];

fn updating(update: UpdateFraction, update_order: UpdateOrder) -> Quality {
    Quality { update, update_order, ..quick() }
}

fn show(renderer: &mut Renderer, scene: &Scene, quality: &Quality, size: [u32; 2]) -> Vec<[f32; 4]> {
    render(renderer, &frame(scene, quality, size, Output::Display));
    renderer.clouds().expect("they can be read")
}

fn bits(clouds: &[[f32; 4]]) -> Vec<[u32; 4]> {
    clouds.iter().map(|texel| texel.map(f32::to_bits)).collect()
}

/// A default sky with enough cloud in a small picture.
fn cloudy() -> Scene {
    let mut scene = Scene::default();
    scene.weather.coverage = 0.6;
    scene
}

#[test]
fn a_still_sky_is_after_one_cycle_the_full_picture_bit_for_bit() {
    let scene = cloudy();
    let mut renderer = renderer();
    for size in [[48, 27], [17, 33], [1, 7], [1, 1]] {
        let full = show(&mut renderer, &scene, &quick(), size);
        let covered = full.iter().filter(|texel| texel[3] < 0.5).count();
        assert!(size[1] < 20 || covered > full.len() / 10, "only {covered} pixels of {size:?} show cloud");
        for (update, order) in PATTERNS {
            let quality = updating(update, order);
            renderer.forget_history();
            let mut before = 0;
            for phase in 0..UpdatePattern::new(update, order).phases() {
                let clouds = show(&mut renderer, &scene, &quality, size);
                let same = clouds.iter().zip(&full).filter(|(a, b)| a == b).count();
                assert!(same >= before, "{update:?} {order:?} {size:?}: frame {phase} is worse than the one before");
                before = same;
            }
            let clouds = show(&mut renderer, &scene, &quality, size);
            assert_eq!(bits(&clouds), bits(&full), "{update:?} {order:?} {size:?}: one frame after the cycle");
            assert_eq!(before, full.len(), "{update:?} {order:?} {size:?}: pixels that are right after the cycle");
        }
    }
}

#[test]
fn the_first_frame_is_already_whole() {
    let scene = cloudy();
    let mut renderer = renderer();
    for size in [[64, 36], [17, 33], [1, 7]] {
        let full = show(&mut renderer, &scene, &quick(), size);
        for (update, order) in PATTERNS {
            renderer.forget_history();
            let first = show(&mut renderer, &scene, &updating(update, order), size);
            assert!(first.iter().all(|texel| *texel != [0.0; 4]), "{update:?} {size:?}: a pixel was left out");
            let error: f32 = first.iter().zip(&full).map(|(a, b)| (a[3] - b[3]).abs()).sum::<f32>() / full.len() as f32;
            assert!(error < 0.15 || size[0] < 4, "{update:?} {size:?}: transmittance differs by {error} on average");
        }
    }
}

#[test]
fn an_edit_starts_over_as_a_new_renderer_would() {
    let quality = updating(UpdateFraction::Sixteenth, UpdateOrder::Cross);
    let before = cloudy();
    let mut after = cloudy();
    after.weather.coverage = 0.3;
    after.sun.elevation_deg = 20.0;
    let size = [48, 27];
    let mut shared = renderer();
    for _ in 0..5 {
        show(&mut shared, &before, &quality, size);
    }
    let edited = show(&mut shared, &after, &quality, size);
    let mut fresh = Renderer::new(gpu()).expect("the sky tables fit");
    let expected = show(&mut fresh, &after, &quality, size);
    assert_eq!(bits(&edited), bits(&expected), "the first frame after the edit");
    let edited = show(&mut shared, &after, &quality, size);
    assert_eq!(bits(&edited), bits(&show(&mut fresh, &after, &quality, size)), "the second frame after the edit");
    assert!(bits(&edited) != bits(&show(&mut fresh, &before, &quality, size)), "the edit is to be seen");
}

#[test]
fn a_cut_of_camera_or_time_starts_over() {
    let quality = updating(UpdateFraction::Quarter, UpdateOrder::Cross);
    let scene = cloudy();
    let mut away = cloudy();
    away.camera.heading_deg = 150.0;
    let mut renderer = renderer();
    let size = [32, 18];
    let expected = bits(&show(&mut renderer, &away, &quality, size));
    renderer.forget_history();
    show(&mut renderer, &scene, &quality, size);
    assert_eq!(bits(&show(&mut renderer, &away, &quality, size)), expected, "turning round");
    let late = Frame { time_secs: 5000.0, ..frame(&away, &quality, size, Output::Display) };
    render(&mut renderer, &late);
    let jumped = bits(&renderer.clouds().expect("they can be read"));
    renderer.forget_history();
    render(&mut renderer, &late);
    assert_eq!(jumped, bits(&renderer.clouds().expect("they can be read")), "a leap in time");
}

const SIZE: [u32; 2] = [24, 20];
const POISON: [f32; 5] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -7.0];

/// Light and transmittance in the true picture of the temporal pass's own test.
fn truth(x: u32, y: u32) -> [f32; 4] {
    let wave = 0.5 + 0.4 * (x as f32 * 0.7).sin() * (y as f32 * 0.5).cos();
    [wave, 0.5 * wave, 0.25 * wave, 1.0 - wave]
}

/// The temporal pass by itself, with pictures of the test's own.
struct Reprojection {
    picture: Vec<[f32; 4]>,
    phase: u32,
    moving: bool,
}

impl Reprojection {
    fn new(moving: bool) -> Self {
        let places = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
        Self { picture: places.map(|(x, y)| truth(x, y)).collect(), phase: 0, moving }
    }

    fn view(&self, offset: [u32; 2]) -> ViewUniforms {
        let mut view = ViewUniforms::zeroed();
        view.camera.forward = Vec3::NEG_Z;
        view.camera.right = Vec3::X * 0.6;
        view.camera.up = Vec3::Y * 0.5;
        view.camera.eye = Vec3::Y * 100.0;
        view.previous = view.camera;
        if self.moving {
            view.previous.eye.x = -15.0;
        }
        view.is_still = u32::from(!self.moving);
        view.size = UVec2::from_array(SIZE);
        view.ray_count = view.size / 4;
        view.update_block = UVec2::splat(4);
        view.update_offset = UVec2::from_array(offset);
        view
    }

    /// One frame; `fresh_poison` replaces one fresh ray.
    fn step(&mut self, fresh_poison: Option<f32>) {
        let offset = UpdatePattern::new(UpdateFraction::Sixteenth, UpdateOrder::Cross).offset(self.phase);
        let view = gpu().uniform("view", bytemuck::bytes_of(&self.view(offset)));
        let rays = [SIZE[0] / 4, SIZE[1] / 4];
        let mut fresh: Vec<[f32; 4]> =
            (0..rays[1]).flat_map(|y| (0..rays[0]).map(move |x| truth(x * 4 + offset[0], y * 4 + offset[1]))).collect();
        if let Some(poison) = fresh_poison {
            fresh[8] = [poison; 4];
        }
        let (fresh, history) = (image(rays, &fresh), image(SIZE, &self.picture));
        let texels = (SIZE[0] * SIZE[1]) as usize;
        let near = scalars(rays, &vec![2000.0; texels / 16]);
        let out = Texture::new_2d(gpu(), "out", SIZE, wgpu::TextureFormat::Rgba16Float).expect("it fits");
        let clamp = gpu().device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let bound = vec![
            ("view", view.as_entire_binding()),
            ("fresh_cloud", view_of(&fresh)),
            ("fresh_distance", view_of(&near)),
            ("history_cloud", view_of(&history)),
            ("linear_clamp", wgpu::BindingResource::Sampler(&clamp)),
            ("cloud_out", view_of(&out)),
        ];
        run(&ProgramKey::plain("pass/temporal.wgsl").with_flags(["HISTORY"]), &bound, [SIZE[0], SIZE[1], 1]);
        self.picture = readback::rgba(gpu(), &out).expect("it can be read");
        self.phase += 1;
    }

    fn differing(&self, other: &Self) -> usize {
        let differs = |(a, b): &(&[f32; 4], &[f32; 4])| !(0..4).all(|c| (a[c] - b[c]).abs() < 1e-3);
        self.picture.iter().zip(&other.picture).filter(differs).count()
    }
}

#[test]
fn poison_in_the_history_never_spreads_and_heals_within_a_cycle() {
    for moving in [false, true] {
        for poison in POISON {
            let (mut clean, mut ill) = (Reprojection::new(moving), Reprojection::new(moving));
            for place in [0, 77, 300, 479] {
                ill.picture[place] = [poison; 4];
            }
            for step in 0..16 {
                clean.step(None);
                ill.step(None);
                let finite =
                    |texel: &[f32; 4]| texel.iter().all(|value| value.is_finite() && (0.0..=1.5).contains(value));
                assert!(ill.picture.iter().all(finite), "{poison}, moving {moving}: not healthy after frame {step}");
                // What cannot be shown is replaced by what is around it, never by black.
                let least = if poison == -7.0 { 0.0 } else { 0.02 };
                let shown = ill.picture.iter().flatten().all(|value| *value >= least);
                assert!(shown, "{poison}, moving {moving}: a hole after frame {step}");
                let differing = ill.differing(&clean);
                // A bilinear read touches four texels of each of the four places; clamping keeps them near.
                assert!(
                    differing <= if moving { 64 } else { 4 },
                    "{poison}, moving {moving}, frame {step}: {differing} differ"
                );
            }
            let differing = ill.differing(&clean);
            assert!(
                differing <= if moving { 16 } else { 0 },
                "{poison}, moving {moving}: {differing} pixels never healed"
            );
        }
    }
}

#[test]
fn poison_in_a_fresh_ray_is_not_kept() {
    for moving in [false, true] {
        for poison in POISON {
            let mut ill = Reprojection::new(moving);
            ill.step(Some(poison));
            for texel in &ill.picture {
                let fine = texel.iter().all(|value| value.is_finite() && *value >= 0.0);
                assert!(fine, "{poison}, moving {moving}: {texel:?} was kept");
            }
        }
    }
}

#[test]
fn a_truth_between_two_frames_leaves_their_history_alone() {
    let scene = cloudy();
    let size = [48, 27];
    let quality = updating(UpdateFraction::Sixteenth, UpdateOrder::Cross);
    let whole = Frame { output: Output::Linear, ..frame(&scene, &quality, size, Output::Display) };
    let frames = |with_truth: bool| {
        let mut renderer = renderer();
        for _ in 0..3 {
            show(&mut renderer, &scene, &quality, size);
        }
        if with_truth {
            let mut still = renderer.begin_still(&whole, 1).expect("the still begins");
            while !still.advance(&renderer, Duration::from_secs(1)).expect("it goes on") {}
            assert!(still.total_ms().is_some_and(|millis| millis > 0.0), "it was timed");
            let goal = Goal::Converged { tolerance: 0.01, levels: 2 };
            let mut truth = renderer.begin_truth(&whole, goal, 1).expect("the truth begins");
            assert!(truth.display().is_none(), "nothing is finished yet");
            let slice = Duration::from_millis(5);
            while truth.display().is_none() {
                truth.advance(&renderer, slice, slice).expect("it goes on");
            }
            let counts = truth.progress().counts;
            assert_eq!([counts.exceeded, counts.cut], [0, 0], "no fault");
        }
        bits(&show(&mut renderer, &scene, &quality, size))
    };
    assert_eq!(frames(true), frames(false), "the fourth frame takes over from the third either way");
}
