//! What each effect of a sky costs and changes: the frame as it is planned beside the same with one effect forced the
//! other way, in turns.

use super::bench::{Case, Row, Stats};
use super::colour::luminance;
use super::table::{Cell, Table};
use crate::plan::{Effect, Forced, FramePlan, Verdict};
use crate::render::{Counts, RenderError, Renderer};
use crate::scene::{Frame, Output};

/// Share of the picture's mean light below which differences are not relative any more.
const DARK: f64 = 0.05;

/// What is counted of a case, rather than timed.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    counts: Counts,
    bytes: u64,
    luminance: Vec<f64>,
}

fn plan(case: &Case, forced: Forced) -> FramePlan {
    let Case { scene, quality, size, .. } = case;
    FramePlan::forced(
        &Frame { scene, quality, size: *size, time_secs: 0.0, output: Output::Display, window: None },
        forced,
    )
}

/// The effects of a sky that can be forced the other way.
fn forceable(sky: &Case) -> Vec<Verdict> {
    plan(sky, Forced::default()).verdicts.into_iter().filter(Verdict::can_be_forced).collect()
}

/// A sky as it is planned, and then with each effect that allows it forced the other way.
pub fn cases(sky: &Case) -> Vec<Case> {
    let other = |verdict: Verdict| {
        let forced = Forced::default().with(verdict.effect, Some(!verdict.runs));
        Case { name: format!("{}, {}", sky.name, verdict.effect.info().name), forced, ..sky.clone() }
    };
    let planned = Case { forced: Forced::default(), ..sky.clone() };
    std::iter::once(planned).chain(forceable(sky).into_iter().map(other)).collect()
}

/// Counts of a case; its light is that of a still.
///
/// # Errors
/// If a frame cannot be rendered.
pub fn facts(renderer: &mut Renderer, case: &Case) -> Result<Facts, RenderError> {
    renderer.force(case.forced);
    let Case { scene, quality, size, .. } = case;
    let frame = Frame { scene, quality, size: *size, time_secs: 0.0, output: Output::Display, window: None };
    let counts = renderer.counted_reads(&frame)?;
    renderer.render(&frame)?;
    let bytes = renderer.memory_bytes();
    renderer.render(&Frame { output: Output::Linear, ..frame })?;
    let luminance = |pixel: &[f32; 4]| luminance([pixel[0], pixel[1], pixel[2]]);
    let luminance = renderer.linear()?.rgba.iter().map(luminance).collect();
    Ok(Facts { counts, bytes, luminance })
}

/// Mean and 95th percentile of the relative difference of two pictures, in per cent.
fn change(one: &Facts, other: &Facts) -> Option<[f64; 2]> {
    let mean = one.luminance.iter().sum::<f64>() / one.luminance.len().max(1) as f64;
    let relative = |(a, b): (&f64, &f64)| 100.0 * (a - b).abs() / a.max(DARK * mean).max(f64::MIN_POSITIVE);
    let all: Vec<f64> = one.luminance.iter().zip(&other.luminance).map(relative).collect();
    Stats::of(&all).map(|stats| [all.iter().sum::<f64>() / all.len() as f64, stats.p95])
}

const COLUMNS: [&str; 14] = [
    "effect",
    "runs",
    "with ms",
    "p5",
    "p95",
    "without ms",
    "p5",
    "p95",
    "costs ms",
    "reads / ray with",
    "without",
    "costs MB",
    "changes, mean %",
    "95 % below",
];

