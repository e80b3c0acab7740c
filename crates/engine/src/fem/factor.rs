//! The sparse Cholesky factor of a grid's stiffness.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::Perm;
use faer::sparse::SparseColMat;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, supernodal::SupernodalLltRef,
};
use faer::{Conj, Mat, Par, Side};

use super::FemError;
use super::element::COMPONENTS;
use super::recovery::Functional;
use super::sparse::{BlockMatrix, Failure, Numbering};
use crate::grid::Element;

/// The supernodal Cholesky factor of a sparse matrix, the unknowns from `interior` on last.
pub(super) struct Factor {
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
    order: Perm<u32>,
    interior: usize,
}

/// Functionals multiplied by L⁻¹, a column each.
pub(super) struct Halved {
    /// The part on the unknowns that are eliminated.
    pub(super) inside: Mat<f64>,
    /// The part on those that are kept.
    pub(super) on_kept: Mat<f64>,
}

/// Size of a factorization before it is done, counted in blocks of the unknowns of a node.
#[derive(Debug, Clone, Copy)]
pub(super) struct FactorSize {
    /// Blocks of the matrix.
    pub(super) matrix: f64,
    /// Blocks of the factor.
    pub(super) factor: f64,
    /// Bytes that are needed beside both, of one unknown a node.
    pub(super) scratch: f64,
    /// Multiplications and additions, of one unknown a node.
    pub(super) operations: f64,
}

impl FactorSize {
    /// Factor of the matrix of `elements`; `None` if it cannot be ordered.
    pub(super) fn of(elements: &[Element], numbering: &Numbering) -> Option<Self> {
        let matrix = BlockMatrix::new(1, elements, numbering);
        let order = matrix.fill_reducing_order(numbering.interior).ok()?;
        let matrix = matrix.into_unknowns(numbering);
        let symbolic = symbolic(&matrix, &order).ok()?;
        let SymbolicCholeskyRaw::Supernodal(supernodes) = symbolic.raw() else {
            return None;
        };
        let starts = supernodes.supernode_begin().iter();
        let widths = starts.zip(supernodes.supernode_end());
        let each = widths.enumerate().map(|(number, (start, end))| {
            let below = supernodes.supernode(number).pattern().len() as f64;
            let width = f64::from(end - start);
            width * (0.5 * below * (below + width) + width * width / 6.0)
        });
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        Some(Self {
            matrix: matrix.compute_nnz() as f64,
            factor: symbolic.len_val() as f64,
            scratch: scratch.unaligned_bytes_required() as f64,
            operations: each.sum(),
        })
    }
}

/// The structure of the factor of the symmetric matrix whose lower triangle is `a`.
fn symbolic(
    a: &SparseColMat<u32, f64>,
    order: &Perm<u32>,
) -> Result<SymbolicCholesky<u32>, Failure> {
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        ..Default::default()
    };
    factorize_symbolic_cholesky(
        a.symbolic(),
        Side::Lower,
        SymmetricOrdering::Custom(order.as_ref()),
        params,
    )
    .map_err(|_| Failure::Size)
}

impl Factor {
    /// Factorizes `matrix`, that of `part`, in an order of few entries which leaves the kept nodes of `numbering` last.
    pub(super) fn new(
        part: &'static str,
        matrix: BlockMatrix,
        numbering: &Numbering,
    ) -> Result<Self, FemError> {
        let size = matrix.size();
        let unknowns = size * numbering.count;
        let order = matrix.fill_reducing_order(numbering.interior);
        order
            .and_then(|order| {
                Self::in_order(
                    &matrix.into_unknowns(numbering),
                    order,
                    size * numbering.interior,
                )
            })
            .map_err(|failure| match failure {
                Failure::Size => FemError::TooLarge { part, unknowns },
                Failure::Indefinite => FemError::NotPositiveDefinite { part, unknowns },
            })
    }

