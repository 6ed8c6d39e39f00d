//! Tracking through neurons: commands, their rates, the start. Eqs. (15), (17)-(19).

use crate::paper::params::TrackingGains;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::shunting::Shunting;
use crate::types::{Accel, Twist};

/// Speed and turn rate to ask for. Eq. (15).
///
/// ```text
/// v_c = k₁ s₁ + v_r cos e_θ
/// w_c = w_r + k₂ v_r s₂ + k₃ sin e_θ
/// ```
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | k₁, k₂, k₃ | `gains` | 1/s, 1/m², rad/s |
/// | v_r, w_r | `reference` | m/s, rad/s |
/// | (sin e_θ, cos e_θ) | `heading` | |
/// | s₁, s₂ | neurons of e_x and e_y | m with A = B = D |
///
/// A transition offset may be added to each; see [`start`].
#[inline(always)]
pub fn command<T: Scalar>(
    gains: &TrackingGains<T>,
    reference: &Twist<T>,
    heading: (T, T),
    s1: T,
    s2: T,
) -> Twist<T> {
    let (sine, cosine) = heading;
    Twist {
        linear: gains.k1 * s1 + reference.linear * cosine,
        angular: reference.angular + gains.k2 * (reference.linear * s2) + gains.k3 * sine,
    }
}

/// Rate of change of the command, from state alone: no difference quotient, no algebraic loop.
/// Time derivative of Eq. (15) along Eqs. (9) and (17).
///
/// ```text
/// v̇_c = k₁ ṡ₁ + v̇_r cos e_θ − v_r sin e_θ (w_r − w)
/// ẇ_c = ẇ_r + k₂ (v̇_r s₂ + v_r ṡ₂) + k₃ cos e_θ (w_r − w)
/// ```
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | w | `turn_rate`, measured | rad/s |
/// | ṡ₁, ṡ₂ | Eq. (17) at the present errors | m/s with A = B = D |
#[inline(always)]
pub fn command_rate<T: Scalar>(
    gains: &TrackingGains<T>,
    reference: &Reference<T>,
    heading: (T, T),
    turn_rate: T,
    s2: T,
    (ds1, ds2): (T, T),
) -> Accel<T> {
    let (sine, cosine) = heading;
    let (twist, accel) = (reference.twist(), reference.accel());
    let heading_rate = twist.angular - turn_rate;
    Accel {
        linear: gains.k1 * ds1 + accel.linear * cosine - twist.linear * sine * heading_rate,
        angular: accel.angular
            + gains.k2 * (accel.linear * s2 + twist.linear * ds2)
            + gains.k3 * cosine * heading_rate,
    }
}

/// First values of the pose neurons, and what they could not carry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<T> {
    /// s₁(0), in [−D, B].
    pub s1: T,
    /// s₂(0), in [−D, B].
    pub s2: T,
    /// b(0): added to the command and faded out as exp(−A t). Zero if (18) could be met.
    pub transition_offset: Twist<T>,
}

/// Start without a jump: the first command equals the measured twist. Eqs. (18) and (19), for any start.
///
/// ```text
/// s₁(0) = (v(0) − v_r cos e_θ)/k₁
/// s₂(0) = (w(0) − w_r − k₃ sin e_θ)/(k₂ v_r)
/// ```
///
/// The paper has v(0) = w(0) = 0. Its (18) cannot be met where it leaves [−D, B] (low v_r: only
/// 41 % of headings at 0.05 m/s with the default gains) or divides by v_r = 0. There the neurons
/// are clipped and a transition offset per command carries the rest: a neuron without input, so it fades
/// with the neurons' own rate A and keeps every bound.
#[inline(always)]
pub fn start<T: Scalar>(
    gains: &TrackingGains<T>,
    shunting: &Shunting<T>,
    reference: &Twist<T>,
    heading: (T, T),
    twist: &Twist<T>,
) -> Start<T> {
    let (sine, cosine) = heading;
    let ahead = twist.linear - reference.linear * cosine;
    let turn = twist.angular - reference.angular - gains.k3 * sine;
    let (s1, bridge_linear) = carry(shunting, ahead, gains.k1);
    let (s2, bridge_angular) = carry(shunting, turn, gains.k2 * reference.linear);
    let transition_offset = Twist {
        linear: bridge_linear,
        angular: bridge_angular,
    };
    Start {
        s1,
        s2,
        transition_offset,
    }
}

/// Splits `desired` into gain · s with s in [−D, B], and a rest that is zero if s could carry it all.
#[inline(always)]
pub(crate) fn carry<T: Scalar>(shunting: &Shunting<T>, desired: T, gain: T) -> (T, T) {
    if gain == T::ZERO {
        return (T::ZERO, desired);
    }
    // May be infinite for a tiny gain; the clip is by comparison, so that is fine.
    let ideal = desired / gain;
    if shunting.contains(ideal) {
        (ideal, T::ZERO)
    } else {
        let state = shunting.clip(ideal);
        (state, desired - gain * state)
    }
}
