//! The report of a tick of the base.

use controller_core::base::{BaseReport, WheelAction};
use controller_core::gyro::GyroOutcome;
use controller_core::localiser::FixOutcome;
use controller_core::motion::{Mode, Outcome};

use crate::{BaseTick, WireAction, WireOutcome, tick_flags as flags};

impl BaseTick {
    /// What a base has just done.
    pub fn of(tick: u32, report: &BaseReport<f32>, ignored: u32) -> Self {
        let law = report.motion.unwrap_or_default();
        let measured = report.measured.unwrap_or_default();
        let torques = report.action.torques().unwrap_or_default();
        let limited = &law.limited;
        let fused = matches!(report.fix, FixOutcome::Fused | FixOutcome::Relocalised);
        let unused = matches!(report.fix, FixOutcome::Rejected | FixOutcome::Refused(_));
        let mut bits = 0;
        for (holds, bit) in [
            (limited.speed, flags::SPEED_LIMITED),
            (limited.accel, flags::ACCEL_LIMITED),
            (limited.jerk, flags::JERK_LIMITED),
            (limited.torque, flags::TORQUE_LIMITED),
            (limited.disturbance, flags::DISTURBANCE_LIMITED),
            (law.jumped, flags::JUMPED),
            (law.backing, flags::BACKING),
            (report.blind, flags::BLIND),
            (law.mode == Mode::Parking, flags::PARKING),
            (law.mode == Mode::Driving, flags::DRIVING),
            (report.motion.is_some(), flags::LAW),
            (fused, flags::FIX_USED),
            (unused, flags::FIX_REFUSED),
            (report.gyro.outcome == GyroOutcome::Used, flags::GYRO_USED),
            (report.gyro.slid != 0.0, flags::SLIDING),
            (limited.grip, flags::GRIP_LIMITED),
        ] {
            bits |= if holds { bit } else { 0 };
        }
        let mut active_faults = 0;
        for fault in report.active_faults.iter() {
            active_faults |= 1_u32.wrapping_shl(u32::from(fault.kind().code()).wrapping_sub(1));
        }
        Self {
            tick,
            state: report.state,
            action: match report.action {
                WheelAction::Release => WireAction::Release,
                WheelAction::Brake => WireAction::Brake,
                WheelAction::Drive(_) => WireAction::Drive,
            },
            outcome: match law.outcome {
                Outcome::Parked => WireOutcome::Parked,
                Outcome::Stalled => WireOutcome::Stalled,
                Outcome::OutOfTolerance => WireOutcome::OutOfTolerance,
                _ => WireOutcome::Driving,
            },
            flags: bits,
            active_faults,
            ignored,
            retries: law.retries,
            x: measured.pose.x,
            y: measured.pose.y,
            theta: measured.pose.theta,
            v: measured.twist.linear,
            w: measured.twist.angular,
            e_x: law.error.x,
            e_y: law.error.y,
            e_theta: law.error.theta,
            v_c: law.command.linear,
            w_c: law.command.angular,
            e_v: law.velocity_error.linear,
            e_w: law.velocity_error.angular,
            load_force: law.disturbance.force,
            load_moment: law.disturbance.moment,
            tau_right: torques.right,
            tau_left: torques.left,
        }
    }

    /// The codes of the kinds of faults found, lowest first.
    pub fn codes(&self) -> impl Iterator<Item = u8> + '_ {
        (1..=32_u8).filter(|code| self.active_faults >> (code - 1) & 1 == 1)
    }
}
