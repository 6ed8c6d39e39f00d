//! Wheel radii and track from external poses: dead reckoning from the wheel angles is laid on them.
//!
//! With wheel angles a, radii r and track l, over a step of the log
//!
//! ```text
//! ds  = (r_R da_R + r_L da_L) / 2
//! dth = (r_R da_R - r_L da_L) / l
//! dx  = ds cos(th + dth/2),  dy = ds sin(th + dth/2)
//! ```
//!
//! In windows of [`WINDOW_S`] each start pose is free, so that slip does not add up over the log,
//! and the poses' noise, not that of their differences, is what is white.

use super::fit::{Fit, Linear, Model, ROUNDS, fit};
use super::log::Log;
use nalgebra::{DMatrix, DVector, Vector3};
use std::f64::consts::TAU;

/// Length of a window \[s\]: long enough that a start pose of some millimetres of noise costs little
/// against metres of path, short enough that slip of a percent stays centimetres.
pub const WINDOW_S: f64 = 5.0;
/// Fewer fixes in a window say no more than its start pose.
const MIN_FIXES: usize = 5;
/// Headings this far off, root mean square, follow no wheels \[rad\]: any heading whatever is 1.8 rad off.
pub(super) const ANY_HEADING_RAD: f64 = 1.0;
/// Missing rows over which the wheels' angles still say the way \[s\]: a turn changes little meanwhile.
const BRIDGED_S: f64 = 0.1;
/// Time over which residuals may be correlated \[s\].
const CORRELATED_S: f64 = 0.5;

/// A fix with the part of the log that led to it.
#[derive(Clone, Copy)]
struct Sighting {
    /// The pose is of a time between this row and the next,
    row: usize,
    /// so far on the way.
    part: f64,
    pose: [f64; 3],
}

struct Poses<'a> {
    log: &'a Log,
    windows: Vec<Vec<Sighting>>,
}

/// Fits (r_R, r_L, 1/l). Nothing if the log has too few fixes. No window goes over a longer time that is `missing`: which way a
/// robot took meanwhile the wheels' angles do not say.
pub(super) fn kinematics(log: &Log, latency_s: f64, missing: &[bool]) -> Option<Fit> {
    let model = Poses {
        log,
        windows: windows(log, latency_s, missing),
    };
    if model.windows.is_empty() {
        return None;
    }
    let start = model.guess()?;
    let count: usize = model.windows.iter().map(Vec::len).sum();
    let time: f64 = model.windows.iter().map(|w| model.duration(w)).sum();
    let lags = (CORRELATED_S * count as f64 / time).ceil() as usize;
    // Equal weights of 1 m and 1 rad only until the residuals are known.
    let scale = start.map(f64::abs);
    fit(&model, start, &scale, vec![1.0e-2, 1.0e-2], lags, ROUNDS)
}

fn windows(log: &Log, latency_s: f64, missing: &[bool]) -> Vec<Vec<Sighting>> {
    let mut windows: Vec<Vec<Sighting>> = vec![Vec::new()];
    let mut begun = f64::NEG_INFINITY;
    let lost = |row: usize| missing[row] && log.t[row + 1] - log.t[row] > BRIDGED_S;
    let mut last = 0;
    for fix in &log.fixes {
        let time = log.t[fix.row] - fix.age_s - latency_s;
        let after = log.t.partition_point(|&t| t <= time);
        if after == 0 {
            // Of a time before the log.
            continue;
        }
        let row = (after - 1).min(log.t.len() - 2);
        let part = (time - log.t[row]) / (log.t[row + 1] - log.t[row]);
        if lost(row) {
            continue;
        }
        let over = (last..row).any(lost);
        last = row;
        if over || time - begun > WINDOW_S {
            windows.push(Vec::new());
            begun = time;
        }
        if let Some(window) = windows.last_mut() {
            window.push(Sighting {
                row,
                part,
                pose: fix.pose,
            });
        }
    }
    windows.retain(|window| window.len() >= MIN_FIXES);
    windows
}

