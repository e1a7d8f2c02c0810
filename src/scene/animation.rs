//! Keyframes: parameters that change with the scene's time.
//!
//! A track holds the values of one parameter at some times, written as `--set` takes them. Between two keys numbers go
//! evenly over their sliders or smoothly through all keys; directions take the shorter way round; what has nothing in
//! between holds until the next key. Any time is reached directly: nothing depends on the frames before.

use std::fmt::Write as _;
use std::ops::RangeInclusive;
use std::str::FromStr;

use serde::Deserialize;

use super::edit::{self, EditError};
use super::morph::between;
use super::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Unit, Visitor};
use super::{Scene, Sun};
use crate::choices;

/// Shortest and longest film, in seconds of the scene.
pub const DURATION_RANGE_SECS: RangeInclusive<f64> = 0.1..=10_000_000.0;
/// Slowest and fastest that time may run, in seconds of the scene per second of the clock.
pub const SPEED_RANGE: RangeInclusive<f64> = 0.0..=10_000.0;
/// Most keys of one parameter.
const MAX_KEYS: usize = 10_000;
/// While a parameter is moved as time plays, keys are no nearer than this, in seconds of the clock.
const RECORDED_SECS: f64 = 0.05;
/// Keys nearer than this are one, in seconds.
const SAME_TIME_SECS: f64 = 1e-3;

choices! {
    /// How a parameter goes from one key to the next.
    pub enum Ease {
        /// Through all keys without a kink, never beyond them; at rest at the first and the last.
        Smooth ("Smooth"),
        /// Evenly.
        Linear ("Linear"),
        /// Not at all: it jumps at the next key.
        Hold ("Hold"),
    }
}

/// A value at a time.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Keyframe {
    /// Seconds since the scene began.
    pub time_secs: f64,
    /// The value as `--set` takes it.
    pub value: String,
    /// The way to the next key.
    #[serde(default = "smooth")]
    pub ease: Ease,
}

fn smooth() -> Ease {
    Ease::Smooth
}

/// One parameter's keys in the order of time.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Track {
    /// The parameter's key, such as `sun.hour_h`.
    pub key: String,
    /// At least one.
    pub keys: Vec<Keyframe>,
}

/// What changes with time, and for how long.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Animation {
    /// Length in seconds of the scene.
    pub duration_secs: f64,
    /// Seconds of the scene per second of the clock.
    pub speed: f64,
    /// Whether time begins anew at the end, rather than stopping.
    pub repeats: bool,
    /// The parameters that change, each at most once.
    pub tracks: Vec<Track>,
}

impl Default for Animation {
    fn default() -> Self {
        Self { duration_secs: 30.0, speed: 1.0, repeats: true, tracks: Vec::new() }
    }
}

/// Whether a parameter can have keys: files, strokes and what other parameters depend on cannot.
pub fn can_move(entry: &edit::Entry) -> bool {
    let is_model = entry.key.starts_with("layers.") && entry.key.ends_with(".model");
    let is_fixed = entry.is_file() || entry.key.ends_with(".strokes") || entry.key == "domain.kind" || is_model;
    !is_fixed
}

impl Track {
    /// The last key that is not after `time_secs`; `None` before the first.
    fn index_at(&self, time_secs: f64) -> Option<usize> {
        self.keys.partition_point(|key| key.time_secs <= time_secs).checked_sub(1)
    }

    /// The key at that time, if there is one.
    pub fn key_at(&self, time_secs: f64) -> Option<usize> {
        self.keys.iter().position(|key| (key.time_secs - time_secs).abs() < SAME_TIME_SECS)
    }

