//! Skies that nobody made: every parameter over its full range, edges favoured, from anywhere. Whatever is drawn, the
//! picture has to be one.

use super::VerifyError;
use crate::plan::Lighting;
use crate::render::Renderer;
use crate::scene::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params as _, Visitor};
use crate::scene::random::{Stream, between};
use crate::scene::{
    BodyForm, CloudLayer, DensityModel, DomainKind, Frame, MapBlend, MapEdge, MapLayer, MapSource, Output, PhaseKind,
    Quality, Scene, ShapeRole,
};

/// Width and height of the pictures.
pub const SIZE: [u32; 2] = [32, 18];
/// Pixels with less opacity do not count as cloud.
const CLOUD: f32 = 0.01;
/// Of drawn skies so many are made friendlier to clouds, or most pictures would show none.
const TAMED: f64 = 0.9;

/// One drawn sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// The sky.
    pub scene: Scene,
    /// How it is computed.
    pub quality: Quality,
    /// Seconds since it began.
    pub time_secs: f64,
}

/// Draws values from two streams: what changes programs and bakes from one that few skies share, so that they need not be
/// made anew for each; the rest from the sky's own.
struct Drawing {
    shared: Stream,
    own: Stream,
}

impl Drawing {
    /// Where in its range a value lies, 0 to 1; `None` is the default. One in five lies on an edge.
    fn place(&mut self) -> Option<f64> {
        let inside = self.own.unit();
        match self.shared.unit() {
            draw if draw < 0.45 => None,
            draw if draw < 0.55 => Some(0.0),
            draw if draw < 0.65 => Some(1.0),
            _ => Some(inside),
        }
    }
}

impl Visitor for Drawing {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        *value = self.place().and_then(|at| between(info, at)).unwrap_or(info.default);
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count within its range")]
    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        let (draw, at) = (self.shared.unit(), self.shared.unit());
        *value = info.default;
        if let Some(range) = info.range.as_ref().filter(|_| draw > 0.5) {
            let (low, high) = (f64::from(*range.start()), f64::from(*range.end()));
            *value = (low + (high - low) * at * at).round() as u32;
        }
    }

    fn switch(&mut self, _: &Info<bool>, value: &mut bool) {
        *value = self.shared.unit() < 0.5;
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        *index = self.shared.below(info.options.len());
    }

    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        let mut part = || self.place().and_then(|at| between(&COLOUR_PART, at));
        *value = match [part(), part(), part()] {
            [Some(red), Some(green), Some(blue)] => Colour(red, green, blue),
            _ => info.default,
        };
    }

    fn file(&mut self, _: &Info<FileName>, _: &mut FileName) {}

    fn group(&mut self, _: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        children(self);
    }

    fn list(&mut self, _: &GroupInfo, list: &mut dyn List) {
        while list.count() > 1 {
            list.remove(list.count() - 1);
        }
        // One layer is as frequent as all other numbers together.
        let count = if self.shared.unit() < 0.5 { 0 } else { self.shared.below(crate::scene::MAX_LAYERS) };
        for index in 0..=count {
            if list.count() <= index {
                list.append();
            }
            list.visit_item(index, self);
        }
    }
}

const COLOUR_PART: Info<f32> = Info {
    name: "part",
    doc: "",
    unit: crate::scene::param::Unit::None,
    range: Some(0.0..=1.0),
    default: 1.0,
    logarithmic: false,
};

/// The sky of an index, one of `kinds` kinds that share programs.
#[allow(clippy::cast_possible_truncation, reason = "heights and angles, to single precision")]
pub fn draw(index: u64, kinds: u64) -> Drawn {
    let kind = index % kinds.max(1);
    let mut drawing = Drawing { shared: Stream::new(kind ^ 0x5eed), own: Stream::new(index << 16 | 1) };
    let (mut scene, mut quality) = (Scene::default(), Quality::default());
    scene.visit(&mut drawing);
    quality.visit(&mut drawing);
    // Small maps and pictures: what they show is checked, not how finely.
    quality.shadow_map_px = quality.shadow_map_px.min(64);
    quality.light_grid = quality.light_grid.min(48);
    quality.resolution_scale = 1.0;
    for (index, map) in scene.weather.layers.iter_mut().enumerate() {
        let is_carried = index > 0 && map.source == MapSource::Flow;
        if !map.source.is_generated() && !is_carried {
            map.source = MapSource::Generated;
        }
    }
    for layer in &mut scene.layers {
        if layer.model == DensityModel::Grid {
            layer.model = DensityModel::Profile;
        }
    }
    scene.mend();
    if drawing.shared.unit() < TAMED {
        tame(&mut scene, &mut quality, &mut drawing.own);
    }
    let times = [0.0, 0.04, -1.0, 3600.0, 86_400.0 * 30.0, 3.15e7, 1e9 * drawing.own.unit()];
    let time_secs = times[drawing.own.below(times.len())];
    Drawn { scene, quality, time_secs }
}

