//! From what the mouse did over the picture to strokes on the weather map.

use std::sync::Arc;

use glam::{DVec2, Vec3};

use super::whole::WholeCloud;
use crate::render::uniforms::map_place;
use crate::scene::{Brush, CloudLayer, FlowKind, MAX_DABS, MAX_LAYERS, MapEdge, MapLayer, MapSource, Scene, Stroke};
use crate::ui::PaintState;

/// Dabs lie so many radii apart.
const SPACING: f64 = 0.25;
/// The same where a whole cloud is taken along: it follows the pointer.
const CLOSE: f64 = 0.04;
/// How much farther than a whole cloud the brush reaches that moves it, or lets it grow or shrink: over the rest it fades.
const BESIDE: f64 = 1.3;
/// Speeds of flows at no and at full strength, in metres per second.
const SPEEDS: [f32; 2] = [2.0, 40.0];
/// Times after which a flow that was drawn begins anew, in seconds.
const TURNS: [f32; 2] = [600.0, 3600.0];

/// Why nothing was painted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum BrushError {
    /// No layer is where the map says.
    #[error("No layer is placed by the weather map, so there is nothing to paint; choose another density model")]
    Mapless,
    /// All layers that are have no cloud.
    #[error("No layer that the weather map places holds cloud; raise the coverage, or switch a layer on")]
    Hidden,
    /// The list of map layers is full.
    #[error("The weather map has {MAX_LAYERS} layers already; remove one, and painting gets one of its own")]
    Full,
    /// Whole clouds are wanted, and there is none.
    #[error("No cloud stands there; click on one, or switch whole clouds off")]
    Clear,
    /// Too many dabs.
    #[error("{MAX_DABS} dabs are painted already; export the weather map and use it as an image to go on")]
    Worn,
}

/// A stroke that is under way.
#[derive(Clone, Debug)]
pub(super) struct UnderWay {
    /// Height above the sea of what was first touched.
    pub(super) height_m: f32,
    layer: usize,
    map: usize,
    does: Does,
    /// Whether one touch is all of it.
    is_whole: bool,
    /// From where it is touched to where it works: to the middle of the cloud that it takes along.
    offset: DVec2,
    /// The last dab, or where a flow begins, not wrapped into the map.
    last: Option<DVec2>,
    /// The last touch of the map itself.
    touched: Option<DVec2>,
    /// Radii between dabs.
    spacing: f64,
}

/// What is being made.
#[derive(Clone, Debug)]
enum Does {
    /// A stroke, as it begins, and how many there are with it: with another number it was taken back, with none it has no dab yet.
    Stroke { begun: Box<Stroke>, count: usize },
    /// A flow, as it was last drawn, and whether it is on the map: without a drag there is none.
    Flow { layer: Box<MapLayer>, is_laid: bool },
}

impl UnderWay {
    /// Begins a stroke or a flow at a height in a scene. With its first dab a stroke gets a painted layer on top of the map if there
    /// is none, a flow always one of its own.
    pub(super) fn begin(scene: &Scene, height_m: Option<f32>, brush: &PaintState) -> Result<Self, BrushError> {
        let layers: Vec<_> = scene.numbered_layers().filter(|(_, layer)| layer.reads_map()).collect();
        let at_height = |height: f32| layers.iter().find(|(_, layer)| (layer.base_m..=layer.top_m).contains(&height));
        let is_placed = scene.layers.iter().any(CloudLayer::reads_map);
        let none = if is_placed { BrushError::Hidden } else { BrushError::Mapless };
        let found = height_m.and_then(at_height).or(layers.first()).ok_or(none)?;
        let (layer, base_m, top_m) = (found.0, found.1.base_m, found.1.top_m);
        let scale_m = scene.weather.size_m * found.1.map_scale;
        let maps = &scene.weather.layers;
        let height = height_m.unwrap_or(base_m).clamp(base_m, top_m);
        let is_painted = maps.last().is_some_and(|map| map.source == MapSource::Painted);
        let map = if is_painted && !brush.stirs { maps.len() - 1 } else { maps.len() };
        if map >= MAX_LAYERS {
            return Err(BrushError::Full);
        }
        let does = if brush.stirs {
            Does::Flow { layer: Box::new(flow(brush, scale_m)), is_laid: false }
        } else {
            Does::Stroke { begun: Box::new(stroke(brush, scale_m)), count: 0 }
        };
        Ok(Self {
            height_m: height,
            layer,
            map,
            does,
            is_whole: false,
            offset: DVec2::ZERO,
            last: None,
            touched: None,
            spacing: SPACING,
        })
    }

