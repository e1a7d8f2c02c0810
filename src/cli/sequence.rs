//! `sequence`: numbered pictures, and a film of them by the user's ffmpeg.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result};
use clap::Args;

use super::error::Usage;
use super::render::{self, RenderArgs};

#[derive(Debug, Args)]
pub(super) struct SequenceArgs {
    #[command(flatten)]
    render: RenderArgs,
    /// Make a film of the frames, all of them .png, with the ffmpeg that is installed: .mp4, .mov, .mkv or .webm.
    #[arg(long, value_name = "FILE")]
    video: Option<PathBuf>,
}

pub(super) fn run(args: &SequenceArgs) -> Result<()> {
    let mut render = args.render.clone();
    render.fit_frames()?;
    let Some(video) = &args.video else { return render::run(&render) };
    // What cannot come to an end is not begun.
    if !matches!(ending(video).as_str(), "mp4" | "mov" | "mkv" | "webm") {
        let said = format!("--video {} ends neither in .mp4 nor in .mov, .mkv or .webm", video.display());
        return Err(Usage(said).into());
    }
    if ending(render.output()) != "png" {
        return Err(
            Usage("--video needs frames as -o NAME.####.png, which are what the screen shows".to_owned()).into()
        );
    }
    let version = Command::new("ffmpeg").arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if !version.is_ok_and(|status| status.success()) {
        let said = "--video needs ffmpeg, which cannot be run here; install it, or leave --video out and make the film from \
                    the frames elsewhere";
        return Err(Usage(said.to_owned()).into());
    }
    render::check_target(video)?;
    let frames = render.files()?;
    render::run(&render)?;
    film(&frames, render.fps(), video).with_context(|| format!("{} could not be made", video.display()))?;
    if render.is_json() {
        let line = serde_json::json!({ "path": video.display().to_string(), "frames": frames.len() });
        return super::print(&format!("{line}\n"));
    }
    super::print(&format!("{} {} frames\n", video.display(), frames.len()))
}

fn ending(path: &Path) -> String {
    path.extension().map_or_else(String::new, |ending| ending.to_string_lossy().to_lowercase())
}

/// Has ffmpeg read a list of the frames, so that they may be any, and write the film beside its place before it goes there.
fn film(frames: &[PathBuf], fps: f64, video: &Path) -> Result<()> {
    let mut list = tempfile::NamedTempFile::new()?;
    for frame in frames {
        let path = std::path::absolute(frame)?;
        // The list's own way of quoting.
        let quoted = path.display().to_string().replace('\'', "'\\''");
        writeln!(list, "file '{quoted}'\nduration {}", 1.0 / fps)?;
    }
    list.flush()?;
    let folder = video.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = tempfile::tempdir_in(folder)?;
    let film = beside.path().join(format!("film.{}", ending(video)));
    let output = Command::new("ffmpeg")
        .args(["-y", "-loglevel", "error", "-f", "concat", "-safe", "0", "-i"])
        .arg(list.path())
        .args(["-r", &fps.to_string(), "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"])
        .arg(&film)
        .stdin(Stdio::null())
        .output()?;
    anyhow::ensure!(output.status.success(), "ffmpeg said: {}", String::from_utf8_lossy(&output.stderr).trim());
    // Nothing of an earlier film is lost before this one is whole.
    Ok(std::fs::rename(&film, video)?)
}
