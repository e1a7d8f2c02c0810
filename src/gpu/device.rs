//! Opens a device: for a window, without one, or the software driver that tests rely on.

use std::sync::{Arc, Mutex, OnceLock};

use super::{GpuError, unchecked};

/// Which adapter to open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The one the system prefers; `NEPHOSCOPE_ADAPTER` may name another.
    #[default]
    Preferred,
    /// A software (CPU) adapter.
    Software,
    /// The first whose name contains this text, whatever the case.
    Named(String),
}

impl AdapterChoice {
    /// The choice written as `--adapter` takes it: nothing, `cpu`, or a part of a name.
    pub fn from_text(text: Option<&str>) -> Self {
        let from_env = std::env::var("NEPHOSCOPE_ADAPTER").ok();
        match text.or(from_env.as_deref()) {
            None | Some("") => Self::Preferred,
            Some("cpu" | "software") => Self::Software,
            Some(name) => Self::Named(name.to_owned()),
        }
    }

    fn phrase(&self) -> String {
        match self {
            Self::Preferred => String::new(),
            Self::Software => " of the software kind".to_owned(),
            Self::Named(name) => format!(" named like {name:?}"),
        }
    }
}

/// An open device with its queue and what is known of it.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The instance that surfaces are made with.
    pub instance: wgpu::Instance,
    /// The adapter behind the device.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its one queue.
    pub queue: wgpu::Queue,
    /// Name, driver and kind of the adapter.
    pub info: wgpu::AdapterInfo,
    /// The first error that no scope caught, until somebody takes it.
    uncaught: Arc<Mutex<Option<String>>>,
    /// Why the device is lost, if it is: for good.
    lost: Arc<Mutex<Option<String>>>,
    /// Programs that the driver has compiled, where it can give them away.
    pipelines: Arc<OnceLock<wgpu::PipelineCache>>,
}

impl Gpu {
    /// Opens a device that needs no window.
    pub fn headless(choice: &AdapterChoice) -> Result<Self, GpuError> {
        pollster::block_on(Self::open(Self::new_instance(), choice, None))
    }

    /// The software driver the tests run on; a missing one is an error, never a skipped test.
    pub fn software() -> Result<Self, GpuError> {
        Self::headless(&AdapterChoice::Named("llvmpipe".to_owned()))
    }

    /// Opens a device that can present to `surface`, which was made by `instance`.
    pub fn for_surface(
        instance: wgpu::Instance,
        choice: &AdapterChoice,
        surface: &wgpu::Surface<'_>,
    ) -> Result<Self, GpuError> {
        pollster::block_on(Self::open(instance, choice, Some(surface)))
    }

    /// The instance, with backends from `WGPU_BACKEND` where that is set.
    pub fn new_instance() -> wgpu::Instance {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        if std::env::var_os("WGPU_BACKEND").is_none() {
            descriptor.backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
        }
        wgpu::Instance::new(descriptor)
    }

    /// All adapters of this machine, as `info` lists them.
    pub fn adapters() -> Vec<wgpu::AdapterInfo> {
        let adapters = pollster::block_on(Self::new_instance().enumerate_adapters(wgpu::Backends::all()));
        adapters.iter().map(wgpu::Adapter::get_info).collect()
    }

