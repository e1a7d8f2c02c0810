//! Dispatches as data, and the clock that times them.
//!
//! On real GPUs every pass is timed by timestamps at its boundaries, the finest thing that exists everywhere. On a
//! software adapter those timestamps are wrong (a pass of 65 ms reads 0.04 ms on llvmpipe), so each job there is its
//! own submission, waited for, and timed by the host: *serialised host time*.

use std::time::Instant;

use super::{Gpu, GpuError};

/// One dispatch, ready to run.
#[derive(Clone, Debug)]
pub struct Job {
    /// The pass it belongs to: timer, debug group and bench column.
    pub pass: &'static str,
    /// Rows it computes; 0 where that is not counted.
    pub rows: u32,
    pipeline: wgpu::ComputePipeline,
    groups: Vec<(u32, wgpu::BindGroup)>,
    grid: [u32; 3],
}

impl Job {
    pub(super) fn new(
        pass: &'static str,
        pipeline: wgpu::ComputePipeline,
        groups: Vec<(u32, wgpu::BindGroup)>,
        grid: [u32; 3],
    ) -> Self {
        Self { pass, rows: 0, pipeline, groups, grid }
    }

    /// The same, known to compute so many rows.
    #[must_use]
    pub fn with_rows(self, rows: u32) -> Self {
        Self { rows, ..self }
    }

    /// The same over another number of workgroups.
    #[must_use]
    pub fn with_grid(self, grid: [u32; 3]) -> Self {
        Self { grid, ..self }
    }

    fn record(&self, encoder: &mut wgpu::CommandEncoder, timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>) {
        let descriptor = wgpu::ComputePassDescriptor { label: Some(self.pass), timestamp_writes: timestamps };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline);
        for (index, group) in &self.groups {
            pass.set_bind_group(*index, group, &[]);
        }
        pass.dispatch_workgroups(self.grid[0], self.grid[1], self.grid[2]);
    }
}

/// Where a time comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimingSource {
    /// Timestamp queries at pass boundaries.
    GpuTimestamps,
    /// Each job alone, waited for, timed by the host.
    SerialisedHost,
    /// The device offers neither.
    Unavailable,
}

impl TimingSource {
    /// The best source this device has.
    pub fn of(gpu: &Gpu) -> Self {
        if gpu.is_software() {
            Self::SerialisedHost
        } else if gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            Self::GpuTimestamps
        } else {
            Self::Unavailable
        }
    }

    /// The words shown wherever a number is.
    pub fn label(self) -> &'static str {
        match self {
            Self::GpuTimestamps => "GPU timestamps",
            Self::SerialisedHost => "serialised host time",
            Self::Unavailable => "n/a",
        }
    }
}

/// The time one pass took in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassTime {
    /// The pass.
    pub pass: &'static str,
    /// Milliseconds; `None` where the device measured nothing usable.
    pub millis: Option<f64>,
}

/// Adds up the jobs of each pass, in order of first appearance.
pub fn add(times: &mut Vec<PassTime>, pass: &'static str, millis: Option<f64>) {
    match times.iter_mut().find(|time| time.pass == pass) {
        Some(time) => time.millis = time.millis.zip(millis).map(|(sum, more)| sum + more),
        None => times.push(PassTime { pass, millis }),
    }
}

/// Runs all jobs in order, waits for them, and returns the time of each pass.
pub fn run(gpu: &Gpu, jobs: &[Job]) -> Result<Vec<PassTime>, GpuError> {
    match TimingSource::of(gpu) {
        TimingSource::SerialisedHost => run_serialised(gpu, jobs),
        TimingSource::GpuTimestamps => run_with_timestamps(gpu, jobs),
        TimingSource::Unavailable => {
            submit(gpu, jobs);
            gpu.wait()?;
            let mut times = Vec::new();
            for job in jobs {
                add(&mut times, job.pass, None);
            }
            Ok(times)
        }
    }
}

/// Sends all jobs to the queue in one submission without waiting.
pub fn submit(gpu: &Gpu, jobs: &[Job]) {
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for job in jobs {
        job.record(&mut encoder, None);
    }
    gpu.queue.submit([encoder.finish()]);
}

fn run_serialised(gpu: &Gpu, jobs: &[Job]) -> Result<Vec<PassTime>, GpuError> {
    let mut times = Vec::new();
    for job in jobs {
        let start = Instant::now();
        submit(gpu, std::slice::from_ref(job));
        gpu.wait()?;
        add(&mut times, job.pass, Some(start.elapsed().as_secs_f64() * 1e3));
    }
    Ok(times)
}

/// Two timestamps for each job, in as many query sets as it takes.
fn run_with_timestamps(gpu: &Gpu, jobs: &[Job]) -> Result<Vec<PassTime>, GpuError> {
    const JOBS_PER_SET: usize = 1024;
    let mut times = Vec::new();
    for jobs in jobs.chunks(JOBS_PER_SET) {
        let count = u32::try_from(2 * jobs.len()).unwrap_or(u32::MAX);
        let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("pass times"),
            ty: wgpu::QueryType::Timestamp,
            count,
        });
        let size = u64::from(count) * 8;
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let descriptor = wgpu::BufferDescriptor { label: Some("pass times"), size, usage, mapped_at_creation: false };
        let resolved = gpu.device.create_buffer(&descriptor);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for (index, job) in (0..count).step_by(2).zip(jobs) {
            let writes = wgpu::ComputePassTimestampWrites {
                query_set: &queries,
                beginning_of_pass_write_index: Some(index),
                end_of_pass_write_index: Some(index + 1),
            };
            job.record(&mut encoder, Some(writes));
        }
        encoder.resolve_query_set(&queries, 0..count, &resolved, 0);
        gpu.queue.submit([encoder.finish()]);
        let bytes = super::readback::buffer(gpu, &resolved)?;
        let ticks: &[u64] = bytemuck::cast_slice(&bytes);
        let period_ms = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        for (job, pair) in jobs.iter().zip(ticks.chunks_exact(2)) {
            add(&mut times, job.pass, span_ms(pair[0], pair[1], period_ms));
        }
    }
    Ok(times)
}

/// A zero or negative span means that the driver wrote nothing usable.
fn span_ms(begin: u64, end: u64, period_ms: f64) -> Option<f64> {
    let ticks = end.checked_sub(begin).filter(|ticks| *ticks > 0 && begin > 0)?;
    Some(f64::from(u32::try_from(ticks).ok()?) * period_ms)
}
