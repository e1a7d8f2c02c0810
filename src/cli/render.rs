//! `render`: one picture or a sequence of them, without a window.

use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context as _, Result};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;

use super::error::Usage;
use super::integrate::{Integration, converge, describe};
use super::interrupt::{self, Interrupted};
use super::{Device, Edits, args, print};
use crate::export::ExportError;
use crate::export::exr::{ExrCompression, ExrDepth, ExrOptions};
use crate::files::{
    self, About, Alpha, Content, CubeLayout, FileError, KeptPrograms, StillError, StillFile, files_of_still, named,
    save_exr, save_png, soften,
};
use crate::gpu::Gpu;
use crate::images::pattern::{FramePattern, parse_frame_range};
use crate::plan::{Forced, FramePlan};
use crate::render::truth::Goal;
use crate::render::{Proceed, Renderer};
use crate::scene::{Frame, LARGEST_WHOLE_PX, Output, Preset, Projection, Quality, UpdateFraction};

#[derive(Clone, Debug, Args)]
pub(super) struct RenderArgs {
    /// A preset (.ron), an exported .exr or .png, a voxel grid (.json), or the name of a built-in sky.
    scene: PathBuf,
    /// File to write, .png, .exr or .hdr; `####` in its name stands for the frame number, `{name}` for the sky's name and
    /// `{seed}` for the first seed of its weather.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Width and height in pixels, such as `640x360`, `hd` or `4k`.
    /// [default: 1920x1080, 4096x2048 for a panorama, 1024x1024 for each face of a cube]
    #[arg(long, value_parser = args::size)]
    size: Option<[u32; 2]>,
    /// Only a part of the picture: WIDTHxHEIGHT+LEFT+TOP in pixels. An EXR keeps its place in the whole.
    #[arg(long, value_parser = args::region, value_name = "REGION")]
    region: Option<[[u32; 2]; 2]>,
    /// How directions map onto the picture; as the sky says if not given.
    #[arg(long)]
    projection: Option<ProjectionArg>,
    /// Seconds since the scene began.
    /// [default: 0, or what a picture shows]
    #[arg(long, value_parser = args::finite, value_name = "SECONDS", allow_negative_numbers = true)]
    time: Option<f64>,
    /// Camera: east,height,south,heading,pitch[,field of view] in metres and degrees.
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true)]
    camera: Option<String>,
    /// Frames of a sequence, such as 1-100x2 or 1,5,9; frame N shows the time `--time` + N / `--fps`, times
    /// the sky's speed of time (`animation.speed`, 1 unless the sky says otherwise).
    #[arg(long, value_name = "RANGE")]
    frames: Option<String>,
    /// Frames per second of a sequence.
    #[arg(long, value_parser = args::finite, default_value = "24")]
    fps: f64,
    /// Render frames of a sequence that exist already; otherwise they are left as they are.
    #[arg(long)]
    overwrite: bool,
    /// Quality: draft, preview, high, final, or a .ron file; as the sky says if not given.
    #[arg(long)]
    quality: Option<String>,
    #[command(flatten)]
    integration: Integration,
    /// Only clouds, with their opacity as alpha (EXR).
    #[arg(long)]
    clouds_only: bool,
    /// With `--clouds-only`: colours that have to be multiplied by alpha, instead of those that are.
    #[arg(long, requires = "clouds_only")]
    straight: bool,
    /// Write layers of light into the .exr beside the picture, which is their sum: direct, multiple, ambient, bounce, air,
    /// shafts, disc, backdrop; and the clouds' transmittance, distance, and motion until the next frame (`--fps`) in pixels.
    #[arg(long, conflicts_with = "clouds_only")]
    layers: bool,
    /// Bits of a sample: of an EXR half, or float where half does not reach; of a PNG 8.
    #[arg(long)]
    depth: Option<DepthArg>,
    /// Codec of an EXR.
    #[arg(long, default_value = "zip")]
    compression: CompressionArg,
    /// Compress what is brighter than half of this towards it, in units of the file: a sun that other programs can bear.
    #[arg(long, value_name = "LIGHT", value_parser = args::above_zero, conflicts_with_all = ["layers", "clouds_only"])]
    brightest: Option<f32>,
    /// Render each picture once more as a frame of the window, look at the values that each pass writes, and fail at the
    /// first that is not finite.
    #[arg(long)]
    watch: bool,
    /// Run an effect that the sky does not call for, or leave one out: NAME=on or NAME=off, with a name of docs/effects.md.
    /// May be given more than once.
    #[arg(long, value_name = "EFFECT")]
    force: Vec<String>,
    /// Print one line of JSON for each file.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    edits: Edits,
    #[command(flatten)]
    device: Device,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ProjectionArg {
    /// As a lens does.
    Perspective,
    /// All directions, longitude across and latitude down.
    Equirect,
    /// The upper half of all directions: the zenith at the top, the horizon at the bottom
    Dome,
    /// A cube map as six files: `sky.px.exr` is east, `py` up, `pz` north.
    Cube,
    /// A cube map as one lying cross.
    Cross,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum DepthArg {
    /// 16 bits.
    Half,
    /// 32 bits.
    Float,
    /// 8 bits, of a PNG.
    #[value(name = "8")]
    Eight,
    /// 16 bits, of a PNG.
    #[value(name = "16")]
    Sixteen,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum CompressionArg {
    /// Deflate, 16 lines at a time.
    Zip,
    /// Deflate, line by line.
    Zips,
    /// Wavelets.
    Piz,
    /// Cosines, lossy but for opacity and data.
    Dwaa,
    /// None.
    None,
}

impl RenderArgs {
    /// One picture with everything as the sky says.
    pub(super) fn still(scene: PathBuf, output: PathBuf, edits: Edits, device: Device) -> Self {
        Self {
            scene,
            output,
            size: Some([1280, 720]),
            region: None,
            projection: None,
            time: None,
            camera: None,
            frames: None,
            fps: 24.0,
            overwrite: false,
            quality: None,
            integration: Integration::default(),
            clouds_only: false,
            straight: false,
            layers: false,
            depth: None,
            compression: CompressionArg::Zip,
            brightest: None,
            watch: false,
            force: Vec::new(),
            json: false,
            edits,
            device,
        }
    }

    /// The same of all directions, if nothing else was said.
    pub(super) fn all_directions(mut self) -> Self {
        self.projection.get_or_insert(ProjectionArg::Equirect);
        self
    }

    /// Frames from the first to the last of the sky's own film, if none were named, and the output's name without `{}`.
    pub(super) fn fit_frames(&mut self) -> Result<()> {
        let mut sky = files::open(&self.scene)?;
        sky.preset.set_all(&self.edits.sets, &mut Quality::default())?;
        self.output = named(&self.output, &sky.preset);
        if self.frames.is_none() {
            let begin_secs = self.time.unwrap_or(sky.time_secs);
            let Some(last) = sky.preset.animation.last_frame(begin_secs, self.fps) else {
                let said = "the sky's time stands still or has ended, so its film has no length; give --frames";
                return Err(Usage(said.to_owned()).into());
            };
            self.frames = Some(format!("0-{last}"));
        }
        Ok(())
    }

    /// Where pictures go.
    pub(super) fn output(&self) -> &Path {
        &self.output
    }

    /// Whether lines of JSON are printed.
    pub(super) fn is_json(&self) -> bool {
        self.json
    }

    /// Frames per second.
    pub(super) fn fps(&self) -> f64 {
        self.fps
    }

    /// The files of all frames, those that exist included.
    pub(super) fn files(&self) -> Result<Vec<PathBuf>> {
        let pattern = FramePattern::parse(&self.output)?;
        let frames = parse_frame_range(self.frames.as_deref().unwrap_or_default())?;
        Ok(frames.into_iter().map(|frame| pattern.path_of(frame)).collect())
    }

    /// What the files hold, by the ending of their names and what was asked for.
    fn content(&self) -> Result<Content> {
        let path = &self.output;
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let wants_exr = match (self.clouds_only, self.layers) {
            (true, _) => Some("--clouds-only needs an .exr, which keeps light and opacity apart"),
            (_, true) => Some("--layers needs an .exr, which holds more than one picture"),
            _ => None,
        };
        let refuse = |said: &str| Err(Usage(said.to_owned()).into());
        match (extension.as_deref(), wants_exr, self.depth) {
            (Some("exr"), _, Some(DepthArg::Eight | DepthArg::Sixteen)) => {
                refuse("--depth 8 and 16 are for .png; an EXR has half or float")
            }
            (Some("exr"), ..) if self.clouds_only => Ok(Content::CloudsAlone(self.exr_options(), self.alpha())),
            (Some("exr"), ..) if self.layers => Ok(Content::Layers(self.exr_options())),
            (Some("exr"), ..) => Ok(Content::Linear(self.exr_options())),
            (Some("png" | "hdr"), Some(said), _) => refuse(said),
            (Some("png"), _, None | Some(DepthArg::Eight)) => Ok(Content::Display),
            (Some("png"), _, Some(DepthArg::Sixteen)) => Ok(Content::Display16),
            (Some("png"), _, Some(DepthArg::Half | DepthArg::Float)) => {
                refuse("--depth half and float are for .exr; a PNG has 8 or 16 bits")
            }
            (Some("hdr"), _, Some(_)) => refuse("--depth is for .exr and .png; a Radiance file has one depth"),
            (Some("hdr"), ..) => Ok(Content::Radiance),
            // A device such as /dev/full has no extension; what it is matters more.
            _ if path.exists() && !path.is_file() => Err(ExportError::NotAFile { path: path.clone() }.into()),
            _ => refuse(&format!("-o {} ends neither in .png nor in .exr nor in .hdr", path.display())),
        }
    }

    fn alpha(&self) -> Alpha {
        if self.straight { Alpha::Straight } else { Alpha::Associated }
    }

    fn exr_options(&self) -> ExrOptions {
        let depth = match self.depth {
            Some(DepthArg::Half) => ExrDepth::Half,
            Some(DepthArg::Float) => ExrDepth::Float,
            _ => ExrDepth::Auto,
        };
        let compression = match self.compression {
            CompressionArg::Zip => ExrCompression::Zip,
            CompressionArg::Zips => ExrCompression::Zips,
            CompressionArg::Piz => ExrCompression::Piz,
            CompressionArg::Dwaa => ExrCompression::Dwaa,
            CompressionArg::None => ExrCompression::None,
        };
        ExrOptions { depth, compression }
    }
}

/// Everything decided and checked before a device is opened.
struct Job {
    preset: Preset,
    quality: Quality,
    content: Content,
    size: [u32; 2],
    cube: Option<CubeLayout>,
    region: Option<[[u32; 2]; 2]>,
    goal: Option<Goal>,
    forced: Forced,
    /// File and time of each picture.
    pictures: Vec<(PathBuf, f64)>,
}

impl Job {
    fn new(args: &RenderArgs) -> Result<Self> {
        let content = args.content()?;
        if args.brightest.is_some() && matches!(content, Content::Display | Content::Display16) {
            return Err(Usage("--brightest is for .exr and .hdr; a PNG has the screen's range".to_owned()).into());
        }
        let sky = files::open(&args.scene)?;
        let mut quality = args::quality(args.quality.as_deref(), &sky)?;
        // A still has no frames before it to take pixels from.
        quality.update = UpdateFraction::Full;
        // `--size` is the size of the file, unless `--set` says otherwise.
        quality.resolution_scale = 1.0;
        let mut preset = sky.preset;
        preset.set_all(&args.edits.sets, &mut quality)?;
        if let Some(camera) = &args.camera {
            args::set_camera(&mut preset.scene, camera)?;
            preset.animation.override_by(["camera"]);
        }
        if args.projection.is_some() {
            preset.animation.override_by(["camera.projection"]);
        }
        match args.projection {
            None => {}
            Some(ProjectionArg::Perspective) => preset.scene.camera.projection = Projection::Perspective,
            Some(ProjectionArg::Equirect) => preset.scene.camera.projection = Projection::Equirect,
            Some(ProjectionArg::Dome) => preset.scene.camera.projection = Projection::Dome,
            Some(ProjectionArg::Cube | ProjectionArg::Cross) => {}
        }
        let cube = match args.projection {
            Some(ProjectionArg::Cube) => Some(CubeLayout::Faces),
            Some(ProjectionArg::Cross) => Some(CubeLayout::Cross),
            _ => None,
        };
        let size = match (cube, args.size, preset.scene.camera.projection) {
            (Some(_), Some([width, height]), _) if width != height => {
                return Err(Usage(format!("a face of a cube is square: --size {width}x{width}, say")).into());
            }
            (_, Some(size), _) => size,
            (Some(_), None, _) => [1024, 1024],
            (None, None, Projection::Perspective) => [1920, 1080],
            (None, None, Projection::Equirect) => [4096, 2048],
            (None, None, Projection::Dome) => [4096, 1024],
        };
        let is_final = args.quality.as_deref().is_some_and(|quality| quality.eq_ignore_ascii_case("final"));
        let goal = args.integration.goal(is_final)?;
        if let Some([offset, part]) = args.region {
            let fits = |axis: usize| offset[axis].checked_add(part[axis]).is_some_and(|end| end <= size[axis]);
            if cube.is_some() || goal.is_some() {
                let said = "--region is for pictures of the realtime march that are no cube maps";
                return Err(Usage(said.to_owned()).into());
            }
            if !fits(0) || !fits(1) {
                let [width, height] = size;
                return Err(Usage(format!("--region leaves the picture, which is {width}x{height}")).into());
            }
        }
        if goal.is_some() && (cube.is_some() || matches!(content, Content::Display16 | Content::Radiance)) {
            let said = "cube maps, Radiance files and 16-bit PNG are for the realtime march; choose --quality high";
            return Err(Usage(said.to_owned()).into());
        }
        if args.layers && goal.is_some() {
            return Err(Usage("--layers is for the realtime march; choose --quality high".to_owned()).into());
        }
        let forced = args::forced(&args.force)?;
        let time_secs = args.time.unwrap_or(sky.time_secs);
        let pictures = pictures(args, (&preset, time_secs), cube)?;
        let (scene, output) = (&preset.scene, content.output());
        let whole = Frame { scene, quality: &quality, size, time_secs, output, window: None };
        if (cube.is_some() || args.region.is_some()) && FramePlan::new(&whole).sunshafts.is_some() {
            eprintln!("streaks of light need the whole picture: a region and the faces of a cube are without them");
        }
        Ok(Self { preset, quality, content, size, cube, region: args.region, goal, forced, pictures })
    }
}

/// The files to write, with their times; those of a sequence that exist are left out.
fn pictures(
    args: &RenderArgs,
    (preset, begin_secs): (&Preset, f64),
    cube: Option<CubeLayout>,
) -> Result<Vec<(PathBuf, f64)>> {
    let output = named(&args.output, preset);
    let pattern = FramePattern::parse(&output)?;
    let pictures = match (&args.frames, pattern.is_sequence()) {
        (None, false) => vec![(output, begin_secs)],
        (None, true) => return Err(Usage("-o has `#` for a frame number, but --frames is missing".to_owned()).into()),
        (Some(_), false) => {
            return Err(Usage("--frames needs `####` in the name of -o, such as sky.####.exr".to_owned()).into());
        }
        (Some(range), true) => {
            if args.fps <= 0.0 {
                return Err(Usage(format!("--fps {} must be above 0", args.fps)).into());
            }
            let frames = parse_frame_range(range).with_context(|| format!("--frames {range:?} cannot be used"))?;
            let all = frames.into_iter().map(|frame| {
                (pattern.path_of(frame), begin_secs + preset.animation.speed * f64::from(frame) / args.fps)
            });
            all.filter(|(path, _)| args.overwrite || !is_there(path, cube)).collect()
        }
    };
    for (path, _) in &pictures {
        check_target(path)?;
    }
    Ok(pictures)
}

fn is_there(path: &Path, cube: Option<CubeLayout>) -> bool {
    let is_there = files_of_still(path, cube).iter().all(|path| path.exists());
    if is_there {
        eprintln!("{} exists and is kept (--overwrite renders it again)", path.display());
    }
    is_there
}

/// Refuses what can never be written before minutes are spent on it.
pub(super) fn check_target(path: &Path) -> Result<(), ExportError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(ExportError::FolderMissing { path: path.to_owned(), folder: folder.to_owned() });
    }
    if path.exists() && !path.is_file() {
        return Err(ExportError::NotAFile { path: path.to_owned() });
    }
    Ok(())
}

