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

use std::rc::Rc;

use nalgebra::SMatrix;

use super::axial::{AxialBasis, AxialMatrices};
use super::body::Body;
use super::element::gradients;
use super::law::Law;
use super::recovery::Functional;
use crate::gear::{Material, Vector};
use crate::grid::element::MOST_NODES;
use crate::grid::{Element, Grid};

/// The components of the displacement of a node: radial, tangential, axial.
pub const COMPONENTS: usize = 3;

/// The last of them.
const AXIAL: usize = 2;

/// The unknowns of an element for one function along the axis.
const UNKNOWNS: usize = COMPONENTS * MOST_NODES;

type SectionMatrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
type Strains = SMatrix<f64, 6, UNKNOWNS>;

/// A body whose every section is `grid`, turned.
#[derive(Debug, Clone, Copy)]
pub struct Prism<'a> {
    /// The section at z = 0.
    pub grid: &'a Grid,
    /// What it is made of.
    pub material: &'a Material,
    /// τ: the turn of the section per length, in radians a meter.
    pub twist: f64,
    /// The functions along the axis.
    pub axial: &'a AxialBasis,
}

/// The matrices of one element: K_00, K_01 and K_11 on polar components at its nodes.
struct SectionMatrices {
    plain: SectionMatrix,
    mixed: SectionMatrix,
    axial: SectionMatrix,
}

impl Prism<'_> {
    /// The displacement at each of `points`, a node and a direction in polar components, for every function along the axis.
    pub fn along(&self, points: &[(u32, [f64; COMPONENTS])]) -> Vec<Functional> {
        let functions = self.axial.len();
        let each = |&(node, direction): &(u32, [f64; COMPONENTS])| {
            (0..functions).map(move |p| {
                let components = direction.into_iter().enumerate();
                let terms = components.map(|(c, along)| (node, c * functions + p, along));
                Functional::of_unknowns(terms.collect())
            })
        };
        points.iter().flat_map(each).collect()
    }
}

impl Body for Prism<'_> {
    fn grid(&self) -> &Grid {
        self.grid
    }

    fn unknowns_of_node(&self) -> usize {
        COMPONENTS * self.axial.len()
    }

    fn scale(&self) -> f64 {
        self.material.youngs_modulus
    }

    fn stiffnesses(&self) -> impl Iterator<Item = impl Fn(usize, usize) -> f64> {
        let law = Law::in_space(self.material);
        let matrices = Rc::new(self.axial.matrices());
        let functions = self.axial.len();
        self.grid.elements.iter().map(move |element| {
            let matrices = Rc::clone(&matrices);
            let SectionMatrices {
                plain,
                mixed,
                axial,
            } = section_matrices(element, self.grid, &law, self.twist);
            move |i: usize, j: usize| {
                let AxialMatrices { slope, slopes } = &*matrices;
                let ((a, p), (b, q)) = (
                    (i / functions, i % functions),
                    (j / functions, j % functions),
                );
                let same = if p == q { plain[(a, b)] } else { 0.0 };
                same + mixed[(a, b)] * slope[(p, q)]
                    + mixed[(b, a)] * slope[(q, p)]
                    + axial[(a, b)] * slopes[(p, q)]
            }
        })
    }

    /// A straight body is its own image in its middle: what is even in the plane and odd along the axis has nothing to do with the opposite.
    fn independent(&self) -> Vec<Vec<usize>> {
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
}

fn section_matrices(element: &Element, grid: &Grid, law: &Law, twist: f64) -> SectionMatrices {
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
    let mut turn = SectionMatrix::identity();
    for (i, place) in places.iter().enumerate().take(count) {
        let (sin, cos) = {
            let radius = place.norm();
            (place.y / radius, place.x / radius)
        };
        // (x, y) by (r, t).
        turn[(3 * i, 3 * i)] = cos;
        turn[(3 * i, 3 * i + 1)] = -sin;
        turn[(3 * i + 1, 3 * i)] = sin;
        turn[(3 * i + 1, 3 * i + 1)] = cos;
    }
    for matrix in [
        &mut matrices.plain,
        &mut matrices.mixed,
        &mut matrices.axial,
    ] {
        *matrix = turn.transpose() * *matrix * turn;
    }
    matrices
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;
    use crate::fem::Interface;
    use crate::fem::condensation::{Rows, condense};

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
        for (element, k) in prism.grid.elements.iter().zip(prism.stiffnesses()) {
            let place = |i: usize| size * element.nodes()[i / size] as usize + i % size;
            let count = size * element.nodes().len();
            for j in 0..count {
                for i in 0..count {
                    energy += 0.5 * u[place(i)] * k(i, j) * u[place(j)];
                }
            }
        }
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
        // The same motions of the material, whose section turns: the moments of a square are alike in all directions. The
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
    fn even_and_odd_motions_of_a_straight_body_apart_make_the_same_of_it_as_together() {
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
            let (points, nodes) = (
                prism.along(&points),
                Functional::unknowns(&[13, 5, 25], prism.unknowns_of_node()),
            );
            let condensed = condense("a bar", &prism, &interface).expect("definite");
            (condensed.stiffness(), condensed.rows(&points, &nodes))
        });
        let matrices = |(stiffness, rows): &(Mat<f64>, [Rows; 2])| {
            let rows = rows.iter();
            let rows = rows.flat_map(|of| [of.by_kept.clone(), of.by_forces.clone()]);
            [stiffness.clone()]
                .into_iter()
                .chain(rows)
                .collect::<Vec<_>>()
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
        let interface = Interface {
            kept: &kept,
            ..Default::default()
        };
        let condensed = condense("a bar", &prism, &interface);
        let k = condensed.expect("definite").stiffness();
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
