//! Functionals of the displacements of a grid: a displacement, a stress.
//!
//! A substructure that is condensed together with functionals offers them as rows on its ports
//! ([`super::condensation::condense`]); displacement and stress then need no second solution.
//!
//! From the contact forces of one position to the stresses of a gear:
//!
//! 1. The contact gives each loaded tooth j its forces p_j on the flank's unknowns: along the outward normal, so pressure is
//!    negative, and towards the tip, node by node.
//! 2. m_j = Vᵀ p_j are its modal loads ([`crate::ring::tooth::modal_loads`]).
//! 3. q = C Σ_j F_j m_j is the motion of the interface circle ([`crate::ring::motion::InterfaceMotion::under`]).
//! 4. Along the fillet of tooth i: [`crate::ring::teeth_recovery::TeethRecovery::values`] of p_i, all m_j and q, for the
//!    [`edge_stresses`] of [`crate::grid::ToothGrid::fillet_nodes`].
//! 5. Along the edge of a hole: [`crate::ring::blank::BlankRecovery::values`] of q, for the [`edge_stresses`] of
//!    [`crate::grid::BlankGrid::hole_edges`].
//!
//! On a free edge the von Mises stress is the absolute value of the stress along it. Elsewhere, and on loaded edges, take
//! [`nodal_stresses`]; for the displacement of a node, [`Functional::displacement`].

use super::element::gradients;
use super::law::Law;
use crate::gear::{Material, Vector};
use crate::grid::{Element, Grid};

/// A linear functional Σ w·u of the displacements u of some nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Functional {
    terms: Vec<(u32, Vector)>,
}

impl Functional {
    /// The sum of w·u over the (node, w) in `terms`.
    pub fn new(terms: Vec<(u32, Vector)>) -> Self {
        Self { terms }
    }

    /// The displacement of `node` along `direction`.
    pub fn displacement(node: u32, direction: Vector) -> Self {
        Self::new(vec![(node, direction)])
    }

    /// The nodes and their weights w.
    pub fn terms(&self) -> &[(u32, Vector)] {
        &self.terms
    }

    /// The value for the displacements `u` of all nodes.
    pub fn value(&self, u: &[Vector]) -> f64 {
        let terms = self.terms.iter();
        terms
            .map(|(node, weight)| weight.dot(&u[*node as usize]))
            .sum()
    }
}

/// The stress in Pa along a free edge at each of its nodes: positive is tension.
///
/// `edge` has corners and midsides in turn, beginning with a corner; a closed one without its first node again at the end.
/// On a free edge the stress across it vanishes, so that the one along it is E times the strain there, the derivative of the
/// displacement by the length: at a corner the mean of both sides of it.
///
/// # Panics
///
/// If a closed edge has an odd number of nodes, or an open one an even number.
pub fn edge_stresses(
    grid: &Grid,
    material: &Material,
    edge: &[u32],
    closed: bool,
) -> Vec<Functional> {
    assert_eq!(
        edge.len() % 2,
        usize::from(!closed),
        "corners and midsides in turn"
    );
    let count = edge.len();
    let mut strains: Vec<Vec<(u32, Vector)>> = vec![Vec::new(); count];
    for first in (0..count - usize::from(!closed)).step_by(2) {
        let places = [first, first + 1, (first + 2) % count];
        let nodes = places.map(|place| edge[place]);
        let points = nodes.map(|node| grid.nodes[node as usize]);
        // The derivatives of the three shape functions at −1, 0 and 1.
        let slopes = [[-1.5, 2.0, -0.5], [-0.5, 0.0, 0.5], [0.5, -2.0, 1.5]];
        for (place, slopes) in places.into_iter().zip(slopes) {
            let tangent: Vector = points.iter().zip(slopes).map(|(p, s)| *p * s).sum();
            let inner = place % 2 == 1 || !closed && (place == 0 || place + 1 == count);
            let share = if inner { 1.0 } else { 0.5 };
            let weight = share * material.youngs_modulus / tangent.norm_squared();
            let of_nodes = nodes.iter().zip(slopes);
            strains[place].extend(of_nodes.map(|(node, slope)| (*node, weight * slope * tangent)));
        }
    }
    strains.into_iter().map(Functional::new).collect()
}

