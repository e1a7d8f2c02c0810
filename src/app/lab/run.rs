//! Measuring on a thread of its own, with a renderer of its own: it can wait, go on, and be left.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::write_textures;
use crate::app::action::Order;
use crate::gpu::{Gpu, TimingSource};
use crate::lab::accuracy;
use crate::lab::bench::Case;
use crate::lab::suite::Suite;
use crate::lab::sweep::{At, Plan, Sweep};
use crate::plan::Forced;
use crate::render::Renderer;
use crate::scene::Scene;
use crate::scene::param::Choice as _;
use crate::ui::{LabView, Measured, Phase};

/// How often the panel hears of progress at most; drawing it takes time from what is measured on a processor.
const REPORT: Duration = Duration::from_millis(700);

/// Size of the pictures in which the effects of a sky are measured.
const SIZE: [u32; 2] = [480, 270];

/// What the window wants of the thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wish {
    Run,
    Pause,
    Stop,
}

/// How the window speaks to the thread.
#[derive(Debug)]
pub(super) struct Control {
    wish: Mutex<Wish>,
    changed: Condvar,
}

impl Control {
    pub(super) fn new() -> Arc<Self> {
        Arc::new(Self { wish: Mutex::new(Wish::Run), changed: Condvar::new() })
    }

    pub(super) fn set(&self, wish: Wish) {
        let mut held = self.wish.lock().unwrap_or_else(PoisonError::into_inner);
        // Nothing comes back from the end.
        if *held != Wish::Stop {
            *held = wish;
        }
        self.changed.notify_all();
    }

    fn wish(&self) -> Wish {
        *self.wish.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until it is wanted again.
    fn wait(&self) -> Wish {
        let held = self.wish.lock().unwrap_or_else(PoisonError::into_inner);
        let held = self.changed.wait_while(held, |wish| *wish == Wish::Pause);
        *held.unwrap_or_else(PoisonError::into_inner)
    }
}

/// What is measured, and what it is called.
pub(super) struct Job {
    pub(super) gpu: Gpu,
    pub(super) name: String,
    pub(super) scene: Scene,
    pub(super) order: Order,
}

enum Running {
    Sweep(Box<Sweep>),
    Suite(Suite),
}

impl Running {
    fn advance(&mut self, renderer: &mut Renderer) -> anyhow::Result<bool> {
        Ok(match self {
            Self::Sweep(sweep) => sweep.advance(renderer)?,
            Self::Suite(suite) => suite.advance(renderer)?,
        })
    }

    /// Share of the work that is done, and what comes next.
    fn progress(&self) -> (f32, String) {
        let of = |(taken, all): (usize, usize)| taken as f32 / all.max(1) as f32;
        match self {
            Self::Suite(suite) => (of(suite.turns()), suite.next_turn().unwrap_or_default()),
            Self::Sweep(sweep) => {
                // Truths take longest where nothing is known of it; half of the bar is theirs.
                let goals = sweep.plan().goals.len();
                let truths = sweep.truths().len();
                match sweep.at() {
                    At::Truth(goal, progress) => {
                        let own = progress.map_or(0.0, |progress| progress.share);
                        let share = 0.5 * (truths as f32 + own) / goals.max(1) as f32;
                        let error = progress.and_then(|progress| progress.error);
                        let error = error.map_or_else(String::new, |error| format!(", within {:.2} %", error * 100.0));
                        (share, format!("finding {}{error}", goal.integrator().title()))
                    }
                    At::Comparing(index) => {
                        let settings = &sweep.plan().settings;
                        (0.5 + 0.1 * of((index, settings.len())), format!("comparing {}", settings[index].name))
                    }
                    At::Timing(taken, all) => (0.6 + 0.4 * of((taken, all)), format!("timing {taken} of {all}")),
                    At::Done => (1.0, String::new()),
                }
            }
        }
    }

