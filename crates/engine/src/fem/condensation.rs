//! Static condensation: the exact stiffness of a body on the unknowns that are kept, and what depends on all others.
//!
//! The kept unknowns are ordered last, so that the trailing block L₂₂ of the sparse Cholesky factor gives the Schur
//! complement S = L₂₂ L₂₂ᵀ without a single right-hand side. A functional b of all displacements takes half of one, L⁻¹ b: with the
//! kept ones moved by u it is (b₂ − L₂₁ L₁₁⁻¹ b₁)ᵀ u, and under a force that acts as another, c, it is (L₁₁⁻¹ b₁)ᵀ L₁₁⁻¹ c₁ with
//! what is kept held.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, MatRef, Par};

use super::FemError;
use super::body::{Body, Load};
use super::dense::mirror_lower;
use super::factor::Factor;
use super::recovery::Functional;
use super::sparse::{BlockMatrix, Interface, Numbering};
use crate::grid::element::MOST_NODES;

/// Functionals that go through the factor together: as many columns as stay in the cache next to a supernode. It changes no digit.
const FUNCTIONALS_AT_ONCE: usize = 64;

/// Loads that go through the factor together. It changes no digit.
const LOADS_AT_ONCE: usize = 16;

/// A body condensed to the unknowns that are kept, node by node in the order given, all unknowns of each: it can be asked what it does under what
/// moves these, and under forces on others.
#[derive(Debug)]
pub struct Condensed {
    numbering: Numbering,
    /// The unknowns of a node.
    size: usize,
    /// The unknowns of each node in sets that do not stiffen each other.
    sets: Vec<Set>,
}

/// Functionals of the displacements, one a row.
#[derive(Debug, Clone)]
pub struct Rows {
    /// By the kept unknowns, while no force acts on any other.
    pub by_kept: Mat<f64>,
    /// By forces along the loaded functionals, with what is kept held, in m/N.
    pub by_forces: Mat<f64>,
}

/// Condenses `body` to its `interface`.
///
/// A body that floats, with nothing fixed, is condensed as well: its stiffness is singular by the rigid motions only.
///
/// # Errors
///
/// [`FemError::NotPositiveDefinite`] if the grid is degenerate.
pub fn condense<B: Body>(
    part: &'static str,
    body: &B,
    interface: &Interface<'_>,
) -> Result<Condensed, FemError> {
    let numbering = Numbering::new(body.grid().nodes.len(), interface);
    let sets = body.independent().into_iter();
    let sets = sets.map(|unknowns| Set::new(part, body, &numbering, unknowns));
    Ok(Condensed {
        size: body.unknowns_of_node(),
        sets: sets.collect::<Result<_, _>>()?,
        numbering,
    })
}

impl Condensed {
    /// The stiffness on the kept unknowns, in N/m.
    pub fn stiffness(&self) -> Mat<f64> {
        let kept = self.kept();
        let mut stiffness = Mat::zeros(kept, kept);
        for set in &self.sets {
            let places = self.places_of_kept(set);
            let mut own = squared(&set.trailing);
            for i in 0..own.nrows() {
                own[(i, i)] -= set.spring;
            }
            add_block(&mut stiffness, &places, &places, own.as_ref());
        }
        stiffness
    }

    /// What becomes of functionals: forces act along the `loaded` ones, and the others are only `asked` for, which takes less. None costs nothing.
    pub fn rows(&self, loaded: &[Functional], asked: &[Functional]) -> [Rows; 2] {
        let [mut of_loaded, mut of_asked] = [loaded, asked].map(|functionals| Rows {
            by_kept: Mat::zeros(functionals.len(), self.kept()),
            by_forces: Mat::zeros(functionals.len(), loaded.len()),
        });
        for set in &self.sets {
            let (interior, kept) = (
                set.unknowns.len() * self.numbering.interior,
                set.trailing.nrows(),
            );
            let places = self.places_of_kept(set);
            let by_kept = |half: &Mat<f64>| &set.trailing * half.subrows(interior, kept);
            let acting = set.with_part(loaded);
            let forces = set.half_solved(&self.numbering, loaded, &acting);
            add_block(
                &mut of_loaded.by_kept,
                &acting,
                &places,
                by_kept(&forces).transpose(),
            );
            let forces = forces.subrows(0, interior);
            let own = squared_columns(forces);
            add_block(&mut of_loaded.by_forces, &acting, &acting, own.as_ref());
            for which in set.with_part(asked).chunks(FUNCTIONALS_AT_ONCE) {
                let half = set.half_solved(&self.numbering, asked, which);
                add_block(
                    &mut of_asked.by_kept,
                    which,
                    &places,
                    by_kept(&half).transpose(),
                );
                let mut by_forces = Mat::<f64>::zeros(half.ncols(), forces.ncols());
                matmul(
                    by_forces.as_mut(),
                    Accum::Replace,
                    half.subrows(0, interior).transpose(),
                    forces,
                    1.0,
                    Par::Seq,
                );
                add_block(&mut of_asked.by_forces, which, &acting, by_forces.as_ref());
            }
        }
        [of_loaded, of_asked]
    }

