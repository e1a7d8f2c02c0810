//! What accuracy costs: settings of the march against the truths of the same frame, error beside milliseconds.
//!
//! Each setting is one still of the frame, all pixels marched. Its light is compared with that of [`Integrator::Converged`]
//! (*discretisation error*: what finer steps would change) and of [`Integrator::PathTraced`] (*model error*: what all
//! orders of scattering would change), over pixels with cloud and over the whole picture. Times are of interleaved
//! rounds, one still of each setting a round, so that a machine that warms up spoils all alike.

use std::time::Duration;

use super::bench::Stats;
use super::flip::{self, PIXELS_PER_DEGREE};
use super::metrics::{Errors, Estimate, MetricError, Reference, Split, mask};
use super::pareto::{self, Point};
use super::plot::{Plot, Series};
use super::table::{Cell, Table};
use crate::plan::Integrator;
use crate::render::truth::{Convergence, Goal, Truth};
use crate::render::{Counts, RenderError, Renderer};
use crate::scene::edit::{self, EditError};
use crate::scene::param::Choice as _;
use crate::scene::{Frame, Output, Quality, Scene, UpdateFraction};

/// Most settings that one run measures.
pub const MAX_SETTINGS: usize = 256;

/// Why nothing could be measured.
#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    /// Rendering failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A parameter cannot be set so.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// A figure has no meaning.
    #[error("the pictures cannot be compared: {0}")]
    Metric(#[from] MetricError),
    /// FLIP has no meaning.
    #[error("the pictures cannot be compared: {0}")]
    Flip(#[from] flip::FlipError),
    /// An axis that is none.
    #[error("the axis {0} is not of the form quality.parameter=value,value,…, such as quality.light_steps=2,4,8")]
    NoAxis(String),
    /// A sweep over what the sky is.
    #[error("{0} is a parameter of the sky; accuracy is swept over quality, such as quality.light_steps=2,4,8")]
    NotQuality(String),
    /// A sweep over what pictures that are measured do not have.
    #[error(
        "{0} says how a picture is put together; what is measured is one whole march through the middle of each pixel"
    )]
    NotOfMarch(String),
    /// Too many settings.
    #[error("the axes make {0} settings, but at most {MAX_SETTINGS} are measured; leave out some values")]
    TooMany(usize),
}

impl AccuracyError {
    /// Whether there was nothing to measure.
    pub fn is_of_no_pixels(&self) -> bool {
        matches!(self, Self::Metric(MetricError::NoPixels))
    }
}

/// Parameters that a whole march through the middle of each pixel does without.
const PUT_TOGETHER: [&str; 5] = [
    "quality.update",
    "quality.update_order",
    "quality.resolution_scale",
    "quality.pixel_samples",
    "quality.still_step",
];

/// One parameter of quality and the values it takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Its key, with `quality.` before it.
    pub key: String,
    /// Its values as a preset writes them.
    pub values: Vec<String>,
}

impl Axis {
    /// Reads `quality.light_steps=2,4,8`.
    ///
    /// # Errors
    /// [`AccuracyError::NoAxis`], [`AccuracyError::NotQuality`] and [`AccuracyError::NotOfMarch`].
    pub fn parse(text: &str) -> Result<Self, AccuracyError> {
        let refused = || AccuracyError::NoAxis(text.to_owned());
        let (key, values) = text.split_once('=').ok_or_else(refused)?;
        let values: Vec<String> =
            values.split(',').map(|value| value.trim().to_owned()).filter(|value| !value.is_empty()).collect();
        if values.is_empty() {
            return Err(refused());
        }
        if !key.trim().starts_with("quality.") {
            return Err(AccuracyError::NotQuality(key.trim().to_owned()));
        }
        if PUT_TOGETHER.contains(&key.trim()) {
            return Err(AccuracyError::NotOfMarch(key.trim().to_owned()));
        }
        Ok(Self { key: key.trim().to_owned(), values })
    }
}

/// One way to compute the frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// What differs from the others, such as `light_steps=4`.
    pub name: String,
    /// All of it.
    pub quality: Quality,
    /// Whether it is the one in use.
    pub is_current: bool,
}

