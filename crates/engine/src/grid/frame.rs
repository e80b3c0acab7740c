//! The lattice of lines of equal radius and of equal angle that a sector is filled between.

use super::BlankGrid;
use super::block::{Edge, GridBuilder};
use crate::gear::{Vector, radial};

/// The rectangles into which lines of equal radius and lines of equal angle cut the sector.
pub(super) struct Frame {
    /// The edges along the radius: by interval of the radius, then by line of equal angle.
    pub(super) rays: Vec<Vec<Edge>>,
    /// The edges along the angle: by line of equal radius, then by interval of the angle.
    pub(super) arcs: Vec<Vec<Edge>>,
}

impl Frame {
    /// The lattice of lines at the given radii and angles in the chart; edges along the radius by interval of it, edges along
    /// the angle by line of equal radius and interval of the angle.
    pub(super) fn new(
        builder: &mut GridBuilder,
        lines: (&[f64], &[f64]),
        ray_fractions: &[Vec<f64>],
        arc_fractions: &[Vec<Vec<f64>>],
    ) -> Self {
        let (radii, angles) = lines;
        let vertices: Vec<Vec<u32>> = radii
            .iter()
            .map(|x| {
                angles
                    .iter()
                    .map(|t| builder.node(Vector::new(*x, *t)))
                    .collect()
            })
            .collect();
        let rays = (0..radii.len() - 1)
            .map(|row| {
                (0..angles.len())
                    .map(|c| {
                        builder.straight(
                            vertices[row][c],
                            vertices[row + 1][c],
                            &ray_fractions[row],
                        )
                    })
                    .collect()
            })
            .collect();
        let arcs = (0..radii.len())
            .map(|row| {
                (0..angles.len() - 1)
                    .map(|c| {
                        builder.straight(
                            vertices[row][c],
                            vertices[row][c + 1],
                            &arc_fractions[row][c],
                        )
                    })
                    .collect()
            })
            .collect();
        Self { rays, arcs }
    }

    /// Fills one of the rectangles.
    pub(super) fn fill(&self, builder: &mut GridBuilder, row: usize, column: usize) {
        builder.block(
            &self.rays[row][column],
            &self.arcs[row + 1][column],
            &self.rays[row][column + 1],
            &self.arcs[row][column],
        );
    }

    /// All nodes along one line of equal angle.
    fn ray(&self, column: usize) -> Edge {
        chain(self.rays.iter().map(|row| &row[column]))
    }

    /// All nodes along one line of equal radius.
    fn arc(&self, row: usize) -> Edge {
        chain(self.arcs[row].iter())
    }

    /// The finished blank: its edges are those of the frame.
    pub(super) fn blank(
        &self,
        builder: GridBuilder,
        interface_radius: f64,
        sector_count: u32,
        hole_edges: Vec<Edge>,
    ) -> BlankGrid {
        let inner = |edge: Edge| edge[1..edge.len() - 1].to_vec();
        let arc_nodes = self.arc(self.arcs.len() - 1);
        BlankGrid {
            sector_count,
            arc_angles: arc_nodes.iter().map(|n| builder.point(*n).y).collect(),
            arc_nodes,
            bore_nodes: self.arc(0),
            side_nodes: (inner(self.ray(0)), inner(self.ray(self.arcs[0].len()))),
            hole_edges,
            grid: builder.finish(|p| interface_radius * p.x.exp() * radial(p.y)),
        }
    }
}

/// Edges that follow one another, as one.
fn chain<'a>(edges: impl Iterator<Item = &'a Edge>) -> Edge {
    let mut whole = Edge::new();
    for edge in edges {
        let repeated = usize::from(!whole.is_empty());
        whole.extend(&edge[repeated..]);
    }
    whole
}