    /// The unknowns of all nodes under each of `loads`, which say how the kept unknowns move.
    pub fn displacements(&self, loads: &[Load]) -> Vec<Vec<f64>> {
        let Self {
            numbering,
            size,
            sets,
        } = self;
        let nodes = numbering.nodes();
        let mut answers = vec![vec![0.0; nodes * size]; loads.len()];
        for set in sets {
            let own = set.unknowns.len();
            let (interior, kept) = (own * numbering.interior, set.trailing.nrows());
            let (places, of_kept) = (set.factor.places(), self.places_of_kept(set));
            for (loads, answers) in loads
                .chunks(LOADS_AT_ONCE)
                .zip(answers.chunks_mut(LOADS_AT_ONCE))
            {
                let mut columns = Mat::<f64>::zeros(interior + kept, loads.len());
                for (j, load) in loads.iter().enumerate() {
                    for (along, force) in &load.forces {
                        set.add(numbering, along, *force, columns.col_as_slice_mut(j));
                    }
                }
                set.factor.half_solve_in_place(&mut columns);
                // What is kept moves as it is said to: L₂₂ᵀ u_b, of which the other half makes u_b.
                let moves = Mat::from_fn(kept, loads.len(), |i, j| loads[j].moves[of_kept[i]]);
                let moves = set.trailing.transpose() * moves;
                columns.subrows_mut(interior, kept).copy_from(moves);
                set.factor.other_half_solve_in_place(&mut columns);
                for (j, answer) in answers.iter_mut().enumerate() {
                    let column = columns.col_as_slice(j);
                    for (node, answer) in answer.chunks_exact_mut(*size).enumerate() {
                        for (place, share) in numbering.terms(node as u32) {
                            for (i, unknown) in set.unknowns.iter().enumerate() {
                                answer[*unknown] +=
                                    share * column[places[place * own + i] as usize];
                            }
                        }
                    }
                }
            }
        }
        answers
    }

    /// The number of kept unknowns.
    fn kept(&self) -> usize {
        self.size * (self.numbering.count - self.numbering.interior)
    }

    /// Where the kept unknowns of a set stand among all kept ones.
    fn places_of_kept(&self, set: &Set) -> Vec<usize> {
        let kept = 0..set.trailing.nrows();
        kept.map(|i| set.among(self.size, i)).collect()
    }
}

/// Those unknowns of each node of a body that have nothing to do with the others, factorized.
#[derive(Debug)]
struct Set {
    unknowns: Vec<usize>,
    factor: Factor,
    /// L₂₂.
    trailing: Mat<f64>,
    /// What was added to the diagonal of the kept unknowns.
    spring: f64,
}

impl Set {
    fn new<B: Body>(
        part: &'static str,
        body: &B,
        numbering: &Numbering,
        unknowns: Vec<usize>,
    ) -> Result<Self, FemError> {
        let (size, all) = (unknowns.len(), body.unknowns_of_node());
        let among = |i: usize| all * (i / size) + unknowns[i % size];
        let of_element: Vec<usize> = (0..size * MOST_NODES).map(among).collect();
        let mut matrix = BlockMatrix::new(size, &body.grid().elements, numbering);
        for (element, k) in body.grid().elements.iter().zip(body.stiffnesses()) {
            matrix.add(element, |i, j| k(of_element[i], of_element[j]), numbering);
        }
        // Springs on the kept unknowns make a floating grid definite; they add to the Schur complement exactly and are taken
        // off again from it.
        let spring = if numbering.holds() { 0.0 } else { body.scale() };
        for node in numbering.interior..numbering.count {
            matrix.add_to_diagonal(node, spring);
        }
        let factor = Factor::new(part, matrix, numbering)?;
        Ok(Self {
            unknowns,
            trailing: factor.trailing(),
            factor,
            spring,
        })
    }

    /// Where unknown `i` of these stands among all, of which a node has so many.
    fn among(&self, all: usize, i: usize) -> usize {
        let size = self.unknowns.len();
        all * (i / size) + self.unknowns[i % size]
    }

    /// Adds a `force` along a functional to a column in the order of the factor. What is fixed takes none.
    fn add(&self, numbering: &Numbering, along: &Functional, force: f64, column: &mut [f64]) {
        let (size, places) = (self.unknowns.len(), self.factor.places());
        for &(node, unknown, weight) in along.terms() {
            let Some(own) = self.unknowns.iter().position(|of| *of == unknown) else {
                continue;
            };
            for (place, share) in numbering.terms(node) {
                column[places[place * size + own] as usize] += share * weight * force;
            }
        }
    }

