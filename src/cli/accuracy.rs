//! `accuracy`: how far pictures are from the truth, and what that costs.

use std::io::IsTerminal as _;
use std::path::PathBuf;

use anyhow::Result;
use clap::{Args, ValueEnum};

use super::bench::{Form, print_machine, print_table};
use super::error::Usage;
use super::integrate::describe;
use super::interrupt::{self, Interrupted};
use super::{Device, Edits, args, print};
use crate::export::ExportError;
use crate::export::atomic::write_atomically;
use crate::files::{self, Sky};
use crate::gpu::{Gpu, TimingSource};
use crate::lab::accuracy::{self, AccuracyError, Axis, Measured};
use crate::lab::sweep::{At, Plan, Sweep, goals};
use crate::lab::verify::anywhere;
use crate::plan::Integrator;
use crate::render::Renderer;
use crate::render::truth::Goal;
use crate::scene::builtin::BUILTINS;
use crate::scene::edit;
use crate::scene::param::Choice as _;

#[derive(Debug, Args)]
pub(super) struct AccuracyArgs {
    /// Skies to measure: built-in names or files, or `all` built-in ones.
    #[arg(value_delimiter = ',', default_value = "fair_weather")]
    skies: Vec<PathBuf>,
    /// Width and height in pixels.
    #[arg(long, value_parser = args::size, default_value = "256x144")]
    size: [u32; 2],
    /// A parameter of quality and its values, such as `quality.light_steps=2,4,8`. Several axes make all combinations.
    #[arg(long = "axis", value_name = "KEY=VALUES")]
    axes: Vec<String>,
    /// What to measure against.
    #[arg(long, default_value = "converged")]
    truth: TruthArg,
    /// Relative error at which a truth is good enough.
    #[arg(long, default_value = "0.005", value_name = "SHARE")]
    tolerance: f32,
    /// Paths of each pixel at most.
    #[arg(long, default_value = "64", value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    samples: u32,
    /// Instead of the sky's own camera and sun, so many of each that a hash has drawn and nobody has tuned.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=1000))]
    views: Option<u32>,
    /// Jitters of the march to compare with: two or more tell its noise from what all of them share.
    #[arg(long, default_value = "1", value_parser = clap::value_parser!(u32).range(1..=64))]
    seeds: u32,
    /// Timed rounds over all settings.
    #[arg(long, default_value = "15", value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,
    /// Also names the cheapest setting with at most this relative error.
    #[arg(long, value_name = "SHARE")]
    max_error: Option<f64>,
    /// Also names the most accurate setting whose march takes at most so many milliseconds.
    #[arg(long, value_name = "MS")]
    max_ms: Option<f64>,
    /// Writes error over time as an SVG picture; with several skies, the name of each goes before the ending.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Quality that is in use: draft, preview, high, final, or a .ron file.
    #[arg(long, default_value = "preview")]
    quality: String,
    #[command(flatten)]
    form: Form,
    #[command(flatten)]
    edits: Edits,
    #[command(flatten)]
    device: Device,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TruthArg {
    /// The march's own model, by brute force.
    Converged,
    /// All orders of scattering.
    PathTraced,
    /// Both.
    Both,
}

impl AccuracyArgs {
    fn goals(&self) -> Result<Vec<Goal>> {
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            return Err(Usage(format!("--tolerance {} must lie above 0 and below 1", self.tolerance)).into());
        }
        for (name, budget) in [("--max-error", self.max_error), ("--max-ms", self.max_ms)] {
            if budget.is_some_and(|budget| !budget.is_finite() || budget <= 0.0) {
                return Err(Usage(format!("{name} must be above 0")).into());
            }
        }
        let converged = self.truth != TruthArg::PathTraced;
        let paths = (self.truth != TruthArg::Converged).then_some(self.samples);
        Ok(goals(self.tolerance, converged, paths))
    }

    fn skies(&self) -> Result<Vec<Sky>> {
        let all = |name: &PathBuf| name.as_os_str() == "all";
        let names = self.skies.iter().flat_map(|name| {
            let builtin = BUILTINS.iter().filter(|_| all(name)).map(|builtin| PathBuf::from(builtin.name));
            builtin.chain((!all(name)).then(|| name.clone()))
        });
        names.map(|name| Ok(files::open(&name)?)).collect()
    }
}