pub(super) fn run(args: &RenderArgs) -> Result<()> {
    let job = Job::new(args)?;
    let gpu = Gpu::headless(&args.device.choice())?;
    let mut programs = KeptPrograms::begin(&gpu);
    let mut renderer = Renderer::new(&gpu)?;
    renderer.force(job.forced);
    let bar = progress(job.pictures.len());
    for (path, time_secs) in &job.pictures {
        bar.set_message(path.display().to_string());
        let begun = Instant::now();
        let before = bar.position();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share")]
        let tell = |share: f32| bar.set_position(before + (share * STEPS as f32) as u64);
        write_picture(&mut renderer, (&job, args), (path, *time_secs), &tell)?;
        bar.set_position(before + STEPS);
        if let Some(programs) = &mut programs {
            programs.keep(&gpu);
        }
        let seconds = begun.elapsed().as_secs_f64();
        bar.suspend(|| report((args, &job), path, *time_secs, seconds))?;
        if interrupt::is_asked() {
            bar.finish_and_clear();
            return Err(Interrupted(format!("{} is the last picture, with what was finished", path.display())).into());
        }
    }
    bar.finish_and_clear();
    Ok(())
}

fn write_picture(
    renderer: &mut Renderer,
    (job, args): (&Job, &RenderArgs),
    (path, time_secs): (&Path, f64),
    tell: &dyn Fn(f32),
) -> Result<()> {
    let preset = Preset { scene: job.preset.at(time_secs), ..job.preset.clone() };
    let (quality, content) = (&job.quality, job.content);
    let frame =
        Frame { scene: &preset.scene, quality, size: job.size, time_secs, output: content.output(), window: None };
    let about = About { preset: &preset, quality, time_secs };
    let failed = || format!("{} could not be rendered", path.display());
    let not_finished = || Interrupted(format!("{} is not finished and was not written", path.display())).into();
    if args.watch {
        watch(renderer, &frame).with_context(|| format!("{} was not written", path.display()))?;
    }
    let Some(goal) = job.goal else {
        let mut proceed = |share: f32| {
            tell(share);
            if interrupt::is_asked() { Proceed::No } else { Proceed::On }
        };
        let (size, cube, region, brightest) = (job.size, job.cube, job.region, args.brightest);
        let frame_secs = job.preset.animation.speed / args.fps;
        let file = StillFile {
            path,
            content,
            size,
            cube,
            region,
            frame_secs,
            brightest,
            largest_whole: LARGEST_WHOLE_PX,
            about,
        };
        return match file.render(renderer, &mut proceed) {
            Ok(true) => Ok(()),
            Ok(false) => Err(not_finished()),
            Err(StillError::Render(error)) => Err(anyhow::Error::new(error).context(failed())),
            Err(error @ (StillError::CubeOfLayers | StillError::TooLarge)) => Err(Usage(error.to_string()).into()),
            Err(StillError::File(error)) => {
                // Of a part, another one may be at fault; a large whole is more than the device holds.
                let is_whole = job.cube.is_none() && job.region.is_none() && !file.is_large();
                if is_whole && matches!(error, FileError::Export(ExportError::NonFinite { .. })) {
                    // The pass that wrote it says more than the pixel.
                    watch(renderer, &frame).with_context(|| format!("{} was not written", path.display()))?;
                }
                Err(error.into())
            }
        };
    };
    let truth = converge(renderer, &frame, goal).with_context(failed)?;
    if !truth.progress().is_done && job.pictures.len() > 1 {
        // The next run would take it for a finished one.
        return Err(not_finished());
    }
    eprintln!("{}: {}", path.display(), describe(goal, &truth.progress()));
    match content {
        Content::Linear(options) | Content::CloudsAlone(options, _) => {
            let mut image = truth.picture(renderer)?.image;
            match (content, args.brightest) {
                (Content::CloudsAlone(_, alpha), _) => alpha.apply(&mut image),
                (_, Some(brightest)) => soften(&mut image.rgba, brightest),
                _ => {}
            }
            save_exr(path, image, &about, options)?;
        }
        _ => {
            let (size, pixels) = renderer.rgba8_of(&truth.into_display())?;
            save_png(path, size, &pixels, &about)?;
        }
    }
    Ok(())
}

