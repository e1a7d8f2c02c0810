//! Times over the last frames, for the overlay.

use std::collections::VecDeque;
use std::time::Instant;

use crate::render::FrameReport;
use crate::ui::{PassLine, Readout};

/// Frames that medians and percentiles run over.
const WINDOW: usize = 60;

/// The last [`WINDOW`] values of something.
#[derive(Clone, Debug, Default)]
struct Recent(VecDeque<f64>);

impl Recent {
    fn push(&mut self, value: f64) {
        if self.0.len() == WINDOW {
            self.0.pop_front();
        }
        self.0.push_back(value);
    }

    /// The value that a share of all lies below.
    #[allow(clippy::cast_possible_truncation, reason = "0 ..= length − 1")]
    fn quantile(&self, share: f64) -> Option<f64> {
        let mut sorted: Vec<f64> = self.0.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        sorted.get((last as f64 * share).round() as usize).copied()
    }
}

/// Collects what frames report.
#[derive(Clone, Debug, Default)]
pub(super) struct Statistics {
    passes: Vec<(&'static str, Recent)>,
    totals: Recent,
    panels: Recent,
    finished: VecDeque<Instant>,
    last: Option<FrameReport>,
}

impl Statistics {
    /// Takes in a finished picture.
    pub(super) fn add(&mut self, report: FrameReport) {
        let same = |(pass, _): &(&str, Recent)| report.passes.iter().any(|time| time.pass == *pass);
        self.passes.retain(same);
        for (index, time) in report.passes.iter().enumerate() {
            let place = self.passes.iter().position(|(pass, _)| *pass == time.pass).unwrap_or_else(|| {
                let place = index.min(self.passes.len());
                self.passes.insert(place, (time.pass, Recent::default()));
                place
            });
            if let (Some((_, recent)), Some(millis)) = (self.passes.get_mut(place), time.millis) {
                recent.push(millis);
            }
        }
        if report.total_ms > 0.0 {
            self.totals.push(report.total_ms);
        }
        if self.finished.len() == WINDOW {
            self.finished.pop_front();
        }
        self.finished.push_back(Instant::now());
        self.last = Some(report);
    }

    /// Takes in the time of one frame of the panels, in milliseconds.
    pub(super) fn add_panel(&mut self, millis: f64) {
        self.panels.push(millis);
    }

    /// Pictures per second over the last two seconds; `None` when nothing was finished in them.
    fn rate(&self) -> Option<f64> {
        let now = Instant::now();
        let recent: Vec<&Instant> = self.finished.iter().filter(|then| (now - **then).as_secs_f64() < 2.0).collect();
        let (first, last) = (recent.first()?, recent.last()?);
        let span = last.duration_since(**first).as_secs_f64();
        (span > 0.0).then(|| (recent.len() - 1) as f64 / span)
    }

    /// What the overlay shows; adapter, size and memory are the caller's.
    pub(super) fn readout(&self) -> Readout {
        let passes = self.passes.iter();
        Readout {
            source: self.last.as_ref().map_or("n/a", |report| report.source.label()),
            passes: passes.map(|(pass, recent)| PassLine { pass, median_ms: recent.quantile(0.5) }).collect(),
            total_ms: self.totals.quantile(0.5),
            frames: self.totals.0.len(),
            pictures_per_sec: self.rate(),
            panel_p95_ms: self.panels.quantile(0.95),
            verdicts: self.last.as_ref().map(|report| report.plan.verdicts.clone()).unwrap_or_default(),
            ..Readout::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{PassTime, TimingSource};
    use crate::plan::FramePlan;
    use crate::scene::{Frame, Output, Quality, Scene};

    fn report(passes: &[(&'static str, Option<f64>)]) -> FrameReport {
        let (scene, quality) = (Scene::default(), Quality::default());
        let frame = Frame {
            scene: &scene,
            quality: &quality,
            size: [1, 1],
            time_secs: 0.0,
            output: Output::Display,
            window: None,
        };
        FrameReport {
            plan: FramePlan::new(&frame),
            passes: passes.iter().map(|(pass, millis)| PassTime { pass, millis: *millis }).collect(),
            source: TimingSource::SerialisedHost,
            total_ms: 10.0,
        }
    }

    #[test]
    fn medians_run_over_frames_and_nothing_measured_is_no_number() {
        let mut statistics = Statistics::default();
        for millis in [1.0, 100.0, 3.0] {
            statistics.add(report(&[("march", Some(millis)), ("tonemap", None)]));
        }
        let readout = statistics.readout();
        assert_eq!(readout.passes[0], PassLine { pass: "march", median_ms: Some(3.0) });
        assert_eq!(readout.passes[1], PassLine { pass: "tonemap", median_ms: None });
    }

    #[test]
    fn passes_that_no_longer_run_leave_the_list() {
        let mut statistics = Statistics::default();
        statistics.add(report(&[("march", Some(1.0)), ("shafts", Some(2.0)), ("tonemap", Some(3.0))]));
        statistics.add(report(&[("sky", Some(1.0)), ("march", Some(1.0)), ("tonemap", Some(3.0))]));
        let names: Vec<&str> = statistics.readout().passes.iter().map(|line| line.pass).collect();
        assert_eq!(names, ["sky", "march", "tonemap"]);
    }
}
