//! Where the fit of the wheels' motion begins: linear regression on the integrated equations.
//!
//! Over a time T, E (w(t+T) - w(t)) + D (a(t+T) - a(t)) + s sign T = integral of u: linear in E, D, s.
//! Noisy speeds bias it by some percent, which a start may be.

use super::log::{Drive, Log};
use super::stretches::{self, Stretch};
use super::wheels::DYNAMIC;
use nalgebra::{DMatrix, DVector};

/// T \[s\]: about a motor's time constant.
const OVER_S: f64 = 0.2;
/// Weight of "the other wheel does not matter" against the data: decides where they do not.
const ALONE: f64 = 1.0e-3;

/// Half of the time over which speeds beside currents are taken \[s\]: rows of 10 ms with their neighbours, and at 1 kHz noise of a count in 25 ms.
/// Means over longer times are slower than currents, which makes alpha too small: with 50 ms a fifth of what it is, where steps are left out.
const SHARP_S: f64 = 0.0125;

/// Where the fit begins.
pub(super) struct Start {
    /// E by rows, D, s and with currents alpha and beta, right then left.
    pub(super) value: DVector<f64>,
    /// With currents: share of the torque that gears hold back, and of the supply that drivers lose.
    pub(super) loss: [Option<f64>; 2],
    pub(super) band: [Option<f64>; 2],
}

/// With currents, torques of v = i/alpha commands are known, and with them what gears hold back of them,
///
/// ```text
/// E (w(t+T) - w(t)) + D (a(t+T) - a(t)) + s sign T + loss sign integral of |v| = integral of u
/// ```
pub(super) fn guess(log: &Log, speeds: &[[f64; 2]], used: &[Stretch]) -> Option<Start> {
    let motors = match &log.current {
        Some(current) => {
            let [right, left] = electric(log, used, current);
            Some([right?, left?])
        }
        None => None,
    };
    let lossy = motors.is_some() && log.drive != Drive::Torque;
    let mut all = Vec::new();
    for i in 0..2 {
        all.push(side(log, speeds, used, motors.as_ref(), lossy, i)?);
    }
    let [right, left] = [&all[0], &all[1]];
    let mut value = vec![
        right[0], right[1], left[1], left[0], right[2], left[2], right[3], left[3],
    ];
    debug_assert_eq!(value.len(), DYNAMIC);
    for motor in motors.iter().flatten() {
        value.extend([motor.alpha, motor.beta]);
    }
    Some(Start {
        value: DVector::from_vec(value),
        loss: [0, 1].map(|i| lossy.then(|| all[i][4])),
        band: [0, 1].map(|i| motors.as_ref().map(|motors| motors[i].band)),
    })
}

/// E of a wheel by its own and by the other's acceleration, D, s, loss.
fn side(
    log: &Log,
    speeds: &[[f64; 2]],
    stretches: &[Stretch],
    motors: Option<&[Motor; 2]>,
    lossy: bool,
    i: usize,
) -> Option<DVector<f64>> {
    // Of each row: command that acts, and the torque in commands.
    let acts = |row: usize| {
        let lost = motors.map_or(0.0, |motors| motors[i].band * full(log, row, i));
        log.command[row][i] - lost
    };
    let torque = |row: usize| match (motors, &log.current) {
        (Some(motors), Some(current)) if lossy => current[row][i] / motors[i].alpha,
        _ => 0.0,
    };
    let mut rows: Vec<([f64; 5], f64)> = Vec::new();
    for stretch in stretches {
        for from in (stretch.first..stretch.last).step_by(2) {
            let to = log.t.partition_point(|&t| t < log.t[from] + OVER_S);
            if to > stretch.last {
                break;
            }
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
                (from..to).map(|k| of(k) * (log.t[k + 1] - log.t[k])).sum()
            };
            let sign = stretch.sign[i];
            let moved = |side: usize| speeds[to][side] - speeds[from][side];
            let row = [
                moved(i),
                moved(1 - i),
                log.angle[to][i] - log.angle[from][i],
                sign * (log.t[to] - log.t[from]),
                sign * sum(&|k| 0.5 * (torque(k).abs() + torque(k + 1).abs())),
            ];
            rows.push((row, sum(&acts)));
        }
    }
    if rows.is_empty() {
        return None;
    }
    let columns = if lossy { 5 } else { 4 };
    let mut a = DMatrix::zeros(rows.len() + 1, columns);
    let mut b = DVector::zeros(rows.len() + 1);
    for (n, (row, acting)) in rows.iter().enumerate() {
        for column in 0..columns {
            a[(n, column)] = row[column];
        }
        b[n] = *acting;
    }
    a[(rows.len(), 1)] = ALONE * a.column(0).norm();
    solve(a, &b)
}

