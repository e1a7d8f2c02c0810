//! The one place with unsafe code: turning off a check which naga adds to shaders, and handing a driver its own data back.
//!
//! naga adds a counter to every loop, so that even an endless one ends. It keeps drivers from unrolling loops, and with
//! that from seeing that indices are constant. The loops of this program's shaders all end by a count of their own, so
//! they are compiled without; checks of array bounds stay. `NEPHOSCOPE_SHADER_CHECKS=all` turns all checks on.

/// Which checks naga adds to shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShaderChecks {
    /// Bounds of arrays and ends of loops.
    All,
    /// Bounds of arrays alone.
    Bounds,
}

impl ShaderChecks {
    /// The checks this process compiles shaders with.
    pub fn in_use() -> Self {
        match std::env::var("NEPHOSCOPE_SHADER_CHECKS").as_deref() {
            Ok("all") => Self::All,
            _ => Self::Bounds,
        }
    }

    /// The words printed beside measurements.
    pub fn label(self) -> &'static str {
        match self {
            Self::All => "bounds and loops checked",
            Self::Bounds => "bounds checked, loops trusted",
        }
    }
}

/// A shader module with the checks in use.
#[allow(unsafe_code, reason = "wgpu marks the choice of runtime checks unsafe; every loop of our shaders is counted")]
pub(super) fn shader_module(device: &wgpu::Device, descriptor: wgpu::ShaderModuleDescriptor<'_>) -> wgpu::ShaderModule {
    let checks = wgpu::ShaderRuntimeChecks {
        force_loop_bounding: ShaderChecks::in_use() == ShaderChecks::All,
        ..wgpu::ShaderRuntimeChecks::checked()
    };
    // SAFETY: without loop bounding a shader must not loop for ever. All loops of the embedded shaders run to a counted
    // end; only somebody who edits them on disk (NEPHOSCOPE_SHADERS) can write one that does not.
    unsafe { device.create_shader_module_trusted(descriptor, checks) }
}

/// A cache of compiled programs, begun with what an earlier one of the same driver gave away.
#[allow(unsafe_code, reason = "wgpu marks it unsafe, as drivers trust their own data")]
pub(super) fn pipeline_cache(device: &wgpu::Device, data: Option<&[u8]>) -> wgpu::PipelineCache {
    let descriptor = wgpu::PipelineCacheDescriptor { label: Some("programs"), data, fallback: true };
    // SAFETY: data has to come from `PipelineCache::get_data`. Whoever reads it from a file checks a sum over it and over the
    // driver's name and version (files/programs.rs); wgpu checks the device's and the driver's identity again.
    unsafe { device.create_pipeline_cache(&descriptor) }
}
