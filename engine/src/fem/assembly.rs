//! The sparse stiffness of a grid, its unknowns numbered for condensation.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::Perm;
use faer::sparse::linalg::amd;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use super::element::ElementStiffness;
use crate::grid::Element;
use crate::grid::element::MOST_NODES;

/// Why a matrix was not factorized.
pub(super) enum Failure {
    Size,
    Indefinite,
}

/// The lower triangle of a symmetric matrix of 2 x 2 blocks, one for each pair of nodes of a common element.
pub(super) struct BlockMatrix {
    /// Where the rows of each block column begin in `rows`.
    starts: Vec<usize>,
    /// The block rows of each column, rising, the diagonal first.
    rows: Vec<u32>,
    /// The unknowns' own columns one after the other; without the entry above the diagonal.
    values: Vec<f64>,
}

impl BlockMatrix {
    /// A matrix of zeros with the pattern of `elements`.
    pub(super) fn new(elements: &[Element], numbering: &Numbering) -> Self {
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
    pub(super) fn add(&mut self, element: &Element, k: &ElementStiffness, numbering: &Numbering) {
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
    pub(super) fn add_to_diagonal(&mut self, block: usize, value: f64) {
        let (first, blocks) = self.column(block);
        self.values[first] += value;
        self.values[first + 2 * blocks] += value;
    }

    /// The matrix on single unknowns.
    pub(super) fn into_unknowns(self) -> SparseColMat<u32, f64> {
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
                .flat_map(|block| [2 * block, 2 * block + 1])
                .collect()
        };
        let (forward, inverse) = (of_unknowns(forward), of_unknowns(inverse));
        let unknowns = forward.len();
        Ok(Perm::new_checked(forward, inverse, unknowns))
    }
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