/// What a whole duty would be in the command's direction; 0 of commands that are no duties.
fn full(log: &Log, row: usize, i: usize) -> f64 {
    let supply = match (&log.supply, log.drive) {
        (Some(supply), _) => supply[row],
        (None, Drive::Duty) => 1.0,
        (None, _) => 0.0,
    };
    let duty = log.command[row][i];
    if duty == 0.0 {
        0.0
    } else {
        supply.copysign(duty)
    }
}

/// A driver that limits within this share of its limit, for what is sensed is noisy and peaks lie between rows.
const NEAR_LIMIT: f64 = 0.9;

/// Rows in which a driver may have held its current at the limit \[A\], so that its command did not act. None without
/// a limit or currents.
pub(super) fn limited(log: &Log, used: &[Stretch], limit_a: Option<f64>) -> Vec<bool> {
    let (Some(limit), Some(current)) = (limit_a, &log.current) else {
        return Vec::new();
    };
    let high = |current: f64| current.abs() >= NEAR_LIMIT * limit;
    let motors = electric(log, used, current);
    let alpha = motors.map(|motor| Some(motor?.alpha));
    let rows = 0..log.t.len();
    rows.map(|row| {
        (0..2).any(|i| {
            let jump = match (row, alpha[i]) {
                (1.., Some(alpha)) => alpha * (log.command[row][i] - log.command[row - 1][i]),
                _ => 0.0,
            };
            let end = current.get(row + 1).map_or(0.0, |next| next[i]);
            high(current[row][i] + jump) || high(current[row][i]) || high(end)
        })
    })
    .collect()
}

struct Motor {
    alpha: f64,
    beta: f64,
    band: f64,
}

/// Of either wheel, i = alpha (u - band) - beta w at the end of each row.
fn electric(log: &Log, used: &[Stretch], current: &[[f64; 2]]) -> [Option<Motor>; 2] {
    let sharp = stretches::speeds(log, SHARP_S);
    let rows: Vec<_> = used.iter().flat_map(|s| s.first..=s.last).collect();
    [0, 1].map(|i| motor(log, &sharp, &rows, current, i))
}

/// Of one wheel, in these rows and with `sharp` speeds.
fn motor(
    log: &Log,
    sharp: &[[f64; 2]],
    rows: &[usize],
    current: &[[f64; 2]],
    i: usize,
) -> Option<Motor> {
    if rows.is_empty() {
        return None;
    }
    let mut a = DMatrix::zeros(rows.len(), 3);
    let mut b = DVector::zeros(rows.len());
    for (n, &row) in rows.iter().enumerate() {
        a[(n, 0)] = log.command[row - 1][i];
        a[(n, 1)] = match log.drive {
            Drive::Torque => 0.0,
            Drive::Voltage | Drive::Duty => -sharp[row][i],
        };
        a[(n, 2)] = -full(log, row - 1, i);
        b[n] = current[row][i];
    }
    let found = solve(a, &b)?;
    let band = found[2] / found[0];
    // NaN of a motor that draws nothing is 0; no bridge loses a fifth.
    let band = if band > 0.0 { band.min(0.2) } else { 0.0 };
    Some(Motor {
        alpha: found[0],
        beta: found[1],
        band,
    })
}

fn solve(a: DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    // Of what is no number the decomposition has no end.
    if a.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let svd = a.svd(true, true);
    let least = 1.0e-9 * svd.singular_values.amax();
    svd.solve(b, least)
        .ok()
        .filter(|x| x.iter().all(|v| v.is_finite()))
}
