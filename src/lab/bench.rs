//! Times passes. Cases take turns, so that a machine that warms up or throttles spoils all of them alike.

use super::table::{Cell, Table};
use crate::gpu::TimingSource;
use crate::plan::Forced;
use crate::render::{Counts, FrameReport, RenderError, Renderer};
use crate::scene::{Frame, Output, Quality, Scene};

/// One thing to measure.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name in the table.
    pub name: String,
    /// The sky.
    pub scene: Scene,
    /// How it is computed.
    pub quality: Quality,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Effects that run, or do not, whatever the sky calls for.
    pub forced: Forced,
}

impl Case {
    fn frame(&self, time_secs: f64) -> Frame<'_> {
        let Self { scene, quality, size, .. } = self;
        Frame { scene, quality, size: *size, time_secs, output: Output::Display, window: None }
    }

    /// `1920×1080`.
    pub fn size_text(&self) -> String {
        format!("{}×{}", self.size[0], self.size[1])
    }
}

/// How often to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rounds {
    /// Rounds over all cases that are thrown away: shaders compile, caches fill.
    pub warm_up: u32,
    /// Rounds that count.
    pub rounds: u32,
    /// Frames measured in a row each time a case has its turn, after one that is not.
    pub frames: u32,
}

/// Middle and spread of a number of measurements, in the unit of the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stats {
    /// Half of the samples are below.
    pub median: f64,
    /// One in twenty samples is below.
    pub p5: f64,
    /// One in twenty samples is above.
    pub p95: f64,
}

impl Stats {
    /// Of samples in any order; `None` without samples.
    pub fn of(samples: &[f64]) -> Option<Self> {
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| quantile(&sorted, share);
        Some(Self { median: at(0.5)?, p5: at(0.05)?, p95: at(0.95)? })
    }
}

/// Linear between neighbours, as most statistics programs do it (Hyndman and Fan 1996, type 7).
pub(super) fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * sorted.len().checked_sub(1)? as f64;
    // Truncation is meant: `place` lies within the array.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ..= length − 1")]
    let below = place.floor() as usize;
    let low = *sorted.get(below)?;
    let high = sorted.get(below + 1).copied().unwrap_or(low);
    Some(low + (high - low) * (place - below as f64))
}

/// The samples of one pass.
#[derive(Clone, Debug)]
pub struct PassSamples {
    /// The pass.
    pub pass: &'static str,
    /// Milliseconds, one for each frame that measured anything.
    pub millis: Vec<f64>,
}

/// What was measured of one case.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// Passes of every frame, in the order of their first run.
    pub each_frame: Vec<PassSamples>,
    /// Passes of the first frame after a change alone: bakes and look-up tables.
    pub on_change: Vec<PassSamples>,
    /// Totals of the frames, in milliseconds.
    pub total: Vec<f64>,
    /// Total of the last frame that warmed up, in milliseconds.
    pub warm_up_ms: f64,
}

impl Row {
    /// The median of a pass that runs each frame; `None` where it does not run or was not measured.
    pub fn median(&self, pass: &str) -> Option<f64> {
        let samples = self.each_frame.iter().find(|samples| samples.pass == pass)?;
        Stats::of(&samples.millis).map(|stats| stats.median)
    }

    /// Whether fewer rounds have to do.
    fn is_slow(&self) -> bool {
        self.warm_up_ms > SLOW_MS
    }

    fn add(&mut self, report: &FrameReport) {
        add_passes(&mut self.each_frame, report);
        self.total.push(report.total_ms);
    }
}

pub(super) fn add_passes(samples: &mut Vec<PassSamples>, report: &FrameReport) {
    for time in &report.passes {
        let index = samples.iter().position(|samples| samples.pass == time.pass).unwrap_or_else(|| {
            samples.push(PassSamples { pass: time.pass, millis: Vec::new() });
            samples.len() - 1
        });
        samples[index].millis.extend(time.millis);
    }
}

/// Rounds that are enough for a case whose frames take longer than [`SLOW_MS`].
const SLOW_ROUNDS: u32 = 3;
const SLOW_MS: f64 = 2000.0;

/// All cases being measured in turns: it can be left after each turn and taken up again.
#[derive(Clone, Debug)]
pub struct Measurement {
    cases: Vec<Case>,
    rounds: Rounds,
    rows: Vec<Row>,
    /// Turns taken, those of warming up among them.
    turns: usize,
}

