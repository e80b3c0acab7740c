//! A prism condensed piece by piece, so that its sparse factors are never all in memory at once.
//!
//! Each piece is condensed to the kept unknowns and to the nodes that it shares with others. The condensed pieces add up, and the shared nodes (s) are
//! eliminated from their dense sum:
//!
//! ```text
//! K = K_kk − K_ks K_ss⁻¹ K_sk,    u_s = −K_ss⁻¹ K_sk u_k
//! ```

use faer::Mat;

use super::FemError;
use super::dense::Cholesky;
use super::prism::{CondensationCost, Interface, Prism};
use crate::gear::Vector;
use crate::grid::{Element, Grid};
use crate::run::Run;

/// Unknowns of a piece that are factorized at once, at most: its factor takes up to 0.8 GB.
const UNKNOWNS: usize = 80_000;

/// A prism in pieces.
pub struct DividedPrism<'a> {
    prism: Prism<'a>,
    interface: &'a Interface<'a>,
    /// Nothing where the prism is condensed as a whole.
    pieces: Vec<Piece>,
    /// The place of each shared or kept node among the blocks of unknowns. Shared ones come first, then kept ones, then the unknowns that others follow.
    places: Vec<Option<usize>>,
    /// The number of shared nodes, and of all blocks.
    shared: usize,
    blocks: usize,
}

/// Some elements of a section.
struct Piece {
    grid: Grid,
    /// Its nodes by their numbers in the whole section, ascending.
    nodes: Vec<u32>,
}

/// The interface of a piece. Nodes that follow other unknowns are kept as well: on a part of a circle its harmonics are nearly dependent.
struct PieceInterface {
    /// Nodes with blocks of their own, then those that follow others.
    kept: Vec<u32>,
    fixed: Vec<u32>,
    /// Where the blocks of unknowns that it reaches stand among those of the whole: own ones, then those that are followed.
    blocks: Vec<usize>,
    /// The number of own blocks.
    own: usize,
    /// How the nodes follow: a row for each.
    weights: Mat<f64>,
}

/// The stiffness on a set of unknowns that do not couple with others: of shared nodes, between these and kept ones, and of kept ones.
struct Sum {
    /// The unknowns of a block.
    unknowns: Vec<usize>,
    shared: Mat<f64>,
    between: Mat<f64>,
    kept: Mat<f64>,
}

/// How recovered nodes of a piece move by its interface.
struct PieceRows {
    /// Their places among all that are recovered.
    recovered: Vec<usize>,
    blocks: Vec<usize>,
    rows: Mat<f64>,
}

impl<'a> DividedPrism<'a> {
    /// `prism` on `interface`, in as few pieces as are small enough.
    pub fn new(prism: &Prism<'a>, interface: &'a Interface<'a>) -> Self {
        let sets = prism.independent();
        let largest = sets.iter().map(Vec::len).fold(1, usize::max);
        Self::of_pieces(prism, interface, UNKNOWNS / largest)
    }

    /// The same, in pieces of about `most` nodes at most.
    pub fn of_pieces(prism: &Prism<'a>, interface: &'a Interface<'a>, most: usize) -> Self {
        let grid = prism.grid;
        let count = grid.nodes.len().div_ceil(most).max(1);
        let pieces = match count {
            1 => Vec::new(),
            _ => Piece::around(grid, count),
        };
        let mut holders = vec![0; grid.nodes.len()];
        for piece in &pieces {
            for node in &piece.nodes {
                holders[*node as usize] += 1;
            }
        }
        let following = interface.followers.iter().flat_map(|of| of.nodes);
        for &node in interface
            .kept
            .iter()
            .chain(interface.fixed)
            .chain(following)
        {
            holders[node as usize] = 0;
        }
        let shared = (0..grid.nodes.len()).filter(|node| holders[*node] > 1);
        let shared: Vec<usize> = shared.collect();
        let kept = interface.kept.iter().map(|node| *node as usize);
        let mut places = vec![None; grid.nodes.len()];
        for (place, node) in shared.iter().copied().chain(kept).enumerate() {
            places[node] = Some(place);
        }
        let followed = interface.followers.iter().map(|of| of.weights.ncols());
        let blocks = shared.len() + interface.kept.len() + followed.sum::<usize>();
        Self {
            prism: *prism,
            interface,
            pieces,
            places,
            shared: shared.len(),
            blocks,
        }
    }