pub(super) fn run(args: &AccuracyArgs) -> Result<()> {
    let goals = args.goals()?;
    let axes = args.axes.iter().map(|axis| Axis::parse(axis)).collect::<Result<Vec<_>, _>>();
    let axes = axes.map_err(|error| Usage(error.to_string()))?;
    let skies = args.skies()?;
    let mut cases = Vec::new();
    for sky in skies {
        let mut quality = args::quality(Some(&args.quality), &sky)?;
        let mut scene = sky.preset.scene.clone();
        edit::apply(&args.edits.sets, &mut scene, &mut quality)?;
        let settings = accuracy::settings(&quality, &axes).map_err(|error| Usage(error.to_string()))?;
        match args.views {
            None => cases.push((sky.preset.name, scene, settings)),
            Some(views) => {
                let name = |view: u32| format!("{}, view {view}", sky.preset.name);
                cases.extend((0..views).map(|view| (name(view), anywhere(&scene, view), settings.clone())));
            }
        }
    }
    let gpu = Gpu::headless(&args.device.choice())?;
    let mut renderer = Renderer::new(&gpu)?;
    print_machine(args.form, &gpu)?;
    let source = TimingSource::of(&gpu).label();
    interrupt::watch();
    let several = cases.len() > 1;
    for (name, scene, settings) in cases {
        let plan =
            Plan { scene, size: args.size, settings, goals: goals.clone(), rounds: args.rounds, seeds: args.seeds };
        let mut sweep = Sweep::new(plan);
        if let Err(error) = run_sweep(&mut sweep, &mut renderer, &name) {
            // A view that nobody chose may show no cloud.
            let is_empty = error.downcast_ref::<AccuracyError>().is_some_and(AccuracyError::is_of_no_pixels);
            if !(is_empty && args.views.is_some()) {
                return Err(error);
            }
            eprintln!("{name}: {error}");
            continue;
        }
        report(args, &sweep, (&name, several), source)?;
        if sweep.at() != At::Done {
            return Err(Interrupted("what was measured so far is above".to_owned()).into());
        }
    }
    Ok(())
}

/// Measures until the end or until Ctrl-C, and tells how far it is.
fn run_sweep(sweep: &mut Sweep, renderer: &mut Renderer, name: &str) -> Result<()> {
    let mut found = 0;
    while !sweep.advance(renderer)? && !interrupt::is_asked() {
        match sweep.at() {
            At::Truth(goal, Some(progress)) => tell(&format!("{name}: {}", describe(goal, &progress))),
            At::Truth(_, None) | At::Done => {}
            At::Comparing(index) => tell(&format!("{name}: comparing {}", sweep.plan().settings[index].name)),
            At::Timing(taken, all) => tell(&format!("{name}: timing {taken} of {all}")),
        }
        for (truth, goal) in sweep.truths().iter().zip(&sweep.plan().goals).skip(found) {
            eprintln!("{name}, {}: {}", truth.integrator.title(), describe(*goal, &truth.progress));
            found += 1;
        }
    }
    Ok(())
}

fn report(args: &AccuracyArgs, sweep: &Sweep, (name, several): (&str, bool), source: &str) -> Result<()> {
    let (title, rows) = (sweep.title(name), sweep.rows());
    print_table(args.form, &accuracy::table(&title, rows, source))?;
    let truths = sweep.integrators();
    choose(args, rows, &truths)?;
    if let Some(path) = &args.plot {
        let path = if several { beside(path, name) } else { path.clone() };
        let svg = accuracy::plot(&title, rows, &truths, source).svg().svg;
        write_atomically(&path, |file| {
            std::io::Write::write_all(file, svg.as_bytes()).map_err(|cause| ExportError::writing(&path, cause))
        })?;
    }
    Ok(())
}

/// `front.svg` and `Fair weather` make `front.fair_weather.svg`.
fn beside(path: &std::path::Path, name: &str) -> PathBuf {
    path.with_extension(format!("{}.svg", name.to_lowercase().replace(' ', "_")))
}

fn tell(what: &str) {
    if std::io::stderr().is_terminal() {
        eprintln!("{what}");
    }
}

/// Says which setting keeps to the budgets that were given, or comes nearest.
fn choose(args: &AccuracyArgs, rows: &[Measured], truths: &[Integrator]) -> Result<()> {
    let Some(truth) = truths.first().copied() else { return Ok(()) };
    let budgets = [
        args.max_error.and_then(|most| {
            let wanted = format!("cheapest within {:.2} % of {}", most * 100.0, truth.title());
            Some((wanted, accuracy::cheapest(rows, truth, most)?))
        }),
        args.max_ms.and_then(|most| {
            Some((format!("most accurate within {most} ms"), accuracy::most_accurate(rows, truth, most)?))
        }),
    ];
    for (wanted, chosen) in budgets.into_iter().flatten() {
        let row = &rows[chosen.row];
        let figures = figures(row, truth);
        let line = if chosen.is_within {
            format!("{wanted}: {} ({figures})", row.setting.name)
        } else {
            format!("{wanted}: none; nearest is {} ({figures})", row.setting.name)
        };
        print(&format!("{line}\n"))?;
    }
    Ok(())
}

fn figures(row: &Measured, truth: Integrator) -> String {
    let error = row.error(truth).map_or(f64::NAN, |error| error.value * 100.0);
    format!("{error:.2} %, {:.1} ms", row.median_ms().unwrap_or(f64::NAN))
}