/// The setting in use, and all combinations of the axes' values. Every value is checked by the parameter's own range.
///
/// # Errors
/// [`AccuracyError::Edit`] for an unknown parameter or a value out of range, [`AccuracyError::TooMany`].
pub fn settings(current: &Quality, axes: &[Axis]) -> Result<Vec<Setting>, AccuracyError> {
    let count = axes.iter().fold(1usize, |count, axis| count.saturating_mul(axis.values.len()));
    if count > MAX_SETTINGS {
        return Err(AccuracyError::TooMany(count));
    }
    let mut all = vec![Setting { name: String::new(), quality: current.clone(), is_current: false }];
    for axis in axes {
        let mut next = Vec::new();
        for setting in &all {
            for value in &axis.values {
                let mut quality = setting.quality.clone();
                let assignment = format!("{}={value}", axis.key);
                edit::apply(&[assignment], &mut Scene::default(), &mut quality)?;
                let name = format!("{} {}={value}", setting.name, axis.key.trim_start_matches("quality."));
                next.push(Setting { name: name.trim().to_owned(), quality, is_current: false });
            }
        }
        all = next;
    }
    all.retain(|setting| axes.is_empty() || setting.quality != *current);
    all.insert(0, Setting { name: "current".to_owned(), quality: current.clone(), is_current: true });
    if axes.is_empty() {
        all.truncate(1);
    }
    Ok(all)
}

/// A truth of the frame and what it cost.
#[derive(Clone, Debug)]
pub struct TruthImage {
    /// Which one.
    pub integrator: Integrator,
    /// Where it stopped.
    pub progress: Convergence,
    size: [u32; 2],
    light: Vec<[f32; 3]>,
    opacity: Vec<f32>,
    variance: Option<Vec<[f32; 3]>>,
    /// Display-encoded, 0 to 1.
    shown: Vec<[f32; 3]>,
}

impl TruthImage {
    /// What a truth has come to.
    pub(super) fn of(renderer: &Renderer, truth: Truth, goal: Goal, size: [u32; 2]) -> Result<Self, AccuracyError> {
        let progress = truth.progress();
        let picture = truth.picture(renderer)?;
        let (_, display) = renderer.rgba8_of(&truth.into_display())?;
        Ok(Self {
            integrator: goal.integrator(),
            progress,
            size,
            light: rgb(&picture.image.rgba),
            opacity: picture.clouds.iter().map(|cloud| 1.0 - cloud[3]).collect(),
            variance: (!picture.variance.is_empty()).then(|| rgb(&picture.variance)),
            shown: shown(&display),
        })
    }

    /// Light of each pixel.
    pub fn light(&self) -> &[[f32; 3]] {
        &self.light
    }

    /// Opacity of the clouds in each pixel.
    pub fn opacity(&self) -> &[f32] {
        &self.opacity
    }

    /// Variance of each pixel's mean; empty for a march.
    pub fn variance(&self) -> &[[f32; 3]] {
        self.variance.as_deref().unwrap_or_default()
    }
}