    /// The stiffness on the kept unknowns, and how all unknowns of the nodes `recovered` follow from these: as [`Prism::condense`].
    ///
    /// # Errors
    ///
    /// As [`Prism::condense`], and [`FemError::Stopped`].
    pub fn condense(
        &self,
        part: &'static str,
        recovered: &[u32],
        run: &Run,
    ) -> Result<(Mat<f64>, Mat<f64>), FemError> {
        run.check()?;
        if self.pieces.is_empty() {
            let made = self.prism.condense(part, self.interface, &[], recovered)?;
            return Ok((made.0.stiffness, made.1.by_kept));
        }
        let all = self.prism.unknowns_of_node();
        let sets = self.prism.independent().into_iter();
        let sizes = [self.shared, self.blocks - self.shared];
        let mut sums: Vec<Sum> = sets.map(|unknowns| Sum::zeros(unknowns, sizes)).collect();
        let mut rows_of_pieces = Vec::new();
        let mut is_recovered = vec![false; recovered.len()];
        for piece in &self.pieces {
            run.check()?;
            let own: Vec<(usize, u32)> = recovered
                .iter()
                .enumerate()
                .filter(|(i, _)| !is_recovered[*i])
                .filter_map(|(i, node)| Some((i, piece.own(*node)?)))
                .collect();
            own.iter().for_each(|(i, _)| is_recovered[*i] = true);
            let (places, own): (Vec<usize>, Vec<u32>) = own.into_iter().unzip();
            let interface = piece.interface(self);
            let prism = piece.prism(&self.prism);
            let (condensed, rows) = prism.condense(part, &interface.of_prism(), &[], &own)?;
            for sum in &mut sums {
                sum.add(&condensed.stiffness, &interface, all);
            }
            rows_of_pieces.push(PieceRows {
                recovered: places,
                rows: interface.on_blocks(&rows.by_kept, all),
                blocks: interface.blocks,
            });
        }
        let kept = all * sizes[1];
        let mut stiffness = Mat::zeros(kept, kept);
        let mut by_kept = Mat::zeros(all * recovered.len(), kept);
        for sum in sums {
            run.check()?;
            let unknowns = sum.unknowns.clone();
            let place = |i: usize| all * (i / unknowns.len()) + unknowns[i % unknowns.len()];
            let (condensed, follows) = sum.condensed(part)?;
            for j in 0..condensed.ncols() {
                for i in 0..condensed.nrows() {
                    stiffness[(place(i), place(j))] = condensed[(i, j)];
                }
            }
            for of in &rows_of_pieces {
                of.add(&mut by_kept, (&unknowns, all), self.shared, &follows);
            }
        }
        Ok((stiffness, by_kept))
    }

    /// Cost of [`DividedPrism::condense`] with a number of `recovered` nodes.
    pub fn cost(&self, recovered: usize) -> CondensationCost {
        if self.pieces.is_empty() {
            return self.prism.cost(self.interface, recovered);
        }
        let all = self.prism.unknowns_of_node() as f64;
        let [shared, kept] = [self.shared, self.blocks - self.shared].map(|count| count as f64);
        let rows = all * recovered as f64;
        let mut sums = CondensationCost::default();
        for unknowns in self.prism.independent() {
            let [s, k] = [shared, kept].map(|count| unknowns.len() as f64 * count);
            sums.memory += 8.0 * (s * s + s * k + k * k);
            let of_rows = rows * unknowns.len() as f64 / all * s * k;
            sums.operations += s * s * (s / 6.0 + k) + 0.5 * s * k * k + of_rows;
        }
        // The rows of the pieces reach their shared nodes too.
        let widest = self.pieces.iter().map(|piece| {
            let interface = piece.interface(self);
            let share = recovered.div_ceil(self.pieces.len());
            let cost = piece.prism(&self.prism).cost(&interface.of_prism(), share);
            sums.operations += cost.operations;
            (cost.memory, interface.blocks.len() as f64)
        });
        let (largest, blocks) = widest.fold((0.0, 0.0), |(memory, blocks): (f64, f64), of| {
            (memory.max(of.0), blocks.max(of.1))
        });
        let rows_of_pieces = 8.0 * rows * all * blocks;
        // While they are eliminated, twice what the kept ones have to do with each other.
        let result = 8.0 * all * kept * (all * kept + rows) + 8.0 * (all * kept).powi(2) / 2.0;
        CondensationCost {
            memory: sums.memory + rows_of_pieces + largest.max(result),
            ..sums
        }
    }
}

