//! Holds a frame's time by moving along a measured front of settings; motion is never dropped.

use std::collections::VecDeque;

use crate::scene::Quality;
use crate::ui::{LabView, Phase};

/// Frames that a decision rests on.
const FRAMES: usize = 5;
/// Frames over the budget by this factor ask for a cheaper setting.
const OVER: f64 = 1.08;
/// How much of the budget the next dearer setting may be expected to take.
const ROOM: f64 = 0.92;

/// Where on the front the window is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Governor {
    /// Settings with their measured cost, from the cheapest to the most accurate.
    front: Vec<(String, Quality, f64)>,
    at: usize,
    /// Times of the last frames with the present setting, in milliseconds.
    recent: VecDeque<f64>,
}

impl Governor {
    /// Takes over the front of what was measured, once that is at its end. The setting stays if it is still on the front.
    pub(crate) fn follow(&mut self, view: &LabView) {
        if !matches!(view.phase, Phase::Ended { .. }) {
            return;
        }
        let front: Vec<(String, Quality, f64)> = view
            .front()
            .into_iter()
            .map(|(setting, cost)| (setting.name.clone(), setting.quality.clone(), cost))
            .collect();
        if front.is_empty() || front == self.front {
            return;
        }
        let own = self.front.get(self.at).map(|(_, quality, _)| quality);
        let place = own.and_then(|own| front.iter().position(|(_, quality, _)| quality == own));
        self.at = place.unwrap_or(front.len() / 2);
        self.front = front;
        self.recent.clear();
    }

    /// The document's quality with what the front decides: how the march is computed. Size, order and share of pixels
    /// stay the user's.
    pub(crate) fn quality(&self, own: &Quality) -> Quality {
        let Some((_, governed, _)) = self.front.get(self.at) else { return own.clone() };
        own.with_march_of(governed)
    }

    /// Takes in a finished frame; returns whether the setting changes.
    pub(crate) fn frame(&mut self, millis: f64, budget_ms: f64) -> bool {
        self.recent.push_back(millis);
        if self.recent.len() < FRAMES {
            return false;
        }
        let mut sorted: Vec<f64> = self.recent.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let median = sorted[sorted.len() / 2];
        let cost = |at: usize| self.front.get(at).map(|(_, _, cost)| *cost);
        let next = if median > OVER * budget_ms {
            self.at.checked_sub(1)
        } else {
            // What is not the march costs the same with every setting; so the ratio of marches is the most it can grow by.
            let dearer = cost(self.at + 1).zip(cost(self.at)).map(|(next, now)| median * next / now);
            dearer.is_some_and(|expected| expected < ROOM * budget_ms).then_some(self.at + 1)
        };
        match next {
            Some(next) => {
                self.at = next;
                self.recent.clear();
                true
            }
            None => {
                self.recent.pop_front();
                false
            }
        }
    }

    /// What it says of itself.
    pub(crate) fn said(&self) -> Option<String> {
        let (name, ..) = self.front.get(self.at)?;
        Some(format!("{name} ({} of {})", self.at + 1, self.front.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::Measured;

    fn governor() -> Governor {
        let setting = |light_steps: u32, cost: f64, is_on_front: bool| Measured {
            name: format!("light_steps={light_steps}"),
            quality: Quality { light_steps, ..Quality::default() },
            cost_ms: Some(cost),
            error: 1.0 / f64::from(light_steps),
            std_error: None,
            reads: 1.0,
            is_on_front,
            is_current: false,
        };
        let view = LabView {
            settings: vec![
                setting(16, 80.0, true),
                setting(2, 20.0, true),
                setting(9, 90.0, false),
                setting(4, 40.0, true),
            ],
            phase: Phase::Ended { is_partial: false },
            ..LabView::default()
        };
        let mut governor = Governor::default();
        governor.follow(&view);
        governor
    }

    /// Frames of a machine on which a frame takes twice the measured march and ten milliseconds.
    fn settled(budget_ms: f64) -> (u32, usize) {
        let mut governor = governor();
        let mut changes = 0;
        for _ in 0..200 {
            let steps = governor.quality(&Quality::default()).light_steps;
            let cost = match steps {
                2 => 20.0,
                4 => 40.0,
                _ => 80.0,
            };
            changes += usize::from(governor.frame(2.0 * cost + 10.0, budget_ms));
        }
        (governor.quality(&Quality::default()).light_steps, changes)
    }

    #[test]
    fn it_takes_the_most_accurate_setting_that_keeps_the_budget_and_stays() {
        assert_eq!(settled(1000.0), (16, 1), "there is time for all");
        assert_eq!(settled(100.0), (4, 0));
        assert_eq!(settled(60.0).0, 2);
        assert_eq!(settled(5.0).0, 2, "nothing keeps it; the cheapest is nearest");
        let (_, changes) = settled(172.0);
        assert!(changes <= 1, "it does not swing: {changes}");
    }

    #[test]
    fn the_users_own_settings_stay() {
        let own = Quality { pixel_samples: 7, resolution_scale: 0.5, light_steps: 99, ..Quality::default() };
        let governed = governor().quality(&own);
        assert_eq!((governed.pixel_samples, governed.resolution_scale, governed.light_steps), (7, 0.5, 4));
        assert_eq!(Governor::default().quality(&own), own, "nothing measured, nothing governed");
    }
}
