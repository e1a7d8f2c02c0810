//! `export`: maps, noises and tables of a sky as pictures.

use std::path::PathBuf;

use anyhow::{Context as _, Result};
use clap::Args;

use super::error::Usage;
use super::{Device, Edits, args, print};
use crate::files::{self, About, save_table};
use crate::gpu::Gpu;
use crate::render::Renderer;
use crate::render::tables::TableKind;
use crate::scene::nearest::did_you_mean;
use crate::scene::param::Choice as _;
use crate::scene::{Frame, Output, Quality};

#[derive(Debug, Args)]
#[command(
    after_help = "Parts: weather-map, shape-noise, worley-noise, octave-noise, detail-noise, curl-noise, relief, clear-ways, \
    sky-transmittance, sky-multiscatter, sky-view. A volume becomes a sheet with its slices below each other."
)]
pub(super) struct ExportArgs {
    /// A preset (.ron), an exported .exr or .png, a voxel grid (.json), or the name of a built-in sky.
    scene: PathBuf,
    /// Which part.
    #[arg(long, value_name = "PART")]
    what: String,
    /// File to write: .exr, 32 bits; or .png, 16 bits, 0 to 1.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Seconds since the scene began.
    #[arg(long, value_parser = args::finite, default_value = "0", value_name = "SECONDS", allow_negative_numbers = true)]
    time: f64,
    #[command(flatten)]
    edits: Edits,
    #[command(flatten)]
    device: Device,
}

pub(super) fn run(args: &ExportArgs) -> Result<()> {
    let kind = TableKind::ALL.iter().copied().find(|kind| kind.title() == args.what);
    let Some(kind) = kind else {
        let known = TableKind::ALL.iter().map(|kind| kind.title());
        let hint = did_you_mean(&args.what, known);
        return Err(Usage(format!("there is no part {}{hint}; `export --help` lists them", args.what)).into());
    };
    let ending = args.output.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    if !matches!(ending.as_deref(), Some("exr" | "png")) {
        return Err(Usage(format!("-o {} ends neither in .exr nor in .png", args.output.display())).into());
    }
    let mut preset = files::open(&args.scene)?.preset;
    let mut quality = Quality::default();
    preset.set_all(&args.edits.sets, &mut quality)?;
    preset.play(args.time);
    let gpu = Gpu::headless(&args.device.choice())?;
    let mut renderer = Renderer::new(&gpu)?;
    let (scene, time_secs) = (&preset.scene, args.time);
    let frame = Frame { scene, quality: &quality, size: [1280, 720], time_secs, output: Output::Display, window: None };
    let table = renderer.table(&frame, kind).with_context(|| format!("{} could not be made", args.what))?;
    let Some(table) = table else {
        let said = format!("{} has no {}: nothing that it shows is made from one", args.scene.display(), args.what);
        return Err(Usage(said).into());
    };
    let [width, height] = table.size;
    let about = About { preset: &preset, quality: &quality, time_secs };
    save_table(&args.output, table, &about)?;
    print(&format!("{} {width}x{height}\n", args.output.display()))
}
