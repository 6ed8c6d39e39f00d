//! A base that says it is parked truly is where it should be; one that gets no poses is there as far as it can know.

use super::Checked;
use super::timeline::Timeline;
use crate::campaign::bounds::{Bounds, stays_parked};
use crate::closed_loop::Board;
use crate::mission::BaseSpec;
use controller_core::angle::wrap;
use controller_core::types::Pose;

#[derive(Default)]
pub(super) struct ParkedCheck {
    /// Largest distance from the goal, and largest heading error \[m, rad\].
    pub(super) worst: Option<(f64, f64)>,
}

impl ParkedCheck {
    pub(super) fn check(
        &mut self,
        goal: &Pose<f64>,
        base: &BaseSpec,
        board: &Board<'_>,
        bounds: &Bounds,
        timeline: &Timeline<'_>,
    ) -> Checked<()> {
        let pose = board.world().truth().pose;
        let off = |pose: &Pose<f64>| {
            (
                (pose.x - goal.x).hypot(pose.y - goal.y),
                wrap(pose.theta - goal.theta).abs(),
            )
        };
        let truly = off(&pose);
        let worst = self.worst.unwrap_or_default();
        self.worst = Some((worst.0.max(truly.0), worst.1.max(truly.1)));
        let (shift, turn) = timeline.pose_offset();
        let carried = timeline.carried(base);
        let (shift, turn) = (shift + carried.0, turn + carried.1);
        let core = board.task().controller().base();
        let own = board.report().measured.map(|measured| measured.pose.cast());
        let (off, whose, (most_m, most_rad)) = match (core.localisation().params().fusion, own) {
            (None, Some(own)) => (off(&own), " by its own pose", stays_parked(core)),
            _ => (truly, "", bounds.parked(core, base, timeline.poses())),
        };
        if off.0 > most_m + shift || off.1 > most_rad + turn {
            return Err(format!(
                "parked {:.1} mm and {:.1} mrad off{whose}, beyond {:.1} and {:.1}",
                1.0e3 * off.0,
                1.0e3 * off.1,
                1.0e3 * (most_m + shift),
                1.0e3 * (most_rad + turn)
            ));
        }
        Ok(())
    }
}
