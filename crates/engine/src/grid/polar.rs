//! Rings divided along circles and rays.

use super::block::quadrilaterals;
use super::planar::Grid;
use crate::gear::radial;

impl Grid {
    /// A ring of quadrilaterals with nodes on `radii` at `angles`, corners and middles in turn: circle by circle, on those between corners alone.
    pub fn polar(radii: &[f64], angles: &[f64]) -> Self {
        let count = angles.len();
        let mut nodes = Vec::new();
        let mut first = Vec::new();
        for (i, radius) in radii.iter().enumerate() {
            first.push(nodes.len());
            let of_circle = angles.iter().step_by(1 + i % 2);
            nodes.extend(of_circle.map(|angle| *radius * radial(*angle)));
        }
        let node = |i: usize, j: usize| {
            let of_circle = j % count / (1 + i % 2);
            (first[i] + of_circle) as u32
        };
        let elements = quadrilaterals(radii.len() - 1, count, node).collect();
        Self { nodes, elements }
    }
}
