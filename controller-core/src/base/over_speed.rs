//! Wheels that turn faster than any command and any load explain: what drives them does not do what it is told.
//!
//! The governor commands no rim faster than s, so a rim that does what it is told is faster only by what the velocity loop has not yet
//! taken from an acceleration that nobody commanded. Against an acceleration a_d that sets in at once the loop leaves a_d/κ at most; the estimate of
//! the load takes that back. The rim is too fast above
//!
//! ```text
//! s (1 + 1/4) + a_d/κ
//! ```
//!
//! | symbol | what | unit |
//! | --- | --- | --- |
//! | s | [largest rim speed](crate::motion::Limits::rim_speed) | m/s |
//! | a_d | acceleration of a rim by three times the [load](crate::safety::WheelDetectorParams::load_nm) | m/s² |
//! | κ | bandwidth of the slower one of the velocity loops | 1/s |
//!
//! and a fault once it has been for [`UNNOTICED`]. That finds drivers that turn wheels faster than they are told, as one of speeds that takes rad/s for turns per second, and
//! velocity loops that run away, as by torques that are noted wrong. What feedback still makes up for, such as motors that are stronger than stated, is no fault.

use crate::motion::ValidMotionParams;
use crate::range::{larger, smaller};
use crate::safety::{Fault, LOADS, Side, Silence, UNNOTICED, ValidDetectorParams};
use crate::scalar::Scalar;
use crate::types::Twist;

/// Share of the largest rim speed that it may be exceeded by. A mass that is off by 30 % leaves 0.3 a/κ of a commanded acceleration a, 3 to 5 % of the shipped
/// bases' rim speeds; the rest is for speeds that odometry measures with noise, and wheels that are larger than stated.
const SHARE: f64 = 0.25;

/// From where on and after what time rims are too fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OverSpeedLimits<T> {
    /// \[m/s\].
    above: T,
    after_us: u32,
}

impl<T: Scalar> OverSpeedLimits<T> {
    /// What follows from limits, gains and load.
    pub(super) fn of_base(
        motion: &ValidMotionParams<T>,
        detectors: &ValidDetectorParams<T>,
    ) -> Self {
        let (motion, gains) = (motion.params(), motion.gains());
        let wheels = &motion.robot.wheels;
        let radius = larger(wheels.radius_right_m, wheels.radius_left_m);
        let accel = T::from_f64(LOADS) * radius * detectors.load_accel();
        let ticks_us = detectors.params().period_us.saturating_mul(UNNOTICED.0);
        Self {
            above: T::from_f64(1.0 + SHARE) * motion.limits.rim_speed
                + accel / smaller(gains.speed_loop, gains.turn_loop),
            after_us: ticks_us.max(UNNOTICED.1),
        }
    }
}

/// How long a rim has been too fast.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct OverSpeed {
    /// Since the rims were slow enough.
    slow_enough: Silence,
}

impl OverSpeed {
    /// A tick with this measured twist.
    #[inline(always)]
    pub(super) fn check<T: Scalar>(
        &mut self,
        limits: &OverSpeedLimits<T>,
        motion: &ValidMotionParams<T>,
        twist: &Twist<T>,
        dt_us: u32,
    ) -> Option<Fault> {
        if motion.rim_speed(twist) > limits.above {
            return self.too_fast(limits, motion, twist, dt_us);
        }
        self.slow_enough = Silence::NONE;
        None
    }

    /// Apart: nearly no tick is.
    #[cold]
    #[inline(never)]
    fn too_fast<T: Scalar>(
        &mut self,
        limits: &OverSpeedLimits<T>,
        motion: &ValidMotionParams<T>,
        twist: &Twist<T>,
        dt_us: u32,
    ) -> Option<Fault> {
        // Of a tick that took too long, as by a clock that steps, no speed is known.
        let dt_us = dt_us.min(limits.after_us / UNNOTICED.0);
        self.slow_enough = self.slow_enough.after(dt_us, false);
        if self.slow_enough.us() < limits.after_us {
            return None;
        }
        let speeds = motion.wheels().wheel_speeds(twist);
        let wheels = &motion.params().robot.wheels;
        let right = speeds.right.abs() * wheels.radius_right_m > limits.above;
        let left = speeds.left.abs() * wheels.radius_left_m > limits.above;
        // The faster rim is one of them, but for rounding.
        Some(Fault::OverSpeed(
            Side::of(right, left).unwrap_or(Side::Both),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Limits, MotionParams};
    use crate::robot::Robot;
    use crate::safety::DetectorParams;

    /// Above 5/4 of the largest rim speed and what three loads leave, for a tenth of a second or five ticks, without a break.
    #[test]
    fn a_rim_is_too_fast_beyond_its_limit_and_after_its_time() {
        for (period_us, ticks) in [(10_000, 10), (50_000, 5)] {
            let robot = Robot::<f64>::paper();
            let params = MotionParams::new(robot, Limits::PAPER);
            let motion = params.validate().expect("valid");
            let detectors = DetectorParams::for_base(&params, 2048.0, period_us);
            // Loads drive a base of 30 kg harder than they turn it: 15 % of its weight at both wheels.
            assert_eq!(detectors.wheels.load_nm, 0.05 * 9.81 * 15.0 * 0.1);
            let limits = OverSpeedLimits::of_base(&motion, &detectors.validate().expect("valid"));
            let bandwidth = params.gains.speed_loop.min(params.gains.turn_loop);
            let above = 1.25 * 2.5 + 0.15 * 9.81 / bandwidth;
            assert!((limits.above - above).abs() < 1e-12, "{limits:?}");

            let half_track = 0.5 * robot.wheels.track_m;
            let of_rims = |right: f64, left: f64| {
                Twist::new(0.5 * (right + left), 0.5 * (right - left) / half_track)
            };
            let (slow, fast) = (0.999 * above, 1.001 * above);
            for (twist, side) in [
                (of_rims(fast, slow), Side::Right),
                (of_rims(-slow, -fast), Side::Left),
                (of_rims(fast, -fast), Side::Both),
            ] {
                let mut over_speed = OverSpeed::default();
                let mut check =
                    |twist: &Twist<f64>| over_speed.check(&limits, &motion, twist, period_us);
                for _ in 0..2 {
                    for _ in 1..ticks {
                        assert_eq!(check(&twist), None);
                    }
                    // Once slow enough, the time begins anew.
                    assert_eq!(check(&of_rims(slow, slow)), None);
                }
                for _ in 1..ticks {
                    assert_eq!(check(&twist), None);
                }
                assert_eq!(check(&twist), Some(Fault::OverSpeed(side)));
                assert_eq!(check(&twist), Some(Fault::OverSpeed(side)), "it lasts");
            }
        }
    }
}