    /// The cloud layer that it works on, by its index among all.
    pub(super) fn layer(&self) -> usize {
        self.layer
    }

    /// Makes it work on all of the cloud at a place: with the first touch, but for a brush that moves, which takes it along.
    #[allow(clippy::cast_possible_truncation, reason = "places on the map")]
    pub(super) fn take_whole(&mut self, cloud: &WholeCloud, (place, strength): (DVec2, f32), is_endless: bool) {
        let Does::Stroke { begun, .. } = &mut self.does else { return };
        // Places about the middle are moved alike as far as the cloud reaches.
        let strength = if begun.brush == Brush::Move { 1.0 } else { strength.clamp(0.0, 1.0) };
        let (radius, places, passes) = match begun.brush {
            // As many as a stroke through its middle has.
            Brush::Grow | Brush::Shrink => {
                (BESIDE * cloud.radius, vec![cloud.middle; (2.0 / SPACING) as usize], SPACING)
            }
            Brush::Move => (BESIDE * cloud.radius, Vec::new(), 1.0),
            // Dabs that overlap by this share the strength.
            _ => (1.5 * cloud.spacing, cloud.places.clone(), 1.0 / 3.0),
        };
        begun.radius = (radius as f32).clamp(1e-3, 0.5);
        begun.strength = 1.0 - (1.0 - strength).powf(passes as f32);
        if matches!(begun.brush, Brush::Grow | Brush::Shrink | Brush::Move) {
            begun.softness = 1.0 - 1.0 / BESIDE as f32;
        }
        let on_map = places.into_iter().map(|place| if is_endless { place - place.floor() } else { place });
        let is_there = |place: &DVec2| place.cmpge(DVec2::ZERO).all() && place.cmple(DVec2::ONE).all();
        begun.dabs = on_map.filter(is_there).map(|place| [place.x as f32, place.y as f32]).collect();
        self.is_whole = begun.brush != Brush::Move;
        self.spacing = CLOSE;
        self.offset = if self.is_whole { DVec2::ZERO } else { cloud.middle - place };
    }

    /// Where on the weather map a direction from the eye meets its height, in edges of the map from its corner.
    pub(super) fn place(&self, scene: &Scene, towards: Vec3, time_secs: f64) -> Option<DVec2> {
        let there = scene.place_at_height(towards, self.height_m)?;
        let camera = &scene.camera;
        let [east, south] =
            [f64::from(camera.east_m) + f64::from(there.x), f64::from(camera.south_m) + f64::from(there.z)];
        let layer = scene.layers.get(self.layer)?;
        Some(map_place(scene, layer, [east, f64::from(self.height_m), south], time_secs))
    }

    /// The parameter that it edits, if it has edited any.
    pub(super) fn key(&self) -> Option<String> {
        let parameter = match self.does {
            Does::Stroke { count: 0, .. } | Does::Flow { is_laid: false, .. } => return None,
            Does::Stroke { .. } => "strokes",
            Does::Flow { .. } => "flow_begun_secs",
        };
        Some(format!("weather.layers.{}.{parameter}", self.map))
    }

    /// Draws it on to where a direction from the eye meets its height.
    pub(super) fn touch(&mut self, scene: &mut Scene, towards: Vec3, time_secs: f64) -> Result<(), BrushError> {
        let Some(place) = self.place(scene, towards, time_secs) else { return Ok(()) };
        self.go_on(scene, place, time_secs)
    }

