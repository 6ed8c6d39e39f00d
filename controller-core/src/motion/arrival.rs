//! Parked, or stuck: when a robot has arrived.

use super::params::Motion;
use crate::error::{Field, ParamError};
use crate::pose_error::PoseError;
use crate::range::within;
use crate::scalar::Scalar;
use crate::types::{Accel, Twist};

/// What counts as arrived, and as stuck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival<T = f32> {
    /// Distance to the goal \[m\], 1e-5 to 10. With noisy poses at least the noise radius plus three
    /// standard deviations.
    pub distance_m: T,
    /// Heading error \[rad\], 1e-5 to 3.
    pub heading_rad: T,
    /// How long the predicted stop has to be inside \[s\], 0 to 10.
    pub dwell_s: T,
    /// What the wheels do once parked.
    pub at_rest: AtRest,
    /// A command above this \[m/s, or at the wheels' distance of the track\] with less than a tenth
    /// of it measured counts towards a stall, and so do wheels at their torque limit with less than a
    /// tenth of this measured. 1e-4 to 10.
    pub stall_speed: T,
    /// For how long it has to, to be one \[s\]. 1e-2 to 1e3.
    pub stall_s: T,
    /// How often a robot that stands outside of the tolerance drives out and tries again before
    /// [`super::Outcome::OutOfTolerance`].
    pub retries: u8,
}

/// What the wheels do once parked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum AtRest {
    /// Hold zero speed: a push is resisted by the velocity loop.
    #[default]
    Hold,
    /// No torque at all once the robot stands, until it is pushed off the goal.
    Release,
}

impl<T: Scalar> Arrival<T> {
    /// Half a millimetre, 0.7 mrad, 50 ms: for poses without noise.
    ///
    /// 0.7 mrad leaves 0.9 at the end (the stop is predicted); 50 ms is ten samples of a slow pose
    /// source. Stalled: 5 cm/s commanded and not reached for 2 s. Two
    /// retries: what two new approaches did not mend a third will not.
    pub fn exact() -> Self {
        let f = T::from_f64;
        Self {
            distance_m: f(5.0e-4),
            heading_rad: f(7.0e-4),
            dwell_s: f(0.05),
            at_rest: AtRest::Hold,
            stall_speed: f(0.05),
            stall_s: f(2.0),
            retries: 2,
        }
    }

    pub(crate) fn check(&self) -> Result<(), ParamError> {
        within(Field::ArrivalDistance, self.distance_m, 1.0e-5, 10.0)?;
        within(Field::ArrivalHeading, self.heading_rad, 1.0e-5, 3.0)?;
        within(Field::ArrivalDwell, self.dwell_s, 0.0, 10.0)?;
        within(Field::StallSpeed, self.stall_speed, 1.0e-4, 10.0)?;
        within(Field::StallTime, self.stall_s, 1.0e-2, 1.0e3)?;
        Ok(())
    }
}

/// Decay of the bridge that stops a parked robot \[1/s\]: faster than the pose neurons' 5, since the
/// speeds left are small, so that nothing moves a second after arrival.
pub(crate) const STOPPING_DECAY: f64 = 12.0;

/// Whether the robot is parked, and for how long it has been fit to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Latch<T> {
    pub(crate) parked: bool,
    inside_s: T,
}

/// Where the robot is with respect to its goal, and how it moves.
pub(crate) struct Standing<T> {
    pub(crate) error: PoseError<T>,
    /// Distance to the goal.
    pub(crate) distance: T,
    pub(crate) twist: Twist<T>,
    pub(crate) command: Twist<T>,
    pub(crate) command_rate: Accel<T>,
    /// The robot backs up to the goal.
    pub(crate) backing: bool,
}

impl<T: Scalar> Latch<T> {
    /// The latch after a tick of `dt`.
    ///
    /// Enters when the place where the stopping bridge would end is inside the tolerance: a bridge
    /// from (v_c, a_c) travels (a_c + 2 A v_c)/A², and the velocity loop's lag adds its own. Leaves
    /// when the robot is pushed beyond [`Motion::leave_distance`] or 1.3 times the heading, but not in
    /// the first second, while it still settles.
    pub(crate) fn advance(&self, motion: &Motion<T>, at: &Standing<T>, dt: T) -> Self {
        let f = T::from_f64;
        let limits = &motion.params().arrival;
        let close = at.distance < motion.leave_distance();
        let fit = if self.parked {
            let turned = at.error.theta.abs() < f(1.3) * limits.heading_rad;
            (close && turned) || self.inside_s < T::ONE
        } else {
            let gains = motion.gains();
            let (v, w) = (
                travel(
                    at.command.linear,
                    at.command_rate.linear,
                    at.twist.linear,
                    dt,
                    gains.speed_loop,
                ),
                travel(
                    at.command.angular,
                    at.command_rate.angular,
                    at.twist.angular,
                    dt,
                    gains.turn_loop,
                ),
            );
            let (dx, dy) = (at.error.x - v, at.error.y);
            let near = dx * dx + dy * dy < limits.distance_m * limits.distance_m;
            let turned = (at.error.theta - w).abs() < limits.heading_rad;
            near && turned && close
        };
        if fit {
            let inside_s = self.inside_s + dt;
            Self {
                parked: self.parked || inside_s > limits.dwell_s,
                inside_s,
            }
        } else {
            Self::default()
        }
    }
}

/// How far a command and a speed still carry once the wish is zero.
fn travel<T: Scalar>(command: T, rate: T, speed: T, dt: T, bandwidth: T) -> T {
    let decay = T::from_f64(STOPPING_DECAY);
    let bridge = (rate + (decay + decay) * command) / (decay * decay);
    bridge + (speed - command - dt * rate) / bandwidth
}

impl<T: Scalar> Motion<T> {
    /// Distance at which a parked robot has left its goal \[m\]: twice the tolerance, and five standard
    /// deviations, so that it is never noise that ends a rest.
    pub(crate) fn leave_distance(&self) -> T {
        let params = self.params();
        let tolerance = params.arrival.distance_m;
        tolerance + tolerance + T::from_f64(5.0) * params.pose_noise_m
    }

    /// Speed of the faster wheel \[m/s\].
    pub(crate) fn rim_speed(&self, twist: &Twist<T>) -> T {
        let lever = T::HALF * self.params().robot.wheels.track_m;
        twist.linear.abs() + lever * twist.angular.abs()
    }
}

/// How long a commanded motion has not happened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stall<T> {
    since_s: T,
}

/// What is asked of a robot and what it does.
pub(crate) struct Pushing<T> {
    pub(crate) command: Twist<T>,
    pub(crate) twist: Twist<T>,
    /// A wheel was at its limit. The command is then set back to nearly what is achieved.
    pub(crate) saturated: bool,
}

impl<T: Scalar> Stall<T> {
    pub(crate) fn advance(&self, motion: &Motion<T>, now: &Pushing<T>, dt: T) -> Self {
        let tenth = T::from_f64(0.1);
        let (asked, done) = (motion.rim_speed(&now.command), motion.rim_speed(&now.twist));
        let least = motion.params().arrival.stall_speed;
        let stuck = if asked > least {
            done < tenth * asked
        } else {
            now.saturated && done < tenth * least
        };
        Self {
            since_s: if stuck { self.since_s + dt } else { T::ZERO },
        }
    }

    pub(crate) fn is_stalled(&self, motion: &Motion<T>) -> bool {
        self.since_s > motion.params().arrival.stall_s
    }
}
