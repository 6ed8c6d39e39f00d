//! Time scaling: the reference runs more slowly where a base could not follow.

use super::limits::{Bound, LimitError, ReferenceLimits};
use super::time_law::{law, smoothed};
use super::time_optimal::{GridPoint, fastest};
use super::time_warp::TimeWarp;
use super::{Sample, Trajectory};
use std::fmt;

/// A part of the trajectory that is run more slowly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledSpan {
    /// From and to, in the file's time \[s\].
    pub file_s: (f64, f64),
    /// From and to, in the scaled time \[s\].
    pub run_s: (f64, f64),
    /// What the file exceeds most there, and by which factor; none where it only slows down
    /// towards a neighbour.
    pub exceeded: Option<(Bound, f64)>,
}

/// What was scaled, where and by how much.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimeScaling {
    /// New duration by old.
    pub factor: f64,
    /// Largest local factor.
    pub slowest: f64,
    /// Where; empty if the file is within the limits and untouched.
    pub places: Vec<ScaledSpan>,
    /// What the time-scaled trajectory uses of the limits, at most 1.
    pub load: f64,
}

/// Distance of grid points in the file's time \[s\], unless there would be too many.
const SPACING: f64 = 0.004;
const MAX_GRID_POINTS: f64 = 1e6;
/// Accelerations change over twice this many grid points, not at once.
const SMOOTHING: usize = 8;
/// Rounds of tightening before everything is slowed by what is left.
const ROUNDS: usize = 6;

impl Trajectory {
    /// The same path, run more slowly where `limits` would be exceeded, and what was scaled.
    ///
    /// Within the limits nothing changes. Elsewhere it is the fastest law of time that keeps them,
    /// smoothed over 0.1 s, so that jerk is finite; it ends as it began, at rest if the file does.
    ///
    /// # Errors
    /// A limit that is not positive.
    pub fn time_scaled(&self, limits: &ReferenceLimits) -> Result<(Self, TimeScaling), LimitError> {
        limits.validate()?;
        let own = worst(self, limits);
        let load = own.iter().fold(0.0, |worst: f64, (_, l)| worst.max(*l));
        if load <= 1.0 {
            let untouched = TimeScaling {
                factor: 1.0,
                slowest: 1.0,
                places: Vec::new(),
                load,
            };
            return Ok((self.clone(), untouched));
        }
        let span = self.path_duration();
        let count = (span / SPACING).clamp(64.0, MAX_GRID_POINTS).ceil();
        let ds = span / count;
        // Along the path at the pace it has now, so that scaling twice is possible.
        let plain = self.without_time_warp();
        let points: Vec<Sample> = (0..=count as usize)
            .map(|i| plain.at((i as f64 * ds).min(span)))
            .collect();
        let pace = pace(self, &points);
        let mut tight = *limits;
        let mut factors = own.map(|(bound, _)| (bound, 1.0));
        let mut time_scaled = plain.clone();
        for _ in 0..ROUNDS {
            let grid: Vec<GridPoint> = points
                .iter()
                .zip(&pace)
                .map(|(point, pace)| GridPoint {
                    ceiling: tight.ceiling(point).0.min(*pace),
                    rows: tight.rows(point),
                })
                .collect();
            let q = smoothed(&fastest(&grid, ds), SMOOTHING);
            time_scaled = plain.with_time_warp(law(&q, ds));
            let used = worst(&time_scaled, limits);
            if used.iter().all(|(_, load)| *load <= 1.0) {
                break;
            }
            for ((_, factor), (_, load)) in factors.iter_mut().zip(used) {
                *factor /= load.max(1.0) * if load > 1.0 { 1.002 } else { 1.0 };
            }
            tight = limits.scaled(&factors);
        }
        let used = worst(&time_scaled, limits);
        let load = used.iter().fold(0.0, |worst: f64, (_, l)| worst.max(*l));
        if let Some(time_warp) = time_scaled.time_warp.take() {
            // All loads fall at least as fast as time is slowed.
            time_scaled = plain.with_time_warp(if load > 1.0 {
                time_warp.slower(load)
            } else {
                time_warp
            });
        }
        let scaling = report(self, &time_scaled, limits, load.min(1.0));
        Ok((time_scaled, scaling))
    }
}

