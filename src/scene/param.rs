//! Declares parameters once: type, default, range, unit and documentation.
//!
//! [`params!`](crate::params) writes the struct, its `Default`, its serde impls and one method, [`Params::visit`],
//! through which everything else (panel, `--set`, range check, reference docs) reaches the fields.

use std::ops::RangeInclusive;

use super::paint::Strokes;

/// What a number means, so that every display of it agrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A plain number.
    None,
    /// m.
    Metres,
    /// 1/m.
    PerMetre,
    /// Degrees of angle.
    Degrees,
    /// m/s.
    MetresPerSecond,
    /// s.
    Seconds,
    /// Hours of the day.
    Hours,
    /// Photographic stops.
    Stops,
    /// Kilolux.
    Kilolux,
    /// Candela per square metre.
    Nits,
    /// Image elements.
    Pixels,
    /// Colour temperature.
    Kelvin,
}

impl Unit {
    /// What stands behind the number.
    pub const fn suffix(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Metres => " m",
            Self::PerMetre => " 1/m",
            Self::Degrees => "°",
            Self::MetresPerSecond => " m/s",
            Self::Seconds => " s",
            Self::Hours => " h",
            Self::Stops => " EV",
            Self::Kilolux => " klx",
            Self::Nits => " cd/m²",
            Self::Pixels => " px",
            Self::Kelvin => " K",
        }
    }
}

/// Everything known about one parameter apart from its value.
#[derive(Clone, Debug)]
pub struct Info<T> {
    /// Field name: the last part of the parameter's key.
    pub name: &'static str,
    /// The doc comment.
    pub doc: &'static str,
    /// Unit of the number.
    pub unit: Unit,
    /// The values allowed; everything where there is no order.
    pub range: Option<RangeInclusive<T>>,
    /// The value of a new scene.
    pub default: T,
    /// Whether equal ratios should take equal distances on a slider.
    pub logarithmic: bool,
}

impl<T> Info<T> {
    /// The name as people read it.
    pub fn label(&self) -> String {
        label(self.name)
    }
}

/// A field name as people read it: `base_m` becomes `Base`.
pub fn label(name: &str) -> String {
    const UNITS: [&str; 10] = ["_m", "_per_m", "_deg", "_mps", "_secs", "_h", "_ev", "_klx", "_px", "_kelvin"];
    let mut words = name;
    for unit in UNITS {
        words = words.strip_suffix(unit).unwrap_or(words);
    }
    let words = words.strip_suffix("_per").unwrap_or(words).replace('_', " ");
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// A closed set of named values.
pub trait Choice: Copy + PartialEq + 'static {
    /// All values in order.
    const ALL: &'static [Self];
    /// The name of the value in files.
    fn name(self) -> &'static str;
    /// The name of the value for people.
    fn title(self) -> &'static str;
    /// What it means.
    fn doc(self) -> &'static str;
}

/// The options of a [`Choice`] with its type taken away.
#[derive(Clone, Debug)]
pub struct ChoiceInfo {
    /// Field name.
    pub name: &'static str,
    /// The doc comment of the field.
    pub doc: &'static str,
    /// Name in files, title and doc of each option.
    pub options: Vec<[&'static str; 3]>,
    /// Index of the default.
    pub default: usize,
}

/// Linear Rec.709 colour.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Colour(pub f32, pub f32, pub f32);

impl Colour {
    /// White.
    pub const WHITE: Self = Self(1.0, 1.0, 1.0);

    /// As a vector.
    pub fn vec(self) -> glam::Vec3 {
        glam::Vec3::new(self.0, self.1, self.2)
    }
}

/// The name of a file, empty for none.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct FileName(pub String);

/// A group's name and documentation.
#[derive(Clone, Copy, Debug)]
pub struct GroupInfo {
    /// Field name of the group.
    pub name: &'static str,
    /// Heading for people.
    pub title: &'static str,
    /// What the group is about.
    pub doc: &'static str,
}

/// A list of groups, such as the cloud layers, with its element type taken away.
pub trait List {
    /// How many there are.
    fn count(&self) -> usize;
    /// Visits the parameters of one.
    fn visit_item(&mut self, index: usize, visitor: &mut dyn Visitor);
    /// Adds a copy of the last, or a default one.
    fn append(&mut self);
    /// Takes one out.
    fn remove(&mut self, index: usize);
}

impl<P: Params + Clone + Default> List for Vec<P> {
    fn count(&self) -> usize {
        self.len()
    }

    fn visit_item(&mut self, index: usize, visitor: &mut dyn Visitor) {
        if let Some(item) = self.get_mut(index) {
            item.visit(visitor);
        }
    }

    fn append(&mut self) {
        let item = self.last().cloned().unwrap_or_default();
        self.push(item);
    }

    fn remove(&mut self, index: usize) {
        if index < self.len() {
            Self::remove(self, index);
        }
    }
}

/// Receives each parameter in declaration order.
pub trait Visitor {
    /// A number.
    fn float(&mut self, info: &Info<f32>, value: &mut f32);
    /// A whole number.
    fn count(&mut self, info: &Info<u32>, value: &mut u32);
    /// On or off.
    fn switch(&mut self, info: &Info<bool>, value: &mut bool);
    /// One of a closed set, by index.
    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize);
    /// A colour.
    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour);
    /// A file.
    fn file(&mut self, info: &Info<FileName>, value: &mut FileName);
    /// What was painted. Only what reads or writes it has to look at it.
    fn strokes(&mut self, _: &Info<Strokes>, _: &mut Strokes) {}
    /// A group of parameters.
    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor));
    /// A list of groups.
    fn list(&mut self, info: &GroupInfo, list: &mut dyn List);
}

