//! Which wheels roll, for the compensation of their stiction.
//!
//! What breaks a standing wheel loose is more than what it needs to roll. By the measured speed alone the motor layer takes it back
//! over ten blends ([`crate::motor`]): a wheel that is to roll more slowly is pushed on all the time, by up to twice its friction, and
//! the disturbance estimate is not made for as much. So it is taken back at once where a wheel has come loose, and given again where
//! it has come to a halt.

use crate::scalar::Scalar;
use crate::types::{WheelSpeeds, WheelsRolling};

/// A wheel rolls from this share of the commanded speed on.
const LOOSE: f64 = 0.5;
/// It has come to a halt below this share: a count is overdue by five times the time that it should take.
const HALTED: f64 = 0.2;

/// Whether wheels that roll still do, by their commanded and measured speeds.
pub(super) fn rolling<T: Scalar>(
    before: WheelsRolling,
    commanded: &WheelSpeeds<T>,
    measured: &WheelSpeeds<T>,
) -> WheelsRolling {
    WheelsRolling {
        right: rolls(before.right, commanded.right, measured.right),
        left: rolls(before.left, commanded.left, measured.left),
    }
}

fn rolls<T: Scalar>(before: bool, commanded: T, measured: T) -> bool {
    let share = T::from_f64(if before { HALTED } else { LOOSE });
    let along = if commanded < T::ZERO {
        -measured
    } else {
        measured
    };
    along > share * commanded.abs()
}

#[cfg(test)]
mod tests {
    use super::rolls;

    #[test]
    fn a_wheel_is_loose_at_half_and_halted_at_a_fifth_of_its_command() {
        for way in [1.0, -1.0] {
            assert!(!rolls(false, way, 0.4 * way) && rolls(false, way, 0.6 * way));
            assert!(rolls(true, way, 0.4 * way) && !rolls(true, way, 0.1 * way));
            // The other way it has to be broken loose anew.
            assert!(!rolls(true, way, -0.6 * way));
        }
        assert!(!rolls(true, 0.0, 0.0));
    }
}