fn rgb(pixels: &[[f32; 4]]) -> Vec<[f32; 3]> {
    pixels.iter().map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

fn shown(rgba: &[u8]) -> Vec<[f32; 3]> {
    rgba.chunks_exact(4).map(|pixel| [0, 1, 2].map(|channel| f32::from(pixel[channel]) / 255.0)).collect()
}

/// A frame of a sky at a quality, all pixels, at its own size, for a file.
fn still<'a>(scene: &'a Scene, quality: &'a Quality, size: [u32; 2]) -> Frame<'a> {
    Frame { scene, quality, size, time_secs: 0.0, output: Output::Linear, window: None }
}

/// Quality as a still of it is computed.
fn of_still(quality: &Quality) -> Quality {
    Quality { update: UpdateFraction::Full, resolution_scale: 1.0, ..quality.clone() }
}

/// Finds a truth. `watch` hears of progress.
///
/// # Errors
/// [`AccuracyError::Render`].
pub fn truth(
    renderer: &mut Renderer,
    (scene, quality): (&Scene, &Quality),
    size: [u32; 2],
    goal: Goal,
    watch: &mut dyn FnMut(&Convergence),
) -> Result<TruthImage, AccuracyError> {
    let mut truth = begin_truth(renderer, (scene, quality), size, goal)?;
    loop {
        let progress = truth.advance(renderer, Duration::from_millis(500), Duration::from_millis(200))?;
        watch(&progress);
        if progress.is_done {
            return TruthImage::of(renderer, truth, goal, size);
        }
    }
}

/// Begins a truth of a still.
pub(super) fn begin_truth(
    renderer: &mut Renderer,
    (scene, quality): (&Scene, &Quality),
    size: [u32; 2],
    goal: Goal,
) -> Result<Truth, AccuracyError> {
    // Truths read the clouds themselves: voxels are one of the things that are measured.
    let quality = Quality { grid_voxels: 0, ..of_still(quality) };
    Ok(renderer.begin_truth(&still(scene, &quality, size), goal, 1)?)
}

/// Errors of one setting against one truth.
#[derive(Clone, Copy, Debug)]
pub struct Against {
    /// Which truth.
    pub integrator: Integrator,
    /// Over pixels with cloud, without the sun's disc.
    pub clouds: Errors,
    /// Over the whole picture without the sun's disc.
    pub whole: Errors,
    /// Mean FLIP of the tone-mapped picture, 0 to 1.
    pub flip: f64,
    /// The error over clouds in its two parts, where several seeds were measured.
    pub split: Option<Split>,
}

/// What was measured of one setting.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The setting.
    pub setting: Setting,
    /// Milliseconds of the march in each round.
    pub march_ms: Vec<f64>,
    /// Work of the march.
    pub counts: Counts,
    /// Errors against each truth.
    pub against: Vec<Against>,
}

impl Measured {
    /// The error that plots and choices go by: relRMSE over pixels with cloud.
    pub fn error(&self, integrator: Integrator) -> Option<Estimate> {
        let against = self.against.iter().find(|against| against.integrator == integrator)?;
        Some(against.clouds.rel_rmse)
    }

    /// Median milliseconds of the march.
    pub fn median_ms(&self) -> Option<f64> {
        Stats::of(&self.march_ms).map(|stats| stats.median)
    }
}

/// Errors and work of one setting.
pub(super) fn compared(
    renderer: &mut Renderer,
    scene: &Scene,
    setting: &Setting,
    (truths, size, seeds): (&[TruthImage], [u32; 2], u32),
) -> Result<Measured, AccuracyError> {
    let quality = of_still(&setting.quality);
    let frame = still(scene, &quality, size);
    let mut others = Vec::new();
    for seed in 1..seeds {
        renderer.set_jitter_seed(seed);
        let rendered = renderer.render(&frame);
        renderer.set_jitter_seed(0);
        rendered?;
        others.push(rgb(&renderer.linear()?.rgba));
    }
    renderer.render(&frame)?;
    let light = rgb(&renderer.linear()?.rgba);
    let display = shown(&renderer.display_rgba8()?.1);
    let all = truths.iter().map(|truth| compare(scene, truth, (&light, &others), &display));
    let against = all.collect::<Result<Vec<_>, _>>()?;
    let counts = renderer.counted_reads(&frame)?;
    Ok(Measured { setting: setting.clone(), march_ms: Vec::new(), counts, against })
}

/// Times the march of one setting once more.
pub(super) fn timed(
    renderer: &mut Renderer,
    scene: &Scene,
    row: &mut Measured,
    size: [u32; 2],
) -> Result<(), AccuracyError> {
    let report = renderer.render(&still(scene, &of_still(&row.setting.quality), size))?;
    let march = report.passes.iter().find(|time| time.pass == "march");
    row.march_ms.extend(march.and_then(|time| time.millis));
    Ok(())
}

fn compare(
    scene: &Scene,
    truth: &TruthImage,
    (light, other_seeds): (&[[f32; 3]], &[Vec<[f32; 3]>]),
    display: &[[f32; 3]],
) -> Result<Against, AccuracyError> {
    let width = truth.size[0] as usize;
    let clouds = mask::cloud_pixels(&truth.opacity, scene, truth.size);
    let everything = mask::without(&vec![true; light.len()], &mask::sun_disc(scene, truth.size));
    fn against<'a>(truth: &'a TruthImage, mask: Option<&'a Vec<bool>>) -> Reference<'a> {
        let (variance, width) = (truth.variance.as_deref(), truth.size[0] as usize);
        Reference { pixels: &truth.light, variance, mask: mask.map(Vec::as_slice), width }
    }
    let of_clouds = against(truth, clouds.as_ref());
    let split = if other_seeds.is_empty() {
        None
    } else {
        let seeds: Vec<&[[f32; 3]]> = std::iter::once(light).chain(other_seeds.iter().map(Vec::as_slice)).collect();
        Some(of_clouds.split(&seeds)?)
    };
    Ok(Against {
        integrator: truth.integrator,
        clouds: of_clouds.errors(light)?,
        whole: against(truth, everything.as_ref()).errors(light)?,
        split,
        flip: flip::flip(&truth.shown, display, width, PIXELS_PER_DEGREE)?.mean,
    })
}

