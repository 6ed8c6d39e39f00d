//! The turn rate that takes back an error of the heading, no faster than the base can stop turning.

use super::manoeuvre::PLAN_SHARE;
use crate::maths::Maths;
use crate::range::{larger, signed};
use crate::scalar::Scalar;

/// Share of the base's angular acceleration that the demand brakes with: the rest is for the lag of the velocity loop, jerk, and what
/// the reference asks for meanwhile.
const BRAKING: f64 = 0.8;

/// e₁/e₀. An error e that fades with k₃ takes k₃² e; beside a plan that brakes 5 % of the acceleration is left for it, 1/16 of p.
const LEFT_BY_A_PLAN: f64 = (1.0 - PLAN_SHARE) / BRAKING;

/// Turn rate by error of the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TurnDemand<T> {
    /// k₃.
    gain: T,
    /// p.
    brake: T,
    /// e₀.
    knee: T,
}

/// Turn rate that an error asks for, on top of the reference's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turn<T> {
    /// w \[rad/s\].
    pub(crate) rate: T,
    /// Its derivative by the error \[1/s\].
    pub(crate) by_error: T,
    /// The derivative of the whole rate by the reference's.
    pub(crate) by_reference: T,
}

impl<T: Scalar> TurnDemand<T> {
    /// For k₃ \[1/s\] and the angular acceleration that a command may have \[rad/s²\].
    pub(crate) fn new(gain: T, turn_accel: T) -> Self {
        let brake = T::from_f64(BRAKING) * turn_accel;
        Self {
            gain,
            brake,
            knee: brake / (gain * gain),
        }
    }

    /// w(e, ω), with the derivatives of ω + w by both:
    ///
    /// ```text
    /// w = k₃ e                                  ∂/∂e = k₃           ∂/∂ω = 1            |e| ≤ e_ω
    /// w = ± (√(B² + 2p (|e| − e_ω)) − ω)        ∂/∂e = p/(ω + |w|)  ∂/∂ω = B/(ω + |w|)  beyond
    /// e_ω = max(e₀ − ω/k₃, e₁)      e₀ = p/k₃²      e₁ = e₀/16      B = ω + k₃ e_ω
    /// ```
    ///
    /// | symbol | what | unit |
    /// | --- | --- | --- |
    /// | e | s₂ + sin e_θ + s₃ | rad |
    /// | p | angular acceleration to brake with | rad/s² |
    /// | ω | of `ending`, the turn rate of a reference that will brake as hard as the base can; 0 if that goes away from the robot | rad/s |
    ///
    /// Values are continuous, and slopes where e_ω is above e₁. A robot that turns at w(e, 0) towards e = 0, ė = −w, brakes with
    /// w′ w: p beyond e₀ and less within, so it does not turn past, whatever k₃ is. In the paper w is k₃ e for all errors; then it needs k₃ w.
    ///
    /// Behind a reference that brakes itself, with α, what is taken back of the error has to be braked as well. There ω + w is the rate
    /// at which the base stops where the reference does, and it brakes with (B α + p |w|)/(ω + |w|), between both. As ω falls below p/k₃
    /// the linear part grows again to e₀: of the reference's braking, hardly anything is left then.
    #[inline(always)]
    pub(crate) fn at<M: Maths<T>>(&self, error: T, ending: Option<T>) -> Turn<T> {
        let size = error.abs();
        let linear = Turn {
            rate: self.gain * error,
            by_error: self.gain,
            by_reference: T::ONE,
        };
        // Most errors are below any knee.
        if ending.is_some() && size <= self.least_knee() {
            return linear;
        }
        let behind = behind(error, ending);
        let knee = self.knee_behind(behind);
        if size <= knee {
            return linear;
        }
        let p = self.brake;
        if behind == T::ZERO {
            // The root below for ω = 0, in fewer operations; following has nothing else.
            let square = p * (size + size - knee);
            let inverse = M::inverse_sqrt(square);
            return Turn {
                rate: signed(square * inverse, error),
                by_error: p * inverse,
                by_reference: T::ONE,
            };
        }
        let begin = behind + self.gain * knee;
        let square = begin * begin + (p + p) * (size - knee);
        let inverse = M::inverse_sqrt(square);
        Turn {
            rate: signed(square * inverse - behind, error),
            by_error: p * inverse,
            by_reference: begin * inverse,
        }
    }

    /// e of a turn rate w, the inverse of [`at`](Self::at).
    pub(crate) fn error_of(&self, rate: T, ending: Option<T>) -> T {
        let (size, behind) = (rate.abs(), behind(rate, ending));
        let knee = self.knee_behind(behind);
        if size / self.gain <= knee {
            return rate / self.gain;
        }
        let error = if behind == T::ZERO {
            T::HALF * (size * size / self.brake + knee)
        } else {
            let (begin, all) = (behind + self.gain * knee, behind + size);
            knee + T::HALF * (all * all - begin * begin) / self.brake
        };
        signed(error, rate)
    }

    /// e_ω.
    #[inline(always)]
    fn knee_behind(&self, behind: T) -> T {
        if behind == T::ZERO {
            self.knee
        } else {
            larger(self.knee - behind / self.gain, self.least_knee())
        }
    }

    /// e₁.
    #[inline(always)]
    fn least_knee(&self) -> T {
        T::from_f64(LEFT_BY_A_PLAN) * self.knee
    }
}

