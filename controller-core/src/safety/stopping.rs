//! The controlled stop: how it is commanded, and how far the base goes.
//!
//! Both axes come to rest at the same time along the arc that the base is on, (v, w) = s(t) (v₀, w₀), with s
//! from 1 to 0 in an S-curve: constant rate of s′, jerk at both ends.
//!
//! | symbol | what | unit |
//! | --- | --- | --- |
//! | P₀ = max(\|v₀\|/brake, \|w₀\|/turn_accel, τ/(0.75 τ_max)) | 1/P₀ is the largest s′ that the limits allow; τ: torque of the harder worked wheel at s′ = 1/s | s |
//! | P = P₀/(1 − 0.15 min(1, p)) | the same beside the acceleration under way, that fades; p: P₀ of it in place of the speeds, the share of the limits that it uses | s |
//! | Q = 2 max(\|v₀\|/jerk, \|w₀\|/turn_jerk) | 1/Q is the largest s″: half of the jerk, the rest is for the acceleration that was under way | s² |
//! | T = P + Q/P, or 2 √Q where Q > P² | duration; by symmetry ∫ s dt = T/2 | s |
//!
//! An acceleration a under way fades by the transition offset as a (1 − A t) e^(−A t), down to −0.135 a. That much has to be left, or the governor would hold
//! the command back and the stop would go further than planned.
//!
//! The plan is followed as a reference that is anew at the measured pose in every tick: the stop goes by the
//! twist alone. A pose that jumps, drifts or is missing does not disturb it, and no base backs up to where it
//! should have stopped.
//!
//! # Distances
//!
//! [`controlled_stop`] bounds the way of the controlled stop. An electrical brake of time constant τ (m r²
//! R/(2 k²) and the like, from the motors' constants) gives v(t) = v₀ e^(−t/τ), hence v₀ τ; friction makes it
//! shorter. On a release only friction brakes: v₀²/(2 μ g) on a level floor, and on a slope there is no bound.
//! To each of them comes v₀ times the time in which the fault is found ([`crate::safety::Monitor`]) and one tick.

use crate::maths::Maths;
use crate::motion::{Task, ValidMotionParams};
use crate::range::{larger, smaller};
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::{Accel, Pose, Twist, Wrench};

/// How far below zero an acceleration of 1 under way falls while it fades: (1 − A t) e^(−A t) is −e⁻² at A t = 2; a tenth of that is for rounding and ticks.
const FADE: f64 = 0.15;

/// A controlled stop under way: a twist that comes to rest within the limits.
///
/// Made once from the last command and its rate ([`crate::motion::MotionReport::command`]); from then on each tick steps the
/// controller with [`StopPlan::task`], after one [`crate::motion::MotionController::declare_jump`], which lets
/// command and torque go on from where they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StopPlan<T> {
    /// (v₀, w₀).
    twist: Twist<T>,
    /// Largest s′ \[1/s\] and time in which it is reached \[s\].
    rate: T,
    ramp_s: T,
    duration_s: T,
}

impl<T: Scalar> StopPlan<T> {
    /// The plan from a commanded twist and its `rate`. A twist that is not finite gives a plan that is at rest at once; a rate that is no number counts
    /// as one at its limit.
    pub fn new<M: Maths<T>>(
        motion: &ValidMotionParams<T>,
        command: &Twist<T>,
        rate: &Accel<T>,
    ) -> Self {
        let limits = &motion.params().limits;
        let (v, w) = (command.linear, command.angular);
        let used = at_limits(motion, rate.linear, rate.angular);
        let left = T::ONE - T::from_f64(FADE) * smaller(used, T::ONE);
        let p = at_limits(motion, v, w) / left;
        let q = T::from_f64(2.0) * larger(v.abs() / limits.jerk, w.abs() / limits.turn_jerk);
        let sum = p + q;
        if !(command.is_finite() && sum > T::ZERO && sum.is_finite()) {
            return Self::default();
        }
        // The rate that the jerk allows is reached in the middle and left again.
        let p = larger(p, M::sqrt(q));
        let ramp_s = q / p;
        Self {
            twist: *command,
            rate: T::ONE / p,
            ramp_s,
            duration_s: p + ramp_s,
        }
    }

