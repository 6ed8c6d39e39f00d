//! Where on a path a robot is, for laws that follow paths and not times.

use crate::law::{Now, Path};
use controller_core::reference::Reference;
use controller_core::types::Pose;

/// The sample next to the robot, and the one ahead of it; they never go back.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Progress {
    at: usize,
    ahead: usize,
}

/// A path as seen from a robot on it.
pub(crate) struct View {
    /// A sample so far ahead.
    pub(crate) ahead: Reference<f32>,
    /// The end.
    pub(crate) goal: Pose<f32>,
    /// The path's speed where the robot is; a moment later where it stands.
    pub(crate) speed: f32,
    /// The sample ahead is the last one.
    pub(crate) ends: bool,
}

/// A path that stands is looked at so far ahead for its speed \[samples\].
const LEAD: usize = 30;

impl Progress {
    /// The path from where the robot is on it.
    pub(crate) fn view(&mut self, now: &Now, path: &Path<'_>, lookahead: f32) -> Option<View> {
        let far = |at: usize| {
            path.samples.get(at).map(|sample| {
                let (dx, dy) = (sample.pose().x - now.pose.x, sample.pose().y - now.pose.y);
                dx * dx + dy * dy
            })
        };
        let mut nearest = far(self.at)?;
        while let Some(next) = far(self.at + 1)
            && next <= nearest
        {
            nearest = next;
            self.at += 1;
        }
        if self.ahead < self.at {
            self.ahead = self.at;
        }
        let reach = lookahead * lookahead;
        while far(self.ahead + 1).is_some() && far(self.ahead).is_some_and(|way| way < reach) {
            self.ahead += 1;
        }
        let last = path.samples.len().saturating_sub(1);
        let later = path.samples.get(if self.at + LEAD < last {
            self.at + LEAD
        } else {
            last
        })?;
        let here = path.samples.get(self.at)?;
        let (v, w) = (here.twist().linear, later.twist().linear);
        Some(View {
            ahead: *path.samples.get(self.ahead)?,
            goal: *path.samples.last()?.pose(),
            speed: if w.abs() > v.abs() { w } else { v },
            ends: self.ahead == last,
        })
    }
}