    /// Puts a value there, in place of one that is there already or no farther than `near_secs`; its ease is that of the key
    /// before. A track that is full stays as it is.
    fn set(&mut self, time_secs: f64, value: String, near_secs: f64) {
        let near = |key: &Keyframe| (key.time_secs - time_secs).abs() < near_secs.max(SAME_TIME_SECS);
        if let Some(index) = self.key_at(time_secs).or_else(|| self.keys.iter().position(near)) {
            self.keys[index].value = value;
            return;
        }
        if self.keys.len() >= MAX_KEYS {
            return;
        }
        let before = self.index_at(time_secs);
        let ease = before.map_or(Ease::Smooth, |index| self.keys[index].ease);
        let at = before.map_or(0, |index| index + 1);
        self.keys.insert(at, Keyframe { time_secs, value, ease });
    }
}

impl Animation {
    /// Whether any parameter changes.
    pub fn is_moving(&self) -> bool {
        !self.tracks.is_empty()
    }

    /// The track of a parameter.
    pub fn track(&self, key: &str) -> Option<&Track> {
        self.tracks.iter().find(|track| track.key == key)
    }

    /// The time that is shown `seconds` of the clock after `time_secs`, and whether the end was reached and stops it. Without
    /// tracks time has no end.
    pub fn after(&self, time_secs: f64, seconds: f64) -> (f64, bool) {
        let time = time_secs + seconds * self.speed;
        if !self.is_moving() || time < self.duration_secs {
            (time, false)
        } else if self.repeats {
            (time.rem_euclid(self.duration_secs), false)
        } else {
            (self.duration_secs, true)
        }
    }

    /// The last frame of the film that begins at a time; `None` if time stands still or the film is over then.
    pub fn last_frame(&self, begin_secs: f64, fps: f64) -> Option<u32> {
        let frames = ((self.duration_secs - begin_secs) / self.speed * fps).round();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked")]
        (1.0..=1e6).contains(&frames).then(|| frames as u32 - 1)
    }

    /// Gives every parameter that has keys its value at that time.
    pub fn play(&self, scene: &mut Scene, time_secs: f64) {
        if self.is_moving() {
            scene.visit(&mut Play { tracks: &self.tracks, time_secs, prefix: String::new() });
            self.keep_layers_upright(scene);
        }
    }

    /// Keeps tops above bases by what has keys alone: what has none must not depend on the times that were shown.
    fn keep_layers_upright(&self, scene: &mut Scene) {
        for (index, layer) in scene.layers.iter_mut().enumerate().filter(|(_, layer)| layer.top_m < layer.base_m) {
            if self.track(&format!("layers.{index}.top_m")).is_some() {
                layer.top_m = layer.base_m;
            } else {
                layer.base_m = layer.top_m;
            }
        }
    }

    /// Puts a key where a parameter that has keys differs from what they say: this is how edits become keys.
    pub fn absorb(&mut self, scene: &Scene, time_secs: f64) {
        if !self.is_moving() {
            return;
        }
        let mut played = scene.clone();
        self.play(&mut played, time_secs);
        if played == *scene {
            return;
        }
        let before = edit::keys(&played);
        let wanted = edit::keys(scene).into_iter().zip(before).filter(|(now, before)| now.value != before.value);
        let near_secs = RECORDED_SECS * self.speed;
        let mut is_late = false;
        for (now, _) in wanted {
            if let Some(track) = self.tracks.iter_mut().find(|track| track.key == now.key) {
                track.set(time_secs, now.value, near_secs);
                is_late = true;
            }
        }
        if is_late {
            self.hold(time_secs);
        }
    }

    /// Lets the film be long enough for a key.
    fn hold(&mut self, time_secs: f64) {
        self.duration_secs = self.duration_secs.max(time_secs).min(*DURATION_RANGE_SECS.end());
    }

    /// Lets go of tracks whose parameter the sky has no longer.
    pub fn keep_only_what_is_in(&mut self, scene: &Scene) {
        if self.is_moving() {
            let known = edit::keys(scene);
            self.tracks.retain(|track| known.iter().any(|entry| entry.key == track.key));
        }
    }

