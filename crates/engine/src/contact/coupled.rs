//! Common compliance of the teeth of a gear, on anything that touches: cells in the plane, slices along faces.
//!
//! The flank of tooth i follows the common motion of its gear by the rows of S_i: under forces on tooth j it moves by S_i X_ij S_jᵀ of them.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use super::mesh_contact::PairLoads;

/// The touching part of one pair.
pub(super) struct LoadedPair<'a> {
    /// The pair n.
    pub(super) pair: i64,
    /// The row of H at which it begins.
    pub(super) start: usize,
    /// S, a row for each cell or slice.
    pub(super) shapes: MatRef<'a, f64>,
}

/// Adds S_i X_ij S_jᵀ to the blocks of `h` on the diagonal and below it. `coupling` is X_ij between two pairs.
pub(super) fn add_coupled<'x>(
    h: &mut Mat<f64>,
    pairs: &[LoadedPair<'_>],
    coupling: impl Fn(i64, i64) -> MatRef<'x, f64>,
) {
    for (j, loaded) in pairs.iter().enumerate() {
        let of_loaded = loaded.shapes.transpose();
        for moved in &pairs[j..] {
            let interface = coupling(moved.pair, loaded.pair) * of_loaded;
            let (rows, columns) = (moved.shapes.nrows(), of_loaded.ncols());
            matmul(
                h.as_mut()
                    .submatrix_mut(moved.start, loaded.start, rows, columns),
                Accum::Add,
                moved.shapes,
                interface,
                1.0,
                Par::Seq,
            );
        }
    }
}

/// Copies the part of `h` above the diagonal to the part below it.
pub(super) fn mirror(h: &mut Mat<f64>) {
    for column in 1..h.ncols() {
        for row in 0..column {
            h[(row, column)] = h[(column, row)];
        }
    }
}

/// Adds qᵀ X p and qᵀ X q to `sums`, where p and q are the two columns of `loads` on the gear of index `gear`.
pub(crate) fn add_yielded<'x>(
    sums: &mut [f64; 2],
    gear: usize,
    loads: &[PairLoads],
    coupling: impl Fn(i64, i64) -> MatRef<'x, f64>,
) {
    for a in loads {
        let q = a.loads[gear].col(1).transpose();
        for b in loads {
            let moved = coupling(a.pair, b.pair) * &b.loads[gear];
            sums[0] += q * moved.col(0);
            sums[1] += q * moved.col(1);
        }
    }
}
