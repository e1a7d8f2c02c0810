//! Painting over the picture.

use std::time::Duration;

use glam::DVec2;

use super::App;
use super::truth::STATUS;
use crate::app::Action;
use crate::app::brush::{BrushError, UnderWay};
use crate::app::viewport::Viewport;
use crate::scene::{MapEdge, Scene};
use crate::ui::{PaintState, Touch};

impl App {
    /// Paints where the brush has touched the picture since the last time. Where a stroke begins, the clouds themselves tell how
    /// high they are there.
    pub(super) fn paint(&mut self) {
        let Some(live) = &mut self.live else { return };
        let state = &mut self.session.ui.paint;
        if state.touches.is_empty() {
            return;
        }
        let document = &mut self.session.document;
        let mut scene = document.preset().scene.clone();
        let (mut done, mut key) = (0, None);
        let mut result = Ok(());
        for touch in &state.touches {
            if !touch.begins && self.session.stroke.is_none() {
                // What is left of a stroke that could not go on.
                done += 1;
                continue;
            }
            if touch.begins {
                match begun(&mut live.viewport, (&scene, document.time_secs()), state, *touch) {
                    Ok(Some(stroke)) => self.session.stroke = Some(stroke),
                    // A shader is being compiled: these touches wait.
                    Ok(None) => {
                        live.draw_within(STATUS);
                        break;
                    }
                    Err(error) => {
                        result = Err(error);
                        break;
                    }
                }
            }
            let Some(stroke) = &mut self.session.stroke else { break };
            let time_secs = document.time_secs();
            result = if touch.is_on_map {
                stroke.touch_map(&mut scene, DVec2::from_array(touch.at.map(f64::from)), time_secs)
            } else {
                let Some(towards) = live.viewport.towards(touch.at) else { break };
                stroke.touch(&mut scene, towards, time_secs)
            }
            .map_err(|error| error.to_string());
            key = stroke.key();
            state.height_m = Some(stroke.height_m);
            done += 1;
            if result.is_err() {
                break;
            }
        }
        if let Err(error) = result {
            self.session.ui.toasts.error(error);
            (done, self.session.stroke) = (state.touches.len(), None);
        }
        state.touches.drain(..done);
        if let Some(key) = key {
            document.apply(&Action::EditScene { key, scene: Box::new(scene) });
        }
        if done > 0 {
            live.draw_within(Duration::ZERO);
        }
    }
}

/// A stroke that begins where the picture or the map was touched; nothing while shaders are compiled that tell how high the
/// picture was.
fn begun(
    viewport: &mut Viewport,
    (scene, time_secs): (&Scene, f64),
    brush: &PaintState,
    touch: Touch,
) -> Result<Option<UnderWay>, String> {
    let mut height_m = None;
    if !touch.is_on_map {
        let Some(picked) = viewport.pick(touch.at).map_err(|error| error.to_string())? else { return Ok(None) };
        height_m = picked.position_m.map(|[_, height, _]| height);
    }
    let mut stroke = UnderWay::begin(scene, height_m, brush).map_err(|error| error.to_string())?;
    if brush.whole && !brush.stirs {
        let place = if touch.is_on_map {
            Some(DVec2::from_array(touch.at.map(f64::from)))
        } else {
            viewport.towards(touch.at).and_then(|towards| stroke.place(scene, towards, time_secs))
        };
        let place = place.ok_or_else(|| BrushError::Clear.to_string())?;
        let cloud =
            viewport.whole_cloud((scene, time_secs), stroke.layer(), place).map_err(|error| error.to_string())?;
        let cloud = cloud.ok_or_else(|| BrushError::Clear.to_string())?;
        stroke.take_whole(&cloud, (place, brush.strength), scene.weather.edge == MapEdge::Repeat);
    }
    Ok(Some(stroke))
}
