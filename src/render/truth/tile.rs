//! The buffers of a truth, a band of rows each so that none is larger than a device binds, and the slices of its work.

use std::time::{Duration, Instant};

use super::settings::{Goal, Level};
use super::{Integrator, RenderError, TruthCounts};
use crate::gpu::{Gpu, Job, ProgramCache, ProgramKey, job, readback};
use crate::plan::{FURTHEST_M, MarchVariant};
use crate::render::context::Bound;
use crate::render::uniforms::other::TruthUniforms;
use crate::render::uniforms::scene::BandUniforms;

/// Bytes of one ray of `pass/march_state.wgsl`.
const RAY_BYTES: u64 = 32;
/// Bytes of one path of `pass/path_state.wgsl`, and of its sums.
const PATH_BYTES: u64 = 128;
const SUMS_BYTES: u64 = 32;
/// Largest buffer, half of what every device binds.
const LARGEST: u64 = 64 << 20;
/// llvmpipe ends an invocation after 65,535 loop iterations, all loops together.
const ITERATIONS: u32 = 50_000;
/// Paths of each pixel after which stock is taken first.
const FIRST_BATCH: u32 = 2;

/// Rows that a slice is made up of.
const BLOCK_ROWS: u32 = 8;

fn blocks_of(height: u32) -> usize {
    height.div_ceil(BLOCK_ROWS) as usize
}

/// What fits a slice. A ray does no more work in a dispatch than it is allowed, so what rows took for each unit of it
/// tells what they take next time at most; rows of which nothing is known go two blocks at a time.
#[derive(Debug)]
struct TilePace {
    /// Milliseconds for each unit of work, of each block of rows.
    known: Vec<Option<f64>>,
    /// The greatest of them so far.
    greatest: f64,
    /// Units of work for each ray in a dispatch.
    work: u32,
}

impl TilePace {
    fn new(blocks: usize) -> Self {
        Self { known: vec![None; blocks], greatest: 0.0, work: 32 }
    }

    /// Rays start anew: blocks that were finished cost something again.
    fn forget(&mut self) {
        self.known.fill(None);
    }

    /// As much work as lets the dearest block fill a slice.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, clamped")]
    fn choose_work(&mut self, slice_ms: f64, (least, most): (u32, u32)) -> u32 {
        let fitting = if self.greatest > 0.0 { slice_ms / self.greatest } else { f64::from(self.work) };
        self.work = (fitting.min(f64::from(most)) as u32).clamp(least, most.max(least));
        self.work
    }

    /// Rows from this block on that fit a slice; at least one block.
    fn rows(&self, first_block: usize, slice_ms: f64) -> u32 {
        let (mut blocks, mut unknown, mut expected_ms) = (0, 0, 0.0);
        for known in self.known.iter().skip(first_block) {
            unknown += u32::from(known.is_none());
            expected_ms += known.unwrap_or(self.greatest) * f64::from(self.work);
            if blocks > 0 && (expected_ms > slice_ms || unknown > 2) {
                break;
            }
            blocks += 1;
        }
        blocks.max(1) * BLOCK_ROWS
    }

    fn learn(&mut self, first_block: usize, rows: u32, millis: f64) {
        let blocks = blocks_of(rows);
        let each = millis / blocks as f64 / f64::from(self.work.max(1));
        for known in self.known.iter_mut().skip(first_block).take(blocks) {
            *known = Some(each);
        }
        // A single hiccup of the machine is forgotten in the end.
        self.greatest = (0.995 * self.greatest).max(each);
    }
}

/// What the tiles are made from.
pub(super) struct Stage<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) programs: &'a ProgramCache,
    pub(super) key: ProgramKey,
    pub(super) resolve: ProgramKey,
    pub(super) bound: Bound<'a>,
    pub(super) outputs: Bound<'a>,
    pub(super) size: [u32; 2],
    /// Rounds of loops in one density: see `density_rounds`.
    pub(super) rounds: u32,
}

#[derive(Debug)]
struct Tile {
    first_row: u32,
    rows: u32,
    /// The integrator over this tile; its band says which rows.
    job: Job,
    band: wgpu::Buffer,
    uniforms: wgpu::Buffer,
    /// What is kept between dispatches, cleared when a level begins.
    state: wgpu::Buffer,
    bytes: u64,
}

/// All tiles, and where their work has got to.
#[derive(Debug)]
pub(super) struct Tiles {
    goal: Goal,
    width: u32,
    tiles: Vec<Tile>,
    counters: wgpu::Buffer,
    /// How many layers there are, and rounds of loops in one density.
    loops: [u32; 2],
    counts: TruthCounts,
    level: u32,
    samples: u32,
    /// The tile under way, and its next row.
    tile: usize,
    row: u32,
    pace: TilePace,
    /// Share of the present tile's rays that have reached their end.
    tile_share: f32,
}

