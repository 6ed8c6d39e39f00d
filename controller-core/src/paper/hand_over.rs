//! From tracking to parking in one tick, without a jump. Eq. (23).

use crate::maths::Maths;
use crate::paper::params::{ParkingGains, Reset};
use crate::paper::tracking::carry;
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::shunting::Shunting;
use crate::types::{Accel, Twist, Wrench};

/// Values of the pose neurons right after the hand-over, and what they could not carry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseNeurons<T> {
    /// s₁(P), in [−D, B].
    pub s1: T,
    /// s₃(P), in [−D, B] and [−π/2, π/2].
    pub s3: T,
    /// b(P): added to the command and faded out as exp(−A t). Zero if (23) could be met.
    pub transition_offset: Twist<T>,
}

/// Pose neurons with which Eq. (20) commands what Eq. (15) did. Eq. (23), first two lines.
///
/// ```text
/// s₁(P) = v_c/k₄        s₃(P) = arcsin(w_c/k₅)
/// ```
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | v_c, w_c | `command` of the tracking law in this very tick | m/s, rad/s |
///
/// Not in the paper: where a state would leave [−D, B], or |w_c| > k₅ leaves the arcsine without
/// a value, the state is clipped and a transition offset carries the rest.
#[inline]
pub fn pose_neurons<T: Scalar, M: Maths<T>>(
    gains: &ParkingGains<T>,
    shunting: &Shunting<T>,
    command: &Twist<T>,
) -> PoseNeurons<T> {
    let (s1, bridge_linear) = carry(shunting, command.linear, gains.k4);
    let ratio = command.angular / gains.k5;
    let angle = if ratio >= T::ONE {
        T::FRAC_PI_2
    } else if ratio <= -T::ONE {
        -T::FRAC_PI_2
    } else {
        M::asin(ratio)
    };
    let s3 = shunting.clip(angle);
    let rest = command.angular - gains.k5 * M::sin_cos_near(s3).0;
    // sin(arcsin) of an exact back end is off by rounding, which is no rest to carry; that of a
    // rough one is off by more, and the command must not jump by it.
    let rounding = T::from_f64(4.0) * T::EPSILON * gains.k5;
    let bridge_angular = if rest.abs() <= rounding {
        T::ZERO
    } else {
        rest
    };
    let transition_offset = Twist {
        linear: bridge_linear,
        angular: bridge_angular,
    };
    PoseNeurons {
        s1,
        s3,
        transition_offset,
    }
}

/// What the acceleration neurons are reset from, all of it of the tick of the hand-over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueBefore<T> {
    /// (v − v_c, w − w_c).
    pub velocity_error: Twist<T>,
    /// (v̇_s, ẇ_s) of tracking.
    pub filtered: Accel<T>,
    /// (v̇_c, ẇ_c) of tracking.
    pub command_rate: Accel<T>,
    /// Diagonal of k_d: the velocity gains of tracking.
    pub gain: (T, T),
}

/// Acceleration neurons right after the hand-over. Eq. (23), last two lines, corrected.
///
/// ```text
/// v̇_s(P⁺) = v̇_s(P⁻) + (k_c1 − k_d1)(v − v_c)/m
/// ẇ_s(P⁺) = ẇ_s(P⁻) + (k_c2 − k_d2)(w − w_c)/I
/// ```
///
/// Equal gains: the neurons keep their values, bit for bit. The printed reset to (v̇_c, ẇ_c) makes
/// the force jump by −(k_c1 − k_d1)(v − v_c) + m (v̇_c − v̇_s). The result may lie outside [−D, B]
/// if gains differ much; the neuron then relaxes into its bounds, and the report says so.
#[inline]
pub fn acceleration_neurons<T: Scalar>(
    reset: Reset,
    robot: &Robot<T>,
    gains: &ParkingGains<T>,
    before: &TorqueBefore<T>,
) -> Accel<T> {
    match reset {
        Reset::TorqueContinuous => {
            let error = before.velocity_error;
            let force = (gains.k_c1 - before.gain.0) * error.linear;
            let moment = (gains.k_c2 - before.gain.1) * error.angular;
            Accel {
                linear: before.filtered.linear + force / robot.mass_kg,
                angular: before.filtered.angular + moment / robot.inertia_kg_m2,
            }
        }
        Reset::Printed => before.command_rate,
        Reset::Zero => Accel::default(),
    }
}

/// The step that a hand-over puts into a wrench: new minus old, in one and the same tick.
#[inline]
pub(crate) fn wrench_step<T: Scalar>(new: &Wrench<T>, old: &Wrench<T>) -> Wrench<T> {
    Wrench {
        force: new.force - old.force,
        moment: new.moment - old.moment,
    }
}
