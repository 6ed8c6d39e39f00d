//! From the fitted numbers and what is stated to physical quantities with their covariance.

use super::fit::Fit;
use super::physics::{CURRENTS, Chart, MEASURED, MOTION, POSES, predict};
use super::quantity::{COUNT, Quantity};
use super::structure::Given;
use nalgebra::{DMatrix, DVector};

/// Standard deviation of a coordinate before anything is known: a factor of e^20. What stays that
/// wide was not in the data; what the data show to 25 % is moved by less than 1e-4 of its deviation.
const WIDE: f64 = 20.0;
/// Steps to the minimum; from the direct solution it takes less than ten.
const STEPS: usize = 200;

/// Coordinates of all quantities with the covariance of those that are not stated.
#[derive(Clone, Debug)]
pub(super) struct Combined {
    pub(super) chart: Chart,
    pub(super) x: [f64; COUNT],
    pub(super) covariance: DMatrix<f64>,
    /// Weighted sum of squares of the fitted numbers against the physical model.
    pub(super) misfit: f64,
    /// How many more numbers there are than quantities explain.
    pub(super) freedom: usize,
}

/// The physical quantities that agree best with both fits, weighted by their information.
pub(super) fn combine(given: &Given, poses: Option<&Fit>, motion: Option<&Fit>) -> Combined {
    let mut y = DVector::zeros(MEASURED);
    let mut information = DMatrix::zeros(MEASURED, MEASURED);
    if let Some(fit) = poses {
        y.rows_range_mut(POSES).copy_from(&fit.value);
        information
            .view_mut((0, 0), (POSES.len(), POSES.len()))
            .copy_from(&fit.information);
    }
    if let Some(fit) = motion {
        let (at, count) = (MOTION.start, fit.value.len());
        y.rows_mut(at, count).copy_from(&fit.value);
        information
            .view_mut((at, at), (count, count))
            .copy_from(&fit.information);
    }
    let (chart, start) = super::direct::direct(given, &y, poses.is_some(), motion);
    let mut free: Vec<_> = Quantity::ALL.map(Quantity::index).to_vec();
    free.retain(|&i| !given.is_given(Quantity::ALL[i]));
    let root = root(&information);
    let rank = root.nrows();
    let off = |x: &[f64; COUNT]| {
        let f = DVector::from_row_slice(&predict(chart.drive, &chart.values(x)));
        let part = &root * (f - &y);
        let prior = x.iter().zip(&start).map(|(x, s)| ((x - s) / WIDE).powi(2));
        let cost = part.norm_squared() + prior.sum::<f64>();
        (part, cost)
    };
    let (mut x, mut damping) = (start, 1.0e-3);
    let (mut part, mut cost) = off(&x);
    let mut h = DMatrix::identity(free.len(), free.len());
    for _ in 0..STEPS {
        let j = (&root * chart.derivatives(&x)).select_columns(&free);
        h = j.tr_mul(&j) + DMatrix::identity(free.len(), free.len()) / (WIDE * WIDE);
        let mut b = j.tr_mul(&part);
        for (n, &i) in free.iter().enumerate() {
            b[n] += (x[i] - start[i]) / (WIDE * WIDE);
        }
        let before = cost;
        while damping < 1.0e12 {
            let damped = &h + damping * DMatrix::from_diagonal(&h.diagonal());
            let step = damped.cholesky().map(|c| c.solve(&b));
            if let Some(step) = step {
                let mut tried = x;
                for (n, &i) in free.iter().enumerate() {
                    tried[i] -= step[n];
                }
                let (new_part, new) = off(&tried);
                if new < cost {
                    (x, part, cost) = (tried, new_part, new);
                    damping = (0.1 * damping).max(1.0e-12);
                    break;
                }
            }
            damping *= 10.0;
        }
        // Far below what one standard error of one number would change.
        if before - cost < 1.0e-6 {
            break;
        }
    }
    let mut covariance = DMatrix::zeros(COUNT, COUNT);
    // The least eigenvalue is that of the prior, so the inverse exists.
    let inverse = h
        .clone()
        .try_inverse()
        .unwrap_or_else(|| DMatrix::identity(free.len(), free.len()) * (WIDE * WIDE));
    for (a, &i) in free.iter().enumerate() {
        for (b, &j) in free.iter().enumerate() {
            covariance[(i, j)] = inverse[(a, b)];
        }
    }
    // Directions that the data show better than the prior does.
    let determined = h
        .symmetric_eigenvalues()
        .iter()
        .filter(|v| **v > 10.0 / (WIDE * WIDE))
        .count();
    Combined {
        chart,
        x,
        covariance,
        misfit: part.norm_squared(),
        freedom: rank.saturating_sub(determined),
    }
}

/// A root of the information, a row for each direction that the data show.
fn root(information: &DMatrix<f64>) -> DMatrix<f64> {
    // In units of the numbers' own information, for these differ by 1e12.
    let size = information.diagonal().map(|d| d.max(0.0).sqrt());
    let unit = size.map(|s| if s > 0.0 { 1.0 / s } else { 0.0 });
    let unit = DMatrix::from_diagonal(&unit);
    let eigen = (&unit * information * &unit).symmetric_eigen();
    let seen: Vec<_> = (0..MEASURED)
        .filter(|&i| eigen.eigenvalues[i] > 1.0e-13)
        .collect();
    let mut root = DMatrix::zeros(seen.len(), MEASURED);
    for (row, &i) in seen.iter().enumerate() {
        let direction = eigen.eigenvectors.column(i).transpose();
        let scaled = direction * DMatrix::from_diagonal(&size);
        root.set_row(row, &(eigen.eigenvalues[i].sqrt() * scaled));
    }
    root
}

const _: () = assert!(CURRENTS.end == MEASURED && POSES.end == MOTION.start);