/// Cost and error of each setting that has both, with its place in `rows`.
fn points(rows: &[Measured], integrator: Integrator) -> Vec<(usize, Point)> {
    let point = |(index, row): (usize, &Measured)| {
        let error = row.error(integrator)?.value;
        Some((index, Point { cost: row.median_ms()?, error }))
    };
    rows.iter().enumerate().filter_map(point).collect()
}

/// Which settings are on the front: none of the others is both cheaper and more accurate.
pub fn front(rows: &[Measured], integrator: Integrator) -> Vec<usize> {
    let points = points(rows, integrator);
    let plain: Vec<Point> = points.iter().map(|(_, point)| *point).collect();
    pareto::front(&plain).into_iter().map(|index| points[index].0).collect()
}

/// A setting chosen by a budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chosen {
    /// Its place among the rows.
    pub row: usize,
    /// Whether it keeps to the budget; otherwise it is the nearest there is.
    pub is_within: bool,
}

fn chosen(points: &[(usize, Point)], choice: Option<pareto::Choice>) -> Option<Chosen> {
    let choice = choice?;
    Some(Chosen { row: points[choice.index()].0, is_within: matches!(choice, pareto::Choice::Within(_)) })
}

/// The cheapest setting with an error of at most so much, or the most accurate one where none has.
pub fn cheapest(rows: &[Measured], integrator: Integrator, max_error: f64) -> Option<Chosen> {
    let points = points(rows, integrator);
    let plain: Vec<Point> = points.iter().map(|(_, point)| *point).collect();
    chosen(&points, pareto::cheapest_within_error(&plain, max_error))
}

/// The most accurate setting whose march takes at most so long, or the cheapest one where none does.
pub fn most_accurate(rows: &[Measured], integrator: Integrator, max_ms: f64) -> Option<Chosen> {
    let points = points(rows, integrator);
    let plain: Vec<Point> = points.iter().map(|(_, point)| *point).collect();
    chosen(&points, pareto::most_accurate_within_cost(&plain, max_ms))
}

/// All figures, a row for each setting and truth; per cent where it says so.
pub fn table(title: &str, rows: &[Measured], source: &str) -> Table {
    let columns = [
        "setting",
        "truth",
        "relRMSE %",
        "±",
        "bias %",
        "± ",
        "mean %",
        "p95 %",
        "whole %",
        "FLIP",
        "march ms",
        "p5",
        "p95",
        "reads / ray",
        "view + light steps / ray",
        "on front",
    ];
    // Over several seeds the error falls into what stays of their mean and what does not.
    let has_seeds = rows.iter().flat_map(|row| &row.against).any(|against| against.split.is_some());
    let split_columns = if has_seeds { &["same for all seeds %", "noise %"][..] } else { &[] };
    let mut table = Table::new(format!("{title} ({source})"), &[&columns[..], split_columns].concat());
    for (index, row) in rows.iter().enumerate() {
        let time = Stats::of(&row.march_ms);
        let per_ray =
            |count: u64| Cell::Number((row.counts.rays > 0).then(|| count as f64 / row.counts.rays as f64), 1);
        for against in &row.against {
            let percent = |value: f64| Cell::Number(Some(value * 100.0), 2);
            let error = |estimate: Estimate| Cell::Number(estimate.std_error.map(|error| error * 100.0), 2);
            let Errors { rel_rmse, bias, mean_relative, p95_relative, .. } = against.clouds;
            let is_front = front(rows, against.integrator).contains(&index);
            table.rows.push(vec![
                Cell::text(&row.setting.name),
                Cell::text(against.integrator.title()),
                percent(rel_rmse.value),
                error(rel_rmse),
                percent(bias.value),
                error(bias),
                percent(mean_relative.value),
                percent(p95_relative.value),
                percent(against.whole.rel_rmse.value),
                Cell::Number(Some(against.flip), 4),
                Cell::millis(time.map(|stats| stats.median)),
                Cell::millis(time.map(|stats| stats.p5)),
                Cell::millis(time.map(|stats| stats.p95)),
                per_ray(row.counts.texture_reads),
                per_ray(row.counts.view_steps + row.counts.light_steps),
                Cell::text(if is_front { "yes" } else { "" }),
            ]);
            if let (Some(row), true) = (table.rows.last_mut(), has_seeds) {
                let root = |part: fn(&Split) -> f64| {
                    Cell::Number(against.split.as_ref().map(|split| part(split).max(0.0).sqrt() * 100.0), 2)
                };
                row.extend([root(|split| split.bias_squared.value), root(|split| split.variance.value)]);
            }
        }
    }
    table
}

