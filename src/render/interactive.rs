//! A frame in slices beside a window: each slice is one submission, short by measured time, and at most one is ahead.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::{Progress, RenderError, Renderer};
use crate::gpu::{Job, job};
use crate::plan::FramePlan;
use crate::scene::Frame;

/// Work that the device has been given.
#[derive(Debug)]
pub(super) struct Slice {
    pass: &'static str,
    rows: u32,
    sent: Instant,
    done: Arc<Mutex<Option<Instant>>>,
}

impl Slice {
    fn finished(&self) -> Option<Instant> {
        *self.done.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Renderer {
    /// Starts an interactive frame. What was under way is dropped, bakes excepted; what was finished stays on display.
    ///
    /// While a shader that the frame needs is being compiled, the frame is drawn as the one before was planned, or,
    /// if there is none, not yet: [`Self::advance`] then says [`Progress::Compiling`].
    ///
    /// # Errors
    /// [`RenderError`] if a shader does not compile or an image of the weather map cannot be used.
    pub fn begin(&mut self, frame: &Frame<'_>) -> Result<(), RenderError> {
        self.queue.truncate(self.bake_jobs);
        if self.pending.take().is_some() {
            // Its targets may be half written.
            self.history = None;
        }
        self.is_compiling = false;
        let mut plan = FramePlan::forced(frame, self.forced);
        if !self.is_ready(&plan)? {
            match self.last_plan.clone() {
                Some(last) if last != plan && last.fits(&plan) && self.is_ready(&last)? => {
                    plan = last.from_anywhere(frame.render_size()[1]);
                }
                _ => {
                    self.is_compiling = true;
                    return Ok(());
                }
            }
        }
        let slice_ms = 25.0;
        let (jobs, bake_jobs) = self.schedule(frame, plan, Some(slice_ms), None)?;
        self.bake_jobs += bake_jobs;
        self.queue.extend(jobs);
        Ok(())
    }

    fn is_ready(&self, plan: &FramePlan) -> Result<bool, RenderError> {
        let mut is_ready = true;
        for key in super::programs(plan) {
            is_ready &= self.programs.ready_or_start(&key)?;
        }
        Ok(is_ready)
    }

    /// Sends the next slice of work to the device if it has finished the one before; never waits for it.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device was lost or reported an error.
    pub fn advance(&mut self, slice: Duration) -> Result<Progress, RenderError> {
        self.gpu.device.poll(wgpu::PollType::Poll).map_err(|error| crate::gpu::GpuError::Device(error.to_string()))?;
        if let Some(error) = self.gpu.take_uncaught_error() {
            return Err(error.into());
        }
        if let Some(under_way) = &self.slice {
            let Some(finished) = under_way.finished() else {
                return Ok(Progress::Working);
            };
            let millis = finished.duration_since(under_way.sent).as_secs_f64() * 1e3;
            if under_way.rows > 0 {
                self.pace.learn(under_way.pass, under_way.rows, millis);
            }
            if let Some(pending) = &mut self.pending {
                job::add(&mut pending.times, under_way.pass, Some(millis));
            }
            self.slice = None;
        }
        if self.is_compiling {
            return Ok(Progress::Compiling);
        }
        if self.queue.is_empty() {
            return Ok(self.complete().map_or(Progress::Idle, |report| Progress::Finished(Box::new(report))));
        }
        self.send(slice);
        Ok(Progress::Working)
    }

    /// Sends jobs of one pass that together fit the slice.
    fn send(&mut self, slice: Duration) {
        let Some(first) = self.queue.pop_front() else {
            return;
        };
        let (pass, mut rows) = (first.pass, first.rows);
        let mut jobs: Vec<Job> = vec![first];
        let mut expected_ms = self.pace.expected_ms(pass, rows);
        while let Some(next) = self.queue.front() {
            let more = self.pace.expected_ms(pass, next.rows);
            if next.pass != pass || expected_ms + more > slice.as_secs_f64() * 1e3 {
                break;
            }
            expected_ms += more;
            rows += next.rows;
            jobs.extend(self.queue.pop_front());
        }
        self.bake_jobs = self.bake_jobs.saturating_sub(jobs.len());
        let done = Arc::new(Mutex::new(None));
        let slot = Arc::clone(&done);
        let sent = Instant::now();
        job::submit(&self.gpu, &jobs);
        self.gpu.queue.on_submitted_work_done(move || {
            *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
        });
        self.slice = Some(Slice { pass, rows, sent, done });
    }

    /// Brings interactive work to an end, so that a whole frame can follow.
    pub(super) fn finish_interactive(&mut self) -> Result<(), RenderError> {
        self.queue.truncate(self.bake_jobs);
        let jobs: Vec<Job> = self.queue.drain(..).collect();
        job::submit(&self.gpu, &jobs);
        self.bake_jobs = 0;
        self.slice = None;
        if self.pending.take().is_some() {
            self.history = None;
        }
        self.gpu.wait()?;
        Ok(())
    }
}
