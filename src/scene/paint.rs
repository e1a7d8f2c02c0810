//! What was painted on the weather map: strokes of a brush, kept as they were made. The map follows from them, so a stroke that
//! is taken back leaves nothing behind, and a preset holds the painting itself.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::param::{Choice, Info, Value, Visitor};
use crate::choices;

/// Most dabs in all strokes of a layer; more would have to be redone for too long when one is taken back.
pub const MAX_DABS: usize = 50_000;

choices! {
    /// What a brush does.
    pub enum Brush {
        /// Puts cloud of a kind where the brush is.
        Add ("Add cloud"),
        /// Takes cloud away.
        Erase ("Take cloud away"),
        /// Lets tops rise.
        Raise ("Raise tops"),
        /// Lets tops sink.
        Lower ("Lower tops"),
        /// Moves clouds along with the brush.
        Move ("Move clouds"),
        /// Draws clouds apart about the brush: they grow.
        Grow ("Let clouds grow"),
        /// Draws clouds together about the brush: they shrink.
        Shrink ("Let clouds shrink"),
        /// Smooths the clouds' outlines.
        Smooth ("Smooth"),
        /// Takes painting away: what lies below comes back.
        Restore ("Take paint away"),
    }
}

impl Brush {
    /// Whether it takes from around each place what was there before, instead of changing each place by itself.
    pub fn reworks(self) -> bool {
        matches!(self, Self::Move | Self::Grow | Self::Shrink | Self::Smooth)
    }
}

choices! {
    /// The kind of cloud that is added.
    pub enum CloudKind {
        /// Heaps.
        Cumulus ("Cumulus"),
        /// A sheet.
        Stratus ("Stratus"),
        /// Rolls and tiles.
        Stratocumulus ("Stratocumulus"),
    }
}

/// A stroke of the brush: dabs one after the other, each towards what the brush makes.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// What it does.
    pub brush: Brush,
    /// The kind of cloud that it adds.
    pub kind: CloudKind,
    /// Its radius, in edges of the map.
    pub radius: f32,
    /// How far one dab goes, 0 to 1.
    pub strength: f32,
    /// Share of the radius over which it fades, 0 to 1.
    pub softness: f32,
    /// How much cloud it adds at most, 0 to 1.
    pub amount: f32,
    /// Middles of the dabs, in edges of the map, east and south of its corner.
    pub dabs: Vec<[f32; 2]>,
}

/// All strokes of a layer of the map, the first at the bottom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strokes(pub Vec<Arc<Stroke>>);

impl Strokes {
    /// Dabs of all strokes.
    pub fn dabs(&self) -> usize {
        self.0.iter().map(|stroke| stroke.dabs.len()).sum()
    }
}

impl fmt::Display for Stroke {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { brush, kind, radius, strength, softness, amount, dabs } = self;
        write!(f, "{} {} radius {radius} strength {strength} softness {softness} ", brush.name(), kind.name())?;
        write!(f, "amount {amount} at")?;
        for [east, south] in dabs {
            write!(f, " {east},{south}")?;
        }
        Ok(())
    }
}

impl FromStr for Stroke {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut words = text.split_whitespace();
        let brush = one_of::<Brush>(words.next())?;
        let kind = one_of::<CloudKind>(words.next())?;
        let mut number = |name: &str, least: f32, most: f32| -> Result<f32, String> {
            if words.next() != Some(name) {
                return Err(format!("{name} is missing"));
            }
            let word = words.next().unwrap_or_default();
            let value: f32 = word.parse().map_err(|_| format!("{name} {word} is no number"))?;
            if value.is_finite() && (least..=most).contains(&value) {
                Ok(value)
            } else {
                Err(format!("{name} {value} is outside {least} ..= {most}"))
            }
        };
        let (radius, strength) = (number("radius", 1e-4, 0.5)?, number("strength", 0.0, 1.0)?);
        let (softness, amount) = (number("softness", 0.0, 1.0)?, number("amount", 0.0, 1.0)?);
        if words.next() != Some("at") {
            return Err("its places are missing, after the word at".to_owned());
        }
        let place = |word: &str| {
            let (east, south) = word.split_once(',')?;
            let place = [east.parse().ok()?, south.parse().ok()?];
            place.iter().all(|side: &f32| side.is_finite() && side.abs() <= 1e3).then_some(place)
        };
        let place =
            |word| place(word).ok_or_else(|| format!("{word} is no place; expected two numbers such as 0.25,0.5"));
        let dabs = words.map(place).collect::<Result<_, _>>()?;
        Ok(Self { brush, kind, radius, strength, softness, amount, dabs })
    }
}

fn one_of<C: Choice>(word: Option<&str>) -> Result<C, String> {
    let word = word.unwrap_or_default();
    let names = || C::ALL.iter().map(|option| option.name()).collect::<Vec<_>>().join(", ");
    let found = C::ALL.iter().copied().find(|option| option.name() == word);
    found.ok_or_else(|| format!("\"{word}\" is none of {}", names()))
}

impl Serialize for Strokes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(ToString::to_string))
    }
}

impl<'de> Deserialize<'de> for Strokes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let texts = Vec::<String>::deserialize(deserializer)?;
        let mut strokes = Self::default();
        for (index, text) in texts.iter().enumerate() {
            let stroke = text.parse().map_err(|error| serde::de::Error::custom(format!("stroke {index}: {error}")))?;
            strokes.0.push(Arc::new(stroke));
        }
        if strokes.dabs() > MAX_DABS {
            return Err(serde::de::Error::custom(format!(
                "{} dabs, but at most {MAX_DABS} can be drawn",
                strokes.dabs()
            )));
        }
        Ok(strokes)
    }
}

impl Value for Strokes {
    fn accept(info: &Info<Self>, value: &mut Self, visitor: &mut dyn Visitor) {
        visitor.strokes(info, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_come_back_from_their_text_bit_for_bit() {
        let stroke = Stroke {
            brush: Brush::Raise,
            kind: CloudKind::Stratocumulus,
            radius: 0.1 + 0.2,
            strength: 1.0 / 3.0,
            softness: 0.7,
            amount: 1.0,
            dabs: vec![[0.123_456_79, -1e-7], [1.0 / 7.0, 0.5]],
        };
        assert_eq!(stroke.to_string().parse(), Ok(stroke));
    }

    #[test]
    fn nonsense_is_told_in_words() {
        let errors = [
            ("", "\"\" is none of Add, Erase, Raise, Lower, Move, Grow, Shrink, Smooth, Restore"),
            ("Add Cirrus", "\"Cirrus\" is none of Cumulus, Stratus, Stratocumulus"),
            ("Add Cumulus radius 0", "radius 0 is outside 0.0001 ..= 0.5"),
            ("Add Cumulus radius x", "radius x is no number"),
            ("Add Cumulus radius 0.1 strength NaN", "strength NaN is outside 0 ..= 1"),
            ("Add Cumulus radius 0.1 strength 1 softness 1 amount 1", "its places are missing, after the word at"),
            (
                "Add Cumulus radius 0.1 strength 1 softness 1 amount 1 at 1",
                "1 is no place; expected two numbers such as 0.25,0.5",
            ),
            (
                "Add Cumulus radius 0.1 strength 1 softness 1 amount 1 at inf,0",
                "inf,0 is no place; expected two numbers such as 0.25,0.5",
            ),
        ];
        for (text, error) in errors {
            assert_eq!(text.parse::<Stroke>(), Err(error.to_owned()), "{text}");
        }
    }
}