    /// Time until the command is zero \[s\].
    pub fn duration_s(&self) -> T {
        self.duration_s
    }

    /// Twist and acceleration, `t` \[s\] after the begin. Zero at the end and after it.
    pub fn at(&self, t: T) -> (Twist<T>, Accel<T>) {
        let (share, rate) = self.share(t);
        let Twist { linear, angular } = self.twist;
        (
            Twist::new(share * linear, share * angular),
            Accel::new(rate * linear, rate * angular),
        )
    }

    /// The reference of the controller in the tick at `t` \[s\], which lasts for `dt` \[s\], at the measured pose.
    pub fn task<M: Maths<T>>(&self, t: T, dt: T, pose: &Pose<T>) -> Task<T> {
        let (twist, _) = self.at(t);
        // Held for a tick: that of its middle. In the first tick none, as it was: a step of it would get a transition offset
        // like an acceleration under way, and lengthen the stop.
        let middle = if t > T::ZERO { t + T::HALF * dt } else { t };
        let (_, accel) = self.at(middle);
        Task::Follow(Reference::new_with::<M>(*pose, twist, accel))
    }

    /// s and s′ at `t`.
    fn share(&self, t: T) -> (T, T) {
        let left = self.duration_s - t;
        // Also where there is nothing to stop, and for a time that is not a number.
        if !(left > T::ZERO && self.ramp_s > T::ZERO) {
            return (T::ZERO, T::ZERO);
        }
        let jerk = self.rate / self.ramp_s;
        if t <= T::ZERO {
            (T::ONE, T::ZERO)
        } else if t < self.ramp_s {
            (T::ONE - T::HALF * jerk * t * t, -(jerk * t))
        } else if left < self.ramp_s {
            (T::HALF * jerk * left * left, -(jerk * left))
        } else {
            let share = T::ONE - self.rate * (t - T::HALF * self.ramp_s);
            (share, -self.rate)
        }
    }
}

/// How long a change of speeds takes with an acceleration at its limit \[s\]; of accelerations that is the share of the limits that they use.
// Apart: it is asked twice.
#[inline(never)]
fn at_limits<T: Scalar>(motion: &ValidMotionParams<T>, linear: T, angular: T) -> T {
    let (limits, robot) = (&motion.params().limits, &motion.params().robot);
    let torques = motion.wheels().torques(&Wrench {
        force: robot.mass_kg * linear,
        moment: robot.inertia_kg_m2 * angular,
    });
    let torque = larger(torques.right.abs(), torques.left.abs());
    larger(
        larger(
            linear.abs() / limits.brake,
            angular.abs() / limits.turn_accel,
        ),
        torque / limits.command_torque_nm(),
    )
}

/// Bounds on a controlled stop on a level floor, for a base that is what its parameters say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopping<T> {
    /// Way along the path, forward or backward \[m\].
    pub distance_m: T,
    /// Turn \[rad\].
    pub angle_rad: T,
    /// Time until the base counts as resting \[s\]: command at zero, and what was left of acceleration and
    /// velocity error faded to a hundredth.
    pub time_s: T,
}

