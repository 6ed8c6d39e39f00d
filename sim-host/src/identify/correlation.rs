//! What the data say when residuals are correlated.

use nalgebra::{DMatrix, DVector};

/// Directions with less than this part of the largest information are not in the data at all: the
/// derivatives are good to about 1e-7 of their size, its square is 1e-14.
const NOTHING: f64 = 1.0e-13;

/// Information matrix of scaled parameters from the Gauss-Newton matrix `h` of whitened residuals
/// and the scores of each window, a row a sample.
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
        let white = window * inverse.transpose();
        variance += gram(&sums(&white, lags)) / (lags + 1) as f64;
    }
    let mut excess = variance.symmetric_eigen();
    let less: DVector<f64> = excess.eigenvalues.map(|v| 1.0 / v.max(1.0));
    excess.eigenvalues = less;
    root.tr_mul(&(excess.recompose() * &root))
}

/// Sums of the last `lags` + 1 rows, from the first row until the last one is past. Bartlett's weights are how many of them two rows
/// share: the sum over all lags is one product.
fn sums(rows: &DMatrix<f64>, lags: usize) -> DMatrix<f64> {
    let count = rows.nrows();
    let mut sums = DMatrix::zeros(count + lags, rows.ncols());
    for (mut sums, rows) in sums.column_iter_mut().zip(rows.column_iter()) {
        let mut sum = 0.0;
        for n in 0..count + lags {
            sum += if n < count { rows[n] } else { 0.0 };
            sums[n] = sum;
            sum -= if n >= lags { rows[n - lags] } else { 0.0 };
        }
    }
    sums
}

/// M^T M, of which one half is the other.
pub(super) fn gram(m: &DMatrix<f64>) -> DMatrix<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Newey and West's sum as it stands, also of fewer rows than lags.
    #[test]
    fn bartlett_weights_are_shares_of_sums() {
        for (count, lags) in [(50, 0), (50, 7), (5, 9)] {
            let rows = DMatrix::from_fn(count, 3, |i, j| ((7 * i + 3 * j * j) as f64).sin());
            let mut variance = DMatrix::zeros(3, 3);
            for (a, b) in (0..count).flat_map(|a| (0..count).map(move |b| (a, b))) {
                let weight = 1.0 - a.abs_diff(b) as f64 / (lags + 1) as f64;
                variance += weight.max(0.0) * rows.row(a).transpose() * rows.row(b);
            }
            let off = gram(&sums(&rows, lags)) / (lags + 1) as f64 - &variance;
            // Roundings of sums of 50 numbers.
            assert!(off.amax() < 1e-12 * variance.amax(), "{count} {lags}");
        }
    }
}
