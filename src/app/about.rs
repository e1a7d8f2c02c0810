//! What this program and this machine are, in words for a bug report.

use crate::gpu::{Gpu, TimingSource};
use crate::scene::PRESET_VERSION;

/// Processors that this program may use.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Operating system and kind of processor.
pub fn system() -> String {
    format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)
}

/// A few lines about the program, the machine and the device in use.
pub fn this(gpu: Option<&Gpu>) -> String {
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