    /// Lets go of what says otherwise than values that were given for all times: the tracks of these keys, or of what lies in
    /// these groups.
    pub fn override_by<'k>(&mut self, keys: impl IntoIterator<Item = &'k str>) {
        for key in keys {
            let is_below = |track: &Track| track.key.strip_prefix(key).is_some_and(|rest| rest.starts_with('.'));
            self.tracks.retain(|track| track.key != key && !is_below(track));
        }
    }

    /// Puts a key at that time for what a parameter is now; nothing if there is no such
    /// parameter, or it cannot change.
    pub fn set_key(&mut self, scene: &Scene, key: &str, time_secs: f64) {
        let found = edit::keys(scene).into_iter().find(|entry| entry.key == key && can_move(entry));
        let Some(entry) = found else { return };
        match self.tracks.iter_mut().find(|track| track.key == key) {
            Some(track) => track.set(time_secs, entry.value, 0.0),
            None => {
                let first = Keyframe { time_secs, value: entry.value, ease: Ease::Smooth };
                self.tracks.push(Track { key: key.to_owned(), keys: vec![first] });
            }
        }
        self.hold(time_secs);
    }

    /// Takes a key away, and the track with its last one.
    pub fn remove_key(&mut self, key: &str, index: usize) {
        if let Some(track) = self.tracks.iter_mut().find(|track| track.key == key)
            && index < track.keys.len()
        {
            track.keys.remove(index);
        }
        self.tracks.retain(|track| !track.keys.is_empty());
    }

    /// Moves a key in time, but not past its neighbours or the ends.
    pub fn move_key(&mut self, key: &str, index: usize, time_secs: f64) {
        let end = self.duration_secs;
        let Some(track) = self.tracks.iter_mut().find(|track| track.key == key) else { return };
        let low = index.checked_sub(1).and_then(|before| track.keys.get(before));
        let low = low.map_or(0.0, |key| key.time_secs + 2.0 * SAME_TIME_SECS);
        let high = track.keys.get(index + 1).map_or(end, |key| key.time_secs - 2.0 * SAME_TIME_SECS);
        if let Some(key) = track.keys.get_mut(index) {
            key.time_secs = time_secs.min(high.max(low)).max(low);
        }
    }

    /// Follows a list of layers from which one was taken, or into which one was put, so that the tracks stay with theirs.
    /// `edited` is the key of the edit: that of a layer that was taken ends in its index, which twins do not tell.
    pub fn follow<T: PartialEq>(&mut self, edited: &str, list: &str, before: &[T], after: &[T]) {
        let named = edited.strip_prefix(list).and_then(|rest| rest.strip_prefix('.')?.parse::<usize>().ok());
        let differs = before.iter().zip(after).take_while(|(old, new)| old == new).count();
        let place = named.filter(|_| after.len() < before.len()).unwrap_or(differs);
        let shift = match after.len().checked_signed_diff(before.len()) {
            Some(shift @ (-1 | 1)) => shift,
            _ => return,
        };
        self.tracks.retain_mut(|track| {
            let Some((index, rest)) =
                track.key.strip_prefix(list).and_then(|key| key.strip_prefix('.')?.split_once('.'))
            else {
                return true;
            };
            let Ok(index) = index.parse::<usize>() else { return true };
            if shift < 0 && index == place {
                return false;
            }
            if index >= place {
                track.key = format!("{list}.{}.{rest}", index.saturating_add_signed(shift));
            }
            true
        });
    }

    /// The sun's way over the sky on its day at its place: from dawn to dusk in `film_secs` seconds of film at this speed of
    /// time. `None` where it does not come up.
    #[must_use = "where there is no day, nothing was done"]
    pub fn day(&self, sun: &Sun, film_secs: f64, speed: f64) -> Option<Self> {
        let [dawn, dusk] = sun.daylight()?;
        let duration_secs = (film_secs * speed).clamp(*DURATION_RANGE_SECS.start(), *DURATION_RANGE_SECS.end());
        let key = |time_secs, hour: f32| Keyframe { time_secs, value: hour.to_string(), ease: Ease::Linear };
        let hours = Track { key: "sun.hour_h".to_owned(), keys: vec![key(0.0, dawn), key(duration_secs, dusk)] };
        let mut tracks = self.tracks.clone();
        tracks.retain(|track| track.key != hours.key && track.key != "sun.placement");
        tracks.insert(0, hours);
        Some(Self { duration_secs, speed, tracks, ..self.clone() })
    }

    /// The first thing that is wrong with it, given the scene that it is of: the index of the track, and why.
    pub fn fault(&self, scene: &Scene) -> Option<(Option<usize>, String)> {
        let outside = |name: &str, value: f64, range: &RangeInclusive<f64>| {
            let reason = format!("animation.{name} = {value} must be {} to {}", range.start(), range.end());
            (!range.contains(&value)).then_some((None, reason))
        };
        let whole = outside("duration_secs", self.duration_secs, &DURATION_RANGE_SECS)
            .or_else(|| outside("speed", self.speed, &SPEED_RANGE));
        if whole.is_some() {
            return whole;
        }
        for (index, track) in self.tracks.iter().enumerate() {
            if let Err(reason) = track.check(scene) {
                return Some((Some(index), reason));
            }
            if self.tracks[..index].iter().any(|other| other.key == track.key) {
                return Some((Some(index), format!("{} has two tracks; put their keys into one", track.key)));
            }
        }
        None
    }

    /// As RON, `depth` levels in; empty if it is the default.
    pub(super) fn to_ron(&self, depth: usize) -> String {
        let default = Self::default();
        let indent = |levels| "    ".repeat(depth + levels);
        let mut text = String::new();
        let mut line = |levels: usize, words: &str| {
            let _ = writeln!(text, "{}{words}", indent(levels));
        };
        if self.duration_secs.to_bits() != default.duration_secs.to_bits() {
            line(0, &format!("duration_secs: {:?},", self.duration_secs));
        }
        if self.speed.to_bits() != default.speed.to_bits() {
            line(0, &format!("speed: {:?},", self.speed));
        }
        if self.repeats != default.repeats {
            line(0, &format!("repeats: {},", self.repeats));
        }
        if self.is_moving() {
            line(0, "tracks: [");
            for track in &self.tracks {
                line(1, &format!("(key: {}, keys: [", super::preset::quoted(&track.key)));
                for Keyframe { time_secs, value, ease } in &track.keys {
                    let value = super::preset::quoted(value);
                    line(2, &format!("(time_secs: {time_secs:?}, value: {value}, ease: {ease:?}),"));
                }
                line(1, "]),");
            }
            line(0, "],");
        }
        text
    }
}