/// Rate of a reference that ends, towards which an `error` or a rate is; 0 of another one, and of one that goes the other way.
#[inline(always)]
fn behind<T: Scalar>(error: T, ending: Option<T>) -> T {
    match ending {
        Some(rate) if (rate > T::ZERO) == (error > T::ZERO) => rate.abs(),
        _ => T::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::TurnDemand;
    use crate::maths::Libm;
    use crate::motion::manoeuvre::PLAN_SHARE;

    /// Where the robot can stop: from w it takes w²/(2p) at p, and what is left at the knee fades with k₃.
    #[test]
    fn a_robot_that_brakes_as_asked_stops_at_no_error() {
        let demand = TurnDemand::<f64>::new(5.0, 0.9);
        let brake = 0.8 * 0.9;
        let dt = 1.0e-4;
        for start in [1.5_f64, -1.5, 0.4] {
            let mut error = start;
            let mut last = demand.at::<Libm>(error, None).rate;
            for _ in 0..100_000 {
                error -= dt * last;
                let turn = demand.at::<Libm>(error, None);
                let braked = (last - turn.rate).abs() / dt;
                // Of a step: the slope changes by no more than k₃² dt of itself.
                assert!(braked < brake * (1.0 + 25.0 * dt), "{braked} at {error}");
                assert!((turn.by_error * turn.rate).abs() <= brake * (1.0 + 1e-12));
                assert!(error * start > -1e-12, "{error}");
                last = turn.rate;
            }
            assert!(error.abs() < 1e-3, "{error}");
        }
    }

    /// A robot that lags behind a reference which brakes with all that a plan may use, and that has no more acceleration than the limit: it
    /// comes to rest where the reference does, and does not turn past. By the demand behind a reference that goes on it turns past by 45 to
    /// 440 mrad.
    #[test]
    fn a_robot_behind_a_reference_that_brakes_stops_where_it_does() {
        let (gain, most, dt) = (3.0, 0.9, 1.0e-3);
        let demand = TurnDemand::<f64>::new(gain, most);
        let plan = PLAN_SHARE * most;
        for sign in [1.0, -1.0] {
            for (start, lag) in [(1.2, 0.03), (1.2, 0.1), (1.2, 0.3), (0.5, 0.1), (0.8, 0.05)] {
                let past = [true, false].map(|ends| {
                    let (mut reference, mut rate, mut error) = (start, start, lag);
                    let mut past = 0.0_f64;
                    for _ in 0..8_000 {
                        let ending = ends.then_some(sign * reference);
                        let turn = sign * demand.at::<Libm>(sign * error, ending).rate;
                        rate += (reference + turn - rate).clamp(-most * dt, most * dt);
                        let next = (reference - dt * plan).max(0.0);
                        error += dt * (0.5 * (reference + next) - rate);
                        reference = next;
                        past = past.max(-error);
                    }
                    assert!(error.abs() < 1.0e-4, "{start}, {lag}: {error} left");
                    past
                });
                assert!(past[0] < 1.0e-4, "{start}, {lag}: {past:?}");
                assert!(past[1] > 0.04, "{start}, {lag}: {past:?}");
            }
        }
    }

    /// Values have no step, the derivatives are theirs, and the inverse is one: behind a reference that goes on or away, and behind those that end
    /// slowly and quickly.
    #[test]
    fn demand_derivatives_and_inverse_agree() {
        let demand = TurnDemand::<f64>::new(3.0, 2.0);
        let knee = 0.8 * 2.0 / 9.0;
        let h = 1.0e-6;
        let close = |a: f64, b: f64| (a - b).abs() < 1.0e-4;
        let endings = [(None, knee), (Some(-0.7), knee), (Some(0.3), knee - 0.1)];
        for (ending, knee) in endings.into_iter().chain([(Some(0.7), knee / 16.0)]) {
            for error in [0.004, 0.8 * knee, knee - 2.0 * h, knee + 2.0 * h, 0.5, 2.0] {
                for sign in [1.0, -1.0] {
                    let error = sign * error;
                    let at = |error, more| {
                        let ending = ending.map(|rate| sign * rate + more);
                        demand.at::<Libm>(error, ending)
                    };
                    let turn = at(error, 0.0);
                    let (less, more) = (at(error - h, 0.0).rate, at(error + h, 0.0).rate);
                    assert!(close(turn.by_error, (more - less) / (2.0 * h)), "{error}");
                    let (slower, quicker) = (at(error, -h).rate, at(error, h).rate);
                    let by_reference = 1.0 + (quicker - slower) / (2.0 * h);
                    assert!(close(turn.by_reference, by_reference), "{error}");
                    let back = demand.error_of(turn.rate, ending.map(|rate| sign * rate));
                    assert!((back - error).abs() < 1e-12, "{error}: {back}");
                }
            }
            let sides = [knee, knee + 1e-9].map(|error| demand.at::<Libm>(error, ending));
            assert_eq!(sides[0].by_error, 3.0, "linear up to {knee}");
            assert!((sides[0].rate - sides[1].rate).abs() < 1e-8);
            let has_corner = ending.is_some_and(|rate| rate > 0.3);
            assert_eq!(!has_corner, close(sides[0].by_error, sides[1].by_error));
        }
    }
}