impl Piece {
    /// The elements of `grid` around its axis, in `count` pieces of equally many.
    fn around(grid: &Grid, count: usize) -> Vec<Self> {
        let angle = |element: &Element| {
            let places = element.nodes().iter();
            let middle: Vector = places.map(|node| grid.nodes[*node as usize]).sum();
            middle.y.atan2(middle.x)
        };
        let mut elements: Vec<(f64, &Element)> =
            grid.elements.iter().map(|of| (angle(of), of)).collect();
        elements.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let pieces = elements.chunks(elements.len().div_ceil(count));
        pieces.map(|elements| Self::of(grid, elements)).collect()
    }

    fn of(grid: &Grid, elements: &[(f64, &Element)]) -> Self {
        let nodes = elements.iter().flat_map(|(_, element)| element.nodes());
        let mut nodes: Vec<u32> = nodes.copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: u32| nodes.partition_point(|known| *known < node) as u32;
        let elements = elements.iter().map(|(_, of)| of.renumbered(place));
        Self {
            grid: Grid {
                elements: elements.collect(),
                nodes: nodes
                    .iter()
                    .map(|node| grid.nodes[*node as usize])
                    .collect(),
            },
            nodes,
        }
    }

    fn prism<'a>(&'a self, whole: &Prism<'a>) -> Prism<'a> {
        Prism {
            grid: &self.grid,
            ..*whole
        }
    }

    /// The number that a node of the whole section has here; `None` where this piece does not have it.
    fn own(&self, node: u32) -> Option<u32> {
        let place = self.nodes.binary_search(&node).ok()?;
        Some(place as u32)
    }

    fn interface(&self, of: &DividedPrism<'_>) -> PieceInterface {
        let mut kept = Vec::new();
        let mut blocks = Vec::new();
        for (own, node) in self.nodes.iter().enumerate() {
            if let Some(place) = of.places[*node as usize] {
                kept.push(own as u32);
                blocks.push(place);
            }
        }
        let own = kept.len();
        let mut first = of.shared + of.interface.kept.len();
        let mut weights = Vec::new();
        for all in of.interface.followers {
            let count = all.weights.ncols();
            let from = blocks.len() - own;
            let before = kept.len();
            for (row, node) in all.nodes.iter().enumerate() {
                if let Some(node) = self.own(*node) {
                    let place = kept.len() - own;
                    weights.extend((0..count).map(|j| (place, from + j, all.weights[(row, j)])));
                    kept.push(node);
                }
            }
            if kept.len() > before {
                blocks.extend(first..first + count);
            }
            first += count;
        }
        let mut of_nodes = Mat::zeros(kept.len() - own, blocks.len() - own);
        for (row, column, weight) in weights {
            of_nodes[(row, column)] = weight;
        }
        let fixed = of.interface.fixed.iter();
        PieceInterface {
            kept,
            fixed: fixed.filter_map(|node| self.own(*node)).collect(),
            blocks,
            own,
            weights: of_nodes,
        }
    }
}

impl PieceInterface {
    fn of_prism(&self) -> Interface<'_> {
        Interface {
            kept: &self.kept,
            followers: &[],
            fixed: &self.fixed,
        }
    }

    /// `rows` by its nodes, of `all` unknowns each, as rows by its blocks.
    fn on_blocks(&self, rows: &Mat<f64>, all: usize) -> Mat<f64> {
        let mut on_blocks = Mat::zeros(rows.nrows(), all * self.blocks.len());
        for unknown in 0..all {
            let by_nodes = Mat::from_fn(rows.nrows(), self.kept.len(), |i, j| {
                rows[(i, all * j + unknown)]
            });
            let by_blocks = self.columns_on_blocks(&by_nodes);
            for j in 0..by_blocks.ncols() {
                let mut column = on_blocks.col_mut(all * j + unknown);
                column.copy_from(by_blocks.col(j));
            }
        }
        on_blocks
    }

    /// A column for each of its blocks, of one for each of its nodes.
    fn columns_on_blocks(&self, by_nodes: &Mat<f64>) -> Mat<f64> {
        let (count, own, followers) = (by_nodes.nrows(), self.own, self.weights.nrows());
        let mut by_blocks = Mat::zeros(count, self.blocks.len());
        by_blocks
            .subcols_mut(0, own)
            .copy_from(by_nodes.subcols(0, own));
        by_blocks
            .subcols_mut(own, self.weights.ncols())
            .copy_from(by_nodes.subcols(own, followers) * &self.weights);
        by_blocks
    }
}

