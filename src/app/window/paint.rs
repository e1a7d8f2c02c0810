//! Painting over the picture.

use std::time::Duration;

use glam::DVec2;

use super::App;
use super::truth::STATUS;
use crate::app::Action;
use crate::app::brush::UnderWay;
use crate::app::viewport::Viewport;
use crate::render::RenderError;

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
                let picked = if touch.is_on_map { Ok(Some(None)) } else { height_at(&mut live.viewport, touch.at) };
                let height_m = match picked {
                    Ok(Some(height_m)) => height_m,
                    // A shader is being compiled: these touches wait.
                    Ok(None) => {
                        live.draw_within(STATUS);
                        break;
                    }
                    Err(error) => {
                        self.session.ui.toasts.error(error);
                        state.touches.clear();
                        self.session.stroke = None;
                        return;
                    }
                };
                match UnderWay::begin(&scene, height_m, state) {
                    Ok(stroke) => self.session.stroke = Some(stroke),
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
            };
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

/// Height above the sea of what the picture shows at a point, if it shows cloud or ground; nothing while shaders are compiled.
fn height_at(viewport: &mut Viewport, at: [f32; 2]) -> Result<Option<Option<f32>>, RenderError> {
    Ok(viewport.pick(at)?.map(|picked| picked.position_m.map(|[_, height, _]| height)))
}
