//! Gains of the law for a real base from a design specification.

use super::loops::{lateral_start, longitudinal_start};
use super::margins;
use crate::maths::Maths;
use crate::motion::{
    MotionGains, MotionParams, NOISE_HEADING_RAD, lateral_pair, reach, turning_limits,
};
use crate::range::smaller;
use crate::scalar::Scalar;
use crate::stability::edge;
use crate::tuning::error::{in_range, refused};
use crate::tuning::response::response;
use crate::tuning::{DesignError, DesignParameter, Why};

/// What an owner wants of following and parking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionDesignSpec<T> {
    /// An offset across or along the path has a tenth left after this \[s\], 0.5 to 60. For offsets
    /// that turn the robot by less than some 0.4 rad: up to a fifth of speed times this time.
    pub settling_s: T,
    /// Damping ratio of the lateral pair, 0.6 (10 % overshoot) to 0.98 (none).
    pub damping: T,
    /// The last distance to a goal has a tenth left after this \[s\], 0.5 to 60.
    pub arrival_s: T,
    /// Lag of the speed loop 1/κ₁ \[s\], 1e-3 to 10. Shorter is stiffer against pushes, and noisier.
    pub speed_lag_s: T,
    /// Lag of the turn-rate loop 1/κ₂ \[s\], 1e-3 to 10.
    pub turn_lag_s: T,
    /// Age of the poses \[s\], 0 to 10; stability has to last to twice that.
    pub pose_delay_s: T,
    /// Delay from measurement to torque, half a tick included \[s\], 0 to 1; the same.
    pub torque_delay_s: T,
    /// Standard deviation of the measured position \[m\], 0 to 1: keeps the heading quiet when slow.
    pub pose_noise_m: T,
}

impl<T: Scalar> MotionDesignSpec<T> {
    /// One time for everything, with the rest as it suits a base of 10 ms ticks and fresh poses:
    /// damping 0.8, lags of 1/3 s and 1/5 s, poses 50 ms old, torques 10 ms late, no noise.
    pub fn settling(settling_s: T) -> Self {
        let f = T::from_f64;
        Self {
            settling_s,
            damping: f(0.8),
            arrival_s: settling_s,
            speed_lag_s: f(1.0 / 3.0),
            turn_lag_s: f(0.2),
            pose_delay_s: f(0.05),
            torque_delay_s: f(0.01),
            pose_noise_m: T::ZERO,
        }
    }

    fn check(&self) -> Result<(), DesignError> {
        for (parameter, value, low, high) in [
            (DesignParameter::Settling, self.settling_s, 0.5, 60.0),
            (DesignParameter::Damping, self.damping, 0.6, 0.98),
            (DesignParameter::Arrival, self.arrival_s, 0.5, 60.0),
            (DesignParameter::SpeedLag, self.speed_lag_s, 1.0e-3, 10.0),
            (DesignParameter::TurnLag, self.turn_lag_s, 1.0e-3, 10.0),
            (DesignParameter::PoseDelay, self.pose_delay_s, 0.0, 10.0),
            (DesignParameter::TorqueDelay, self.torque_delay_s, 0.0, 1.0),
            (DesignParameter::PoseNoise, self.pose_noise_m, 0.0, 1.0),
        ] {
            in_range(parameter, value, low, high)?;
        }
        Ok(())
    }
}

