//! The sparse stiffness of a grid, its unknowns numbered for condensation.

use std::collections::BTreeMap;
use std::ops::Range;

use faer::Mat;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::Perm;
use faer::sparse::linalg::amd;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use crate::grid::Element;

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
    /// The blocks between nodes of which both follow other unknowns, by row and column: their condensed form is a product of whole matrices.
    followed: BTreeMap<(u32, u32), Vec<f64>>,
}

impl BlockMatrix {
    /// A matrix of zeros with the pattern of `elements` and `size` unknowns a node.
    pub(super) fn new(size: usize, elements: &[Element], numbering: &Numbering) -> Self {
        let reached = elements.iter().map(|element| numbering.places_of(element));
        let reached: Vec<Vec<usize>> = reached.collect();
        let pairs = || {
            reached.iter().flat_map(|places| {
                let columns = places.iter().enumerate();
                columns.flat_map(|(i, column)| places[i..].iter().map(move |row| (*column, *row)))
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
            followed: BTreeMap::new(),
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

    /// Adds the stiffness of `element`, told by `fill`.
    pub(super) fn add(
        &mut self,
        element: &Element,
        fill: impl Fn([usize; 2], &mut [f64]),
        numbering: &Numbering,
    ) {
        let size = self.size;
        let mut between = vec![0.0; size * size];
        for (b, column_node) in element.nodes().iter().enumerate() {
            let columns = numbering.terms(*column_node);
            for (a, node) in element.nodes().iter().enumerate() {
                let rows = numbering.terms(*node);
                let lower = |(column, _): &&(usize, f64)| rows.iter().any(|(row, _)| row >= column);
                if !columns.iter().any(|column| lower(&column)) {
                    continue;
                }
                fill([a, b], &mut between);
                if rows.len() > 1 && columns.len() > 1 {
                    let sum = self.followed.entry((*node, *column_node));
                    let sum = sum.or_insert_with(|| vec![0.0; size * size]);
                    for (sum, value) in sum.iter_mut().zip(&between) {
                        *sum += value;
                    }
                    continue;
                }
                for (column, by) in columns {
                    for (row, share) in rows.iter().filter(|(row, _)| row >= column) {
                        self.add_block((*row, *column), by * share, &between);
                    }
                }
            }
        }
    }

    /// Adds the blocks between nodes that follow others, on those: Wᵀ K W for each two unknowns of a node.
    fn add_followed(&mut self, numbering: &Numbering) {
        let followed = std::mem::take(&mut self.followed);
        let Some(first) = followed
            .keys()
            .flat_map(|(row, _)| numbering.terms(*row))
            .map(|(place, _)| *place)
            .min()
        else {
            return;
        };
        let mut nodes: Vec<u32> = followed.keys().map(|(row, _)| *row).collect();
        nodes.dedup();
        let mut weights = Mat::<f64>::zeros(nodes.len(), numbering.count - first);
        for (i, node) in nodes.iter().enumerate() {
            for (place, weight) in numbering.terms(*node) {
                weights[(i, place - first)] = *weight;
            }
        }
        let at = |node: &u32| nodes.partition_point(|known| known < node);
        let between: Vec<_> = followed
            .iter()
            .map(|((row, column), block)| (at(row), at(column), block))
            .collect();
        let size = self.size;
        let mut sum = Mat::<f64>::zeros(size * weights.ncols(), size * weights.ncols());
        let mut moved = Mat::<f64>::zeros(nodes.len(), weights.ncols());
        for (r, c) in (0..size).flat_map(|r| (0..size).map(move |c| (r, c))) {
            moved.fill(0.0);
            for j in 0..weights.ncols() {
                for (row, column, block) in &between {
                    moved[(*row, j)] += block[size * c + r] * weights[(*column, j)];
                }
            }
            let of_both = weights.transpose() * &moved;
            for j in 0..weights.ncols() {
                for i in j..weights.ncols() {
                    sum[(size * i + r, size * j + c)] = of_both[(i, j)];
                }
            }
        }
        let mut block = vec![0.0; size * size];
        for column in first..numbering.count {
            let rows = self.rows[self.starts[column]..self.starts[column + 1]].to_vec();
            for row in rows.into_iter().map(|row| row as usize) {
                let (i, j) = (size * (row - first), size * (column - first));
                for (c, values) in block.chunks_exact_mut(size).enumerate() {
                    for (r, value) in values.iter_mut().enumerate() {
                        *value = sum[(i + r, j + c)];
                    }
                }
                self.add_block((row, column), 1.0, &block);
            }
        }
    }

    /// Adds `share` of a block, column by column.
    fn add_block(&mut self, (row, column): (usize, usize), share: f64, block: &[f64]) {
        let rows = &self.rows[self.starts[column]..self.starts[column + 1]];
        let place = self.size * rows.partition_point(|&known| (known as usize) < row);
        for (c, diagonal) in self.diagonals(column).enumerate() {
            // The block on the diagonal has no entries above it.
            let first = if row == column { c } else { 0 };
            let from = &block[self.size * c + first..self.size * (c + 1)];
            let to = &mut self.values[diagonal + place + first - c..];
            for (to, from) in to.iter_mut().zip(from) {
                *to += share * from;
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
    pub(super) fn into_unknowns(mut self, numbering: &Numbering) -> SparseColMat<u32, f64> {
        self.add_followed(numbering);
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
    /// All kept blocks couple with each other, and count in the degrees of the interior blocks that couple with them. Without them the factor of a tooth took up
    /// to twice the operations.
    ///
    /// Blocks are nodes of a section, which is plane in three dimensions too: nested dissection (METIS) took 1.1 to 1.7 times the operations.
    pub(super) fn fill_reducing_order(&self, interior: usize) -> Result<Perm<u32>, Failure> {
        let count = self.starts.len() - 1;
        let (mut pointers, mut rows) = (vec![0], Vec::new());
        for column in 0..count {
            if column < interior {
                rows.extend(&self.rows[self.starts[column]..self.starts[column + 1]]);
            } else {
                rows.extend(column as u32..count as u32);
            }
            pointers.push(rows.len() as u32);
        }
        let entries = rows.len();
        let pattern = SymbolicSparseColMat::new_checked(count, count, pointers, None, rows);
        let (mut forward, mut inverse) = (vec![0_u32; count], vec![0_u32; count]);
        let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<u32>(count, entries));
        amd::order_maybe_unsorted(
            &mut forward,
            &mut inverse,
            pattern.as_ref(),
            Default::default(),
            MemStack::new(&mut memory),
        )
        .map_err(|_| Failure::Size)?;
        forward.retain(|block| (*block as usize) < interior);
        inverse.truncate(interior);
        for (place, block) in (0..).zip(&forward) {
            inverse[*block as usize] = place;
        }
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

/// Fills the stiffness between the nodes a and b of an element, of `size` unknowns each, column by column, from its entries by unknowns, node by node.
pub(super) fn by_entries(
    size: usize,
    k: impl Fn(usize, usize) -> f64,
) -> impl Fn([usize; 2], &mut [f64]) {
    move |[a, b], between| {
        for (c, column) in between.chunks_exact_mut(size).enumerate() {
            for (r, value) in column.iter_mut().enumerate() {
                *value = k(size * a + r, size * b + c);
            }
        }
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

/// Nodes whose displacements follow unknowns that take their place: u_i = Σ_j w_ij a_j, with the same weights for each unknown of a node.
#[derive(Debug, Clone)]
pub struct Followers<'a> {
    /// The nodes.
    pub nodes: &'a [u32],
    /// w: a row for each node.
    pub weights: Mat<f64>,
}

/// The places of the nodes that move: interior ones first, kept and coupled ones last, fixed ones nowhere.
pub(super) struct Numbering {
    /// Of each node where its terms begin, and where they end.
    ranges: Vec<Range<usize>>,
    /// Places and weights.
    terms: Vec<(usize, f64)>,
    pub(super) interior: usize,
    pub(super) count: usize,
    holds: bool,
}

impl Numbering {
    pub(super) fn new(nodes: usize, kept: &[u32], fixed: &[u32]) -> Self {
        Self::with_followers(nodes, kept, &[], fixed)
    }

    pub(super) fn with_followers(
        nodes: usize,
        kept: &[u32],
        followers: &[Followers<'_>],
        fixed: &[u32],
    ) -> Self {
        let mut is_interior = vec![true; nodes];
        let following = followers.iter().flat_map(|of| of.nodes);
        for &node in kept.iter().chain(fixed).chain(following) {
            is_interior[node as usize] = false;
        }
        let mut numbering = Self {
            ranges: vec![0..0; nodes],
            terms: Vec::new(),
            interior: 0,
            count: 0,
            holds: !fixed.is_empty(),
        };
        let interior = (0..nodes as u32).filter(|node| is_interior[*node as usize]);
        for node in interior {
            numbering.set(node, [(numbering.count, 1.0)]);
            numbering.count += 1;
        }
        numbering.interior = numbering.count;
        for &node in kept {
            numbering.set(node, [(numbering.count, 1.0)]);
            numbering.count += 1;
        }
        for of in followers {
            let first = numbering.count;
            for (i, &node) in of.nodes.iter().enumerate() {
                let weights = (0..of.weights.ncols()).map(|j| (first + j, of.weights[(i, j)]));
                numbering.set(node, weights);
            }
            numbering.count += of.weights.ncols();
        }
        numbering
    }

    /// True if any node is held.
    pub(super) fn holds(&self) -> bool {
        self.holds
    }

    fn set(&mut self, node: u32, terms: impl IntoIterator<Item = (usize, f64)>) {
        let first = self.terms.len();
        self.terms.extend(terms);
        self.ranges[node as usize] = first..self.terms.len();
    }

    /// Where the unknowns stand that a node follows, and by how much; a node that moves by itself follows its own.
    pub(super) fn terms(&self, node: u32) -> &[(usize, f64)] {
        &self.terms[self.ranges[node as usize].clone()]
    }

    /// Where the unknowns of a node stand that moves by itself.
    pub(super) fn place(&self, node: u32) -> Option<usize> {
        match self.terms(node) {
            [(place, _)] => Some(*place),
            _ => None,
        }
    }

    /// All places that an element reaches, each once.
    fn places_of(&self, element: &Element) -> Vec<usize> {
        let terms = element.nodes().iter().flat_map(|node| self.terms(*node));
        let mut places: Vec<usize> = terms.map(|(place, _)| *place).collect();
        places.sort_unstable();
        places.dedup();
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The matrix of two elements with the given number of unknowns a node, entry by entry, and the same by adding up.
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
            matrix.add(element, by_entries(size, |i, j| k(e, i, j)), &numbering);
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
        let found = matrix.into_unknowns(&numbering).to_dense();
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

    #[test]
    fn nodes_that_follow_others_add_their_part_to_those() {
        let elements = [
            Element::triangle([0, 1, 2, 3, 4, 5]),
            Element::triangle([2, 1, 6, 4, 7, 8]),
        ];
        let weights = Mat::from_fn(3, 2, |i, j| 0.3 + 0.5 * i as f64 - 0.7 * (i * j) as f64);
        let followers = [Followers {
            nodes: &[2, 6, 8],
            weights: weights.clone(),
        }];
        let numbering = Numbering::with_followers(9, &[4], &followers, &[0]);
        assert_eq!((numbering.interior, numbering.count), (4, 7));
        // Every node by the numbered unknowns: fixed ones by none.
        let mut by = Mat::<f64>::zeros(9, 7);
        for (place, node) in [1, 3, 5, 7, 4].into_iter().enumerate() {
            by[(node, place)] = 1.0;
        }
        for (i, node) in [2, 6, 8].into_iter().enumerate() {
            (by[(node, 5)], by[(node, 6)]) = (weights[(i, 0)], weights[(i, 1)]);
        }
        let k =
            |e: usize, i: usize, j: usize| (1.0 + (7 * e + 3 * i.min(j) + i.max(j)) as f64).sin();
        let mut matrix = BlockMatrix::new(1, &elements, &numbering);
        let mut plain = Mat::<f64>::zeros(9, 9);
        for (e, element) in elements.iter().enumerate() {
            matrix.add(element, by_entries(1, |i, j| k(e, i, j)), &numbering);
            for (a, row) in element.nodes().iter().enumerate() {
                for (b, column) in element.nodes().iter().enumerate() {
                    plain[(*row as usize, *column as usize)] += k(e, a, b);
                }
            }
        }
        let (found, expected) = (
            matrix.into_unknowns(&numbering).to_dense(),
            by.transpose() * &plain * &by,
        );
        for j in 0..7 {
            for i in j..7 {
                assert!((found[(i, j)] - expected[(i, j)]).abs() < 1e-13, "{i} {j}");
            }
        }
    }
}
