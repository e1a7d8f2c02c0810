//! Where the sun stands: as given, or computed from place, date and hour.

use solar_positioning::{Location, SolarPositions, time::JulianDate};

use super::{Sun, SunPlacement};

/// Any year will do: the difference between years is below a quarter of a degree.
const YEAR: i32 = 2026;

/// Difference of terrestrial and universal time in that decade.
const DELTA_T_SECS: f64 = 69.0;

/// Elevation above the horizon and azimuth clockwise from north, in degrees.
pub(super) fn elevation_azimuth_deg(sun: &Sun) -> (f32, f32) {
    let given = (sun.elevation_deg, sun.azimuth_deg);
    match sun.placement {
        SunPlacement::Direction => given,
        SunPlacement::Hour => computed(sun).unwrap_or(given),
    }
}

#[allow(clippy::cast_possible_truncation, reason = "angles of parameters are f32")]
fn computed(sun: &Sun) -> Option<(f32, f32)> {
    let new_year = JulianDate::from_utc_simple(YEAR, 1, 1, 0, 0, 0.0).ok()?;
    let days = f64::from(sun.day) - 1.0 + (f64::from(sun.hour_h) - sun.clock_offset_h()) / 24.0;
    let date = JulianDate::new(new_year.julian_date() + days, DELTA_T_SECS).ok()?;
    let place = Location { latitude: f64::from(sun.latitude_deg), longitude: f64::from(sun.longitude_deg) };
    let position = SolarPositions::new().at_from_julian(date, place, 0.0, None).ok()?;
    Some((position.elevation_angle() as f32, position.azimuth() as f32))
}

/// An hour of the sun's day that has a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// The sun rises through 6° below the horizon.
    MorningTwilight,
    /// Its middle rises over the horizon, bent by the air.
    Sunrise,
    /// It is as high as it gets.
    Noon,
    /// It sinks through 6° above the horizon.
    GoldenHour,
    /// Its middle sinks below the horizon.
    Sunset,
    /// It sinks through 6° below the horizon.
    EveningTwilight,
}

impl Moment {
    /// All of them in the order of the day.
    pub const ALL: [Self; 6] =
        [Self::MorningTwilight, Self::Sunrise, Self::Noon, Self::GoldenHour, Self::Sunset, Self::EveningTwilight];

    /// Its name for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::MorningTwilight => "Dawn",
            Self::Sunrise => "Sunrise",
            Self::Noon => "Noon",
            Self::GoldenHour => "Golden hour",
            Self::Sunset => "Sunset",
            Self::EveningTwilight => "Dusk",
        }
    }

    /// The sun's elevation, in degrees, and whether it climbs; `None` for noon.
    fn elevation(self) -> Option<(f32, bool)> {
        match self {
            Self::MorningTwilight => Some((-6.0, true)),
            Self::Sunrise => Some((-0.57, true)),
            Self::Noon => None,
            Self::GoldenHour => Some((6.0, false)),
            Self::Sunset => Some((-0.57, false)),
            Self::EveningTwilight => Some((-6.0, false)),
        }
    }
}

impl Sun {
    /// The clock's time minus universal time, in hours.
    fn clock_offset_h(&self) -> f64 {
        f64::from(self.utc_offset_h) + f64::from(u8::from(self.daylight_saving))
    }

    /// The local hour of a moment on the sun's day at its place, to a few seconds; `None` where there is none, as at the poles.
    pub fn hour_of(&self, moment: Moment) -> Option<f32> {
        const MINUTES: u16 = 24 * 60;
        let at = |minute: f32| {
            let sun = Self { placement: SunPlacement::Hour, hour_h: minute / 60.0, ..self.clone() };
            computed(&sun).map(|(elevation, _)| elevation)
        };
        let minutes = || (0..MINUTES).step_by(5).map(f32::from);
        let Some((wanted, climbs)) = moment.elevation() else {
            let highest = |from: f32, step: f32, count: u16| {
                let minutes = (0..count).map(|index| from + step * f32::from(index));
                let heights = minutes.filter_map(|minute| Some((at(minute)?, minute)));
                heights.max_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, minute)| minute)
            };
            // To six seconds; the sun stands still there.
            let near = highest(0.0, 5.0, MINUTES / 5)?;
            return Some(highest((near - 5.0).max(0.0), 0.1, 101)? / 60.0);
        };
        let is_past = |minute: f32| Some((at(minute)? >= wanted) == climbs);
        let begin = minutes().find(|minute| is_past(*minute) == Some(false) && is_past(*minute + 5.0) == Some(true))?;
        let (mut low, mut high) = (begin, begin + 5.0);
        for _ in 0..6 {
            let middle = 0.5 * (low + high);
            if is_past(middle)? { high = middle } else { low = middle }
        }
        Some(high.min(24.0 * 60.0) / 60.0)
    }

    /// From dawn to dusk on the sun's day at its place, in hours: by civil twilight where there is one, else from sunrise to
    /// sunset, else all day; `None` where the sun stays deeper than twilight.
    pub fn daylight(&self) -> Option<[f32; 2]> {
        let between = |begin, end| {
            let hours = [self.hour_of(begin)?, self.hour_of(end)?];
            (hours[0] < hours[1]).then_some(hours)
        };
        let noon = Self { placement: SunPlacement::Hour, hour_h: self.hour_of(Moment::Noon)?, ..self.clone() };
        let is_day = computed(&noon).is_some_and(|(elevation, _)| elevation > -6.0);
        between(Moment::MorningTwilight, Moment::EveningTwilight)
            .or_else(|| between(Moment::Sunrise, Moment::Sunset))
            .or_else(|| is_day.then_some([0.0, 24.0]))
    }

    /// Puts day and hour to those of a clock, in seconds since the beginning of 1970 (universal time).
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a calendar"
    )]
    pub fn set_clock(&mut self, unix_secs: u64) {
        let local = unix_secs as f64 / 86_400.0 + self.clock_offset_h() / 24.0;
        let days = local.floor().max(0.0);
        // Years of the Gregorian calendar since 1970, one by one: there are few.
        let (mut year, mut left) = (1970_u32, days as u32);
        let is_leap = |year: u32| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
        let length = |year| if is_leap(year) { 366 } else { 365 };
        while left >= length(year) {
            left -= length(year);
            year += 1;
        }
        self.placement = SunPlacement::Hour;
        self.day = (left + 1).clamp(1, 366);
        self.hour_h = ((local - days) * 24.0) as f32;
    }
}

