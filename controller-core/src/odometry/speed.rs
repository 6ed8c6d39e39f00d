//! Speed of a wheel from counts that may be rare.

use crate::range::{clamp, larger};
use crate::scalar::Scalar;

/// The loop's bandwidth is at most this over the time between counts \[rad\]. A count shows its speed
/// once; a loop that is much faster than the counts takes each for a blow and forgets it before the
/// next. With 0.7, 1.5, 2.5, 4 a base of 30 kg that turns at a count in 20 ticks without telling its
/// accelerations has a torque ripple of 3.2, 2.0, 2.1, 2.6 % of its limit.
const PER_COUNT: f64 = 1.5;

/// Bandwidth over time between counts \[rad\] above which nothing is learnt of unmodelled accelerations: half of
/// [`PER_COUNT`], and the speed of a wheel that turns steadily is read as quietly as without.
const OFTEN: f64 = 0.5 * PER_COUNT;

/// Longest time between counts that slows the loop \[s\].
const LONGEST_S: f64 = 0.2;

/// A wheel without a count for this long rests \[s\]: it is slower than two counts a second, 0.6 mm/s on the
/// coarsest of the example bases, a twentieth of what counts as rest for the supervisor.
const REST_S: f64 = 0.5;

/// Below this many counts a second, and with a count overdue, a wheel stands.
const STANDS: f64 = 0.01;

/// Counts in one direction that show that a wheel rolls. One comes of a tyre that swings about an edge; false edges,
/// one in some 10 s with brushes beside the wires, add one or rarely two.
const ROLLS: i32 = 4;

/// Share of the loop's bandwidth at which it learns an unmodelled acceleration. Its poles are those of
/// s³ + 2ω s² + ω² s + ω³/16, all real: 0.07, 0.71 and 1.22 ω. Above 4/27 two of them swing.
const LEARNS: f64 = 1.0 / 16.0;

/// What is learnt is at most this share of ω times the speed: a push that would stop the wheel in 16/ω. Friction turns about with
/// the direction, and where the supply fails and comes back there was none.
const MOST: f64 = 1.0 / 16.0;

/// The winding makes up for the speed that a wheel lost in this many times 1/ω to unmodelled accelerations. A motor whose free wheel
/// settles in τ then takes from what pushes the wheel all but 1/(1 + 4/(ωτ)), and the loop of [`LEARNS`] becomes that much
/// faster: at 20 ms and 50 rad/s 5 times, with poles of a damping of 0.67.
const MADE_UP: f64 = 4.0;

/// Wheel travel \[m\], its rate \[m/s\] and its unmodelled acceleration \[m/s²\], estimated by a third-order loop inside a count.
///
/// Counts are rounded down, so that a count n says only that the travel is in \[n, n + 1) of it. The
/// loop predicts the travel from speed and known acceleration; as long as the prediction is inside,
/// nothing speaks against it and nothing is corrected. Hence a steady speed, however slow, is read
/// without ripple: its counts come when they are predicted. What is outside is corrected as by a
/// critically damped loop of bandwidth ω, and what lasts of it is learnt ([`LEARNS`]):
///
/// ```text
/// v̂⁺ = v̂ + (a + u) dt + c      c = ω · ωdt/(1 + ωdt)² · e      e = what the travel is beyond the count
/// u⁺ = u + ω/16 · c
/// ```
///
/// So friction, a slope, a motor that gives another torque than asked, do not mislead the speed for long: without u a force F
/// would read as a speed of 2 F/(m ω). Where counts are rare ([`OFTEN`]) nothing is learnt, and a wheel that is stopped
/// forgets: dry friction turns about with the direction. A wheel that creeps is therefore fed forward what a disturbance estimate
/// outside knows ([`fed_forward`]).
///
/// A prediction that has left its count while none came is overdue by t: the speed is at most q/t.
///
/// A wheel at rest may be held by static friction, which takes the torque and turns nothing. Where a
/// count should have come and did not, the acceleration that predicted it is refuted: up to that size,
/// in both directions (friction holds alike), no acceleration is believed until the wheel rolls, which
/// [`ROLLS`] counts in one direction show, none of them [`REST_S`] after the last. Otherwise torque and speed
/// estimate support each other at rest: a held torque F reads as a speed of 2 F/(m ω), against which the
/// velocity loop holds another torque.
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
    /// Single counts in a row without a rest between them, up to [`ROLLS`]; negative backward.
    streak: i32,
    /// Largest acceleration that friction has held since the wheel rolled \[m/s²\], ≥ 0.
    held: T,
    /// Acceleration beyond that of torques and disturbance estimate, as learnt \[m/s²\].
    unmodelled: T,
}

