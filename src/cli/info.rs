//! `info`: what this program and this machine are.

use anyhow::Result;
use clap::Args;
use serde_json::{Value, json};

use super::{Device, print};
use crate::app::about;
use crate::gpu::{AdapterChoice, Gpu, TimingSource};
use crate::scene::{PRESET_VERSION, reference_docs};

#[derive(Debug, Args)]
pub(super) struct InfoArgs {
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// Print the reference of all parameters (docs/parameters.md).
    #[arg(long, hide = true)]
    parameters: bool,
    #[command(flatten)]
    device: Device,
}

pub(super) fn run(args: &InfoArgs) -> Result<()> {
    if args.parameters {
        return print(&reference_docs::markdown());
    }
    let choice = args.device.choice();
    let gpu = match Gpu::headless(&choice) {
        Ok(gpu) => Some(gpu),
        // Without a wish, a machine that has no adapter is worth describing too.
        Err(error) if choice == AdapterChoice::Preferred => {
            eprintln!("warning: {error}");
            None
        }
        Err(error) => return Err(error.into()),
    };
    if args.json { print(&format!("{}\n", as_json(gpu.as_ref()))) } else { print(&about::this(gpu.as_ref())) }
}

fn as_json(gpu: Option<&Gpu>) -> Value {
    let adapter = |adapter: wgpu::AdapterInfo| {
        json!({
            "name": adapter.name,
            "kind": format!("{:?}", adapter.device_type),
            "backend": format!("{:?}", adapter.backend),
            "driver": format!("{} {}", adapter.driver, adapter.driver_info).trim(),
        })
    };
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "preset_version": PRESET_VERSION,
        "system": about::system(),
        "processors": about::processors(),
        "in_use": gpu.map(Gpu::description),
        "timing": gpu.map(|gpu| TimingSource::of(gpu).label()),
        "adapters": Gpu::adapters().into_iter().map(adapter).collect::<Vec<_>>(),
    })
}
