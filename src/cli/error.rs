//! Sorts errors into exit codes and prints them.

use std::io::IsTerminal as _;
use std::process::ExitCode;

use super::interrupt::Interrupted;
use crate::export::ExportError;
use crate::files::FileError;
use crate::gpu::GpuError;
use crate::images::ImageError;
use crate::images::pattern::PatternError;
use crate::render::RenderError;
use crate::scene::PresetError;
use crate::scene::edit::EditError;

/// An argument that clap lets through but that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct Usage(pub(super) String);

const RENDERING: u8 = 1;
const USAGE: u8 = 2;
const ADAPTER: u8 = 3;
const FILE: u8 = 4;
/// What shells take for an end by Ctrl-C.
pub(super) const INTERRUPTED: u8 = 130;

/// The exit code of an error.
pub fn exit_code(error: &anyhow::Error) -> ExitCode {
    ExitCode::from(error.chain().find_map(code_of).unwrap_or(RENDERING))
}

fn code_of(cause: &(dyn std::error::Error + 'static)) -> Option<u8> {
    if let Some(error) = cause.downcast_ref::<RenderError>() {
        return Some(match error {
            RenderError::Gpu(gpu) => code_of_gpu(gpu),
            RenderError::Map { .. } | RenderError::Grid { .. } => FILE,
        });
    }
    if let Some(error) = cause.downcast_ref::<GpuError>() {
        return Some(code_of_gpu(error));
    }
    if cause.is::<Usage>() || cause.is::<EditError>() || cause.is::<PatternError>() {
        return Some(USAGE);
    }
    if cause.is::<Interrupted>() {
        return Some(INTERRUPTED);
    }
    let is_file = cause.is::<FileError>()
        || cause.is::<ExportError>()
        || cause.is::<PresetError>()
        || cause.is::<ImageError>()
        || cause.is::<std::io::Error>();
    is_file.then_some(FILE)
}

fn code_of_gpu(error: &GpuError) -> u8 {
    match error {
        GpuError::NoAdapter { .. } | GpuError::NoDevice { .. } => ADAPTER,
        _ => RENDERING,
    }
}

/// Prints an error and its causes to stderr, each once.
pub fn print_error(error: &anyhow::Error) {
    let no_colour = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let (red, plain) =
        if std::io::stderr().is_terminal() && !no_colour { ("\u{1b}[1;31m", "\u{1b}[0m") } else { ("", "") };
    let mut told = error.to_string();
    eprintln!("{red}error:{plain} {told}");
    for cause in error.chain().skip(1) {
        let text = cause.to_string();
        // Many messages already end in the words of their cause.
        if !told.contains(&text) {
            eprintln!("  because: {text}");
            told = text;
        }
    }
}
