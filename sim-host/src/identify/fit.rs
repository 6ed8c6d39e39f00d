//! Nonlinear least squares with start states per window, and what the data say about the rest.
//!
//! Residuals r depend on global parameters g and, in each window, on that window's start state l.
//! Each Gauss-Newton step (damped: Levenberg, Marquardt) solves for l by an orthogonal
//! factorisation in its window and for g by the normal equations of what is left.

use super::correlation::{gram, information};
use nalgebra::{DMatrix, DVector};

/// Derivatives of a window's residuals.
pub(super) struct Linear {
    /// By global parameters.
    pub(super) global: DMatrix<f64>,
    /// By the window's start state.
    pub(super) local: DMatrix<f64>,
}

/// What is fitted. Residuals are predicted less measured, sample by sample, each sample with the
/// same channels in the same order.
pub(super) trait Model {
    /// How many windows there are.
    fn windows(&self) -> usize;
    /// The kind of noise of each channel of a sample, counted from 0.
    fn kinds(&self) -> &[usize];
    /// How many start states belong to each kind of noise.
    fn states_of_kind(&self) -> &[usize];
    /// What is known of the global parameters before: the inverse of the variance of each about
    /// zero, 0 for those of which nothing is known.
    fn prior(&self, count: usize) -> DVector<f64> {
        DVector::zeros(count)
    }
    /// First guess of a window's start state.
    fn start(&self, window: usize) -> DVector<f64>;
    /// Residuals.
    fn residual(&self, global: &DVector<f64>, window: usize, local: &DVector<f64>) -> DVector<f64>;
    /// Their derivatives.
    fn linear(&self, global: &DVector<f64>, window: usize, local: &DVector<f64>) -> Linear;
}

/// What was found.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    pub(super) value: DVector<f64>,
    /// Information: the inverse of the covariance where there is one; directions that the data do
    /// not show have none.
    pub(super) information: DMatrix<f64>,
    /// Standard deviation of the residuals, by kind of noise.
    pub(super) sigma: Vec<f64>,
    /// Residuals less parameters.
    pub(super) freedom: f64,
    /// Windows that were used.
    pub(super) windows: usize,
}

/// Added to the information of each parameter, as a share of it: what the data do not show is uncertain without end.
const UNSHOWN: f64 = 1.0e-9;

impl Fit {
    /// Whether a parameter is below zero, and not by chance: by three standard deviations, with all others as uncertain as they
    /// are.
    pub(super) fn is_negative(&self, index: usize) -> bool {
        // Parameters differ by orders of magnitude: by their own information all are alike.
        let unit = self.information.diagonal().map(|own| own.max(0.0).sqrt());
        let count = unit.len();
        let scaled = DMatrix::from_fn(count, count, |i, j| {
            let product = unit[i] * unit[j];
            let shown = if product > 0.0 {
                self.information[(i, j)] / product
            } else {
                0.0
            };
            shown + if i == j { UNSHOWN } else { 0.0 }
        });
        let Some(covariance) = scaled.cholesky().map(|c| c.inverse()) else {
            return false;
        };
        let value = self.value[index] * unit[index];
        value < 0.0 && value * value > 9.0 * covariance[(index, index)]
    }
}

/// Steps until a fit has certainly converged: from a start within 50 % it takes five to ten.
const STEPS: usize = 40;
/// A step that lowers the sum of squares by less than this part is the last: a hundredth of a
/// standard error of one parameter among 1e4 residuals lowers it by 1e-8.
const ENOUGH: f64 = 1.0e-9;
/// Damping that a descent begins with, and the most that one takes over from where no step was small enough.
const DAMPING: f64 = 1.0e-4;
/// Weights from residuals, twice: the first fit's weights are guesses.
pub(super) const ROUNDS: usize = 3;

/// A step that lowers the sum of squares by less than this part leaves derivatives as they were: it moves 1e4 residuals by three
/// standard errors, so that the next step, by the same derivatives, is right to some per cent. The last round begins with
/// derivatives of its own.
const NEAR: f64 = 1.0e-3;

/// Derivatives of a window whose start state is projected out, weighted.
struct Reduced {
    /// Start state = -(by_residual + by_global * step), with this and the weighted derivatives by the start state, Q R.
    by_global: DMatrix<f64>,
    q: DMatrix<f64>,
    r: DMatrix<f64>,
    global: DMatrix<f64>,
    /// Of `global`.
    gram: DMatrix<f64>,
}

/// A fit under way.
struct Descent<'a, M> {
    model: &'a M,
    scale: &'a DVector<f64>,
    value: DVector<f64>,
    /// Start states, by window.
    local: Vec<DVector<f64>>,
    residuals: Vec<DVector<f64>>,
    /// Near there, or at it if they are `fresh`.
    slopes: Vec<Linear>,
    fresh: bool,
    damping: f64,
}

