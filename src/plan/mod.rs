//! Decides what one frame needs. No GPU here, so every rule has a plain test.
//!
//! `None` and `false` mean: not compiled, not bound, not allocated, not dispatched. What there is to decide is the closed
//! list of [`Effect`]s; every frame has a [`Verdict`] on each of them, in words.

mod decide;
mod effect;
mod history;
mod light;
mod lights;
mod rows;
mod variant;
mod view;

pub use decide::{Need, Verdict};
pub use effect::{Effect, EffectInfo, Forced};
pub use history::{HistoryKey, UpdatePattern};
pub use light::{KeyLight, Lighting};
pub use variant::{MarchVariant, Phases, SunGridPlan};

use std::ops::Range;

use crate::choices;
use crate::scene::{Frame, MapLayer, MapSource, Output, Quality, Scene, ToneMap, UpdateFraction};
use decide::Verdicts;

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
    /// Whether solid shapes stand on it or over it.
    pub solids: bool,
    /// Edge length of the map of cloud shadows on it.
    pub shadow_px: Option<u32>,
    /// Rows from the top of the picture in which no ray can meet it.
    pub open_rows: u32,
}

/// Where the rays of reference integrators end that meet nothing.
pub const FURTHEST_M: f32 = 500_000.0;

/// What of the sky is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkyPlan {
    /// The table of the air before every distance.
    pub air: bool,
    /// The table of mean radiances.
    pub light: bool,
    /// Whether the air scatters moonlight.
    pub moonlit: bool,
    /// The sun's disc.
    pub sun_disc: bool,
    /// The moon's disc.
    pub moon_disc: bool,
    /// Stars.
    pub stars: bool,
}

/// What kinds of layers the weather map has beside generated ones and images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapLayers {
    /// Several, which are joined.
    pub joined: bool,
    /// Some that grow out of an image.
    pub grown: bool,
    /// Some that flow.
    pub flow: bool,
    /// Some that the brush has moved or smoothed.
    pub reworked: bool,
}

impl MapLayers {
    fn of(scene: &Scene, is_read: bool, why: &mut Verdicts) -> Self {
        let maps = &scene.weather.layers;
        // Flows with nothing below them carry nothing.
        let first = maps.iter().position(|map| map.source != MapSource::Flow).unwrap_or(maps.len());
        let maps = &maps[first..];
        let any = |source: MapSource| maps.iter().any(|map| map.source == source);
        let flows = |map: &MapLayer| map.source == MapSource::Flow && map.flow_mps * map.opacity != 0.0;
        let reworks = |map: &MapLayer| map.strokes.0.iter().any(|stroke| stroke.brush.reworks());
        let is_reworked = |map: &MapLayer| map.source == MapSource::Painted && reworks(map);
        let unread = (!is_read, Need::Impossible, "no layer is placed by the map");
        let no_image = (!any(MapSource::Grown), Need::Impossible, "no layer of the map grows");
        let no_flow = (!any(MapSource::Flow), Need::Impossible, "no layer of the map flows");
        let stands = (!maps.iter().any(flows), Need::Needless, "they stand still");
        Self {
            joined: maps.len() > 1,
            grown: why.unless(Effect::GrowingMap, &[unread, no_image], "a layer of the map grows"),
            flow: why.unless(Effect::Flows, &[unread, no_flow, stands], "they carry the map"),
            reworked: is_read && maps.iter().any(is_reworked),
        }
    }
}

