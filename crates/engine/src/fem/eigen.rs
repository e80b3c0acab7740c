//! The lowest eigenvalues of K x = λ M x with sparse Hermitian matrices: Lanczos's method on a factor that is kept.
//!
//! With the shift s > 0 and A = K + s M, which is positive definite even where K lets a rigid motion be, the operator A⁻¹ M has the
//! eigenvalues θ = 1/(λ + s), the lowest λ first. Each step solves with the one factor of A. All vectors are kept M-orthonormal to each
//! other, so that no eigenvalue comes twice; two vectors a step find those that are double. A pair (θ, x) is done when its residual
//! ‖A⁻¹ M x − θ x‖_M falls below a part of θ, which bounds the error of θ by the same part.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::linalg::matmul::matmul;
use faer::sparse::SparseColMat;
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::{Accum, Conj, Mat, Par, Side, c64};

use super::FemError;
use crate::run::Run;

/// Vectors a step.
const BLOCK: usize = 2;
/// The largest residual of a pair that is done, as a part of its θ.
const RESIDUAL: f64 = 1e-7;
/// Steps between two looks at the pairs that are done.
const STEPS_BETWEEN: usize = 4;
/// The part of its length that a vector must keep when those before it are taken off; less is rounding, and the space is exhausted.
const INDEPENDENT: f64 = 1e-9;

/// One entry of a sparse Hermitian pair (K, M), in the lower triangle; entries of the same place add up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    /// The column.
    pub column: u32,
    /// The row, not above the diagonal.
    pub row: u32,
    /// Its entry in K.
    pub stiffness: c64,
    /// Its entry in M.
    pub mass: c64,
}

/// A sparse Hermitian pair (K, M), lower triangles of one pattern, column by column.
#[derive(Debug, Clone)]
pub(crate) struct Pencil {
    count: usize,
    starts: Vec<u32>,
    rows: Vec<u32>,
    stiffness: Vec<c64>,
    mass: Vec<c64>,
}

/// One pair that was found.
#[derive(Debug, Clone)]
pub(crate) struct EigenPair {
    /// λ.
    pub value: f64,
    /// x, with xᴴ M x = 1.
    pub vector: Mat<c64>,
    /// ‖A⁻¹ M x − θ x‖_M / θ.
    pub residual: f64,
}

impl Pencil {
    /// The pair of `count` unknowns with these entries.
    pub(crate) fn new(count: usize, entries: &[Entry]) -> Self {
        let mut ends = vec![0_usize; count + 1];
        for entry in entries {
            ends[entry.column as usize + 1] += 1;
        }
        for column in 0..count {
            ends[column + 1] += ends[column];
        }
        let mut next = ends.clone();
        let mut sorted = vec![0_u32; entries.len()];
        for (index, entry) in entries.iter().enumerate() {
            let place = &mut next[entry.column as usize];
            sorted[*place] = index as u32;
            *place += 1;
        }
        let zero = c64::new(0.0, 0.0);
        let mut pencil = Self {
            count,
            starts: vec![0],
            rows: Vec::new(),
            stiffness: Vec::new(),
            mass: Vec::new(),
        };
        let mut place_of_row = vec![usize::MAX; count];
        for column in 0..count {
            let own = &sorted[ends[column]..ends[column + 1]];
            let first = pencil.rows.len();
            for &index in own {
                let row = entries[index as usize].row;
                if place_of_row[row as usize] == usize::MAX {
                    place_of_row[row as usize] = 0;
                    pencil.rows.push(row);
                }
            }
            pencil.rows[first..].sort_unstable();
            for (place, row) in pencil.rows.iter().enumerate().skip(first) {
                place_of_row[*row as usize] = place;
            }
            pencil.stiffness.resize(pencil.rows.len(), zero);
            pencil.mass.resize(pencil.rows.len(), zero);
            for &index in own {
                let entry = &entries[index as usize];
                let place = place_of_row[entry.row as usize];
                pencil.stiffness[place] += entry.stiffness;
                pencil.mass[place] += entry.mass;
            }
            for row in &pencil.rows[first..] {
                place_of_row[*row as usize] = usize::MAX;
            }
            pencil.starts.push(pencil.rows.len() as u32);
        }
        pencil
    }

    /// The number of unknowns.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// M x, or K x.
    fn times(&self, values: &[c64], x: &Mat<c64>) -> Mat<c64> {
        let mut product = Mat::<c64>::zeros(self.count, x.ncols());
        for c in 0..x.ncols() {
            let (x, y) = (x.col_as_slice(c), product.col_as_slice_mut(c));
            for column in 0..self.count {
                let range = self.starts[column] as usize..self.starts[column + 1] as usize;
                for (row, value) in self.rows[range.clone()].iter().zip(&values[range]) {
                    let row = *row as usize;
                    y[row] += value * x[column];
                    if row != column {
                        y[column] += value.conj() * x[row];
                    }
                }
            }
        }
        product
    }

    /// M x.
    pub(crate) fn mass_times(&self, x: &Mat<c64>) -> Mat<c64> {
        self.times(&self.mass, x)
    }