/// Fits. `scale` holds typical sizes of the parameters, `sigma` first guesses of the noise, `lags`
/// the samples over which residuals may be correlated, `rounds` how often weights are new.
pub(super) fn fit(
    model: &impl Model,
    start: DVector<f64>,
    scale: &DVector<f64>,
    mut sigma: Vec<f64>,
    lags: usize,
    rounds: usize,
) -> Option<Fit> {
    let mut descent = Descent::new(model, start, scale);
    let mut reduced = Vec::new();
    for round in 0..rounds {
        let last = round + 1 == rounds;
        reduced = descent.descend(&sigma, round == 0 || last)?;
        if !last {
            sigma = descent.spread()?;
        }
    }
    let Descent {
        value, residuals, ..
    } = descent;
    let channels = model.kinds().len();
    let scores: Vec<_> = reduced
        .iter()
        .zip(&residuals)
        .map(|(window, residual)| {
            let residual = whitened(model, residual, &sigma);
            let of_start = &window.q * window.q.tr_mul(&residual);
            scores(&window.global, &(residual - of_start), channels)
        })
        .collect();
    let count: usize = residuals.iter().map(|residual| residual.len()).sum();
    let states: usize = reduced.iter().map(|window| window.r.ncols()).sum();
    let h = reduced
        .into_iter()
        .map(|window| window.gram)
        .reduce(|a, b| a + b)?;
    let freedom = count.saturating_sub(states + value.len()) as f64;
    let unit = DMatrix::from_diagonal(&scale.map(|s| 1.0 / s));
    let shown = &unit * information(&h, &scores, lags) * &unit;
    let information = shown + DMatrix::from_diagonal(&model.prior(value.len()));
    let whole = freedom > 0.0
        && value
            .iter()
            .chain(information.iter())
            .all(|x| x.is_finite());
    whole.then_some(Fit {
        value,
        information,
        sigma,
        freedom,
        windows: model.windows(),
    })
}

impl<'a, M: Model> Descent<'a, M> {
    fn new(model: &'a M, value: DVector<f64>, scale: &'a DVector<f64>) -> Self {
        let local: Vec<_> = (0..model.windows()).map(|w| model.start(w)).collect();
        Self {
            model,
            scale,
            residuals: residuals(model, &value, &local),
            value,
            local,
            slopes: Vec::new(),
            fresh: false,
            damping: DAMPING,
        }
    }

    /// Goes down with these weights; gives the reduced derivatives of where it ends, or of near it. They `renew` at the begin, or stay
    /// until a step is not small. `None` without a start state that could be found.
    fn descend(&mut self, sigma: &[f64], renew: bool) -> Option<Vec<Reduced>> {
        self.damping = self.damping.min(DAMPING);
        let mut cost = cost(self.model, &self.value, &self.residuals, sigma);
        let mut reduced = Vec::new();
        let mut stale = renew && !self.fresh;
        for _ in 0..STEPS {
            if stale {
                self.look();
                reduced.clear();
            }
            if reduced.is_empty() {
                reduced = self.reduced(sigma)?;
            }
            let was_fresh = self.fresh;
            match self.step(&reduced, sigma, cost) {
                Some(lower) => {
                    let gain = (cost - lower) / cost.max(f64::MIN_POSITIVE);
                    if gain < ENOUGH {
                        break;
                    }
                    (cost, stale) = (lower, gain > NEAR);
                }
                None if was_fresh => break,
                // Derivatives of elsewhere need not lead down.
                None => (self.damping, stale) = (DAMPING, true),
            }
        }
        Some(reduced)
    }

    /// Takes the derivatives of here.
    fn look(&mut self) {
        let (value, local) = (&self.value, &self.local);
        self.slopes = (0..local.len())
            .map(|w| self.model.linear(value, w, &local[w]))
            .collect();
        self.fresh = true;
    }

    fn reduced(&self, sigma: &[f64]) -> Option<Vec<Reduced>> {
        self.slopes
            .iter()
            .map(|slope| reduce(self.model, slope, self.scale, sigma))
            .collect()
    }