impl Measurement {
    /// Nothing measured yet.
    pub fn new(cases: Vec<Case>, rounds: Rounds) -> Self {
        let rows = vec![Row::default(); cases.len()];
        Self { cases, rounds, rows, turns: 0 }
    }

    /// Takes the next turn: one case's frames of one round. Returns whether all is measured.
    ///
    /// # Errors
    /// If a frame cannot be rendered; the turn can be tried again.
    pub fn advance(&mut self, renderer: &mut Renderer) -> Result<bool, RenderError> {
        let Some((round, index)) = self.next() else { return Ok(true) };
        let (case, row) = (&self.cases[index], &mut self.rows[index]);
        let counts = round >= self.rounds.warm_up;
        let mut time_secs = f64::from(round);
        let is_enough = row.is_slow() && row.total.len() >= (SLOW_ROUNDS * self.rounds.frames) as usize;
        if !is_enough {
            renderer.force(case.forced);
            let first = renderer.render(&case.frame(time_secs))?;
            if counts {
                add_passes(&mut row.on_change, &first);
            }
            for _ in 0..if counts { self.rounds.frames } else { 1 } {
                time_secs += 1.0 / 24.0;
                let report = renderer.render(&case.frame(time_secs))?;
                if counts {
                    row.add(&report);
                } else {
                    row.warm_up_ms = report.total_ms;
                }
            }
        }
        self.turns += 1;
        Ok(self.next().is_none())
    }

    fn next(&self) -> Option<(u32, usize)> {
        let cases = self.cases.len().max(1);
        let round = u32::try_from(self.turns / cases).unwrap_or(u32::MAX);
        let all = self.rounds.warm_up + self.rounds.rounds;
        (round < all && !self.cases.is_empty()).then_some((round, self.turns % cases))
    }

    /// What the next turn does, in words; `None` at the end.
    pub fn next_turn(&self) -> Option<String> {
        let (round, index) = self.next()?;
        let kind = if round < self.rounds.warm_up { "warm-up" } else { "round" };
        Some(format!("{kind} {round}: {} {}", self.cases[index].name, self.cases[index].size_text()))
    }

    /// Turns taken, and turns altogether.
    pub fn turns(&self) -> (usize, usize) {
        (self.turns, self.cases.len() * (self.rounds.warm_up + self.rounds.rounds) as usize)
    }

    /// What is measured.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// What was measured so far, in the order of the cases.
    pub fn rows(&self) -> Vec<Row> {
        let mut rows = self.rows.clone();
        for Row { each_frame, on_change, .. } in &mut rows {
            on_change.retain(|first| !each_frame.iter().any(|samples| samples.pass == first.pass));
        }
        rows
    }

    /// How many rounds there were, in words.
    pub fn rounds_text(&self) -> String {
        let slow = self.rows.iter().filter(|row| row.is_slow()).count();
        let few = if slow > 0 && self.rounds.rounds > SLOW_ROUNDS {
            format!(", {SLOW_ROUNDS} for {slow} with frames over 2 s")
        } else {
            String::new()
        };
        format!("{} rounds{few}", self.rounds.rounds)
    }
}

/// Measures all cases in turns; `progress` hears what is being done.
///
/// # Errors
/// If a frame cannot be rendered.
pub fn measure(
    renderer: &mut Renderer,
    cases: &[Case],
    rounds: Rounds,
    progress: &mut dyn FnMut(&str),
) -> Result<Vec<Row>, RenderError> {
    let mut measurement = Measurement::new(cases.to_vec(), rounds);
    while let Some(turn) = measurement.next_turn() {
        progress(&turn);
        measurement.advance(renderer)?;
    }
    Ok(measurement.rows())
}

/// One row a pass: what runs each frame, then what runs when something changes.
pub fn pass_table(cases: &[Case], rows: &[Row], source: TimingSource) -> Table {
    let title = format!("Milliseconds per pass ({})", source.label());
    let columns = ["sky", "size", "pass", "when", "median", "p5", "p95", "share %"];
    let mut table = Table::new(title, &columns);
    for (case, row) in cases.iter().zip(rows) {
        let total = Stats::of(&row.total);
        let mut push = |pass: &str, when: &str, samples: &[f64]| {
            let stats = Stats::of(samples);
            let share = stats.zip(total).filter(|_| when == "each frame").map(|(own, all)| own.median / all.median);
            table.rows.push(vec![
                Cell::text(&case.name),
                Cell::text(case.size_text()),
                Cell::text(pass),
                Cell::text(when),
                Cell::millis(stats.map(|stats| stats.median)),
                Cell::millis(stats.map(|stats| stats.p5)),
                Cell::millis(stats.map(|stats| stats.p95)),
                Cell::Number(share.map(|share| share * 100.0), 1),
            ]);
        };
        for samples in &row.each_frame {
            push(samples.pass, "each frame", &samples.millis);
        }
        push("total", "each frame", &row.total);
        for samples in &row.on_change {
            push(samples.pass, "on change", &samples.millis);
        }
    }
    table
}

