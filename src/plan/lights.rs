//! What the sky, the ground and the streaks of light need.

use super::decide::{Need, Verdicts};
use super::effect::Effect;
use super::light::{KeyLight, Lighting};
use super::variant::MarchVariant;
use super::{GroundPlan, SkyPlan, rows, view};
use crate::scene::{Frame, Output, Projection, Scene, ShapeRole};

/// Share of the sun's light below which moonlight in the air is lost in half floats.
const LOST_IN_DAYLIGHT: f32 = 1e-5;
/// Sine of the elevation from which light can cast shadows of clouds on the ground.
const STEEP_ENOUGH: f32 = 0.02;

/// The ground, where any can be seen; whether clouds cast shadows on it is decided later.
pub(super) fn ground(frame: &Frame<'_>, why: &mut Verdicts) -> Option<GroundPlan> {
    let ground = &frame.scene.ground;
    let relief_m = ground.mountains_m + ground.hills_m;
    let rows = frame.render_size()[1];
    let solids = frame.scene.has_shapes(ShapeRole::Solid);
    let open_rows = if solids { 0 } else { rows::open_rows(frame) };
    let runs = why.unless(
        Effect::Ground,
        &[
            (frame.scene.plain_light.enabled, Need::Impossible, "the light is plain"),
            (!ground.visible, Need::Unwanted, "it is switched off"),
            (open_rows >= rows, Need::Needless, "the whole view lies above it"),
        ],
        "it is in view",
    );
    if !runs {
        return None;
    }
    let terrain = why.needed_if(
        relief_m > 0.0,
        Effect::Terrain,
        format!("relief is {relief_m:.0} m high"),
        "there are no hills and no mountains",
    );
    let solids = why.needed_if(solids, Effect::Solids, "some shape is solid", "no shape is solid");
    let everywhere = why.unless(
        Effect::GroundEverywhere,
        &[
            (open_rows >= rows, Need::Impossible, "no row meets any"),
            (open_rows > 0, Need::Needless, "some rows lie above all ground"),
        ],
        "ground may be in every row",
    );
    let open_rows = if everywhere || open_rows >= rows { 0 } else { open_rows };
    Some(GroundPlan { terrain, solids, shadow_px: None, open_rows })
}

/// Edge length of the map of cloud shadows.
pub(super) fn cloud_shadow(
    frame: &Frame<'_>,
    (has_ground, has_field): (bool, bool),
    lighting: &Lighting,
    why: &mut Verdicts,
) -> Option<u32> {
    let is_steep = lighting.key != KeyLight::None && lighting.towards_key.y > STEEP_ENOUGH;
    why.unless(
        Effect::CloudShadows,
        &[
            (!has_ground, Need::Impossible, "there is no ground in view"),
            (!has_field, Need::Impossible, "there is no cloud to cast any"),
            (frame.scene.ground.cloud_shadows <= 0.0, Need::Needless, "their strength is 0"),
            (!is_steep, Need::Unwanted, "no light falls steeply enough on the ground"),
        ],
        "lit ground is in view below clouds",
    )
    .then_some(frame.quality.shadow_map_px)
}

/// Whether thin cloud glows about the light.
pub(super) fn glow(scene: &Scene, has_clouds: bool, lighting: &Lighting, why: &mut Verdicts) -> bool {
    why.unless(
        Effect::Glow,
        &[
            (!has_clouds, Need::Impossible, "no cloud is in the picture"),
            (scene.scattering.glow <= 0.0, Need::Needless, "its strength is 0"),
            (lighting.key == KeyLight::None, Need::Needless, "neither sun nor moon shines"),
        ],
        "the artist wants it",
    )
}