    /// A step down, with as much damping as it needs; the sum of squares after it.
    fn step(&mut self, windows: &[Reduced], sigma: &[f64], cost_here: f64) -> Option<f64> {
        let count = self.value.len();
        let (mut h, mut b) = (DMatrix::zeros(count, count), DVector::zeros(count));
        let mut by_residual = Vec::with_capacity(windows.len());
        for (window, residual) in windows.iter().zip(&self.residuals) {
            let residual = whitened(self.model, residual, sigma);
            h += &window.gram;
            // What the start state takes of residuals is across to what is left of the derivatives.
            b += window.global.tr_mul(&residual);
            let of_start = window.q.tr_mul(&residual);
            by_residual.push(window.r.solve_upper_triangular(&of_start)?);
        }
        for (i, weight) in self.model.prior(count).iter().enumerate() {
            h[(i, i)] += weight * self.scale[i] * self.scale[i];
            b[i] += weight * self.scale[i] * self.value[i];
        }
        // Far below what any parameter's own information is: only directions that nothing shows need it.
        let floor = 1.0e-12 * h.diagonal().amax();
        while self.damping < 1.0e9 {
            let mut damped = h.clone();
            for i in 0..count {
                damped[(i, i)] += self.damping * h[(i, i)] + floor;
            }
            let Some(step) = damped.cholesky().map(|c| -c.solve(&b)) else {
                self.damping *= 10.0;
                continue;
            };
            let tried = &self.value + step.component_mul(self.scale);
            let states: Vec<_> = windows
                .iter()
                .zip(by_residual.iter().zip(&self.local))
                .map(|(window, (by_residual, l))| l - (by_residual + &window.by_global * &step))
                .collect();
            let left = residuals(self.model, &tried, &states);
            let new = cost(self.model, &tried, &left, sigma);
            if new <= cost_here {
                (self.value, self.local, self.residuals) = (tried, states, left);
                self.fresh = false;
                self.damping = (0.1 * self.damping).max(1.0e-9);
                return Some(new);
            }
            self.damping *= 10.0;
        }
        None
    }

    /// Standard deviations by kind of noise, each with its own start states taken off.
    fn spread(&self) -> Option<Vec<f64>> {
        let kinds = self.model.kinds();
        let states = self.model.states_of_kind();
        let mut sums = vec![(0.0, 0.0); states.len()];
        for (i, r) in self.residuals.iter().flat_map(|r| r.iter().enumerate()) {
            let sum = &mut sums[kinds[i % kinds.len()]];
            *sum = (sum.0 + r * r, sum.1 + 1.0);
        }
        let windows = self.local.len() as f64;
        let parameters = self.value.len() as f64 / states.len() as f64;
        sums.iter()
            .zip(states)
            .map(|((squares, count), &states): (&(f64, f64), _)| {
                let freedom = count - windows * states as f64 - parameters;
                // Residuals of nothing but rounding still need a weight.
                (freedom >= 1.0).then(|| (squares / freedom).sqrt().max(1.0e-12))
            })
            .collect()
    }
}

fn residuals(
    model: &impl Model,
    value: &DVector<f64>,
    local: &[DVector<f64>],
) -> Vec<DVector<f64>> {
    let windows = local.iter().enumerate();
    windows
        .map(|(window, local)| model.residual(value, window, local))
        .collect()
}

/// Sum of squares of weighted residuals, and of what is known before.
fn cost(
    model: &impl Model,
    value: &DVector<f64>,
    residuals: &[DVector<f64>],
    sigma: &[f64],
) -> f64 {
    let prior = model.prior(value.len());
    let squares = |residual| whitened(model, residual, sigma).norm_squared();
    // A comparison with NaN is false: such a step is refused.
    prior.dot(&value.component_mul(value)) + residuals.iter().map(squares).sum::<f64>()
}

fn whitened(model: &impl Model, residual: &DVector<f64>, sigma: &[f64]) -> DVector<f64> {
    let mut residual = residual.clone();
    whiten(model, residual.as_mut_slice(), sigma);
    residual
}

fn whiten(model: &impl Model, rows: &mut [f64], sigma: &[f64]) {
    for (row, kind) in rows.iter_mut().zip(model.kinds().iter().cycle()) {
        *row /= sigma[*kind];
    }
}

fn reduce(
    model: &impl Model,
    slope: &Linear,
    scale: &DVector<f64>,
    sigma: &[f64],
) -> Option<Reduced> {
    let Linear { global, local } = slope;
    let (mut global, mut local) = (global.clone(), local.clone());
    for (mut column, scale) in global.column_iter_mut().zip(scale.iter()) {
        column *= *scale;
    }
    for matrix in [&mut global, &mut local] {
        let rows = matrix.nrows().max(1);
        for column in matrix.as_mut_slice().chunks_mut(rows) {
            whiten(model, column, sigma);
        }
    }
    let (q, r) = local.qr().unpack();
    let of_start = q.tr_mul(&global);
    let by_global = r.solve_upper_triangular(&of_start)?;
    global -= &q * of_start;
    Some(Reduced {
        by_global,
        q,
        r,
        gram: gram(&global),
        global,
    })
}

/// Gradient of half the sum of squares, a row a sample.
fn scores(global: &DMatrix<f64>, residual: &DVector<f64>, channels: usize) -> DMatrix<f64> {
    let samples = residual.len() / channels;
    let mut scores = DMatrix::zeros(samples, global.ncols());
    for (mut scores, by) in scores.column_iter_mut().zip(global.column_iter()) {
        for (row, (by, r)) in by.iter().zip(residual).enumerate() {
            scores[row / channels] += by * r;
        }
    }
    scores
}
