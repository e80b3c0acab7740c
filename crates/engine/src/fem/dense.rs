//! Dense symmetric factorizations, sequential on purpose: threads work on different bodies and positions instead.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve;
use faer::traits::ComplexField;
use faer::traits::math_utils::{conj, neg, one};
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::run::{Run, Stopped};

/// Columns that a watched factorization does between two looks at its run: a few hundredths of a second for the largest
/// gears.
const PANEL: usize = 256;

/// The lower Cholesky factor of a Hermitian positive definite matrix, of which the lower triangle is read.
#[derive(Debug)]
pub(crate) struct Cholesky<T: ComplexField>(Mat<T>);

impl<T: ComplexField> Cholesky<T> {
    /// Factorizes `a`; `None` if it is not positive definite.
    pub(crate) fn new(mut a: Mat<T>) -> Option<Self> {
        let n = a.nrows();
        let mut memory = MemBuffer::new(llt::factor::cholesky_in_place_scratch::<T>(
            n,
            Par::Seq,
            Default::default(),
        ));
        llt::factor::cholesky_in_place(
            a.as_mut(),
            Default::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .ok()?;
        Some(Self(a))
    }

    /// Overwrites `b` with A⁻¹ b.
    pub(crate) fn solve_in_place(&self, b: MatMut<'_, T>) {
        let columns = b.ncols();
        let mut memory = MemBuffer::new(llt::solve::solve_in_place_scratch::<T>(
            self.0.nrows(),
            columns,
            Par::Seq,
        ));
        llt::solve::solve_in_place(self.0.as_ref(), b, Par::Seq, MemStack::new(&mut memory));
    }

    /// Overwrites `b` with L⁻¹ b, so that bᴴ A⁻¹ b becomes a plain product.
    pub(crate) fn half_solve_in_place(&self, b: MatMut<'_, T>) {
        triangular_solve::solve_lower_triangular_in_place(self.0.as_ref(), b, Par::Seq);
    }

    /// Overwrites `b`, the rows from `first` on of a matrix that is zero above, with those of L⁻¹ times that matrix.
    pub(crate) fn half_solve_from(&self, first: usize, b: MatMut<'_, T>) {
        let rest = self.0.nrows() - first;
        let factor = self.0.submatrix(first, first, rest, rest);
        triangular_solve::solve_lower_triangular_in_place(factor, b, Par::Seq);
    }

    /// Overwrites `b` with L⁻ᴴ b.
    pub(crate) fn other_half_solve_in_place(&self, b: MatMut<'_, T>) {
        triangular_solve::solve_upper_triangular_in_place(self.0.adjoint(), b, Par::Seq);
    }
}

impl Cholesky<f64> {
    /// L, with zeros above the diagonal.
    pub(crate) fn lower(&self) -> Mat<f64> {
        let size = self.0.nrows();
        let mut lower = Mat::zeros(size, size);
        for j in 0..size {
            let own = &self.0.col_as_slice(j)[j..];
            lower.col_as_slice_mut(j)[j..].copy_from_slice(own);
        }
        lower
    }

    /// As [`Cholesky::new`], for matrices that take long: asks `run` after each panel of columns.
    ///
    /// # Errors
    ///
    /// [`Stopped`].
    pub(crate) fn new_watched(mut a: Mat<f64>, run: &Run) -> Result<Option<Self>, Stopped> {
        let n = a.nrows();
        for start in (0..n).step_by(PANEL) {
            run.check()?;
            let width = PANEL.min(n - start);
            let rest = n - start - width;
            let diagonal = a.submatrix(start, start, width, width).to_owned();
            let Some(factor) = Self::new(diagonal) else {
                return Ok(None);
            };
            a.submatrix_mut(start, start, width, width)
                .copy_from(&factor.0);
            // L_21 = A_21 L_11^-T, and the rest loses L_21 L_21^T.
            let mut below = a
                .submatrix(start + width, start, rest, width)
                .transpose()
                .to_owned();
            factor.half_solve_in_place(below.as_mut());
            a.submatrix_mut(start + width, start, rest, width)
                .copy_from(below.transpose());
            triangular::matmul(
                a.submatrix_mut(start + width, start + width, rest, rest),
                BlockStructure::TriangularLower,
                Accum::Add,
                below.transpose(),
                BlockStructure::Rectangular,
                &below,
                BlockStructure::Rectangular,
                -1.0,
                Par::Seq,
            );
        }
        Ok(Some(Self(a)))
    }
}

/// The number of entries of `a`, for the size limit of the cache.
pub(crate) fn entries(a: &Mat<f64>) -> usize {
    a.nrows() * a.ncols()
}

/// Replaces the upper triangle of `a` by the adjoint of its lower one.
pub(crate) fn mirror_lower<T: ComplexField>(a: &mut Mat<T>) {
    for j in 0..a.ncols() {
        for i in 0..j {
            a[(i, j)] = conj(&a[(j, i)]);
        }
    }
}

/// `half`ᴴ `half`, Hermitian.
pub(crate) fn product<T: ComplexField>(half: MatRef<'_, T>) -> Mat<T> {
    let mut product = Mat::zeros(half.ncols(), half.ncols());
    add_product(&mut product, half, one());
    product
}

/// Subtracts `half`ᴴ `half` from the lower triangle of a Hermitian matrix, and makes its upper one the adjoint of that.
pub(crate) fn subtract_product<T: ComplexField>(from: &mut Mat<T>, half: MatRef<'_, T>) {
    add_product(from, half, neg(&one::<T>()));
}

fn add_product<T: ComplexField>(sum: &mut Mat<T>, half: MatRef<'_, T>, share: T) {
    triangular::matmul(
        sum.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Add,
        half.adjoint(),
        BlockStructure::Rectangular,
        half,
        BlockStructure::Rectangular,
        share,
        Par::Seq,
    );
    mirror_lower(sum);
}

/// Replaces both triangles of `a` by their mean.
pub(crate) fn symmetrize(a: &mut Mat<f64>) {
    for j in 0..a.ncols() {
        for i in 0..j {
            let mean = f64::midpoint(a[(i, j)], a[(j, i)]);
            a[(i, j)] = mean;
            a[(j, i)] = mean;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_give_the_factor_of_the_whole() {
        let n = 2 * PANEL + 37;
        let a = Mat::from_fn(n, n, |i, j| {
            if i == j {
                3.0
            } else {
                1.0 / (1.0 + i.abs_diff(j) as f64).powi(2)
            }
        });
        let whole = Cholesky::new(a.clone()).expect("diagonally dominant");
        let panels = Cholesky::new_watched(a.clone(), &Run::unattended())
            .expect("nobody stops it")
            .expect("definite");
        let b = Mat::from_fn(n, 2, |i, j| (i as f64 + j as f64).sin());
        let (mut x, mut y) = (b.clone(), b.clone());
        whole.solve_in_place(x.as_mut());
        panels.solve_in_place(y.as_mut());
        assert!((&x - &y).norm_max() < 1e-13 * x.norm_max());
        assert!((&a * &y - &b).norm_max() < 1e-12);
    }

    #[test]
    fn an_indefinite_matrix_is_found_in_any_panel() {
        let n = PANEL + 5;
        let a = Mat::from_fn(n, n, |i, j| {
            if i != j {
                0.0
            } else if i == n - 1 {
                -1.0
            } else {
                1.0
            }
        });
        assert!(
            Cholesky::new_watched(a, &Run::unattended())
                .expect("nobody stops it")
                .is_none()
        );
    }
}