/// Samples along streaks of light.
pub(super) fn sunshafts(frame: &Frame<'_>, has_occluder: bool, lighting: &Lighting, why: &mut Verdicts) -> Option<u32> {
    let scene = frame.scene;
    let off_axis_deg = view::angle_off_view_deg(scene, lighting.towards_key);
    // Streaks end at a chord of the sphere of directions.
    let reach_deg = 2.0 * (0.5 * scene.sunshafts.length_deg.to_radians()).min(1.0).asin().to_degrees();
    let in_reach = scene.camera.projection != Projection::Perspective
        || off_axis_deg < view::half_diagonal_deg(frame) + reach_deg + view::MARGIN_DEG;
    why.unless(
        Effect::Sunshafts,
        &[
            (scene.plain_light.enabled, Need::Impossible, "there is no air"),
            (frame.output == Output::CloudsAlone, Need::Impossible, "only clouds are written"),
            (frame.window.is_some(), Need::Impossible, "a part of a picture lacks what streaks come from"),
            (scene.sunshafts.strength <= 0.0, Need::Needless, "their strength is 0"),
            (lighting.streak_share() <= 0.0, Need::Needless, "the light is below the horizon"),
            (!has_occluder, Need::Unwanted, "nothing stands before the light"),
            (!in_reach, Need::Needless, &format!("the light is {off_axis_deg:.0}° away from the view")),
        ],
        "the light is near the view, behind things",
    )
    .then_some(frame.quality.shaft_samples)
}

/// Tables of the sky, and what is drawn on it.
pub(super) fn sky(
    frame: &Frame<'_>,
    has_ground: bool,
    march: Option<MarchVariant>,
    lighting: &Lighting,
    why: &mut Verdicts,
) -> Option<SkyPlan> {
    let scene = frame.scene;
    let is_plain = scene.plain_light.enabled;
    let plain = (is_plain, Need::Impossible, "the light is plain: there is no air");
    if !why.unless(Effect::SkyTables, &[plain], "the light comes through air") {
        return None;
    }
    let reads_air = march.is_some_and(|march| march.air);
    let reads_light = march.is_some_and(|march| march.ambient);
    let of_both = |reads: bool| if reads { "clouds are in the air" } else { "ground is in view" };
    let air =
        why.needed_if(has_ground || reads_air, Effect::AirTable, of_both(reads_air), "nothing is seen through air");
    let light =
        why.needed_if(has_ground || reads_light, Effect::SkyLightTable, of_both(reads_light), "nothing is lit by it");
    let moonlit = why.unless(
        Effect::MoonlitAir,
        &[
            (lighting.moon_lux == glam::Vec3::ZERO, Need::Needless, "there is no moonlight"),
            (
                lighting.moon_lux.max_element() < LOST_IN_DAYLIGHT * lighting.daylight_lux,
                Need::Needless,
                "daylight outshines it",
            ),
        ],
        "the moon shines",
    );
    let out_of_view = |towards, radius_deg: f32| view::is_out_of_view(frame, towards, radius_deg);
    let hidden = |towards, radius_deg: f32| has_ground && view::is_below_eye_horizon(frame, towards, radius_deg);
    let (sun, moon) = (lighting.towards_sun, lighting.towards_moon);
    let sun_disc = why.unless(
        Effect::SunDisc,
        &[
            (!scene.sun.disc, Need::Unwanted, "it is switched off"),
            (lighting.sun_lux == glam::Vec3::ZERO, Need::Needless, "the sun is dark"),
            (hidden(sun, scene.sun.radius_deg), Need::Needless, "the sun is below the horizon"),
            (out_of_view(sun, scene.sun.radius_deg), Need::Needless, "the sun is out of view"),
        ],
        "the sun may be in view",
    );
    let moon_disc = why.unless(
        Effect::MoonDisc,
        &[
            (lighting.moon_lux == glam::Vec3::ZERO, Need::Needless, "there is no moonlight"),
            (hidden(moon, scene.moon.radius_deg), Need::Needless, "the moon is below the horizon"),
            (out_of_view(moon, scene.moon.radius_deg), Need::Needless, "the moon is out of view"),
        ],
        "the moon may be in view",
    );
    let stars = why.needed_if(
        lighting.star_share() > 0.0,
        Effect::Stars,
        "the sun is far below the horizon",
        "the sky is too bright",
    );
    Some(SkyPlan { air, light, moonlit, sun_disc, moon_disc, stars })
}
