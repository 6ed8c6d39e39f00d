//! Speed of a wheel from counts that may be rare.

use crate::range::clamp;
use crate::scalar::Scalar;

/// The loop's bandwidth is at most this over the time between counts \[rad\]. A count tells its speed
/// once; a loop that is much faster than the counts takes each for a blow and forgets it before the
/// next. With 0.7, 1.5, 2.5, 4 a base of 30 kg that turns at a count in 20 ticks without telling its
/// accelerations has a torque ripple of 3.2, 2.0, 2.1, 2.6 % of its limit.
const PER_COUNT: f64 = 1.5;

/// Longest time between counts that slows the loop \[s\]: from rest, the second count is believed.
const LONGEST_S: f64 = 0.2;

/// Below this many counts a second, and with a count overdue, a wheel stands.
const STANDS: f64 = 0.01;

/// Wheel travel \[m\] and its rate \[m/s\], estimated by a second-order loop inside a count.
///
/// Counts are rounded down, so that a count n says only that the travel is in \[n, n + 1) of it. The
/// loop predicts the travel from speed and known acceleration; as long as the prediction is inside,
/// nothing speaks against it and nothing is corrected. Hence a steady speed, however slow, is read
/// without ripple: its counts come when they are predicted. What is outside is corrected as by a
/// critically damped loop of bandwidth ω:
///
/// ```text
/// v̂⁺ = v̂ + a dt + ω · ωdt/(1 + ωdt)² · e        e = what the travel is beyond the count
/// ```
///
/// A prediction that has left its count while none came is overdue by t: the speed is at most q/t.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wheel<T> {
    /// Measured minus estimated travel: kept instead of both, so that it never grows. Within half a
    /// count while prediction and counts agree.
    lag: T,
    speed: T,
    /// Time between the last two counts, and since the last \[s\].
    period: T,
    since: T,
    /// For how long a count has been expected \[s\].
    overdue: T,
}

/// What a wheel did in a tick.
pub(super) struct Turned<T> {
    pub(super) counts: i32,
    /// Travel of a count \[m\].
    pub(super) per_count: T,
    /// Acceleration that the wheel's rim was to have \[m/s²\].
    pub(super) accel: T,
    pub(super) dt: T,
}

impl<T: Scalar> Wheel<T> {
    /// The speed at the end of the tick \[m/s\]. The loop is solved implicitly: stable for every ω dt.
    pub(super) fn track(&mut self, turned: &Turned<T>, bandwidth: T) -> T {
        let f = T::from_f64;
        let &Turned {
            counts,
            per_count,
            accel,
            dt,
        } = turned;
        self.count(counts, dt);
        let omega = bandwidth_between(self.period, bandwidth);
        let a = omega * dt;
        let one_plus = T::ONE + a;
        let shrink = T::ONE / (one_plus * one_plus);
        let ahead = dt * (self.speed + T::HALF * dt * accel);
        let error = self.lag + T::from_i32(counts) * per_count - ahead;
        let inside = clamp(error, T::HALF * per_count);
        let beyond = error - inside;
        let mut speed = self.speed + dt * accel + omega * (a * shrink) * beyond;
        self.lag = error - beyond * (T::ONE - shrink);
        // Written so that a beyond of zero is not overdue.
        let waits = counts == 0 && beyond * ahead < T::ZERO;
        self.overdue = if waits { self.overdue + dt } else { T::ZERO };
        if waits {
            let most = per_count / self.overdue;
            if speed.abs() > most {
                // A blow: the travel has stopped at the edge too, or it would be undone backwards.
                speed = clamp(speed, most);
                self.lag = inside;
            }
            if speed.abs() < f(STANDS) * per_count {
                speed = T::ZERO;
            }
        }
        self.speed = speed;
        speed
    }

    /// Takes the time between counts. Several counts in a tick have come within it.
    fn count(&mut self, counts: i32, dt: T) {
        let longest = T::from_f64(LONGEST_S);
        let since = self.since + dt;
        let since = if since < longest { since } else { longest };
        if counts == 0 {
            self.since = since;
        } else {
            self.period = if counts == 1 || counts == -1 {
                since
            } else {
                dt
            };
            self.since = T::ZERO;
        }
    }
}

/// The smaller of the loop's bandwidth and what the counts allow \[rad/s\].
fn bandwidth_between<T: Scalar>(period: T, bandwidth: T) -> T {
    let per_count = T::from_f64(PER_COUNT);
    if bandwidth * period > per_count {
        per_count / period
    } else {
        bandwidth
    }
}
