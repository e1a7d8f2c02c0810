//! `verify --skies`: pictures of skies that nobody made.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use clap::Args;

use super::interrupt::{self, Interrupted};
use crate::export::ExportError;
use crate::export::atomic::write_atomically;
use crate::lab::bench::Stats;
use crate::lab::verify::skies::{self, Drawn};
use crate::lab::verify::{Check, VerifyError};
use crate::render::Renderer;
use crate::scene::Preset;

/// Skies after which the command says where it is.
const REPORT: u64 = 100;
/// Of all skies so many have to show some cloud and some sky.
const LEAST_TELLING: f64 = 60.0;
/// Opacity over the picture that counts as some of both.
const TELLING: std::ops::RangeInclusive<f64> = 0.05..=0.95;

#[derive(Clone, Debug, Args)]
pub(super) struct SkiesArgs {
    /// Draw so many skies from the whole range of every parameter, and look at each pixel, instead of the other checks.
    #[arg(long, value_name = "COUNT")]
    pub(super) skies: Option<u64>,
    /// How many of them to leave out at the beginning; a run that was interrupted says where to go on.
    #[arg(long, default_value = "0", requires = "skies", value_name = "INDEX")]
    from: u64,
    /// Kinds of skies; those of a kind share their programs.
    #[arg(long, default_value = "50", requires = "skies", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    kinds: u64,
    /// Folder for what fails, made as simple as it can be, as presets.
    #[arg(long, requires = "skies", value_name = "FOLDER")]
    failures: Option<PathBuf>,
    /// File for the light of all pictures, to compare another driver with.
    #[arg(long, requires = "skies", value_name = "FILE")]
    save: Option<PathBuf>,
    /// Such a file of the same skies, made by another driver.
    #[arg(long, requires = "skies", value_name = "FILE")]
    against: Option<PathBuf>,
}

/// Values of one picture.
const VALUES: usize = (skies::SIZE[0] * skies::SIZE[1] * 3) as usize;

/// What other drivers made of the same skies: difference of each picture's mean, and of each pixel, relative to the
/// greatest value of the picture.
#[derive(Debug, Default)]
struct Agreement {
    means: Vec<f64>,
    pixels: Vec<f64>,
}

impl Agreement {
    fn add(&mut self, seen: &[f32], expected: &[f32]) {
        let greatest = expected.iter().fold(f32::MIN_POSITIVE, |a, b| a.max(*b));
        let relative = |(a, b): (&f32, &f32)| f64::from(a - b) / f64::from(greatest);
        let all: Vec<f64> = seen.iter().zip(expected).map(relative).collect();
        self.means.push((all.iter().sum::<f64>() / all.len().max(1) as f64).abs());
        self.pixels.extend(all.into_iter().map(f64::abs));
    }

    fn line(&self) -> String {
        let share = |limit: f64| {
            self.pixels.iter().filter(|d| **d <= limit).count() as f64 * 100.0 / self.pixels.len().max(1) as f64
        };
        let means = Stats::of(&self.means);
        let of = |stats: Option<Stats>| {
            stats.map_or_else(|| "n/a".to_owned(), |s| format!("{:.1e}, 95 % below {:.1e}", s.median, s.p95))
        };
        format!(
            "between drivers, relative to each picture's greatest value: means differ by {}; values by {}; {:.2} % within \
             1e-4, {:.2} % within 1e-3, {:.2} % within 1e-2\n",
            of(means),
            of(Stats::of(&self.pixels)),
            share(1e-4),
            share(1e-3),
            share(1e-2)
        )
    }
}

fn read_values(path: &Path) -> Result<Vec<f32>> {
    let bytes = std::fs::read(path).with_context(|| format!("{} cannot be read", path.display()))?;
    anyhow::ensure!(
        bytes.len() % (VALUES * 4) == 0,
        "{}: {} bytes are no whole number of pictures; make it with --save",
        path.display(),
        bytes.len()
    );
    Ok(bytes.chunks_exact(4).map(|part| f32::from_le_bytes([part[0], part[1], part[2], part[3]])).collect())
}

