//! Structured blocks that share their edges.

use super::{Element, Grid};
use crate::gear::Vector;

/// The node numbers along the side of a block: corner, midside, corner, and so on.
pub(super) type Edge = Vec<u32>;

/// A grid in the making.
///
/// Blocks that name the same edge share its nodes; nothing is merged by position.
#[derive(Debug)]
pub(super) struct GridBuilder {
    nodes: Vec<Vector>,
    elements: Vec<Element>,
    /// The thickness of the next blocks, as a part of the body's.
    pub(super) thickness: f64,
}

impl Default for GridBuilder {
    /// Nothing yet, of the body's own thickness.
    fn default() -> Self {
        Self {
            nodes: Vec::new(),
            elements: Vec::new(),
            thickness: 1.0,
        }
    }
}

impl GridBuilder {
    /// A new node.
    pub(super) fn node(&mut self, point: Vector) -> u32 {
        let number = self.nodes.len() as u32;
        self.nodes.push(point);
        number
    }

    /// The place of a node.
    pub(super) fn point(&self, node: u32) -> Vector {
        self.nodes[node as usize]
    }

    /// An edge between two nodes, with new nodes at the points of `curve` except its first and last.
    pub(super) fn curve(&mut self, from: u32, to: u32, curve: &[Vector]) -> Edge {
        let inner = curve.iter().take(curve.len().saturating_sub(1)).skip(1);
        let mut edge = vec![from];
        for point in inner {
            edge.push(self.node(*point));
        }
        edge.push(to);
        edge
    }

    /// A straight edge between two nodes, divided at `fractions`.
    pub(super) fn straight(&mut self, from: u32, to: u32, fractions: &[f64]) -> Edge {
        let (p, q) = (self.point(from), self.point(to));
        let points: Vec<_> = fractions.iter().map(|f| p * (1.0 - f) + q * *f).collect();
        self.curve(from, to, &points)
    }

    /// A block between four edges, its inner nodes by transfinite interpolation.
    ///
    /// `bottom` and `top` both run from `left` to `right`; these run from bottom to top; seen from the bottom edge, the
    /// block lies on the left. The interpolation is that of Gordon and Hall, with the coordinates u and v taken where the
    /// straight lines between arc-length fractions of opposite edges cross, so that gradings carry over.
    pub(super) fn block(&mut self, bottom: &[u32], right: &[u32], top: &[u32], left: &[u32]) {
        let points =
            |edge: &[u32]| -> Vec<Vector> { edge.iter().map(|n| self.point(*n)).collect() };
        let (b, r, t, l) = (points(bottom), points(right), points(top), points(left));
        let (s_b, s_t, t_l, t_r) = (lengths(&b), lengths(&t), lengths(&l), lengths(&r));
        let (m, n) = (b.len() - 1, l.len() - 1);
        self.fill(bottom, right, top, left, |i, j| {
            let (ds, dt) = (s_t[i] - s_b[i], t_r[j] - t_l[j]);
            let u = (s_b[i] + t_l[j] * ds) / (1.0 - ds * dt);
            let v = t_l[j] + u * dt;
            (1.0 - v) * b[i] + v * t[i] + (1.0 - u) * l[j] + u * r[j]
                - (1.0 - u) * ((1.0 - v) * b[0] + v * t[0])
                - u * ((1.0 - v) * b[m] + v * t[m])
        });
        debug_assert_eq!((t.len() - 1, r.len() - 1), (m, n));
    }

    /// A block between two straight edges, `bottom` and `top`: each inner node on the straight line from a node of `left`
    /// to the opposite one of `right`.
    ///
    /// Where `left` and `right` come close to each other this keeps the lines between them, which an interpolation from
    /// all four edges would shear if `bottom` and `top` are divided differently.
    pub(super) fn ruled(&mut self, bottom: &[u32], right: &[u32], top: &[u32], left: &[u32]) {
        let points =
            |edge: &[u32]| -> Vec<Vector> { edge.iter().map(|n| self.point(*n)).collect() };
        let (s_b, s_t) = (lengths(&points(bottom)), lengths(&points(top)));
        let (l, r) = (points(left), points(right));
        let last = (l.len() - 1) as f64;
        self.fill(bottom, right, top, left, |i, j| {
            let u = s_b[i] + (s_t[i] - s_b[i]) * j as f64 / last;
            (1.0 - u) * l[j] + u * r[j]
        });
    }

