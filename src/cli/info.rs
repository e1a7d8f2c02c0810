//! `info`: what this program and this machine are.

use anyhow::Result;
use clap::Args;
use serde_json::{Value, json};

use super::{Device, print};
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
    if args.json { print(&format!("{}\n", as_json(gpu.as_ref()))) } else { print(&as_text(gpu.as_ref())) }
}

fn system() -> String {
    format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)
}

fn as_text(gpu: Option<&Gpu>) -> String {
    let mut text = format!("nephoscope {}\n", env!("CARGO_PKG_VERSION"));
    text.push_str(&format!("preset format  {PRESET_VERSION}\nsystem         {}\n", system()));
    text.push_str(&format!("processors     {}\n", processors()));
    match gpu {
        Some(gpu) => {
            text.push_str(&format!("in use         {}\n", gpu.description()));
            text.push_str(&format!("timing         {}\n", TimingSource::of(gpu).label()));
            text.push_str(&format!("largest image  {} px\n", gpu.device.limits().max_texture_dimension_2d));
        }
        None => text.push_str("in use         no adapter\n"),
    }
    for adapter in Gpu::adapters() {
        text.push_str(&format!("adapter        {} ({:?}, {:?})\n", adapter.name, adapter.device_type, adapter.backend));
    }
    text
}

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
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
        "system": system(),
        "processors": processors(),
        "in_use": gpu.map(Gpu::description),
        "timing": gpu.map(|gpu| TimingSource::of(gpu).label()),
        "adapters": Gpu::adapters().into_iter().map(adapter).collect::<Vec<_>>(),
    })
}
