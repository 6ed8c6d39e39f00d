//! A smoother path inside a tube about that of the file, where that saves time.
//!
//! What costs time is angular acceleration where the path's curvature changes. The fit that makes
//! the reference smooths it over the time that it is given; so it is given the time of the run,
//! longer where the base is slow, and the tube for a tolerance. Run on the smoother path the base is
//! quicker, which is the time for the next fit; a few rounds of the two settle.

use super::fit::{self, Rest, Target};
use super::limits::{LimitError, ReferenceLimits};
use super::time_scaling::{FASTEST, Pace, TimeScaling};
use super::{Closeness, Trajectory};

/// Places of the tube are at most so far apart, by way \[m\], turn \[rad\] and time \[s\].
const APART: [f64; 3] = [0.01, 0.05, 0.1];
/// They are looked for at steps of this \[s\], unless there would be too many.
const STEP: f64 = 0.005;
const MAX_STEPS: f64 = 1e6;
/// A heading may depart by what brings a point so far ahead to the tube's edge \[m\].
const AHEAD: f64 = 0.04;
/// Weight of accelerations against jerk \[1/s²\]: more makes no heavy base quicker.
const CALM: f64 = 300.0;
/// Parts of the tube that are left to the ends, and to where the run is not slowed within `NEAR`
/// seconds.
const ENDS: f64 = 0.1;
const APPROVED: f64 = 0.05;
const NEAR: f64 = 0.5;
/// Rounds of smoothing and retiming.
const ROUNDS: usize = 6;
/// A round that saves less than this part of the time is the last.
const SAVED: f64 = 4e-3;
/// On another path a run is as fast as the file if its rate is at least this.
const KEPT: f64 = 0.99;
/// Places that lose less than this are not worth a line \[s\].
const MARKED: f64 = 1e-3;
/// Slower than this \[m/s, rad/s\] is rest.
const REST: f64 = 1e-6;

/// A place of the tube.
struct Place {
    /// In the time of the file.
    s: f64,
    /// Its pose, at its time in the run.
    target: Target,
}

impl Trajectory {
    /// The fastest run within `limits` on a path that is no farther than `tube` from this one
    /// \[m\], from its first pose to its last. The path is left as it is where nothing is slowed,
    /// where nothing is saved, and if `tube` is 0.
    ///
    /// # Errors
    /// A limit that is not positive.
    pub fn time_scaled_within(
        &self,
        limits: &ReferenceLimits,
        pace: Pace,
        tube: f64,
    ) -> Result<(Self, TimeScaling), LimitError> {
        let (mut best, mut scaling) = self.time_scaled(limits, pace)?;
        let untouched = scaling.places.is_empty() && pace == Pace::Own;
        if untouched || tube.is_nan() || tube <= 0.0 {
            return Ok((best, scaling));
        }
        let (first, last) = (self.at(0.0), self.at(self.duration()));
        let resting = |v: f64, w: f64| v.abs() < REST && w.abs() < REST;
        let rest = Rest {
            start: resting(first.v, first.w),
            end: resting(last.v, last.w),
        };
        let mut places = self.places(&best, &scaling, pace);
        for _ in 0..ROUNDS {
            let targets: Vec<Target> = places.iter().map(|place| place.target).collect();
            let fitted = fit::fit(&targets, rest, [tube, tube / AHEAD], CALM);
            let Some((nodes, close)) = fitted.filter(|(_, close)| close.excess <= 1.0) else {
                break;
            };
            let most = |s: f64| match pace {
                Pace::Fastest => FASTEST * FASTEST,
                Pace::Own => pace_at(&places, s).powi(2),
            };
            let (run, load) = self.with_nodes(nodes).fastest(limits, &most, pace);
            let saved = 1.0 - run.duration() / best.duration();
            if saved <= 0.0 {
                break;
            }
            for place in &mut places {
                place.target.t = run.run_time(place.target.t);
            }
            let ends = places.iter().zip(places.iter().skip(1));
            let rates: Vec<_> = ends
                .map(|(from, to)| {
                    let rate = (to.s - from.s) / (to.target.t - from.target.t);
                    let rate = if rate > KEPT { rate.max(1.0) } else { rate };
                    (to.s, to.target.t, rate)
                })
                .collect();
            scaling = self.scaling(limits, &run, load, &rates);
            scaling.places.retain(|span| {
                let ((from, to), (start, end)) = (span.file_s, span.run_s);
                end - start > to - from + MARKED
            });
            scaling.departure = Some(Closeness {
                position_m: close.position,
                heading_rad: close.heading,
            });
            best = run;
            if saved < SAVED {
                break;
            }
        }
        Ok((best, scaling))
    }

    /// Places of this path, at the times of a run of it.
    fn places(&self, run: &Self, scaling: &TimeScaling, pace: Pace) -> Vec<Place> {
        let end = run.duration();
        let steps = (end / STEP).clamp(1.0, MAX_STEPS).ceil();
        let mut places: Vec<Place> = Vec::new();
        let mut way = [f64::INFINITY; 3];
        let mut before = run.at(0.0);
        for i in 0..=steps as usize {
            let t = end * i as f64 / steps;
            let here = run.at(t);
            way[0] += libm::hypot(here.x - before.x, here.y - before.y);
            way[1] += (here.theta - before.theta).abs();
            way[2] += t - before.t;
            before = here;
            let is_end = i == 0 || i == steps as usize;
            if !is_end && way.iter().zip(APART).all(|(way, apart)| *way < apart) {
                continue;
            }
            way = [0.0; 3];
            let slowed = |(from, to): (f64, f64)| (from - NEAR..to + NEAR).contains(&t);
            let is_slowed = scaling.places.iter().any(|span| slowed(span.run_s));
            let room = match (is_end, is_slowed || pace == Pace::Fastest) {
                (true, _) => ENDS,
                (false, true) => 1.0,
                (false, false) => APPROVED,
            };
            let target = Target {
                t,
                x: here.x,
                y: here.y,
                theta: here.theta,
                room,
            };
            places.push(Place {
                s: run.path_time(t),
                target,
            });
        }
        places
    }
}

/// The largest rate of a path's time, such that it is nowhere faster than the file.
fn pace_at(places: &[Place], s: f64) -> f64 {
    let after = places.partition_point(|place| place.target.t <= s);
    let to = after.min(places.len().saturating_sub(1)).max(1);
    match places.get(to - 1..=to) {
        Some([from, to]) => (to.target.t - from.target.t) / (to.s - from.s),
        _ => 1.0,
    }
}
