//! A quicker path inside a tube about that of the file, where that saves time.
//!
//! What costs time is angular acceleration where the path's curvature changes. Path and time
//! together are sought from the quickest run of the file's own path (`joint`); the path that comes of
//! it is run in its least time, where every limit is looked at between the places of the tube too.

use super::closeness::{Closeness, room};
use super::fit::Node;
use super::fit::motion::{Jerk, State};
use super::joint::{self, Stage};
use super::limits::{LimitError, ReferenceLimits};
use super::time_scaling::{FASTEST, Pace, TimeScaling};
use super::trajectory::is_rest;
use super::{Sample, Trajectory};

/// Places of the tube are at most so far apart on the file's path, by way \[m\], turn \[rad\] and
/// time of its run \[s\].
const APART: [f64; 3] = [0.03, 0.1, 0.03];
/// They are looked for at steps of this \[s\], unless there would be too many.
const STEP: f64 = 0.005;
const MAX_STEPS: f64 = 1e6;
/// Of more places, ten minutes of a slowed run, memory and time would be too much: such a path is left as it is.
const MAX_PLACES: usize = 20_000;
/// Part of the tube that is left where the run is not slowed within `NEAR` seconds.
const APPROVED: f64 = 0.05;
const NEAR: f64 = 0.5;
/// What the places of a run keep of the tube: the rest is for what rounding adds.
const KEEPS: f64 = 0.999;
/// From place to place no less time is taken \[s\]; two places at once would tell nothing.
const SHORTEST: f64 = 2e-4;
/// Rounds of smoothing and retiming.
const ROUNDS: usize = 3;
/// A round that saves less than this part of the time is the last.
const SAVED: f64 = 4e-3;
/// On another path a run is as fast as the file if its rate is at least this.
const KEPT: f64 = 0.99;
/// Places that lose less than this are not worth a line \[s\].
const MARKED: f64 = 1e-3;

/// A place of the tube.
struct Place {
    /// In the time of the file.
    s: f64,
    /// In the time of the run.
    t: f64,
    /// Its pose: x, y, θ.
    middle: [f64; 3],
    /// The part of the tube that is left to it.
    room: f64,
}

impl Trajectory {
    /// The fastest run within `limits` on a path that is no farther than `tube` from this one
    /// \[m\], from its first pose to its last, at rest there where the file means rest, else as fast as [`time_scaled`](Self::time_scaled) has it. The path is left as it is where nothing is slowed,
    /// where nothing is saved, if `tube` is 0, and if the run is so long (at least ten minutes) that the
    /// search would be too large.
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
        let rest = [0.0, self.duration()].map(|t| {
            let end = self.at(t);
            is_rest(end.v, end.w)
        });
        let mut places = self.places(&best, &scaling, pace);
        if places.len() > MAX_PLACES {
            return Ok((best, scaling));
        }
        let mut work = scaling.work;
        for round in 0..ROUNDS {
            let stages = stages(&places, &best, pace, tube);
            let Some(found) = joint::quickest(stages, limits, rest, &mut work) else {
                break;
            };
            let mut nodes = Vec::with_capacity(found.len());
            let mut t = 0.0;
            for (place, Stage { z, u, h, .. }) in places.iter_mut().zip(found) {
                place.t = t;
                nodes.push(Node { t, z, u });
                t += h;
            }
            if round > 0 && t > best.duration() {
                // A path that is no quicker than the last, which was sought in the same way.
                break;
            }
            let path = self.with_nodes(nodes);
            let close = departure(&places, &path);
            let most = |s: f64| match pace {
                Pace::Fastest => FASTEST * FASTEST,
                Pace::Own => pace_at(&places, s).powi(2),
            };
            let (run, load, took) = path.fastest(limits, &most, pace);
            work += took;
            let saved = 1.0 - run.duration() / best.duration();
            if saved <= 0.0 || close.position_m > tube {
                break;
            }
            for place in &mut places {
                place.t = run.run_time(place.t);
            }
            let ends = places.iter().zip(places.iter().skip(1));
            let rates: Vec<_> = ends
                .map(|(from, to)| {
                    let rate = (to.s - from.s) / (to.t - from.t);
                    let rate = if rate > KEPT { rate.max(1.0) } else { rate };
                    (to.s, to.t, rate)
                })
                .collect();
            scaling = self.scaling(limits, &run, load, &rates);
            scaling.places.retain(|span| {
                let ((from, to), (start, end)) = (span.file_s, span.run_s);
                end - start > to - from + MARKED
            });
            scaling.departure = Some(close);
            best = run;
            if saved < SAVED {
                break;
            }
        }
        scaling.work = work;
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
            let all = is_slowed || pace == Pace::Fastest;
            places.push(Place {
                s: run.path_time(t),
                t,
                middle: [here.x, here.y, here.theta],
                room: if all { 1.0 } else { APPROVED },
            });
        }
        places
    }
}

/// The motion of a run from place to place of the tube.
fn stages(places: &[Place], run: &Trajectory, pace: Pace, tube: f64) -> Vec<Stage> {
    let samples: Vec<Sample> = places.iter().map(|place| run.at(place.t)).collect();
    let stage = |(i, place): (usize, &Place)| {
        let here = samples.get(i).copied().unwrap_or_default();
        let (next, after) = match (samples.get(i + 1), places.get(i + 1)) {
            (Some(next), Some(after)) => (*next, after),
            _ => (here, place),
        };
        let h = (next.t - here.t).max(SHORTEST);
        let least = match pace {
            Pace::Own => after.s - place.s,
            Pace::Fastest => (after.s - place.s) / FASTEST,
        };
        Stage {
            middle: place.middle,
            room: room(KEEPS * place.room * tube),
            least: least.clamp(SHORTEST, h),
            z: State::from([
                here.x, here.y, here.theta, here.v, here.w, here.a, here.alpha,
            ]),
            u: Jerk::new(next.a - here.a, next.alpha - here.alpha) / h,
            h,
        }
    };
    places.iter().enumerate().map(stage).collect()
}

/// How far a path is from the places of the tube.
fn departure(places: &[Place], path: &Trajectory) -> Closeness {
    let mut most = Closeness {
        position_m: 0.0,
        heading_rad: 0.0,
    };
    for place in places {
        let here = path.at(place.t);
        let [x, y, theta] = place.middle;
        let away = libm::hypot(here.x - x, here.y - y);
        most.position_m = most.position_m.max(away);
        most.heading_rad = most.heading_rad.max((here.theta - theta).abs());
    }
    most
}

/// The largest rate of a path's time, such that it is nowhere faster than the file.
fn pace_at(places: &[Place], s: f64) -> f64 {
    let after = places.partition_point(|place| place.t <= s);
    let to = after.min(places.len().saturating_sub(1)).max(1);
    match places.get(to - 1..=to) {
        Some([from, to]) => (to.t - from.t) / (to.s - from.s),
        _ => 1.0,
    }
}
