//! Detectors, fed once a tick.
//!
//! | finding | condition | found within |
//! | --- | --- | --- |
//! | measurement stale | no counts for `measurement` | the timeout and a tick |
//! | pose, command stale | their age | the timeout and a tick |
//! | not finite | measured pose or twist | the tick |
//! | tick too long, jitter | `ticks` | the tick; `row` late ticks, or `of_64` of the last 64 |
//! | pose jump, driver | told by others | the tick |
//! | stuck, stalled | [`wheel`](self#wheels): told to turn, stands | `stuck.after` and a tick |
//! | reversed | moves against its torque | 0.3 s and `reversed` once what is exerted is 2.5 times the load |
//! | reversed | told to turn, turns the other way | `stuck.after` and a tick, and as long for a wheel to come round |
//! | stuck, on the way | the same, but its counts, or the other wheel's, ceased | as reversed |
//! | slip | moves more than its torque explains, or than the robot does | 0.1 s and `slip.after` |
//! | over-current, under-voltage | beyond the limit | their time and a tick |
//!
//! # Wheels
//!
//! Both sides of each wheel's equation of motion φ̈ = â + d (â from the torques by the model, d by the load)
//! pass the same filter, so that counts need not be differentiated:
//!
//! ```text
//! seen     y = (s/(s + a))² φ            from the counts
//! expected x = 1/(s + a)² â              from the torques          y = x + 1/(s + a)² d
//! ```
//!
//! | symbol | what | unit |
//! | --- | --- | --- |
//! | φ | turn of the wheel | rad |
//! | â = B̄ᵀ M̄⁻¹ B̄ τ | acceleration by the torques, both wheels together | rad/s² |
//! | a = 10 | rate of the window of 0.1 s | 1/s |
//! | D = d_max/a² | most that the load contributes to y | rad |
//!
//! The filter's impulse response t e^(−at) is positive with area 1/a², so a sound wheel has |y − x| ≤ D for
//! any load up to d_max, and a reversed one |y + x| ≤ D. With |x| ≥ 2 D the two are told apart at −x/2: a
//! reversed wheel has y sgn x ≤ −|x|/2, a sound one does not before the load is three times the stated one.
//! Under a constant torque c times the load |x| reaches 2 D when 1 − (1 + at) e^(−at) = 2/c: after 0.30 s for
//! c = 2.5, 0.17 s for c = 4, 0.10 s for c = 8. Below 8 counts of x nothing is said, for the sake of rounding.
//!
//! While torques are not known (windings shorted; a supply that is too low, until under-voltage is found) x
//! follows y, as if a constant acceleration explained it: nothing is said of the wheels, and when torques are
//! known again both filters begin from what the wheels really did.
//!
//! A velocity loop of bandwidth κ on reversed encoders drives the speed up as v_c (e^(κt) − 1) and the force
//! as m κ v_c e^(κt): when the latter has reached F the base has gone less than F/(m κ²), whatever the
//! command was. With the default load that is 10 % of the weight to be reached, 0.11 m for κ = 3, plus what it
//! travels in the 0.3 s that follow.

mod electric;
mod held;
mod ticks;
mod wheel;

use super::evidence::{Evidence, Findings};
use super::fault::{Fault, Side};
use super::watch::{Watch, wheel_accels};
use crate::error::Input;
use crate::hal::WheelCounts;
use crate::scalar::Scalar;
use crate::types::{Twist, WheelSpeeds};
pub(super) use held::Held;

use electric::{OverCurrent, UnderVoltage};
use ticks::Ticks;
use wheel::{Effort, Wheel, WheelEvidence, WheelFinding};

/// All detectors and what they remember. See the source's table of formulas and bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Monitor<T> {
    watch: Watch<T>,
    ticks: Ticks,
    silent_us: u32,
    last: Option<WheelCounts>,
    right: Wheel<T>,
    left: Wheel<T>,
    current: OverCurrent,
    supply: UnderVoltage,
}

impl<T: Scalar> Monitor<T> {
    /// Nothing seen yet.
    pub fn new(watch: &Watch<T>) -> Self {
        Self {
            watch: *watch,
            ticks: Ticks::default(),
            silent_us: 0,
            last: None,
            right: Wheel::default(),
            left: Wheel::default(),
            current: OverCurrent::default(),
            supply: UnderVoltage::default(),
        }
    }

