//! What a number may be, said in the same words wherever it is refused: loading, `--set`, panel.

use std::fmt::{self, Display};
use std::ops::RangeInclusive;

use super::param::{Colour, Info, Unit};

/// The brightest a component of a colour may be; colours are tints, their strength has parameters of its own.
pub const COLOUR_MAX: f32 = 100.0;

/// A value that its parameter refuses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Key of the parameter, such as `layers.0.base_m`.
    pub key: String,
    /// The value with its unit.
    pub value: String,
    /// The range with its unit, such as `0 m ..= 15000 m`; empty where any number will do.
    pub allowed: String,
    /// Whether the value is a number at all, neither infinite nor NaN.
    pub is_finite: bool,
}

impl Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, value, allowed, is_finite } = self;
        match (is_finite, allowed.is_empty()) {
            (true, _) => write!(f, "{key} = {value} is outside {allowed}"),
            (false, false) => write!(f, "{key} = {value} is not a finite number; allowed are {allowed}"),
            (false, true) => write!(f, "{key} = {value} is not a finite number"),
        }
    }
}

/// `0 m ..= 15000 m`.
pub fn range_phrase<T: Display>(range: &RangeInclusive<T>, unit: Unit) -> String {
    let suffix = unit.suffix();
    format!("{}{suffix} ..= {}{suffix}", range.start(), range.end())
}

/// What is wrong with a number, if anything.
pub fn float_fault(key: &str, info: &Info<f32>, value: f32) -> Option<Fault> {
    let is_inside = info.range.as_ref().is_none_or(|range| range.contains(&value));
    (!value.is_finite() || !is_inside).then(|| Fault {
        key: key.to_owned(),
        value: format!("{value}{}", info.unit.suffix()),
        allowed: info.range.as_ref().map_or(String::new(), |range| range_phrase(range, info.unit)),
        is_finite: value.is_finite(),
    })
}

/// What is wrong with a whole number, if anything.
pub fn count_fault(key: &str, info: &Info<u32>, value: u32) -> Option<Fault> {
    let range = info.range.as_ref().filter(|range| !range.contains(&value))?;
    Some(Fault {
        key: key.to_owned(),
        value: format!("{value}{}", info.unit.suffix()),
        allowed: range_phrase(range, info.unit),
        is_finite: true,
    })
}

/// What is wrong with a colour, if anything.
pub fn colour_fault(key: &str, value: Colour) -> Option<Fault> {
    let parts = [value.0, value.1, value.2];
    let wrong = parts.into_iter().find(|part| !(0.0..=COLOUR_MAX).contains(part))?;
    Some(Fault {
        key: key.to_owned(),
        value: format!("({}, {}, {})", value.0, value.1, value.2),
        allowed: format!("0 ..= {COLOUR_MAX} for each component"),
        is_finite: wrong.is_finite(),
    })
}