impl Track {
    /// Whether the parameter is there, and all values suit it.
    fn check(&self, scene: &Scene) -> Result<(), String> {
        let name = &self.key;
        if self.keys.is_empty() || self.keys.len() > MAX_KEYS {
            return Err(format!("{name} has {} keys, but must have 1 to {MAX_KEYS}", self.keys.len()));
        }
        match edit::keys(scene).iter().find(|entry| entry.key == *name) {
            Some(entry) if entry.is_file() => return Err(format!("{name} is a file, which cannot have keys")),
            Some(entry) if !can_move(entry) => {
                return Err(format!("{name} decides what else there is, and cannot have keys"));
            }
            Some(_) => {}
            None => {
                // Says what is near, or that it is a group.
                let error = edit::set(&mut scene.clone(), name, "").err();
                let error = error.filter(|error| !matches!(error, EditError::WrongType { .. }));
                return Err(error.map_or_else(|| format!("the sky has no {name}"), |error| error.to_string()));
            }
        }
        let mut scratch = scene.clone();
        for key in &self.keys {
            if !key.time_secs.is_finite() || key.time_secs < 0.0 {
                return Err(format!("{name}: a key lies at {} s; times are 0 or later", key.time_secs));
            }
            edit::set(&mut scratch, name, &key.value).map_err(|error| error.to_string())?;
        }
        let late = self.keys.windows(2).find(|pair| pair[1].time_secs <= pair[0].time_secs);
        late.map_or(Ok(()), |pair| {
            Err(format!(
                "{name}: the key at {} s comes after that at {} s; order them by time, one for each",
                pair[1].time_secs, pair[0].time_secs
            ))
        })
    }