    /// Draws it on to a place on the weather map, in edges of the map from its corner.
    pub(super) fn touch_map(&mut self, scene: &mut Scene, place: DVec2, time_secs: f64) -> Result<(), BrushError> {
        // Of a map that repeats that place which is nearest: the eye, about which it is shown, may have gone over its edge.
        let is_endless = scene.weather.edge == MapEdge::Repeat;
        let ahead = self.touched.filter(|_| is_endless).map_or(DVec2::ZERO, |before| (place - before).round());
        self.touched = Some(place - ahead);
        self.go_on(scene, place - ahead, time_secs)
    }

    fn go_on(&mut self, scene: &mut Scene, place: DVec2, time_secs: f64) -> Result<(), BrushError> {
        let place = place + self.offset;
        let is_endless = scene.weather.edge == MapEdge::Repeat;
        let is_on_map = is_endless || (place.cmpge(DVec2::ZERO).all() && place.cmple(DVec2::ONE).all());
        if self.last.is_none() && !is_on_map {
            return Ok(());
        }
        let maps = &mut scene.weather.layers;
        let count = match &mut self.does {
            Does::Flow { .. } => {
                self.stir(scene, place, time_secs);
                return Ok(());
            }
            Does::Stroke { begun, count: count @ 0 } => {
                *count = lay(maps, self.map, begun)?;
                *count
            }
            Does::Stroke { count, .. } => *count,
        };
        if self.is_whole {
            return Ok(());
        }
        // Or it was taken back.
        let map = maps.get_mut(self.map).filter(|map| map.strokes.0.len() == count);
        map.map_or(Ok(()), |map| self.dabs(map, place, is_endless))
    }

    /// Draws a flow from where it began to a place.
    fn stir(&mut self, scene: &mut Scene, place: DVec2, time_secs: f64) {
        let begin = *self.last.get_or_insert(place);
        let way = place - begin;
        // A slip over the horizon is no flow across the whole map.
        if way == DVec2::ZERO || way.length() > 2.0 {
            return;
        }
        let Does::Flow { layer: flow, is_laid } = &mut self.does else { return };
        let (maps, size_m) = (&mut scene.weather.layers, scene.weather.size_m);
        let is_as_left = if *is_laid { maps.get(self.map) == Some(&**flow) } else { maps.len() == self.map };
        // It was taken back, or the map is another.
        if !is_as_left {
            return;
        }
        drawn(flow, (begin, way), (size_m, time_secs));
        maps.truncate(self.map);
        maps.push((**flow).clone());
        *is_laid = true;
    }

    /// Dabs from the last one to a place; they lie evenly on the way.
    #[allow(clippy::cast_possible_truncation, reason = "places on the map, within it")]
    fn dabs(&mut self, map: &mut MapLayer, place: DVec2, is_endless: bool) -> Result<(), BrushError> {
        let room = MAX_DABS.saturating_sub(map.strokes.dabs());
        if room == 0 {
            return Err(BrushError::Worn);
        }
        let Some(stroke) = map.strokes.0.last_mut().map(Arc::make_mut) else { return Ok(()) };
        let spacing = self.spacing * f64::from(stroke.radius);
        let most = stroke.dabs.len() + room;
        let mut dab = |place: DVec2| {
            let is_on_map = place.cmpge(DVec2::ZERO).all() && place.cmple(DVec2::ONE).all();
            if (is_endless || is_on_map) && stroke.dabs.len() < most {
                let wrapped = if is_endless { place - place.floor() } else { place };
                stroke.dabs.push([wrapped.x as f32, wrapped.y as f32]);
            }
        };
        let Some(last) = self.last else {
            dab(place);
            self.last = Some(place);
            return Ok(());
        };
        // A slip over the horizon is no line across the whole map.
        let way = place - last;
        if way.length() > 2.0 {
            self.last = Some(place);
            return Ok(());
        }
        let count = (way.length() / spacing).floor();
        let mut at = last;
        for _ in 0..count as u32 {
            at += way.normalize_or_zero() * spacing;
            dab(at);
        }
        self.last = Some(at);
        Ok(())
    }
}

