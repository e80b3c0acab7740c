//! Bodies whose every section is the same one, turned: plane grids times functions along the axis.
//!
//! In the frame that turns with the section nothing depends on z. With the turn τ per length, v the displacement in the plane and
//! w along the axis, J = [[0, −1], [1, 0]] and ∂_φ = −y ∂_x + x ∂_y,
//!
//! ```text
//! D_z v = v' − τ ∂_φ v + τ J v        D_z w = w' − τ ∂_φ w
//! strain = (v_x,x; v_y,y; D_z w; v_x,y + v_y,x; w,x + (D_z v)_x; w,y + (D_z v)_y) = B_0 d f + B_1 d f'
//! K = K_00 ⊗ M + K_01 ⊗ C + K_01ᵀ ⊗ Cᵀ + K_11 ⊗ D,    K_ab = ∫ B_aᵀ D_el B_b dA
//! ```
//!
//! and M, C, D the integrals of products of the functions ([`super::axial`]). Straight bodies are those of τ = 0. The unknowns are
//! the components along e_r, e_t and the axis at each node, for each function along the axis: node by node, component by component.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, Par};
use nalgebra::SMatrix;

use super::FemError;
use super::axial::{AxialBasis, AxialMatrices};
use super::condensation::squared;
use super::element::gradients;
use super::factor::{Factor, FactorSize};
use super::sparse::{BlockMatrix, Followers, Numbering};
use crate::gear::{Material, Vector};
use crate::grid::element::MOST_NODES;
use crate::grid::{Element, Grid};

/// The components of the displacement of a node: radial, tangential, axial.
pub(crate) const COMPONENTS: usize = 3;

/// The last of them.
const AXIAL: usize = 2;

/// The unknowns of an element for one function along the axis.
const UNKNOWNS: usize = COMPONENTS * MOST_NODES;

pub(crate) type SectionMatrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
type Strains = SMatrix<f64, 6, UNKNOWNS>;

/// A body whose every section is `grid`, turned.
#[derive(Debug, Clone, Copy)]
pub struct Prism<'a> {
    /// The section at z = 0.
    pub grid: &'a Grid,
    /// Its material.
    pub material: &'a Material,
    /// τ: the turn of the section per length, in radians a meter.
    pub twist: f64,
    /// The functions along the axis.
    pub axial: &'a AxialBasis,
}

/// Kept unknowns of a prism.
#[derive(Debug, Clone, Copy, Default)]
pub struct Interface<'a> {
    /// Nodes whose unknowns are kept.
    pub kept: &'a [u32],
    /// Nodes that follow unknowns of their own, which are kept after those.
    pub followers: &'a [Followers<'a>],
    /// Nodes that are held.
    pub fixed: &'a [u32],
}

/// A prism on its kept unknowns, and displacements at points.
#[derive(Debug, Clone)]
pub struct CondensedPrism {
    /// The stiffness on the kept unknowns, in N/m: node by node, component by component, function by function.
    pub stiffness: Mat<f64>,
    /// The displacements asked for, by the kept unknowns: a row for each point and function along the axis.
    pub rows: Mat<f64>,
    /// Their compliance among each other with the kept unknowns held, in m/N.
    pub held: Mat<f64>,
}

/// All unknowns of some nodes of a prism: node by node, component by component, a row for each function along the axis.
#[derive(Debug, Clone)]
pub struct NodeRows {
    /// By the kept unknowns.
    pub by_kept: Mat<f64>,
    /// By forces on the requested points, with the kept unknowns held, in m/N.
    pub by_points: Mat<f64>,
}

/// Cost of a condensation before it is done.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CondensationCost {
    /// The most memory that it takes, with its result, in bytes.
    pub memory: f64,
    /// Multiplications and additions.
    pub operations: f64,
}

/// Takes an element, and what fills the stiffness between two of its nodes, column by column.
pub(super) type TakeElement<'a> = dyn FnMut(&Element, &dyn Fn([usize; 2], &mut [f64])) + 'a;

/// Unknowns that go through the factor together, about.
const ROWS_AT_ONCE: usize = 64;

/// The matrices of one element: K_00, K_01 and K_11 on polar components at its nodes.
#[derive(Debug)]
pub(crate) struct SectionMatrices {
    pub(crate) plain: SectionMatrix,
    pub(crate) mixed: SectionMatrix,
    pub(crate) axial: SectionMatrix,
}