    /// Factorizes the symmetric matrix whose lower triangle is `a`; `order` leaves the unknowns from `interior` on in their
    /// places.
    fn in_order(
        a: &SparseColMat<u32, f64>,
        order: Perm<u32>,
        interior: usize,
    ) -> Result<Self, Failure> {
        let symbolic = symbolic(a, &order)?;
        let mut values = vec![0.0; symbolic.len_val()];
        let mut memory = MemBuffer::new(
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()),
        );
        symbolic
            .factorize_numeric_llt(
                &mut values,
                a.as_ref(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| Failure::Indefinite)?;
        // Always, by the parameters above.
        if !matches!(symbolic.raw(), SymbolicCholeskyRaw::Supernodal(_)) {
            return Err(Failure::Size);
        }
        Ok(Self {
            symbolic,
            values,
            order,
            interior,
        })
    }

    fn supernodal(&self) -> SupernodalLltRef<'_, u32, f64> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(supernodes) => {
                SupernodalLltRef::new(supernodes, &self.values)
            }
            SymbolicCholeskyRaw::Simplicial(_) => unreachable!("refused when it was made"),
        }
    }

    /// L₂₂: the part of the factor on the kept unknowns.
    pub(super) fn trailing(&self) -> Mat<f64> {
        let (factor, interior) = (self.supernodal(), self.interior);
        let kept = self.symbolic.nrows() - interior;
        let mut l_22 = Mat::<f64>::zeros(kept, kept);
        for index in (0..factor.symbolic().n_supernodes()).rev() {
            let supernode = factor.supernode(index);
            let (block, start) = (supernode.val(), supernode.start());
            let width = block.ncols();
            if start + width <= interior {
                break;
            }
            for c in 0..width {
                let Some(col) = (start + c).checked_sub(interior) else {
                    continue;
                };
                for r in c..width {
                    l_22[(start + r - interior, col)] = block[(r, c)];
                }
                for (r, &row) in supernode.pattern().iter().enumerate() {
                    l_22[(row as usize - interior, col)] = block[(width + r, c)];
                }
            }
        }
        l_22
    }

    /// L⁻¹ b for each functional b, a column each. L₂₂ times the part on the kept unknowns is b₂ − L₂₁ L₁₁⁻¹ b₁.
    pub(super) fn halved(&self, asked: &[Functional], numbering: &Numbering) -> Halved {
        let place = self.places();
        let mut solved = Mat::<f64>::zeros(self.symbolic.nrows(), asked.len());
        for (column, functional) in asked.iter().enumerate() {
            for &(node, weight) in functional.terms() {
                // Fixed nodes do not move.
                let Some(node) = numbering.place(node) else {
                    continue;
                };
                solved[(place[COMPONENTS * node] as usize, column)] += weight.x;
                solved[(place[COMPONENTS * node + 1] as usize, column)] += weight.y;
            }
        }
        if !asked.is_empty() {
            self.half_solve_in_place(&mut solved);
        }
        let kept = solved.nrows() - self.interior;
        Halved {
            inside: solved.subrows(0, self.interior).to_owned(),
            on_kept: solved.subrows(self.interior, kept).to_owned(),
        }
    }

    /// Where each unknown stands in the order of the factor.
    pub(super) fn places(&self) -> &[u32] {
        self.order.as_ref().arrays().1
    }

    /// Overwrites `columns`, which stand in the order of the factor, with L⁻¹ times them.
    pub(super) fn half_solve_in_place(&self, columns: &mut Mat<f64>) {
        let scratch = self
            .symbolic
            .solve_in_place_scratch::<f64>(columns.ncols(), Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        self.supernodal().l_solve_with_conj(
            Conj::No,
            columns.as_mut(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }

    /// The solutions of the whole system, in place of the right-hand sides `columns` on the numbered unknowns.
    pub(super) fn solve_in_place(&self, columns: &mut Mat<f64>) {
        let (factor, (numbers, _)) = (self.supernodal(), self.order.as_ref().arrays());
        let mut ordered = Mat::from_fn(columns.nrows(), columns.ncols(), |i, j| {
            columns[(numbers[i] as usize, j)]
        });
        let scratch = self
            .symbolic
            .solve_in_place_scratch::<f64>(columns.ncols(), Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        factor.solve_in_place_with_conj(
            Conj::No,
            ordered.as_mut(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        for (i, &number) in numbers.iter().enumerate() {
            for j in 0..columns.ncols() {
                columns[(number as usize, j)] = ordered[(i, j)];
            }
        }
    }
}