/// Lays a stroke, without dabs but for those of a whole cloud, on a painted layer, which is made on top of the map if it is not there; how many strokes it has then.
fn lay(maps: &mut Vec<MapLayer>, map: usize, begun: &Stroke) -> Result<usize, BrushError> {
    let dabs = begun.dabs.len().max(1);
    if maps.get(map).is_some_and(|map| map.strokes.dabs() + dabs > MAX_DABS) {
        return Err(BrushError::Worn);
    }
    if maps.len() == map {
        maps.push(MapLayer { source: MapSource::Painted, ..MapLayer::default() });
    }
    let Some(strokes) = maps.get_mut(map).map(|map| &mut map.strokes.0) else { return Ok(0) };
    strokes.push(Arc::new(begun.clone()));
    Ok(strokes.len())
}

/// A stroke that is about to be painted.
#[allow(clippy::cast_possible_truncation, reason = "a constant below 1")]
fn stroke(brush: &PaintState, scale_m: f32) -> Stroke {
    // One pass goes so far, but what is moved follows each dab.
    let passes = if brush.brush == Brush::Move { 1.0 } else { SPACING as f32 };
    Stroke {
        brush: brush.brush,
        kind: brush.kind,
        radius: (brush.radius_m / scale_m).clamp(1e-3, 0.5),
        strength: 1.0 - (1.0 - brush.strength.clamp(0.0, 1.0)).powf(passes),
        softness: brush.softness,
        amount: brush.amount,
        dabs: Vec::new(),
    }
}

/// A flow that is about to be drawn.
fn flow(brush: &PaintState, scale_m: f32) -> MapLayer {
    let [slow, fast] = SPEEDS;
    MapLayer {
        source: MapSource::Flow,
        flow: brush.flow,
        flow_radius: (brush.radius_m / scale_m).clamp(0.01, 0.5),
        flow_mps: slow + (fast - slow) * brush.strength.clamp(0.0, 1.0),
        ..MapLayer::default()
    }
}

