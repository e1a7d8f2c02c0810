//! Fixed sets of measurements, beside the tables and figures of the documents they come from.

use std::path::PathBuf;

use super::bench::{Case, Measurement, Rounds, Row};
use super::costa;
use super::effects::{self, Facts};
use super::plot::Plot;
use super::table::Table;
use super::thesis::{self, Settings};
use crate::choices;
use crate::render::{RenderError, Renderer};

choices! {
    /// Which set.
    pub enum SuiteKind {
        /// Table 4.1 of the thesis, with its own model and with the defaults of this program.
        Thesis ("Thesis, table 4.1"),
        /// The sweeps of Costa 2023, section 4.1: eye steps, light steps, grid sizes, resolutions.
        Costa ("Costa, section 4.1"),
        /// What each effect of this sky costs and changes: with it and without it, in turns.
        Effects ("Effects of this sky"),
    }
}

/// What is measured together.
#[derive(Clone, Copy, Debug)]
enum Part {
    Thesis(Settings),
    Costa(costa::Sweep),
    Effects,
}

/// A set under way: its parts one after the other, the cases of each in turns. It can be left after each turn.
#[derive(Clone, Debug)]
pub struct Suite {
    parts: Vec<(Part, Measurement)>,
    /// What is counted of each case once all are timed, for each part that asks for it.
    facts: Vec<Vec<Facts>>,
}

impl Suite {
    /// Nothing measured yet. Costa's cases read two images, which [`costa::textures`] makes; effects are those of `skies`.
    pub fn new(kind: SuiteKind, rounds: Rounds, textures: &[PathBuf; 2], skies: &[Case]) -> Self {
        let part = |part: Part, cases: Vec<Case>| (part, Measurement::new(cases, rounds));
        let parts: Vec<(Part, Measurement)> = match kind {
            SuiteKind::Thesis => [Settings::Thesis, Settings::Defaults]
                .map(|settings| part(Part::Thesis(settings), thesis::cases(settings)))
                .into(),
            SuiteKind::Costa => {
                costa::Sweep::ALL.map(|sweep| part(Part::Costa(sweep), costa::cases(sweep, textures))).into()
            }
            SuiteKind::Effects => skies.iter().map(|sky| part(Part::Effects, effects::cases(sky))).collect(),
        };
        let facts = vec![Vec::new(); parts.len()];
        Self { parts, facts }
    }

    /// Takes the next turn; returns whether all is measured.
    ///
    /// # Errors
    /// If a frame cannot be rendered; the turn can be tried again.
    pub fn advance(&mut self, renderer: &mut Renderer) -> Result<bool, RenderError> {
        for ((part, measurement), facts) in self.parts.iter_mut().zip(&mut self.facts) {
            if measurement.next_turn().is_some() {
                measurement.advance(renderer)?;
                break;
            }
            if let Some(case) = uncounted(*part, measurement, facts) {
                facts.push(effects::facts(renderer, case)?);
                break;
            }
        }
        Ok(self.next_turn().is_none())
    }

    /// What the next turn does, in words; `None` at the end.
    pub fn next_turn(&self) -> Option<String> {
        self.parts.iter().zip(&self.facts).find_map(|((part, measurement), facts)| {
            let counting = || uncounted(*part, measurement, facts).map(|case| format!("counting: {}", case.name));
            measurement.next_turn().or_else(counting)
        })
    }

    /// Turns taken, and turns altogether.
    pub fn turns(&self) -> (usize, usize) {
        let all = self.parts.iter().zip(&self.facts).map(|((part, measurement), facts)| {
            let (taken, of) = measurement.turns();
            let counted = if matches!(part, Part::Effects) { measurement.cases().len() } else { 0 };
            (taken + facts.len(), of + counted)
        });
        all.fold((0, 0), |(taken, count), (own, of)| (taken + own, count + of))
    }

    /// What was measured, a table for each part that has begun; those that are not at their end say so.
    pub fn tables(&self, source: &str) -> Vec<Table> {
        self.begun()
            .map(|((part, measurement), facts)| {
                let rounds = measurement.rounds_text();
                let is_partial = measurement.next_turn().is_some() || uncounted(*part, measurement, facts).is_some();
                let partial = if is_partial { ", PARTIAL" } else { "" };
                let said = format!("{source}; {rounds}{partial}");
                let rows = measurement.rows();
                match part {
                    Part::Thesis(settings) => thesis::table(*settings, &rows, &said),
                    Part::Costa(sweep) => costa::table(*sweep, (measurement.cases(), &rows), &said),
                    Part::Effects => effects::table(measurement.cases(), &rows, facts, &said),
                }
            })
            .collect()
    }

    /// Plots of what was measured, with a name for the file of each.
    pub fn plots(&self, source: &str) -> Vec<(&'static str, Plot)> {
        let plot = |(part, measurement): &(Part, Measurement)| match part {
            Part::Thesis(_) | Part::Effects => None,
            Part::Costa(sweep) => {
                let rows: Vec<Row> = measurement.rows();
                Some((sweep.file(), costa::plot(*sweep, (measurement.cases(), &rows), source)))
            }
        };
        self.begun().map(|(part, _)| part).filter_map(plot).collect()
    }

    /// The cases of each part.
    pub fn cases(&self) -> impl Iterator<Item = &[Case]> {
        self.parts.iter().map(|(_, measurement)| measurement.cases())
    }

    fn begun(&self) -> impl Iterator<Item = (&(Part, Measurement), &Vec<Facts>)> {
        self.parts.iter().zip(&self.facts).filter(|((_, measurement), _)| measurement.turns().0 > 0)
    }
}

/// The next case of which nothing is counted yet, where that is asked for.
fn uncounted<'a>(part: Part, measurement: &'a Measurement, facts: &[Facts]) -> Option<&'a Case> {
    measurement.cases().get(facts.len()).filter(|_| matches!(part, Part::Effects))
}
