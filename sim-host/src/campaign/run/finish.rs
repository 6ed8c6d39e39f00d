//! How a run ends, and what comes after.

use super::*;
use crate::campaign::expected::KNOWN;
use crate::campaign::outcome::Failing;
use crate::world::PlantFault;
use controller_core::angle::wrap;

impl Runner<'_, '_> {
    /// The end, if this is one.
    pub(super) fn ended(&mut self, quiet_s: f64, woken: bool) -> Checked<Option<End>> {
        let report = self.board.report();
        let (state, cause) = (report.state, report.cause);
        let rests = self.rest_s > REST.2;
        let late = quiet_s > 1.5
            && woken
            && self.stop_at.is_none()
            && (self.host.is_content() || self.manner().silent);
        Ok(match state {
            State::Stopped | State::Fault if rests && late => Some(End::Stopped(Why::of(cause))),
            State::Parked
                if rests
                    && quiet_s > 2.5
                    && self.parked_s > SETTLED_S
                    && self.intent != Intent::Follow =>
            {
                self.parked()?;
                Some(End::Parked)
            }
            State::Idle | State::Armed if late && self.intent == Intent::Quiet => {
                rests.then_some(End::Held)
            }
            _ => None,
        })
    }

    /// A base that says it is parked truly is where it should be.
    pub(super) fn parked(&mut self) -> Checked<()> {
        let Intent::Park(goal) = self.intent else {
            return Ok(());
        };
        let pose = self.board.world().truth().pose;
        let off = (
            (pose.x - goal.x).hypot(pose.y - goal.y),
            wrap(pose.theta - goal.theta).abs(),
        );
        let worst = self.outcome.parked.unwrap_or_default();
        self.outcome.parked = Some((worst.0.max(off.0), worst.1.max(off.1)));
        let (shift, turn) = self.lies();
        let core = self.board.task().controller().base();
        let (most_m, most_rad) = self.bounds.parked(core, self.base, self.poses());
        if off.0 > most_m + shift || off.1 > most_rad + turn {
            if self.is_known(Failing::Misplaced) {
                self.failed = Some(Failing::Misplaced);
                return Ok(());
            }
            return Err(format!(
                "parked {:.1} mm and {:.1} mrad off, beyond {:.1} and {:.1}",
                1.0e3 * off.0,
                1.0e3 * off.1,
                1.0e3 * (most_m + shift),
                1.0e3 * (most_rad + turn)
            ));
        }
        Ok(())
    }

    /// Whether a failing is stated for the trouble there is.
    pub(super) fn is_known(&self, failing: Failing) -> bool {
        let injection = self.plan.injection.kind;
        !self.mended
            && KNOWN
                .iter()
                .any(|known| known.injection == injection && known.failing == failing)
    }

    /// What the poses themselves are off by: where they lie a base cannot know better.
    fn lies(&self) -> (f64, f64) {
        let jumps = self
            .active_upsets()
            .filter_map(|injection| match injection.what {
                What::PlantFault(PlantFault::PoseJump { dx, dy, dtheta }) => {
                    Some((dx.hypot(dy), dtheta.abs()))
                }
                _ => None,
            });
        // Of two the later one acts.
        jumps.last().unwrap_or_default()
    }

    /// Everything is mended: the base is reset, armed, goes to a new goal and parks.
    pub(super) fn again(&mut self, watch: &mut impl FnMut(&Tick<'_, '_>)) -> Checked<()> {
        for which in [0, 1] {
            if self.active[which] {
                self.heal(which);
            }
        }
        let since = self.t;
        // Poses come back, batteries recover.
        while self.t < since + 1.5 {
            self.tick(watch)?;
        }
        // What was wrong is over: from here on nothing is to be found any more.
        self.mended = true;
        self.wake();
        let since = self.t;
        loop {
            self.tick(watch)?;
            match self.state() {
                State::Parked if self.parked_s > SETTLED_S && self.host.is_content() => {
                    return self.parked();
                }
                State::Stopped | State::Fault if self.t > since + 0.5 => {
                    return Err(format!(
                        "mended and armed again, it stops: {:?}",
                        self.board.report().cause
                    ));
                }
                _ => {}
            }
            if self.t - since > LONGEST_S.0 {
                return Err("mended and armed again, it does not park".to_owned());
            }
        }
    }
}