/// One row for each effect, the most expensive first. `facts` are those of the cases, as far as they are known.
pub fn table(cases: &[Case], rows: &[Row], facts: &[Facts], said: &str) -> Table {
    let Some(sky) = cases.first() else { return Table::default() };
    let mut table = Table::new(format!("{}, {}: effects ({said})", sky.name, sky.size_text()), &COLUMNS);
    let total = |index: usize| rows.get(index).and_then(|row| Stats::of(&row.total));
    let reads = |index: usize| {
        let Counts { rays, texture_reads, .. } = facts.get(index)?.counts;
        Some(texture_reads as f64 / rays.max(1) as f64)
    };
    let mut lines: Vec<(f64, Vec<Cell>)> = Vec::new();
    for (verdict, index) in forceable(sky).into_iter().zip(1..) {
        let (with, without) = if verdict.runs { (0, index) } else { (index, 0) };
        let costs = total(with).zip(total(without)).map(|(with, without)| with.median - without.median);
        let bytes = |at: usize| facts.get(at).map(|facts| facts.bytes as f64 / 1e6);
        let changes = facts.first().zip(facts.get(index)).and_then(|(planned, other)| change(planned, other));
        let mut line = vec![Cell::text(verdict.effect.info().name), Cell::text(if verdict.runs { "yes" } else { "" })];
        for at in [with, without] {
            let stats = total(at);
            line.extend([
                Cell::millis(stats.map(|stats| stats.median)),
                Cell::millis(stats.map(|stats| stats.p5)),
                Cell::millis(stats.map(|stats| stats.p95)),
            ]);
        }
        line.extend([
            Cell::millis(costs),
            Cell::Number(reads(with), 1),
            Cell::Number(reads(without), 1),
            Cell::Number(bytes(with).zip(bytes(without)).map(|(with, without)| with - without), 2),
            Cell::Number(changes.map(|[mean, _]| mean), 3),
            Cell::Number(changes.map(|[_, p95]| p95), 3),
        ]);
        lines.push((costs.unwrap_or(f64::NEG_INFINITY), line));
    }
    lines.sort_by(|one, other| other.0.total_cmp(&one.0));
    table.rows = lines.into_iter().map(|(_, line)| line).collect();
    table
}

/// docs/effects.md: the whole list, and what each one leaves behind.
pub fn reference() -> String {
    use std::fmt::Write as _;
    let mut text = String::from(
        "# Effects\n\nEverything that a frame may or may not need, in the order in which it comes to it. The plan has a \
         verdict on each of them: it is *needed*, *needless* (it would change nothing), *unwanted* (switched off) or \
         *impossible*. What does not run leaves no flag, no binding, no texture and no pass; where it is needless the \
         picture is the same with it, bit for bit unless a tolerance is given. `tests/gpu/effects.rs` proves both for every \
         row.\n\nGenerated from `src/plan/effect.rs`.\n\n| effect | does | flags | bindings | passes | may differ by |\n\
         |---|---|---|---|---|---|\n",
    );
    let code = |names: &[&str]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" ");
    for effect in Effect::ALL {
        let info = effect.info();
        let differs = if info.may_differ > 0.0 { format!("{} %", info.may_differ * 100.0) } else { String::new() };
        let does = if info.can_be_off { info.does.to_owned() } else { format!("{} Cannot be forced off.", info.does) };
        let (flags, bindings, passes) = (code(info.flags), code(info.bindings), code(info.passes));
        let _ = writeln!(text, "| {} | {does} | {flags} | {bindings} | {passes} | {differs} |", info.name);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Quality, Scene};

    #[test]
    fn there_is_a_case_for_each_effect_that_can_be_forced() {
        let (scene, quality) = (Scene::default(), Quality::default());
        let sky = Case { name: "sky".to_owned(), scene, quality, size: [64, 36], forced: Forced::default() };
        let cases = cases(&sky);
        assert!(cases.len() > 20 && cases[0].forced.is_empty() && !cases[1].forced.is_empty(), "{}", cases.len());
        let row = |ms: f64| Row { total: vec![ms; 3], ..Row::default() };
        let rows: Vec<Row> = (0..cases.len()).map(|index| row(if index == 5 { 2.0 } else { 9.0 })).collect();
        let table = table(&cases, &rows, &[], "a test");
        assert_eq!(table.rows.len(), cases.len() - 1);
        let dearest = forceable(&sky)[4].effect.info().name;
        let costs = if plan(&sky, Forced::default()).verdict(forceable(&sky)[4].effect).runs { 7.0 } else { -7.0 };
        let line = table.rows.iter().find(|line| line[0] == Cell::text(dearest)).expect("its line");
        assert_eq!(line[8], Cell::millis(Some(costs)));
    }

    #[test]
    fn the_list_is_in_the_docs() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/effects.md");
        if std::env::var_os("NEPHOSCOPE_UPDATE").is_some() {
            std::fs::write(path, reference()).expect("it can be written");
        }
        let committed = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            committed == reference(),
            "docs/effects.md is old: NEPHOSCOPE_UPDATE=1 cargo test --lib writes it anew"
        );
    }
}
