//! Decides what one frame needs. No GPU here, so every rule has a plain test.
//!
//! `None` and `false` mean: not compiled, not bound, not allocated, not dispatched. Every entry says why in words.

mod history;
mod horizon;
mod light;
mod reasons;
mod variant;

pub use history::{HistoryKey, UpdatePattern};
pub use light::{KeyLight, Lighting};
pub use reasons::Reason;
pub use variant::MarchVariant;

use crate::choices;
use crate::scene::{Frame, Output, Projection, Scene, ToneMap, UpdateFraction};
use reasons::Reasons;

choices! {
    /// How the light of clouds is found. All three read the same density and the same phase functions.
    pub enum Integrator {
        /// The march: as fast as its quality allows.
        Realtime ("Realtime"),
        /// The march's model with steps so short that they no longer matter.
        Converged ("Converged"),
        /// All orders of scattering, without bias.
        PathTraced ("Path traced"),
    }
}

/// Whether and how the ground is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroundPlan {
    /// Whether it has relief.
    pub terrain: bool,
    /// Edge length of the map of cloud shadows on it.
    pub shadow_px: Option<u32>,
    /// Rows from the top of the picture in which no ray can meet it.
    pub open_rows: u32,
}

/// Everything one frame does, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// The light that is marched towards.
    pub key: KeyLight,
    /// Whether light comes from a plain sun and sky, with no air and no ground.
    pub plain: bool,
    /// Whether stars are drawn.
    pub stars: bool,
    /// The ground, where any can be seen.
    pub ground: Option<GroundPlan>,
    /// The cloud march, where any cloud can be seen.
    pub march: Option<MarchVariant>,
    /// Which pixels are computed, where not all are.
    pub temporal: Option<UpdatePattern>,
    /// Samples along streaks of light.
    pub sunshafts: Option<u32>,
    /// Whether targets are float, for a file.
    pub float: bool,
    /// Whether the clouds are written without what lies behind them.
    pub alone: bool,
    /// How light becomes display colour.
    pub tone_map: ToneMap,
    /// Whether clouds are found by tracking, which needs bounds of their density.
    pub tracks: bool,
    /// Samples of each pixel; those of paths are their own.
    pub pixel_samples: u32,
    /// Why each entry is as it is.
    pub reasons: Vec<Reason>,
}

impl FramePlan {
    /// The plan of a frame.
    pub fn new(frame: &Frame<'_>) -> Self {
        let scene = frame.scene;
        let lighting = Lighting::new(scene);
        let mut why = Reasons::default();
        let ground = ground(frame, &lighting, &mut why);
        let march = MarchVariant::new(frame, ground.is_some(), &lighting, &mut why);
        let temporal = temporal(frame, march.is_some(), &mut why);
        let sunshafts = sunshafts(frame, march.is_some() || ground.is_some(), &lighting, &mut why);
        Self {
            key: lighting.key,
            plain: plain(scene, &mut why),
            stars: stars(&lighting, scene.plain_light.enabled, &mut why),
            ground,
            march,
            temporal,
            sunshafts,
            float: frame.output != Output::Display,
            alone: frame.output == Output::CloudsAlone,
            tone_map: scene.display.tone_map,
            tracks: false,
            pixel_samples: 1,
            reasons: why.0,
        }
    }

    /// The plan of a picture that takes its time: all pixels, with several samples each but for paths, at the frame's own
    /// size.
    pub fn for_still(frame: &Frame<'_>, integrator: Integrator, pixel_samples: u32) -> Self {
        let is_traced = integrator == Integrator::PathTraced;
        let pixel_samples = if is_traced { 1 } else { pixel_samples.max(1) };
        Self { temporal: None, tracks: is_traced, pixel_samples, ..Self::new(frame) }
    }
}

impl FramePlan {
    /// Whether a scene of the other plan holds everything that this one draws from.
    pub fn fits(&self, other: &Self) -> bool {
        let source = |plan: &Self| plan.march.map(|march| (march.grid, march.baked, march.layers));
        self.plain == other.plain && source(self) == source(other)
    }
}

fn plain(scene: &Scene, why: &mut Reasons) -> bool {
    let plain = scene.plain_light.enabled;
    why.either(!plain, "sky tables", "the light comes through air", "the light is plain: there is no air");
    plain
}

