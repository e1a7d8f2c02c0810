//! `bench`: what each pass costs.

use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::{Args, ValueEnum};
use serde_json::{Map, Value, json};

use super::interrupt::{self, Interrupted};
use super::{Device, Edits, args, print};
use crate::app::lab::write_textures;
use crate::export::ExportError;
use crate::export::atomic::write_atomically;
use crate::files::{self, Origin, Sky};
use crate::gpu::{Gpu, TimingSource};
use crate::lab::bench::{Case, Rounds, count_table, measure, pass_table, ratio_table};
use crate::lab::flight;
use crate::lab::suite::{Suite, SuiteKind};
use crate::lab::table::{Cell, Table};
use crate::plan::Forced;
use crate::render::Renderer;
use crate::scene::builtin::BUILTINS;
use crate::scene::edit;
use crate::scene::{Quality, UpdateFraction};

#[derive(Debug, Args)]
pub(super) struct BenchArgs {
    /// Skies to measure: built-in names or files, or `all` built-in ones.
    #[arg(long, value_delimiter = ',', default_value = "fair_weather,stratocumulus,towering,broken_sunset")]
    presets: Vec<PathBuf>,
    /// Sizes to measure.
    #[arg(long, value_delimiter = ',', value_parser = args::size, default_value = "960x540")]
    size: Vec<[u32; 2]>,
    /// Rounds over all cases.
    #[arg(long, default_value = "3", value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,
    /// Frames measured in a row each round; the whole number of frames of a flight is 20 times this.
    #[arg(long, default_value = "3", value_parser = clap::value_parser!(u32).range(1..=1000))]
    frames: u32,
    /// Quality: draft, preview, high, final, or a .ron file.
    #[arg(long, default_value = "preview")]
    quality: String,
    /// Fly through the first sky with time playing, and report frames per second and the budget per pass.
    #[arg(long, conflicts_with = "suite")]
    flight: bool,
    /// A fixed set of measurements.
    #[arg(long)]
    suite: Option<SuiteArg>,
    /// Folder for the plots of a suite, as SVG.
    #[arg(long, value_name = "FOLDER", requires = "suite")]
    plots: Option<PathBuf>,
    /// Leave out the march of all pixels, which the march of a part is compared with.
    #[arg(long)]
    no_full: bool,
    #[command(flatten)]
    form: Form,
    #[command(flatten)]
    edits: Edits,
    #[command(flatten)]
    device: Device,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SuiteArg {
    /// Table 4.1 of the thesis, with its own model and with the defaults of this program.
    Thesis,
    /// The sweeps of Costa 2023: eye steps, light steps, grid sizes, resolutions. Takes an hour on a processor.
    Costa,
    /// What each effect of the skies costs and changes, with it and without it.
    Effects,
}

impl SuiteArg {
    fn kind(self) -> SuiteKind {
        match self {
            Self::Thesis => SuiteKind::Thesis,
            Self::Costa => SuiteKind::Costa,
            Self::Effects => SuiteKind::Effects,
        }
    }
}

#[derive(Clone, Copy, Debug, Args)]
#[group(multiple = false)]
pub(super) struct Form {
    /// Print JSON, one table a line.
    #[arg(long)]
    json: bool,
    /// Print comma-separated values.
    #[arg(long)]
    csv: bool,
    /// Print Markdown.
    #[arg(long)]
    md: bool,
}

pub(super) fn run(args: &BenchArgs) -> Result<()> {
    let takes_skies = matches!(args.suite, None | Some(SuiteArg::Effects));
    let cases = if takes_skies { cases(args)? } else { Vec::new() };
    let gpu = Gpu::headless(&args.device.choice())?;
    let mut renderer = Renderer::new(&gpu)?;
    print_machine(args.form, &gpu)?;
    let source = TimingSource::of(&gpu);
    match (args.suite, args.flight) {
        (Some(suite), _) => run_suite(args, &mut renderer, (suite.kind(), &cases, source)),
        (None, true) => {
            let Some(case) = cases.first() else { return Ok(()) };
            let flight = flight::fly(&mut renderer, case, args.frames.saturating_mul(20))?;
            print_table(args.form, &flight::table(case, &flight, source))
        }
        (None, false) => per_pass(args, &mut renderer, &cases),
    }
}

fn cases(args: &BenchArgs) -> Result<Vec<Case>> {
    let mut cases = Vec::new();
    for name in &args.presets {
        let skies: Vec<PathBuf> = if name.as_os_str() == "all" {
            BUILTINS.iter().map(|builtin| builtin.name.into()).collect()
        } else {
            vec![name.clone()]
        };
        for source in skies {
            let sky = files::open(&source)?;
            let mut quality = args::quality(Some(&args.quality), &sky)?;
            // Named levels for stills march all pixels; what the viewport does is measured here.
            if Path::new(&args.quality).extension().is_none() {
                quality.update = UpdateFraction::Sixteenth;
            }
            let mut scene = sky.preset.scene.clone();
            edit::apply(&args.edits.sets, &mut scene, &mut quality)?;
            for size in &args.size {
                let (scene, quality) = (scene.clone(), quality.clone());
                cases.push(Case { name: title(&sky), scene, quality, size: *size, forced: Forced::default() });
            }
        }
    }
    Ok(cases)
}

fn title(sky: &Sky) -> String {
    match &sky.origin {
        Origin::Builtin(name) => (*name).to_owned(),
        Origin::Preset(path) | Origin::Picture(path) | Origin::Grid(path) => path.display().to_string(),
    }
}

fn rounds(args: &BenchArgs) -> Rounds {
    Rounds { warm_up: 1, rounds: args.rounds, frames: args.frames }
}

fn per_pass(args: &BenchArgs, renderer: &mut Renderer, cases: &[Case]) -> Result<()> {
    let parts = measure(renderer, cases, rounds(args), &mut progress)?;
    print_table(args.form, &pass_table(cases, &parts, TimingSource::of(renderer.gpu())))?;
    if !args.no_full {
        let full = |case: &Case| {
            let quality = Quality { update: UpdateFraction::Full, ..case.quality.clone() };
            Case { quality, ..case.clone() }
        };
        let fulls: Vec<Case> = cases.iter().map(full).collect();
        let fulls = measure(renderer, &fulls, Rounds { warm_up: 0, frames: 1, ..rounds(args) }, &mut progress)?;
        print_table(args.form, &ratio_table(cases, &parts, &fulls))?;
    }
    let counts = count_table(renderer, cases)?;
    if counts.rows.is_empty() { Ok(()) } else { print_table(args.form, &counts) }
}

/// Measures a suite until its end or until Ctrl-C.
fn run_suite(
    args: &BenchArgs,
    renderer: &mut Renderer,
    (kind, skies, source): (SuiteKind, &[Case], TimingSource),
) -> Result<()> {
    interrupt::watch();
    let folder = tempfile::tempdir()?;
    let textures = write_textures(folder.path())?;
    let mut suite = Suite::new(kind, rounds(args), &textures, skies);
    while let Some(turn) = suite.next_turn() {
        if interrupt::is_asked() {
            break;
        }
        progress(&turn);
        suite.advance(renderer)?;
    }
    for table in suite.tables(source.label()) {
        print_table(args.form, &table)?;
    }
    if let Some(plots) = &args.plots {
        for (name, plot) in suite.plots(source.label()) {
            let path = plots.join(format!("{name}.svg"));
            let svg = plot.svg().svg;
            write_atomically(&path, |file| {
                std::io::Write::write_all(file, svg.as_bytes()).map_err(|cause| ExportError::writing(&path, cause))
            })?;
        }
    }
    if suite.next_turn().is_some() {
        return Err(Interrupted("what was measured so far is above".to_owned()).into());
    }
    // Effects are counted in their own table.
    for cases in suite.cases().filter(|_| kind != SuiteKind::Effects) {
        let counts = count_table(renderer, cases)?;
        if !counts.rows.is_empty() {
            print_table(args.form, &counts)?;
        }
    }
    Ok(())
}

/// Tells a person what is being measured; a log file would only fill.
fn progress(what: &str) {
    if std::io::stderr().is_terminal() {
        eprintln!("{what}");
    }
}

pub(super) fn print_machine(form: Form, gpu: &Gpu) -> Result<()> {
    let software = "SOFTWARE ADAPTER: this processor draws; its times say nothing about a graphics card.";
    let lines = [
        ("program", format!("nephoscope {}", env!("CARGO_PKG_VERSION"))),
        ("adapter", gpu.description()),
        ("system", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
        ("timing", TimingSource::of(gpu).label().to_owned()),
        ("note", if gpu.is_software() { software.to_owned() } else { String::new() }),
    ];
    let shown = lines.iter().filter(|(_, value)| !value.is_empty());
    if form.json {
        let fields: Map<String, Value> = shown.map(|(name, value)| ((*name).to_owned(), json!(value))).collect();
        return print(&format!("{}\n", Value::Object(fields)));
    }
    let mut text = String::new();
    for (name, value) in shown {
        let line = if form.md { format!("- {name}: {value}\n") } else { format!("# {name}: {value}\n") };
        text.push_str(&line);
    }
    print(&format!("{text}\n"))
}

pub(super) fn print_table(form: Form, table: &Table) -> Result<()> {
    let text = match form {
        Form { json: true, .. } => format!("{}", as_json(table)),
        Form { csv: true, .. } => table.csv(),
        Form { md: true, .. } => table.markdown(),
        _ => table.plain(),
    };
    print(&format!("{text}\n"))
}

fn as_json(table: &Table) -> Value {
    let cell = |cell: &Cell| match cell {
        Cell::Text(text) => json!(text),
        Cell::Number(number, _) => json!(number),
    };
    let row = |row: &Vec<Cell>| {
        Value::Object(table.columns.iter().map(|name| (*name).to_owned()).zip(row.iter().map(cell)).collect())
    };
    json!({ "title": table.title, "rows": table.rows.iter().map(row).collect::<Vec<_>>() })
}