/// Everything one frame does, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// The light that is marched towards.
    pub key: KeyLight,
    /// The sky, unless light comes from a plain sun and sky without air and ground.
    pub sky: Option<SkyPlan>,
    /// The ground, where any can be seen.
    pub ground: Option<GroundPlan>,
    /// How the clouds are read, where the view or a shadow map needs them.
    pub march: Option<MarchVariant>,
    /// Whether layers may hold cloud, in view or not: what was made for them is kept until they come into view again.
    pub holds_clouds: bool,
    /// Rows of the picture that are marched; none where no cloud can be in view.
    pub cloud_rows: Range<u32>,
    /// Which pixels are computed, where not all are.
    pub temporal: Option<UpdatePattern>,
    /// Samples along streaks of light.
    pub sunshafts: Option<u32>,
    /// Whether thin cloud glows about the light.
    pub glow: bool,
    /// Whether targets are float, for a file.
    pub float: bool,
    /// Whether the clouds are written without what lies behind them.
    pub alone: bool,
    /// How light becomes display colour.
    pub tone_map: ToneMap,
    /// Whether the display's contrast and saturation change anything.
    pub graded: bool,
    /// Whether what clips on the screen is striped.
    pub stripes: bool,
    /// Whether the weather map has layers over others, which grow, or which flow.
    pub map_layers: MapLayers,
    /// Whether clouds are found by tracking, which needs bounds of their density.
    pub tracks: bool,
    /// Samples of each pixel; those of paths are their own.
    pub pixel_samples: u32,
    /// A verdict on each effect, in their order.
    pub verdicts: Vec<Verdict>,
}

impl FramePlan {
    /// The plan of a frame.
    pub fn new(frame: &Frame<'_>) -> Self {
        Self::forced(frame, Forced::default())
    }

    /// The plan of a frame with some effects forced on or off.
    pub fn forced(frame: &Frame<'_>, forced: Forced) -> Self {
        let scene = frame.scene;
        let lighting = Lighting::new(scene);
        let mut why = Verdicts::new(forced);
        let ground = lights::ground(frame, &mut why);
        let field = MarchVariant::of_field(frame, &mut why);
        let has_field = field.is_some();
        let map_layers = MapLayers::of(scene, field.is_some_and(|field| !field.mapless), &mut why);
        let cloud_rows = cloud_rows(frame, has_field, &mut why);
        let has_clouds = !cloud_rows.is_empty();
        let shadow_px = lights::cloud_shadow(frame, (ground.is_some(), has_field), &lighting, &mut why);
        let temporal = temporal(frame, has_clouds, &mut why);
        let march = field.filter(|_| has_clouds || shadow_px.is_some()).map(|field| {
            let is_partial = temporal.is_some();
            if has_clouds { field.marched(frame, (ground.is_some(), is_partial), &lighting, &mut why) } else { field }
        });
        let sunshafts = lights::sunshafts(frame, has_clouds || ground.is_some(), &lighting, &mut why);
        let glow = lights::glow(scene, has_clouds, &lighting, &mut why);
        let sky = lights::sky(frame, ground.is_some(), march, &lighting, &mut why);
        let display = &scene.display;
        let graded = why.needed_if(
            (display.contrast != 1.0 || display.saturation != 1.0) && display.tone_map != ToneMap::FalseColour,
            Effect::Grading,
            format!("contrast is {}, saturation {}", display.contrast, display.saturation),
            "contrast and saturation are 1, or false colours are shown",
        );
        Self {
            key: lighting.key,
            sky,
            ground: ground.map(|ground| GroundPlan { shadow_px, ..ground }),
            march,
            holds_clouds: has_field && forced.get(Effect::Clouds) != Some(false),
            cloud_rows,
            temporal,
            sunshafts,
            glow,
            float: frame.output != Output::Display,
            alone: frame.output == Output::CloudsAlone,
            tone_map: scene.display.tone_map,
            graded,
            stripes: forced.stripes && frame.output == Output::Display,
            map_layers,
            tracks: false,
            pixel_samples: 1,
            verdicts: why.complete(),
        }
    }

    /// The plan of a frame whose clouds are wanted whether they are in view or not.
    pub fn of_clouds(frame: &Frame<'_>) -> Self {
        Self::forced(frame, Forced::default().with(Effect::Clouds, Some(true)))
    }