    /// A block between four edges, with its inner nodes where `place` puts lattice point (i, j).
    pub(super) fn fill(
        &mut self,
        bottom: &[u32],
        right: &[u32],
        top: &[u32],
        left: &[u32],
        place: impl Fn(usize, usize) -> Vector,
    ) {
        debug_assert_eq!((bottom.len(), left.len()), (top.len(), right.len()));
        debug_assert_eq!(
            (bottom.first(), bottom.last()),
            (left.first(), right.first())
        );
        debug_assert_eq!((top.first(), top.last()), (left.last(), right.last()));
        let (m, n) = (bottom.len() - 1, left.len() - 1);
        let mut lattice = vec![0; (m + 1) * (n + 1)];
        for j in 0..=n {
            for i in 0..=m {
                lattice[j * (m + 1) + i] = match (i, j) {
                    (i, 0) => bottom[i],
                    (i, j) if j == n => top[i],
                    (0, j) => left[j],
                    (i, j) if i == m => right[j],
                    // The eight-node element has no node at its center.
                    (i, j) if i % 2 == 1 && j % 2 == 1 => u32::MAX,
                    (i, j) => self.node(place(i, j)),
                };
            }
        }
        let at = |i: usize, j: usize| lattice[j * (m + 1) + i];
        let elements = quadrilaterals(m, n, at);
        self.elements
            .extend(elements.map(|element| element.of_thickness(self.thickness)));
    }

    /// The grid, with every node moved to its image under `map`.
    pub(super) fn finish(self, map: impl Fn(Vector) -> Vector) -> Grid {
        Grid {
            nodes: self.nodes.into_iter().map(map).collect(),
            elements: self.elements,
        }
    }
}

/// The elements between the nodes `at` lattice points (i, j), 0 ≤ i ≤ `m`, 0 ≤ j ≤ `n`, corners where both are even.
pub(super) fn quadrilaterals(
    m: usize,
    n: usize,
    at: impl Fn(usize, usize) -> u32,
) -> impl Iterator<Item = Element> {
    let corners = (0..n)
        .step_by(2)
        .flat_map(move |j| (0..m).step_by(2).map(move |i| (i, j)));
    corners.map(move |(i, j)| {
        Element::quadrilateral([
            at(i, j),
            at(i + 2, j),
            at(i + 2, j + 2),
            at(i, j + 2),
            at(i + 1, j),
            at(i + 2, j + 1),
            at(i + 1, j + 2),
            at(i, j + 1),
        ])
    })
}

/// The same edge from its other end.
pub(super) fn backwards(edge: &[u32]) -> Edge {
    edge.iter().rev().copied().collect()
}

/// The length from the first point to each, as a fraction of the whole.
fn lengths(points: &[Vector]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut lengths = vec![0.0];
    for pair in points.windows(2) {
        sum += (pair[1] - pair[0]).norm();
        lengths.push(sum);
    }
    for length in &mut lengths {
        *length /= sum;
    }
    lengths
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::division::uniform;

    #[test]
    fn two_blocks_with_an_edge_in_common_share_its_nodes_and_tile_their_rectangle() {
        let mut builder = GridBuilder::default();
        let at = |builder: &mut GridBuilder, x, y| builder.node(Vector::new(x, y));
        let corners = [
            (0.0, 0.0),
            (2.0, 0.0),
            (3.0, 0.0),
            (0.0, 1.0),
            (2.0, 1.0),
            (3.0, 1.0),
        ]
        .map(|(x, y)| at(&mut builder, x, y));
        let (two, three) = (uniform(2), uniform(3));
        let mut edge = |a: usize, b: usize, f: &[f64]| builder.straight(corners[a], corners[b], f);
        let (b_1, b_2) = (edge(0, 1, &two), edge(1, 2, &two));
        let (t_1, t_2) = (edge(3, 4, &two), edge(4, 5, &two));
        let (l, shared, r) = (edge(0, 3, &three), edge(1, 4, &three), edge(2, 5, &three));
        builder.block(&b_1, &shared, &t_1, &l);
        builder.block(&b_2, &r, &t_2, &shared);
        let grid = builder.finish(|p| p);
        // Of the 9 by 7 lattice the 4 by 3 cell centers carry no node.
        assert_eq!((grid.nodes.len(), grid.elements.len()), (63 - 12, 12));
        assert!((grid.area() - 3.0).abs() < 1e-14);
    }
}