    /// The numbers of those functionals in which these unknowns have a part.
    fn with_part(&self, functionals: &[Functional]) -> Vec<usize> {
        let is_own = |term: &(u32, usize, f64)| term.2 != 0.0 && self.unknowns.contains(&term.1);
        let each = functionals.iter().enumerate();
        let own = each.filter(|(_, of)| of.terms().iter().any(is_own));
        own.map(|(number, _)| number).collect()
    }

    /// L⁻¹ b of the functionals b with the numbers `which`, a column each in the order of the factor.
    fn half_solved(
        &self,
        numbering: &Numbering,
        functionals: &[Functional],
        which: &[usize],
    ) -> Mat<f64> {
        let unknowns = self.unknowns.len() * numbering.count;
        let mut columns = Mat::<f64>::zeros(unknowns, which.len());
        for (j, number) in which.iter().enumerate() {
            self.add(
                numbering,
                &functionals[*number],
                1.0,
                columns.col_as_slice_mut(j),
            );
        }
        self.factor.half_solve_in_place(&mut columns);
        columns
    }
}

/// Adds `block` to those `rows` and `columns` of a matrix.
fn add_block(to: &mut Mat<f64>, rows: &[usize], columns: &[usize], block: MatRef<'_, f64>) {
    for (j, &column) in columns.iter().enumerate() {
        for (i, &row) in rows.iter().enumerate() {
            to[(row, column)] += block[(i, j)];
        }
    }
}

/// L Lᵀ of a lower triangle.
fn squared(l: &Mat<f64>) -> Mat<f64> {
    lower_of(
        (l.as_ref(), BlockStructure::TriangularLower),
        (l.transpose(), BlockStructure::TriangularUpper),
    )
}

/// Cᵀ C.
fn squared_columns(c: MatRef<'_, f64>) -> Mat<f64> {
    let whole = BlockStructure::Rectangular;
    lower_of((c.transpose(), whole), (c, whole))
}