/// Error over time of all settings, with the front against each truth and the setting in use marked.
pub fn plot(title: &str, rows: &[Measured], truths: &[Integrator], source: &str) -> Plot {
    let series = |integrator: Integrator| {
        let points = points(rows, integrator).into_iter().map(|(_, point)| [point.cost, point.error * 100.0]);
        Series { name: integrator.title().to_owned(), points: points.collect(), joined: false }
    };
    let first = truths.first().copied();
    let place = |row: usize| {
        let row = &rows[row];
        Some([row.median_ms()?, row.error(first?)?.value * 100.0])
    };
    let on_front = first.map(|integrator| front(rows, integrator)).unwrap_or_default();
    Plot {
        title: title.to_owned(),
        x_label: format!("march, ms ({source})"),
        y_label: "relRMSE over clouds, %".to_owned(),
        series: truths.iter().map(|truth| series(*truth)).collect(),
        front: on_front.into_iter().filter_map(place).collect(),
        current: rows.iter().position(|row| row.setting.is_current).and_then(place),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_read_and_refused() {
        let axis = Axis::parse("quality.light_steps=2, 4,8").expect("an axis");
        assert_eq!((axis.key.as_str(), axis.values.len()), ("quality.light_steps", 3));
        for wrong in ["quality.light_steps", "quality.light_steps=", "quality.light_steps=,"] {
            assert!(matches!(Axis::parse(wrong), Err(AccuracyError::NoAxis(_))), "{wrong}");
        }
        assert!(matches!(Axis::parse("weather.coverage=0.1"), Err(AccuracyError::NotQuality(_))));
    }

    #[test]
    fn axes_multiply_and_the_setting_in_use_comes_first() {
        let axes = ["quality.light_steps=2,4", "quality.octaves=0,3"].map(|text| Axis::parse(text).expect("an axis"));
        let all = settings(&Quality::default(), &axes).expect("settings");
        assert_eq!(all.len(), 5);
        assert!(all[0].is_current && all[1].name == "light_steps=2 octaves=0", "{}", all[1].name);
        assert_eq!((all[4].quality.light_steps, all[4].quality.octaves), (4, 3));
        let same = Axis::parse(&format!("quality.light_steps={}", Quality::default().light_steps)).expect("an axis");
        assert_eq!(settings(&Quality::default(), &[same]).expect("settings").len(), 1, "not measured twice");
    }

    #[test]
    fn what_no_parameter_allows_is_refused() {
        let refused = |text: &str| settings(&Quality::default(), &[Axis::parse(text).expect("an axis")]);
        assert!(matches!(refused("quality.light_steps=2,100000"), Err(AccuracyError::Edit(EditError::OutOfRange(_)))));
        assert!(matches!(refused("quality.lihgt_steps=2"), Err(AccuracyError::Edit(EditError::UnknownKey { .. }))));
        let samples = Axis::parse("quality.pixel_samples=1,4");
        assert!(matches!(samples, Err(AccuracyError::NotOfMarch(_))), "{samples:?} would change nothing");
        let many: Vec<String> = (4..=404).map(|steps| steps.to_string()).collect();
        let axis = Axis { key: "quality.view_steps".to_owned(), values: many };
        assert!(matches!(settings(&Quality::default(), &[axis]), Err(AccuracyError::TooMany(401))));
    }
}
