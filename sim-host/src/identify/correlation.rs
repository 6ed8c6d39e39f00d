//! What the data say when residuals are correlated.

use nalgebra::{DMatrix, DVector};

/// Directions with less than this part of the largest information are not in the data at all: the
/// derivatives are good to about 1e-7 of their size, its square is 1e-14.
const NOTHING: f64 = 1.0e-13;

/// Information matrix of scaled parameters from the Gauss-Newton matrix `h` of whitened residuals
/// and the scores of each window, a column a sample.
///
/// White residuals give `h` itself. Correlated ones (quantised slow wheels, what the model does not
/// know) give less: the variance of the scores is estimated with Bartlett weights over `lags`
/// samples (Newey and West, Econometrica 55, 1987), and where it exceeds that of white residuals
/// the information is divided by the excess. It is never multiplied: an estimate below is chance.
pub(super) fn information(h: &DMatrix<f64>, scores: &[DMatrix<f64>], lags: usize) -> DMatrix<f64> {
    let eigen = h.clone().symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let seen: Vec<_> = (0..h.nrows())
        .filter(|&i| eigen.eigenvalues[i] > NOTHING * largest && largest > 0.0)
        .collect();
    if seen.is_empty() {
        return DMatrix::zeros(h.nrows(), h.nrows());
    }
    let mut root = DMatrix::zeros(seen.len(), h.nrows());
    let mut inverse = root.clone();
    for (row, &i) in seen.iter().enumerate() {
        let (size, direction) = (eigen.eigenvalues[i].sqrt(), eigen.eigenvectors.column(i));
        root.set_row(row, &(size * direction.transpose()));
        inverse.set_row(row, &(direction.transpose() / size));
    }
    let mut variance = DMatrix::zeros(seen.len(), seen.len());
    for window in scores {
        let white = &inverse * window;
        for lag in 0..=lags.min(white.ncols().saturating_sub(1)) {
            let weight = 1.0 - lag as f64 / (lags + 1) as f64;
            let count = white.ncols() - lag;
            let product = weight * white.columns(lag, count) * white.columns(0, count).transpose();
            if lag > 0 {
                variance += product.transpose();
            }
            variance += product;
        }
    }
    let mut excess = variance.symmetric_eigen();
    let less: DVector<f64> = excess.eigenvalues.map(|v| 1.0 / v.max(1.0));
    excess.eigenvalues = less;
    root.tr_mul(&(excess.recompose() * &root))
}