/// Brings clouds into view, and leaves everything else as it was drawn.
#[allow(clippy::cast_possible_truncation, reason = "heights and angles, to single precision")]
fn tame(scene: &mut Scene, quality: &mut Quality, own: &mut Stream) {
    if own.unit() < 0.8 {
        scene.weather.edge = MapEdge::Repeat;
    }
    let mut within = |low: f64, high: f64| (low + (high - low) * own.unit()) as f32;
    scene.weather.coverage = within(0.3, 0.5);
    scene.weather.coverage_changes = false;
    scene.camera.height_m = within(1.0, 5.0).exp2() * within(1.0, 18.0);
    scene.camera.pitch_deg = within(5.0, 35.0);
    scene.camera.field_of_view_deg = within(60.0, 110.0);
    quality.max_distance_m = quality.max_distance_m.max(30_000.0);
    (quality.view_steps, quality.step_m) = (quality.view_steps.max(96), quality.step_m.clamp(20.0, 300.0));
    scene.weather.size_m = scene.weather.size_m.clamp(8000.0, 20_000.0);
    scene.domain.kind = if scene.domain.kind == DomainKind::Box { DomainKind::Shell } else { scene.domain.kind };
    for map in &mut scene.weather.layers {
        (map.contrast, map.small_share, map.cumulus) = (MapLayer::default().contrast, 0.5, 1.0);
        (map.blend, map.opacity) = (MapBlend::Densest, 1.0);
    }
    // Shapes neither hide the view nor fill it.
    for shape in &mut scene.shapes {
        let far = if shape.role == ShapeRole::Solid { 0.2 } else { 1.0 };
        for side in [&mut shape.width_m, &mut shape.length_m, &mut shape.tall_m] {
            *side = (*side * 0.02 * far).min(2000.0);
        }
        (shape.east_m, shape.south_m) = (shape.east_m * 0.03, -2000.0 - 0.03 * shape.south_m.abs());
        (shape.height_m, shape.blend_m) = (0.15 * shape.height_m.abs(), 0.1 * shape.blend_m);
    }
    for (index, layer) in scene.layers.iter_mut().enumerate() {
        layer.enabled = true;
        (layer.base_m, layer.coverage_offset) = (layer.base_m.clamp(600.0, 1500.0), 0.0);
        layer.top_m = layer.top_m.clamp(layer.base_m + 300.0, layer.base_m + 3000.0);
        layer.density = layer.density.max(0.5);
        *layer = layer.with_given_optics();
        layer.scattering_per_m = layer.scattering_per_m.max(0.01);
        layer.map_scale = layer.map_scale.clamp(0.3, 0.7);
        // Fields as wide as the view show clouds or sky, not both.
        (layer.stretch, layer.lean_m) = (layer.stretch.min(2.0), layer.lean_m.min(5000.0));
        // What clouds and sky share is left to the map: thresholds of noises neither above nor below all of it.
        (layer.perlin.threshold, layer.perlin.multiplier) = (0.5, 3.0);
        (layer.voronoi.threshold, layer.voronoi.multiplier) = (0.4, 2.0);
        if index > 0 {
            // Seldom, or every sky of several layers would be overcast.
            layer.coverage_offset = if layer.reads_map() { -0.45 } else { 0.0 };
        } else {
            layer.form = BodyForm::Map;
            let CloudLayer { edge_softness, shape_strength, detail_strength, .. } = CloudLayer::default();
            (layer.edge_softness, layer.shape_strength) = (edge_softness, shape_strength);
            layer.detail_strength = layer.detail_strength.min(detail_strength);
            layer.sharpness = layer.sharpness.max(0.5);
            if !matches!(layer.model, DensityModel::Profile | DensityModel::Thesis | DensityModel::Uniform) {
                layer.model = DensityModel::Profile;
            }
        }
    }
}

/// What one sky showed.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Light of every pixel, in working units.
    pub light: Vec<[f32; 3]>,
    /// Share of pixels with cloud.
    pub cloudy: f64,
    /// What is wrong with it, in words.
    pub fault: Option<String>,
}

