//! Static condensation: the exact stiffness of a grid on the unknowns that are kept.
//!
//! The kept unknowns are ordered last, so that the trailing block L₂₂ of the sparse Cholesky factor gives the Schur
//! complement S = L₂₂ L₂₂ᵀ without a single right-hand side.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::perm::Perm;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
    supernodal::SupernodalLltRef,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Accum, Mat, Par, Side};

use super::FemError;
use super::element::{self, ElementStiffness};
use crate::gear::{Material, Vector};
use crate::grid::Grid;

/// The stiffness of every element of `grid`, of one material and thickness.
pub fn element_stiffnesses(
    grid: &Grid,
    material: &Material,
    thickness: f64,
) -> Vec<ElementStiffness> {
    grid.elements
        .iter()
        .map(|element| {
            let nodes: [Vector; 8] = element.map(|node| grid.nodes[node as usize]);
            element::stiffness(&nodes, material, thickness)
        })
        .collect()
}

/// Condenses `grid` to the unknowns of the nodes in `kept`, with the nodes in `fixed` held.
///
/// The result has the unknowns (u_x, u_y) of each kept node in the order given, in N/m. A grid that floats, with nothing
/// fixed, is condensed as well: its stiffness is singular by the rigid motions only.
///
/// # Errors
///
/// [`FemError::NotPositiveDefinite`] if the grid is degenerate.
pub fn condense(
    part: &'static str,
    grid: &Grid,
    material: &Material,
    thickness: f64,
    kept: &[u32],
    fixed: &[u32],
) -> Result<Mat<f64>, FemError> {
    let numbering = Numbering::new(grid.nodes.len(), kept, fixed);
    let (n, interior) = (numbering.unknowns(), numbering.interior());
    let mut triplets = Vec::with_capacity(grid.elements.len() * 136 + 2 * kept.len());
    for (element, k) in grid
        .elements
        .iter()
        .zip(element_stiffnesses(grid, material, thickness))
    {
        for (b, &node_b) in element.iter().enumerate() {
            let Some(col) = numbering.first(node_b) else {
                continue;
            };
            for (a, &node_a) in element.iter().enumerate() {
                let Some(row) = numbering.first(node_a) else {
                    continue;
                };
                for (c, d) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let (i, j) = (row + c, col + d);
                    if i >= j {
                        triplets.push(Triplet::new(i as u32, j as u32, k[(2 * a + c, 2 * b + d)]));
                    }
                }
            }
        }
    }
    // Springs on the kept unknowns make a floating grid definite; they add to the Schur complement exactly and are taken
    // off again below.
    let spring = if fixed.is_empty() {
        material.youngs_modulus * thickness
    } else {
        0.0
    };
    if spring > 0.0 {
        triplets.extend((interior..n).map(|i| Triplet::new(i as u32, i as u32, spring)));
    }
    let too_large = FemError::TooLarge { part, unknowns: n };
    let stiffness = SparseColMat::<u32, f64>::try_new_from_triplets(n, n, &triplets)
        .map_err(|_| too_large.clone())?;
    drop(triplets);
    let mut schur = trailing_schur(&stiffness, interior).map_err(|error| match error {
        Failure::Size => too_large,
        Failure::Indefinite => FemError::NotPositiveDefinite { part, unknowns: n },
    })?;
    for i in 0..schur.nrows() {
        schur[(i, i)] -= spring;
    }
    Ok(schur)
}

enum Failure {
    Size,
    Indefinite,
}

/// The Schur complement of the symmetric matrix whose lower triangle is `a` on its unknowns from `interior` on.
fn trailing_schur(a: &SparseColMat<u32, f64>, interior: usize) -> Result<Mat<f64>, Failure> {
    let n = a.nrows();
    let kept = n - interior;
    let order = fill_reducing_order(a, interior).map_err(|()| Failure::Size)?;
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        ..Default::default()
    };
    let symbolic = factorize_symbolic_cholesky(
        a.symbolic(),
        Side::Lower,
        SymmetricOrdering::Custom(order.as_ref()),
        params,
    )
    .map_err(|_| Failure::Size)?;
    let mut values = vec![0.0; symbolic.len_val()];
    let mut memory =
        MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()));
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
    let SymbolicCholeskyRaw::Supernodal(supernodes) = symbolic.raw() else {
        return Err(Failure::Size);
    };
    let factor = SupernodalLltRef::new(supernodes, &values);

    let mut l_22 = Mat::<f64>::zeros(kept, kept);
    for index in (0..supernodes.n_supernodes()).rev() {
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
    let mut schur = Mat::<f64>::zeros(kept, kept);
    triangular::matmul(
        schur.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        &l_22,
        BlockStructure::TriangularLower,
        l_22.transpose(),
        BlockStructure::TriangularUpper,
        1.0,
        Par::Seq,
    );
    mirror_lower(&mut schur);
    Ok(schur)
}

