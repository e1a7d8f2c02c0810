//! `grid`: the clouds of a sky as voxels, for other renderers.

use std::path::PathBuf;

use anyhow::Result;
use clap::{Args, ValueEnum};

use super::error::Usage;
use super::{Device, Edits, args, print};
use crate::files::{self, VoxelFormat, save_grid, save_vdb};
use crate::gpu::Gpu;
use crate::images::voxels::{UpAxis, VdbOptions};
use crate::plan::{Effect, FramePlan};
use crate::render::Renderer;
use crate::scene::{DomainKind, Frame, Output, Quality};

#[derive(Debug, Args)]
pub(super) struct GridArgs {
    /// A preset (.ron), an exported .exr or .png, a voxel grid (.json), or the name of a built-in sky. Its box is baked, or
    /// the clouds of its shell where the box stands.
    scene: PathBuf,
    /// A description to write, .json, with the voxels beside it; or an `OpenVDB` file, .vdb.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Voxels from west to east and from north to south; half as many upwards.
    #[arg(long, default_value = "128", value_parser = clap::value_parser!(u32).range(4..=512))]
    voxels: u32,
    /// Format of the voxels.
    #[arg(long, default_value = "npy")]
    format: Format,
    /// Which way is up in a .vdb: z as in Blender, y as in Houdini and Maya.
    #[arg(long, default_value = "z")]
    up: Up,
    /// Bits of a value in a .vdb.
    #[arg(long, default_value = "half")]
    depth: Depth,
    /// Seconds since the scene began.
    #[arg(long, value_parser = args::finite, default_value = "0", value_name = "SECONDS", allow_negative_numbers = true)]
    time: f64,
    #[command(flatten)]
    edits: Edits,
    #[command(flatten)]
    device: Device,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// `NumPy`.
    Npy,
    /// Mitsuba.
    Vol,
    /// Both of them.
    Both,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Up {
    /// x east, y north, z up.
    Z,
    /// x east, y up, z south.
    Y,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Depth {
    /// 16 bits.
    Half,
    /// 32 bits.
    Float,
}

/// The size of picture for which the camera is described.
const PICTURE: [u32; 2] = [1920, 1080];

pub(super) fn run(args: &GridArgs) -> Result<()> {
    let extension = args.output.extension().and_then(|extension| extension.to_str());
    let is_vdb = match extension {
        Some("json") => false,
        Some("vdb") => true,
        _ => return Err(Usage(format!("-o {} ends neither in .json nor in .vdb", args.output.display())).into()),
    };
    let mut preset = files::open(&args.scene)?.preset;
    let mut quality = Quality { grid_voxels: args.voxels, ..Quality::default() };
    preset.scene.domain.kind = DomainKind::Box;
    preset.set_all(&args.edits.sets, &mut quality)?;
    preset.play(args.time);
    let gpu = Gpu::headless(&args.device.choice())?;
    let mut renderer = Renderer::new(&gpu)?;
    let frame = Frame {
        scene: &preset.scene,
        quality: &quality,
        size: PICTURE,
        time_secs: args.time,
        output: Output::Linear,
        window: None,
    };
    let Some((grid, bounds)) = renderer.bake_extinction(&frame)? else {
        return Err(Usage(format!("{} has no cloud to bake: {}", preset.name, no_cloud(&frame))).into());
    };
    let format = match args.format {
        Format::Npy => VoxelFormat::Npy,
        Format::Vol => VoxelFormat::Vol,
        Format::Both => VoxelFormat::Both,
    };
    let written = if is_vdb {
        let up = match args.up {
            Up::Z => UpAxis::Z,
            Up::Y => UpAxis::Y,
        };
        save_vdb(&args.output, (&grid, bounds), VdbOptions { up, is_half: args.depth == Depth::Half })?;
        vec![args.output.clone()]
    } else {
        save_grid(&args.output, (&grid, bounds), &preset, (format, PICTURE))?
    };
    let [x, y, z] = grid.size();
    let filled = grid.values().iter().filter(|value| **value > 0.0).count() as f64 / grid.values().len() as f64;
    let names: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    print(&format!(
        "{}: {x} x {y} x {z} voxels, {:.1} % with cloud, greatest extinction {:.4} 1/m\n",
        names.join(", "),
        100.0 * filled,
        grid.greatest()
    ))
}

/// Why a frame's clouds are not baked.
fn no_cloud(frame: &Frame<'_>) -> String {
    let plan = FramePlan::of_clouds(frame);
    let verdict = [Effect::Clouds, Effect::Baked].map(|effect| plan.verdict(effect)).into_iter().find(|v| !v.runs);
    verdict.map_or_else(|| "its layers are empty".to_owned(), |verdict| verdict.because.clone())
}
