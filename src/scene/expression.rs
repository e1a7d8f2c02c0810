//! Numbers as people type them: `1.5 km`, `30 km/h`, `2 * (300 + 50)`, `pi/6 rad`.

use super::param::Unit;

/// What a typed number is worth in the parameter's own unit; `None` if it cannot be read or is not finite.
///
/// Sums, products, powers and brackets; a number or a bracket may carry a unit that measures the same thing, and the last
/// one of a quotient is that of the quotient: `pi/6 rad`. A comma is a decimal point.
pub fn evaluate(text: &str, unit: Unit) -> Option<f64> {
    let text = text.replace('−', "-").replace(',', ".").replace('×', "*");
    let mut reader = Reader { rest: text.trim_end(), units: units_of(unit), unit: 1.0, depth: 0 };
    let value = reader.sum()?;
    (reader.rest.trim_start().is_empty() && value.is_finite()).then_some(value)
}

/// Names of units and what they are worth, longer names before those that they begin with.
fn units_of(unit: Unit) -> &'static [(&'static str, f64)] {
    match unit {
        Unit::None => &[("%", 0.01)],
        Unit::Metres => {
            &[("mm", 1e-3), ("mi", 1609.344), ("m", 1.0), ("km", 1e3), ("cm", 1e-2), ("ft", 0.3048), ("nmi", 1852.0)]
        }
        Unit::PerMetre => &[("1/km", 1e-3), ("/km", 1e-3), ("1/m", 1.0), ("/m", 1.0)],
        Unit::Degrees => &[("deg", 1.0), ("°", 1.0), ("rad", 57.295_779_513_082_32)],
        Unit::MetresPerSecond => &[("m/s", 1.0), ("km/h", 1.0 / 3.6), ("kn", 0.514_444), ("mph", 0.447_04)],
        Unit::Seconds => &[("ms", 1e-3), ("min", 60.0), ("s", 1.0), ("h", 3600.0), ("d", 86_400.0)],
        Unit::Hours => &[("min", 1.0 / 60.0), ("s", 1.0 / 3600.0), ("h", 1.0)],
        Unit::Stops => &[("EV", 1.0)],
        Unit::Kilolux => &[("klx", 1.0), ("lx", 1e-3)],
        Unit::Nits => &[("cd/m²", 1.0), ("cd/m2", 1.0), ("nit", 1.0)],
        Unit::Pixels => &[("px", 1.0)],
        Unit::Kelvin => &[("K", 1.0)],
    }
}

/// Brackets within brackets beyond this are nobody's number.
const DEEPEST: u32 = 64;

struct Reader<'t> {
    rest: &'t str,
    units: &'static [(&'static str, f64)],
    /// What the unit is worth that was read since the last factor.
    unit: f64,
    depth: u32,
}

impl Reader<'_> {
    /// Takes the next letter if it is this one.
    fn take(&mut self, letter: char) -> bool {
        let rest = self.rest.trim_start().strip_prefix(letter);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn sum(&mut self) -> Option<f64> {
        let mut value = self.product()?;
        loop {
            if self.take('+') {
                value += self.product()?;
            } else if self.take('-') {
                value -= self.product()?;
            } else {
                return Some(value);
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut value = self.signed()? * self.take_unit();
        loop {
            if self.take('*') {
                value *= self.signed()? * self.take_unit();
            } else if self.take('/') {
                value = value / self.signed()? * self.take_unit();
            } else {
                return Some(value);
            }
        }
    }

    fn take_unit(&mut self) -> f64 {
        std::mem::replace(&mut self.unit, 1.0)
    }

    fn signed(&mut self) -> Option<f64> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let value = if self.take('-') {
            -self.signed()?
        } else if self.take('+') {
            self.signed()?
        } else {
            self.power()?
        };
        self.depth -= 1;
        Some(value)
    }

    fn power(&mut self) -> Option<f64> {
        let base = self.atom()?;
        self.read_unit();
        if self.take('^') { Some(base.powf(self.signed()?)) } else { Some(base) }
    }

    fn atom(&mut self) -> Option<f64> {
        if self.take('(') {
            let value = self.sum()?;
            return self.take(')').then_some(value);
        }
        self.rest = self.rest.trim_start();
        if let Some(rest) = self.rest.strip_prefix("pi") {
            self.rest = rest;
            return Some(std::f64::consts::PI);
        }
        let digits = |text: &str| text.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(text.len());
        let mut end = digits(self.rest);
        if self.rest[end..].starts_with('.') {
            end += 1 + digits(&self.rest[end + 1..]);
        }
        // An exponent, unless what follows the e is none.
        if let Some(exponent) = self.rest[end..].strip_prefix(['e', 'E']) {
            let sign = usize::from(exponent.starts_with(['+', '-']));
            let length = digits(&exponent[sign..]);
            if length > 0 {
                end += 1 + sign + length;
            }
        }
        let value = self.rest[..end].parse().ok()?;
        self.rest = &self.rest[end..];
        Some(value)
    }

    /// Reads the unit behind a number, if there is one.
    fn read_unit(&mut self) {
        let text = self.rest.trim_start();
        for (name, worth) in self.units {
            let Some(rest) = text.get(..name.len()).filter(|start| start.eq_ignore_ascii_case(name)) else { continue };
            let after = &text[rest.len()..];
            if !after.starts_with(char::is_alphanumeric) {
                self.rest = after;
                self.unit *= worth;
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_carry_units_and_are_computed() {
        let cases = [
            ("1200", Unit::Metres, 1200.0),
            ("1200 m", Unit::Metres, 1200.0),
            ("1.5km", Unit::Metres, 1500.0),
            ("1,5 KM + 20", Unit::Metres, 1520.0),
            ("1 mi", Unit::Metres, 1609.344),
            ("2*(300 + 50) m", Unit::Metres, 700.0),
            ("36 km/h", Unit::MetresPerSecond, 10.0),
            ("36/4 m/s", Unit::MetresPerSecond, 9.0),
            ("30 1/km", Unit::PerMetre, 0.03),
            ("0.05 /m", Unit::PerMetre, 0.05),
            ("pi/2 rad", Unit::Degrees, std::f64::consts::FRAC_PI_2 * 57.295_779_513_082_32),
            ("−3,5 EV", Unit::Stops, -3.5),
            ("1e3", Unit::None, 1000.0),
            ("2^3^2", Unit::None, 512.0),
            ("-2^2", Unit::None, -4.0),
            ("40 %", Unit::None, 0.4),
            ("90 min", Unit::Hours, 1.5),
            ("1 d", Unit::Seconds, 86_400.0),
        ];
        for (text, unit, value) in cases {
            let seen = evaluate(text, unit).unwrap_or_else(|| panic!("{text}"));
            assert!((seen - value).abs() <= 1e-9 * value.abs(), "{text}: {seen}, not {value}");
        }
    }

    #[test]
    fn nonsense_is_no_number() {
        let deep = "(".repeat(5000);
        for bad in ["", "NaN", "inf", "abc", "1e999", "1/0", "3 4", "2 *", "(1", "1)", "5 kg", "1 m", &deep, "--", "."]
        {
            assert_eq!(evaluate(bad, Unit::Kelvin), None, "{bad}");
        }
        assert_eq!(evaluate("5 s", Unit::Metres), None, "another dimension");
    }
}
