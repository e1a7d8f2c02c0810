//! A logarithmic axis: its range, and where it has ticks and numbers.

/// Spans of at most this many decades have numbers at 1, 2 and 5.
const SHORT: f64 = 2.0;
/// Spans of at most this many decades have ticks at 2, 3, … 9.
const MEDIUM: f64 = 10.0;
/// No axis has more numbers at decades than this.
const MOST_DECADES: i32 = 8;
/// Room between the outermost points and the ends, as a share of the span, and in decades at least.
const ROOM: f64 = 0.04;
const LEAST_ROOM: f64 = 0.08;

/// The logarithm of what can be shown: finite and above zero.
pub(super) fn log(value: f64) -> Option<f64> {
    (value.is_finite() && value > 0.0).then(|| value.log10())
}

/// One mark on the axis, at mantissa · 10^exponent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tick {
    mantissa: u8,
    exponent: i32,
    /// Whether its number is written.
    pub(super) numbered: bool,
}

impl Tick {
    /// Its logarithm, which exists even where the number itself overflows.
    pub(super) fn log(self) -> f64 {
        f64::from(self.mantissa).log10() + f64::from(self.exponent)
    }
}

/// A range and its ticks.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    /// Decimal logarithms of the ends.
    pub(super) range: [f64; 2],
    /// From low to high.
    pub(super) ticks: Vec<Tick>,
}

impl Axis {
    /// An axis that holds all these logarithms, with room at the ends; from 1 to 10 if there are none.
    pub(super) fn new(logs: impl Iterator<Item = f64>) -> Self {
        let [low, high] =
            logs.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], log| [low.min(log), high.max(log)]);
        if low > high {
            return Self::between([0.0, 1.0]);
        }
        let room = (ROOM * (high - low)).max(LEAST_ROOM);
        Self::between([snapped(low - room, f64::floor), snapped(high + room, f64::ceil)])
    }

    fn between(range: [f64; 2]) -> Self {
        let span = range[1] - range[0];
        let (first, last) = (whole(range[0]), whole(range[1]));
        let stride = (last - first) / MOST_DECADES + 1;
        let numbered = |mantissa: u8, exponent: i32| match mantissa {
            1 => exponent.rem_euclid(stride) == 0,
            2 | 5 => span <= SHORT + 1e-9,
            _ => false,
        };
        let marked = |mantissa: u8, exponent: i32| {
            span <= MEDIUM || mantissa == 1 && (span <= 8.0 * MEDIUM || numbered(1, exponent))
        };
        let ticks = (first..=last).flat_map(|exponent| (1..=9).map(move |mantissa| (mantissa, exponent)));
        let ticks = ticks
            .filter(|(mantissa, exponent)| marked(*mantissa, *exponent))
            .map(|(mantissa, exponent)| Tick { mantissa, exponent, numbered: numbered(mantissa, exponent) });
        let inside = |tick: &Tick| (range[0] - 1e-9..=range[1] + 1e-9).contains(&tick.log());
        Self { range, ticks: ticks.filter(inside).collect() }
    }

    /// The number of a tick as SVG text. One axis writes all its numbers in one way: in full, or as powers of ten.
    pub(super) fn number(&self, tick: Tick) -> String {
        let Tick { mantissa, exponent, .. } = tick;
        if self.range[0] < -4.0 - 1e-9 || self.range[1] > 4.0 + 1e-9 {
            let factor = if mantissa == 1 { String::new() } else { format!("{mantissa}·") };
            let sign = if exponent < 0 { "−" } else { "" };
            let power = exponent.abs();
            return format!("{factor}10<tspan dy=\"-5\" font-size=\"10\">{sign}{power}</tspan>");
        }
        in_full(tick)
    }

    /// The same as plain text.
    pub(super) fn plain_number(&self, tick: Tick) -> String {
        if self.range[0] < -4.0 - 1e-9 || self.range[1] > 4.0 + 1e-9 {
            return format!("{}e{}", tick.mantissa, tick.exponent);
        }
        in_full(tick)
    }
}

fn in_full(Tick { mantissa, exponent, .. }: Tick) -> String {
    let zeros = |count: i32| "0".repeat(count.unsigned_abs() as usize);
    if exponent >= 0 {
        format!("{mantissa}{}", zeros(exponent))
    } else {
        format!("0.{}{mantissa}", zeros(exponent + 1))
    }
}

/// The next logarithm of 1, 2 or 5 times a power of ten in the direction in which `round` goes.
fn snapped(log: f64, round: fn(f64) -> f64) -> f64 {
    let decade = log.floor();
    let steps = [0.0, 2_f64.log10(), 5_f64.log10(), 1.0].map(|step| decade + step);
    if round(0.5) > 0.0 {
        steps.into_iter().find(|step| *step >= log - 1e-9).unwrap_or(log)
    } else {
        steps.into_iter().rev().find(|step| *step <= log + 1e-9).unwrap_or(log)
    }
}

/// The decade that a logarithm lies in.
fn whole(log: f64) -> i32 {
    #[allow(clippy::cast_possible_truncation, reason = "logarithms of doubles lie within ±400")]
    let decade = (log + 1e-9).floor() as i32;
    decade
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(values: &[f64]) -> Vec<String> {
        let axis = Axis::new(values.iter().filter_map(|value| log(*value)));
        axis.ticks.iter().filter(|tick| tick.numbered).map(|tick| axis.number(*tick)).collect()
    }

    #[test]
    fn short_axes_count_in_1_2_5_and_long_ones_in_decades() {
        assert_eq!(numbers(&[3.0]), ["2", "5"]);
        assert_eq!(numbers(&[]), ["1", "2", "5", "10"]);
        assert_eq!(numbers(&[0.03, 0.4]), ["0.02", "0.05", "0.1", "0.2", "0.5"]);
        assert_eq!(numbers(&[0.0026, 1.1, 333.0]), ["0.001", "0.01", "0.1", "1", "10", "100", "1000"]);
        let powers = numbers(&[3e-7, 2.0]);
        assert_eq!(powers.len(), 8, "{powers:?}");
        assert_eq!(powers[0], "10<tspan dy=\"-5\" font-size=\"10\">−7</tspan>");
    }

    #[test]
    fn every_axis_holds_its_values_and_a_few_numbers() {
        let ends =
            [f64::MIN_POSITIVE * f64::EPSILON, 1e-300, 1e-9, 0.02, 0.999, 1.0, 1.001, 5.0, 777.0, 1e12, f64::MAX];
        for low in ends {
            for high in ends.into_iter().filter(|high| *high >= low) {
                let axis = Axis::new([low.log10(), high.log10()].into_iter());
                let count = axis.ticks.iter().filter(|tick| tick.numbered).count();
                assert!((2..=9).contains(&count), "{low} to {high}: {count} numbers");
                assert!(axis.ticks.len() < 120, "{low} to {high}: {} ticks", axis.ticks.len());
                assert!(
                    axis.range[0] < low.log10() && axis.range[1] > high.log10(),
                    "{low} to {high}: {:?}",
                    axis.range
                );
                assert!(axis.ticks.windows(2).all(|pair| pair[0].log() < pair[1].log()), "{low} to {high}");
            }
        }
    }

    #[test]
    fn only_finite_values_above_zero_have_a_place() {
        assert_eq!([0.0, -1.0, f64::NAN, f64::INFINITY, 100.0].map(log), [None, None, None, None, Some(2.0)]);
    }
}
