//! The light meter beside the window: the histogram, and exposure that follows it.

use std::time::{Duration, Instant};

use super::{Action, App};

/// Shortest time between two measurements.
const PERIOD: Duration = Duration::from_millis(100);
/// Exposure that is off by less stays as it is, in stops.
const STEADY_EV: f32 = 0.1;

impl App {
    /// Measures the last picture, if anybody wants to know and `is_new` or nothing is known yet. Says when to come again.
    pub(super) fn meter(&mut self, is_new: bool) -> Option<Instant> {
        let live = self.live.as_mut()?;
        let state = &mut self.session.ui.histogram;
        if !state.is_open {
            state.light = None;
            return None;
        }
        self.is_metered &= !is_new;
        if self.is_metered && state.light.is_some() {
            return None;
        }
        let again = Some(Instant::now() + PERIOD);
        if self.metered.elapsed() < PERIOD {
            return again;
        }
        match live.viewport.light_histogram() {
            Ok(Some(light)) => {
                self.metered = Instant::now();
                self.is_metered = true;
                state.light = Some(light);
                live.draw_within(Duration::ZERO);
            }
            // Another picture is under way, or the shader is being compiled.
            Ok(None) => return again,
            Err(error) => {
                (state.is_open, state.is_auto) = (false, false);
                self.session.ui.toasts.error(error);
                return None;
            }
        }
        let document = &mut self.session.document;
        let has_keys = document.animation().track("display.exposure_ev").is_some();
        if let Some(stops) = state.correction(document).filter(|stops| stops.abs() > STEADY_EV)
            && state.is_auto
            && !has_keys
        {
            document.apply(&Action::MeterExposure(stops));
        }
        None
    }
}
