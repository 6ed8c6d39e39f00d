//! From command and measured twist to a wrench, and back where the wheels cannot exert it.

use super::params::ValidMotionParams;
use crate::scalar::Scalar;
use crate::torque;
use crate::types::{Accel, Twist, Wrench};

/// The wrench that the law asks for: feed-forward, velocity loop, and the estimated `disturbance`
/// compensated.
pub(crate) fn wrench<T: Scalar>(
    motion: &ValidMotionParams<T>,
    rate: &Accel<T>,
    velocity_error: &Twist<T>,
    disturbance: &Wrench<T>,
) -> Wrench<T> {
    let robot = &motion.params().robot;
    let driving = torque::wrench(robot, motion.loops, velocity_error, rate);
    Wrench {
        force: driving.force - disturbance.force,
        moment: driving.moment - disturbance.moment,
    }
}

/// Back-calculation: the commanded twist that would have asked for just the `applied` wrench, with the
/// twist as measured and `rate` fed forward.
pub(crate) fn achieved<T: Scalar>(
    motion: &ValidMotionParams<T>,
    rate: &Accel<T>,
    twist: &Twist<T>,
    applied: &Wrench<T>,
    disturbance: &Wrench<T>,
) -> Twist<T> {
    let params = motion.params();
    let (robot, gains) = (&params.robot, &params.gains);
    let (f, n) = (
        (applied.force + disturbance.force) / robot.mass_kg,
        (applied.moment + disturbance.moment) / robot.inertia_kg_m2,
    );
    let v = twist.linear + (f - rate.linear) / gains.speed_loop;
    let w = twist.angular + (n - rate.angular) / gains.turn_loop;
    motion.reachable(&Twist::new(v, w))
}

/// The robot stands, and the torque that is left is a step of less than L dt: it may be let go. Where no friction stops it, it goes
/// on with the speed that it has then, and so leaves its goal again: of a tenth of a millimetre a second nobody sees that.
pub(crate) fn stands<T: Scalar>(
    motion: &ValidMotionParams<T>,
    command: &Twist<T>,
    velocity_error: &Twist<T>,
    wrench: &Wrench<T>,
    dt: T,
) -> bool {
    let still = T::from_f64(1.0e-4);
    command.linear.abs() < still
        && command.angular.abs() < still
        && velocity_error.linear.abs() < still
        && velocity_error.angular.abs() < still
        && wrench.force.abs() <= motion.force_rate_limit() * dt
        && wrench.moment.abs() <= motion.moment_rate_limit() * dt
}