/// How far a controlled stop goes at most from a commanded twist and its `rate` (both of the last report), with
/// the robot's twist differing by `error` (measured minus commanded; zero where no wheel slips and no torque is
/// at its limit).
///
/// ```text
/// d = |v₀| T/2 + |a|/A² + (|δ_v| + b(a, j))/κ₁     φ = |w₀| T/2 + |α|/A² + (|δ_w| + b(α, j_w))/κ₂
///
/// b(a, j) = a²/j (1 − q)³ (1 + 4 q),  q = j/(4 A |a|);  0 where q ≥ 1
/// ```
///
/// | term | what |
/// | --- | --- |
/// | v₀ T/2 | the plan |
/// | a/A² | the acceleration under way when the stop begins fades with the transition offset, of decay A |
/// | δ/κ | the velocity loop takes the error away as e^(−κt) |
/// | b/κ | b is the speed that the jerk limit j lets pass while a fades |
///
/// For ticks without length; for those of dt there come v₀ 2 dt + 2 a dt/A (and the same of w₀, α): the torque of
/// the last tick still acts, the plan begins with the next, and the transition offset begins with what a adds meanwhile.
pub fn controlled_stop<T: Scalar, M: Maths<T>>(
    motion: &ValidMotionParams<T>,
    command: &Twist<T>,
    rate: &Accel<T>,
    error: &Twist<T>,
) -> Stopping<T> {
    let plan = StopPlan::new::<M>(motion, command, rate);
    let gains = motion.gains();
    let half = T::HALF * plan.duration_s;
    let area = gains.decay * gains.decay;
    let slowest = if gains.speed_loop < gains.turn_loop {
        gains.speed_loop
    } else {
        gains.turn_loop
    };
    let limits = &motion.params().limits;
    let (a, alpha) = (rate.linear.abs(), rate.angular.abs());
    // e^(-4.6) is a hundredth; 7 of the transition offset, whose pole is double, or as long as half of the jerk takes.
    let two = T::from_f64(2.0);
    let held = larger(two * a / limits.jerk, two * alpha / limits.turn_jerk);
    let fading = larger(T::from_f64(7.0) / gains.decay, held) + T::from_f64(4.6) / slowest;
    let passed = held_back(a, limits.jerk, gains.decay);
    let turned = held_back(alpha, limits.turn_jerk, gains.decay);
    Stopping {
        distance_m: command.linear.abs() * half
            + a / area
            + (error.linear.abs() + passed) / gains.speed_loop,
        angle_rad: command.angular.abs() * half
            + alpha / area
            + (error.angular.abs() + turned) / gains.turn_loop,
        time_s: plan.duration_s + fading,
    }
}

/// Bound on the speed that the jerk limit lets pass while an acceleration `a` under way ends \[m/s\] or \[rad/s\].
///
/// ```text
/// b = ∫ max(0, a − j t/2 − a (1 − A t) e^(−A t)) dt ≤ a²/j (1 − q)³ (1 + 4 q),     q = j/(4 A a)
/// ```
///
/// The transition offset wants a to fade as a (1 − A t) e^(−A t), at first by 2 A a a second. The plan takes half of the jerk j, so what is fed
/// forward fades by j/2 at least and is above what is wanted until the two meet, not at all where q ≥ 1. The bound has both limits of the integral,
/// a²/j for j → 0 and a zero of third order at q = 1, and is between them above it by 0.13 a²/j at most (a test integrates).
fn held_back<T: Scalar>(a: T, jerk: T, decay: T) -> T {
    let q = jerk / (T::from_f64(4.0) * decay * a);
    let left = T::ONE - q;
    // Without an acceleration q is infinite.
    if left <= T::ZERO {
        return T::ZERO;
    }
    a * a / jerk * left * left * left * (T::ONE + T::from_f64(4.0) * q)
}