impl Tiles {
    /// The tiles of a picture, and the jobs that resolve them.
    pub(super) fn new(stage: &Stage<'_>, goal: Goal, march: MarchVariant) -> Result<(Self, Vec<Job>), RenderError> {
        let [width, height] = stage.size;
        let is_traced = goal.integrator() == Integrator::PathTraced;
        let state_bytes = if is_traced { PATH_BYTES } else { RAY_BYTES };
        let most_rows = u32::try_from(LARGEST / (u64::from(width) * state_bytes)).unwrap_or(1).clamp(1, height);
        let counters = storage(stage.gpu, "counters", 16);
        let (mut tiles, mut resolve) = (Vec::new(), Vec::new());
        let mut first_row = 0;
        while first_row < height {
            let rows = most_rows.min(height - first_row);
            let pixels = u64::from(width) * u64::from(rows);
            let state = storage(stage.gpu, "truth_state", pixels * state_bytes);
            let sums = is_traced.then(|| storage(stage.gpu, "path_sums", pixels * SUMS_BYTES));
            let whole = BandUniforms { first_row, rows, pad0: 0, pad1: 0 };
            let band = stage.gpu.uniform("band", bytemuck::bytes_of(&whole));
            let all_rows = stage.gpu.uniform("band", bytemuck::bytes_of(&whole));
            let uniforms = stage.gpu.uniform(
                "truth",
                bytemuck::bytes_of(&Self::uniforms_at(goal, [march.layers, stage.rounds], (0, 0), first_row)),
            );
            let mut bound = stage.bound.clone();
            bound.push(("truth", uniforms.as_entire_binding()));
            bound.push((if is_traced { "paths" } else { "marched_rays" }, state.as_entire_binding()));
            if let Some(sums) = &sums {
                bound.push(("path_sums", sums.as_entire_binding()));
            }
            let mut resolving = bound.clone();
            resolving.extend_from_slice(&stage.outputs);
            resolving.push(("band", all_rows.as_entire_binding()));
            bound.push(("band", band.as_entire_binding()));
            bound.push(("counters", counters.as_entire_binding()));
            let grid = [width.div_ceil(8), rows.div_ceil(8), 1];
            let job = stage.programs.get(&stage.key)?.job(stage.gpu, "truth", &bound, grid)?;
            resolve.push(stage.programs.get(&stage.resolve)?.job(stage.gpu, "truth_resolve", &resolving, grid)?);
            let bytes = state.size() + sums.as_ref().map_or(0, wgpu::Buffer::size);
            tiles.push(Tile { first_row, rows, job, band, uniforms, state, bytes });
            first_row += rows;
        }
        let mut this = Self {
            goal,
            width,
            tiles,
            counters,
            loops: [march.layers, stage.rounds],
            counts: TruthCounts::default(),
            level: 0,
            samples: 0,
            tile: 0,
            row: 0,
            pace: TilePace::new(blocks_of(height)),
            tile_share: 0.0,
        };
        this.samples = this.next_samples();
        Ok((this, resolve))
    }

    fn uniforms_at(
        goal: Goal,
        [layers, rounds]: [u32; 2],
        (level, samples): (u32, u32),
        first_row: u32,
    ) -> TruthUniforms {
        let steps = Level::new(level);
        let (scatterings, seed) = match goal {
            Goal::Converged { .. } => (None, 0),
            Goal::PathTraced { scatterings, seed, .. } => (scatterings, seed),
        };
        // Loops inside of one step or event: layers in several places, octaves, tries of a phase function.
        let inside = match goal {
            Goal::Converged { .. } => steps.light_steps * (rounds + layers) + 8 * layers + 15 + rounds,
            // The majorant and the density.
            Goal::PathTraced { .. } => 6 * layers + 38 + 2 * rounds,
        };
        TruthUniforms {
            first_row,
            per_dispatch: (ITERATIONS / inside).clamp(1, 1024),
            samples,
            scattering_limit: scatterings.unwrap_or(u32::MAX).max(1),
            seed,
            light_steps: steps.light_steps,
            view_step_m: steps.view_step_m,
            view_growth: steps.view_growth,
            furthest_m: FURTHEST_M,
            work_per_dispatch: u32::MAX,
            pad0: 0.0,
            pad1: 0.0,
        }
    }

    /// Tells the tile under way where it is, and how much work a dispatch may do for each ray or path.
    fn write_uniforms(&mut self, gpu: &Gpu, slice_ms: f64) {
        let tile = &self.tiles[self.tile];
        let mut uniforms = Self::uniforms_at(self.goal, self.loops, (self.level, self.samples), tile.first_row);
        // A ray that has met cloud takes at least one step, with all its steps towards the light.
        let (least, most) = match self.goal {
            Goal::Converged { .. } => (1 + uniforms.light_steps, uniforms.per_dispatch * (1 + uniforms.light_steps)),
            Goal::PathTraced { .. } => (1, uniforms.per_dispatch),
        };
        let work = self.pace.choose_work(slice_ms, (least, most));
        match self.goal {
            Goal::Converged { .. } => uniforms.work_per_dispatch = work,
            Goal::PathTraced { .. } => uniforms.per_dispatch = work,
        }
        gpu.queue.write_buffer(&tile.uniforms, 0, bytemuck::bytes_of(&uniforms));
    }

