//! Which light shines on the clouds, and the scale that numbers are kept in.

use glam::Vec3;

use crate::scene::{Scene, param::Colour};

/// Luminance weights of linear Rec.709.
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Below this elevation of the sun the moon lights the clouds, or nothing does.
const SUN_GONE_SINE: f32 = -0.10;

/// The light that the clouds are marched towards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyLight {
    /// The sun, also for a while after it has set for the eye.
    Sun,
    /// The moon.
    Moon,
    /// Neither: only airglow and starlight.
    None,
}

/// The lights of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lighting {
    /// Which one is marched towards.
    pub key: KeyLight,
    /// Unit vector towards it.
    pub towards_key: Vec3,
    /// Illuminance of the key light above the air in lux, coloured.
    pub key_lux: Vec3,
    /// Unit vector towards the sun.
    pub towards_sun: Vec3,
    /// Unit vector towards the moon.
    pub towards_moon: Vec3,
    /// Illuminance of the sun above the air in lux, coloured.
    pub sun_lux: Vec3,
    /// Illuminance of the moon above the air in lux, coloured; zero without a moon.
    pub moon_lux: Vec3,
    /// Illuminance of the sun as it is left after sunset, in lux.
    pub daylight_lux: f32,
    /// One working unit in cd/m²: chosen so that half floats hold the picture, day and night.
    pub candela_per_unit: f32,
}

/// A colour of luminance 1.
fn tint(colour: Colour) -> Vec3 {
    let luminance = colour.vec().dot(LUMINANCE);
    if luminance > 1e-6 { colour.vec() / luminance } else { Vec3::ZERO }
}

impl Lighting {
    /// The lights of a scene.
    #[allow(clippy::cast_possible_truncation, reason = "the range of f32 is ample for a scale")]
    pub fn new(scene: &Scene) -> Self {
        if scene.plain_light.enabled {
            return Self::plain(scene);
        }
        let towards_sun = scene.towards_sun();
        let towards_moon = scene.towards_moon();
        let sun_lux = tint(scene.sun.colour) * scene.sun.illuminance_klx * 1e3;
        let moon_up = scene.moon.enabled && towards_moon.y > SUN_GONE_SINE;
        let moon_lux = if moon_up { tint(scene.moon.colour) * scene.moon.illuminance_klx * 1e3 } else { Vec3::ZERO };
        let (key, towards_key, key_lux) = if sun_lux.max_element() > 0.0 && towards_sun.y > SUN_GONE_SINE {
            (KeyLight::Sun, towards_sun, sun_lux)
        } else if moon_lux.max_element() > 0.0 {
            (KeyLight::Moon, towards_moon, moon_lux)
        } else {
            (KeyLight::None, Vec3::Y, Vec3::ZERO)
        };
        // After sunset daylight falls by about three quarters of a power of ten with each degree.
        let below_deg = f64::from(-towards_sun.y).max(0.0).asin().to_degrees();
        let daylight = f64::from(sun_lux.dot(LUMINANCE)) * 10f64.powf(-0.75 * below_deg);
        let night = f64::from(moon_lux.dot(LUMINANCE)) + 1e-3;
        let candela_per_unit = ((daylight + night) / 16.0) as f32;
        let daylight_lux = daylight as f32;
        Self { key, towards_key, key_lux, towards_sun, towards_moon, sun_lux, moon_lux, daylight_lux, candela_per_unit }
    }

    /// How much of the stars twilight leaves: none until the sun is 7° below the horizon.
    pub fn star_share(&self) -> f32 {
        smoothstep(0.12, 0.18, -self.towards_sun.y)
    }

    /// How much of its streaks a light at the horizon still draws: none from 1° below it.
    pub fn streak_share(&self) -> f32 {
        if self.key == KeyLight::None { 0.0 } else { smoothstep(-0.02, 0.02, self.towards_key.y) }
    }

    /// A sun that shines from wherever it is told, in units of its own: pictures hold them as they are.
    fn plain(scene: &Scene) -> Self {
        let light = &scene.plain_light;
        let irradiance = light.sun_colour.vec() * light.sun_irradiance;
        let towards_sun = scene.towards_sun();
        Self {
            key: if irradiance.max_element() > 0.0 { KeyLight::Sun } else { KeyLight::None },
            towards_key: towards_sun,
            key_lux: irradiance,
            towards_sun,
            towards_moon: Vec3::NEG_Y,
            sun_lux: irradiance,
            moon_lux: Vec3::ZERO,
            daylight_lux: irradiance.max_element(),
            candela_per_unit: 1.0,
        }
    }
}

fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(elevation_deg: f32) -> Lighting {
        let mut scene = Scene::default();
        scene.sun.elevation_deg = elevation_deg;
        Lighting::new(&scene)
    }

    #[test]
    fn the_moon_takes_over_in_twilight() {
        assert_eq!(at(10.0).key, KeyLight::Sun);
        assert_eq!(at(-3.0).key, KeyLight::Sun, "high clouds still see the sun");
        assert_eq!(at(-12.0).key, KeyLight::Moon);
        let mut scene = Scene::default();
        scene.sun.elevation_deg = -30.0;
        scene.moon.enabled = false;
        assert_eq!(Lighting::new(&scene).key, KeyLight::None);
    }

    #[test]
    fn plain_light_is_as_given() {
        let mut scene = Scene::default();
        scene.sun.elevation_deg = -60.0;
        scene.plain_light.enabled = true;
        scene.plain_light.sun_irradiance = 7.0;
        let lighting = Lighting::new(&scene);
        assert_eq!((lighting.key, lighting.key_lux), (KeyLight::Sun, Vec3::splat(7.0)), "from below as well");
        assert_eq!((lighting.candela_per_unit, lighting.moon_lux), (1.0, Vec3::ZERO));
        scene.plain_light.sun_irradiance = 0.0;
        assert_eq!(Lighting::new(&scene).key, KeyLight::None);
    }

    #[test]
    fn stars_and_streaks_come_and_go_without_a_jump() {
        assert_eq!((at(10.0).star_share(), at(-6.0).star_share(), at(-12.0).star_share()), (0.0, 0.0, 1.0));
        assert_eq!((at(10.0).streak_share(), at(-1.2).streak_share()), (1.0, 0.0));
        for step in 0..400 {
            let (now, then) = (at(2.0 - step as f32 * 0.05), at(1.95 - step as f32 * 0.05));
            assert!((now.star_share() - then.star_share()).abs() < 0.03, "{step}");
            let moon_takes_over = now.key != then.key;
            assert!(moon_takes_over || (now.streak_share() - then.streak_share()).abs() < 0.05, "{step}");
        }
    }

    #[test]
    fn the_working_unit_never_jumps() {
        let mut before = at(5.0).candela_per_unit;
        for step in 0..300 {
            let now = at(5.0 - step as f32 * 0.1).candela_per_unit;
            assert!(
                now > 0.0 && (now / before).ln().abs() < 0.35,
                "at {}°: {before} then {now}",
                5.0 - step as f32 * 0.1
            );
            before = now;
        }
    }
}