/// Approximate minimum degree on the interior unknowns; the kept ones stay last, in their order.
fn fill_reducing_order(a: &SparseColMat<u32, f64>, interior: usize) -> Result<Perm<u32>, ()> {
    let n = a.nrows();
    let mut pattern = Vec::new();
    for j in 0..interior {
        for &i in a.symbolic().row_idx_of_col_raw(j) {
            if (i as usize) < interior {
                pattern.push(Triplet::new(i, j as u32, ()));
            }
        }
    }
    let pattern = pattern
        .into_iter()
        .map(|t| Triplet::new(t.row, t.col, 1.0_f64))
        .collect::<Vec<_>>();
    let pattern = SparseColMat::<u32, f64>::try_new_from_triplets(interior, interior, &pattern)
        .map_err(|_| ())?;
    let (mut forward, mut inverse) = (vec![0_u32; interior], vec![0_u32; interior]);
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<u32>(
        interior,
        pattern.compute_nnz(),
    ));
    amd::order_maybe_unsorted(
        &mut forward,
        &mut inverse,
        pattern.symbolic(),
        Default::default(),
        MemStack::new(&mut memory),
    )
    .map_err(|_| ())?;
    forward.extend(interior as u32..n as u32);
    inverse.extend(interior as u32..n as u32);
    Ok(Perm::new_checked(
        forward.into_boxed_slice(),
        inverse.into_boxed_slice(),
        n,
    ))
}

/// Copies the lower triangle of `a` to its upper one.
pub fn mirror_lower(a: &mut Mat<f64>) {
    for j in 0..a.ncols() {
        for i in 0..j {
            a[(i, j)] = a[(j, i)];
        }
    }
}

/// Where the unknowns of each node stand: interior ones first, kept ones last, fixed ones nowhere.
struct Numbering {
    first: Vec<u32>,
    interior: usize,
    unknowns: usize,
}

impl Numbering {
    const FIXED: u32 = u32::MAX;

    fn new(nodes: usize, kept: &[u32], fixed: &[u32]) -> Self {
        let mut first = vec![0; nodes];
        for &node in kept.iter().chain(fixed) {
            first[node as usize] = Self::FIXED;
        }
        let mut next = 0;
        for place in first.iter_mut().filter(|place| **place != Self::FIXED) {
            *place = next;
            next += 2;
        }
        let interior = next as usize;
        for &node in kept {
            first[node as usize] = next;
            next += 2;
        }
        Self {
            first,
            interior,
            unknowns: next as usize,
        }
    }

    fn first(&self, node: u32) -> Option<usize> {
        let place = self.first[node as usize];
        (place != Self::FIXED).then_some(place as usize)
    }

    fn interior(&self) -> usize {
        self.interior
    }

