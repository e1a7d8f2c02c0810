//! The command line. Results go to stdout, progress and errors to stderr.
//!
//! Exit codes: 0 done · 1 rendering failed · 2 wrong usage · 3 no usable adapter · 4 a file could not be read or written ·
//! 130 stopped by Ctrl-C.

mod accuracy;
mod args;
mod bench;
mod compare_sky;
mod editor;
mod error;
mod export;
mod grid;
mod info;
mod integrate;
mod interrupt;
mod presets;
mod render;
mod sequence;
mod skies;
mod verify;

use std::path::PathBuf;

use anyhow::Result;
use clap::{Args, Parser, Subcommand};

pub use error::{exit_code, print_error};

use crate::gpu::AdapterChoice;

/// A desktop studio for volumetric skies.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true, after_help = EXIT_CODES)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Sky to open in the editor: a preset (.ron), an exported .exr or .png, a voxel grid (.json), or the name of a built-in sky.
    scene: Option<PathBuf>,
    #[command(flatten)]
    edits: Edits,
    #[command(flatten)]
    device: Device,
}

const EXIT_CODES: &str = "Without a command the editor opens; without a display, the sky is rendered to out/.\n\
    Exit codes: 0 done, 1 rendering failed, 2 wrong usage, 3 no usable adapter, 4 file could not be read or written, \
    130 stopped by Ctrl-C with what was finished kept.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Renders a sky to a PNG, an EXR or a Radiance file.
    Render(Box<render::RenderArgs>),
    /// Renders all directions of a sky, to light other scenes with: a panorama, or a cube map by `--projection cube`.
    Pano(Box<render::RenderArgs>),
    /// Renders numbered frames; a run that was interrupted goes on where it was.
    Sequence(Box<sequence::SequenceArgs>),
    /// Writes a map, a noise or a table that a sky is made from.
    Export(export::ExportArgs),
    /// Lists, checks and shows presets.
    #[command(subcommand)]
    Presets(presets::PresetsCommand),
    /// Says what this program and this machine are, for reports of faults.
    Info(info::InfoArgs),
    /// Measures what each pass costs.
    Bench(Box<bench::BenchArgs>),
    /// Measures how far pictures are from the truth, and what that costs.
    Accuracy(Box<accuracy::AccuracyArgs>),
    /// Measures how like a photograph skies are: light, colours, and the sizes of structures.
    CompareSky(compare_sky::CompareSkyArgs),
    /// Bakes clouds into voxels that other renderers read.
    Grid(grid::GridArgs),
    /// Checks that pictures on this machine keep what the program promises.
    Verify(verify::VerifyArgs),
}

/// Changes to the sky.
#[derive(Clone, Debug, Default, Args)]
struct Edits {
    /// Sets a parameter, such as `weather.coverage=0.6` or `quality.light_steps=8`. May be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
}

/// The device to work on.
#[derive(Clone, Debug, Default, Args)]
struct Device {
    /// Graphics adapter: a part of its name, or `cpu` for a software one.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

impl Device {
    fn choice(&self) -> AdapterChoice {
        AdapterChoice::from_text(self.adapter.as_deref())
    }
}

/// Runs the command.
///
/// # Errors
/// Whatever the command reports; [`exit_code`] sorts it.
pub fn run(cli: Cli) -> Result<()> {
    match cli.command {
        None => editor::run(cli.scene, cli.edits, &cli.device),
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Pano(args)) => render::run(&args.clone().all_directions()),
        Some(Command::Sequence(args)) => sequence::run(&args),
        Some(Command::Export(args)) => export::run(&args),
        Some(Command::Presets(command)) => presets::run(&command),
        Some(Command::Info(args)) => info::run(&args),
        Some(Command::Bench(args)) => bench::run(&args),
        Some(Command::Accuracy(args)) => accuracy::run(&args),
        Some(Command::CompareSky(args)) => compare_sky::run(&args),
        Some(Command::Grid(args)) => grid::run(&args),
        Some(Command::Verify(args)) => verify::run(&args),
    }
}

/// Writes to stdout; a reader that has gone away is no error.
fn print(text: &str) -> Result<()> {
    use std::io::{ErrorKind, Write as _};
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(anyhow::Error::new(error).context("cannot write to the standard output"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    #[test]
    fn the_declaration_is_sound() {
        super::Cli::command().debug_assert();
    }
}