/// How much cheaper the march is when it computes a part of the pixels; `parts` and `fulls` are rows of the same skies.
pub fn ratio_table(cases: &[Case], parts: &[Row], fulls: &[Row]) -> Table {
    let mut table = Table::new("The march of a part of the pixels beside the full one (ms)", &RATIO_COLUMNS);
    for ((case, part), full) in cases.iter().zip(parts).zip(fulls) {
        let (part, full) = (part.median("march"), full.median("march"));
        table.rows.push(vec![
            Cell::text(&case.name),
            Cell::text(case.size_text()),
            Cell::millis(part),
            Cell::millis(full),
            Cell::Number(part.zip(full).map(|(part, full)| full / part), 1),
        ]);
    }
    table
}

const RATIO_COLUMNS: [&str; 5] = ["sky", "size", "part", "full", "full / part"];

/// Counted work per ray, which does not depend on the machine. Cases that counted no rays are left out.
///
/// # Errors
/// If a frame cannot be rendered.
pub fn count_table(renderer: &mut Renderer, cases: &[Case]) -> Result<Table, RenderError> {
    let columns = ["sky", "size", "rays", "view steps / ray", "light steps / ray", "texture reads / ray"];
    let mut table = Table::new("Counted work of one frame", &columns);
    for case in cases {
        renderer.force(case.forced);
        let Counts { rays, view_steps, light_steps, texture_reads } = renderer.counted_reads(&case.frame(0.0))?;
        let per_ray = |count: u64| Cell::Number((rays > 0).then(|| count as f64 / rays as f64), 1);
        if rays > 0 {
            table.rows.push(vec![
                Cell::text(&case.name),
                Cell::text(case.size_text()),
                Cell::Number(Some(rays as f64), 0),
                per_ray(view_steps),
                per_ray(light_steps),
                per_ray(texture_reads),
            ]);
        }
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::PassTime;
    use crate::plan::FramePlan;

    #[test]
    fn quantiles_are_those_of_type_7() {
        let stats = Stats::of(&[4.0, 1.0, 3.0, 2.0]).expect("samples");
        assert_eq!(stats.median, 2.5);
        assert!((stats.p5 - 1.15).abs() < 1e-12 && (stats.p95 - 3.85).abs() < 1e-12, "{stats:?}");
        assert_eq!(Stats::of(&[]), None);
        assert_eq!(Stats::of(&[7.0]).map(|stats| stats.p95), Some(7.0));
    }

    #[test]
    fn passes_are_told_apart_by_when_they_run() {
        let (scene, quality) = (Scene::default(), Quality::default());
        let frame = Frame {
            scene: &scene,
            quality: &quality,
            size: [64, 36],
            time_secs: 0.0,
            output: Output::default(),
            window: None,
        };
        let plan = FramePlan::new(&frame);
        let report = |passes: &[(&'static str, f64)], total_ms| FrameReport {
            plan: plan.clone(),
            passes: passes.iter().map(|(pass, millis)| PassTime { pass, millis: Some(*millis) }).collect(),
            source: TimingSource::SerialisedHost,
            total_ms,
        };
        let mut row = Row::default();
        row.add(&report(&[("march", 2.0), ("tonemap", 1.0)], 3.0));
        row.add(&report(&[("march", 4.0), ("tonemap", 1.0)], 5.0));
        add_passes(&mut row.on_change, &report(&[("bake_shape", 9.0)], 9.0));
        assert_eq!((row.median("march"), row.median("temporal")), (Some(3.0), None));
        let (name, forced) = ("a".to_owned(), Forced::default());
        let case = Case { name, scene: Scene::default(), quality: Quality::default(), size: [64, 36], forced };
        let table = pass_table(&[case], &[row], TimingSource::SerialisedHost);
        assert!(table.title.contains("serialised host time"), "{}", table.title);
        assert_eq!(table.rows.len(), 4);
        assert_eq!(table.rows[0][7], Cell::Number(Some(75.0), 1), "3 of 4 ms");
        assert_eq!(table.rows[3][3], Cell::text("on change"));
    }
}