    /// Takes a tick's evidence. A condition that lasts is found again in every tick.
    pub fn check(&mut self, evidence: &Evidence<T>) -> Findings {
        let params = *self.watch.params();
        let dt_us = evidence.dt_us;
        let mut found = Findings::NONE;
        self.silent_us = match evidence.counts {
            Some(_) => 0,
            None => self.silent_us.saturating_add(dt_us),
        };
        let (jitter, long) = self.ticks.advance(&params.ticks, dt_us);
        for (holds, fault) in [
            (
                params.measurement.passed(self.silent_us),
                Fault::MeasurementStale,
            ),
            (params.pose.passed(evidence.pose_age_us), Fault::PoseStale),
            (
                params.command.passed(evidence.command_age_us),
                Fault::CommandStale,
            ),
            (
                !evidence.measured.pose.is_finite(),
                Fault::NotFinite(Input::Pose),
            ),
            (
                !evidence.measured.twist.is_finite(),
                Fault::NotFinite(Input::Twist),
            ),
            (jitter, Fault::TickJitter),
            (long, Fault::TickTooLong),
            (evidence.pose_jumped, Fault::PoseJump),
        ] {
            if holds {
                found.add(fault);
            }
        }
        found.add_some(evidence.driver.map(Fault::Driver));
        let over = self
            .current
            .advance(&params.current, evidence.currents, dt_us);
        found.add_some(over.map(Fault::OverCurrent));
        if self
            .supply
            .advance(&params.supply, evidence.supply_v, dt_us)
        {
            found.add(Fault::UnderVoltage);
        }
        self.check_wheels(evidence, &mut found);
        found
    }

    /// Late ticks since the start.
    pub fn late_ticks(&self) -> u32 {
        self.ticks.late
    }

    fn check_wheels(&mut self, evidence: &Evidence<T>, found: &mut Findings) {
        let watch = &self.watch;
        let moved = match (evidence.counts, self.last) {
            (Some(now), Some(last)) => Some((
                now.right.wrapping_sub(last.right),
                now.left.wrapping_sub(last.left),
            )),
            _ => None,
        };
        if evidence.counts.is_some() {
            self.last = evidence.counts;
        }
        let torques = match self.supply.suspected(&watch.params.supply) {
            true => None,
            false => evidence.torques,
        };
        let efforts = torques.map(|torques| {
            let wrench = watch.map.wrench(&torques);
            let (right, left) = wheel_accels(&watch.params.robot, &watch.map, &wrench);
            let effort = |torque, accel| Effort { torque, accel };
            (effort(torques.right, right), effort(torques.left, left))
        });
        let command = watch.map.wheel_speeds(&evidence.command);
        let outside = evidence
            .outside
            .map(|twist| watch.map.wheel_speeds(&twist))
            .map_or((None, None), |WheelSpeeds { right, left }| {
                (Some(right), Some(left))
            });
        let (right_off, left_off) = self.disagreement(evidence);
        let side = |moved, effort, command, outside, off| WheelEvidence {
            dt_us: evidence.dt_us,
            moved,
            effort,
            command,
            outside,
            off,
        };
        let right = side(
            moved.map(|(right, _)| right),
            efforts.map(|(right, _)| right),
            command.right,
            outside.0,
            right_off,
        );
        let left = side(
            moved.map(|(_, left)| left),
            efforts.map(|(_, left)| left),
            command.left,
            outside.1,
            left_off,
        );
        let right = self.right.advance(watch, &right);
        let left = self.left.advance(watch, &left);
        let of = |what: fn(&WheelFinding) -> bool| Side::of(what(&right), what(&left));
        let (dead, reversed) = (dead(&right, &left), reversed(&right, &left));
        found.add_some(of(|wheel| wheel.stuck).or(dead).map(Fault::EncoderStuck));
        found.add_some(of(|wheel| wheel.blocked).map(|_| Fault::Stalled));
        found.add_some(reversed.map(Fault::EncoderReversed));
        found.add_some(of(|wheel| wheel.slips).map(Fault::WheelSlip));
    }

    /// Speed at each wheel by the encoders less that by the outside twist \[m/s\]; 0 without one.
    fn disagreement(&self, evidence: &Evidence<T>) -> (T, T) {
        let Some(outside) = evidence.outside else {
            return (T::ZERO, T::ZERO);
        };
        let Twist { linear, angular } = evidence.measured.twist.minus(&outside);
        let turning = T::HALF * self.watch.params.robot.wheels.track_m * angular;
        (linear + turning, linear - turning)
    }
}

/// Wheels that move against their torque while neither is silent that should not be.
fn reversed(right: &WheelFinding, left: &WheelFinding) -> Option<Side> {
    let is = |own: &WheelFinding, other: &WheelFinding| own.against && !own.silent && !other.dead;
    Side::of(is(right, left), is(left, right))
}

/// Encoders without counts that explain a wheel against its torque: its own, which died while it turned, or the
/// other one, whose motor is then driven at a speed that it does not have.
fn dead(right: &WheelFinding, left: &WheelFinding) -> Option<Side> {
    let is = |own: &WheelFinding, other: &WheelFinding| {
        (own.against && own.silent) || (other.against && !other.silent && own.dead)
    };
    Side::of(is(right, left), is(left, right))
}

#[cfg(test)]
mod tests;
