//! The time that counts towards a deadline, and what was found within it.

use super::Checked;
use super::timeline::Timeline;
use crate::campaign::check;
use crate::campaign::expected::{Clock, Rule, applies, late_s};
use crate::campaign::fault_injection::What;
use crate::campaign::outcome::{Detection, Why};
use crate::campaign::plan::Plan;
use crate::closed_loop::Board;
use crate::mission::BaseSpec;
use crate::world::{PlantFault, Side};
use controller_core::base::BaseReport;
use controller_core::hal::WheelDrive;
use controller_core::types::WheelTorques;

/// Drivers that close their own speed loop push a wheel the way that it is commanded, with what grows with the way commanded: up to so many times
/// the slowest speed that is watched a way counts, not a time. Written here anew.
const SLOW: f64 = 4.0;

/// Whether a plan's first injection is found in time.
pub(super) struct Deadline<'a> {
    plan: &'a Plan,
    base: &'a BaseSpec,
    /// What has acted on the wheels since the last tick, if torques did.
    acting: Option<WheelTorques<f32>>,
    /// Time that counts towards the deadline, and which way a wheel was pushed in it.
    counted_s: f64,
    pushed_way: f64,
    /// The most that counted.
    pub(super) longest_s: f64,
    pub(super) found: Option<Detection>,
}

impl<'a> Deadline<'a> {
    pub(super) const fn new(plan: &'a Plan, base: &'a BaseSpec) -> Self {
        Self {
            plan,
            base,
            acting: None,
            counted_s: 0.0,
            pushed_way: 0.0,
            longest_s: 0.0,
            found: None,
        }
    }

    /// Takes the tick that ends now; `before` is the report that it began with, `read` that a frame was read in it.
    pub(super) fn count(
        &mut self,
        board: &Board<'_>,
        timeline: &Timeline<'_>,
        before: &BaseReport<f32>,
        read: bool,
    ) {
        let acting = self.acting;
        let hal = board.task().drive();
        let asked = board.task().applied();
        self.acting = asked.map(|asked| hal.exerted().unwrap_or(asked));
        if !timeline.is_active(0) || self.found.is_some() {
            return;
        }
        let dt = 1.0e-6 * f64::from(board.dt_us());
        let period = 1.0e-6 * f64::from(board.task().params().detectors.period_us);
        // What share of the tick counts, and whether what was counted before stays where none does.
        let (share, lasts) = match Rule::of(self.plan.injection.kind).clock {
            Clock::None => return,
            // What a tick is late by chance comes on top of a deadline, as what the trouble makes it late does: one of 1 ms may last for three.
            Clock::All | Clock::Beyond
                if late_s(&self.plan.injection, board.task().params()) == 0.0 =>
            {
                ((period / dt).min(1.0), true)
            }
            Clock::All | Clock::Beyond | Clock::Long => (1.0, true),
            Clock::SinceFrame => {
                let rolls = before.state.is_live() && !check::stops(before.state);
                (f64::from(u8::from(!read && rolls)), false)
            }
            Clock::Pushed => {
                let (way, share) = self.pushed(board, before, acting).unwrap_or_default();
                if way != self.pushed_way {
                    self.counted_s = 0.0;
                }
                self.pushed_way = way;
                (share, false)
            }
        };
        self.counted_s = if share > 0.0 || lasts {
            self.counted_s + share * dt
        } else {
            0.0
        };
        self.longest_s = self.longest_s.max(self.counted_s);
    }

    /// Which way a wheel in trouble is pushed, 1 or −1, and what share of the time counts; `None` if not hard enough to be found.
    fn pushed(
        &self,
        board: &Board<'_>,
        before: &BaseReport<f32>,
        acting: Option<WheelTorques<f32>>,
    ) -> Option<(f64, f64)> {
        let What::PlantFault(
            PlantFault::EncoderStuck(side)
            | PlantFault::EncoderReversed(side)
            | PlantFault::WheelBlocked(side),
        ) = self.plan.injection.what
        else {
            return None;
        };
        let (torques, motion) = (acting?, before.motion?);
        let of = |right: f32, left: f32| f64::from(if side == Side::Right { right } else { left });
        let detectors = &board.task().params().detectors;
        let core = board.task().controller().base();
        let wheels = core.motion().wheels();
        let speeds = wheels.wheel_speeds(&motion.command);
        let (speed, torque) = (
            of(speeds.right, speeds.left),
            of(torques.right, torques.left),
        );
        let (fast, hard) = (
            f64::from(detectors.wheels.stuck.speed_rad_s),
            f64::from(detectors.wheels.stuck.torque_nm),
        );
        let way = speed.signum();
        if speed.abs() < fast {
            None
        } else if core.driver().speeds().is_some() {
            Some((way, (speed.abs() / (SLOW * fast)).min(1.0)))
        } else {
            (way * torque >= hard).then_some((way, 1.0))
        }
    }

    /// Takes what the tick found, `after_s` and `way_m` after the trouble began; `refused` that something was which had
    /// to be.
    pub(super) fn detect(
        &mut self,
        report: &BaseReport<f32>,
        refused: bool,
        after_s: f64,
        way_m: f64,
    ) {
        if self.found.is_some() {
            return;
        }
        let rule = Rule::of(self.plan.injection.kind);
        let faults = report.active_faults.iter();
        let mut found = faults.map(|fault| Why::Fault(fault.kind()));
        let stopped = Some(Why::of(report.cause)).filter(|_| check::stops(report.state));
        let refused = refused.then_some(Why::Refused);
        let why = found
            .find(|why| rule.allows(*why))
            .or(stopped.filter(|why| rule.allows(*why)))
            .or(refused.filter(|why| rule.allows(*why)));
        self.found = why.map(|why| Detection {
            why,
            after_s,
            way_m,
        });
    }

    /// More time than there is.
    pub(super) fn check(&self, board: &Board<'_>, timeline: &Timeline<'_>) -> Checked<()> {
        let injection = &self.plan.injection;
        let params = board.task().params();
        // One that comes on top may hide it.
        let alone = !timeline.has_begun(1);
        if self.found.is_some()
            || !timeline.is_active(0)
            || !alone
            || !applies(injection, self.plan.target, params)
        {
            return Ok(());
        }
        let source = self.base.hardware.and_then(|hardware| hardware.pose_source);
        let rule = Rule::of(injection.kind);
        let Some(within) = rule.within_s(params, source.as_ref()) else {
            return Ok(());
        };
        let within = within + late_s(injection, params);
        if self.counted_s > within {
            return Err(format!("not found within {within:.3} s"));
        }
        Ok(())
    }
}