/// Gains that meet the specification on this base. Gains that it does not determine stay as they are in `base`.
///
/// With the pair λ² + 2ζωλ + ω² and A given, the lateral loop λ³ + (A + k₃)λ² + A k₃ λ + A c has
///
/// ```text
/// k₃ = 2ζω + ω²/(A − 2ζω)      c = ω² (1 + ω²/(A (A − 2ζω)))
/// ```
///
/// exactly; A is that of the base's gains. ω, k₁ and k₄ are found by bisection such that the loop's response, the transition offset at its
/// start included and for k₄ with the neurons of parking by feedback, has a tenth left at the specified time. The limits are those that
/// [`MotionGains::for_limits`] respects: k₃² ≤ 10/rad turn_accel, (c/k₃)² ≤ turn_accel; k₁, k₄ ≤ 1.2/s √(a/0.6 m/s²),
/// both accelerations with three quarters of the wheels' torque;
/// and k₁, k₄ ≤ A/4, beyond which the robot runs past its goal.
///
/// # Errors
/// The first parameter of the specification that cannot be met, with the nearest value that can.
pub fn gains<T: Scalar, M: Maths<T>>(
    spec: &MotionDesignSpec<T>,
    base: &MotionParams<T>,
) -> Result<MotionGains<T>, DesignError> {
    spec.check()?;
    let f = T::from_f64;
    let a = base.gains.decay;
    let damping = spec.damping;
    let limits = &base.limits;
    let (accel, turn_accel) = reach(&base.robot, limits);
    let brake = smaller(limits.accel, limits.brake);
    let fastest = f(1.2) * M::sqrt(smaller(accel, brake) / f(0.6));

    let settled = |gain: T, neuron: T| {
        let (p, push) = longitudinal_start(gain, neuron, a);
        response(&p, push, f(7.0) / gain).tenth_s
    };
    let run = |gain: T| settled(gain, a);
    let arrive = |approach: T| {
        let gains = MotionGains {
            approach,
            ..base.gains
        };
        settled(approach, gains.approach_decay())
    };
    let most = smaller(fastest, a / f(4.0));

    // Across the path. ω up to where k₃ or c/k₃ reaches what the base can turn, or A − 2ζω gets so small
    // that k₃ is no longer a heading gain but the mirror of A.
    let time = |omega: T| {
        let (k3, c) = lateral_pair(omega, damping, a);
        let (p, push) = lateral_start(k3, c, a);
        response(&p, push, f(9.0) / (damping * omega)).tenth_s
    };
    let (stiffest, steepest) = turning_limits::<T, M>(smaller(turn_accel, limits.turn_accel));
    let neurons = T::HALF * a / (damping + damping);
    let turning = edge(T::ZERO, neurons, |omega| {
        let (k3, c) = lateral_pair(omega, damping, a);
        k3 <= stiffest && c <= k3 * steepest
    });
    let omega = edge(T::ZERO, turning, |omega| time(omega) > spec.settling_s);
    if time(omega) > spec.settling_s * f(1.001) {
        let why = if turning < neurons * f(0.999) {
            if turn_accel < limits.turn_accel {
                Why::Torque
            } else {
                Why::TurnAccel
            }
        } else {
            Why::Neurons
        };
        // Along the path it may take longer still.
        let (aside, longitudinal) = (time(omega), run(most));
        let limit = if longitudinal > aside {
            longitudinal
        } else {
            aside
        };
        return Err(refused(
            DesignParameter::Settling,
            spec.settling_s,
            limit,
            why,
        ));
    }
    let (heading, lateral) = lateral_pair(omega, damping, a);

    let solve = |parameter: DesignParameter, time: &dyn Fn(T) -> T, desired: T| {
        let gain = edge(T::ZERO, most, |gain| time(gain) > desired);
        if time(gain) > desired * f(1.001) {
            let why = if fastest < a / f(4.0) {
                if accel < brake {
                    Why::Torque
                } else {
                    Why::Accel
                }
            } else {
                Why::Neurons
            };
            return Err(refused(parameter, desired, time(gain), why));
        }
        Ok(gain)
    };
    let longitudinal = solve(DesignParameter::Settling, &run, spec.settling_s)?;
    let approach = solve(DesignParameter::Arrival, &arrive, spec.arrival_s)?;

    let gains = MotionGains {
        decay: a,
        longitudinal,
        heading,
        lateral,
        approach,
        speed_loop: T::ONE / spec.speed_lag_s,
        turn_loop: T::ONE / spec.turn_lag_s,
        ..base.gains
    };
    // The base's own suits exact poses.
    let quiet = gains.slow_for(spec.pose_noise_m, f(NOISE_HEADING_RAD));
    let slow = base.gains.slow;
    let gains = MotionGains {
        slow: if quiet > slow { quiet } else { slow },
        ..gains
    };
    survive_delays::<T, M>(spec, &gains)?;
    Ok(gains)
}

fn survive_delays<T: Scalar, M: Maths<T>>(
    spec: &MotionDesignSpec<T>,
    gains: &MotionGains<T>,
) -> Result<(), DesignError> {
    let worst = margins::<T, M>(gains).worst();
    for (parameter, delay, margin) in [
        (
            DesignParameter::PoseDelay,
            spec.pose_delay_s,
            worst.pose_delay_s,
        ),
        (
            DesignParameter::TorqueDelay,
            spec.torque_delay_s,
            worst.torque_delay_s,
        ),
    ] {
        if delay + delay > margin {
            return Err(refused(parameter, delay, T::HALF * margin, Why::Delay));
        }
    }
    Ok(())
}