/// What a wheel did in a tick.
pub(super) struct Turned<T> {
    pub(super) counts: i32,
    /// Travel of a count \[m\].
    pub(super) per_count: T,
    /// Acceleration that the wheel's rim was to have \[m/s²\].
    pub(super) accel: T,
    /// Acceleration of the rim by a disturbance, where somebody estimates it \[m/s²\].
    pub(super) disturbance: Option<T>,
    pub(super) dt: T,
}

impl<T: Scalar> Wheel<T> {
    /// \[m/s\].
    pub(super) const fn speed(&self) -> T {
        self.speed
    }

    /// The speed for which the back-EMF of a motor of this constant, over what is stated, is to be made up \[m/s\]: with what is
    /// [`made_up`](Self::made_up).
    pub(super) fn back_emf_speed(&self, constant: T, bandwidth: T) -> T {
        constant * self.speed + self.made_up(bandwidth)
    }

    /// What the wheel lost, in [`MADE_UP`]/ω, to unmodelled accelerations \[m/s\]; a quarter of its speed at most, as [`MOST`] has it.
    pub(super) fn made_up(&self, bandwidth: T) -> T {
        -(T::from_f64(MADE_UP) * self.unmodelled) / bandwidth
    }

    /// The speed at the end of the tick \[m/s\]. The loop is solved implicitly: stable for every ω dt.
    #[inline(always)]
    pub(super) fn track(&mut self, turned: &Turned<T>, bandwidth: T) -> T {
        let f = T::from_f64;
        let &Turned {
            counts,
            per_count,
            accel,
            disturbance,
            dt,
        } = turned;
        let first = self.count(counts, dt);
        // What counts allow is no less than the bandwidth unless they are rarer still.
        let (most, omega) = if bandwidth * self.period > f(OFTEN) {
            (T::ZERO, bandwidth_between(self.period, bandwidth))
        } else {
            (f(MOST) * bandwidth * self.speed.abs(), bandwidth)
        };
        let unmodelled = match disturbance {
            None => self.unmodelled,
            Some(disturbance) => self.unmodelled + fed_forward(disturbance, most),
        };
        let accel = beyond_held(accel + unmodelled, self.held);
        let a = omega * dt;
        let one_plus = T::ONE + a;
        let shrink = T::ONE / (one_plus * one_plus);
        let ahead = dt * (self.speed + T::HALF * dt * accel);
        let error = self.lag + T::from_i32(counts) * per_count - ahead;
        let inside = clamp(error, T::HALF * per_count);
        // The first count after a rest says where the travel is, at the near edge of the new count, and nothing
        // about a speed: it may be a false edge, or a tyre that gives.
        let beyond = if first { T::ZERO } else { error - inside };
        let corrected = omega * (a * shrink) * beyond;
        let mut speed = self.speed + dt * accel + corrected;
        let mut unmodelled = clamp(self.unmodelled + f(LEARNS) * omega * corrected, most);
        self.lag = if first {
            inside
        } else {
            error - beyond * (T::ONE - shrink)
        };
        // Written so that a beyond of zero is not overdue.
        let waits = counts == 0 && beyond * ahead < T::ZERO;
        self.overdue = if waits { self.overdue + dt } else { T::ZERO };
        if waits {
            let most = per_count / self.overdue;
            if speed.abs() > most {
                // A blow: the travel has stopped at the edge too, or it would be undone backwards.
                speed = clamp(speed, most);
                unmodelled = T::ZERO;
                self.lag = inside;
                if accel * ahead > T::ZERO {
                    self.held += accel.abs();
                }
            }
            // A wheel that is late is slow; it is not reversed.
            if speed.abs() < f(STANDS) * per_count || speed * ahead < T::ZERO {
                speed = T::ZERO;
                unmodelled = T::ZERO;
                self.lag = inside;
            }
        }
        (self.speed, self.unmodelled) = (speed, unmodelled);
        speed
    }