/// Finds the pass that first writes a value that is not finite.
fn watch(renderer: &mut Renderer, frame: &Frame<'_>) -> Result<()> {
    renderer.render(&Frame { output: Output::Linear, ..*frame })?;
    match renderer.find_broken()?.first() {
        Some(broken) => anyhow::bail!("{broken}; `nephoscope verify` says whether this is the driver"),
        None => Ok(()),
    }
}

/// Steps of the progress bar for each picture.
const STEPS: u64 = 1000;

fn progress(count: usize) -> ProgressBar {
    let is_shown = std::io::stderr().is_terminal();
    let target = if is_shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(count as u64 * STEPS), target);
    let style = ProgressStyle::with_template("{wide_bar} {percent} % {msg} {eta}");
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

fn report((args, job): (&RenderArgs, &Job), path: &Path, time_secs: f64, seconds: f64) -> Result<()> {
    let [width, height] = match (job.cube, job.region) {
        (Some(CubeLayout::Cross), _) => [4 * job.size[0], 3 * job.size[1]],
        (_, Some([_, part])) => part,
        _ => job.size,
    };
    if args.json {
        let line = json!({
            "path": files_of_still(path, job.cube)[0].display().to_string(),
            "width": width,
            "height": height,
            "time_secs": time_secs,
            "seconds": seconds,
        });
        return print(&format!("{line}\n"));
    }
    let paths = files_of_still(path, job.cube);
    paths.iter().try_for_each(|path| print(&format!("{} {width}x{height}, {seconds:.1} s\n", path.display())))
}