    /// The plan of a picture that takes its time: all pixels, with several samples each but for paths, at the frame's own
    /// size.
    pub fn for_still(frame: &Frame<'_>, (integrator, pixel_samples): (Integrator, u32), forced: Forced) -> Self {
        let is_traced = integrator == Integrator::PathTraced;
        let pixel_samples = if is_traced { 1 } else { pixel_samples.max(1) };
        let mut whole = Quality { update: UpdateFraction::Full, ..frame.quality.clone() };
        if integrator != Integrator::Realtime {
            // How far the march looks is its own affair.
            whole.max_distance_m = FURTHEST_M;
        }
        let mut plan = Self::forced(&Frame { quality: &whole, ..*frame }, forced);
        (plan.tracks, plan.pixel_samples) = (is_traced, pixel_samples);
        if integrator != Integrator::Realtime && plan.has_clouds() {
            // They walk through all pixels, and never look where it is clear.
            plan.cloud_rows = 0..frame.render_size()[1];
            plan.march = plan.march.map(|march| if is_traced { march.traced(frame.scene) } else { march });
        }
        plan
    }

    /// Whether clouds are in the picture, and not only their shadows.
    pub fn has_clouds(&self) -> bool {
        !self.cloud_rows.is_empty()
    }

    /// The verdict on an effect.
    pub fn verdict(&self, effect: Effect) -> &Verdict {
        &self.verdicts[effect as usize]
    }

    /// Whether an effect runs.
    pub fn runs(&self, effect: Effect) -> bool {
        self.verdict(effect).runs
    }

    /// The same for a picture from another place: what it looked past may be in view there.
    #[must_use]
    pub fn from_anywhere(self, rows: u32) -> Self {
        let ground = self.ground.map(|ground| GroundPlan { open_rows: 0, ..ground });
        let cloud_rows = if self.has_clouds() { 0..rows } else { 0..0 };
        Self { ground, cloud_rows, ..self }
    }

    /// Whether a scene of the other plan holds everything that this one draws from.
    pub fn fits(&self, other: &Self) -> bool {
        let source = |plan: &Self| plan.march.map(|march| (march.grid, march.baked, march.layers));
        self.sky.is_some() == other.sky.is_some() && source(self) == source(other)
    }
}

/// Rows of the picture that are marched.
fn cloud_rows(frame: &Frame<'_>, has_field: bool, why: &mut Verdicts) -> Range<u32> {
    let all = frame.render_size()[1];
    let in_view = if has_field { rows::cloud_rows(frame) } else { 0..0 };
    let runs = why.unless(
        Effect::Clouds,
        &[
            (!has_field, Need::Impossible, variant::no_cloud(frame.scene)),
            (in_view.is_empty(), Need::Needless, "the view misses all of them"),
        ],
        format!("{} layer(s) can hold cloud", frame.scene.visible_layers().count()),
    );
    let everywhere = why.unless(
        Effect::CloudsEverywhere,
        &[
            (!runs, Need::Impossible, "no cloud is marched"),
            (in_view.is_empty(), Need::Impossible, "no row meets any"),
            (in_view != (0..all), Need::Needless, "no cloud can be in some rows"),
        ],
        "clouds may be in every row",
    );
    match (runs, everywhere || in_view.is_empty()) {
        (false, _) => 0..0,
        (true, true) => 0..all,
        (true, false) => in_view,
    }
}

fn temporal(frame: &Frame<'_>, has_clouds: bool, why: &mut Verdicts) -> Option<UpdatePattern> {
    let pattern = UpdatePattern::new(frame.quality.update, frame.quality.update_order);
    why.unless(
        Effect::Temporal,
        &[
            (!has_clouds, Need::Impossible, "no cloud is marched"),
            (frame.output != Output::Display, Need::Impossible, "a still is marched whole"),
            (frame.quality.update == UpdateFraction::Full, Need::Impossible, "every pixel is computed in every frame"),
        ],
        format!("one pixel of {} is computed in a frame", pattern.phases()),
    )
    .then_some(pattern)
}

#[cfg(test)]
mod tests;