fn ground(frame: &Frame<'_>, lighting: &Lighting, why: &mut Reasons) -> Option<GroundPlan> {
    let ground = &frame.scene.ground;
    let camera = &frame.scene.camera;
    let relief_m = ground.mountains_m + ground.hills_m;
    let lowest_ray_deg = match camera.projection {
        Projection::Perspective => camera.pitch_deg - half_diagonal_deg(frame),
        Projection::Equirect => -90.0,
        Projection::Dome => 0.0,
    };
    let relief_angle_deg = if relief_m > 0.0 { 35.0 } else { 0.0 };
    if frame.scene.plain_light.enabled {
        why.no("ground", "the light is plain");
        return None;
    }
    if !ground.visible {
        why.no("ground", "it is switched off");
        return None;
    }
    if frame.output == Output::CloudsAlone && relief_m <= 0.0 {
        why.no("ground", "only clouds are written, and a plain hides none of them above the horizon");
        return None;
    }
    if lowest_ray_deg > relief_angle_deg {
        why.no("ground", format!("the view begins {lowest_ray_deg:.0}° above the horizon"));
        return None;
    }
    why.yes("ground", "it is in view");
    let terrain = relief_m > 0.0;
    why.either(terrain, "terrain", format!("relief is {relief_m:.0} m high"), "there are no hills and no mountains");
    let shadow_px = cloud_shadow(frame, lighting, why);
    let open_rows = horizon::open_rows(frame);
    let rows = frame.render_size()[1];
    why.either(
        open_rows < rows,
        "ground in each row",
        format!("the upper {open_rows} of {rows} rows lie above it"),
        "it lies below the picture",
    );
    Some(GroundPlan { terrain, shadow_px, open_rows })
}

fn cloud_shadow(frame: &Frame<'_>, lighting: &Lighting, why: &mut Reasons) -> Option<u32> {
    let scene = frame.scene;
    let because = if scene.ground.cloud_shadows <= 0.0 {
        "their strength is 0"
    } else if lighting.key == KeyLight::None || lighting.towards_key.y <= 0.02 {
        "no light falls steeply enough on the ground"
    } else if scene.visible_layers().next().is_none() {
        "there is no cloud to cast any"
    } else {
        why.yes("cloud shadows", "lit ground is in view below clouds");
        return Some(frame.quality.shadow_map_px);
    };
    why.no("cloud shadows", because);
    None
}

fn temporal(frame: &Frame<'_>, has_clouds: bool, why: &mut Reasons) -> Option<UpdatePattern> {
    let because = if !has_clouds {
        "no cloud is marched"
    } else if frame.output != Output::Display {
        "a still is marched whole"
    } else if frame.quality.update == UpdateFraction::Full {
        "every pixel is computed in every frame"
    } else {
        let pattern = UpdatePattern::new(frame.quality.update, frame.quality.update_order);
        why.yes("temporal reprojection", format!("one pixel of {} is computed in a frame", pattern.phases()));
        return Some(pattern);
    };
    why.no("temporal reprojection", because);
    None
}

fn sunshafts(frame: &Frame<'_>, has_occluder: bool, lighting: &Lighting, why: &mut Reasons) -> Option<u32> {
    let scene = frame.scene;
    let reach_deg = scene.sunshafts.length_deg;
    let off_axis_deg = angle_off_view_deg(scene, lighting.towards_key);
    let in_reach = match scene.camera.projection {
        Projection::Perspective => off_axis_deg < half_diagonal_deg(frame) + reach_deg,
        _ => true,
    };
    let because = if scene.sunshafts.strength <= 0.0 {
        "their strength is 0".to_owned()
    } else if scene.plain_light.enabled {
        "there is no air".to_owned()
    } else if lighting.key == KeyLight::None || lighting.towards_key.y < -0.02 {
        "the light is below the horizon".to_owned()
    } else if !has_occluder {
        "nothing stands before the light".to_owned()
    } else if !in_reach {
        format!("the light is {off_axis_deg:.0}° away from the view")
    } else if frame.output == Output::CloudsAlone {
        "only clouds are written".to_owned()
    } else {
        why.yes("sunshafts", "the light is near the view, behind things");
        return Some(frame.quality.shaft_samples);
    };
    why.no("sunshafts", because);
    None
}

fn stars(lighting: &Lighting, plain: bool, why: &mut Reasons) -> bool {
    let night = lighting.towards_sun.y < -0.12 && !plain;
    why.either(night, "stars", "the sun is far below the horizon", "the sky is too bright, or plain");
    night
}

/// Half the angle across the picture's diagonal.
fn half_diagonal_deg(frame: &Frame<'_>) -> f32 {
    let [across, up] = frame.scene.camera.half_tangents(frame.render_size());
    across.hypot(up).atan().to_degrees()
}

fn angle_off_view_deg(scene: &Scene, towards: glam::Vec3) -> f32 {
    let forward = crate::scene::direction(scene.camera.pitch_deg, scene.camera.heading_deg);
    forward.dot(towards).clamp(-1.0, 1.0).acos().to_degrees()
}

#[cfg(test)]
mod tests;
