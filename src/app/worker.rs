//! What would keep the window waiting: file dialogs, stills, and writing pictures. Each runs on a thread of its own
//! and reports back through the event loop.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use winit::event_loop::EventLoopProxy;

use super::action::{Browse, Export, Shape, Steering, Still};
use super::lab::News;
use super::truth::{CompareJob, Compared};
use super::viewport::pixels_of;
use crate::export::exr::ExrOptions;
use crate::files::{About, Alpha, Content, CubeLayout, StillFile, files_of_still, named, save_png};
use crate::gpu::Gpu;
use crate::images::pattern::FramePattern;
use crate::render::{Proceed, Renderer};
use crate::scene::{Frame, LARGEST_WHOLE_PX, Output, Preset, Quality, QualityLevel, UpdateFraction};

/// What reaches the event loop from outside the window.
#[derive(Debug)]
pub(super) enum Event {
    /// A screen reader wants something.
    Accessibility(egui_winit::accesskit_winit::Event),
    /// A thread has finished.
    Worker(Message),
    /// Pictures were compared.
    Compared(Box<Compared>),
    /// Something was measured.
    Lab(Box<News>),
}

impl From<egui_winit::accesskit_winit::Event> for Event {
    fn from(event: egui_winit::accesskit_winit::Event) -> Self {
        Self::Accessibility(event)
    }
}

/// What a thread found or did.
#[derive(Debug)]
pub(super) enum Message {
    /// A path was chosen in the system's file dialog.
    Picked(Browse, PathBuf),
    /// The dialog was closed without a choice.
    NotPicked,
    /// There seems to be no file dialog on this system.
    NoFileDialog,
    /// How much of a picture is done, 0 to 1, and since when it is worked on.
    Progress(f32, Instant),
    /// A still is over: it was written, or given up, or why it could not be rendered.
    Still(Result<Option<PathBuf>, String>),
    /// A small picture of a preset, size and bytes; `None` if it could not be made.
    SmallPicture(PathBuf, Option<([u32; 2], Vec<u8>)>),
    /// A picture was written.
    Written(PathBuf),
    /// A picture could not be rendered or written.
    Failed(String),
}

/// A dialog that returns nothing faster than this was never on the screen.
const FASTEST_CANCEL: Duration = Duration::from_millis(400);

/// Size of a preset's picture, and how often it is asked whether it may go on.
const SMALL_PX: [u32; 2] = [256, 144];
const WAITS_FOR: Duration = Duration::from_millis(100);

/// Starts threads that report to one event loop.
#[derive(Clone, Debug)]
pub(super) struct Worker {
    proxy: EventLoopProxy<Event>,
}

/// Everything a still or a screenshot needs, owned, so that the document can change meanwhile.
#[derive(Clone, Debug)]
pub(super) struct StillJob {
    /// The device.
    pub(super) gpu: Gpu,
    /// The sky.
    pub(super) preset: Preset,
    /// How it is computed.
    pub(super) quality: Quality,
    /// When.
    pub(super) time_secs: f64,
    /// What is written and where.
    pub(super) export: Export,
}

impl StillJob {
    fn about(&self) -> About<'_> {
        About { preset: &self.preset, quality: &self.quality, time_secs: self.time_secs }
    }
}

impl Worker {
    /// A worker that reports to this loop.
    pub(super) fn new(proxy: EventLoopProxy<Event>) -> Self {
        Self { proxy }
    }

    /// Compares two pictures.
    pub(super) fn compare(&self, job: CompareJob) {
        let proxy = self.proxy.clone();
        let compare = move || {
            // As above: whoever does not wait has closed the window.
            let _ = proxy.send_event(Event::Compared(Box::new(job.run())));
        };
        if let Err(error) = std::thread::Builder::new().name("compare".to_owned()).spawn(compare) {
            let _ = self.proxy.send_event(Event::Worker(Message::Failed(format!("no thread for comparing: {error}"))));
        }
    }

    fn spawn(&self, name: &str, work: impl FnOnce() -> Message + Send + 'static) {
        let proxy = self.proxy.clone();
        let report = move |message| {
            // The loop is gone only when the window is closed; then nobody waits for the message.
            let _ = proxy.send_event(Event::Worker(message));
        };
        let failed = report.clone();
        let thread = std::thread::Builder::new().name(name.to_owned());
        if let Err(error) = thread.spawn(move || report(work())) {
            failed(Message::Failed(format!("no thread for {name}: {error}")));
        }
    }

    /// Shows the system's file dialog.
    pub(super) fn browse(&self, purpose: Browse, start: &Path) {
        let start = start.to_owned();
        self.spawn("file dialog", move || {
            let begun = Instant::now();
            match pollster::block_on(dialog(&purpose, &start)) {
                Some(file) => Message::Picked(purpose, file.path().to_owned()),
                None if begun.elapsed() < FASTEST_CANCEL => Message::NoFileDialog,
                None => Message::NotPicked,
            }
        });
    }

