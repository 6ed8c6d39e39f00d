//! What tyres lose of what their wheels turn.
//!
//! A tyre transmits a force only where it slips: as long as it grips, its rim turns faster than it rolls by the share F/(C N) of the
//! force F and the load N, and pushed aside by F it moves aside by that share of its speed (the linear part of every model of tyres; C is
//! some 10 to 30 for rubber, and more for hard wheels). Forces accelerate the base, so that of one number κ = 1/(C g) \[s²/m\],
//! larger where a caster takes some of the load, follows all that odometry has to take off. Bodies that are hard to turn push their tyres
//! hard: with I = 15 kg m² on 30 kg and 0.5 m a turn that begins at 1 m/s loses 50 mrad per rad/s at C = 16, until it ends.

use crate::scalar::Scalar;
use crate::types::{Accel, Twist};

/// What the tyres of a base have to transmit, as shares of way and turn that they lose where κ is 1 s²/m: (a, 4I/(m l²) α) \[m/s²\], \[rad/s²\].
///
/// Each rim pushes with ½ m a ± I α/l on half of the weight, and slips by κ |v| (a ± 2I α/(m l)): both alike is way that is lost, and the difference
/// over l is turn. `turning` is 4I/(m l²), [`Robot::turning_load`](crate::robot::Robot::turning_load).
pub(crate) fn strain<T: Scalar>(accel: &Accel<T>, turning: T) -> Accel<T> {
    Accel {
        linear: accel.linear,
        angular: turning * accel.angular,
    }
}

/// How far the direction in which a base moves is from its heading \[rad\]: −κ |v| w, for v w accelerates it aside.
pub(crate) fn drift_angle<T: Scalar>(slip: T, twist: &Twist<T>) -> T {
    -(slip * twist.linear.abs() * twist.angular)
}
