//! The turn rate that takes back an error of the heading, no faster than the base can stop turning.

use crate::maths::Maths;
use crate::scalar::Scalar;

/// Share of the base's angular acceleration that the demand brakes with: the rest is for the lag of the velocity loop, jerk, and what
/// the reference asks for meanwhile.
const BRAKING: f64 = 0.8;

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

    /// w(e) and its slope:
    ///
    /// ```text
    /// w = k₃ e                         w′ = k₃           |e| ≤ e₀ = p/k₃²
    /// w = ± √(p (2 |e| − e₀))          w′ = p/|w|        beyond
    /// ```
    ///
    /// | symbol | what | unit |
    /// | --- | --- | --- |
    /// | e | s₂ + sin e_θ + s₃ | rad |
    /// | p | angular acceleration to brake with | rad/s² |
    ///
    /// Value and slope are continuous. A robot that turns at w(e) towards e = 0, ė = −w, brakes with w′ w: p beyond e₀ and less within,
    /// so it does not turn past, whatever k₃ is. In the paper w is k₃ e for all errors; then it needs k₃ w.
    #[inline(always)]
    pub(crate) fn at<M: Maths<T>>(&self, error: T) -> (T, T) {
        let size = error.abs();
        if size <= self.knee {
            return (self.gain * error, self.gain);
        }
        let square = self.brake * (size + size - self.knee);
        let inverse = M::inverse_sqrt(square);
        let rate = square * inverse;
        let rate = if error < T::ZERO { -rate } else { rate };
        (rate, self.brake * inverse)
    }

    /// e of a turn rate, the inverse of [`at`](Self::at).
    pub(crate) fn error_of(&self, rate: T) -> T {
        let size = rate.abs();
        let error = size / self.gain;
        if error <= self.knee {
            return rate / self.gain;
        }
        let error = T::HALF * (size * size / self.brake + self.knee);
        if rate < T::ZERO { -error } else { error }
    }
}

#[cfg(test)]
mod tests {
    use super::TurnDemand;
    use crate::maths::Libm;

    /// Where the robot can stop: from w it takes w²/(2p) at p, and what is left at the knee fades with k₃.
    #[test]
    fn a_robot_that_brakes_as_asked_stops_at_no_error() {
        let demand = TurnDemand::<f64>::new(5.0, 0.9);
        let brake = 0.8 * 0.9;
        let dt = 1.0e-4;
        for start in [1.5_f64, -1.5, 0.4] {
            let mut error = start;
            let mut last = demand.at::<Libm>(error).0;
            for _ in 0..100_000 {
                error -= dt * last;
                let (rate, slope) = demand.at::<Libm>(error);
                let braked = (last - rate).abs() / dt;
                // Of a step: the slope changes by no more than k₃² dt of itself.
                assert!(braked < brake * (1.0 + 25.0 * dt), "{braked} at {error}");
                assert!((slope * rate).abs() <= brake * (1.0 + 1e-12));
                assert!(error * start > -1e-12, "{error}");
                last = rate;
            }
            assert!(error.abs() < 1e-3, "{error}");
        }
    }

    /// Value and slope have no step, the slope is that of the value, and the inverse is one.
    #[test]
    fn demand_slope_and_inverse_agree() {
        let demand = TurnDemand::<f64>::new(3.0, 2.0);
        let knee = 0.8 * 2.0 / 9.0;
        let h = 1.0e-6;
        for error in [0.0, 0.05, knee - h, knee + h, 0.5, 2.0] {
            for error in [error, -error] {
                let (rate, slope) = demand.at::<Libm>(error);
                let (less, more) = (demand.at::<Libm>(error - h), demand.at::<Libm>(error + h));
                assert!(
                    (slope - (more.0 - less.0) / (2.0 * h)).abs() < 1e-4,
                    "{error}"
                );
                assert!((demand.error_of(rate) - error).abs() < 1e-12);
            }
        }
        let (inside, outside) = (demand.at::<Libm>(knee), demand.at::<Libm>(knee + 1e-9));
        assert!((inside.0 - outside.0).abs() < 1e-8 && (inside.1 - outside.1).abs() < 1e-7);
    }
}