/// The greatest value of a layer's phase function, times what its octaves add.
fn greatest_phase(scene: &Scene, quality: &Quality, layer: &CloudLayer) -> f64 {
    let lobe = |g: f64| {
        let g = g.abs().min(0.99);
        match layer.phase.kind {
            PhaseKind::Isotropic => 1.0,
            PhaseKind::Rayleigh => 1.5,
            // Its k is at most 0.999.
            PhaseKind::Schlick => {
                let k = (1.55 * g - 0.55 * g * g * g).min(0.999);
                (1.0 + k) / (1.0 - k)
            }
            _ => 1.5 * (1.0 + g) / ((1.0 - g) * (1.0 - g)),
        }
    };
    let light = &scene.scattering;
    let greatest_g = f64::from(layer.phase.g.abs().max(layer.phase.back_g.abs()));
    let octave = |o: u32| {
        let power = i32::try_from(o).unwrap_or(0);
        f64::from(light.octave_energy).powi(power) * lobe(greatest_g * f64::from(light.octave_anisotropy).powi(power))
    };
    (0..=quality.octaves).map(octave).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// No pixel of a sky can be brighter than this, in working units.
pub fn brightest(drawn: &Drawn) -> f64 {
    let Drawn { scene, quality, .. } = drawn;
    let lighting = Lighting::new(scene);
    let per_unit = 1.0 / f64::from(lighting.candela_per_unit);
    let units = |lux: glam::Vec3| f64::from(lux.max_element()) * per_unit;
    let (sun, moon, key) = (units(lighting.sun_lux), units(lighting.moon_lux), units(lighting.key_lux));
    // A disc's light comes from its solid angle, brighter in its middle, a crescent up to ten times.
    let disc =
        |light: f64, radius_deg: f32| light / (std::f64::consts::PI * f64::from(radius_deg.to_radians()).sin().powi(2));
    let discs = 2.0 * disc(sun, scene.sun.radius_deg) + 20.0 * disc(moon, scene.moon.radius_deg);
    let glow = 30.0 * f64::from(scene.moon.night_glow) * per_unit;
    // Aerosol sends at most four times the light per steradian, in all orders not more than twice that.
    let plain = f64::from(scene.plain_light.sky_radiance) * f64::from(scene.plain_light.sky_colour.vec().max_element());
    let sky = if scene.plain_light.enabled { plain } else { 8.0 * (sun + moon) + glow };
    let light = &scene.scattering;
    let tint = light.ambient_top.vec().max_element() + light.ambient_bottom.vec().max_element();
    let ambient = f64::from(light.ambient * tint) * sky;
    let clouds = scene.visible_layers().map(|layer| {
        let scattered = key * greatest_phase(scene, quality, layer) * f64::from(layer.phase_gain);
        f64::from(layer.brightness) * (scattered + ambient)
    });
    let shafts = key * f64::from(scene.sunshafts.strength);
    discs + 2.0 * sky + 2.0 * (sun + moon) + clouds.sum::<f64>() + shafts + 0.1 * per_unit
}

/// Renders a sky and looks at every value.
///
/// # Errors
/// [`VerifyError::Render`] and [`VerifyError::Gpu`].
pub fn show(renderer: &mut Renderer, drawn: &Drawn) -> Result<Shown, VerifyError> {
    let Drawn { scene, quality, time_secs } = drawn;
    let frame = Frame { scene, quality, size: SIZE, time_secs: *time_secs, output: Output::Linear, window: None };
    let mut take = || -> Result<_, VerifyError> {
        renderer.forget_history();
        renderer.render(&frame)?;
        Ok((renderer.linear()?.rgba, renderer.clouds()?))
    };
    let (light, clouds) = take()?;
    let bits = |pixels: &[[f32; 4]]| -> Vec<[u32; 4]> { pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect() };
    let again = take()?;
    let bound = brightest(drawn);
    let values = || light.iter().chain(&clouds).flatten();
    let fault = if values().any(|value| !value.is_finite()) {
        Some("a value is not finite".to_owned())
    } else if values().any(|value| *value < 0.0) {
        Some("a value is negative".to_owned())
    } else if clouds.iter().any(|cloud| cloud[3] > 1.0) {
        Some("a transmittance is above 1".to_owned())
    } else if let Some(value) = light.iter().flat_map(|p| &p[..3]).find(|value| f64::from(**value) > bound) {
        Some(format!("{value} is brighter than all lights allow, {bound}"))
    } else if bits(&light) != bits(&again.0) || bits(&clouds) != bits(&again.1) {
        Some("another run gave other bits".to_owned())
    } else {
        None
    };
    let cloudy = clouds.iter().filter(|cloud| 1.0 - cloud[3] > CLOUD).count() as f64 / light.len().max(1) as f64;
    let light = light.iter().map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    Ok(Shown { light, cloudy, fault })
}

/// Sets the parameter of a number to its default; counts them.
struct Reset {
    target: usize,
    at: usize,
    is_changed: bool,
}

impl Reset {
    fn to<T: PartialEq + Clone>(&mut self, value: &mut T, default: &T) {
        if self.at == self.target && value != default {
            *value = default.clone();
            self.is_changed = true;
        }
        self.at += 1;
    }
}

impl Visitor for Reset {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        self.to(value, &info.default);
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        self.to(value, &info.default);
    }

    fn switch(&mut self, info: &Info<bool>, value: &mut bool) {
        self.to(value, &info.default);
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        self.to(index, &info.default);
    }

    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        self.to(value, &info.default);
    }

    fn file(&mut self, _: &Info<FileName>, _: &mut FileName) {}

    fn group(&mut self, _: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        children(self);
    }

    fn list(&mut self, _: &GroupInfo, list: &mut dyn List) {
        if self.at == self.target && list.count() > 1 {
            list.remove(list.count() - 1);
            self.is_changed = true;
        }
        self.at += 1;
        for index in 0..list.count() {
            list.visit_item(index, self);
        }
    }
}

