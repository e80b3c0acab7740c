//! The few shapes in which a matrix of many columns acts.

use faer::Mat;

/// Singular values below this share of the largest carry nothing: H keeps nine digits.
const MODE_TOLERANCE: f64 = 1e-11;

/// Splits `a` into a product of two matrices, the second with orthonormal rows, by its singular values above
/// [`MODE_TOLERANCE`]: (U Σ, V).
pub(super) fn compress(a: &Mat<f64>) -> Option<(Mat<f64>, Mat<f64>)> {
    let svd = a.thin_svd().ok()?;
    let (u, v, s) = (svd.U(), svd.V(), svd.S().column_vector());
    let rank = (0..s.nrows())
        .take_while(|&i| s[i] > MODE_TOLERANCE * s[0])
        .count();
    let scaled = Mat::from_fn(u.nrows(), rank, |i, j| u[(i, j)] * s[j]);
    Some((scaled, v.subcols(0, rank).to_owned()))
}
