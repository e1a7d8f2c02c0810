//! Options of commands that may render with a reference integrator.

use std::time::Duration;

use anyhow::Result;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::error::Usage;
use super::interrupt::{self, Interrupted};
use crate::render::Renderer;
use crate::render::truth::{Convergence, Goal, Truth};
use crate::scene::Frame;

/// Between two looks at the progress.
const BUDGET: Duration = Duration::from_millis(400);
/// Longest dispatch.
const SLICE: Duration = Duration::from_millis(200);

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum IntegratorArg {
    /// The march, as fast as its quality allows.
    Realtime,
    /// The march's model with steps so short that they no longer matter.
    Converged,
    /// All orders of scattering, without bias.
    PathTraced,
}

#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Integration {
    /// How the light of clouds is found; converged for `--quality final`, else realtime.
    #[arg(long)]
    integrator: Option<IntegratorArg>,
    /// Relative error at which a converging picture is good enough.
    #[arg(long, default_value = "0.01", value_name = "SHARE")]
    tolerance: f32,
    /// Paths of each pixel at most (path-traced).
    #[arg(long, default_value = "256", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    samples: u32,
    /// Most scatterings of a path (path-traced); 1 is single scattering.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    scatterings: Option<u32>,
    /// Seed of the paths.
    #[arg(long, default_value = "0")]
    seed: u32,
}

impl Default for Integration {
    fn default() -> Self {
        Self { integrator: None, tolerance: 0.01, samples: 256, scatterings: None, seed: 0 }
    }
}

impl Integration {
    /// What to aim at, or `None` for the march.
    pub(super) fn goal(&self, is_final: bool) -> Result<Option<Goal>> {
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            return Err(Usage(format!("--tolerance {} must lie above 0 and below 1", self.tolerance)).into());
        }
        let tolerance = self.tolerance;
        let by_quality = if is_final { IntegratorArg::Converged } else { IntegratorArg::Realtime };
        Ok(match self.integrator.unwrap_or(by_quality) {
            IntegratorArg::Realtime => None,
            IntegratorArg::Converged => Some(Goal::Converged { tolerance, levels: 8 }),
            IntegratorArg::PathTraced => Some(Goal::PathTraced {
                tolerance,
                samples: self.samples,
                scatterings: self.scatterings,
                seed: self.seed,
            }),
        })
    }
}

/// Brings a frame to its goal, with a bar on a terminal; or as far as it came until Ctrl-C, if that is worth keeping.
pub(super) fn converge(renderer: &mut Renderer, frame: &Frame<'_>, goal: Goal) -> Result<Truth> {
    use std::io::IsTerminal as _;
    let target =
        if std::io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(1000), target);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {msg}") {
        bar.set_style(style);
    }
    interrupt::watch();
    let mut truth = renderer.begin_truth(frame, goal, frame.quality.pixel_samples)?;
    loop {
        let progress = truth.advance(renderer, BUDGET, SLICE)?;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of 1000")]
        bar.set_position((progress.share * 1000.0) as u64);
        bar.set_message(describe(goal, &progress));
        if progress.is_done {
            break;
        }
        if interrupt::is_asked() {
            bar.finish_and_clear();
            if truth.has_picture() {
                break;
            }
            return Err(Interrupted("nothing was finished yet".to_owned()).into());
        }
    }
    bar.finish_and_clear();
    Ok(truth)
}

/// How far it is, in words.
pub(super) fn describe(goal: Goal, progress: &Convergence) -> String {
    let finished = match (goal, progress.finished) {
        (Goal::Converged { .. }, Some(level)) => match progress.pixel_samples {
            0 | 1 => format!("level {level}"),
            several => format!("level {level}, {several} samples a pixel"),
        },
        (Goal::PathTraced { .. }, Some(samples)) => format!("{samples} samples"),
        (_, None) if progress.is_done => "no cloud in view".to_owned(),
        (_, None) => "nothing finished yet".to_owned(),
    };
    let error = progress.error.map_or_else(String::new, |error| format!(", within {:.2} %", error * 100.0));
    let faults = progress.counts.exceeded + progress.counts.cut;
    let faults = if faults > 0 {
        format!(
            ", FAULTS: density above its bound in {} places, {} paths cut short",
            progress.counts.exceeded, progress.counts.cut
        )
    } else {
        String::new()
    };
    let work = progress.counts.steps as f64 / 1e6;
    format!("{finished}{error}, {work:.1} M steps, {:.1} s{faults}", progress.spent_secs)
}
