//! What every pass is given, and how a pass is cut into bands of rows.

use std::collections::HashMap;
use std::sync::Arc;

use super::uniforms::scene::BandUniforms;
use crate::gpu::{Gpu, GpuError, Job, Program, ProgramCache, ProgramKey};

/// Resources by the name shaders give them.
pub(super) type Bound<'a> = Vec<(&'static str, wgpu::BindingResource<'a>)>;

/// How long a row of each pass takes, learnt from finished jobs.
#[derive(Clone, Debug, Default)]
pub(super) struct Pace {
    ms_per_row: HashMap<&'static str, f64>,
}

impl Pace {
    /// Takes note that `rows` rows of a pass took so long.
    pub(super) fn learn(&mut self, pass: &'static str, rows: u32, millis: f64) {
        let measured = millis / f64::from(rows.max(1));
        let known = self.ms_per_row.entry(pass).or_insert(measured);
        *known += 0.4 * (measured - *known);
    }

    /// How long so many rows of a pass should take; 0 while nothing is known or rows are not counted.
    pub(super) fn expected_ms(&self, pass: &'static str, rows: u32) -> f64 {
        self.ms_per_row.get(pass).map_or(0.0, |millis| millis * f64::from(rows))
    }

    /// Rows that fit in `slice_ms`, at least one; a sixteenth of all while nothing is known.
    #[allow(clippy::cast_possible_truncation, reason = "a count of rows, clamped")]
    fn rows(&self, pass: &'static str, all: u32, slice_ms: f64) -> u32 {
        match self.ms_per_row.get(pass) {
            Some(millis) => ((slice_ms / millis.max(1e-6)).floor() as u32).clamp(1, all.max(1)),
            None => all.div_ceil(16).max(1),
        }
    }
}

/// The device, the programs, and the longest a job may take.
#[derive(Debug)]
pub(super) struct Context<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) programs: &'a ProgramCache,
    pub(super) pace: &'a Pace,
    /// Longest job in milliseconds; `None` leaves passes whole.
    pub(super) slice_ms: Option<f64>,
}

/// What is dispatched, apart from what is bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Invocations along x, y and z.
    pub(super) size: [u32; 3],
    /// Workgroup size of the program.
    pub(super) group: [u32; 3],
    /// Rows at the beginning that are left out, where it is cut into bands.
    pub(super) first_row: u32,
}

impl Extent {
    /// An image in groups of 8×8.
    pub(super) fn image([width, height]: [u32; 2]) -> Self {
        Self { size: [width, height, 1], group: [8, 8, 1], first_row: 0 }
    }

    /// A cube in groups of 4×4×4.
    pub(super) fn cube(side: u32) -> Self {
        Self { size: [side; 3], group: [4; 3], first_row: 0 }
    }

    /// Texels in three dimensions, in groups of 4×4×4.
    pub(super) fn solid(size: [u32; 3]) -> Self {
        Self { size, group: [4; 3], first_row: 0 }
    }

    /// The same without its first rows.
    pub(super) fn below(self, first_row: u32) -> Self {
        Self { first_row, ..self }
    }

    fn grid(self) -> [u32; 3] {
        [0, 1, 2].map(|axis| self.size[axis].div_ceil(self.group[axis]))
    }

    /// The axis that bands cut: the last one.
    fn band_axis(self) -> usize {
        if self.group[2] > 1 { 2 } else { 1 }
    }
}

impl Context<'_> {
    /// The program for a key, compiled now if it has to be.
    pub(super) fn program(&self, key: &ProgramKey) -> Result<Arc<Program>, GpuError> {
        self.programs.get(key)
    }

    /// One job for the whole extent.
    pub(super) fn whole(
        &self,
        pass: &'static str,
        key: &ProgramKey,
        bound: &Bound<'_>,
        extent: Extent,
    ) -> Result<Job, GpuError> {
        self.program(key)?.job(self.gpu, pass, bound, extent.grid())
    }

    /// Jobs for bands of rows, each short enough; the shader reads its rows from `band`.
    pub(super) fn banded(
        &self,
        pass: &'static str,
        key: &ProgramKey,
        bound: &Bound<'_>,
        extent: Extent,
    ) -> Result<Vec<Job>, GpuError> {
        let axis = extent.band_axis();
        let all = extent.size[axis];
        if extent.first_row >= all {
            // What is not run is not compiled.
            return Ok(Vec::new());
        }
        let program = self.program(key)?;
        let step = extent.group[axis];
        let rows = self.slice_ms.map_or(all, |slice_ms| self.pace.rows(pass, all, slice_ms)).next_multiple_of(step);
        let mut jobs = Vec::new();
        let mut first_row = extent.first_row;
        while first_row < all {
            let count = rows.min(all - first_row);
            let band = BandUniforms { first_row, rows: count, pad0: 0, pad1: 0 };
            let buffer = self.gpu.uniform("band", bytemuck::bytes_of(&band));
            let mut bound = bound.clone();
            bound.push(("band", buffer.as_entire_binding()));
            let mut size = extent.size;
            size[axis] = count;
            let grid = Extent { size, ..extent }.grid();
            jobs.push(program.job(self.gpu, pass, &bound, grid)?.with_rows(count));
            first_row += count;
        }
        Ok(jobs)
    }
}