    fn view(&self, name: &str, phase: Phase, source: &str) -> LabView {
        let (share, what) = self.progress();
        let base = LabView { name: name.to_owned(), phase, share, what, ..LabView::default() };
        match self {
            Self::Suite(suite) => {
                let plots = suite.plots(source).into_iter().map(|(_, plot)| plot).collect();
                LabView { tables: suite.tables(source), plots, ..base }
            }
            Self::Sweep(sweep) if sweep.rows().is_empty() => base,
            Self::Sweep(sweep) => {
                let (title, truths) = (sweep.title(name), sweep.integrators());
                let plot = accuracy::plot(&title, sweep.rows(), &truths, source);
                let table = accuracy::table(&title, sweep.rows(), source);
                LabView { tables: vec![table], plots: vec![plot], settings: settings(sweep), ..base }
            }
        }
    }
}

/// The settings of a sweep as the panel takes them.
fn settings(sweep: &Sweep) -> Vec<Measured> {
    let Some(first) = sweep.integrators().first().copied() else { return Vec::new() };
    let front = accuracy::front(sweep.rows(), first);
    let one = |(index, row): (usize, &accuracy::Measured)| {
        let error = row.error(first)?;
        Some(Measured {
            name: row.setting.name.clone(),
            quality: row.setting.quality.clone(),
            cost_ms: row.median_ms(),
            error: error.value,
            std_error: error.std_error,
            reads: row.counts.texture_reads as f64 / row.counts.rays.max(1) as f64,
            is_on_front: front.contains(&index),
            is_current: row.setting.is_current,
        })
    };
    sweep.rows().iter().enumerate().filter_map(one).collect()
}

/// Measures until the end or until it is left; `tell` hears what the panel is to show.
pub(super) fn run(job: Job, control: &Control, tell: &dyn Fn(LabView)) {
    let name = job.name.clone();
    let measured = catch_unwind(AssertUnwindSafe(|| measure(job, control, tell)));
    let why = match measured {
        Ok(Ok(())) => return,
        Ok(Err(error)) => format!("{error:#}"),
        Err(_) => "measuring broke off by a fault of the program; the terminal says more".to_owned(),
    };
    tell(LabView { name, phase: Phase::Failed(why), ..LabView::default() });
}

fn measure(job: Job, control: &Control, tell: &dyn Fn(LabView)) -> anyhow::Result<()> {
    let Job { gpu, name, scene, order } = job;
    let source = TimingSource::of(&gpu).label();
    let mut renderer = Renderer::new(&gpu)?;
    let folder = tempfile::tempdir()?;
    let mut running = match order {
        Order::Sweep { settings, goals, size, rounds } => {
            Running::Sweep(Box::new(Sweep::new(Plan { scene, size, settings, goals, rounds, seeds: 1 })))
        }
        Order::Suite(kind, rounds, quality) => {
            let sky = Case { name: name.clone(), scene, quality: *quality, size: SIZE, forced: Forced::default() };
            Running::Suite(Suite::new(kind, rounds, &write_textures(folder.path())?, &[sky]))
        }
    };
    tell(running.view(&name, Phase::Running, source));
    let mut told = Instant::now();
    loop {
        if control.wish() == Wish::Pause {
            tell(running.view(&name, Phase::Paused, source));
            if control.wait() == Wish::Run {
                tell(running.view(&name, Phase::Running, source));
            }
        }
        if control.wish() == Wish::Stop {
            tell(running.view(&name, Phase::Ended { is_partial: true }, source));
            return Ok(());
        }
        match running.advance(&mut renderer) {
            Ok(false) => {}
            Ok(true) => {
                tell(running.view(&name, Phase::Ended { is_partial: false }, source));
                return Ok(());
            }
            Err(error) => {
                // What was measured before stays.
                tell(running.view(&name, Phase::Failed(format!("{error:#}")), source));
                return Ok(());
            }
        }
        if told.elapsed() > REPORT {
            tell(running.view(&name, Phase::Running, source));
            told = Instant::now();
        }
    }
}
