//! Sun, moon, air and the light that clouds keep among themselves.

use super::param::Colour;
use crate::{choices, params};

choices! {
    /// How the sun's place is given.
    pub enum SunPlacement {
        /// By elevation and azimuth.
        Direction ("Direction"),
        /// By place, date and hour of day.
        Hour ("Hour of day"),
    }
}

params! {
    /// The sun.
    pub struct Sun ("Sun") {
        /// How the sun's place is given.
        placement: SunPlacement = SunPlacement::Direction;
        /// Height of the sun above the horizon.
        elevation_deg: f32 = 42.0, -90.0..=90.0, Degrees;
        /// Direction of the sun, clockwise from north.
        azimuth_deg: f32 = 235.0, 0.0..=360.0, Degrees;
        /// Local hour of the day.
        hour_h: f32 = 14.0, 0.0..=24.0, Hours;
        /// Day of the year.
        day: u32 = 172, 1..=366, None;
        /// Latitude of the place; north is positive.
        latitude_deg: f32 = 50.0, -90.0..=90.0, Degrees;
        /// Longitude of the place; east is positive.
        longitude_deg: f32 = 14.4, -180.0..=180.0, Degrees;
        /// Local time minus universal time, without daylight saving.
        utc_offset_h: f32 = 1.0, -12.0..=14.0, Hours;
        /// Whether clocks are an hour ahead of that for the summer.
        daylight_saving: bool = false;
        /// Illuminance of the sun above the air.
        illuminance_klx: f32 = 128.0, 0.0..=1000.0, Kilolux;
        /// Colour of the sunlight above the air.
        colour: Colour = Colour(1.05, 0.99, 0.93);
        /// Angular radius of the disc.
        radius_deg: f32 = 0.2667, 0.05..=5.0, Degrees, logarithmic;
        /// Whether the disc itself is drawn.
        disc: bool = true;
    }
}

params! {
    /// The moon and the light of the night.
    pub struct Moon ("Moon and night") {
        /// Whether there is a moon.
        enabled: bool = true;
        /// Height of the moon above the horizon.
        elevation_deg: f32 = 35.0, -90.0..=90.0, Degrees;
        /// Direction of the moon, clockwise from north.
        azimuth_deg: f32 = 20.0, 0.0..=360.0, Degrees;
        /// Illuminance of the moon above the air; a full moon gives 0.00032 klx.
        illuminance_klx: f32 = 0.000_32, 0.0..=1.0, Kilolux, logarithmic;
        /// Colour of the moonlight.
        colour: Colour = Colour(0.85, 0.97, 1.2);
        /// Angular radius of the disc.
        radius_deg: f32 = 0.26, 0.05..=5.0, Degrees, logarithmic;
        /// Radiance of airglow and starlight, in cd/m².
        night_glow: f32 = 0.0004, 0.0..=0.1, Nits, logarithmic;
    }
}

params! {
    /// Light that has bounced among droplets more than once, and light from all around.
    pub struct Scattering ("Scattered light") {
        /// Extinction of each octave of scattering relative to the one before (Wrenninge 2013).
        octave_extinction: f32 = 0.35, 0.0..=1.0, None;
        /// Energy of each octave relative to the one before.
        octave_energy: f32 = 0.64, 0.0..=1.0, None;
        /// Anisotropy of each octave relative to the one before.
        octave_anisotropy: f32 = 0.55, 0.0..=1.0, None;
        /// Strength of the light from the whole sky.
        ambient: f32 = 1.0, 0.0..=4.0, None;
        /// Tint of the light from above.
        ambient_top: Colour = Colour::WHITE;
        /// Tint of the light from below.
        ambient_bottom: Colour = Colour::WHITE;
        /// How much of the light from above reaches the cloud base.
        ambient_base_share: f32 = 0.3, 0.0..=1.0, None;
        /// How dense cloud keeps ambient light out of its middle.
        ambient_occlusion: f32 = 0.6, 0.0..=4.0, None;
        /// Artists' glow of thin cloud about the sun or moon, added to the picture (Thomann 2020, listing 16). 0 leaves it out.
        glow: f32 = 0.0, 0.0..=4.0, None;
        /// Angle from the light at which the glow ends.
        glow_deg: f32 = 25.0, 1.0..=90.0, Degrees;
        /// How the glow falls off: above 1 it stays wide, below it is narrow.
        glow_width: f32 = 1.0, 0.1..=8.0, None, logarithmic;
    }
}

params! {
    /// The clear air.
    pub struct Air ("Air") {
        /// Amount of haze (Mie scatterers) relative to clear air.
        haze: f32 = 4.0, 0.0..=20.0, None;
        /// Amount of air molecules (Rayleigh scatterers) relative to the Earth's.
        molecules: f32 = 1.0, 0.0..=10.0, None;
        /// Amount of ozone relative to the Earth's.
        ozone: f32 = 1.0, 0.0..=10.0, None;
        /// Whether the air in front of clouds is drawn.
        aerial_perspective: bool = true;
    }
}

params! {
    /// The light that other renderers have: a sun and a constant sky, and no air, no ground, no moon. Clouds can be compared
    /// under it.
    pub struct PlainLight ("Plain light") {
        /// Whether it replaces the light of sun, moon and air. The sun's place stays.
        enabled: bool = false;
        /// Irradiance of the sun on a surface that faces it, in any unit; radiances of a picture are in the same.
        sun_irradiance: f32 = 3.0, 0.0..=1_000_000.0, None, logarithmic;
        /// Factor of the sun's irradiance by colour.
        sun_colour: Colour = Colour::WHITE;
        /// Radiance of the sky, the same from all directions.
        sky_radiance: f32 = 0.3, 0.0..=1_000_000.0, None, logarithmic;
        /// Factor of the sky's radiance by colour.
        sky_colour: Colour = Colour(0.55, 0.75, 1.0);
    }
}

params! {
    /// Streaks of light in the haze, added after the picture is drawn.
    pub struct Sunshafts ("Sunshafts") {
        /// Strength of the streaks. 0 removes the pass.
        strength: f32 = 0.0, 0.0..=4.0, None;
        /// Length of the streaks, as an angle.
        length_deg: f32 = 25.0, 1.0..=90.0, Degrees;
        /// Tint of the streaks.
        tint: Colour = Colour::WHITE;
    }
}