impl Prism<'_> {
    /// The unknowns of a node.
    pub fn unknowns_of_node(&self) -> usize {
        COMPONENTS * self.axial.len()
    }

    /// The numbers of the unknowns on `interface` and inside it.
    fn numbering(&self, interface: &Interface<'_>) -> Numbering {
        let Interface {
            kept,
            followers,
            fixed,
        } = *interface;
        Numbering::with_followers(self.grid.nodes.len(), kept, followers, fixed)
    }

    /// The prism condensed to its interface, with the displacement at each of `points`: a node and a direction in polar components, for every function along
    /// the axis; and how all unknowns of the nodes `recovered` follow from those that are kept.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`] if the grid is degenerate.
    pub fn condense(
        &self,
        part: &'static str,
        interface: &Interface<'_>,
        points: &[(u32, [f64; COMPONENTS])],
        recovered: &[u32],
    ) -> Result<(CondensedPrism, NodeRows), FemError> {
        let numbering = self.numbering(interface);
        let kept = self.unknowns_of_node() * (numbering.count - numbering.interior);
        let (asked, recovered_rows) = (
            points.len() * self.axial.len(),
            recovered.len() * self.unknowns_of_node(),
        );
        let mut condensed = CondensedPrism {
            stiffness: Mat::zeros(kept, kept),
            rows: Mat::zeros(asked, kept),
            held: Mat::zeros(asked, asked),
        };
        let mut rows = NodeRows {
            by_kept: Mat::zeros(recovered_rows, kept),
            by_points: Mat::zeros(recovered_rows, asked),
        };
        for unknowns in self.independent() {
            let alone = Independent {
                prism: self,
                unknowns,
                numbering: &numbering,
            };
            alone.condense(part, points, recovered, (&mut condensed, &mut rows))?;
        }
        Ok((condensed, rows))
    }

    /// Cost of [`Prism::condense`] to `interface`, with a number of `recovered` nodes and no points.
    pub fn cost(&self, interface: &Interface<'_>, recovered: usize) -> CondensationCost {
        let numbering = self.numbering(interface);
        let kept = (numbering.count - numbering.interior) as f64;
        let [unknowns, rows] =
            [kept, recovered as f64].map(|count| count * self.unknowns_of_node() as f64);
        let mut cost = CondensationCost::default();
        let Some(of_nodes) = FactorSize::of(&self.grid.elements, &numbering) else {
            return cost;
        };
        for set in self.independent() {
            let size = set.len() as f64;
            let square = size * size;
            let values = 8.0 * square * of_nodes.factor;
            // A value and its row for each entry of the matrix; the trailing part of the factor, and its square.
            let factorized = square * (12.0 * of_nodes.matrix + of_nodes.scratch) + values;
            let squared = values + 16.0 * square * kept * kept;
            cost.memory = cost.memory.max(factorized).max(squared);
            let solved = size * recovered as f64 * square * of_nodes.factor;
            cost.operations +=
                square * size * of_nodes.operations + (size * kept).powi(3) / 6.0 + solved;
        }
        cost.memory += 8.0 * unknowns * (unknowns + rows);
        cost
    }

    /// The unknowns of a node, in sets that do not stiffen each other. A straight body is its own image in its middle: motions even in the plane and odd along
    /// the axis do not couple with the opposite.
    pub(super) fn independent(&self) -> Vec<Vec<usize>> {
        let functions = self.axial.len();
        let all = 0..self.unknowns_of_node();
        if self.twist != 0.0 || !self.axial.alternates() {
            return vec![all.collect()];
        }
        let is_even = |unknown: &usize| {
            let (component, p) = (unknown / functions, unknown % functions);
            (p + usize::from(component == AXIAL)).is_multiple_of(2)
        };
        let (even, odd) = all.partition(is_even);
        vec![even, odd]
    }

    /// Hands each element with its stiffness to `take`.
    pub(super) fn each_element(&self, take: &mut TakeElement<'_>) {
        let all: Vec<usize> = (0..self.unknowns_of_node()).collect();
        self.each_element_of(&all, take);
    }

    /// Hands each element to `take`, with its stiffness on some `unknowns` of each node, which rise.
    fn each_element_of(&self, unknowns: &[usize], take: &mut TakeElement<'_>) {
        let law = Law3::new(self.material);
        let functions = self.axial.len();
        let own = [0, 1, 2].map(|component| -> Vec<usize> {
            let all = component * functions..(component + 1) * functions;
            let own = unknowns.iter().filter(|unknown| all.contains(unknown));
            own.map(|unknown| unknown - all.start).collect()
        });
        let matrices = self.axial.matrices();
        let products: Vec<AxialMatrices> = (0..COMPONENTS * COMPONENTS)
            .map(|pair| matrices.between(&own[pair / COMPONENTS], &own[pair % COMPONENTS]))
            .collect();
        for element in &self.grid.elements {
            let SectionMatrices {
                plain,
                mixed,
                axial,
            } = section_matrices(element, self.grid, &law, self.twist);
            take(element, &|[a, b], between| {
                let mut columns = between.chunks_exact_mut(unknowns.len());
                for (d, of_component) in own.iter().enumerate() {
                    for (column, to) in (0..of_component.len()).zip(&mut columns) {
                        let mut first = 0;
                        for (c, rows) in own.iter().enumerate() {
                            let to = &mut to[first..first + rows.len()];
                            let [i, j] = [COMPONENTS * a + c, COMPONENTS * b + d];
                            let shares =
                                [plain[(i, j)], mixed[(i, j)], mixed[(j, i)], axial[(i, j)]];
                            products[COMPONENTS * c + d].fill(shares, column, to);
                            first += rows.len();
                        }
                    }
                }
            });
        }
    }
}