    /// Writes the window's picture as PNG into the folder that the job names, under the first free numbered name.
    pub(super) fn screenshot(&self, job: StillJob, (size, pixels): ([u32; 2], Vec<u8>)) {
        self.spawn("screenshot", move || {
            let folder = &job.export.path;
            // A folder that cannot be made is reported by the write, with its path.
            let _ = std::fs::create_dir_all(folder);
            let path = free_name(folder);
            match save_png(&path, size, &pixels, &job.about()) {
                Ok(()) => Message::Written(path),
                Err(error) => Message::Failed(error.to_string()),
            }
        });
    }

    /// Renders small pictures of presets, one after the other, and waits while `waits` says so. Tells of each; returns whether a
    /// thread does.
    pub(super) fn small_pictures(&self, gpu: &Gpu, (presets, waits): (Vec<PathBuf>, Arc<AtomicBool>)) -> bool {
        let (gpu, proxy) = (gpu.clone(), self.proxy.clone());
        let work = move || {
            let mut renderer = Renderer::new(&gpu).ok();
            for preset in presets {
                let mut proceed = |_: f32| {
                    while waits.load(Ordering::Relaxed) {
                        std::thread::sleep(WAITS_FOR);
                    }
                    Proceed::On
                };
                proceed(0.0);
                // Whatever a file holds must not take the others' pictures away.
                let drawn = catch_unwind(AssertUnwindSafe(|| small_picture(renderer.as_mut()?, &preset, &mut proceed)));
                let picture = drawn.unwrap_or(None);
                if proxy.send_event(Event::Worker(Message::SmallPicture(preset, picture))).is_err() {
                    return;
                }
            }
        };
        std::thread::Builder::new().name("small pictures".to_owned()).spawn(work).is_ok()
    }

    /// Renders a still and writes it, as what is returned steers it.
    pub(super) fn still(&self, job: StillJob) -> Arc<Helm> {
        let helm = Arc::new(Helm::default());
        let (hand, proxy, mut begun) = (Arc::clone(&helm), self.proxy.clone(), Instant::now());
        let failed = self.proxy.clone();
        let work = move || {
            let mut proceed = |share| {
                // What is left is guessed from the time that was worked.
                begun += hand.wait();
                // As above: whoever does not wait has closed the window.
                let is_heard = proxy.send_event(Event::Worker(Message::Progress(share, begun))).is_ok();
                match hand.steering() {
                    _ if !is_heard => Proceed::No,
                    Steering::On | Steering::Wait => Proceed::On,
                    Steering::End => Proceed::WithWhatIsDone,
                    Steering::GiveUp => Proceed::No,
                }
            };
            // Whatever happens, the window has to hear that it is over.
            let outcome = catch_unwind(AssertUnwindSafe(|| still(&job, &mut proceed)));
            let is_written = match outcome {
                Ok(result) => result.map_err(|error| format!("{error:#}")),
                Err(_) => Err("the still could not be rendered: its thread panicked".to_owned()),
            };
            let path = named(&job.export.path, &job.preset);
            let _ = proxy
                .send_event(Event::Worker(Message::Still(is_written.map(|is_written| is_written.then_some(path)))));
        };
        if let Err(error) = std::thread::Builder::new().name("still".to_owned()).spawn(work) {
            let said = Err(format!("no thread for a still: {error}"));
            let _ = failed.send_event(Event::Worker(Message::Still(said)));
        }
        helm
    }
}

/// Steers a still from another thread.
#[derive(Debug)]
pub(super) struct Helm {
    steering: Mutex<Steering>,
    turned: Condvar,
}

impl Default for Helm {
    fn default() -> Self {
        Self { steering: Mutex::new(Steering::On), turned: Condvar::new() }
    }
}

impl Helm {
    fn lock(&self) -> MutexGuard<'_, Steering> {
        // Whoever panicked while turning it has set it, or has not.
        self.steering.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What becomes of the still.
    pub(super) fn steering(&self) -> Steering {
        *self.lock()
    }

    /// Says what becomes of the still.
    pub(super) fn turn(&self, steering: Steering) {
        let mut now = self.lock();
        // What ends does not go on, but can still be given up.
        let is_settled = *now == Steering::GiveUp || *now == Steering::End && steering != Steering::GiveUp;
        if !is_settled {
            *now = steering;
        }
        drop(now);
        self.turned.notify_all();
    }

    /// Waits while it has to wait; returns for how long.
    fn wait(&self) -> Duration {
        let begun = Instant::now();
        let still_waits = |steering: &mut Steering| *steering == Steering::Wait;
        drop(self.turned.wait_while(self.lock(), still_waits));
        begun.elapsed()
    }
}

