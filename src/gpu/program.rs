//! Compiled shaders that know their bindings by name.
//!
//! A pass never declares a layout: the shader text does, once. [`Program`] reads the names of the bindings its entry
//! point really uses from naga, so a binding that `#if` left out is neither in the layout nor asked for.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex};

use super::{Gpu, GpuError, Job, unchecked};
use crate::shader::{self, ShaderSource};

/// One compiled form of one shader file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ProgramKey {
    /// The file below `shaders/` that holds the entry point `main`.
    pub file: &'static str,
    /// The flags of `#if` that are on.
    pub flags: BTreeSet<&'static str>,
    /// Values of `override` constants.
    pub constants: Vec<(&'static str, u32)>,
}

impl ProgramKey {
    /// The plain form of a file: no flag, no constant.
    pub fn plain(file: &'static str) -> Self {
        Self { file, flags: BTreeSet::new(), constants: Vec::new() }
    }

    /// The same with these flags on.
    #[must_use]
    pub fn with_flags(mut self, flags: impl IntoIterator<Item = &'static str>) -> Self {
        self.flags.extend(flags);
        self
    }

    /// The same with an `override` constant set.
    #[must_use]
    pub fn with_constant(mut self, name: &'static str, value: u32) -> Self {
        self.constants.push((name, value));
        self
    }
}

impl std::fmt::Display for ProgramKey {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}", self.file)?;
        for flag in &self.flags {
            write!(formatter, " {flag}")?;
        }
        for (name, value) in &self.constants {
            write!(formatter, " {name}={value}")?;
        }
        Ok(())
    }
}

/// What the composer may be asked for: the closed list of flags and the structs written by `gpu_struct!`.
#[derive(Clone, Copy, Debug)]
pub struct ShaderTable {
    /// Every flag any shader knows.
    pub flags: &'static [&'static str],
    /// `(name, WGSL)` of every generated struct.
    pub structs: &'static [(&'static str, &'static str)],
}

impl ShaderTable {
    /// Composes and validates one variant.
    pub fn compose(&self, key: &ProgramKey) -> Result<(ShaderSource, Vec<Binding>), GpuError> {
        let source = shader::compose(key.file, &key.flags, self.flags, self.structs)?;
        let (module, info) = shader::validate(&source)?;
        Ok((source, used_bindings(&module, &info)))
    }
}

/// A resource that the entry point uses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// The shader's name for it.
    pub name: String,
    /// Bind group.
    pub group: u32,
    /// Number in the group.
    pub binding: u32,
}

fn used_bindings(module: &wgpu::naga::Module, info: &wgpu::naga::valid::ModuleInfo) -> Vec<Binding> {
    if module.entry_points.is_empty() {
        return Vec::new();
    }
    let entry = info.get_entry_point(0);
    let mut bindings: Vec<Binding> = module
        .global_variables
        .iter()
        .filter(|(handle, _)| !entry[*handle].is_empty())
        .filter_map(|(_, variable)| {
            let place = variable.binding.as_ref()?;
            Some(Binding { name: variable.name.clone()?, group: place.group, binding: place.binding })
        })
        .collect();
    bindings.sort_by_key(|binding| (binding.group, binding.binding));
    bindings
}

/// A compiled shader.
#[derive(Clone, Debug)]
pub struct Program {
    pipeline: wgpu::ComputePipeline,
    bindings: Vec<Binding>,
}

/// Resources by the name the shader gives them; names a variant does not use are passed over.
pub type Resources<'a> = [(&'static str, wgpu::BindingResource<'a>)];

