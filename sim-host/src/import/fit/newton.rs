//! One Gauss-Newton step of the fit, by the Riccati recursion: linear in the number of knots.

use super::grid::{Knot, Target};
use super::motion::{Jerk, State, advance, linearise};
use nalgebra::{SMatrix, SVector};

/// What is weighed against what.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    /// Of a target: along its heading, across it, and in heading.
    pub(super) pose: Vec<[f64; 3]>,
    /// Of jerk in v and w, from every knot to the next.
    pub(super) jerk: Vec<Jerk>,
    /// Of speed, turn rate and their rates at a start or end at rest.
    pub(super) rest: f64,
}

/// Whether the file says that the base stands at its first and last sample.
#[derive(Clone, Copy, Debug, Default)]
pub(in super::super) struct Rest {
    pub(in super::super) start: bool,
    pub(in super::super) end: bool,
}

/// An iterate: a state at every knot, the jerk from it to the next.
#[derive(Clone, Debug)]
pub(super) struct Iterate {
    pub(super) z: Vec<State>,
    pub(super) u: Vec<Jerk>,
}

type Gain = SMatrix<f64, 2, 7>;

/// One step; then the jerk is rolled out through Eq. (6) so that the iterate is consistent again.
/// `None` if the numbers ran away. Also gives the largest change of position and heading.
pub(super) fn step(
    knots: &[Knot],
    targets: &[Target],
    rest: Rest,
    weights: &Weights,
    iterate: &Iterate,
) -> Option<(Iterate, f64)> {
    let n = knots.len();
    let mut p = SMatrix::<f64, 7, 7>::zeros();
    let mut q = SVector::<f64, 7>::zeros();
    let mut gains: Vec<(Gain, Jerk)> = vec![(Gain::zeros(), Jerk::zeros()); n.saturating_sub(1)];
    for k in (0..n).rev() {
        let z = iterate.z.get(k)?;
        if let (Some(u), Some(next), Some(knot), Some(after)) = (
            iterate.u.get(k),
            iterate.z.get(k + 1),
            knots.get(k),
            knots.get(k + 1),
        ) {
            let h = after.t - knot.t;
            let (predicted, a, b) = linearise(z, u, h);
            let q_next = q + p * (predicted - next);
            let r = weights.jerk.get(k)? * h;
            let bp = b.transpose() * p;
            let mut quu = bp * b;
            quu[(0, 0)] += r[0];
            quu[(1, 1)] += r[1];
            let qux = bp * a;
            let qu = b.transpose() * q_next + r.component_mul(u);
            let inverse = quu.try_inverse()?;
            let (gain, push) = (-inverse * qux, -inverse * qu);
            p = a.transpose() * p * a + qux.transpose() * gain;
            q = a.transpose() * q_next + qux.transpose() * push;
            *gains.get_mut(k)? = (gain, push);
        }
        add_cost(knots.get(k)?, targets, &weights.pose, z, &mut p, &mut q);
        if (k == 0 && rest.start) || (k + 1 == n && rest.end) {
            // Without acceleration either: no base has that at once.
            for i in 3..7 {
                p[(i, i)] += weights.rest;
                q[i] += weights.rest * z[i];
            }
        }
        p = (p + p.transpose()) * 0.5;
    }
    // A whisper of a prior, for what a short file leaves open at its start.
    for i in 3..7 {
        p[(i, i)] += 1e-9;
    }
    let first = iterate.z.first()? - p.cholesky()?.solve(&q);
    roll(knots, iterate, &gains, first)
}

/// Adds the cost of missing the targets of a knot.
fn add_cost(
    knot: &Knot,
    targets: &[Target],
    weights: &[[f64; 3]],
    z: &State,
    p: &mut SMatrix<f64, 7, 7>,
    q: &mut SVector<f64, 7>,
) {
    let share = (knot.targets.len().max(1) as f64).recip();
    for i in knot.targets.clone() {
        let (Some(target), Some(weights)) = (targets.get(i), weights.get(i)) else {
            continue;
        };
        // Targets beside the knot, by less than the cluster's width, are moved onto it.
        let ahead = target.t - knot.t;
        let (sin, cos) = libm::sincos(z[2]);
        let miss = [
            z[0] + ahead * z[3] * cos - target.x,
            z[1] + ahead * z[3] * sin - target.y,
            z[2] + ahead * z[4] - target.theta,
        ];
        let (sin, cos) = libm::sincos(target.theta);
        let rows = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
        for (row, weight) in rows.iter().zip(weights) {
            let weight = share * weight;
            let error: f64 = row.iter().zip(miss).map(|(r, m)| r * m).sum();
            for (i, a) in row.iter().enumerate() {
                q[i] += weight * error * a;
                for (j, b) in row.iter().enumerate() {
                    p[(i, j)] += weight * a * b;
                }
            }
        }
    }
}

/// The new iterate, from the start through all knots.
fn roll(
    knots: &[Knot],
    iterate: &Iterate,
    gains: &[(Gain, Jerk)],
    first: State,
) -> Option<(Iterate, f64)> {
    let mut change: f64 = 0.0;
    let mut z = Vec::with_capacity(iterate.z.len());
    let mut u = Vec::with_capacity(iterate.u.len());
    let mut state = first;
    for (k, old) in iterate.z.iter().enumerate() {
        let moved = state - old;
        change = change.max(moved.fixed_rows::<3>(0).amax());
        z.push(state);
        if let (Some((gain, push)), Some(jerk), Some(from), Some(to)) = (
            gains.get(k),
            iterate.u.get(k),
            knots.get(k),
            knots.get(k + 1),
        ) {
            let jerk = jerk + push + gain * moved;
            state = advance(&state, &jerk, to.t - from.t);
            u.push(jerk);
        }
    }
    let finite = change.is_finite()
        && z.iter().all(|z| z.iter().all(|v| v.is_finite()))
        && u.iter().all(|u| u.iter().all(|v| v.is_finite()));
    finite.then_some((Iterate { z, u }, change))
}
