//! A wrench that the wheels can exert.

use super::limits::SaturationPolicy;
use crate::scalar::Scalar;
use crate::types::{WheelTorques, Wrench};
use crate::wheels::WheelMap;

/// The wrench nearest to `desired`, in the sense of `policy`, whose wheel torques stay within
/// ±`limit`, and whether it differs.
///
/// `limit` > 0. The torques of the result may exceed the limit by rounding only; whoever sends them
/// clips those last bits.
#[inline]
pub fn share<T: Scalar>(
    wheels: &WheelMap<T>,
    desired: &Wrench<T>,
    limit: T,
    policy: SaturationPolicy,
) -> (Wrench<T>, bool) {
    let asked = wheels.torques(desired);
    // What is not a number fits no limit. If it is one wheel's alone, force and moment overflow there with opposite signs: they add up
    // at the other wheel, which is then the largest.
    if largest(&asked) <= limit {
        return (*desired, false);
    }
    (yielding(wheels, *desired, asked, limit, policy), true)
}

/// The shared wrench where the wheels cannot exert what is `asked`.
#[cold]
#[inline(never)]
fn yielding<T: Scalar>(
    wheels: &WheelMap<T>,
    desired: Wrench<T>,
    asked: WheelTorques<T>,
    limit: T,
    policy: SaturationPolicy,
) -> Wrench<T> {
    let force = Wrench {
        force: desired.force,
        moment: T::ZERO,
    };
    let moment = Wrench {
        force: T::ZERO,
        moment: desired.moment,
    };
    let (drive, turn) = match policy {
        SaturationPolicy::KeepCurvature => {
            let scale = limit / largest(&asked);
            (scale, scale)
        }
        SaturationPolicy::TurnFirst => {
            let first = scale_within(&wheels.torques(&moment), limit);
            let rest = room(wheels, &moment, first, &force, limit);
            (rest, first)
        }
        SaturationPolicy::DriveFirst => {
            let first = scale_within(&wheels.torques(&force), limit);
            let rest = room(wheels, &force, first, &moment, limit);
            (first, rest)
        }
    };
    Wrench {
        force: drive * desired.force,
        moment: turn * desired.moment,
    }
}

/// The larger size of both, of the left wheel where that of the right one is no number.
#[inline(always)]
fn largest<T: Scalar>(torques: &WheelTorques<T>) -> T {
    let (right, left) = (torques.right.abs(), torques.left.abs());
    if right > left { right } else { left }
}

/// The largest factor up to 1 that brings both torques within ±limit.
fn scale_within<T: Scalar>(torques: &WheelTorques<T>, limit: T) -> T {
    let largest = largest(torques);
    if largest > limit {
        limit / largest
    } else {
        T::ONE
    }
}

/// The largest factor of `second` in [0, 1] that fits beside `scale` times `first`.
fn room<T: Scalar>(
    wheels: &WheelMap<T>,
    first: &Wrench<T>,
    scale: T,
    second: &Wrench<T>,
    limit: T,
) -> T {
    let (first, second) = (wheels.torques(first), wheels.torques(second));
    let fits = |taken: T, more: T| {
        // Room in the direction of `more`, at least 0 although the last bit may say otherwise.
        let room = if more > T::ZERO {
            limit - scale * taken
        } else {
            limit + scale * taken
        };
        let room = if room > T::ZERO { room } else { T::ZERO };
        if more.abs() > room {
            room / more.abs()
        } else {
            T::ONE
        }
    };
    let right = fits(first.right, second.right);
    let left = fits(first.left, second.left);
    if right < left { right } else { left }
}