    /// K x.
    pub(crate) fn stiffness_times(&self, x: &Mat<c64>) -> Mat<c64> {
        self.times(&self.stiffness, x)
    }

    /// The factor of K + `shift` M.
    ///
    /// # Errors
    ///
    /// [`FemError`] if that is not positive definite, or too large.
    pub(crate) fn factor(&self, part: &'static str, shift: f64) -> Result<PencilFactor, FemError> {
        let unknowns = self.count;
        let values = self.stiffness.iter().zip(&self.mass);
        let values: Vec<c64> = values.map(|(k, m)| k + m * shift).collect();
        let pattern = faer::sparse::SymbolicSparseColMat::<u32>::new_checked(
            unknowns,
            unknowns,
            self.starts.clone(),
            None,
            self.rows.clone(),
        );
        let a = SparseColMat::<u32, c64>::new(pattern, values);
        let symbolic = factorize_symbolic_cholesky(
            a.symbolic(),
            Side::Lower,
            SymmetricOrdering::Amd,
            Default::default(),
        )
        .map_err(|_| FemError::TooLarge { part, unknowns })?;
        let mut values = vec![c64::new(0.0, 0.0); symbolic.len_val()];
        let mut memory = MemBuffer::new(
            symbolic.factorize_numeric_llt_scratch::<c64>(Par::Seq, Default::default()),
        );
        symbolic
            .factorize_numeric_llt(
                &mut values,
                a.as_ref(),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| FemError::NotPositiveDefinite { part, unknowns })?;
        Ok(PencilFactor { symbolic, values })
    }
}

/// The Cholesky factor of K + s M.
#[derive(Debug)]
pub(crate) struct PencilFactor {
    symbolic: SymbolicCholesky<u32>,
    values: Vec<c64>,
}

impl PencilFactor {
    /// Overwrites `b` with (K + s M)⁻¹ b.
    pub(crate) fn solve_in_place(&self, b: &mut Mat<c64>) {
        let columns = b.ncols();
        let mut memory = MemBuffer::new(
            self.symbolic
                .solve_in_place_scratch::<c64>(columns, Par::Seq),
        );
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            b.as_mut(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }
}

/// Lanczos's method on one pair of matrices, which goes on from where it stopped.
#[derive(Debug)]
pub(crate) struct Lanczos {
    pencil: Pencil,
    factor: PencilFactor,
    shift: f64,
    /// The M-orthonormal vectors, M times these, and A⁻¹ M times these.
    basis: Vec<Mat<c64>>,
    weighted: Vec<Mat<c64>>,
    answers: Vec<Mat<c64>>,
    next: Mat<c64>,
    random: Random,
    is_exhausted: bool,
    found: Vec<EigenPair>,
}

impl Lanczos {
    /// The method for `pencil` with the shift s > 0, before its first step.
    ///
    /// # Errors
    ///
    /// As [`Pencil::factor`].
    pub(crate) fn new(part: &'static str, pencil: Pencil, shift: f64) -> Result<Self, FemError> {
        let factor = pencil.factor(part, shift)?;
        let mut random = Random(0x9e37_79b9_7f4a_7c15);
        let mut next = pencil.mass_times(&random.columns(pencil.len(), BLOCK));
        factor.solve_in_place(&mut next);
        Ok(Self {
            pencil,
            factor,
            shift,
            basis: Vec::new(),
            weighted: Vec::new(),
            answers: Vec::new(),
            next,
            random,
            is_exhausted: false,
            found: Vec::new(),
        })
    }

    /// The matrices.
    pub(crate) fn pencil(&self) -> &Pencil {
        &self.pencil
    }

    /// The pairs found so far, the lowest first: none below the last of them is missing.
    pub(crate) fn found(&self) -> &[EigenPair] {
        &self.found
    }

    /// True if there are no more than those found.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    /// Steps on until `wanted` pairs are found, or all that there are.
    ///
    /// # Errors
    ///
    /// [`FemError::Stopped`].
    pub(crate) fn find(&mut self, wanted: usize, run: &Run) -> Result<(), FemError> {
        while self.found.len() < wanted && !self.is_exhausted {
            for _ in 0..STEPS_BETWEEN {
                run.check()?;
                self.step();
            }
            self.look(wanted);
        }
        Ok(())
    }

    /// One step: the next vectors join the basis, and the operator makes those after them. A vector that depends on those before it is
    /// followed by one drawn at random.
    fn step(&mut self) {
        for c in 0..BLOCK {
            let mut vector = self.next.subcols(c, 1).to_owned();
            let before = self.norm(&vector);
            // A second pass removes the parts that rounding brings back.
            for _ in 0..2 {
                for (q, m_q) in self.basis.iter().zip(&self.weighted) {
                    let share = -inner(m_q, &vector);
                    axpy(share, q, &mut vector);
                }
            }
            let length = self.norm(&vector);
            let is_new = length > INDEPENDENT * before && self.basis.len() < self.pencil.len();
            if !is_new {
                let drawn = self.random.columns(self.pencil.len(), 1);
                self.next.subcols_mut(c, 1).copy_from(&drawn);
                continue;
            }
            vector *= faer::Scale(c64::new(1.0 / length, 0.0));
            let weighted = self.pencil.mass_times(&vector);
            let mut answer = weighted.clone();
            self.factor.solve_in_place(&mut answer);
            self.next.subcols_mut(c, 1).copy_from(&answer);
            self.basis.push(vector);
            self.weighted.push(weighted);
            self.answers.push(answer);
        }
    }

