//! Theorem 4 of `docs/proofs.md` by trial, where a float changes its kind: what leaves the governor is within the limits.

use super::*;
use crate::maths::Single;
use crate::motion::{MotionParams, SaturationPolicy};
use crate::robot::Robot;

const LIMITS: Limits<f32> = Limits {
    speed: 1.1,
    turn_rate: 2.3,
    // A track of 0.5 m: both at once would be 1.675.
    rim_speed: 1.3,
    accel: 0.7,
    brake: 1.3,
    turn_accel: 3.1,
    jerk: 17.0,
    turn_jerk: 41.0,
    wheel_torque_nm: 8.0,
    policy: SaturationPolicy::KeepCurvature,
};

/// Both ends of [-most, most], what lies next to them, around zero and in between.
fn within(most: f32) -> [f32; 10] {
    let least = f32::from_bits(1);
    [
        -most,
        -most.next_down(),
        -0.3 * most,
        -f32::MIN_POSITIVE,
        -0.0,
        least,
        f32::EPSILON,
        0.7 * most,
        most.next_down(),
        most,
    ]
}

/// Anything that a setpoint may be.
const ANY: [f32; 13] = [
    0.0,
    1.0e-45,
    -1.0e-38,
    1.0e-6,
    -0.3,
    0.7,
    -1.1,
    1.3,
    2.3,
    -1.0e3,
    1.0e30,
    -f32::MAX,
    f32::INFINITY,
];

/// From the shortest tick there is to the longest that is accepted.
const TICKS: [f32; 9] = [
    1.0e-45, 1.2e-38, 1.0e-20, 1.0e-6, 1.0e-3, 1.0e-2, 0.5, 30.0, 1.0e3,
];

#[test]
fn a_command_within_the_limits_stays_there_for_every_setpoint_and_tick() {
    let mut tried = 0_u32;
    for policy in [
        SaturationPolicy::KeepCurvature,
        SaturationPolicy::TurnFirst,
        SaturationPolicy::DriveFirst,
    ] {
        let limits = Limits { policy, ..LIMITS };
        let motion = MotionParams::new_with::<Single>(Robot::paper(), limits)
            .validate()
            .expect("in range");
        let most = if limits.accel > limits.brake {
            limits.accel
        } else {
            limits.brake
        };
        let (speeds, turns) = (within(limits.speed), within(limits.turn_rate));
        let (accels, turn_accels) = (within(most), within(limits.turn_accel));
        for i in 0..speeds.len() {
            for j in 0..accels.len() {
                let command = Command {
                    twist: motion.reachable(&Twist::new(speeds[i], turns[j])),
                    rate: Accel::new(accels[j], turn_accels[(i + 3) % accels.len()]),
                };
                for (k, v) in ANY.into_iter().enumerate() {
                    for (l, a) in ANY.into_iter().enumerate() {
                        let setpoint = Setpoint {
                            twist: Twist::new(v, ANY[l]),
                            rate: Accel::new(a, -ANY[k]),
                        };
                        for dt in TICKS {
                            let (next, _) = command.advance(&motion, &setpoint, dt);
                            check(&limits, most, &command, &next, dt);
                            // Two products and a sum, each rounded, here and where it was limited.
                            let rim = motion.rim_speed(&next.twist);
                            let rounded = 1.0 + 8.0 * f32::EPSILON;
                            assert!(
                                rim <= rounded * limits.rim_speed,
                                "{command:?} {next:?} {dt}"
                            );
                            tried += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(tried > 400_000);
}

/// Exactly within what is compared; moved by no more than the limits' rates and a rounding of what is summed.
fn check(limits: &Limits<f32>, accel: f32, from: &Command<f32>, to: &Command<f32>, dt: f32) {
    let context = (from, to, dt);
    assert!(to.twist.linear.abs() <= limits.speed, "{context:?}");
    assert!(to.twist.angular.abs() <= limits.turn_rate, "{context:?}");
    assert!(to.rate.linear.abs() <= accel, "{context:?}");
    assert!(to.rate.angular.abs() <= limits.turn_accel, "{context:?}");
    let moved = |a: f32, b: f32, step: f32, size: f32| {
        // Two products, a quotient and a sum, each rounded.
        (f64::from(b) - f64::from(a)).abs()
            <= f64::from(step) * (1.0 + 4.0 * f64::from(f32::EPSILON))
                + f64::from(size) * f64::from(f32::EPSILON)
    };
    let (v, w) = (from.twist.linear, from.twist.angular);
    assert!(
        moved(v, to.twist.linear, accel * dt, limits.speed),
        "{context:?}"
    );
    assert!(
        moved(
            w,
            to.twist.angular,
            limits.turn_accel * dt,
            limits.turn_rate
        ),
        "{context:?}"
    );
    let (a, alpha) = (from.rate.linear, from.rate.angular);
    assert!(
        moved(a, to.rate.linear, limits.jerk * dt, accel),
        "{context:?}"
    );
    assert!(
        moved(
            alpha,
            to.rate.angular,
            limits.turn_jerk * dt,
            limits.turn_accel
        ),
        "{context:?}"
    );
}