/// The stresses (σ_xx, σ_yy, τ_xy) in Pa at every node for the displacements `u` of all: the mean over the elements that meet there.
pub(crate) fn stresses(grid: &Grid, material: &Material, u: &[Vector]) -> Vec<[f64; 3]> {
    let mut sums = vec![([0.0; 3], 0.0); grid.nodes.len()];
    for element in &grid.elements {
        for (local, node) in element.nodes().iter().enumerate() {
            let (sum, meeting) = &mut sums[*node as usize];
            *meeting += 1.0;
            for (node, weights) in stress_at(grid, material, element, local) {
                for (stress, weight) in sum.iter_mut().zip(weights) {
                    *stress += weight.dot(&u[node as usize]);
                }
            }
        }
    }
    sums.into_iter()
        .map(|(sum, meeting)| sum.map(|stress| stress / f64::max(meeting, 1.0)))
        .collect()
}

/// The stresses of `element` at its node `local`: the weights of the displacement of each of its nodes in each stress.
fn stress_at(
    grid: &Grid,
    material: &Material,
    element: &Element,
    local: usize,
) -> impl Iterator<Item = (u32, [Vector; 3])> {
    let law = Law::plane_stress(material);
    let (xi, eta) = element.kind().node_places()[local];
    let (gradient, _) = gradients(element.kind(), &element.places(&grid.nodes), xi, eta);
    let nodes = element.nodes().iter().copied().zip(gradient);
    nodes.map(move |(node, (by_x, by_y))| {
        let weights = [
            Vector::new(law.along * by_x, law.across * by_y),
            Vector::new(law.across * by_x, law.along * by_y),
            law.shear * Vector::new(by_y, by_x),
        ];
        (node, weights)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::condensation::tests::patch;

    /// The patch of distorted quadrilaterals, and the same cut into triangles.
    fn patches() -> [Grid; 2] {
        let quadrilaterals = patch();
        let mut triangles = quadrilaterals.clone();
        triangles.elements.clear();
        for element in &quadrilaterals.elements {
            let [a, b, c, d, ab, bc, cd, da] = std::array::from_fn(|i| element.nodes()[i]);
            let middle = (triangles.nodes[a as usize] + triangles.nodes[c as usize]) / 2.0;
            let ac = triangles.nodes.len() as u32;
            triangles.nodes.push(middle);
            triangles
                .elements
                .push(Element::triangle([a, b, c, ab, bc, ac]));
            triangles
                .elements
                .push(Element::triangle([a, c, d, ac, cd, da]));
        }
        [quadrilaterals, triangles]
    }

    #[test]
    fn a_linear_field_has_its_constant_stress_at_every_node() {
        let (exx, eyy, gxy, nu) = (1e-3, -0.4e-3, 0.7e-3, 0.3);
        let d = 210e9 / (1.0 - nu * nu);
        let expected = [
            d * (exx + nu * eyy),
            d * (eyy + nu * exx),
            210e9 / (2.0 * (1.0 + nu)) * gxy,
        ];
        for grid in patches() {
            let field =
                |p: &Vector| Vector::new(exx * p.x + 0.2 * gxy * p.y, eyy * p.y + 0.8 * gxy * p.x);
            let u: Vec<Vector> = grid.nodes.iter().map(field).collect();
            for found in stresses(&grid, &Material::STEEL, &u) {
                for (stress, expected) in found.iter().zip(expected) {
                    assert!((stress - expected).abs() < 1e-9 * d * exx);
                }
            }
        }
    }

    #[test]
    fn the_stress_along_a_free_edge_is_that_of_uniaxial_tension_along_it() {
        // Along x the strain is σ/E, across it −ν σ/E: an edge that runs along x is free.
        let sigma = 100e6;
        let grid = Grid {
            nodes: (0..5)
                .map(|i| Vector::new(1e-3 * f64::from(i), 2e-3))
                .collect(),
            elements: Vec::new(),
        };
        let strain = sigma / 210e9;
        let field = |p: &Vector| Vector::new(strain * p.x + 1e-6, -0.3 * strain * p.y);
        let u: Vec<Vector> = grid.nodes.iter().map(field).collect();
        for stress in edge_stresses(&grid, &Material::STEEL, &[0, 1, 2, 3, 4], false) {
            assert!((stress.value(&u) / sigma - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_strain_of_a_growing_ring_is_axisymmetric() {
        let count = 24;
        let at = |i: i32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
            1e-2 * Vector::new(angle.cos(), angle.sin())
        };
        let grid = Grid {
            nodes: (0..count).map(at).collect(),
            elements: Vec::new(),
        };
        let u: Vec<Vector> = grid.nodes.iter().map(|p| 1e-3 * p).collect();
        let edge: Vec<u32> = (0..count as u32).collect();
        for stress in edge_stresses(&grid, &Material::STEEL, &edge, true) {
            assert!((stress.value(&u) / 210e6 - 1.0).abs() < 1e-12);
        }
    }
}