/// A flow from a place on the map by a way: at this time it has carried the fastest of its cloud so far.
#[allow(clippy::cast_possible_truncation, reason = "places on the map, to single precision")]
fn drawn(map: &mut MapLayer, (begin, way): (DVec2, DVec2), (size_m, time_secs): (f32, f64)) {
    let on_map = begin - begin.floor();
    (map.flow_east, map.flow_south) = (on_map.x as f32, on_map.y as f32);
    map.flow_heading_deg = (way.x.atan2(-way.y).to_degrees().rem_euclid(360.0) as f32).min(360.0);
    // To the right, vortices turn clockwise.
    let turns_back = map.flow == FlowKind::Vortex && way.x < 0.0;
    map.flow_mps = if turns_back { -map.flow_mps.abs() } else { map.flow_mps.abs() };
    map.flow_begun_secs = (way.length() as f32 * size_m / map.flow_mps.abs().max(0.1)).min(100_000.0);
    map.flow_secs = map.flow_begun_secs.clamp(TURNS[0], TURNS[1]);
    map.flow_at_secs = (time_secs as f32).clamp(-1e9, 1e9);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::DensityModel;

    #[test]
    fn a_flow_carries_cloud_from_where_it_begins_to_where_it_ends() {
        let stirred = |flow: FlowKind, to_the: f32| {
            let mut scene = Scene::default();
            // Whatever part of the map the layer shows.
            scene.layers[0].map_scale = 0.5;
            let brush = PaintState { stirs: true, flow, radius_m: 2400.0, strength: 0.5, ..PaintState::default() };
            let mut stroke = UnderWay::begin(&scene, Some(1500.0), &brush).expect("the sky has a map");
            for side in [0.0, 0.1 * to_the, 0.3 * to_the] {
                stroke.touch(&mut scene, Vec3::new(side, 0.5, -1.0).normalize(), 20_000.0).expect("there is room");
                // A press alone is no flow.
                let is_laid = side != 0.0;
                assert_eq!((stroke.key().is_some(), scene.weather.layers.len()), (is_laid, 1 + usize::from(is_laid)));
            }
            assert_eq!(stroke.key().as_deref(), Some("weather.layers.1.flow_begun_secs"));
            assert_eq!((scene.weather.layers.len(), scene.weather.layers[1].flow_at_secs), (2, 20_000.0));
            assert!(scene.problems().is_empty(), "{:?}", scene.problems());
            (scene.weather.layers.pop().expect("a flow"), scene.weather.size_m)
        };
        let (band, size_m) = stirred(FlowKind::Band, 1.0);
        assert_eq!((band.source, band.flow), (MapSource::Flow, FlowKind::Band));
        assert!((band.flow_heading_deg - 90.0).abs() < 0.5, "towards {}", band.flow_heading_deg);
        assert!((band.flow_radius * size_m * 0.5 - 2400.0).abs() < 1.0);
        // The height above the eye is twice the way ahead; the way aside is 0.3 of that.
        // In a map of half the scale.
        let carried_m = band.flow_mps * band.flow_begun_secs * 0.5;
        let eye_m = Scene::default().camera.height_m;
        assert!((carried_m - 0.6 * (1500.0 - eye_m)).abs() < 5.0, "{carried_m} m");
        let (clockwise, _) = stirred(FlowKind::Vortex, 1.0);
        let (back, _) = stirred(FlowKind::Vortex, -1.0);
        assert!(clockwise.flow_mps > 0.0 && back.flow_mps == -clockwise.flow_mps);
    }

    fn painted(touches: &[Vec3]) -> Scene {
        let mut scene = Scene::default();
        let brush = PaintState { brush: Brush::Erase, radius_m: 240.0, ..PaintState::default() };
        let mut stroke = UnderWay::begin(&scene, Some(1500.0), &brush).expect("the sky has a map");
        for towards in touches {
            stroke.touch(&mut scene, *towards, 0.0).expect("there is room");
        }
        scene
    }

    #[test]
    fn dabs_lie_evenly_whatever_the_mouse_does() {
        let straight = [Vec3::new(0.0, 0.5, -1.0).normalize(), Vec3::new(1.0, 0.5, -1.0).normalize()];
        let slow: Vec<Vec3> = (0..=100).map(|i| straight[0].lerp(straight[1], i as f32 / 100.0).normalize()).collect();
        for touches in [&straight[..], &slow] {
            let scene = painted(touches);
            let map = scene.weather.layers.last().expect("a painted one");
            let dabs = &map.strokes.0[0].dabs;
            assert_eq!((map.source, map.strokes.0.len()), (MapSource::Painted, 1));
            assert!(dabs.len() > 20, "{dabs:?}");
            for pair in dabs.windows(2) {
                let apart = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]).map(|apart| apart - apart.round());
                let metres = apart[0].hypot(apart[1]) * scene.weather.size_m;
                assert!((metres - 60.0).abs() < 1.0, "{metres} m apart");
            }
        }
    }

    #[test]
    fn the_map_is_painted_where_it_is_touched() {
        let mut scene = Scene::default();
        // Whatever the wind has done with it.
        let brush = PaintState { radius_m: 480.0, ..PaintState::default() };
        let mut stroke = UnderWay::begin(&scene, None, &brush).expect("the sky has a map");
        for place in [DVec2::new(0.97, 0.5), DVec2::new(0.02, 0.5)] {
            stroke.touch_map(&mut scene, place, 5000.0).expect("there is room");
        }
        let dabs = &scene.weather.layers[1].strokes.0[0].dabs;
        assert_eq!(dabs.first(), Some(&[0.97, 0.5]));
        // A quarter of a fiftieth apart, over the edge of a map that repeats.
        assert_eq!(dabs.len(), 11, "{dabs:?}");
        // As when the eye goes over the edge, about which the map is shown.
        assert!((dabs[10][0] - 0.02).abs() < 1e-4 && dabs.iter().all(|dab| dab[1] == 0.5), "{dabs:?}");
    }

    #[test]
    fn a_whole_cloud_is_worked_on_with_one_touch() {
        let places = [[0.98, 0.5], [0.99, 0.5], [1.0, 0.5], [1.01, 0.5]].map(DVec2::from_array);
        let cloud = WholeCloud { middle: places[1], radius: 0.03, places: places.to_vec(), spacing: 0.01 };
        let stroke = |brush, is_endless| {
            let mut scene = Scene::default();
            let brush = PaintState { brush, strength: 0.784, ..PaintState::default() };
            let mut stroke = UnderWay::begin(&scene, None, &brush).expect("the sky has a map");
            stroke.take_whole(&cloud, (DVec2::new(0.98, 0.51), brush.strength), is_endless);
            for place in [DVec2::new(0.98, 0.51), DVec2::new(0.89, 0.51)] {
                stroke.touch_map(&mut scene, place, 0.0).expect("there is room");
            }
            assert!(scene.problems().is_empty(), "{:?}", scene.problems());
            (*scene.weather.layers[1].strokes.0[0]).clone()
        };
        let erased = stroke(Brush::Erase, true);
        let xs: Vec<f32> = erased.dabs.iter().map(|dab| (dab[0] * 100.0).round()).collect();
        assert_eq!(xs, [98.0, 99.0, 0.0, 1.0], "wrapped, and no more of them");
        assert!((erased.radius - 0.015).abs() < 1e-6 && (erased.strength - 0.4).abs() < 1e-3, "{erased:?}");
        assert_eq!(stroke(Brush::Erase, false).dabs.len(), 3, "one lies beyond the edge");
        let grown = stroke(Brush::Grow, true);
        assert!(grown.dabs.len() == 8 && grown.dabs.iter().all(|dab| *dab == [0.99, 0.5]), "{grown:?}");
        let moved = stroke(Brush::Move, true);
        assert!((moved.radius - 0.039).abs() < 1e-6 && moved.dabs.len() > 5, "it is taken along: {moved:?}");
        assert_eq!((moved.dabs[0], moved.strength), ([0.99, 0.5], 1.0), "by its middle, wherever it was touched");
    }

    #[test]
    fn what_cannot_be_painted_is_said() {
        let brush = PaintState::default();
        let mut mapless = Scene::default();
        mapless.layers[0].model = DensityModel::Shapes;
        assert_eq!(UnderWay::begin(&mapless, None, &brush).err(), Some(BrushError::Mapless));
        let mut clear = Scene::default();
        clear.weather.coverage = 0.0;
        assert_eq!(UnderWay::begin(&clear, None, &brush).err(), Some(BrushError::Hidden));
        let mut full = Scene::default();
        full.weather.layers.resize(MAX_LAYERS, MapLayer::default());
        assert_eq!(UnderWay::begin(&full, None, &brush).err(), Some(BrushError::Full));
        let down = painted(&[Vec3::NEG_Y]);
        assert_eq!(down, Scene::default(), "nothing is up there when looking down from below");
    }

    #[test]
    fn no_touch_paints_more_than_is_loaded_again() {
        let mut scene = Scene::default();
        let brush = PaintState { radius_m: 50.0, ..PaintState::default() };
        let mut stroke = UnderWay::begin(&scene, Some(1500.0), &brush).expect("the sky has a map");
        let towards = [Vec3::new(-1.0, 0.5, -1.0).normalize(), Vec3::new(1.0, 0.5, -1.0).normalize()];
        let result = (0..200_000).try_for_each(|i| stroke.touch(&mut scene, towards[i % 2], 0.0));
        assert_eq!(result, Err(BrushError::Worn));
        assert_eq!(scene.weather.layers[1].strokes.dabs(), MAX_DABS);
    }

    #[test]
    fn the_painting_is_in_the_preset() {
        use crate::scene::Preset;
        let scene = painted(&[Vec3::new(0.0, 0.5, -1.0).normalize(), Vec3::new(0.4, 0.5, -1.0).normalize()]);
        let preset = Preset::new("Painted", scene);
        let again = Preset::from_ron(&preset.to_ron(), "painted").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(again, preset);
        let broken = preset.to_ron().replacen("radius 0.01", "radius -3", 1);
        let error = Preset::from_ron(&broken, "painted.ron").expect_err("a radius below 0").to_string();
        assert!(error.contains("weather.layers.1.strokes") && error.contains("painted.ron:"), "{error}");
    }
}