fn keep(folder: &Path, index: u64, drawn: Drawn) -> Result<PathBuf> {
    std::fs::create_dir_all(folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    let path = folder.join(format!("sky_{index}.ron"));
    Preset::new(format!("Sky {index} at {} s", drawn.time_secs), drawn.scene).save(&path)?;
    let quality = folder.join(format!("sky_{index}.quality.ron"));
    crate::files::save_quality(&drawn.quality, &quality)?;
    Ok(path)
}

/// Draws skies and shows them; returns what is to be said of them.
pub(super) fn run(renderer: &mut Renderer, args: &SkiesArgs, count: u64) -> Result<Vec<Check>> {
    interrupt::watch();
    let expected = args.against.as_deref().map(read_values).transpose()?;
    let (mut failed, mut cloudy, mut all, mut agreement) = (Vec::new(), Vec::new(), Vec::new(), Agreement::default());
    // Skies of a kind follow each other, so that bakes are shared as well.
    let of_each_kind = count.div_ceil(args.kinds).max(1);
    for done in args.from..count {
        let index = done / of_each_kind + args.kinds * (done % of_each_kind);
        if interrupt::is_asked() {
            let said = format!("{} skies with faults so far; go on with --from {done}", failed.len());
            return Err(Interrupted(said).into());
        }
        let drawn = skies::draw(index, args.kinds);
        let shown = skies::show(renderer, &drawn).with_context(|| format!("sky {index} of {}", args.kinds))?;
        cloudy.push(shown.cloudy);
        let values: Vec<f32> = shown.light.iter().flatten().copied().collect();
        if let Some(expected) = &expected {
            let at = usize::try_from(done - args.from).unwrap_or(usize::MAX).saturating_mul(VALUES);
            let Some(expected) = expected.get(at..at + VALUES) else {
                anyhow::bail!("the file of --against holds fewer pictures than {count}")
            };
            agreement.add(&values, expected);
        }
        if args.save.is_some() {
            all.extend(values);
        }
        if let Some(fault) = shown.fault {
            let mut said = format!("sky {index}: {fault}");
            if let Some(folder) = &args.failures {
                let mut is_faulty =
                    |drawn: &Drawn| -> Result<bool, VerifyError> { Ok(skies::show(renderer, drawn)?.fault.is_some()) };
                let least = skies::shrink(&drawn, &mut is_faulty)?;
                said = format!("{said}; {}", keep(folder, index, least)?.display());
            }
            eprintln!("{said}");
            failed.push(index);
        }
        if (done + 1) % REPORT == 0 {
            eprintln!("{} of {count} skies, {} with faults", done + 1, failed.len());
        }
    }
    if let Some(path) = &args.save {
        let bytes: Vec<u8> = all.iter().flat_map(|value: &f32| value.to_le_bytes()).collect();
        write_atomically(path, |file| file.write_all(&bytes).map_err(|cause| ExportError::writing(path, cause)))?;
    }
    if expected.is_some() {
        eprint!("{}", agreement.line());
    }
    let shown = count.saturating_sub(args.from);
    let share = |test: &dyn Fn(f64) -> bool| {
        100.0 * cloudy.iter().filter(|share| test(**share)).count() as f64 / cloudy.len().max(1) as f64
    };
    let telling = share(&|share| TELLING.contains(&share));
    Ok(vec![
        Check {
            name: format!("{shown} skies that nobody made, of {} kinds", args.kinds),
            holds: failed.is_empty(),
            figure: format!("{} with faults", failed.len()),
        },
        Check {
            name: "enough of them show clouds and sky".to_owned(),
            holds: telling >= LEAST_TELLING,
            figure: format!(
                "{telling:.0} %, wanted {LEAST_TELLING} %; {:.0} % are clear, {:.0} % overcast",
                share(&|share| share < *TELLING.start()),
                share(&|share| share > *TELLING.end()),
            ),
        },
    ])
}
