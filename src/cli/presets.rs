//! `presets`: lists, checks and shows presets.

use std::path::PathBuf;

use anyhow::Result;
use clap::Subcommand;
use serde_json::json;

use super::print;
use crate::files::{self, FileError};
use crate::scene::builtin::BUILTINS;

#[derive(Debug, Subcommand)]
pub(super) enum PresetsCommand {
    /// Lists the built-in skies.
    List {
        /// Print JSON, one sky a line.
        #[arg(long)]
        json: bool,
    },
    /// Checks files: presets, or pictures with one inside.
    Validate {
        /// The files.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// Prints a sky as a preset in the current version.
    Show {
        /// A built-in sky or a file.
        name: PathBuf,
    },
}

pub(super) fn run(command: &PresetsCommand) -> Result<()> {
    match command {
        PresetsCommand::List { json } => list(*json),
        PresetsCommand::Validate { files } => validate(files),
        PresetsCommand::Show { name } => print(&files::open(name)?.preset.to_ron()),
    }
}

fn list(json: bool) -> Result<()> {
    let width = BUILTINS.iter().map(|builtin| builtin.name.len()).max().unwrap_or(0);
    for builtin in BUILTINS {
        let preset = builtin.preset()?;
        if json {
            let line = json!({
                "name": builtin.name,
                "title": preset.name,
                "description": preset.description,
                "tags": preset.tags,
            });
            print(&format!("{line}\n"))?;
        } else {
            print(&format!("{:width$}  {}: {}\n", builtin.name, preset.name, preset.description))?;
        }
    }
    Ok(())
}

/// Reports every file; the first refusal decides the exit code.
fn validate(files: &[PathBuf]) -> Result<()> {
    let mut first: Option<FileError> = None;
    for file in files {
        match files::open(file) {
            Ok(sky) => print(&format!("{}: {} is sound\n", file.display(), sky.preset.name))?,
            Err(error) => {
                if let Some(earlier) = first.replace(error) {
                    eprintln!("error: {earlier}");
                }
            }
        }
    }
    first.map_or(Ok(()), |error| Err(error.into()))
}