    /// Values before and after a time, and the share of the way; with what lies beyond them on either side.
    fn around(&self, time_secs: f64) -> Around<'_> {
        let value = |index: usize| self.keys.get(index).map(|key| (key.time_secs, key.value.as_str()));
        let Some(at) = self.index_at(time_secs) else {
            return Around { from: &self.keys[0].value, way: None };
        };
        let key = &self.keys[at];
        let way = value(at + 1).filter(|_| key.ease != Ease::Hold).map(|to| {
            let share = (time_secs - key.time_secs) / (to.0 - key.time_secs);
            let before = at.checked_sub(1).and_then(value);
            Way {
                to: to.1,
                share,
                is_smooth: key.ease == Ease::Smooth,
                times: [key.time_secs, to.0],
                before,
                after: value(at + 2),
            }
        });
        Around { from: &key.value, way }
    }
}

/// Where a time lies among keys.
struct Around<'t> {
    from: &'t str,
    way: Option<Way<'t>>,
}

/// The way to the next key.
struct Way<'t> {
    to: &'t str,
    share: f64,
    is_smooth: bool,
    times: [f64; 2],
    before: Option<(f64, &'t str)>,
    after: Option<(f64, &'t str)>,
}

impl Way<'_> {
    /// A number on the way, where `step` is the difference of two values as the parameter counts it.
    ///
    /// Smooth ways are cubic, with the slopes of Fritsch and Butland (A method for constructing local monotone piecewise cubic
    /// interpolants, 1984): they never leave the interval of their two keys.
    fn along(&self, from: f64, to: f64, step: impl Fn(f64, f64) -> f64, parse: impl Fn(&str) -> Option<f64>) -> f64 {
        let whole = step(from, to);
        if !self.is_smooth {
            return from + self.share * whole;
        }
        let [begin, end] = self.times;
        let length = end - begin;
        let slope = whole / length;
        let tangent = |other: Option<f64>, theirs: f64| match other {
            Some(other) if other * slope > 0.0 => {
                let weight = (1.0 + length / (length + theirs)) / 3.0;
                other * slope / (weight * slope + (1.0 - weight) * other)
            }
            _ => 0.0,
        };
        let before = self.before.and_then(|(time, text)| Some((begin - time, parse(text)?)));
        let after = self.after.and_then(|(time, text)| Some((time - end, parse(text)?)));
        let first = before.map_or(0.0, |(gap, value)| tangent(Some(step(value, from) / gap), gap));
        let last = after.map_or(0.0, |(gap, value)| tangent(Some(step(to, value) / gap), gap));
        let t = self.share;
        let (t2, t3) = (t * t, t * t * t);
        from + (3.0 * t2 - 2.0 * t3) * whole + length * ((t3 - 2.0 * t2 + t) * first + (t3 - t2) * last)
    }
}

/// Writes the values at a time.
struct Play<'a> {
    tracks: &'a [Track],
    time_secs: f64,
    /// Key of the group that is visited, with a dot at its end.
    prefix: String,
}

impl<'a> Play<'a> {
    fn around(&self, name: &str) -> Option<Around<'a>> {
        let is_here = |track: &&Track| track.key.strip_prefix(self.prefix.as_str()) == Some(name);
        Some(self.tracks.iter().find(is_here)?.around(self.time_secs))
    }

    /// The value of the key before.
    fn hold<T: FromStr>(&self, name: &str) -> Option<T> {
        self.around(name)?.from.parse().ok()
    }

    fn within(&mut self, name: &str, visit: impl FnOnce(&mut Self)) {
        let length = self.prefix.len();
        self.prefix.push_str(name);
        self.prefix.push('.');
        if self.tracks.iter().any(|track| track.key.starts_with(&self.prefix)) {
            visit(self);
        }
        self.prefix.truncate(length);
    }
}

