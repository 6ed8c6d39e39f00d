//! Coulomb friction of two wheels on one body.

use controller_core::robot::Robot;
use controller_core::types::{WheelSpeeds, WheelTorques};

/// Friction that stops a wheel and holds it: a torque up to a limit, as large as it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Friction {
    limit_nm: f64,
    /// Angular acceleration of a wheel per torque on itself, (right, left), and on the other
    /// one \[1/(kg m²)\].
    own: (f64, f64),
    other: f64,
}

/// Gauss-Seidel sweeps. Each shrinks the error by (other/own)² < 1; for the base here, 0.6.
const SWEEPS: usize = 60;

impl Friction {
    pub(super) fn new(robot: &Robot<f64>, limit_nm: f64) -> Self {
        let (right, left) = (robot.wheels.radius_right_m, robot.wheels.radius_left_m);
        let half = 0.5 * robot.wheels.track_m;
        let (along, about) = (1.0 / robot.mass_kg, half * half / robot.inertia_kg_m2);
        Self {
            limit_nm,
            own: (
                (along + about) / (right * right),
                (along + about) / (left * left),
            ),
            other: (along - about) / (right * left),
        }
    }

    /// What friction leaves of `torques` over the next `h` \[s\].
    ///
    /// For each wheel: its speed at the end is zero, or friction is at its limit against it. Found by
    /// projected Gauss-Seidel on the two coupled conditions.
    pub(super) fn reduce(
        &self,
        torques: &WheelTorques<f64>,
        speeds: &WheelSpeeds<f64>,
        h: f64,
    ) -> WheelTorques<f64> {
        let limit = self.limit_nm;
        let (mut right, mut left) = (0.0_f64, 0.0_f64);
        for _ in 0..SWEEPS {
            let net = (torques.right - right, torques.left - left);
            let end = speeds.right + h * (self.own.0 * net.0 + self.other * net.1);
            right = (right + end / (h * self.own.0)).clamp(-limit, limit);
            let net = torques.right - right;
            let end = speeds.left + h * (self.own.1 * (torques.left - left) + self.other * net);
            left = (left + end / (h * self.own.1)).clamp(-limit, limit);
        }
        WheelTorques {
            right: torques.right - right,
            left: torques.left - left,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn friction() -> Friction {
        Friction::new(&Robot::paper(), 0.2)
    }

    #[test]
    fn a_torque_below_the_limit_moves_nothing_and_one_above_loses_the_limit() {
        let rest = WheelSpeeds {
            right: 0.0,
            left: 0.0,
        };
        let small = WheelTorques {
            right: 0.15,
            left: -0.1,
        };
        let left = friction().reduce(&small, &rest, 1.0e-3);
        // What the sweeps leave: 0.6^60 of 0.2 N m, and rounding.
        assert!(
            left.right.abs() < 1.0e-12 && left.left.abs() < 1.0e-12,
            "{left:?}"
        );
        let large = WheelTorques {
            right: 1.0,
            left: 1.0,
        };
        let left = friction().reduce(&large, &rest, 1.0e-3);
        assert!((left.right - 0.8).abs() < 1.0e-12 && (left.left - 0.8).abs() < 1.0e-12);
    }

    #[test]
    fn a_rolling_robot_is_braked_and_stops() {
        let none = WheelTorques::default();
        let fast = WheelSpeeds {
            right: 1.0,
            left: 1.0,
        };
        let braking = friction().reduce(&none, &fast, 1.0e-3);
        assert!((braking.right + 0.2).abs() < 1.0e-12);
        // Slow enough to stop within the step: exactly what stops it, m r v/(2 h).
        let slow = WheelSpeeds {
            right: 1.0e-4,
            left: 1.0e-4,
        };
        let stopping = friction().reduce(&none, &slow, 1.0e-3);
        let wanted = -30.0 * 0.1 * 1.0e-5 / 2.0e-3;
        assert!((stopping.right - wanted).abs() < 1.0e-12, "{stopping:?}");
    }
}