/// How far a controlled stop goes at most straight on from `speed` \[m\], if the base was speeding up as hard as
/// it may: [`controlled_stop`] without turning and without a velocity error.
pub fn controlled_stop_distance<T: Scalar, M: Maths<T>>(
    motion: &ValidMotionParams<T>,
    speed: T,
) -> T {
    let limits = &motion.params().limits;
    let command = Twist::new(speed, T::ZERO);
    let rate = Accel::new(larger(limits.accel, limits.brake), T::ZERO);
    controlled_stop::<T, M>(motion, &command, &rate, &Twist::default()).distance_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::Libm;
    use crate::motion::{Limits, MotionParams};
    use crate::paper::params::Params;

    fn motion(wheel_torque_nm: f64) -> ValidMotionParams<f64> {
        let limits = Limits {
            brake: 1.2,
            wheel_torque_nm,
            ..Limits::PAPER
        };
        let params = MotionParams::new_with::<Libm>(Params::paper().robot, limits);
        params.validate().expect("valid")
    }

    /// Summed in steps of 1 ms: way v₀ T/2, limits kept, and value and rate belong together. `rate` is a share of each limit.
    #[test]
    fn plan_keeps_the_limits_and_its_way_is_half_of_its_time() {
        for (torque, rate) in [
            (15.0, 0.0),
            (1.0, 0.0),
            (15.0, 0.3),
            (15.0, 1.0),
            (1.0, 1.0),
        ] {
            let motion = motion(torque);
            let left = 1.0 - 0.15 * rate;
            let rate = Accel::new(rate * 1.2, rate * 3.0);
            // At 1 N m the acceleration takes all of the torque.
            let torque_left = 0.75 * torque * if torque > 1.0 { 1.0 } else { left };
            for (v, w) in [
                (2.5, 0.0),
                (-1.0, 0.0),
                (0.02, 0.0),
                (0.0, 3.0),
                (1.0, -2.0),
            ] {
                let plan = StopPlan::new::<Libm>(&motion, &Twist::new(v, w), &rate);
                let (mut way, dt) = (0.0, 1e-3);
                let (mut last, mut last_accel) = plan.at(0.0);
                assert_eq!(last, Twist::new(v, w));
                for k in 1..20_000 {
                    let (twist, accel) = plan.at(f64::from(k) * dt);
                    way += 0.5 * dt * (twist.linear + last.linear);
                    // One rounding above the limits.
                    assert!(accel.linear.abs() <= left * 1.2 + 1e-9);
                    assert!(accel.angular.abs() <= left * 3.0 + 1e-9);
                    let jerk = (accel.linear - last_accel.linear).abs() / dt;
                    assert!(jerk <= 10.0 + 1e-6, "half of the limit, {jerk}");
                    let mean = 0.5 * (accel.linear + last_accel.linear);
                    // Trapezoids of a curve that is linear but for three corners: jerk dt²/8 each.
                    assert!((twist.linear - last.linear - mean * dt).abs() < 1e-5);
                    let wheels = motion.wheels().torques(&Wrench {
                        force: 30.0 * accel.linear,
                        moment: 15.0 * accel.angular,
                    });
                    assert!(wheels.right.abs().max(wheels.left.abs()) <= torque_left + 1e-9);
                    (last, last_accel) = (twist, accel);
                }
                assert_eq!(last, Twist::default());
                assert!(
                    (way - 0.5 * v * plan.duration_s()).abs() < 1e-5,
                    "{v} {way}"
                );
            }
        }
    }

    /// The twist of now, and the acceleration of the middle of the tick but in the first one.
    #[test]
    fn a_tick_of_the_plan_has_the_acceleration_of_its_middle() {
        let plan =
            StopPlan::new::<Libm>(&motion(15.0), &Twist::new(1.0, -2.0), &Accel::new(1.2, 3.0));
        let pose = Pose::new(0.3, -0.7, 2.0);
        for (t, dt, middle) in [(0.0, 0.02, 0.0), (0.1, 0.02, 0.11), (0.4, 0.1, 0.45)] {
            let Task::Follow(reference) = plan.task::<Libm>(t, dt, &pose) else {
                panic!("a stop is followed");
            };
            let ((twist, _), (_, accel)) = (plan.at(t), plan.at(middle));
            assert_eq!((reference.twist(), reference.accel()), (&twist, &accel));
            assert_eq!(reference.pose(), &pose);
        }
        assert!(plan.at(0.11).1 != plan.at(0.1).1 && plan.at(0.45).1.linear != 0.0);
    }

    /// The sums of the document, whichever loop is the slower one.
    #[test]
    fn bounds_are_the_sums_of_their_terms() {
        let mut params = *motion(15.0).params();
        let fast = params.gains.speed_loop;
        for (speed_loop, turn_loop) in [(fast, 0.8 * fast), (0.8 * fast, fast)] {
            (params.gains.speed_loop, params.gains.turn_loop) = (speed_loop, turn_loop);
            let motion = params.validate().expect("valid");
            let decay = motion.gains().decay;
            let command = Twist::new(-1.5, 2.0);
            let (rate, error) = (Accel::new(0.7, -1.1), Twist::new(-0.05, 0.08));
            let found = controlled_stop::<_, Libm>(&motion, &command, &rate, &error);
            let duration = StopPlan::new::<Libm>(&motion, &command, &rate).duration_s();
            let square = decay * decay;
            let Limits {
                jerk, turn_jerk, ..
            } = motion.params().limits;
            let (passed, turned) = (
                held_back(0.7, jerk, decay),
                held_back(1.1, turn_jerk, decay),
            );
            let expected = [
                0.5 * 1.5 * duration + 0.7 / square + (0.05 + passed) / speed_loop,
                0.5 * 2.0 * duration + 1.1 / square + (0.08 + turned) / turn_loop,
                duration + 7.0 / decay + 4.6 / (0.8 * fast),
            ];
            let found = [found.distance_m, found.angle_rad, found.time_s];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            }
            // Straight on from a speed, with the larger of both accelerations, 1.5 m/s².
            let straight =
                StopPlan::new::<Libm>(&motion, &Twist::new(2.0, 0.0), &Accel::new(1.5, 0.0));
            let distance = controlled_stop_distance::<_, Libm>(&motion, 2.0);
            let passed = held_back(1.5, jerk, decay) / speed_loop;
            assert!((distance - (straight.duration_s() + 1.5 / square + passed)).abs() < 1e-12);
        }
    }

    /// In steps of a ten-thousandth of 1/A: never below the integral, and above it by 0.13 a²/j at most.
    #[test]
    fn what_the_jerk_lets_pass_is_bounded_by_its_sum() {
        let (a, decay) = (1.5, 6.0);
        assert_eq!(held_back(0.0, 20.0, decay), 0.0);
        for number in 1..60 {
            let q = 0.02 * f64::from(number);
            let jerk = 4.0 * decay * a * q;
            let step = 1e-4 / decay;
            let mut sum = 0.0;
            for k in 0.. {
                let t = f64::from(k) * step;
                let more = a - 0.5 * jerk * t - a * (1.0 - decay * t) * (-decay * t).exp();
                if more < 0.0 && k > 0 {
                    break;
                }
                sum += more.max(0.0) * step;
            }
            let bound = held_back(a, jerk, decay);
            // A step of the sum, of a at most.
            assert!(bound >= sum - a * step, "{q}: {bound} {sum}");
            assert!(bound - sum <= 0.13 * a * a / jerk, "{q}: {bound} {sum}");
        }
    }

    /// Of 2 m/s with brake 1.2, half of a jerk of 20: 2/1.2 + 1.2/10 s from a steady speed, 2/1.02 + 1.02/10 s from an acceleration at its limit.
    #[test]
    fn a_steady_base_has_all_of_its_brake_to_stop() {
        let motion = motion(15.0);
        for (rate, duration) in [(0.0, 2.0 / 1.2 + 0.12), (1.2, 2.0 / 1.02 + 0.102)] {
            let rate = Accel::new(rate, 0.0);
            let plan = StopPlan::new::<Libm>(&motion, &Twist::new(2.0, 0.0), &rate);
            assert!((plan.duration_s() - duration).abs() < 1e-12);
        }
        let nonsense = Accel::new(f64::NAN, 0.0);
        let plan = StopPlan::new::<Libm>(&motion, &Twist::new(2.0, 0.0), &nonsense);
        assert!(plan.duration_s().is_finite());
    }

    #[test]
    fn a_plan_for_nothing_or_nonsense_is_at_rest() {
        let motion = motion(15.0);
        for twist in [
            Twist::default(),
            Twist::new(f64::NAN, 1.0),
            Twist::new(1.0, f64::INFINITY),
        ] {
            let plan = StopPlan::new::<Libm>(&motion, &twist, &Accel::default());
            assert_eq!(plan.duration_s(), 0.0);
            let (twist, accel) = plan.at(0.0);
            assert_eq!((twist, accel), (Twist::default(), Accel::default()));
        }
    }
}