async fn dialog(purpose: &Browse, start: &Path) -> Option<rfd::FileHandle> {
    let dialog = rfd::AsyncFileDialog::new().set_directory(start);
    let skies = ["ron", "exr", "png", "json"];
    match purpose {
        Browse::Open => dialog.add_filter("Skies", &skies).pick_file().await,
        Browse::SaveAs => dialog.add_filter("Preset", &["ron"]).set_file_name("sky.ron").save_file().await,
        Browse::Export => {
            dialog.add_filter("Pictures", &["exr", "hdr", "png"]).set_file_name("sky.exr").save_file().await
        }
        Browse::Parameter(key) if key.ends_with(".grid") => {
            dialog.add_filter("Voxel grids", &["npy", "vol"]).pick_file().await
        }
        Browse::Parameter(_) => dialog.add_filter("Images", &["png", "exr"]).pick_file().await,
    }
}

fn free_name(folder: &Path) -> PathBuf {
    let name = |number: u32| folder.join(format!("nephoscope-{number:04}.png"));
    (1..10_000).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(10_000))
}

/// A picture of a preset for the gallery, as quickly as can be.
fn small_picture(
    renderer: &mut Renderer,
    preset: &Path,
    proceed: &mut dyn FnMut(f32) -> Proceed,
) -> Option<([u32; 2], Vec<u8>)> {
    let sky = crate::files::open(preset).ok()?;
    let quality = Quality { pixel_samples: 1, update: UpdateFraction::Full, ..Quality::level(QualityLevel::Draft) };
    let (scene, output) = (&sky.preset.scene, Output::Display);
    let frame = Frame { scene, quality: &quality, size: SMALL_PX, time_secs: 0.0, output, window: None };
    let still = renderer.still_while(&frame, proceed).ok()??;
    renderer.rgba8_of(&still.into_display()).ok()
}

/// What the file of a still holds.
fn content(still: Still) -> Content {
    match still {
        Still::Exr => Content::Linear(ExrOptions::default()),
        Still::LayersExr => Content::Layers(ExrOptions::default()),
        Still::CloudsExr => Content::CloudsAlone(ExrOptions::default(), Alpha::Associated),
        Still::Radiance => Content::Radiance,
        Still::Png => Content::Display,
        Still::Png16 => Content::Display16,
    }
}

fn cube(shape: Shape) -> Option<CubeLayout> {
    match shape {
        Shape::Camera | Shape::Panorama => None,
        Shape::CubeFaces => Some(CubeLayout::Faces),
        Shape::CubeCross => Some(CubeLayout::Cross),
    }
}

/// Files and times of all pictures that are to be written.
fn pictures(job: &StillJob) -> anyhow::Result<Vec<(PathBuf, f64)>> {
    let path = named(&job.export.path, &job.preset);
    let Some(frames) = job.export.frames else { return Ok(vec![(path, job.time_secs)]) };
    let pattern = FramePattern::parse(&path)?;
    anyhow::ensure!(pattern.is_sequence(), "a sequence needs #### for the frame number in its path");
    let speed = job.preset.animation.speed;
    let numbers = (frames.first..=frames.last).step_by(frames.step.max(1) as usize);
    let all = numbers.map(|frame| (pattern.path_of(frame), speed * f64::from(frame) / frames.fps));
    let is_there = |path: &Path| files_of_still(path, cube(job.export.shape)).iter().all(|path| path.exists());
    Ok(all.filter(|(path, _)| !frames.keeps || !is_there(path)).collect())
}

/// A renderer of its own on the same device, so that the window's keeps its history and its picture. Returns whether all was
/// written, rather than given up.
fn still(job: &StillJob, proceed: &mut dyn FnMut(f32) -> Proceed) -> anyhow::Result<bool> {
    let mut renderer = Renderer::new(&job.gpu)?;
    let pictures = pictures(job)?;
    anyhow::ensure!(
        !pictures.is_empty(),
        "all frames are there already; untick “Keep what is there” to render them again"
    );
    let mut ends = false;
    for (index, (path, time_secs)) in pictures.iter().enumerate() {
        if ends {
            break;
        }
        let mut preset = job.preset.clone();
        preset.scene = preset.at(*time_secs);
        let file = StillFile {
            path,
            content: content(job.export.still),
            size: job.export.size,
            cube: cube(job.export.shape),
            frame_secs: job.preset.animation.speed / job.export.frames.map_or(24.0, |frames| frames.fps),
            brightest: job.export.brightest,
            largest_whole: LARGEST_WHOLE_PX,
            region: job.export.region.map(|region| pixels_of(region, job.export.size)),
            about: About { preset: &preset, quality: &job.quality, time_secs: *time_secs },
        };
        let mut part = |share: f32| match proceed((index as f32 + share) / pictures.len() as f32) {
            // A frame that was left half done would stay so when the rest is made.
            Proceed::WithWhatIsDone if job.export.frames.is_some() => {
                ends = true;
                Proceed::On
            }
            asked => asked,
        };
        if !file.render(&mut renderer, &mut part)? {
            return Ok(false);
        }
    }
    Ok(true)
}
