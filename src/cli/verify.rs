//! `verify`: checks of whole frames on this machine: known light first, then skies.

use anyhow::Result;
use clap::Args;

use super::skies::{self, SkiesArgs};
use super::{Device, print};
use crate::files;
use crate::gpu::Gpu;
use crate::lab::verify::{Check, analytic, hard_cases, single_scattering_agrees, stays_finite};
use crate::render::Renderer;
use crate::scene::builtin::BUILTINS;

#[derive(Debug, Args)]
pub(super) struct VerifyArgs {
    /// Skies to check: built-in names or files; the first built-in one if none is given.
    #[arg(value_name = "SKIES")]
    of: Vec<std::path::PathBuf>,
    /// The hard cases alone.
    #[arg(long, conflicts_with_all = ["full", "skies"])]
    hard: bool,
    /// Check all built-in skies, larger, with more paths and from more places. Takes many minutes on a processor.
    #[arg(long)]
    full: bool,
    /// Print JSON, one check a line.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    drawn: SkiesArgs,
    #[command(flatten)]
    device: Device,
}

impl VerifyArgs {
    fn verdict(&self, all: &[Check], gpu: &Gpu) -> Result<()> {
        let failed = all.iter().filter(|check| !check.holds).count();
        if failed > 0 {
            return Err(Failed { failed, count: all.len(), adapter: gpu.description() }.into());
        }
        if self.json { Ok(()) } else { print(&format!("all {} checks hold\n", all.len())) }
    }

    fn tell(&self, check: &Check) -> Result<()> {
        if self.json {
            let line = serde_json::json!({ "name": check.name, "holds": check.holds, "figure": check.figure });
            return print(&format!("{line}\n"));
        }
        print(&format!("{}\n", check.line()))
    }
}

/// Some promise does not hold.
#[derive(Debug, thiserror::Error)]
#[error("{failed} of {count} checks failed on {adapter}")]
struct Failed {
    failed: usize,
    count: usize,
    adapter: String,
}

pub(super) fn run(args: &VerifyArgs) -> Result<()> {
    let builtin = if args.full { BUILTINS } else { &BUILTINS[..1] };
    let names = if args.of.is_empty() {
        builtin.iter().map(|builtin| std::path::PathBuf::from(builtin.name)).collect()
    } else {
        args.of.clone()
    };
    let skies = names.iter().map(|name| files::open(name)).collect::<Result<Vec<_>, _>>()?;
    let gpu = Gpu::headless(&args.device.choice())?;
    if !args.json {
        print(&format!("{}\n", gpu.description()))?;
    }
    let mut renderer = Renderer::new(&gpu)?;
    if let Some(count) = args.drawn.skies {
        let checks = skies::run(&mut renderer, &args.drawn, count)?;
        checks.iter().try_for_each(|check| args.tell(check))?;
        return args.verdict(&checks, &gpu);
    }
    if args.hard {
        let checks = hard_cases(&mut renderer)?;
        checks.iter().try_for_each(|check| args.tell(check))?;
        return args.verdict(&checks, &gpu);
    }
    let (size, paths, views) = if args.full { ([64, 36], 128, 20) } else { ([32, 18], 64, 4) };
    let mut all: Vec<Check> = analytic(&mut renderer, args.full)?;
    all.iter().try_for_each(|check| args.tell(check))?;
    let mut hard = hard_cases(&mut renderer)?;
    hard.iter().try_for_each(|check| args.tell(check))?;
    all.append(&mut hard);
    for sky in &skies {
        let named = (sky.preset.name.as_str(), &sky.preset.scene);
        let mut checks = single_scattering_agrees(&mut renderer, named, (size, paths), &mut |_| {})?;
        checks.push(stays_finite(&mut renderer, named, (size, views))?);
        checks.iter().try_for_each(|check| args.tell(check))?;
        all.append(&mut checks);
    }
    args.verdict(&all, &gpu)
}
