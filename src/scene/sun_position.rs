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
    let days = f64::from(sun.day) - 1.0 + (f64::from(sun.hour_h) - f64::from(sun.utc_offset_h)) / 24.0;
    let date = JulianDate::new(new_year.julian_date() + days, DELTA_T_SECS).ok()?;
    let place = Location { latitude: f64::from(sun.latitude_deg), longitude: f64::from(sun.longitude_deg) };
    let position = SolarPositions::new().at_from_julian(date, place, 0.0, None).ok()?;
    Some((position.elevation_angle() as f32, position.azimuth() as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn midsummer_noon_in_prague() {
        let sun = Sun { placement: SunPlacement::Hour, hour_h: 12.05, ..Sun::default() };
        let (elevation, azimuth) = elevation_azimuth_deg(&sun);
        assert!((elevation - 63.4).abs() < 0.3, "90° − 50° + 23.4°, got {elevation}");
        assert!((azimuth - 180.0).abs() < 2.0, "due south, got {azimuth}");
    }
}
