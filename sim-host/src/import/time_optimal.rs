//! The fastest law of time within limits: reachability along the path, backwards, then forwards.
//!
//! The path is the trajectory itself with its own time s as parameter, run at ds/dt ≤ 1. With
//! q = (ds/dt)², speeds scale with √q, and accelerations are a q + v q′/2: linear in q and q′, so
//! standstill is no singular point. Backwards, the largest q from which the end can be reached
//! within limits; forwards, the largest step that stays below it.

use super::limits::BoundRow;

/// The path at one of its points, evenly spaced in s.
#[derive(Clone, Debug)]
pub(super) struct GridPoint {
    /// Largest q by the limits on speeds.
    pub(super) ceiling: f64,
    /// Limits on accelerations.
    pub(super) rows: [BoundRow; 4],
}

const BISECTIONS: usize = 48;

/// q at every grid point; `ds` is their distance. All q are positive.
pub(super) fn fastest(grid: &[GridPoint], ds: f64) -> Vec<f64> {
    let n = grid.len();
    let mut q: Vec<f64> = grid.iter().map(|s| s.ceiling).collect();
    for i in (0..n.saturating_sub(1)).rev() {
        if let (Some(from), Some(to), Some(&next)) = (grid.get(i), grid.get(i + 1), q.get(i + 1)) {
            let reach = reachable(from, to, ds, next);
            if let Some(here) = q.get_mut(i) {
                *here = reach;
            }
        }
    }
    for i in 1..n {
        if let (Some(from), Some(to), Some(&before), Some(&limit)) =
            (grid.get(i - 1), grid.get(i), q.get(i - 1), q.get(i))
        {
            let (_, high) = interval(from, to, ds, before);
            if let Some(here) = q.get_mut(i) {
                *here = limit.min(high).max(SLOWEST);
            }
        }
    }
    q
}

/// Part of a limit that rounding may use.
const SLACK: f64 = 1e-6;
/// q changes by no more than e-fold in 1/STEADINESS seconds of the file: where the base starts from
/// rest, steps of q between grid points would cost nothing, and mean nothing.
const STEADINESS: f64 = 40.0;
/// Time never quite stops.
const SLOWEST: f64 = 1e-9;

/// The largest q at `from` with a next one of at most `next` at `to`. Zero is always feasible and
/// the feasible set convex, so bisection finds it.
fn reachable(from: &GridPoint, to: &GridPoint, ds: f64, next: f64) -> f64 {
    let feasible = |q: f64| {
        let (low, high) = interval(from, to, ds, q);
        low <= high.min(next)
    };
    if feasible(from.ceiling) {
        return from.ceiling;
    }
    let (mut good, mut bad) = (0.0, from.ceiling);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (good + bad);
        if feasible(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    good.max(SLOWEST)
}

/// The q that `to` can have after `q` at `from`; empty if low > high.
fn interval(from: &GridPoint, to: &GridPoint, ds: f64, q: f64) -> (f64, f64) {
    let grip = (STEADINESS * ds).exp();
    let (mut low, mut high) = (q / grip, to.ceiling.min(q * grip));
    // low ≤ c q + d (y − q)/ds ≤ high at the start of the step, c y + d (y − q)/ds at its end.
    let starts = from
        .rows
        .iter()
        .map(|r| (r, r.d / ds, (r.c - r.d / ds) * q));
    let ends = to.rows.iter().map(|r| (r, r.c + r.d / ds, -r.d / ds * q));
    for (row, slope, rest) in starts.chain(ends) {
        let (a, b) = (row.low - rest, row.high - rest);
        // At rest, but for rounding, y does not matter: it moves the row by less than the slack.
        let slack = SLACK * row.high.min(-row.low);
        if slope.abs() < slack {
            if a > slack || b < -slack {
                return (1.0, 0.0);
            }
        } else if slope > 0.0 {
            low = low.max(a / slope);
            high = high.min(b / slope);
        } else {
            low = low.max(b / slope);
            high = high.min(a / slope);
        }
    }
    (low, high)
}