/// A symmetric product, of which half is computed.
fn lower_of(
    (left, of_left): (MatRef<'_, f64>, BlockStructure),
    (right, of_right): (MatRef<'_, f64>, BlockStructure),
) -> Mat<f64> {
    let mut product = Mat::<f64>::zeros(left.nrows(), left.nrows());
    triangular::matmul(
        product.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        left,
        of_left,
        right,
        of_right,
        1.0,
        Par::Seq,
    );
    mirror_lower(&mut product);
    product
}

#[cfg(test)]
pub(super) mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::fem::body::Plate;
    use crate::fem::recovery::vectors;
    use crate::gear::{Material, Vector};
    use crate::grid::{Element, Grid};

    /// A plate of steel.
    fn plate(grid: &Grid) -> Plate<'_> {
        Plate {
            grid,
            material: &Material::STEEL,
            thickness: 20e-3,
        }
    }

    /// It on `kept`.
    fn condensed(grid: &Grid, kept: &[u32], fixed: &[u32]) -> Result<Condensed, FemError> {
        let interface = Interface {
            kept,
            fixed,
            ..Default::default()
        };
        condense("a patch", &plate(grid), &interface)
    }

    fn stiffness(grid: &Grid, kept: &[u32], fixed: &[u32]) -> Mat<f64> {
        let condensed = condensed(grid, kept, fixed).expect("a sound grid");
        condensed.stiffness()
    }

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

    /// The stiffness of the whole grid.
    fn dense(grid: &Grid) -> DMatrix<f64> {
        let n = 2 * grid.nodes.len();
        let mut k = DMatrix::<f64>::zeros(n, n);
        for (element, stiffness) in grid.elements.iter().zip(plate(grid).stiffnesses()) {
            let place = |local: usize| 2 * element.nodes()[local / 2] as usize + local % 2;
            let unknowns = 2 * element.nodes().len();
            for i in 0..unknowns {
                for j in 0..unknowns {
                    k[(place(i), place(j))] += stiffness(i, j);
                }
            }
        }
        k
    }

    /// K_bb − K_bi K_ii⁻¹ K_ib with dense matrices, all unknowns of `kept` against all that are neither kept nor fixed.
    fn dense_schur(grid: &Grid, kept: &[u32], fixed: &[u32]) -> DMatrix<f64> {
        let k = dense(grid);
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
        let schur = stiffness(&grid, &kept, &[]);
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
        let schur = stiffness(&grid, &kept, &fixed);
        assert_alike(&schur, &dense_schur(&grid, &kept, &fixed));
    }

    #[test]
    fn a_grid_turned_inside_out_is_refused() {
        let mut grid = patch();
        for element in &mut grid.elements {
            let nodes = element.nodes();
            *element = Element::quadrilateral([0, 3, 2, 1, 7, 6, 5, 4].map(|i: usize| nodes[i]));
        }
        let error = condensed(&grid, &[0, 4], &[]).expect_err("a refusal");
        assert!(matches!(
            error,
            FemError::NotPositiveDefinite {
                part: "a patch",
                ..
            }
        ));
    }

    #[test]
    fn functionals_follow_the_kept_nodes_as_the_solution_of_the_dense_system_does() {
        let grid = patch();
        let n = grid.nodes.len() as u32;
        // Inner, kept and fixed nodes together, with and without anything held.
        let asked: Vec<Functional> = (0..70)
            .map(|k| {
                let term = |i: u32| {
                    (
                        (7 * k + 3 * i) % n,
                        Vector::new(f64::from(i) - 1.0, 0.5 + f64::from(k % 5)),
                    )
                };
                Functional::new((0..4).map(term).collect())
            })
            .collect();
        for fixed in [&[0, 1, 2][..], &[]] {
            let kept = [18, 20, 3];
            let condensed = condensed(&grid, &kept, fixed).expect("a sound grid");
            let [_, Rows { by_kept, .. }] = condensed.rows(&[], &asked);
            let inner: Vec<u32> = (0..n)
                .filter(|node| !kept.contains(node) && !fixed.contains(node))
                .collect();
            // u_i = −K_ii⁻¹ K_ib u_b, from the dense matrix.
            let k = dense(&grid);
            let unknowns = |nodes: &[u32]| -> Vec<usize> {
                let both = |node: &u32| [2 * *node as usize, 2 * *node as usize + 1];
                nodes.iter().flat_map(both).collect()
            };
            let (b, i) = (unknowns(&kept), unknowns(&inner));
            let part = |rows: &[usize], cols: &[usize]| k.select_rows(rows).select_columns(cols);
            let moved = -part(&i, &i).lu().solve(&part(&i, &b)).expect("held");
            for (row, functional) in asked.iter().enumerate() {
                for column in 0..b.len() {
                    let mut expected = 0.0;
                    for &(node, unknown, w) in functional.terms() {
                        let unknown = 2 * node as usize + unknown;
                        if unknown == b[column] {
                            expected += w;
                        } else if let Some(place) = i.iter().position(|u| *u == unknown) {
                            expected += w * moved[(place, column)];
                        }
                    }
                    assert!((by_kept[(row, column)] - expected).abs() < 1e-11);
                }
            }
        }
    }

    #[test]
    fn a_grid_whose_boundary_moves_by_a_linear_field_follows_it_inside() {
        let grid = patch();
        let field = |p: &Vector| Vector::new(1e-3 * p.x + 2e-4 * p.y, -4e-4 * p.y + 1e-4 * p.x);
        // The patch has one corner inside, and the midsides that meet there.
        let corner = |node: u32| grid.elements.iter().all(|e| e.nodes().contains(&node));
        let moved: Vec<u32> = (0..grid.nodes.len() as u32)
            .filter(|node| !corner(*node))
            .collect();
        assert_eq!(moved.len() + 1, grid.nodes.len());
        let moves = |factor: f64| Load {
            moves: moved
                .iter()
                .map(|node| factor * field(&grid.nodes[*node as usize]))
                .flat_map(|u| [u.x, u.y])
                .collect(),
            forces: Vec::new(),
        };
        let answers = condensed(&grid, &moved, &[]).expect("a sound grid");
        let answers = answers.displacements(&[moves(1.0), moves(-2.0)]);
        for (answer, factor) in answers.iter().zip([1.0, -2.0]) {
            for (u, point) in vectors(answer).iter().zip(&grid.nodes) {
                assert!((u - factor * field(point)).norm() < 1e-17);
            }
        }
    }

    #[test]
    fn a_force_moves_a_free_node_by_the_compliance_of_the_condensed_grid() {
        let grid = patch();
        let (free, held) = (grid.elements[0].nodes()[0], grid.elements[3].nodes()[2]);
        let fixed: Vec<u32> = grid.elements[3].nodes().to_vec();
        assert!(fixed.contains(&held) && !fixed.contains(&free));
        let stiffness = stiffness(&grid, &[free], &fixed);
        let load = Load {
            moves: vec![0.0; 2 * fixed.len()],
            forces: vec![(
                Functional::displacement(free, Vector::new(3.0, -1.0)),
                100.0,
            )],
        };
        let answers = condensed(&grid, &fixed, &[]).expect("a sound grid");
        let u = vectors(&answers.displacements(&[load])[0])[free as usize];
        let force = [0, 1].map(|i| stiffness[(i, 0)] * u.x + stiffness[(i, 1)] * u.y);
        assert!((force[0] - 300.0).abs() < 1e-9 && (force[1] + 100.0).abs() < 1e-9);
    }
}
