//! A scripted flight with time playing: frames per second as the editor would reach them, and the budget per pass.

use std::time::Instant;

use glam::Vec3;

use super::bench::{Case, PassSamples, Stats, add_passes};
use super::metrics::mask::directions;
use super::table::{Cell, Table};
use crate::gpu::TimingSource;
use crate::render::{RenderError, Renderer};
use crate::scene::{Camera, Frame, Output, Quality, Scene, UpdateFraction, direction};

/// Scene time from one frame to the next, in seconds: the rate that the flight should at least reach.
const FRAME_SECS: f64 = 1.0 / 8.0;
/// Speed of the camera, in metres per second.
const SPEED_MPS: f64 = 30.0;
/// How far the camera turns to either side, in degrees, and in which period, in seconds.
const TURN_DEG: f64 = 12.0;
const TURN_SECS: f64 = 20.0;
/// Frames at the beginning that do not count.
const WARM_UP: u32 = 4;

/// What a flight measured.
#[derive(Clone, Debug)]
pub struct Flight {
    /// Frames that counted.
    pub frames: u32,
    /// Frames per second over all of them, by the clock on the wall.
    pub frames_per_sec: f64,
    /// Milliseconds of each frame, by the clock on the wall.
    pub frame_ms: Vec<f64>,
    /// Samples of each pass.
    pub passes: Vec<PassSamples>,
    /// How far the last picture is from the same frame computed whole.
    pub trail: Trail,
    /// How far its clouds are from those of the picture before, each pixel looked up where its cloud was: what flickers.
    pub warp: Trail,
}

/// What reprojection leaves behind a moving camera: differences of the display's 8-bit levels, the greatest of the three
/// channels of each pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trail {
    /// Mean difference in levels.
    pub mean: f64,
    /// Difference that 95 % of the pixels stay below.
    pub p95: u8,
    /// Difference that 99 % of the pixels stay below.
    pub p99: u8,
}

impl Trail {
    /// The differences of two pictures of four channels.
    fn between(seen: &[u8], expected: &[u8]) -> Self {
        let differences: Vec<u8> = seen
            .chunks_exact(4)
            .zip(expected.chunks_exact(4))
            .map(|(a, b)| (0..3).map(|channel| a[channel].abs_diff(b[channel])).max().unwrap_or(0))
            .collect();
        Self::of(differences)
    }

    fn of(mut differences: Vec<u8>) -> Self {
        if differences.is_empty() {
            return Self::default();
        }
        differences.sort_unstable();
        let count = differences.len();
        let sum: u64 = differences.iter().map(|difference| u64::from(*difference)).sum();
        Self {
            mean: sum as f64 / count as f64,
            p95: differences[(count * 95 / 100).min(count - 1)],
            p99: differences[(count * 99 / 100).min(count - 1)],
        }
    }
}

/// The camera of a frame of the flight: forwards, swaying from side to side, climbing a little.
#[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
pub fn camera_at(start: &Camera, time_secs: f64) -> Camera {
    let phase = time_secs / TURN_SECS * std::f64::consts::TAU;
    let heading = f64::from(start.heading_deg).to_radians();
    let way = SPEED_MPS * time_secs;
    Camera {
        east_m: (f64::from(start.east_m) + way * heading.sin()) as f32,
        south_m: (f64::from(start.south_m) - way * heading.cos()) as f32,
        height_m: (f64::from(start.height_m) + 2.0 * time_secs) as f32,
        heading_deg: (f64::from(start.heading_deg) + TURN_DEG * phase.sin()).rem_euclid(360.0) as f32,
        ..start.clone()
    }
}