/// Unknowns of each node of a prism that do not couple with the others.
struct Independent<'a> {
    prism: &'a Prism<'a>,
    unknowns: Vec<usize>,
    numbering: &'a Numbering,
}

impl Independent<'_> {
    /// Adds the condensed form of these unknowns to that of all.
    fn condense(
        &self,
        part: &'static str,
        points: &[(u32, [f64; COMPONENTS])],
        recovered: &[u32],
        (condensed, rows): (&mut CondensedPrism, &mut NodeRows),
    ) -> Result<(), FemError> {
        let Self {
            prism,
            unknowns,
            numbering,
        } = self;
        let (size, all) = (unknowns.len(), prism.unknowns_of_node());
        let mut matrix = BlockMatrix::new(size, &prism.grid.elements, numbering);
        prism.each_element_of(unknowns, &mut |element, fill| {
            matrix.add(element, fill, numbering);
        });
        // Springs on the kept unknowns make a floating grid definite; they add to the Schur complement exactly and are taken
        // off again below.
        let spring = if numbering.holds() {
            0.0
        } else {
            prism.material.youngs_modulus
        };
        for node in numbering.interior..numbering.count {
            matrix.add_to_diagonal(node, spring);
        }
        let factor = Factor::new(part, matrix, numbering)?;
        let trailing = factor.trailing();
        let interior = size * numbering.interior;
        let on_kept = |i: usize| all * (i / size) + unknowns[i % size];

        let mut stiffness = squared(&trailing);
        for i in 0..stiffness.nrows() {
            stiffness[(i, i)] -= spring;
        }
        for j in 0..stiffness.ncols() {
            for i in 0..stiffness.nrows() {
                condensed.stiffness[(on_kept(i), on_kept(j))] = stiffness[(i, j)];
            }
        }

        let asked = self.asked(points);
        let mut columns = self.forces(&factor, asked.len(), |add| {
            for (column, (point, p)) in asked.iter().enumerate() {
                let (node, direction) = points[*point];
                for (c, along) in direction.into_iter().enumerate() {
                    add(node, c * prism.axial.len() + p, column, along);
                }
            }
        });
        let asked: Vec<usize> = asked
            .into_iter()
            .map(|(point, p)| point * prism.axial.len() + p)
            .collect();
        factor.half_solve_in_place(&mut columns);
        let inside = columns.subrows(0, interior);
        let mut held = Mat::<f64>::zeros(columns.ncols(), columns.ncols());
        triangular::matmul(
            held.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Replace,
            inside.transpose(),
            BlockStructure::Rectangular,
            inside,
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        super::dense::mirror_lower(&mut held);
        let by_kept = &trailing * columns.subrows(interior, trailing.nrows());
        for (j, &column) in asked.iter().enumerate() {
            for (i, &row) in asked.iter().enumerate() {
                condensed.held[(row, column)] += held[(i, j)];
            }
            for i in 0..by_kept.nrows() {
                condensed.rows[(column, on_kept(i))] = by_kept[(i, j)];
            }
        }

        let at_once = (ROWS_AT_ONCE / size).max(1);
        for (chunk, nodes) in recovered.chunks(at_once).enumerate() {
            let mut units = self.forces(&factor, nodes.len() * size, |add| {
                for (i, node) in nodes.iter().enumerate() {
                    for (c, unknown) in unknowns.iter().enumerate() {
                        add(*node, *unknown, i * size + c, 1.0);
                    }
                }
            });
            factor.half_solve_in_place(&mut units);
            let by_kept = &trailing * units.subrows(interior, trailing.nrows());
            let mut by_points = Mat::<f64>::zeros(units.ncols(), inside.ncols());
            matmul(
                by_points.as_mut(),
                Accum::Replace,
                units.subrows(0, interior).transpose(),
                inside,
                1.0,
                Par::Seq,
            );
            for row in 0..units.ncols() {
                let to = on_kept(chunk * at_once * size + row);
                for i in 0..by_kept.nrows() {
                    rows.by_kept[(to, on_kept(i))] = by_kept[(i, row)];
                }
                for (j, &column) in asked.iter().enumerate() {
                    rows.by_points[(to, column)] = by_points[(row, j)];
                }
            }
        }
        Ok(())
    }

    /// The points and functions along the axis whose displacements these unknowns have a part in.
    fn asked(&self, points: &[(u32, [f64; COMPONENTS])]) -> Vec<(usize, usize)> {
        let functions = self.prism.axial.len();
        let has_part = |direction: &[f64; COMPONENTS], p: usize| {
            let mut components = direction.iter().enumerate();
            components
                .any(|(c, along)| *along != 0.0 && self.unknowns.contains(&(c * functions + p)))
        };
        let each = points.iter().enumerate();
        each.flat_map(|(point, (_, direction))| {
            let own = (0..functions).filter(move |p| has_part(direction, *p));
            own.map(move |p| (point, p))
        })
        .collect()
    }

    /// Columns of forces in the order of `factor`: `each` gets the entries, by node, unknown of it and column.
    fn forces(
        &self,
        factor: &Factor,
        count: usize,
        each: impl FnOnce(&mut dyn FnMut(u32, usize, usize, f64)),
    ) -> Mat<f64> {
        let (size, places) = (self.unknowns.len(), factor.places());
        let mut forces = Mat::<f64>::zeros(size * self.numbering.count, count);
        each(&mut |node, unknown, column, force| {
            let Some(own) = self.unknowns.iter().position(|of| *of == unknown) else {
                return;
            };
            for (place, share) in self.numbering.terms(node) {
                forces[(places[place * size + own] as usize, column)] += share * force;
            }
        });
        forces
    }
}