    /// Takes the time between counts; several counts in a tick have come within it. Whether this is a single count
    /// after a rest.
    #[inline(always)]
    fn count(&mut self, counts: i32, dt: T) -> bool {
        let (longest, rest) = (T::from_f64(LONGEST_S), T::from_f64(REST_S));
        let since = self.since + dt;
        let since = if since < rest { since } else { rest };
        if counts == 0 {
            self.since = since;
            return false;
        }
        let single = counts == 1 || counts == -1;
        let first = single && since >= rest;
        // 1 or −1, without a comparison.
        let sign = (counts >> 31) | 1;
        let streak = self.streak * sign;
        let streak = if first || streak < 0 { 0 } else { streak };
        let streak = if streak < ROLLS { streak + 1 } else { ROLLS };
        self.streak = streak * sign;
        let rolls = !single || streak == ROLLS;
        let period = if single { since } else { dt };
        self.period = if period < longest { period } else { longest };
        self.since = T::ZERO;
        if rolls {
            self.held = T::ZERO;
        }
        first
    }
}

/// The part of an acceleration that is beyond what friction has been seen to hold: nearly always all of it, so that comes first.
fn beyond_held<T: Scalar>(accel: T, held: T) -> T {
    let inside = if accel > held {
        held
    } else if accel < -held {
        -held
    } else {
        accel
    };
    accel - inside
}

/// The part of an estimated disturbance that is fed forward to a wheel that learns up to `most` by itself: all of it up to a `most`
/// of its size, nothing from twice its size on.
fn fed_forward<T: Scalar>(disturbance: T, most: T) -> T {
    let spare = larger(most - disturbance.abs(), T::ZERO);
    beyond_held(disturbance, spare)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What a disturbance estimate has is fed forward where a wheel can learn nothing by itself, less where it can learn as much, and
    /// not where it can learn twice as much.
    #[test]
    fn a_disturbance_is_fed_forward_to_what_cannot_learn_it() {
        for (most, fed) in [
            (0.0, 0.4),
            (0.2, 0.4),
            (0.4, 0.4),
            (0.6, 0.2),
            (0.8, 0.0),
            (5.0, 0.0),
        ] {
            for side in [1.0, -1.0] {
                // A rounding.
                assert!((fed_forward(side * 0.4, most) - side * fed).abs() < 1e-15);
            }
        }
    }

    /// A wheel believes torque, what it has learnt, and what is fed forward beside that: together, inside a count.
    #[test]
    fn a_wheel_adds_what_accelerates_it() {
        let (omega, dt) = (50.0, 0.01);
        // At 0.1 m/s what is learnt is at most 50/16 · 0.1 = 0.3125 m/s²; at rest, nothing.
        for (speed, learnt, disturbance, fed) in [
            (0.0, 0.0, None, 0.0),
            (0.0, 0.0, Some(-0.25), -0.25),
            (0.1, 0.2, None, 0.0),
            (0.1, 0.2, Some(-0.25), -0.1875),
            (0.1, 0.2, Some(0.1), 0.0),
        ] {
            let mut wheel = Wheel {
                speed,
                unmodelled: learnt,
                period: dt,
                ..Wheel::default()
            };
            let turned = Turned {
                counts: 0,
                per_count: 0.01,
                accel: 0.5,
                disturbance,
                dt,
            };
            let believed = wheel.track(&turned, omega);
            let expected = speed + dt * (0.5 + learnt + fed);
            assert!((believed - expected).abs() < 1e-15, "{believed} {expected}");
            assert_eq!(wheel.unmodelled, learnt);
        }
    }
}
