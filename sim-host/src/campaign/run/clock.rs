//! The time that counts towards a deadline.

use super::*;
use crate::campaign::expected::{Clock, applies, late_s};
use crate::world::{PlantFault, Side};
use controller_core::hal::WheelDrive;
use controller_core::types::WheelTorques;

impl Runner<'_, '_> {
    /// Takes the tick that ends now; `before` is the report that it began with.
    pub(super) fn count(&mut self, before: &BaseReport<f32>) {
        let acting = self.acting;
        let hal = self.board.task().drive();
        self.acting = self
            .board
            .task()
            .applied()
            .map(|asked| hal.exerted().unwrap_or(asked));
        if !self.active[0] || self.outcome.found.is_some() {
            return;
        }
        let dt = 1.0e-6 * f64::from(self.board.dt_us());
        let clock = Rule::of(self.plan.injection.kind).clock;
        let (counts, lasts) = match clock {
            Clock::None => return,
            Clock::All | Clock::Beyond | Clock::Long => (true, true),
            Clock::SinceFrame => {
                let rolls = before.state.is_live() && !check::stops(before.state);
                (!self.received.read && rolls, false)
            }
            Clock::Pushed => {
                let way = self.pushed(before, acting);
                if way != self.pushed_way {
                    self.counted_s = 0.0;
                }
                self.pushed_way = way;
                (way != 0.0, false)
            }
        };
        self.counted_s = match (counts, lasts) {
            (true, _) => self.counted_s + dt,
            (false, true) => self.counted_s,
            (false, false) => 0.0,
        };
        self.outcome.counted_s = self.outcome.counted_s.max(self.counted_s);
    }

    /// Which way a wheel in trouble is pushed hard enough to be found: 1, −1, or 0 if it is not.
    fn pushed(&self, before: &BaseReport<f32>, acting: Option<WheelTorques<f32>>) -> f64 {
        let What::PlantFault(
            PlantFault::EncoderStuck(side)
            | PlantFault::EncoderReversed(side)
            | PlantFault::WheelBlocked(side),
        ) = self.plan.injection.what
        else {
            return 0.0;
        };
        let (Some(torques), Some(motion)) = (acting, before.motion) else {
            return 0.0;
        };
        let of = |right: f32, left: f32| f64::from(if side == Side::Right { right } else { left });
        let detectors = &self.board.task().params().detectors;
        let core = self.board.task().controller().base();
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
        if speed.abs() >= fast && way * torque >= hard {
            way
        } else {
            0.0
        }
    }

    /// More time than there is.
    pub(super) fn overdue(&self) -> Checked<()> {
        let injection = &self.plan.injection;
        let params = self.board.task().params();
        // One that comes on top may hide it.
        let alone = self.second.is_none();
        if self.outcome.found.is_some()
            || !self.active[0]
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
