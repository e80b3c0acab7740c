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
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Accum, Mat, Par, Side};

use super::FemError;
use super::dense::mirror_lower;
use super::element::{self, ElementStiffness};
use crate::gear::Material;
use crate::grid::element::MOST_NODES;
use crate::grid::{Element, Grid};

/// The stiffness of every element of `grid` in turn, of one material; `thickness`, in meters, is that of an element whose own
/// is 1.
pub fn element_stiffnesses(
    grid: &Grid,
    material: &Material,
    thickness: f64,
) -> impl Iterator<Item = ElementStiffness> {
    grid.elements.iter().map(move |element| {
        let (nodes, part) = (element.places(&grid.nodes), element.thickness());
        element::stiffness(element.kind(), &nodes, material, thickness * part)
    })
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
    let mut matrix = BlockMatrix::new(&grid.elements, &numbering);
    for (element, k) in grid
        .elements
        .iter()
        .zip(element_stiffnesses(grid, material, thickness))
    {
        matrix.add(element, &k, &numbering);
    }
    // Springs on the kept unknowns make a floating grid definite; they add to the Schur complement exactly and are taken
    // off again below.
    let spring = if fixed.is_empty() {
        material.youngs_modulus * thickness
    } else {
        0.0
    };
    for node in numbering.interior..numbering.count {
        matrix.add_to_diagonal(node, spring);
    }
    let unknowns = 2 * numbering.count;
    let mut schur = matrix
        .trailing_schur(numbering.interior)
        .map_err(|error| match error {
            Failure::Size => FemError::TooLarge { part, unknowns },
            Failure::Indefinite => FemError::NotPositiveDefinite { part, unknowns },
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

/// The lower triangle of a symmetric matrix of 2 x 2 blocks, one for each pair of nodes of a common element.
struct BlockMatrix {
    /// Where the rows of each block column begin in `rows`.
    starts: Vec<usize>,
    /// The block rows of each column, rising, the diagonal first.
    rows: Vec<u32>,
    /// The unknowns' own columns one after the other; without the entry above the diagonal.
    values: Vec<f64>,
}

impl BlockMatrix {
    /// A matrix of zeros with the pattern of `elements`.
    fn new(elements: &[Element], numbering: &Numbering) -> Self {
        let pairs = || {
            elements.iter().flat_map(|element| {
                let places = || element.nodes().iter().map(|node| numbering.place(*node));
                let all = places().flat_map(move |column| places().map(move |row| column.zip(row)));
                all.flatten().filter(|(column, row)| row >= column)
            })
        };
        let mut ends = vec![0; numbering.count + 1];
        for (column, _) in pairs() {
            ends[column + 1] += 1;
        }
        for column in 0..numbering.count {
            ends[column + 1] += ends[column];
        }
        let mut next = ends.clone();
        let mut all = vec![0; ends[numbering.count]];
        for (column, row) in pairs() {
            all[next[column]] = row as u32;
            next[column] += 1;
        }
        let (mut starts, mut rows) = (vec![0], Vec::with_capacity(all.len() / 2));
        for range in ends.windows(2) {
            let column = &mut all[range[0]..range[1]];
            column.sort_unstable();
            let first = rows.len();
            for &row in &*column {
                if rows.len() == first || rows[rows.len() - 1] != row {
                    rows.push(row);
                }
            }
            starts.push(rows.len());
        }
        let values = vec![0.0; 4 * rows.len() - numbering.count];
        Self {
            starts,
            rows,
            values,
        }
    }

    /// Where the first unknown of a block column has its values, and how many blocks there are; those of the second
    /// unknown follow.
    fn column(&self, column: usize) -> (usize, usize) {
        let (first, end) = (self.starts[column], self.starts[column + 1]);
        (4 * first - column, end - first)
    }

    /// Adds the stiffness `k` of `element`.
    fn add(&mut self, element: &Element, k: &ElementStiffness, numbering: &Numbering) {
        let mut places = [None; MOST_NODES];
        for (place, node) in places.iter_mut().zip(element.nodes()) {
            *place = numbering.place(*node);
        }
        for (b, column) in places.iter().enumerate() {
            let Some(column) = *column else { continue };
            let (first, blocks) = self.column(column);
            let rows = &self.rows[self.starts[column]..self.starts[column + 1]];
            for (a, row) in places.iter().enumerate() {
                let Some(row) = row.filter(|row| *row >= column) else {
                    continue;
                };
                let block = rows.partition_point(|&known| (known as usize) < row);
                let (left, right) = (first + 2 * block, first + 2 * (blocks + block));
                self.values[left] += k[(2 * a, 2 * b)];
                self.values[left + 1] += k[(2 * a + 1, 2 * b)];
                if row > column {
                    self.values[right - 1] += k[(2 * a, 2 * b + 1)];
                }
                self.values[right] += k[(2 * a + 1, 2 * b + 1)];
            }
        }
    }

    /// Adds `value` to both diagonal entries of a block.
    fn add_to_diagonal(&mut self, block: usize, value: f64) {
        let (first, blocks) = self.column(block);
        self.values[first] += value;
        self.values[first + 2 * blocks] += value;
    }

    /// The matrix on single unknowns.
    fn into_unknowns(self) -> SparseColMat<u32, f64> {
        let count = self.starts.len() - 1;
        let mut pointers = Vec::with_capacity(2 * count + 1);
        let mut rows = Vec::with_capacity(self.values.len());
        pointers.push(0);
        for column in 0..count {
            let blocks = &self.rows[self.starts[column]..self.starts[column + 1]];
            for unknown in 0..2 {
                rows.extend(
                    blocks
                        .iter()
                        .flat_map(|row| [2 * row, 2 * row + 1])
                        .skip(unknown),
                );
                pointers.push(rows.len() as u32);
            }
        }
        let pattern = SymbolicSparseColMat::new_checked(2 * count, 2 * count, pointers, None, rows);
        SparseColMat::new(pattern, self.values)
    }

    /// Approximate minimum degree on the `interior` blocks; the kept ones stay last, in their order.
    fn fill_reducing_order(&self, interior: usize) -> Result<Perm<u32>, Failure> {
        let (mut pointers, mut rows) = (vec![0], Vec::new());
        for column in 0..interior {
            let blocks = &self.rows[self.starts[column]..self.starts[column + 1]];
            rows.extend(blocks.iter().filter(|row| (**row as usize) < interior));
            pointers.push(rows.len() as u32);
        }
        let entries = rows.len();
        let pattern = SymbolicSparseColMat::new_checked(interior, interior, pointers, None, rows);
        let (mut forward, mut inverse) = (vec![0_u32; interior], vec![0_u32; interior]);
        let mut memory =
            MemBuffer::new(amd::order_maybe_unsorted_scratch::<u32>(interior, entries));
        amd::order_maybe_unsorted(
            &mut forward,
            &mut inverse,
            pattern.as_ref(),
            Default::default(),
            MemStack::new(&mut memory),
        )
        .map_err(|_| Failure::Size)?;
        let all = 0..self.starts.len() as u32 - 1;
        let of_unknowns = |blocks: Vec<u32>| -> Box<[u32]> {
            let kept = all.clone().skip(interior);
            let blocks = blocks.into_iter().chain(kept);
            blocks
                .flat_map(|block| [2 * block, 2 * block + 1])
                .collect()
        };
        let (forward, inverse) = (of_unknowns(forward), of_unknowns(inverse));
        let unknowns = forward.len();
        Ok(Perm::new_checked(forward, inverse, unknowns))
    }

    /// The Schur complement on the unknowns of the blocks from `interior` on.
    fn trailing_schur(self, interior: usize) -> Result<Mat<f64>, Failure> {
        let order = self.fill_reducing_order(interior)?;
        trailing_schur(&self.into_unknowns(), &order, 2 * interior)
    }
}

/// The Schur complement of the symmetric matrix whose lower triangle is `a` on its unknowns from `interior` on, which
/// `order` leaves in their places.
fn trailing_schur(
    a: &SparseColMat<u32, f64>,
    order: &Perm<u32>,
    interior: usize,
) -> Result<Mat<f64>, Failure> {
    let kept = a.nrows() - interior;
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

/// The places of the nodes that move: interior ones first, kept ones last, fixed ones nowhere.
struct Numbering {
    places: Vec<u32>,
    interior: usize,
    count: usize,
}

impl Numbering {
    const FIXED: u32 = u32::MAX;

    fn new(nodes: usize, kept: &[u32], fixed: &[u32]) -> Self {
        let mut places = vec![0; nodes];
        for &node in kept.iter().chain(fixed) {
            places[node as usize] = Self::FIXED;
        }
        let mut next = 0;
        for place in places.iter_mut().filter(|place| **place != Self::FIXED) {
            *place = next;
            next += 1;
        }
        let interior = next as usize;
        for &node in kept {
            places[node as usize] = next;
            next += 1;
        }
        Self {
            places,
            interior,
            count: next as usize,
        }
    }

    fn place(&self, node: u32) -> Option<usize> {
        let place = self.places[node as usize];
        (place != Self::FIXED).then_some(place as usize)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::gear::Vector;

    const STEEL: Material = Material {
        youngs_modulus: 210e9,
        poisson_ratio: 0.3,
        density: 7850.0,
    };

    /// Four distorted elements around one corner: nodes on the lattice of corners and midsides.
    pub(in crate::fem) fn patch() -> Grid {
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
        let element = |i: usize, j: usize| Element::quadrilateral(element(i, j));
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
            let place = |local: usize| 2 * element.nodes()[local / 2] as usize + local % 2;
            let unknowns = 2 * element.nodes().len();
            for i in 0..unknowns {
                for j in 0..unknowns {
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
            let nodes = element.nodes();
            *element = Element::quadrilateral([0, 3, 2, 1, 7, 6, 5, 4].map(|i: usize| nodes[i]));
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
