//! The paper's parking: straight to the target, heading by heading. Eqs. (20) and (22).
//!
//! The law has no e_y: what lateral error there is at the hand-over stays, to first order. It is
//! kept as published; see `docs/errata.md`.

use crate::paper::params::ParkingGains;
use crate::scalar::Scalar;
use crate::types::{Accel, Twist};

/// Speed and turn rate to ask for. Eq. (20).
///
/// ```text
/// v_c = k₄ s₁        w_c = k₅ sin s₃
/// ```
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | k₄, k₅ | `gains` | 1/s, rad/s |
/// | s₁ | neuron of e_x | m with A = B = D |
/// | (sin s₃, cos s₃) | `turn`, s₃ the neuron of the wrapped e_θ | |
#[inline(always)]
pub fn command<T: Scalar>(gains: &ParkingGains<T>, s1: T, turn: (T, T)) -> Twist<T> {
    Twist {
        linear: gains.k4 * s1,
        angular: gains.k5 * turn.0,
    }
}

/// Rate of change of the command: time derivative of Eq. (20) along Eq. (22).
///
/// ```text
/// v̇_c = k₄ ṡ₁       ẇ_c = k₅ cos(s₃) ṡ₃
/// ```
#[inline(always)]
pub fn command_rate<T: Scalar>(
    gains: &ParkingGains<T>,
    turn: (T, T),
    (ds1, ds3): (T, T),
) -> Accel<T> {
    Accel {
        linear: gains.k4 * ds1,
        angular: gains.k5 * turn.1 * ds3,
    }
}