    fn unknowns(&self) -> usize {
        self.unknowns
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    const STEEL: Material = Material {
        youngs_modulus: 210e9,
        poisson_ratio: 0.3,
        density: 7850.0,
    };

    /// Four distorted elements around one corner: nodes on the lattice of corners and midsides.
    fn patch() -> Grid {
        let mut number = [[u32::MAX; 5]; 5];
        let mut nodes = Vec::new();
        for (j, row) in number.iter_mut().enumerate() {
            for (i, place) in row.iter_mut().enumerate() {
                if i % 2 == 1 && j % 2 == 1 {
                    continue;
                }
                *place = nodes.len() as u32;
                let (x, y) = (i as f64, j as f64);
                nodes.push(1e-3 * Vector::new(x + 0.1 * y * y + 0.05 * x * y, 0.9 * y - 0.1 * x));
            }
        }
        let element = |i: usize, j: usize| {
            [
                (0, 0),
                (2, 0),
                (2, 2),
                (0, 2),
                (1, 0),
                (2, 1),
                (1, 2),
                (0, 1),
            ]
            .map(|(a, b)| number[j + b][i + a])
        };
        Grid {
            nodes,
            elements: vec![element(0, 0), element(2, 0), element(0, 2), element(2, 2)],
        }
    }

    /// K_bb − K_bi K_ii⁻¹ K_ib with dense matrices, all unknowns of `kept` against all that are neither kept nor fixed.
    fn dense_schur(grid: &Grid, kept: &[u32], fixed: &[u32]) -> DMatrix<f64> {
        let n = 2 * grid.nodes.len();
        let mut k = DMatrix::<f64>::zeros(n, n);
        for (element, stiffness) in grid
            .elements
            .iter()
            .zip(element_stiffnesses(grid, &STEEL, 20e-3))
        {
            let place = |local: usize| 2 * element[local / 2] as usize + local % 2;
            for i in 0..16 {
                for j in 0..16 {
                    k[(place(i), place(j))] += stiffness[(i, j)];
                }
            }
        }
        let unknowns = |nodes: &[u32]| -> Vec<usize> {
            nodes
                .iter()
                .flat_map(|node| [2 * *node as usize, 2 * *node as usize + 1])
                .collect()
        };
        let inner: Vec<u32> = (0..grid.nodes.len() as u32)
            .filter(|node| !kept.contains(node) && !fixed.contains(node))
            .collect();
        let (b, i) = (unknowns(kept), unknowns(&inner));
        let part = |rows: &[usize], cols: &[usize]| k.select_rows(rows).select_columns(cols);
        let solved = part(&i, &i)
            .lu()
            .solve(&part(&i, &b))
            .expect("what is inside is held by its boundary");
        part(&b, &b) - part(&b, &i) * solved
    }

    fn assert_alike(schur: &Mat<f64>, dense: &DMatrix<f64>) {
        assert_eq!(
            (schur.nrows(), schur.ncols()),
            (dense.nrows(), dense.ncols())
        );
        for i in 0..dense.nrows() {
            for j in 0..dense.ncols() {
                // Roundings of an elimination of a few dozen unknowns.
                assert!((schur[(i, j)] - dense[(i, j)]).abs() < 1e-12 * dense.amax());
            }
        }
    }

    #[test]
    fn the_trailing_factor_is_the_schur_complement_of_a_floating_grid() {
        let grid = patch();
        let kept = [20, 0, 7, 4, 12];
        let schur = condense("a patch", &grid, &STEEL, 20e-3, &kept, &[]).expect("a sound grid");
        assert_alike(&schur, &dense_schur(&grid, &kept, &[]));
        // It floats: a translation and a rotation of the kept nodes cost nothing.
        let scale = schur[(0, 0)];
        for i in 0..schur.nrows() {
            let along_x: f64 = (0..kept.len()).map(|k| schur[(i, 2 * k)]).sum();
            let turning: f64 = kept
                .iter()
                .enumerate()
                .map(|(k, node)| {
                    let p = 1e3 * grid.nodes[*node as usize];
                    -p.y * schur[(i, 2 * k)] + p.x * schur[(i, 2 * k + 1)]
                })
                .sum();
            assert!(along_x.abs() < 1e-11 * scale && turning.abs() < 1e-10 * scale);
        }
    }

    #[test]
    fn the_trailing_factor_is_the_schur_complement_of_a_held_grid() {
        let grid = patch();
        let (kept, fixed) = ([18, 20, 3], [0, 1, 2]);
        let schur = condense("a patch", &grid, &STEEL, 20e-3, &kept, &fixed).expect("a sound grid");
        assert_alike(&schur, &dense_schur(&grid, &kept, &fixed));
    }

    #[test]
    fn a_grid_turned_inside_out_is_refused() {
        let mut grid = patch();
        for element in &mut grid.elements {
            *element = [0, 3, 2, 1, 7, 6, 5, 4].map(|place: usize| element[place]);
        }
        let error = condense("a patch", &grid, &STEEL, 20e-3, &[0, 4], &[]).expect_err("a refusal");
        assert!(matches!(
            error,
            FemError::NotPositiveDefinite {
                part: "a patch",
                ..
            }
        ));
    }
}