/// Flies through the sky of `case` for that many frames.
///
/// # Errors
/// If a frame cannot be rendered.
pub fn fly(renderer: &mut Renderer, case: &Case, frames: u32) -> Result<Flight, RenderError> {
    let mut scene = case.scene.clone();
    let mut flight = Flight {
        frames,
        frames_per_sec: 0.0,
        frame_ms: Vec::new(),
        passes: Vec::new(),
        trail: Trail::default(),
        warp: Trail::default(),
    };
    let mut before = None;
    for index in 0..WARM_UP + frames {
        if index + 1 == WARM_UP + frames && index > 0 {
            before = Some((scene.camera.clone(), renderer.display_rgba8()?.1));
        }
        let time_secs = f64::from(index) * FRAME_SECS;
        scene.camera = camera_at(&case.scene.camera, time_secs);
        let frame = Frame {
            scene: &scene,
            quality: &case.quality,
            size: case.size,
            time_secs,
            output: Output::Display,
            window: None,
        };
        let begun = Instant::now();
        let report = renderer.render(&frame)?;
        if index >= WARM_UP {
            flight.frame_ms.push(begun.elapsed().as_secs_f64() * 1e3);
            add_passes(&mut flight.passes, &report);
        }
    }
    let seconds = flight.frame_ms.iter().sum::<f64>() * 1e-3;
    flight.frames_per_sec = f64::from(frames) / seconds.max(1e-9);
    let (_, seen) = renderer.display_rgba8()?;
    let whole = Quality { update: UpdateFraction::Full, ..case.quality.clone() };
    let time_secs = f64::from(WARM_UP + frames - 1) * FRAME_SECS;
    renderer.render(&Frame {
        scene: &scene,
        quality: &whole,
        size: case.size,
        time_secs,
        output: Output::Linear,
        window: None,
    })?;
    let (size, expected) = renderer.display_rgba8()?;
    flight.trail = Trail::between(&seen, &expected);
    if let Some((camera, picture)) = before {
        let distances = renderer.linear()?.distance_m;
        let now = View { camera: &scene.camera, picture: &seen, size };
        let wind = wind_in(&scene, FRAME_SECS);
        flight.warp = warp(now, &distances, View { camera: &camera, picture: &picture, size }, wind);
    }
    Ok(flight)
}

/// A picture and the camera it was made with.
#[derive(Clone, Copy)]
struct View<'a> {
    camera: &'a Camera,
    picture: &'a [u8],
    size: [u32; 2],
}

impl View<'_> {
    fn eye(self) -> Vec3 {
        Vec3::new(self.camera.east_m, self.camera.height_m, self.camera.south_m)
    }

    /// Red, green and blue where a place of the world is seen, between the four pixels around it; `None` outside.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to lie in the picture")]
    fn colour_at(self, place: Vec3) -> Option<[f32; 3]> {
        let [forward, right, up] = self.camera.axes();
        let [across, high] = self.camera.half_tangents(self.size);
        let offset = place - self.eye();
        let depth = offset.dot(forward);
        let [width, height] = self.size.map(|side| side as f32);
        let x = (0.5 + 0.5 * offset.dot(right) / (depth * across)) * width - 0.5;
        let y = (0.5 - 0.5 * offset.dot(up) / (depth * high)) * height - 0.5;
        if !(depth > 0.0 && x >= 0.0 && y >= 0.0 && x < width - 1.0 && y < height - 1.0) {
            return None;
        }
        let texel = |dx: usize, dy: usize, channel: usize| {
            let at = ((y as usize + dy) * self.size[0] as usize + x as usize + dx) * 4 + channel;
            self.picture.get(at).map_or(0.0, |value| f32::from(*value))
        };
        Some([0, 1, 2].map(|channel| {
            let row = |dy: usize| texel(0, dy, channel) + (texel(1, dy, channel) - texel(0, dy, channel)) * x.fract();
            row(0) + (row(1) - row(0)) * y.fract()
        }))
    }
}

/// The way of the wind in a time.
#[allow(clippy::cast_possible_truncation, reason = "metres between two frames")]
fn wind_in(scene: &Scene, seconds: f64) -> Vec3 {
    let away = direction(0.0, scene.wind.from_deg + 180.0);
    away * (f64::from(scene.wind.speed_mps) * seconds) as f32
}

/// Differences of clouds between a picture and the one before, followed by their distances and the wind.
fn warp(now: View<'_>, distances: &[f32], before: View<'_>, wind: Vec3) -> Trail {
    let directions = directions(now.camera, now.size);
    let differences =
        directions.zip(distances).zip(now.picture.chunks_exact(4)).filter_map(|((dir, distance), pixel)| {
            if *distance <= 0.0 {
                return None;
            }
            let was = before.colour_at(now.eye() + dir * *distance - wind)?;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "levels of a display")]
            let level = |channel: usize| (f32::from(pixel[channel]) - was[channel]).abs().round() as u8;
            (0..3).map(level).max()
        });
    Trail::of(differences.collect())
}

