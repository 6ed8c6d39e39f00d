//! Fit of the wheels' motion and current: the system of [`super::wheels`] is simulated over each
//! stretch and laid on the measured angles, which are never differentiated.

use super::fit::{Fit, Linear, Model, fit};
use super::lag::{self, LAGS, Lags};
use super::log::Log;
use super::motor;
use super::quantity::Known;
use super::start::guess;
use super::stretches::Stretch;
use super::wheels::{DYNAMIC, State, Wheels};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// Time over which residuals may be correlated \[s\].
const CORRELATED_S: f64 = 0.2;

struct Motion<'a> {
    log: &'a Log,
    speeds: &'a [[f64; 2]],
    stretches: &'a [Stretch],
    /// D_e of the wheels' system, where that is stated.
    stated: [Option<f64>; 2],
    scale: DVector<f64>,
    /// Standard deviation of the lags about 0 before the fit \[s\].
    lag_s: f64,
}

/// Fits E, D, s and, with currents, alpha and beta of the right, then of the left motor; beside them
/// the lags, which the fit that is given back allows for.
pub(super) fn dynamics(
    log: &Log,
    known: &Known,
    speeds: &[[f64; 2]],
    stretches: &[Stretch],
) -> Option<(Fit, Lags)> {
    let wheels = guess(log, speeds, stretches)?;
    let count = wheels.len();
    let scale = scale(&wheels).insert_rows(count, LAGS, lag::TYPICAL_S);
    let start = wheels.insert_rows(count, LAGS, 0.0);
    let mut model = Motion {
        log,
        speeds,
        stretches,
        stated: motor::stated(log.drive, known),
        scale: scale.clone(),
        lag_s: lag::BEFORE_S,
    };
    let rows = log.t.len() - 1;
    let correlated = (CORRELATED_S * rows as f64 / (log.t[rows] - log.t[0])).ceil() as usize;
    let angle = log.step_rad.map_or(1.0e-3, |step| step / 12.0_f64.sqrt());
    let largest = log.current.iter().flatten().flatten();
    let current = 0.02 * largest.fold(0.0_f64, |most, i| most.max(i.abs())) + 1.0e-6;
    let sigma = match log.current {
        Some(_) => vec![angle, current],
        None => vec![angle],
    };
    let whole = fit(&model, start.clone(), &scale, sigma.clone(), correlated)?;
    let (found, told) = lag::set_apart(whole);
    if told.early() {
        // No lag but something else that would pull mass and resistance along.
        model.lag_s = lag::NONE_S;
        let without = fit(&model, start, &scale, sigma, correlated)?;
        return Some((lag::set_apart(without).0, told));
    }
    Some((found, told))
}

/// Typical sizes: the inertias', dampings' and frictions' own of both sides.
fn scale(p: &DVector<f64>) -> DVector<f64> {
    let mean = |a: usize, b: usize| 0.5 * (p[a].abs() + p[b].abs());
    let (e, d) = (mean(0, 3), mean(4, 5));
    // Friction worth the drag at a speed of 1 rad/s.
    let s = mean(6, 7) + d;
    let mut scale = vec![e, e, e, e, d, d, s, s];
    scale.extend(p.iter().skip(DYNAMIC).map(|x| x.abs().max(1.0e-9)));
    DVector::from_vec(scale)
}

