//! A gentle start.

use super::Trajectory;
use super::time_warp::{Tick, TimeWarp};

/// Knots of the ramp.
const KNOTS: usize = 32;
/// Slower than this \[m/s, rad/s\] is rest.
const REST: f64 = 1e-6;

impl Trajectory {
    /// The same motion, begun more gently: the reference's time starts at rate 0 and reaches its
    /// own pace after `ramp` seconds, of which half are lost.
    ///
    /// Files that start at rest mostly start with their full acceleration, which no base has at
    /// once. With p = t/ramp the rate is 3p² − 2p³, so the acceleration grows from 0, and
    /// exceeds the file's by at most 16 %. A motion that does not start at rest, or lasts less than
    /// twice the ramp, is left as it is.
    #[must_use]
    pub fn ramped_in(&self, ramp: f64) -> Self {
        let first = self.at(0.0);
        let moving = first.v.abs() > REST || first.w.abs() > REST;
        let usable = ramp.is_finite() && ramp > 0.0 && self.duration() > 2.0 * ramp;
        if moving || !usable {
            return self.clone();
        }
        // Laws of time that are not warped yet are s = t.
        let law = |t: f64| match &self.time_warp {
            Some(time_warp) => time_warp.at(t),
            None => (t, 1.0, 0.0),
        };
        let mut ticks: Vec<Tick> = (0..=KNOTS)
            .map(|knot| {
                let p = knot as f64 / KNOTS as f64;
                let (s, rate, rate_dot) = law(ramp * p * p * p * (1.0 - 0.5 * p));
                let slope = p * p * (3.0 - 2.0 * p);
                let curvature = 6.0 * p * (1.0 - p) / ramp;
                Tick {
                    t: ramp * p,
                    s,
                    rate: rate * slope,
                    rate_dot: rate_dot * slope * slope + rate * curvature,
                }
            })
            .collect();
        let rest = |t: f64, s: f64, rate: f64, rate_dot: f64| {
            (t > 0.5 * ramp + 1e-9).then_some(Tick {
                t: t + 0.5 * ramp,
                s,
                rate,
                rate_dot,
            })
        };
        match &self.time_warp {
            Some(time_warp) => {
                let later = time_warp.ticks().iter();
                ticks.extend(later.filter_map(|k| rest(k.t, k.s, k.rate, k.rate_dot)));
            }
            None => {
                let later = self.nodes.iter();
                ticks.extend(later.filter_map(|node| rest(node.t, node.t, 1.0, 0.0)));
            }
        }
        self.with_time_warp(TimeWarp::new(ticks))
    }
}