/// The budget: what each pass takes of a frame on average, the rest of the program's own time last.
pub fn table(case: &Case, flight: &Flight, source: TimingSource) -> Table {
    let title = format!(
        "Flight through {} at {}: {:.1} frames per second over {} frames ({}, frames by wall clock); trail behind the \
         moving camera: mean {:.2}, 95 % below {}, 99 % below {} of 255 levels; clouds from one frame to the next, followed: \
         mean {:.2}, 95 % below {}, 99 % below {}",
        case.name,
        case.size_text(),
        flight.frames_per_sec,
        flight.frames,
        source.label(),
        flight.trail.mean,
        flight.trail.p95,
        flight.trail.p99,
        flight.warp.mean,
        flight.warp.p95,
        flight.warp.p99
    );
    let mut table = Table::new(title, &["pass", "runs", "median", "p5", "p95", "mean per frame", "share %"]);
    let count = f64::from(flight.frames.max(1));
    let whole = flight.frame_ms.iter().sum::<f64>() / count;
    let mut named = 0.0;
    let mut push = |pass: &str, samples: &[f64], mean: f64| {
        let stats = Stats::of(samples);
        table.rows.push(vec![
            Cell::text(pass),
            Cell::Number(Some(samples.len() as f64), 0),
            Cell::millis(stats.map(|stats| stats.median)),
            Cell::millis(stats.map(|stats| stats.p5)),
            Cell::millis(stats.map(|stats| stats.p95)),
            Cell::millis(Some(mean)),
            Cell::Number((whole > 0.0).then(|| mean / whole * 100.0), 1),
        ]);
    };
    for samples in &flight.passes {
        let mean = samples.millis.iter().sum::<f64>() / count;
        named += mean;
        push(samples.pass, &samples.millis, mean);
    }
    push("(between passes)", &[], (whole - named).max(0.0));
    push("frame", &flight.frame_ms, whole);
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_is_the_difference_of_pictures() {
        let still = [10_u8, 20, 30, 255].repeat(100);
        assert_eq!(Trail::between(&still, &still), Trail::default());
        let mut moved = still.clone();
        moved[1] = 40;
        let trail = Trail::between(&moved, &still);
        assert!((trail.mean - 0.2).abs() < 1e-9 && trail.p95 == 0, "one pixel of a hundred, by 20 levels: {trail:?}");
    }

    #[test]
    fn clouds_are_followed_to_where_they_were() {
        // A picture whose levels rise to the right, seen by a lens of 90 degrees.
        let camera = Camera { pitch_deg: 0.0, field_of_view_deg: 90.0, ..Camera::default() };
        let size = [40, 40];
        let ramp = |shift: f32| -> Vec<u8> {
            (0..1600).flat_map(|at| [byte(100.0 + 2.0 * ((at % 40) as f32 + shift)), 0, 0, 255]).collect()
        };
        let (seen, was) = (ramp(0.0), ramp(-3.0));
        let distances = vec![2000.0; 1600];
        let view = |picture| View { camera: &camera, picture, size };
        let still = warp(view(&seen), &distances, view(&seen), Vec3::ZERO);
        assert!(still.mean < 0.1, "{still:?}");
        // A pixel is a twentieth of the distance wide; what was three pixels further left has the same level.
        let depth = 2000.0 * 0.9;
        let moved = warp(view(&seen), &distances, view(&was), Vec3::X * (depth * 3.0 / 20.0));
        let unmoved = warp(view(&seen), &distances, view(&was), Vec3::ZERO);
        assert!((unmoved.mean - 6.0).abs() < 0.1, "three pixels are six levels: {unmoved:?}");
        assert!(moved.mean > 6.0, "it was followed the other way: {moved:?}");
        let back = warp(view(&seen), &distances, view(&was), Vec3::X * (-depth * 3.0 / 20.0));
        assert!(back.mean < 1.5, "{back:?}");
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "levels of a display")]
    fn byte(level: f32) -> u8 {
        level.round() as u8
    }

    #[test]
    fn the_flight_starts_at_the_camera_and_moves_on() {
        let start = Camera { heading_deg: 90.0, ..Camera::default() };
        assert_eq!(camera_at(&start, 0.0), start);
        let later = camera_at(&start, 10.0);
        assert!((later.east_m - start.east_m - 300.0).abs() < 1e-3, "east by 300 m: {}", later.east_m);
        assert!((camera_at(&start, 5.0).heading_deg - 102.0).abs() < 1e-3, "a quarter period turns by 12°");
    }
}