impl Sum {
    fn zeros(unknowns: Vec<usize>, [shared, kept]: [usize; 2]) -> Self {
        let [shared, kept] = [shared, kept].map(|count| unknowns.len() * count);
        Self {
            unknowns,
            shared: Mat::zeros(shared, shared),
            between: Mat::zeros(shared, kept),
            kept: Mat::zeros(kept, kept),
        }
    }

    /// Adds the part of the `stiffness` of a piece on the nodes of its interface, of `all` unknowns each.
    fn add(&mut self, stiffness: &Mat<f64>, of: &PieceInterface, all: usize) {
        let (size, shared) = (self.unknowns.len(), self.shared.nrows());
        let nodes = of.kept.len();
        for (c, column) in self.unknowns.iter().enumerate() {
            for (r, row) in self.unknowns.iter().enumerate() {
                let by_nodes = Mat::from_fn(nodes, nodes, |i, j| {
                    stiffness[(all * i + row, all * j + column)]
                });
                // Wᵀ K W: the same on the rows of K W.
                let half = of.columns_on_blocks(&by_nodes).transpose().to_owned();
                let on_blocks = of.columns_on_blocks(&half);
                for (j, column) in of.blocks.iter().enumerate() {
                    for (i, row) in of.blocks.iter().enumerate() {
                        // The transpose of the block from row to column.
                        let value = on_blocks[(j, i)];
                        let (row, column) = (size * row + r, size * column + c);
                        match (row.checked_sub(shared), column.checked_sub(shared)) {
                            (None, None) => self.shared[(row, column)] += value,
                            (None, Some(column)) => self.between[(row, column)] += value,
                            (Some(_), None) => {}
                            (Some(row), Some(column)) => self.kept[(row, column)] += value,
                        }
                    }
                }
            }
        }
    }

    /// K, and −K_ss⁻¹ K_sk.
    fn condensed(self, part: &'static str) -> Result<(Mat<f64>, Mat<f64>), FemError> {
        let unknowns = self.shared.nrows();
        let factor = Cholesky::new(self.shared);
        let factor = factor.ok_or(FemError::NotPositiveDefinite { part, unknowns })?;
        let mut half = self.between;
        factor.half_solve_in_place(half.as_mut());
        let condensed = self.kept - half.transpose() * &half;
        factor.other_half_solve_in_place(half.as_mut());
        Ok((condensed, -half))
    }
}

impl PieceRows {
    /// Adds the part of some `unknowns` of a node to the rows by the kept ones; the shared nodes move as `follows` says.
    fn add(
        &self,
        by_kept: &mut Mat<f64>,
        (unknowns, all): (&[usize], usize),
        shared: usize,
        follows: &Mat<f64>,
    ) {
        let size = unknowns.len();
        let own = |i: usize| all * (i / size) + unknowns[i % size];
        let count = size * self.recovered.len();
        let (inner, outer): (Vec<usize>, Vec<usize>) =
            (0..self.blocks.len()).partition(|block| self.blocks[*block] < shared);
        let rows = |blocks: &[usize]| {
            Mat::from_fn(count, size * blocks.len(), |i, j| {
                self.rows[(own(i), all * blocks[j / size] + unknowns[j % size])]
            })
        };
        let moved = Mat::from_fn(size * inner.len(), follows.ncols(), |i, j| {
            follows[(size * self.blocks[inner[i / size]] + i % size, j)]
        });
        let by_shared = rows(&inner) * moved;
        let direct = rows(&outer);
        let row = |i: usize| all * self.recovered[i / size] + unknowns[i % size];
        for j in 0..by_shared.ncols() {
            for i in 0..count {
                by_kept[(row(i), own(j))] += by_shared[(i, j)];
            }
        }
        for j in 0..direct.ncols() {
            let block = self.blocks[outer[j / size]] - shared;
            let column = all * block + unknowns[j % size];
            for i in 0..count {
                by_kept[(row(i), column)] += direct[(i, j)];
            }
        }
    }
}