/// The same fault with as many parameters at their defaults as leave it there. `is_faulty` says whether it is.
///
/// # Errors
/// Whatever `is_faulty` reports.
pub fn shrink(
    drawn: &Drawn,
    is_faulty: &mut dyn FnMut(&Drawn) -> Result<bool, VerifyError>,
) -> Result<Drawn, VerifyError> {
    let mut least = drawn.clone();
    let still = Drawn { time_secs: 0.0, ..least.clone() };
    if is_faulty(&still)? {
        least = still;
    }
    // Whole layers first, the last ones before those that they lie over.
    for index in (1..least.scene.layers.len()).rev() {
        let mut next = least.clone();
        next.scene.layers.remove(index);
        if is_faulty(&next)? {
            least = next;
        }
    }
    for index in (1..least.scene.weather.layers.len()).rev() {
        let mut next = least.clone();
        next.scene.weather.layers.remove(index);
        if is_faulty(&next)? {
            least = next;
        }
    }
    let mut target = 0;
    loop {
        let mut next = least.clone();
        let mut reset = Reset { target, at: 0, is_changed: false };
        next.scene.visit(&mut reset);
        next.quality.visit(&mut reset);
        let count = reset.at;
        if reset.is_changed && next.scene.problems().is_empty() && is_faulty(&next)? {
            // And again, as a list may have more to lose.
            least = next;
            continue;
        }
        target += 1;
        if target >= count {
            return Ok(least);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::edit::faults;

    #[test]
    fn draws_are_sound_and_reach_the_edges() {
        let all: Vec<Drawn> = (0..400).map(|index| draw(index, 40)).collect();
        for (index, drawn) in all.iter().enumerate() {
            assert!(drawn.scene.problems().is_empty() && faults(&drawn.scene).is_empty(), "{index}");
        }
        assert_eq!(draw(7, 40), draw(7, 40));
        let haze: Vec<f32> = all.iter().map(|drawn| drawn.scene.air.haze).collect();
        assert!(haze.contains(&0.0) && haze.contains(&20.0) && haze.iter().any(|haze| *haze > 5.0 && *haze < 15.0));
        assert!(all.iter().any(|drawn| drawn.quality.view_steps > 500));
        assert!(all.iter().any(|drawn| drawn.scene.layers.len() == 4));
    }

    #[test]
    fn shrinking_leaves_what_matters() {
        let is_wanted = |drawn: &Drawn| drawn.scene.air.haze > 19.0 && drawn.scene.layers.len() > 1;
        let drawn = (0..).map(|index| draw(index, 40)).find(is_wanted).expect("one");
        let found = shrink(&drawn, &mut |drawn| Ok(drawn.scene.air.haze > 19.0)).expect("no device is asked");
        let haze = found.scene.air.haze;
        let mut plain = Scene::default();
        plain.air.haze = haze;
        assert_eq!((found.scene, found.quality, found.time_secs), (plain, Quality::default(), 0.0));
    }

    #[test]
    fn the_bound_is_above_the_sun_and_follows_it() {
        let drawn = |klx: f32| {
            let mut scene = Scene::default();
            scene.sun.illuminance_klx = klx;
            Drawn { scene, quality: Quality::default(), time_secs: 0.0 }
        };
        assert!(brightest(&drawn(128.0)).is_finite() && brightest(&drawn(128.0)) > 1e4);
    }
}