/// The largest loads of a trajectory.
fn worst(trajectory: &Trajectory, limits: &ReferenceLimits) -> [(Bound, f64); 6] {
    let mut worst = limits.load(&Sample::default());
    let mut include = |t| {
        for ((_, most), (_, here)) in worst.iter_mut().zip(limits.load(&trajectory.at(t))) {
            *most = most.max(here);
        }
    };
    match &trajectory.time_warp {
        Some(time_warp) => {
            for pair in time_warp.ticks().windows(2) {
                let [from, to] = pair else { continue };
                for i in 0..4 {
                    include(from.t + (to.t - from.t) * f64::from(i) / 4.0);
                }
            }
        }
        None => {
            for pair in trajectory.nodes.windows(2) {
                let [from, to] = pair else { continue };
                for i in 0..4 {
                    include(from.t + (to.t - from.t) * f64::from(i) / 4.0);
                }
            }
        }
    }
    include(trajectory.duration());
    worst
}

/// The squared rate of time that a trajectory has already, at points of its path.
fn pace(trajectory: &Trajectory, points: &[Sample]) -> Vec<f64> {
    let Some(time_warp) = &trajectory.time_warp else {
        return vec![1.0; points.len()];
    };
    let ticks = time_warp.ticks();
    points
        .iter()
        .map(|point| {
            let after = ticks.partition_point(|tick| tick.s <= point.t);
            let near = after.saturating_sub(1)..(after + 1).min(ticks.len());
            let rates = ticks.get(near).unwrap_or_default().iter();
            rates.map(|tick| tick.rate * tick.rate).fold(1.0, f64::min)
        })
        .collect()
}

/// Where the law of time is slower than before.
fn report(
    before: &Trajectory,
    after: &Trajectory,
    limits: &ReferenceLimits,
    load: f64,
) -> TimeScaling {
    let mut scaling = TimeScaling {
        factor: after.duration() / before.duration(),
        slowest: 1.0,
        places: Vec::new(),
        load,
    };
    let plain = after.without_time_warp();
    let ticks = after
        .time_warp
        .as_ref()
        .map(TimeWarp::ticks)
        .unwrap_or_default();
    let mut open: Option<ScaledSpan> = None;
    for tick in ticks {
        scaling.slowest = scaling.slowest.max(tick.rate.recip());
        if tick.rate >= 1.0 - 1e-9 {
            scaling.places.extend(open.take());
            continue;
        }
        let here = open.get_or_insert(ScaledSpan {
            file_s: (tick.s, tick.s),
            run_s: (tick.t, tick.t),
            exceeded: None,
        });
        (here.file_s.1, here.run_s.1) = (tick.s, tick.t);
        for (bound, load) in limits.load(&plain.at(tick.s)) {
            if load > here.exceeded.map_or(1.0, |(_, most)| most) {
                here.exceeded = Some((bound, load));
            }
        }
    }
    scaling.places.extend(open);
    scaling
}

impl fmt::Display for TimeScaling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.places.is_empty() {
            return f.write_str("within the limits, time not scaled");
        }
        let (factor, slowest) = (self.factor, self.slowest);
        write!(
            f,
            "time scaled by {factor:.3} in all, up to {slowest:.2} locally"
        )?;
        for place in &self.places {
            let ((from, to), (run_from, run_to)) = (place.file_s, place.run_s);
            write!(
                f,
                "\n  {from:.3} to {to:.3} s takes {:.3} s",
                run_to - run_from
            )?;
            if let Some((bound, load)) = place.exceeded {
                write!(f, ": {bound} {load:.2} times the limit")?;
            }
        }
        Ok(())
    }
}