    /// The M-norm of a column.
    fn norm(&self, x: &Mat<c64>) -> f64 {
        inner(&self.pencil.mass_times(x), x).re.max(0.0).sqrt()
    }

    /// The pairs of the space so far: those that are done, up to the first that is not.
    fn look(&mut self, wanted: usize) {
        let size = self.basis.len();
        let projected = Mat::from_fn(size, size, |i, j| {
            let (i, j) = (i.max(j), i.min(j));
            inner(&self.weighted[i], &self.answers[j])
        });
        let projected = Mat::from_fn(size, size, |i, j| match i >= j {
            true => projected[(i, j)],
            false => projected[(i, j)].conj(),
        });
        self.is_exhausted = size >= self.pencil.len();
        let Ok(eigen) = projected.self_adjoint_eigen(Side::Lower) else {
            return;
        };
        let (values, vectors) = (eigen.S().column_vector(), eigen.U());
        let combined = |columns: &[Mat<c64>], of: usize| {
            let mut sum = Mat::<c64>::zeros(self.pencil.len(), 1);
            for (k, column) in columns.iter().enumerate() {
                axpy(vectors[(k, of)], column, &mut sum);
            }
            sum
        };
        let mut found = Vec::new();
        for of in (0..size).rev().take(wanted) {
            let theta = values[of].re;
            let vector = combined(&self.basis, of);
            let mut residual = combined(&self.answers, of);
            axpy(c64::new(-theta, 0.0), &vector, &mut residual);
            let residual = self.norm(&residual) / theta;
            let is_done = residual < RESIDUAL || self.is_exhausted;
            if !is_done {
                break;
            }
            found.push(EigenPair {
                value: 1.0 / theta - self.shift,
                vector,
                residual,
            });
        }
        self.found = found;
    }
}

/// Numbers without a pattern, the same in every run: Marsaglia's xorshift.
#[derive(Debug)]
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        let state = &mut self.0;
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    fn columns(&mut self, rows: usize, columns: usize) -> Mat<c64> {
        Mat::from_fn(rows, columns, |_, _| c64::new(self.number(), self.number()))
    }
}

/// xᴴ y of two columns.
pub(crate) fn inner(x: &Mat<c64>, y: &Mat<c64>) -> c64 {
    let mut product = Mat::<c64>::zeros(1, 1);
    matmul(
        product.as_mut(),
        Accum::Replace,
        x.adjoint(),
        y,
        c64::new(1.0, 0.0),
        Par::Seq,
    );
    product[(0, 0)]
}

/// Adds `share` of `x` to `y`.
fn axpy(share: c64, x: &Mat<c64>, y: &mut Mat<c64>) {
    for (y, x) in y.col_as_slice_mut(0).iter_mut().zip(x.col_as_slice(0)) {
        *y += share * x;
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// A closed chain of equal masses on equal springs: λ = 4 sin²(π j/n), all but the first and the last double.
    fn chain(n: u32) -> Pencil {
        let entry = |row: u32, column: u32, stiffness: f64, mass: f64| Entry {
            column: column.min(row),
            row: column.max(row),
            stiffness: c64::new(stiffness, 0.0),
            mass: c64::new(mass, 0.0),
        };
        let of_mass = |i: u32| [entry(i, i, 2.0, 1.0), entry(i, (i + 1) % n, -1.0, 0.0)];
        let entries: Vec<Entry> = (0..n).flat_map(of_mass).collect();
        Pencil::new(n as usize, &entries)
    }

    #[test]
    fn a_closed_chain_has_its_rigid_motion_and_every_double_value_twice() {
        let n = 60;
        let mut lanczos = Lanczos::new("a chain", chain(n), 1e-3).expect("definite");
        lanczos
            .find(9, &Run::unattended())
            .expect("nobody stops it");
        let found = lanczos.found();
        assert!(found.len() >= 9);
        for (i, pair) in found.iter().enumerate() {
            let j = f64::from(i.div_ceil(2) as u32);
            let expected = 4.0 * (PI * j / f64::from(n)).sin().powi(2);
            assert!((pair.value - expected).abs() < 1e-10, "{i}: {}", pair.value);
            let k = lanczos.pencil().stiffness_times(&pair.vector);
            let quotient = inner(&pair.vector, &k).re;
            assert!((quotient - expected).abs() < 1e-10);
        }
    }

    #[test]
    fn a_small_pair_is_found_whole() {
        let mut lanczos = Lanczos::new("a chain", chain(5), 1e-3).expect("definite");
        lanczos
            .find(9, &Run::unattended())
            .expect("nobody stops it");
        assert!(lanczos.is_exhausted());
        assert_eq!(lanczos.found().len(), 5);
    }
}