    async fn open(
        instance: wgpu::Instance,
        choice: &AdapterChoice,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, GpuError> {
        let adapter = Self::choose(&instance, choice, surface).await?;
        let info = adapter.get_info();
        let optional = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::PIPELINE_CACHE;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("nephoscope"),
            required_features: adapter.features() & optional,
            required_limits: Self::limits(&adapter),
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..Default::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), message: error.to_string() })?;
        let uncaught = Arc::new(Mutex::new(None));
        let slot = Arc::clone(&uncaught);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut slot) = slot.lock() {
                slot.get_or_insert_with(|| error.to_string());
            }
        }));
        let lost = Arc::new(Mutex::new(None));
        let slots = [Arc::clone(&uncaught), Arc::clone(&lost)];
        device.set_device_lost_callback(move |_, message| {
            for slot in &slots {
                if let Ok(mut slot) = slot.lock() {
                    *slot = Some(format!("device lost: {message}"));
                }
            }
        });
        Ok(Self { instance, adapter, device, queue, info, uncaught, lost, pipelines: Arc::default() })
    }

    /// WebGPU's defaults; images may be as large as the adapter allows.
    fn limits(adapter: &wgpu::Adapter) -> wgpu::Limits {
        let theirs = adapter.limits();
        wgpu::Limits {
            max_texture_dimension_2d: theirs.max_texture_dimension_2d,
            max_buffer_size: theirs.max_buffer_size.min(1 << 30),
            ..wgpu::Limits::default()
        }
    }

    async fn choose(
        instance: &wgpu::Instance,
        choice: &AdapterChoice,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<wgpu::Adapter, GpuError> {
        if *choice == AdapterChoice::Preferred {
            let options = wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                compatible_surface: surface,
                ..Default::default()
            };
            if let Ok(adapter) = instance.request_adapter(&options).await {
                return Ok(adapter);
            }
        }
        let adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
        let names: Vec<String> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
        let fits = |adapter: &wgpu::Adapter| {
            let info = adapter.get_info();
            let chosen = match choice {
                AdapterChoice::Preferred => false,
                AdapterChoice::Software => info.device_type == wgpu::DeviceType::Cpu,
                AdapterChoice::Named(name) => info.name.to_lowercase().contains(&name.to_lowercase()),
            };
            chosen && surface.is_none_or(|surface| adapter.is_surface_supported(surface))
        };
        adapters.into_iter().find(fits).ok_or_else(|| GpuError::NoAdapter {
            wanted: choice.phrase(),
            found: if names.is_empty() { "none".to_owned() } else { names.join(", ") },
        })
    }

    /// Whether the adapter computes on the processor, where timestamps of passes lie.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// `name (driver, backend)`, for reports.
    pub fn description(&self) -> String {
        let driver = [self.info.driver.as_str(), self.info.driver_info.as_str()];
        let driver: Vec<&str> = driver.into_iter().filter(|part| !part.is_empty()).collect();
        format!("{} ({}; {:?})", self.info.name, driver.join(" "), self.info.backend)
    }

    /// Begins a cache of compiled programs, with the data of an earlier one of the same adapter and driver, if there is any;
    /// false where the driver has none. To be called once, before programs are compiled.
    pub fn begin_pipeline_cache(&self, data: Option<&[u8]>) -> bool {
        if !self.device.features().contains(wgpu::Features::PIPELINE_CACHE) {
            return false;
        }
        self.pipelines.set(unchecked::pipeline_cache(&self.device, data)).is_ok()
    }

    /// The cache that programs are compiled with.
    pub(super) fn pipeline_cache(&self) -> Option<&wgpu::PipelineCache> {
        self.pipelines.get()
    }

    /// What the driver gives away of the programs compiled so far; only it can read that.
    pub fn pipeline_data(&self) -> Option<Vec<u8>> {
        if self.is_lost() {
            return None;
        }
        self.pipelines.get()?.get_data()
    }

    /// The error of a device that is lost; every thread that holds it sees it.
    pub fn loss(&self) -> Option<GpuError> {
        self.lost.lock().ok()?.clone().map(GpuError::Device)
    }

    /// Whether the device is lost.
    pub fn is_lost(&self) -> bool {
        self.loss().is_some()
    }

    /// Takes the first error that came outside any error scope since the last call.
    pub fn take_uncaught_error(&self) -> Option<GpuError> {
        self.uncaught.lock().ok()?.take().map(GpuError::Device)
    }

    /// Waits until the device has finished all it was given.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| GpuError::Device(error.to_string()))?;
        self.take_uncaught_error().map_or(Ok(()), Err)
    }

    /// Runs `create` and returns the validation error it caused, if any.
    pub fn checked<T>(&self, create: impl FnOnce() -> T) -> Result<T, String> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let created = create();
        match pollster::block_on(scope.pop()) {
            None => Ok(created),
            Some(error) => Err(error.to_string()),
        }
    }

    /// A uniform buffer holding `contents`.
    pub fn uniform(&self, label: &str, contents: &[u8]) -> wgpu::Buffer {
        let size = contents.len().next_multiple_of(16) as u64;
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, contents);
        buffer
    }
}