/// An isotropic law in space: stresses from normal strains and shears.
pub(crate) struct Law3 {
    along: f64,
    across: f64,
    shear: f64,
}

impl Law3 {
    pub(crate) fn new(material: &Material) -> Self {
        let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
        let across = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let shear = material.shear_modulus();
        Self {
            along: across + 2.0 * shear,
            across,
            shear,
        }
    }

    /// The stress (xx, yy, zz, xy, xz, yz) of a strain; of any orthogonal directions.
    pub(crate) fn stress<T>(&self, [xx, yy, zz, xy, xz, yz]: [T; 6]) -> [T; 6]
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        let sum = (xx + yy + zz) * self.across;
        let twice = self.along - self.across;
        [
            sum + xx * twice,
            sum + yy * twice,
            sum + zz * twice,
            xy * self.shear,
            xz * self.shear,
            yz * self.shear,
        ]
    }
}

pub(crate) fn section_matrices(
    element: &Element,
    grid: &Grid,
    law: &Law3,
    twist: f64,
) -> SectionMatrices {
    let kind = element.kind();
    let places = element.places(&grid.nodes);
    let count = element.nodes().len();
    let mut matrices = SectionMatrices {
        plain: SectionMatrix::zeros(),
        mixed: SectionMatrix::zeros(),
        axial: SectionMatrix::zeros(),
    };
    for &(xi, eta, weight) in kind.rule() {
        let (gradient, det) = gradients(kind, &places, xi, eta);
        let values = kind.values(xi, eta);
        let at: Vector = places.iter().zip(values).map(|(p, n)| *p * n).sum();
        let (mut b_0, mut b_1) = (Strains::zeros(), Strains::zeros());
        for i in 0..count {
            let (n, (dx, dy)) = (values[i], gradient[i]);
            let turned = twist * (-at.y * dx + at.x * dy);
            let (x, y, z) = (3 * i, 3 * i + 1, 3 * i + 2);
            b_0[(0, x)] = dx;
            b_0[(1, y)] = dy;
            b_0[(2, z)] = -turned;
            b_0[(3, x)] = dy;
            b_0[(3, y)] = dx;
            b_0[(4, z)] = dx;
            b_0[(4, x)] = -turned;
            b_0[(4, y)] = -twist * n;
            b_0[(5, z)] = dy;
            b_0[(5, y)] = -turned;
            b_0[(5, x)] = twist * n;
            b_1[(2, z)] = n;
            b_1[(4, x)] = n;
            b_1[(5, y)] = n;
        }
        let weight = weight * det;
        let stressed = |strains: &Strains| {
            let mut stresses = Strains::zeros();
            for (stress, strain) in stresses.column_iter_mut().zip(strains.column_iter()) {
                let mut stress = stress;
                let of = law.stress(std::array::from_fn(|i| strain[i]));
                for (s, of) in stress.iter_mut().zip(of) {
                    *s = weight * of;
                }
            }
            stresses
        };
        let (s_0, s_1) = (stressed(&b_0), stressed(&b_1));
        matrices.plain += b_0.transpose() * s_0;
        matrices.mixed += b_0.transpose() * s_1;
        matrices.axial += b_1.transpose() * s_1;
    }
    let turn = cartesian_by_polar(&places[..count]);
    for matrix in [
        &mut matrices.plain,
        &mut matrices.mixed,
        &mut matrices.axial,
    ] {
        *matrix = turn.transpose() * *matrix * turn;
    }
    matrices
}

