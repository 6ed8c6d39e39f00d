//! Wheel speeds for a driver that closes its own speed loop.
//!
//! ```text
//! v′ = v + T_d v̇      φ̇ = B̄ᵀ v′      φ̇ ← φ̇ · min(1, φ̇_max/max|φ̇|)      slowest speed, by wheel
//! ```
//!
//! **Lead.** A driver whose speed follows its command as 1/(T_d s + 1) follows the reference if it is given the inverse,
//! φ̇* + T_d φ̈*. The controller's command has an exact, limited rate, so nothing is differentiated. With T_d
//! overestimated by ΔT the wheel is ahead by ΔT φ̈*, no more.
//!
//! **Limit.** One factor for both wheels keeps their ratio, and with it the curvature.
//!
//! **Slowest speed.** A driver that stands still below φ̇_min can only do 0 or |φ̇| ≥ φ̇_min. The nearer of
//! both changes at φ̇_min/2; a blend cannot help, for what it would pass through is not executed, and a noisy command
//! at the threshold would start and stop the wheel every tick. So each wheel has a hysteresis: it starts at
//! 3/4 φ̇_min, and stops at 1/4 φ̇_min or when it is to reverse. A ripple of up to φ̇_min/2 from peak to
//! peak does not chatter, and the commanded speed is off by at most 3/4 φ̇_min. A pose loop around such wheels ends with a
//! limit cycle of a few ticks at φ̇_min, or at rest with a remaining error; its tolerance of arrival has to
//! be above both.
//!
//! # What changes with such a driver
//!
//! The torque loop is inside the driver, so [`MotionReport::torques`](crate::motion::MotionReport::torques) is not what
//! the wheels exert: limits of torque are not enforced and not reported, nor are current, slip and disturbance seen. Limits
//! of speed, acceleration, braking and jerk are enforced all the same, by the governor, on the command that
//! is handed on here; so choose them such that the driver can follow. A torque limit of the controller below what the base needs
//! would set its command back for a reason that does not exist: leave it above what the accelerations take.
//!
//! A [`BaseController`](crate::base::BaseController) with [`DriverParams::Speeds`](crate::motor::DriverParams) reckons with all that. Who has the law alone calls
//! [`note_not_driven`](crate::motion::MotionController::note_not_driven) in every tick, or the estimates of disturbance and load take the
//! report's torques for what the wheels exert, and limits and plans follow from these. The example `speed_drive` does.

use crate::error::{Field, Input, ParamError, Problem, StepFault};
use crate::range::{check_ranges, clamp};
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::types::{Accel, Twist, WheelSpeeds};
use crate::wheels::WheelMap;

/// A stopped wheel starts at this share of the slowest speed, a turning one stops at 1 less it: as far
/// from the middle, where 0 and the slowest speed are equally wrong, as leaves room on both sides.
const START: f64 = 0.75;

/// What a driver of wheel speeds can do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpeedParams<T = f32> {
    /// φ̇_max \[rad/s\], 1e-3 to 1e5.
    pub max_speed_rad_s: T,
    /// φ̇_min \[rad/s\]: slowest speed that the driver executes; 0 to half of the largest.
    pub min_speed_rad_s: T,
    /// T_d \[s\]: lag of the driver's speed loop that is made up for, 0 to 1.
    pub lag_s: T,
    /// What it takes to break a standing wheel loose \[N m\], 0 to 1e6: how long a wheel may stand before it is stuck goes by that. A fifth of the weight at the
    /// wheels is reckoned with in any case, so 0 does where no more holds them.
    pub breakaway_nm: T,
}

/// [`SpeedParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedOutput<T = f32> {
    params: SpeedParams<T>,
    start: T,
    stop: T,
}

/// Which way each wheel was commanded to turn: −1, 0 or 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SpeedState {
    right: i8,
    left: i8,
}

/// What limited the wheel speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SpeedLimited {
    /// Both wheels were slowed down by one factor: the curvature is kept.
    pub speed: bool,
    /// A wheel stands or turns at the slowest speed because it was to turn more slowly.
    pub slow: bool,
}

/// Wheel speeds for the driver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelSpeedCommand<T> {
    /// Within the largest speed; 0 or at least the slowest.
    pub speeds: WheelSpeeds<T>,
    /// What was limited.
    pub limited: SpeedLimited,
}

impl<T: Scalar> SpeedParams<T> {
    /// Checks every parameter.
    ///
    /// # Errors
    /// The first one out of its range.
    pub fn validate(self) -> Result<SpeedOutput<T>, ParamError> {
        let slowest = self.min_speed_rad_s;
        check_ranges![
            (Field::MaxWheelSpeed, self.max_speed_rad_s, 1.0e-3, 1.0e5),
            (Field::MinWheelSpeed, slowest, 0.0, 1.0e5),
            (Field::DriverLag, self.lag_s, 0.0, 1.0),
            (Field::BreakawayTorque, self.breakaway_nm, 0.0, 1.0e6),
        ]?;
        let half = T::HALF * self.max_speed_rad_s;
        if slowest > half {
            let (field, problem) = (Field::MinWheelSpeed, Problem::Above(half.to_f64()));
            return Err(ParamError { field, problem });
        }
        Ok(SpeedOutput {
            params: self,
            start: T::from_f64(START) * slowest,
            stop: T::from_f64(1.0 - START) * slowest,
        })
    }

