//! Where the fit of the wheels' motion begins: linear regression on the integrated equations.
//!
//! Over a time T, E (w(t+T) - w(t)) + D (a(t+T) - a(t)) + s sign T = integral of u: linear in E, D, s.
//! Noisy speeds bias it by some percent, which a start may be.

use super::log::{Drive, Log};
use super::stretches::Stretch;
use super::wheels::DYNAMIC;
use nalgebra::{DMatrix, DVector};

/// T \[s\]: about a motor's time constant.
const OVER_S: f64 = 0.2;
/// Weight of "the other wheel does not matter" against the data: decides where they do not.
const ALONE: f64 = 1.0e-3;

/// E by rows, D, s and with currents alpha and beta, right then left.
pub(super) fn guess(log: &Log, speeds: &[[f64; 2]], stretches: &[Stretch]) -> Option<DVector<f64>> {
    let mut rows: Vec<([f64; 8], [f64; 2])> = Vec::new();
    for stretch in stretches {
        for from in (stretch.first..stretch.last).step_by(2) {
            let to = log.t.partition_point(|&t| t < log.t[from] + OVER_S);
            if to > stretch.last {
                break;
            }
            let held = |i: usize| -> f64 {
                (from..to)
                    .map(|k| log.command[k][i] * (log.t[k + 1] - log.t[k]))
                    .sum()
            };
            let time = log.t[to] - log.t[from];
            let row = [0, 1].map(|i| {
                [
                    speeds[to][i] - speeds[from][i],
                    log.angle[to][i] - log.angle[from][i],
                    stretch.sign[i] * time,
                    0.0,
                ]
            });
            let [a, b] = row;
            rows.push((
                [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]],
                [held(0), held(1)],
            ));
        }
    }
    if rows.is_empty() {
        return None;
    }
    let side = |i: usize| {
        let mut a = DMatrix::zeros(rows.len() + 1, 4);
        let mut b = DVector::zeros(rows.len() + 1);
        for (n, (row, held)) in rows.iter().enumerate() {
            let (own, other) = (4 * i, 4 - 4 * i);
            for (column, value) in [row[own], row[other], row[own + 1], row[own + 2]]
                .into_iter()
                .enumerate()
            {
                a[(n, column)] = value;
            }
            b[n] = held[i];
        }
        a[(rows.len(), 1)] = ALONE * a.column(0).norm();
        solve(a, &b)
    };
    let (right, left) = (side(0)?, side(1)?);
    let mut p = vec![
        right[0], right[1], left[1], left[0], right[2], left[2], right[3], left[3],
    ];
    debug_assert_eq!(p.len(), DYNAMIC);
    if let Some(current) = &log.current {
        for i in 0..2 {
            let (alpha, beta) = electric(log, speeds, stretches, current, i)?;
            p.extend([alpha, beta]);
        }
    }
    Some(DVector::from_vec(p))
}

fn electric(
    log: &Log,
    speeds: &[[f64; 2]],
    stretches: &[Stretch],
    current: &[[f64; 2]],
    i: usize,
) -> Option<(f64, f64)> {
    let rows: Vec<_> = stretches.iter().flat_map(|s| s.first..=s.last).collect();
    let mut a = DMatrix::zeros(rows.len(), 2);
    let mut b = DVector::zeros(rows.len());
    for (n, &row) in rows.iter().enumerate() {
        a[(n, 0)] = log.command[row - 1][i];
        a[(n, 1)] = match log.drive {
            Drive::Torque => 0.0,
            Drive::Voltage | Drive::Duty => -speeds[row][i],
        };
        b[n] = current[row][i];
    }
    let found = solve(a, &b)?;
    Some((found[0], found[1]))
}

fn solve(a: DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let svd = a.svd(true, true);
    let least = 1.0e-9 * svd.singular_values.amax();
    svd.solve(b, least)
        .ok()
        .filter(|x| x.iter().all(|v| v.is_finite()))
}