    /// Sends one slice to the device and waits for it. Returns whether that completed the level.
    pub(super) fn run_slice(&mut self, gpu: &Gpu, slice: Duration) -> Result<bool, RenderError> {
        let slice_ms = slice.as_secs_f64() * 1e3;
        if self.row == 0 {
            self.write_uniforms(gpu, slice_ms);
            gpu.queue.write_buffer(&self.counters, 0, &[0; 16]);
        }
        let tile = &self.tiles[self.tile];
        let first_block = ((tile.first_row + self.row) / BLOCK_ROWS) as usize;
        let rows = self.pace.rows(first_block, slice_ms).min(tile.rows - self.row);
        let pixels = self.width * tile.rows;
        let band = BandUniforms { first_row: tile.first_row + self.row, rows, pad0: 0, pad1: 0 };
        gpu.queue.write_buffer(&tile.band, 0, bytemuck::bytes_of(&band));
        let started = Instant::now();
        job::submit(gpu, &[tile.job.clone().with_grid([self.width.div_ceil(8), rows.div_ceil(8), 1])]);
        gpu.wait()?;
        self.pace.learn(first_block, rows, started.elapsed().as_secs_f64() * 1e3);
        self.row += rows;
        if self.row < self.tiles[self.tile].rows {
            return Ok(false);
        }
        self.row = 0;
        let bytes = readback::buffer(gpu, &self.counters)?;
        let counted: [u32; 4] = bytemuck::pod_read_unaligned(&bytes);
        self.add(counted);
        self.tile_share = 1.0 - counted[0] as f32 / pixels as f32;
        if counted[0] > 0 {
            return Ok(false);
        }
        self.tile += 1;
        self.tile_share = 0.0;
        Ok(self.tile == self.tiles.len())
    }

    fn add(&mut self, [_, first, second, third]: [u32; 4]) {
        self.counts.steps += u64::from(first);
        match self.goal {
            Goal::Converged { .. } => self.counts.light_steps += u64::from(second),
            Goal::PathTraced { .. } => self.counts.exceeded += u64::from(second),
        }
        self.counts.cut += u64::from(third);
    }

    pub(super) fn counts(&self) -> TruthCounts {
        self.counts
    }

    /// Share of the level that is done, by tiles and by rays that have ended.
    pub(super) fn share(&self) -> f32 {
        (self.tile as f32 + self.tile_share) / self.tiles.len().max(1) as f32
    }

    /// The level, or the samples, that the buffers hold once a level is complete.
    pub(super) fn finished(&self) -> u32 {
        match self.goal {
            Goal::Converged { .. } => self.level,
            Goal::PathTraced { .. } => self.samples,
        }
    }

    /// Samples after the next batch: batches grow with what is there, so that stock is taken seldom.
    fn next_samples(&self) -> u32 {
        match self.goal {
            Goal::Converged { .. } => 0,
            Goal::PathTraced { samples, .. } => {
                self.samples.saturating_add(FIRST_BATCH.max(self.samples / 2)).min(samples.max(1))
            }
        }
    }

    /// Starts the next level. `false` when there is none.
    pub(super) fn next_level(&mut self, gpu: &Gpu) -> bool {
        match self.goal {
            Goal::Converged { levels, .. } => {
                if self.level + 1 >= levels {
                    return false;
                }
                self.level += 1;
                self.begin_again(gpu);
            }
            Goal::PathTraced { .. } => {
                let samples = self.next_samples();
                if samples == self.samples {
                    return false;
                }
                self.samples = samples;
                self.tile = 0;
                self.pace.forget();
            }
        }
        true
    }

    /// Starts all rays anew on the same level.
    pub(super) fn begin_again(&mut self, gpu: &Gpu) {
        self.tile = 0;
        self.pace.forget();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for tile in &self.tiles {
            encoder.clear_buffer(&tile.state, 0, None);
        }
        gpu.queue.submit([encoder.finish()]);
    }

    pub(super) fn bytes(&self) -> u64 {
        self.tiles.iter().map(|tile| tile.bytes).sum()
    }
}

fn storage(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dear_rows_after_cheap_ones_do_not_make_a_long_slice() {
        let mut pace = TilePace::new(12);
        let work = f64::from(pace.choose_work(20.0, (1, 1000)));
        // Four blocks of cloud, then sky that costs nothing.
        let cost = |block: usize| if block < 4 { 0.5 } else { 0.001 };
        for block in 0..12 {
            assert!(pace.rows(block, 20.0) <= 2 * BLOCK_ROWS, "block {block}: nothing is known yet");
            pace.learn(block, BLOCK_ROWS, cost(block) * work);
        }
        let work = f64::from(pace.choose_work(20.0, (1, 1000)));
        assert!((work - 40.0).abs() <= 3.0, "a block of cloud fills a slice: {work}");
        assert_eq!(pace.rows(0, 20.5), BLOCK_ROWS, "one block of cloud");
        assert_eq!(pace.rows(4, 20.0), 8 * BLOCK_ROWS, "all of the sky");
        pace.forget();
        assert_eq!(pace.rows(4, 20.0), BLOCK_ROWS, "another level may cost more");
    }
}
