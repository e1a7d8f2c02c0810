//! Reads the values of arguments.

use std::path::Path;

use anyhow::{Context as _, Result};

use super::error::Usage;
use crate::files::{Sky, load_quality};
use crate::plan::{Effect, Forced};
use crate::scene::edit;
use crate::scene::nearest::did_you_mean;
use crate::scene::param::Choice as _;
use crate::scene::{Quality, QualityLevel, Scene};

/// Longest side of a picture in pixels.
pub(super) const MAX_SIDE: u32 = 16_384;

/// `1920x1080`, `hd` or `4k`.
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let refused = || format!("a size is hd, 4k, or WIDTHxHEIGHT from 1x1 to {MAX_SIDE}x{MAX_SIDE}, such as 1920x1080");
    match text.to_lowercase().as_str() {
        "hd" => Ok([1920, 1080]),
        "4k" => Ok([3840, 2160]),
        other => size_of(other).ok_or_else(refused),
    }
}

fn size_of(text: &str) -> Option<[u32; 2]> {
    let (width, height) = text.split_once(['x', '×'])?;
    let side = |text: &str| text.trim().parse().ok().filter(|side| (1..=MAX_SIDE).contains(side));
    Some([side(width)?, side(height)?])
}

/// `640x360+100+50`: offset from the top left, then size.
pub(super) fn region(text: &str) -> Result<[[u32; 2]; 2], String> {
    let refused = || format!("a region is WIDTHxHEIGHT+LEFT+TOP in pixels, such as 640x360+100+50, not {text}");
    let mut parts = text.split('+');
    let (size, left, top) = (parts.next(), parts.next(), parts.next());
    let (Some(part), Some(left), Some(top), None) = (size, left, top, parts.next()) else { return Err(refused()) };
    let offset = |text: &str| text.trim().parse().map_err(|_| refused());
    Ok([[offset(left)?, offset(top)?], size_of(part).ok_or_else(refused)?])
}

/// A finite number.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| "must be a finite number".to_owned())
}

/// A finite number above 0.
pub(super) fn above_zero(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|number: &f32| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "must be a number above 0".to_owned())
}

/// `x,y,z,heading,pitch[,fov]` as values of the camera's parameters.
pub(super) fn set_camera(scene: &mut Scene, text: &str) -> Result<()> {
    const KEYS: [&str; 6] = ["east_m", "height_m", "south_m", "heading_deg", "pitch_deg", "field_of_view_deg"];
    let values: Vec<&str> = text.split(',').map(str::trim).collect();
    if !(5..=6).contains(&values.len()) {
        let message = format!(
            "--camera {text:?} has {} value(s), but takes east,height,south,heading,pitch[,field of view], \
             such as 0,20,0,180,10,50",
            values.len()
        );
        return Err(Usage(message).into());
    }
    for (key, value) in KEYS.iter().zip(values) {
        edit::set(scene, &format!("camera.{key}"), value)
            .with_context(|| format!("--camera {text:?} cannot be used"))?;
    }
    Ok(())
}

/// `NAME=on` and `NAME=off` of effects, as the overlay and docs/effects.md name them; spaces may be written as dashes.
pub(super) fn forced(texts: &[String]) -> Result<Forced> {
    let mut forced = Forced::default();
    for text in texts {
        let refused = |reason: String| Usage(format!("--force {text:?}: {reason}"));
        let wanted = text.split_once('=').and_then(|(name, state)| match state.trim() {
            "on" => Some((name, true)),
            "off" => Some((name, false)),
            _ => None,
        });
        let Some((name, is_on)) = wanted else {
            return Err(refused("write the name of an effect and =on or =off, such as sunshafts=off".to_owned()).into());
        };
        let Some(effect) = Effect::ALL.iter().copied().find(|effect| is_name_of(*effect, name.trim())) else {
            let hint = did_you_mean(name, Effect::ALL.iter().map(|effect| effect.info().name));
            return Err(refused(format!("there is no such effect{hint}; docs/effects.md lists them")).into());
        };
        if !is_on && !effect.info().can_be_off {
            return Err(refused("the picture cannot be made without it".to_owned()).into());
        }
        forced = forced.with(effect, Some(is_on));
    }
    Ok(forced)
}

fn is_name_of(effect: Effect, text: &str) -> bool {
    text.replace('-', " ").eq_ignore_ascii_case(&effect.info().name.replace('-', " "))
}

/// The quality settings: a level by name or a file if given, else those of the sky, else the level for stills.
pub(super) fn quality(given: Option<&str>, sky: &Sky) -> Result<Quality> {
    let Some(given) = given else {
        return Ok(sky.quality.clone().unwrap_or_else(|| Quality::level(QualityLevel::High)));
    };
    if let Some(level) = QualityLevel::ALL.iter().find(|level| level.name().eq_ignore_ascii_case(given)) {
        return Ok(Quality::level(*level));
    }
    if Path::new(given).extension().is_some_and(|extension| extension == "ron") {
        return Ok(load_quality(Path::new(given))?);
    }
    let message = format!("--quality {given:?} is neither draft, preview, high or final, nor a .ron file");
    Err(Usage(message).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_refused() {
        assert_eq!(size("64x36"), Ok([64, 36]));
        assert_eq!(size("4K"), Ok([3840, 2160]));
        for wrong in ["", "64", "0x5", "5x", "-1x5", "99999x5", "64x36x2", "NaNx1"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn effects_are_forced_by_name() {
        let read = |text: &str| forced(&[text.to_owned()]);
        let seen = read("Sunshafts=off").expect("an effect");
        assert_eq!((seen.get(Effect::Sunshafts), seen.get(Effect::Curl)), (Some(false), None));
        let seen = read("henyey-greenstein-phase=on").expect("spaces may be dashes");
        assert_eq!(seen.get(Effect::HenyeyGreenstein), Some(true));
        for wrong in ["", "sunshafts", "sunshafts=maybe", "sunshaft=on", "weather map=off"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
        let message = read("sunshaft=on").expect_err("a slip").to_string();
        assert!(message.contains("sunshafts"), "{message}");
    }

    #[test]
    fn a_camera_sets_its_parameters() {
        let mut scene = Scene::default();
        set_camera(&mut scene, "1, 2, -3, 90, -5, 60").expect("six values");
        let camera = &scene.camera;
        assert_eq!([camera.east_m, camera.height_m, camera.south_m], [1.0, 2.0, -3.0]);
        assert_eq!([camera.heading_deg, camera.pitch_deg, camera.field_of_view_deg], [90.0, -5.0, 60.0]);
        for wrong in ["1,2,3", "1,2,3,4,x", "1,2,3,4,95", "1,2,3,4,NaN"] {
            assert!(set_camera(&mut scene, wrong).is_err(), "{wrong}");
        }
    }
}