    /// Way of the rims that is commanded before the drivers push standing wheels with `torque_nm` each \[N m\]: 4 T_d² F/m \[m\], with
    /// [F](crate::WheelGeometry::force_n) of both.
    ///
    /// A driver integrates what its wheel lacks, so what it exerts on one that stands grows with the way that was commanded: by m/(4 T_d²) of force
    /// in a loop that settles as its lag lets it.
    pub fn way_to_push_m(&self, torque_nm: T, robot: &Robot<T>) -> T {
        let accel = robot.wheels.force_n(torque_nm) / robot.mass_kg;
        T::from_f64(4.0) * self.lag_s * self.lag_s * accel
    }
}

impl<T: Scalar> SpeedOutput<T> {
    /// The parameters as they were given.
    pub const fn params(&self) -> &SpeedParams<T> {
        &self.params
    }

    /// Wheel speeds for the twist that the controller commands and its rate:
    /// [`MotionReport::command`](crate::motion::MotionReport::command) and `command_rate`. Equations in the
    /// [module](crate::motor::SpeedOutput#speed-output).
    ///
    /// # Errors
    /// [`StepFault::NotFinite`] of [`Input::Reference`] for a twist or rate that is not finite,
    /// [`StepFault::Overflow`] for finite ones whose wheel speeds are not; the state is unchanged.
    pub fn command(
        &self,
        state: &mut SpeedState,
        wheels: &WheelMap<T>,
        command: &Twist<T>,
        command_rate: &Accel<T>,
    ) -> Result<WheelSpeedCommand<T>, StepFault> {
        self.command_with(
            state,
            wheels,
            (command, command_rate),
            &WheelSpeeds::default(),
        )
    }

    /// [`command`](Self::command) with `more` speed of each wheel.
    ///
    /// # Errors
    /// As there.
    pub(crate) fn command_with(
        &self,
        state: &mut SpeedState,
        wheels: &WheelMap<T>,
        (command, command_rate): (&Twist<T>, &Accel<T>),
        more: &WheelSpeeds<T>,
    ) -> Result<WheelSpeedCommand<T>, StepFault> {
        if !(command.is_finite() && command_rate.is_finite()) {
            return Err(StepFault::NotFinite(Input::Reference));
        }
        let lag = self.params.lag_s;
        let led = Twist {
            linear: command.linear + lag * command_rate.linear,
            angular: command.angular + lag * command_rate.angular,
        };
        let led = wheels.wheel_speeds_apart(&led);
        let asked = WheelSpeeds {
            right: led.right + more.right,
            left: led.left + more.left,
        };
        if !(asked.right.is_finite() && asked.left.is_finite()) {
            return Err(StepFault::Overflow);
        }
        let (speeds, speed) = limit_speeds(asked, self.params.max_speed_rad_s);
        let (right, right_way) = self.executable(speeds.right, state.right);
        let (left, left_way) = self.executable(speeds.left, state.left);
        *state = SpeedState {
            right: right_way,
            left: left_way,
        };
        let slow = right != speeds.right || left != speeds.left;
        Ok(WheelSpeedCommand {
            speeds: WheelSpeeds { right, left },
            limited: SpeedLimited { speed, slow },
        })
    }

    // Once for both wheels: no other base comes here.
    /// What the driver executes of a wheel's speed, and which way that is, after a command to turn `before`.
    #[inline(never)]
    fn executable(&self, speed: T, before: i8) -> (T, i8) {
        let way = if speed > T::ZERO {
            1
        } else if speed < T::ZERO {
            -1
        } else {
            return (T::ZERO, 0);
        };
        let size = speed.abs();
        let turns = if way == before {
            size > self.stop
        } else {
            size >= self.start
        };
        let slowest = self.params.min_speed_rad_s;
        if !turns {
            (T::ZERO, 0)
        } else if size >= slowest {
            (speed, way)
        } else if way > 0 {
            (slowest, way)
        } else {
            (-slowest, way)
        }
    }
}

/// Scales both speeds by one factor so that neither exceeds `limit` > 0; returns whether it had to.
fn limit_speeds<T: Scalar>(speeds: WheelSpeeds<T>, limit: T) -> (WheelSpeeds<T>, bool) {
    let (right, left) = (speeds.right.abs(), speeds.left.abs());
    let largest = if right > left { right } else { left };
    if largest > limit {
        let scale = limit / largest;
        // The product may round above the limit by one unit in the last place.
        let right = clamp(speeds.right * scale, limit);
        let left = clamp(speeds.left * scale, limit);
        (WheelSpeeds { right, left }, true)
    } else {
        (speeds, false)
    }
}