/// Cities: name, latitude, longitude, and local minus universal time without daylight saving.
pub const CITIES: [(&str, f32, f32, f32); 24] = [
    ("Auckland", -36.85, 174.76, 12.0),
    ("Beijing", 39.90, 116.41, 8.0),
    ("Berlin", 52.52, 13.40, 1.0),
    ("Buenos Aires", -34.60, -58.38, -3.0),
    ("Cairo", 30.04, 31.24, 2.0),
    ("Cape Town", -33.92, 18.42, 2.0),
    ("Delhi", 28.61, 77.21, 5.5),
    ("Honolulu", 21.31, -157.86, -10.0),
    ("Istanbul", 41.01, 28.98, 3.0),
    ("Lagos", 6.45, 3.39, 1.0),
    ("London", 51.51, -0.13, 0.0),
    ("Los Angeles", 34.05, -118.24, -8.0),
    ("Mexico City", 19.43, -99.13, -6.0),
    ("Moscow", 55.76, 37.62, 3.0),
    ("Nairobi", -1.29, 36.82, 3.0),
    ("New York", 40.71, -74.01, -5.0),
    ("Paris", 48.86, 2.35, 1.0),
    ("Prague", 50.09, 14.42, 1.0),
    ("Quito", -0.18, -78.47, -5.0),
    ("Reykjavik", 64.15, -21.94, 0.0),
    ("Singapore", 1.35, 103.82, 8.0),
    ("Sydney", -33.87, 151.21, 10.0),
    ("Tokyo", 35.68, 139.69, 9.0),
    ("Tromsø", 69.65, 18.96, 1.0),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_moments_are_where_almanacs_have_them() {
        // Greenwich at the equinox of 2026, day 79: sunrise 6:05, sunset 18:13, noon 12:07 (local mean time).
        let sun = Sun { latitude_deg: 51.48, longitude_deg: 0.0, utc_offset_h: 0.0, day: 79, ..Sun::default() };
        for (moment, hour) in [(Moment::Sunrise, 6.07), (Moment::Noon, 12.13), (Moment::Sunset, 18.22)] {
            let seen = sun.hour_of(moment).expect("it has one");
            assert!((seen - hour).abs() < 0.1, "{moment:?}: {seen}, not {hour}");
        }
        let hours: Vec<f32> = Moment::ALL.iter().filter_map(|moment| sun.hour_of(*moment)).collect();
        assert!(hours.len() == 6 && hours.is_sorted(), "{hours:?}");
        let summer = Sun { daylight_saving: true, ..sun.clone() };
        let (later, seen) = (summer.hour_of(Moment::Noon).expect("a noon"), sun.hour_of(Moment::Noon).expect("a noon"));
        assert!((later - seen - 1.0).abs() < 0.01, "clocks are ahead: {later} and {seen}");
        let polar = Sun { latitude_deg: 80.0, day: 172, ..sun };
        assert_eq!(polar.hour_of(Moment::Sunset), None, "the sun does not set");
        assert!(polar.hour_of(Moment::Noon).is_some(), "but there is a noon");
    }

    #[test]
    fn a_clock_sets_day_and_hour() {
        let mut sun = Sun { utc_offset_h: 1.0, ..Sun::default() };
        for (secs, day, hour) in [(0, 1, 1.0), (951_782_400, 60, 1.0), (1_798_758_000, 1, 0.0)] {
            sun.set_clock(secs);
            assert_eq!((sun.day, sun.placement), (day, SunPlacement::Hour), "{secs}");
            assert!((sun.hour_h - hour).abs() < 1e-3, "{secs}: {}", sun.hour_h);
        }
    }

    #[test]
    fn cities_lie_within_their_ranges() {
        use super::super::edit::faults;
        for (name, latitude_deg, longitude_deg, utc_offset_h) in CITIES {
            let mut scene = super::super::Scene::default();
            scene.sun = Sun { latitude_deg, longitude_deg, utc_offset_h, ..scene.sun };
            assert!(faults(&scene).is_empty(), "{name}: {:?}", faults(&scene));
            // Solar noon is within two hours of the clock's.
            let noon = scene.sun.hour_of(Moment::Noon).expect("a noon");
            assert!((noon - 12.0).abs() < 2.0, "{name}: {noon}");
        }
    }

    #[test]
    fn midsummer_noon_in_prague() {
        let sun = Sun { placement: SunPlacement::Hour, hour_h: 12.05, ..Sun::default() };
        let (elevation, azimuth) = elevation_azimuth_deg(&sun);
        assert!((elevation - 63.4).abs() < 0.3, "90° − 50° + 23.4°, got {elevation}");
        assert!((azimuth - 180.0).abs() < 2.0, "due south, got {azimuth}");
    }
}