/// The number as its slider counts it, and back.
fn on_slider(info: &Info<f32>, value: f64) -> f64 {
    if info.logarithmic && value > 0.0 { value.ln() } else { value }
}

/// Degrees that go all the way round.
fn circle(info: &Info<f32>) -> Option<f64> {
    let range = info.range.as_ref()?;
    (info.unit == Unit::Degrees && range.end() - range.start() >= 360.0).then_some(f64::from(*range.start()))
}

impl Visitor for Play<'_> {
    #[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        let Some(around) = self.around(info.name) else { return };
        let Ok(from) = around.from.parse::<f32>() else { return };
        let Some(way) = around.way else {
            *value = from;
            return;
        };
        let Ok(to) = way.to.parse::<f32>() else { return };
        if !way.is_smooth {
            *value = between(info, (from, to), way.share as f32);
            return;
        }
        let circle = circle(info);
        let step = |from: f64, to: f64| match circle {
            Some(_) => (to - from + 180.0).rem_euclid(360.0) - 180.0,
            None => to - from,
        };
        // Noughts have no logarithm: such a way goes evenly.
        let texts = [way.before.map(|before| before.1), way.after.map(|after| after.1)];
        let all = [from, to].into_iter().chain(texts.into_iter().flatten().filter_map(|text| text.parse().ok()));
        let is_logarithmic = info.logarithmic && all.into_iter().all(|value| value > 0.0);
        let scale = |value: f32| if is_logarithmic { on_slider(info, f64::from(value)) } else { f64::from(value) };
        let on_way = way.along(scale(from), scale(to), step, |text| text.parse().ok().map(scale));
        let number = if is_logarithmic { on_way.exp() } else { on_way };
        let number = circle.map_or(number, |low| low + (number - low).rem_euclid(360.0)) as f32;
        *value = info.range.as_ref().map_or(number, |range| number.clamp(*range.start(), *range.end()));
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two counts")]
    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        let Some(around) = self.around(info.name) else { return };
        let Ok(from) = around.from.parse::<u32>() else { return };
        *value = from;
        if let Some(way) = around.way.filter(|_| !info.name.ends_with("seed"))
            && let Ok(to) = way.to.parse::<u32>()
        {
            let parse = |text: &str| text.parse().ok();
            *value = way.along(f64::from(from), f64::from(to), |from, to| to - from, parse).round() as u32;
        }
    }

    fn switch(&mut self, info: &Info<bool>, value: &mut bool) {
        *value = self.hold(info.name).unwrap_or(*value);
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        let Some(around) = self.around(info.name) else { return };
        *index = info.options.iter().position(|[name, ..]| *name == around.from).unwrap_or(*index);
    }

    #[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        let parse = |text: &str| ron::from_str::<Colour>(text).ok();
        let Some(around) = self.around(info.name) else { return };
        let Some(from) = parse(around.from) else { return };
        *value = from;
        let Some((way, to)) = around.way.and_then(|way| parse(way.to).map(|to| (way, to))) else { return };
        let mix = |channel: fn(Colour) -> f32| {
            let wide = |colour: Colour| f64::from(channel(colour));
            way.along(wide(from), wide(to), |from, to| to - from, |text| parse(text).map(wide)) as f32
        };
        *value = Colour(mix(|colour| colour.0), mix(|colour| colour.1), mix(|colour| colour.2));
    }

    fn file(&mut self, _: &Info<FileName>, _: &mut FileName) {}

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        self.within(info.name, |play| children(play));
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        self.within(info.name, |play| {
            for index in 0..list.count() {
                play.within(&index.to_string(), |play| list.visit_item(index, play));
            }
        });
    }
}

#[cfg(test)]
mod tests;
