//! Nonlinear least squares with start states per window, and what the data say about the rest.
//!
//! Residuals r depend on global parameters g and, in each window, on that window's start state l.
//! Each Gauss-Newton step (damped: Levenberg, Marquardt) solves for l by an orthogonal
//! factorisation in its window and for g by the normal equations of what is left.

use super::correlation::information;
use nalgebra::{DMatrix, DVector};

/// Residuals of a window with their derivatives.
pub(super) struct Linear {
    pub(super) residual: DVector<f64>,
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
    /// Residuals and derivatives.
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

/// Steps until a fit has certainly converged: from a start within 50 % it takes five to ten.
const STEPS: usize = 40;
/// A step that lowers the sum of squares by less than this part is the last: a hundredth of a
/// standard error of one parameter among 1e4 residuals lowers it by 1e-8.
const ENOUGH: f64 = 1.0e-9;
/// Weights from residuals, twice: the first fit's weights are guesses.
pub(super) const ROUNDS: usize = 3;

/// A window whose start state is projected out.
struct Reduced {
    residual: DVector<f64>,
    global: DMatrix<f64>,
    /// Start state = -(by_residual + by_global * step).
    by_residual: DVector<f64>,
    by_global: DMatrix<f64>,
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
    let (mut value, mut damping) = (start, 1.0e-4);
    let mut local: Vec<_> = (0..model.windows()).map(|w| model.start(w)).collect();
    for round in 0..rounds {
        descend(model, &mut value, &mut local, scale, &sigma, &mut damping);
        if round + 1 < rounds {
            sigma = spread(model, &value, &local)?;
        }
    }
    let windows: Vec<_> = (0..model.windows())
        .map(|w| reduce(model, &value, w, &local[w], scale, &sigma))
        .collect::<Option<_>>()?;
    let scores: Vec<_> = windows
        .iter()
        .map(|w| scores(w, model.kinds().len()))
        .collect();
    let h = windows
        .iter()
        .map(|w| gram(&w.global))
        .reduce(|a, b| a + b)?;
    let residuals: usize = windows.iter().map(|w| w.residual.len()).sum();
    let states: usize = local.iter().map(|l| l.len()).sum();
    let freedom = residuals.saturating_sub(states + value.len()) as f64;
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

fn descend(
    model: &impl Model,
    value: &mut DVector<f64>,
    local: &mut Vec<DVector<f64>>,
    scale: &DVector<f64>,
    sigma: &[f64],
    damping: &mut f64,
) {
    // Of a round that ended where no step was small enough.
    *damping = damping.min(1.0e-4);
    let mut cost = total(model, value, local, sigma);
    for _ in 0..STEPS {
        let windows: Option<Vec<_>> = (0..model.windows())
            .map(|w| reduce(model, value, w, &local[w], scale, sigma))
            .collect();
        let Some(windows) = windows else { return };
        let count = value.len();
        let (mut h, mut b) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for window in &windows {
            h += gram(&window.global);
            b += window.global.tr_mul(&window.residual);
        }
        for (i, weight) in model.prior(count).iter().enumerate() {
            h[(i, i)] += weight * scale[i] * scale[i];
            b[i] += weight * scale[i] * value[i];
        }
        // Far below what any parameter's own information is: only directions that nothing shows need it.
        let floor = 1.0e-12 * h.diagonal().amax();
        let mut gain = None;
        while *damping < 1.0e9 {
            let mut damped = h.clone();
            for i in 0..count {
                damped[(i, i)] += *damping * h[(i, i)] + floor;
            }
            let Some(step) = damped.cholesky().map(|c| -c.solve(&b)) else {
                *damping *= 10.0;
                continue;
            };
            let tried = &*value + step.component_mul(scale);
            let states: Vec<_> = windows
                .iter()
                .zip(&*local)
                .map(|(window, l)| l - (&window.by_residual + &window.by_global * &step))
                .collect();
            let new = total(model, &tried, &states, sigma);
            if new <= cost {
                gain = Some((cost - new) / cost.max(f64::MIN_POSITIVE));
                (*value, *local, cost) = (tried, states, new);
                *damping = (0.1 * *damping).max(1.0e-9);
                break;
            }
            *damping *= 10.0;
        }
        if gain.is_none_or(|gain| gain < ENOUGH) {
            return;
        }
    }
}

fn total(model: &impl Model, value: &DVector<f64>, local: &[DVector<f64>], sigma: &[f64]) -> f64 {
    let prior = model.prior(value.len());
    let mut sum = prior.dot(&value.component_mul(value));
    for (window, local) in local.iter().enumerate() {
        let mut residual = model.residual(value, window, local);
        whiten(model, &mut residual, sigma);
        sum += residual.norm_squared();
    }
    // A comparison with NaN is false: such a step is refused.
    sum
}

fn whiten(model: &impl Model, residual: &mut DVector<f64>, sigma: &[f64]) {
    for (r, kind) in residual.iter_mut().zip(model.kinds().iter().cycle()) {
        *r /= sigma[*kind];
    }
}

fn reduce(
    model: &impl Model,
    value: &DVector<f64>,
    window: usize,
    local: &DVector<f64>,
    scale: &DVector<f64>,
    sigma: &[f64],
) -> Option<Reduced> {
    let mut linear = model.linear(value, window, local);
    whiten(model, &mut linear.residual, sigma);
    for mut column in linear
        .global
        .column_iter_mut()
        .chain(linear.local.column_iter_mut())
    {
        for (entry, kind) in column.iter_mut().zip(model.kinds().iter().cycle()) {
            *entry /= sigma[*kind];
        }
    }
    for (mut column, scale) in linear.global.column_iter_mut().zip(scale.iter()) {
        column *= *scale;
    }
    let (q, r) = linear.local.qr().unpack();
    let (qr, qg) = (q.tr_mul(&linear.residual), q.tr_mul(&linear.global));
    Some(Reduced {
        by_residual: r.solve_upper_triangular(&qr)?,
        by_global: r.solve_upper_triangular(&qg)?,
        residual: linear.residual - &q * qr,
        global: linear.global - &q * qg,
    })
}

/// M^T M, of which one half is the other.
fn gram(m: &DMatrix<f64>) -> DMatrix<f64> {
    let count = m.ncols();
    let mut product = DMatrix::zeros(count, count);
    for i in 0..count {
        for j in 0..=i {
            let entry = m.column(i).dot(&m.column(j));
            (product[(i, j)], product[(j, i)]) = (entry, entry);
        }
    }
    product
}

/// Gradient of half the sum of squares, sample by sample.
fn scores(window: &Reduced, channels: usize) -> DMatrix<f64> {
    let samples = window.residual.len() / channels;
    let mut scores = DMatrix::zeros(window.global.ncols(), samples);
    for (row, r) in window.residual.iter().enumerate() {
        let mut column = scores.column_mut(row / channels);
        column += window.global.row(row).transpose() * *r;
    }
    scores
}

/// Standard deviations by kind of noise, each with its own start states taken off.
fn spread(model: &impl Model, value: &DVector<f64>, local: &[DVector<f64>]) -> Option<Vec<f64>> {
    let kinds = model.kinds();
    let states = model.states_of_kind();
    let mut sums = vec![(0.0, 0.0); states.len()];
    for (window, local) in local.iter().enumerate() {
        for (i, r) in model.residual(value, window, local).iter().enumerate() {
            let sum = &mut sums[kinds[i % kinds.len()]];
            *sum = (sum.0 + r * r, sum.1 + 1.0);
        }
    }
    let windows = local.len() as f64;
    let parameters = value.len() as f64 / states.len() as f64;
    sums.iter()
        .zip(states)
        .map(|((squares, count), &states): (&(f64, f64), _)| {
            let freedom = count - windows * states as f64 - parameters;
            // Residuals of nothing but rounding still need a weight.
            (freedom >= 1.0).then(|| (squares / freedom).sqrt().max(1.0e-12))
        })
        .collect()
}