impl Motion<'_> {
    fn per_sample(&self) -> usize {
        if self.log.current.is_some() { 4 } else { 2 }
    }

    /// The system of these parameters.
    fn wheels(&self, global: &[f64]) -> Option<Wheels> {
        let emf = [0, 1].map(|i| match (self.stated[i], &self.log.current) {
            (Some(stated), _) => stated,
            (None, Some(_)) => motor::measured(global, i),
            // Nine tenths and more in gear motors; the rest enters times the lag only.
            (None, None) => global[4 + i],
        });
        Wheels::new(global, emf, lag::of(global))
    }

    fn states(&self, wheels: &Wheels, stretch: &Stretch, local: &DVector<f64>) -> Vec<State> {
        let mut state = State {
            angle: Vector2::new(local[0], local[1]),
            speed: Vector2::new(local[2], local[3]),
            // Jumps before a stretch are forgotten within a row or two.
            left: Vector2::zeros(),
        };
        let mut states = Vec::with_capacity(stretch.last - stretch.first + 1);
        let mut step = None;
        states.push(state);
        for row in stretch.first..stretch.last {
            let solution = wheels.step_like(step, self.log.t[row + 1] - self.log.t[row]);
            let u = self.log.command[row];
            // No stretch begins at the first row.
            state = wheels.switched(state, self.log.command[row - 1], u);
            state = wheels.advance(&solution, state, u, stretch.sign);
            step = Some(solution);
            states.push(state);
        }
        states
    }

    /// Predicted angles and currents, sample by sample.
    fn predicted(
        &self,
        global: &[f64],
        stretch: &Stretch,
        local: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let wheels = self.wheels(global)?;
        let states = self.states(&wheels, stretch, local);
        let mut rows = Vec::with_capacity(self.per_sample() * states.len());
        for (row, state) in (stretch.first..).zip(states) {
            rows.extend(state.angle.iter());
            if self.log.current.is_some() {
                // Measured with the angles, before the row's own command: that of the row before.
                let u = self.log.command[row - 1];
                let acceleration = wheels.acceleration(state.speed, u, stretch.sign);
                rows.extend([0, 1].map(|i| {
                    let acts = u[i] + state.left[i];
                    motor::current(global, i, acts, state.speed[i], acceleration[i])
                }));
            }
        }
        Some(DVector::from_vec(rows))
    }

    fn simulated(&self, global: &[f64], stretch: &Stretch, local: &DVector<f64>) -> DVector<f64> {
        self.predicted(global, stretch, local).unwrap_or_else(|| {
            // No system: no sum of squares, so the step is refused.
            let samples = stretch.last - stretch.first + 1;
            DVector::from_element(self.per_sample() * samples, f64::NAN)
        })
    }

    fn measured(&self, stretch: &Stretch) -> DVector<f64> {
        let mut rows = Vec::new();
        for row in stretch.first..=stretch.last {
            rows.extend(self.log.angle[row]);
            rows.extend(self.log.current.iter().flat_map(|current| current[row]));
        }
        DVector::from_vec(rows)
    }

    /// Derivatives by the start state: the system is linear in it.
    fn by_start(&self, global: &[f64], stretch: &Stretch) -> DMatrix<f64> {
        let per = self.per_sample();
        let samples = stretch.last - stretch.first + 1;
        let mut rows = DMatrix::zeros(per * samples, 4);
        let Some(wheels) = self.wheels(global) else {
            return rows;
        };
        let (mut angle, mut speed) = (Matrix2::zeros(), Matrix2::identity());
        let mut step = None;
        for sample in 0..samples {
            let rate = wheels.rate() * speed;
            for i in 0..2 {
                let at = per * sample + i;
                rows[(at, i)] = 1.0;
                rows.view_mut((at, 2), (1, 2)).copy_from(&angle.row(i));
                if per > 2 {
                    let part = |by: f64, rate: f64| motor::current(global, i, 0.0, by, rate);
                    for side in 0..2 {
                        rows[(at + 2, 2 + side)] = part(speed[(i, side)], rate[(i, side)]);
                    }
                }
            }
            let row = stretch.first + sample;
            if row < stretch.last {
                let solution = wheels.step_like(step, self.log.t[row + 1] - self.log.t[row]);
                angle += solution.once * speed;
                speed = solution.speed * speed;
                step = Some(solution);
            }
        }
        rows
    }
}

impl Model for Motion<'_> {
    fn windows(&self) -> usize {
        self.stretches.len()
    }

    fn kinds(&self) -> &[usize] {
        if self.log.current.is_some() {
            &[0, 0, 1, 1]
        } else {
            &[0, 0]
        }
    }

    fn states_of_kind(&self) -> &[usize] {
        if self.log.current.is_some() {
            &[4, 0]
        } else {
            &[4]
        }
    }

    fn prior(&self, count: usize) -> DVector<f64> {
        lag::prior(count, self.lag_s)
    }

    fn start(&self, window: usize) -> DVector<f64> {
        let first = self.stretches[window].first;
        let (angle, speed) = (self.log.angle[first], self.speeds[first]);
        DVector::from_vec(vec![angle[0], angle[1], speed[0], speed[1]])
    }

    fn residual(&self, global: &DVector<f64>, window: usize, local: &DVector<f64>) -> DVector<f64> {
        let stretch = &self.stretches[window];
        self.simulated(global.as_slice(), stretch, local) - self.measured(stretch)
    }

    fn linear(&self, global: &DVector<f64>, window: usize, local: &DVector<f64>) -> Linear {
        let stretch = &self.stretches[window];
        let here = self.simulated(global.as_slice(), stretch, local);
        let mut by_global = DMatrix::zeros(here.len(), global.len());
        let mut moved = global.clone();
        for i in 0..global.len() {
            // One-sided: error 1e-6 of the derivative, rounding 1e-8; only the way to the minimum
            // and the intervals see it, and those to 1e-6 of their width.
            let step = 1.0e-6 * self.scale[i];
            moved[i] = global[i] + step;
            let there = self.simulated(moved.as_slice(), stretch, local);
            by_global.set_column(i, &((there - &here) / step));
            moved[i] = global[i];
        }
        Linear {
            residual: here - self.measured(stretch),
            global: by_global,
            local: self.by_start(global.as_slice(), stretch),
        }
    }
}