/// The consistent mass of an element for a density of 1 and one function along the axis, ∫ N_iᵀ N_j dA, on polar components at its nodes.
pub(crate) fn section_mass(element: &Element, grid: &Grid) -> SectionMatrix {
    let kind = element.kind();
    let places = element.places(&grid.nodes);
    let count = element.nodes().len();
    let mut mass = SectionMatrix::zeros();
    for &(xi, eta, weight) in kind.rule() {
        let (_, det) = gradients(kind, &places, xi, eta);
        let values = kind.values(xi, eta);
        for i in 0..count {
            for j in 0..count {
                for c in 0..COMPONENTS {
                    mass[(3 * i + c, 3 * j + c)] += weight * det * values[i] * values[j];
                }
            }
        }
    }
    let turn = cartesian_by_polar(&places[..count]);
    turn.transpose() * mass * turn
}

/// The components along x, y and the axis at `places` by those along e_r, e_t and the axis.
fn cartesian_by_polar(places: &[Vector]) -> SectionMatrix {
    let mut turn = SectionMatrix::identity();
    for (i, place) in places.iter().enumerate() {
        let radius = place.norm();
        let (sin, cos) = (place.y / radius, place.x / radius);
        turn[(3 * i, 3 * i)] = cos;
        turn[(3 * i, 3 * i + 1)] = -sin;
        turn[(3 * i + 1, 3 * i)] = sin;
        turn[(3 * i + 1, 3 * i + 1)] = cos;
    }
    turn
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: f64 = 10e-3;

    /// The displacement at (x, y, z).
    type Motion = fn(f64, f64, f64) -> [f64; 3];

    /// A square of side 8 mm about the axis, of nine elements: no node stands on the axis.
    fn square() -> Grid {
        let mut nodes = Vec::new();
        let mut number = [[0_u32; 7]; 7];
        for (j, row) in number.iter_mut().enumerate() {
            for (i, place) in row.iter_mut().enumerate() {
                if i % 2 == 0 || j % 2 == 0 {
                    *place = nodes.len() as u32;
                    let at = |k: usize| 8e-3 * (k as f64 / 6.0 - 0.5);
                    nodes.push(Vector::new(at(i), at(j)));
                }
            }
        }
        let mut elements = Vec::new();
        for j in [0, 2, 4] {
            for i in [0, 2, 4] {
                let n = |a: usize, b: usize| number[j + b][i + a];
                elements.push(Element::quadrilateral([
                    n(0, 0),
                    n(2, 0),
                    n(2, 2),
                    n(0, 2),
                    n(1, 0),
                    n(2, 1),
                    n(1, 2),
                    n(0, 1),
                ]));
            }
        }
        Grid { nodes, elements }
    }

    /// The unknowns of the displacement `u` of the material at (x, y, z) of a body whose section turns by `twist`.
    fn unknowns(prism: &Prism<'_>, u: impl Fn(f64, f64, f64) -> [f64; 3]) -> Vec<f64> {
        let m = prism.axial.len();
        let mut all = vec![0.0; prism.grid.nodes.len() * 3 * m];
        for (i, place) in prism.grid.nodes.iter().enumerate() {
            let (radius, angle) = (place.norm(), place.y.atan2(place.x));
            for (z, w) in prism.axial.rule(40) {
                let (sin, cos) = (angle + prism.twist * z).sin_cos();
                let [ux, uy, uz] = u(radius * cos, radius * sin, z);
                let polar = [cos * ux + sin * uy, cos * uy - sin * ux, uz];
                for (p, f) in prism.axial.values(z).into_iter().enumerate() {
                    for (c, u) in polar.into_iter().enumerate() {
                        all[(3 * i + c) * m + p] += w * f * u;
                    }
                }
            }
        }
        all
    }

    /// The energy ½ uᵀ K u of the displacements `u` of all nodes, node by node.
    fn energy(prism: &Prism<'_>, u: &[f64]) -> f64 {
        let size = prism.unknowns_of_node();
        let mut energy = 0.0;
        let mut between = vec![0.0; size * size];
        prism.each_element(&mut |element, fill| {
            for (b, column_node) in element.nodes().iter().enumerate() {
                for (a, node) in element.nodes().iter().enumerate() {
                    fill([a, b], &mut between);
                    let [rows, columns] = [*node, *column_node].map(|node| size * node as usize);
                    for (c, column) in between.chunks_exact(size).enumerate() {
                        for (r, k) in column.iter().enumerate() {
                            energy += 0.5 * u[rows + r] * k * u[columns + c];
                        }
                    }
                }
            }
        });
        energy
    }

    #[test]
    fn rigid_motions_strain_nothing() {
        let square = square();
        for twist in [0.0, 8.55, -20.0] {
            for axial in [
                AxialBasis::new(&[-HALF, HALF], 8),
                AxialBasis::new(&[-HALF, -2.5e-3, HALF], 6),
            ] {
                let prism = Prism {
                    grid: &square,
                    material: &Material::STEEL,
                    twist,
                    axial: &axial,
                };
                // A stretch as large as the motions.
                let strained = energy(&prism, &unknowns(&prism, |x, _, _| [x, 0.0, 0.0]));
                let motions: [Motion; 5] = [
                    |_, _, _| [1e-3, 0.0, 0.0],
                    |_, _, _| [0.0, 0.0, 1e-3],
                    |x, y, _| [-y, x, 0.0],
                    |_, y, z| [0.0, -z, y],
                    |x, _, z| [z, 0.0, -x],
                ];
                for motion in motions {
                    let energy = energy(&prism, &unknowns(&prism, motion));
                    assert!(energy.abs() < 1e-12 * strained, "{energy:e} {strained:e}");
                }
            }
        }
    }

    #[test]
    fn a_twisted_bar_is_as_stiff_in_tension_bending_and_torsion_as_its_closed_form() {
        // The same motions of the material, whose section turns: the moments of a square are equal in all directions. The
        // energies of bending and tension are those of free sides; that of torsion is of sections that stay plane.
        let grid = square();
        let side = 8e-3_f64;
        let (area, moment) = (side * side, side.powi(4) / 12.0);
        let (e, nu, g) = (210e9, 0.3, Material::STEEL.shear_modulus());
        for twist in [0.0, 12.0] {
            let axial = AxialBasis::new(&[-HALF, HALF], 9);
            let prism = Prism {
                grid: &grid,
                material: &Material::STEEL,
                twist,
                axial: &axial,
            };
            let energy =
                |u: &dyn Fn(f64, f64, f64) -> [f64; 3]| energy(&prism, &unknowns(&prism, u));
            let tension = energy(&|x, y, z| [-nu * x, -nu * y, z]);
            let bending =
                energy(&|x, y, z| [-(z * z + nu * (x * x - y * y)) / 2.0, -nu * x * y, x * z]);
            let torsion = energy(&|x, y, z| [-y * z, x * z, 0.0]);
            for (found, expected) in [
                (tension, e * area * HALF),
                (bending, e * moment * HALF),
                (torsion, g * 2.0 * moment * HALF),
            ] {
                assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
            }
        }
    }

    #[test]
    fn even_and_odd_motions_of_a_straight_body_are_separated_and_give_the_same_result() {
        let grid = square();
        let axial = AxialBasis::new(&[-7e-3, 13e-3], 4);
        // A turn that nobody feels keeps them together.
        let [apart, together] = [0.0, 1e-9].map(|twist| {
            let prism = Prism {
                grid: &grid,
                material: &Material::STEEL,
                twist,
                axial: &axial,
            };
            assert_eq!(prism.independent().len(), if twist == 0.0 { 2 } else { 1 });
            let interface = Interface {
                kept: &[0, 1, 5],
                fixed: &[30, 31, 32],
                ..Default::default()
            };
            let points = [(12, [0.6, -0.3, 0.7]), (20, [0.0, 1.0, 0.0])];
            let made = prism.condense("a bar", &interface, &points, &[13, 5, 25]);
            made.expect("definite")
        });
        let matrices = |(condensed, rows): &(CondensedPrism, NodeRows)| {
            [
                condensed.stiffness.clone(),
                condensed.rows.clone(),
                condensed.held.clone(),
                rows.by_kept.clone(),
                rows.by_points.clone(),
            ]
        };
        for (one, other) in matrices(&apart).iter().zip(&matrices(&together)) {
            assert!(one.norm_max() > 0.0);
            assert!((one - other).norm_max() < 1e-8 * one.norm_max());
        }
    }

    #[test]
    fn a_bar_pulled_at_its_end_gives_as_much_as_by_hooke_though_its_section_turns() {
        // Both ends are free; a force along the axis at z, spread over the section, is balanced by springs at the other end: so
        // the bar is held along the axis at the nodes of one corner only in the mean. Instead, hold nothing and compare the energy
        // of the answer to a self-balanced pull: end forces ±F give F² 2h/(2 E A).
        let grid = square();
        let axial = AxialBasis::new(&[-HALF, HALF], 6);
        let prism = Prism {
            grid: &grid,
            material: &Material::STEEL,
            twist: 12.0,
            axial: &axial,
        };
        let kept: Vec<u32> = (0..grid.nodes.len() as u32).collect();
        let k = prism
            .condense(
                "a bar",
                &Interface {
                    kept: &kept,
                    ..Default::default()
                },
                &[],
                &[],
            )
            .expect("definite")
            .0
            .stiffness;
        // Consistent loads of a uniform stress on both ends.
        let m = axial.len();
        let (low, high) = (axial.values(-HALF), axial.values(HALF));
        let mut load = vec![0.0; k.nrows()];
        for element in &grid.elements {
            let places = element.places(&grid.nodes);
            for &(xi, eta, w) in element.kind().rule() {
                let (_, det) = gradients(element.kind(), &places, xi, eta);
                for (n, node) in element.kind().values(xi, eta).iter().zip(element.nodes()) {
                    for p in 0..m {
                        load[(3 * *node as usize + 2) * m + p] +=
                            w * det * n * (high[p] - low[p]) * 1e6;
                    }
                }
            }
        }
        // Weak springs take the rigid motions, which the load does not move.
        let spring = 1e-6 * k.norm_max();
        let held = Mat::from_fn(k.nrows(), k.nrows(), |i, j| {
            k[(i, j)] + if i == j { spring } else { 0.0 }
        });
        let mut u = Mat::from_fn(k.nrows(), 1, |i, _| load[i]);
        crate::fem::dense::Cholesky::new(held)
            .expect("definite")
            .solve_in_place(u.as_mut());
        let work: f64 = (0..k.nrows()).map(|i| u[(i, 0)] * load[i]).sum();
        // σ²/E per volume.
        let expected = 1e12 / 210e9 * 64e-6 * 2.0 * HALF;
        assert!((work / expected - 1.0).abs() < 2e-3, "{work} {expected}");
    }
}
