//! A trajectory for the chip: as few samples as the core's interpolation needs.

use super::raw::wrap;
use super::{Sample, Tolerance, Trajectory};
use controller_core::maths::Libm;
use controller_core::queue::{TimedReference, interpolate};
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};

/// A sample as it goes to flash or through the queue, 36 bytes. SI units, heading in (−π, π].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompactSample {
    /// Time from the start.
    pub t: f32,
    /// Position.
    pub x: f32,
    /// Position.
    pub y: f32,
    /// Heading.
    pub theta: f32,
    /// Speed.
    pub v: f32,
    /// Turn rate.
    pub w: f32,
    /// Rate of `v`.
    pub a: f32,
    /// Rate of `w`.
    pub alpha: f32,
    /// See [`Sample::left`].
    pub left: f32,
}

/// Samples, and how far the interpolation between them is from the trajectory they are taken of.
///
/// The errors are the largest found on a grid of 2 ms or finer; rounding to `f32` is in them, that
/// of the chip's own arithmetic is not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compact {
    /// Strictly increasing in time.
    pub samples: Vec<CompactSample>,
    /// Position \[m\].
    pub position_error_m: f64,
    /// Heading \[rad\].
    pub heading_error_rad: f64,
    /// Speed \[m/s\].
    pub speed_error: f64,
    /// Turn rate \[rad/s\].
    pub turn_rate_error: f64,
}

/// Samples stand at multiples of this \[s\], or coarser in very long trajectories.
const QUANTUM: f64 = 1e-3;
const MAX_STEPS: f64 = 1e6;
/// The tolerance is checked at instants this far apart \[s\], and at this many at least.
const CHECK: f64 = 2e-3;
const LEAST_CHECKS: f64 = 16.0;
/// A compiled trajectory may use this part of the tolerance while it is searched, for what lies
/// between the instants that are checked.
const PART: f64 = 0.9;
/// Samples are not farther apart than this \[s\].
const LONGEST: f64 = 4.0;

/// Chooses samples so that cubic Hermite interpolation stays within the tolerance.
///
/// From each sample on, the farthest next one that keeps the tolerance: doubling, then bisection.
/// Where even 1 ms is too long, as with tolerances below the rounding of `f32`, it is taken all the
/// same, and the errors say so.
pub fn compact(trajectory: &Trajectory, tolerance: Tolerance) -> Compact {
    let end = trajectory.duration();
    let steps = (end / QUANTUM).clamp(1.0, MAX_STEPS).round();
    let quantum = end / steps;
    let (steps, longest) = (steps as usize, ((LONGEST / quantum) as usize).max(1));
    let take = |i: usize| sample(trajectory, (i as f64 * quantum).min(end));
    let mut compiled = Compact::default();
    let mut here = 0;
    let mut from = take(0);
    compiled.samples.push(from);
    while here < steps {
        let room = (steps - here).min(longest);
        let fits = |n: usize| {
            let errors = errors(trajectory, &from, &take(here + n));
            errors[0] <= PART * tolerance.position_m && errors[1] <= PART * tolerance.heading_rad
        };
        let mut good = 1;
        while good < room && fits((2 * good).min(room)) {
            good = (2 * good).min(room);
        }
        let mut bad = (2 * good).min(room + 1);
        while bad > good + 1 {
            let middle = good + (bad - good) / 2;
            if fits(middle) {
                good = middle;
            } else {
                bad = middle;
            }
        }
        here += good;
        let mut to = take(here);
        // In f32 two instants may become one, late in a long trajectory.
        while to.t <= from.t && here < steps {
            here += 1;
            to = take(here);
        }
        if to.t <= from.t {
            break;
        }
        let [position, heading, speed, turn_rate] = errors(trajectory, &from, &to);
        compiled.position_error_m = compiled.position_error_m.max(position);
        compiled.heading_error_rad = compiled.heading_error_rad.max(heading);
        compiled.speed_error = compiled.speed_error.max(speed);
        compiled.turn_rate_error = compiled.turn_rate_error.max(turn_rate);
        compiled.samples.push(to);
        from = to;
    }
    compiled
}

/// The trajectory at an instant that `f32` can tell; the values belong to the rounded instant.
fn sample(trajectory: &Trajectory, t: f64) -> CompactSample {
    let mut rounded = t as f32;
    if f64::from(rounded) > trajectory.duration() {
        rounded = rounded.next_down();
    }
    let s = trajectory.at(f64::from(rounded));
    CompactSample {
        t: rounded,
        x: s.x as f32,
        y: s.y as f32,
        theta: wrap(s.theta) as f32,
        v: s.v as f32,
        w: s.w as f32,
        a: s.a as f32,
        alpha: s.alpha as f32,
        left: s.left as f32,
    }
}

/// Largest errors between two samples: position, heading, speed, turn rate.
fn errors(trajectory: &Trajectory, from: &CompactSample, to: &CompactSample) -> [f64; 4] {
    let (a, b) = (timed(from), timed(to));
    let span = b.t - a.t;
    if span <= 0.0 {
        return [f64::INFINITY; 4];
    }
    let checks = (span / CHECK).ceil().max(LEAST_CHECKS) as usize;
    let mut worst = [0.0; 4];
    for i in 0..=checks {
        let t = a.t + span * i as f64 / checks as f64;
        let truth = trajectory.at(t);
        let found = interpolate::<f64, Libm>(&a, &b, t);
        for (worst, error) in worst.iter_mut().zip(difference(&truth, &found)) {
            *worst = error.max(*worst);
        }
    }
    worst
}

fn difference(truth: &Sample, found: &Reference<f64>) -> [f64; 4] {
    [
        libm::hypot(found.pose().x - truth.x, found.pose().y - truth.y),
        wrap(found.pose().theta - truth.theta).abs(),
        (found.twist().linear - truth.v).abs(),
        (found.twist().angular - truth.w).abs(),
    ]
}

/// A compact sample as the core takes it, in double precision.
fn timed(s: &CompactSample) -> TimedReference<f64> {
    TimedReference {
        t: f64::from(s.t),
        reference: Reference::new_with::<Libm>(
            Pose {
                x: f64::from(s.x),
                y: f64::from(s.y),
                theta: f64::from(s.theta),
            },
            Twist::new(f64::from(s.v), f64::from(s.w)),
            Accel::new(f64::from(s.a), f64::from(s.alpha)),
        )
        .with_left(f64::from(s.left)),
    }
}