impl Program {
    fn compile(gpu: &Gpu, table: ShaderTable, key: &ProgramKey) -> Result<Self, GpuError> {
        let (source, bindings) = table.compose(key)?;
        let label = key.to_string();
        let constants: Vec<(&str, f64)> =
            key.constants.iter().map(|(name, value)| (*name, f64::from(*value))).collect();
        let pipeline = gpu
            .checked(|| {
                let descriptor = wgpu::ShaderModuleDescriptor {
                    label: Some(&label),
                    source: wgpu::ShaderSource::Wgsl(source.code.into()),
                };
                let module = unchecked::shader_module(&gpu.device, descriptor);
                gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(&label),
                    layout: None,
                    module: &module,
                    entry_point: Some("main"),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &constants,
                        zero_initialize_workgroup_memory: false,
                    },
                    cache: gpu.pipeline_cache(),
                })
            })
            .map_err(|message| GpuError::Pipeline { program: label.clone(), message })?;
        Ok(Self { pipeline, bindings })
    }

    /// One dispatch of `grid` workgroups with everything this program uses bound from `resources`.
    pub fn job(
        &self,
        gpu: &Gpu,
        pass: &'static str,
        resources: &Resources<'_>,
        grid: [u32; 3],
    ) -> Result<Job, GpuError> {
        let mut groups = Vec::new();
        let highest = self.bindings.last().map_or(0, |binding| binding.group + 1);
        for group in 0..highest {
            let mut entries = Vec::new();
            for binding in self.bindings.iter().filter(|binding| binding.group == group) {
                let (_, resource) = resources
                    .iter()
                    .find(|(name, _)| *name == binding.name)
                    .ok_or_else(|| GpuError::MissingResource { pass, name: binding.name.clone() })?;
                entries.push(wgpu::BindGroupEntry { binding: binding.binding, resource: resource.clone() });
            }
            if !entries.is_empty() {
                let layout = self.pipeline.get_bind_group_layout(group);
                let descriptor = wgpu::BindGroupDescriptor { label: Some(pass), layout: &layout, entries: &entries };
                groups.push((group, gpu.device.create_bind_group(&descriptor)));
            }
        }
        Ok(Job::new(pass, self.pipeline.clone(), groups, grid))
    }

    /// The names of all resources this variant binds.
    pub fn binding_names(&self) -> impl Iterator<Item = &str> {
        self.bindings.iter().map(|binding| binding.name.as_str())
    }
}

enum Slot {
    Compiling,
    Ready(Arc<Program>),
    Failed(String),
}

/// Owns every compiled program; compiles in the background on request.
#[derive(Clone)]
pub struct ProgramCache {
    gpu: Gpu,
    table: ShaderTable,
    slots: Arc<Mutex<HashMap<ProgramKey, Slot>>>,
}

impl std::fmt::Debug for ProgramCache {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("ProgramCache").field("programs", &self.len()).finish()
    }
}

impl ProgramCache {
    /// An empty cache.
    pub fn new(gpu: &Gpu, table: ShaderTable) -> Self {
        Self { gpu: gpu.clone(), table, slots: Arc::default() }
    }

    /// The program, compiled now if it has to be.
    pub fn get(&self, key: &ProgramKey) -> Result<Arc<Program>, GpuError> {
        if let Some(Slot::Ready(program)) = self.lock().get(key) {
            return Ok(Arc::clone(program));
        }
        let program = Arc::new(Program::compile(&self.gpu, self.table, key)?);
        self.lock().insert(key.clone(), Slot::Ready(Arc::clone(&program)));
        Ok(program)
    }

    /// Whether the program can be had without waiting; starts to compile it on another thread if not.
    pub fn ready_or_start(&self, key: &ProgramKey) -> Result<bool, GpuError> {
        let mut slots = self.lock();
        match slots.get(key) {
            Some(Slot::Ready(_)) => return Ok(true),
            Some(Slot::Compiling) => return Ok(false),
            Some(Slot::Failed(message)) => {
                return Err(GpuError::Pipeline { program: key.to_string(), message: message.clone() });
            }
            None => {}
        }
        slots.insert(key.clone(), Slot::Compiling);
        drop(slots);
        let (cache, key) = (self.clone(), key.clone());
        std::thread::spawn(move || {
            let slot = match Program::compile(&cache.gpu, cache.table, &key) {
                Ok(program) => Slot::Ready(Arc::new(program)),
                Err(error) => Slot::Failed(error.to_string()),
            };
            cache.lock().insert(key, slot);
        });
        Ok(false)
    }

    /// How many programs were asked for so far.
    pub fn len(&self) -> usize {
        self.lock().len()
    }

    /// Whether nothing was asked for yet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, HashMap<ProgramKey, Slot>> {
        self.slots.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}
