//! The body forces of a grid that rotates about the origin.

use super::element::gradients;
use super::recovery::Functional;
use crate::gear::{Material, Vector};
use crate::grid::Grid;

/// The centrifugal forces ∫ N ρ t r dA on the nodes of `grid` for ω² = 1 in 1/s², by the work that they do.
///
/// `thickness` t, in meters, is that of an element whose own is 1.
pub(crate) fn centrifugal(grid: &Grid, material: &Material, thickness: f64) -> Functional {
    let mut forces = vec![Vector::zeros(); grid.nodes.len()];
    for element in &grid.elements {
        let (kind, nodes) = (element.kind(), element.places(&grid.nodes));
        for &(xi, eta, weight) in kind.rule() {
            let (_, det) = gradients(kind, &nodes, xi, eta);
            let values = kind.values(xi, eta);
            let place: Vector = nodes.iter().zip(values).map(|(p, n)| *p * n).sum();
            let mass = weight * det * material.density * thickness * element.thickness();
            for (node, n) in element.nodes().iter().zip(values) {
                forces[*node as usize] += mass * n * place;
            }
        }
    }
    Functional::new((0..).zip(forces).collect())
}
