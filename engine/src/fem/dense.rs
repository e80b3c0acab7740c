//! Dense symmetric factorizations, sequential on purpose: threads work on different bodies and positions instead.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::triangular_solve;
use faer::traits::ComplexField;
use faer::{Mat, MatMut, Par};

/// The lower Cholesky factor of a Hermitian positive definite matrix, of which the lower triangle is read.
pub struct Cholesky<T: ComplexField>(Mat<T>);

impl<T: ComplexField> Cholesky<T> {
    /// Factorizes `a`; `None` if it is not positive definite.
    pub fn new(mut a: Mat<T>) -> Option<Self> {
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
    pub fn solve_in_place(&self, b: MatMut<'_, T>) {
        let columns = b.ncols();
        let mut memory = MemBuffer::new(llt::solve::solve_in_place_scratch::<T>(
            self.0.nrows(),
            columns,
            Par::Seq,
        ));
        llt::solve::solve_in_place(self.0.as_ref(), b, Par::Seq, MemStack::new(&mut memory));
    }

    /// Overwrites `b` with L⁻¹ b, so that bᴴ A⁻¹ b becomes a plain product.
    pub fn half_solve_in_place(&self, b: MatMut<'_, T>) {
        triangular_solve::solve_lower_triangular_in_place(self.0.as_ref(), b, Par::Seq);
    }

    /// Overwrites `b` with L⁻ᴴ b.
    pub fn other_half_solve_in_place(&self, b: MatMut<'_, T>) {
        triangular_solve::solve_upper_triangular_in_place(self.0.adjoint(), b, Par::Seq);
    }
}