impl Poses<'_> {
    fn duration(&self, window: &[Sighting]) -> f64 {
        match window {
            [first, .., last] => self.log.t[last.row] - self.log.t[first.row],
            _ => 0.0,
        }
    }

    /// Wheel angle steps between neighbouring sightings.
    fn steps<'a>(
        &'a self,
        window: &'a [Sighting],
    ) -> impl Iterator<Item = ([f64; 2], [f64; 3])> + 'a {
        window.windows(2).map(|pair| {
            let (a, b) = (self.angle(&pair[0]), self.angle(&pair[1]));
            let moved = [0, 1, 2].map(|i| pair[1].pose[i] - pair[0].pose[i]);
            (
                [b[0] - a[0], b[1] - a[1]],
                [moved[0], moved[1], wrapped(moved[2])],
            )
        })
    }

    fn angle(&self, at: &Sighting) -> [f64; 2] {
        let (a, b) = (self.log.angle[at.row], self.log.angle[at.row + 1]);
        [0, 1].map(|i| a[i] + at.part * (b[i] - a[i]))
    }

    /// Linear regression: headings give r/l, then displacements along the measured heading give r.
    fn guess(&self) -> Option<DVector<f64>> {
        let (mut turn, mut turn_by) = (0.0, 0.0);
        let (mut way, mut way_by) = (0.0, 0.0);
        for window in &self.windows {
            let mut heading = window[0].pose[2];
            // Over the whole window, where noise is small against what was driven.
            let (mut x, mut y, mut d) = (0.0, 0.0, [0.0; 2]);
            let (mut along_x, mut along_y) = (0.0, 0.0);
            for (angle, moved) in self.steps(window) {
                let middle = heading + 0.5 * moved[2];
                heading += moved[2];
                let mean = 0.5 * (angle[0] + angle[1]);
                (along_x, along_y) = (along_x + mean * middle.cos(), along_y + mean * middle.sin());
                (x, y) = (x + moved[0], y + moved[1]);
                d = [d[0] + angle[0], d[1] + angle[1]];
            }
            let difference = d[0] - d[1];
            turn += difference * (heading - window[0].pose[2]);
            turn_by += difference * difference;
            way += x * along_x + y * along_y;
            way_by += along_x * along_x + along_y * along_y;
        }
        let radius = if way_by > 0.0 { way / way_by } else { 0.0 };
        let ratio = if turn_by > 0.0 { turn / turn_by } else { 0.0 };
        if radius == 0.0 || !radius.is_finite() {
            return None;
        }
        // A track of five radii where the log never turns: any start serves.
        let curvature = if ratio == 0.0 { 0.2 } else { ratio } / radius;
        Some(DVector::from_vec(vec![radius, radius, curvature]))
    }

    /// Dead reckoning from the window's first sighting.
    fn reckon(&self, global: &[f64], window: &[Sighting]) -> Vec<Vector3<f64>> {
        let [r, l, curvature] = *global else {
            return Vec::new();
        };
        let forward = |from: Vector3<f64>, step: [f64; 2]| {
            let (right, left) = (r * step[0], l * step[1]);
            let (way, turn) = (0.5 * (right + left), (right - left) * curvature);
            let (sin, cos) = (from.z + 0.5 * turn).sin_cos();
            from + Vector3::new(way * cos, way * sin, turn)
        };
        let mut at = Vector3::zeros();
        let Some(first) = window.first() else {
            return Vec::new();
        };
        let mut row = first.row;
        let mut from = self.angle(first);
        let mut poses = Vec::with_capacity(window.len());
        for sighting in window {
            while row < sighting.row {
                row += 1;
                let angle = self.log.angle[row];
                at = forward(at, [angle[0] - from[0], angle[1] - from[1]]);
                from = angle;
            }
            let angle = self.angle(sighting);
            poses.push(forward(at, [angle[0] - from[0], angle[1] - from[1]]));
        }
        poses
    }
}

/// To -pi to pi.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

impl Model for Poses<'_> {
    fn windows(&self) -> usize {
        self.windows.len()
    }

    fn kinds(&self) -> &[usize] {
        &[0, 0, 1]
    }

    fn states_of_kind(&self) -> &[usize] {
        &[2, 1]
    }

    fn start(&self, window: usize) -> DVector<f64> {
        DVector::from_row_slice(&self.windows[window][0].pose)
    }

    fn residual(&self, global: &DVector<f64>, window: usize, local: &DVector<f64>) -> DVector<f64> {
        let window = &self.windows[window];
        let (sin, cos) = local[2].sin_cos();
        let poses = self.reckon(global.as_slice(), window);
        let rows = poses.iter().zip(window).flat_map(|(p, seen)| {
            [
                local[0] + cos * p.x - sin * p.y - seen.pose[0],
                local[1] + sin * p.x + cos * p.y - seen.pose[1],
                wrapped(local[2] + p.z - seen.pose[2]),
            ]
        });
        DVector::from_iterator(3 * window.len(), rows)
    }

    fn linear(&self, global: &DVector<f64>, window: usize, local: &DVector<f64>) -> Linear {
        let rows = 3 * self.windows[window].len();
        let mut by_global = DMatrix::zeros(rows, 3);
        for i in 0..3 {
            // Central differences: error of the third order, 1e-10 of the value.
            let step = 1.0e-5 * global[i].abs().max(1.0e-3);
            let (mut up, mut down) = (global.clone(), global.clone());
            up[i] += step;
            down[i] -= step;
            let change = self.residual(&up, window, local) - self.residual(&down, window, local);
            by_global.set_column(i, &(change / (2.0 * step)));
        }
        let (sin, cos) = local[2].sin_cos();
        let mut by_local = DMatrix::zeros(rows, 3);
        let poses = self.reckon(global.as_slice(), &self.windows[window]);
        for (i, p) in poses.iter().enumerate() {
            by_local[(3 * i, 0)] = 1.0;
            by_local[(3 * i + 1, 1)] = 1.0;
            by_local[(3 * i + 2, 2)] = 1.0;
            by_local[(3 * i, 2)] = -sin * p.x - cos * p.y;
            by_local[(3 * i + 1, 2)] = cos * p.x - sin * p.y;
        }
        Linear {
            global: by_global,
            local: by_local,
        }
    }
}
