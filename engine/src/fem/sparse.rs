//! The sparse stiffness of a grid, its unknowns numbered for condensation.

use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::Perm;
use faer::sparse::linalg::amd;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use crate::grid::Element;
use crate::grid::element::MOST_NODES;

/// Why a matrix was not factorized.
pub(super) enum Failure {
    Size,
    Indefinite,
}

/// The lower triangle of a symmetric matrix of square blocks, one for each pair of nodes of a common element.
pub(super) struct BlockMatrix {
    /// The unknowns of a node, C.
    size: usize,
    /// Where the rows of each block column begin in `rows`.
    starts: Vec<usize>,
    /// The block rows of each column, rising, the diagonal first.
    rows: Vec<u32>,
    /// The unknowns' own columns one after the other; without the entries above the diagonal.
    values: Vec<f64>,
}

impl BlockMatrix {
    /// A matrix of zeros with the pattern of `elements` and `size` unknowns a node.
    pub(super) fn new(size: usize, elements: &[Element], numbering: &Numbering) -> Self {
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
        let values = vec![0.0; size * size * rows.len() - above(size) * numbering.count];
        Self {
            size,
            starts,
            rows,
            values,
        }
    }

    /// The unknowns of a node, C.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// Where the diagonal entry of each unknown of a block column stands; the entries below it follow.
    fn diagonals(&self, column: usize) -> impl Iterator<Item = usize> + Clone + use<> {
        let size = self.size;
        let (first, end) = (self.starts[column], self.starts[column + 1]);
        let start = size * size * first - above(size) * column;
        let whole = size * (end - first);
        (0..size).map(move |c| start + c * whole - above(c))
    }

    /// Adds the stiffness `k` of `element`: its entries by unknowns, node by node.
    pub(super) fn add(
        &mut self,
        element: &Element,
        k: impl Fn(usize, usize) -> f64,
        numbering: &Numbering,
    ) {
        let mut places = [None; MOST_NODES];
        for (place, node) in places.iter_mut().zip(element.nodes()) {
            *place = numbering.place(*node);
        }
        for (b, column) in places.iter().enumerate() {
            let Some(column) = *column else { continue };
            let (size, diagonals) = (self.size, self.diagonals(column));
            let rows = &self.rows[self.starts[column]..self.starts[column + 1]];
            for (a, row) in places.iter().enumerate() {
                let Some(row) = row.filter(|row| *row >= column) else {
                    continue;
                };
                let block = rows.partition_point(|&known| (known as usize) < row);
                for (c, diagonal) in diagonals.clone().enumerate() {
                    // The block on the diagonal has no entries above it.
                    let first = if row == column { c } else { 0 };
                    for r in first..size {
                        self.values[diagonal + size * block + r - c] +=
                            k(size * a + r, size * b + c);
                    }
                }
            }
        }
    }

    /// Adds `value` to the diagonal entries of a block.
    pub(super) fn add_to_diagonal(&mut self, block: usize, value: f64) {
        for diagonal in self.diagonals(block) {
            self.values[diagonal] += value;
        }
    }

    /// The matrix on single unknowns.
    pub(super) fn into_unknowns(self) -> SparseColMat<u32, f64> {
        let (size, count) = (self.size, self.starts.len() - 1);
        let mut pointers = Vec::with_capacity(size * count + 1);
        let mut rows = Vec::with_capacity(self.values.len());
        pointers.push(0);
        for column in 0..count {
            let blocks = &self.rows[self.starts[column]..self.starts[column + 1]];
            for unknown in 0..size {
                rows.extend(
                    blocks
                        .iter()
                        .flat_map(|row| unknowns_of(size, *row))
                        .skip(unknown),
                );
                pointers.push(rows.len() as u32);
            }
        }
        let pattern =
            SymbolicSparseColMat::new_checked(size * count, size * count, pointers, None, rows);
        SparseColMat::new(pattern, self.values)
    }

    /// Approximate minimum degree on the `interior` blocks; the kept ones stay last, in their order.
    ///
    /// Blocks are nodes of a section, which is plane in three dimensions too: nested dissection (METIS) took 1.1 to 1.7 times the operations.
    pub(super) fn fill_reducing_order(&self, interior: usize) -> Result<Perm<u32>, Failure> {
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
                .flat_map(|block| unknowns_of(self.size, block))
                .collect()
        };
        let (forward, inverse) = (of_unknowns(forward), of_unknowns(inverse));
        let unknowns = forward.len();
        Ok(Perm::new_checked(forward, inverse, unknowns))
    }
}

/// The unknowns of a block.
fn unknowns_of(size: usize, block: u32) -> Range<u32> {
    let size = size as u32;
    size * block..size * (block + 1)
}

/// Entries of a block above its diagonal.
fn above(size: usize) -> usize {
    size * size.saturating_sub(1) / 2
}

/// The places of the nodes that move: interior ones first, kept ones last, fixed ones nowhere.
pub(super) struct Numbering {
    places: Vec<u32>,
    pub(super) interior: usize,
    pub(super) count: usize,
}

impl Numbering {
    const FIXED: u32 = u32::MAX;

    pub(super) fn new(nodes: usize, kept: &[u32], fixed: &[u32]) -> Self {
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

    pub(super) fn place(&self, node: u32) -> Option<usize> {
        let place = self.places[node as usize];
        (place != Self::FIXED).then_some(place as usize)
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    /// The matrix of two elements with so many unknowns at each node, entry by entry, and the same by adding up.
    fn assembled(size: usize) {
        let elements = [
            Element::triangle([0, 1, 2, 3, 4, 5]),
            Element::triangle([2, 1, 6, 4, 7, 8]),
        ];
        let numbering = Numbering::new(9, &[4, 0], &[8]);
        let k = |e: usize, i: usize, j: usize| {
            let (low, high) = (i.min(j), i.max(j));
            (1.0 + (7 * e + 3 * low) as f64 + 0.1 * high as f64).sin()
        };
        let mut matrix = BlockMatrix::new(size, &elements, &numbering);
        let mut expected = Mat::<f64>::zeros(size * numbering.count, size * numbering.count);
        for (e, element) in elements.iter().enumerate() {
            matrix.add(element, |i, j| k(e, i, j), &numbering);
            for (a, node) in element.nodes().iter().enumerate() {
                for (b, other) in element.nodes().iter().enumerate() {
                    let places = numbering.place(*node).zip(numbering.place(*other));
                    let Some((row, column)) = places else {
                        continue;
                    };
                    for (r, c) in (0..size).flat_map(|r| (0..size).map(move |c| (r, c))) {
                        expected[(size * row + r, size * column + c)] +=
                            k(e, size * a + r, size * b + c);
                    }
                }
            }
        }
        matrix.add_to_diagonal(3, 0.5);
        for c in 0..size {
            expected[(size * 3 + c, size * 3 + c)] += 0.5;
        }
        let order = matrix.fill_reducing_order(numbering.interior);
        let order = order.unwrap_or_else(|_| panic!("a small matrix"));
        let (forward, _) = order.as_ref().arrays();
        let (interior, count) = (size * numbering.interior, size * numbering.count);
        assert!((interior..count).all(|i| forward[i] as usize == i));
        let found = matrix.into_unknowns().to_dense();
        for j in 0..count {
            for i in j..count {
                assert!(
                    (found[(i, j)] - expected[(i, j)]).abs() < 1e-14,
                    "{size}: {i} {j}"
                );
            }
        }
    }

    #[test]
    fn blocks_of_any_size_add_up_to_the_matrix_of_single_unknowns() {
        assembled(1);
        assembled(2);
        assembled(3);
    }
}