/// A type that can be the value of a field.
pub trait Value: Sized {
    /// Shows the field to a visitor.
    fn accept(info: &Info<Self>, value: &mut Self, visitor: &mut dyn Visitor);
}

macro_rules! plain_values {
    ($($T:ty => $method:ident;)*) => { $(
        impl Value for $T {
            fn accept(info: &Info<Self>, value: &mut Self, visitor: &mut dyn Visitor) {
                visitor.$method(info, value);
            }
        }
    )* };
}
plain_values! {
    f32 => float;
    u32 => count;
    bool => switch;
    Colour => colour;
    FileName => file;
}

/// Shows a choice to a visitor as an index into its options.
pub fn accept_choice<C: Choice>(info: &Info<C>, value: &mut C, visitor: &mut dyn Visitor) {
    let position = |wanted: C| C::ALL.iter().position(|option| *option == wanted).unwrap_or(0);
    let options = C::ALL.iter().map(|option| [option.name(), option.title(), option.doc()]).collect();
    let choice = ChoiceInfo { name: info.name, doc: info.doc, options, default: position(info.default) };
    let mut index = position(*value);
    visitor.choice(&choice, &mut index);
    if let Some(option) = C::ALL.get(index) {
        *value = *option;
    }
}

impl<P: Params + Clone + Default> Value for Vec<P> {
    fn accept(info: &Info<Self>, value: &mut Self, visitor: &mut dyn Visitor) {
        visitor.list(&GroupInfo { name: info.name, title: P::TITLE, doc: info.doc }, value);
    }
}

/// A group of parameters written with [`params!`](crate::params).
pub trait Params {
    /// Heading.
    const TITLE: &'static str;
    /// What the group is about.
    const DOC: &'static str;
    /// Shows every field to the visitor in order.
    fn visit(&mut self, visitor: &mut dyn Visitor);
}

/// Declares a group: `name: type = default, range, unit, logarithmic;` with the last three optional.
#[macro_export]
macro_rules! params {
    (
        $(#[doc = $group_doc:literal])*
        pub struct $Name:ident ($title:literal) {
            $(
                $(#[doc = $doc:literal])*
                $field:ident : $T:ty = $default:expr $(, $range:expr, $unit:ident $(, $scale:ident)?)?;
            )*
        }
    ) => {
        $(#[doc = $group_doc])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $Name {
            $( $(#[doc = $doc])* pub $field: $T, )*
        }

        impl Default for $Name {
            fn default() -> Self {
                Self { $( $field: $default, )* }
            }
        }

        impl $crate::scene::param::Params for $Name {
            const TITLE: &'static str = $title;
            const DOC: &'static str = concat!($($group_doc),*);

            fn visit(&mut self, visitor: &mut dyn $crate::scene::param::Visitor) {
                $(
                    <$T as $crate::scene::param::Value>::accept(
                        &$crate::scene::param::Info {
                            name: stringify!($field),
                            doc: concat!($($doc),*),
                            unit: $crate::params!(@unit $($unit)?),
                            range: $crate::params!(@range $($range)?),
                            default: $default,
                            logarithmic: $crate::params!(@logarithmic $($($scale)?)?),
                        },
                        &mut self.$field,
                        visitor,
                    );
                )*
            }
        }

        impl $crate::scene::param::Value for $Name {
            fn accept(
                info: &$crate::scene::param::Info<Self>,
                value: &mut Self,
                visitor: &mut dyn $crate::scene::param::Visitor,
            ) {
                use $crate::scene::param::Params;
                let group = $crate::scene::param::GroupInfo { name: info.name, title: Self::TITLE, doc: Self::DOC };
                visitor.group(&group, &mut |visitor| value.visit(visitor));
            }
        }
    };
    (@unit) => { $crate::scene::param::Unit::None };
    (@unit $unit:ident) => { $crate::scene::param::Unit::$unit };
    (@range) => { None };
    (@range $range:expr) => { Some($range) };
    (@logarithmic) => { false };
    (@logarithmic logarithmic) => { true };
}

/// Declares a closed set of named values that can be a parameter.
#[macro_export]
macro_rules! choices {
    (
        $(#[doc = $doc:literal])*
        pub enum $Name:ident { $( $(#[doc = $option_doc:literal])* $Option:ident ($title:literal), )* }
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        pub enum $Name { $( $(#[doc = $option_doc])* $Option, )* }

        impl $crate::scene::param::Choice for $Name {
            const ALL: &'static [Self] = &[$( Self::$Option, )*];
            fn name(self) -> &'static str {
                match self { $( Self::$Option => stringify!($Option), )* }
            }
            fn title(self) -> &'static str {
                match self { $( Self::$Option => $title, )* }
            }
            fn doc(self) -> &'static str {
                match self { $( Self::$Option => concat!($($option_doc),*), )* }
            }
        }

        impl $crate::scene::param::Value for $Name {
            fn accept(
                info: &$crate::scene::param::Info<Self>,
                value: &mut Self,
                visitor: &mut dyn $crate::scene::param::Visitor,
            ) {
                $crate::scene::param::accept_choice(info, value, visitor);
            }
        }
    };
}
