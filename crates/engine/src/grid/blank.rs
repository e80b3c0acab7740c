//! The grid of a blank, from the bore to the interface circle.

use super::{Element, Grid};
use crate::gear::{Vector, radial, tangential};

/// The grid of a blank, or of one of the equal sectors that make it up.
///
/// A sector stands in a frame whose x axis runs through its middle: through the center of the hole, if there is one. A whole
/// blank stands in the frame of its gear, has one sector and no sides.
#[derive(Debug, Clone, PartialEq)]
pub struct BlankGrid {
    /// The elements.
    pub grid: Grid,
    /// The number n of sectors that make up the blank: one for each hole of a pattern, one for each tooth of a blank without
    /// holes, 1 for any other.
    pub sector_count: u32,
    /// The nodes on the interface circle, corners and midsides, from −π/n to π/n; of a whole blank without sides up to but
    /// without π.
    pub arc_nodes: Vec<u32>,
    /// The polar angle of each of these.
    pub arc_angles: Vec<f64>,
    /// The nodes on the bore, likewise.
    pub bore_nodes: Vec<u32>,
    /// The nodes on the sides at −π/n and at π/n, outward, without those on the bore and on the interface circle; equal
    /// radii on both sides. Where n = 1 the two sides are the lips of one cut, or there are none.
    pub side_nodes: (Vec<u32>, Vec<u32>),
    /// The nodes around each hole, counter-clockwise, each once.
    pub hole_edges: Vec<Vec<u32>>,
}

impl BlankGrid {
    /// The nodes that one sector adds to the ring: those of its grid without its left side and the ends of that, which are
    /// the next one's.
    pub fn own_nodes(&self) -> usize {
        let (_, left) = &self.side_nodes;
        let shared = if left.is_empty() { 0 } else { left.len() + 2 };
        self.grid.nodes.len() - shared
    }

    /// The nodes of a sector that the next one does not have too.
    pub fn own(&self) -> Vec<u32> {
        let (_, left) = &self.side_nodes;
        let mut shared = left.clone();
        if !left.is_empty() {
            let last = |nodes: &[u32]| nodes[nodes.len() - 1];
            shared.extend([last(&self.bore_nodes), last(&self.arc_nodes)]);
        }
        let all = 0..self.grid.nodes.len() as u32;
        all.filter(|node| !shared.contains(node)).collect()
    }

    /// All sectors joined into one grid of a whole blank: the way without symmetry, to prove the other by.
    pub fn unrolled(&self) -> Self {
        let (right, left) = &self.side_nodes;
        if left.is_empty() {
            return self.clone();
        }
        let ends = |nodes: &[u32]| (nodes[0], nodes[nodes.len() - 1]);
        let ((bore_right, bore_left), (arc_right, arc_left)) =
            (ends(&self.bore_nodes), ends(&self.arc_nodes));
        let mut counterpart = vec![u32::MAX; self.grid.nodes.len()];
        for (l, r) in left.iter().zip(right) {
            counterpart[*l as usize] = *r;
        }
        counterpart[bore_left as usize] = bore_right;
        counterpart[arc_left as usize] = arc_right;

        // Own nodes are numbered sector by sector; the left side is the next sector's right one.
        let (own, count) = (self.own_nodes() as u32, self.sector_count);
        let mut numbers = Vec::with_capacity(counterpart.len());
        let mut next = 0;
        for other in &counterpart {
            numbers.push(next);
            next += u32::from(*other == u32::MAX);
        }
        let number = |sector: u32, node: u32| match counterpart[node as usize] {
            u32::MAX => sector * own + numbers[node as usize],
            right => (sector + 1) % count * own + numbers[right as usize],
        };
        let pitch = std::f64::consts::TAU / f64::from(count);
        let mut whole = Self {
            grid: Grid {
                nodes: Vec::new(),
                elements: Vec::new(),
            },
            sector_count: 1,
            arc_nodes: Vec::new(),
            arc_angles: Vec::new(),
            bore_nodes: Vec::new(),
            side_nodes: (Vec::new(), Vec::new()),
            hole_edges: Vec::new(),
        };
        for sector in 0..count {
            let turn = pitch * f64::from(sector);
            let (e_x, e_y) = (radial(turn), tangential(turn));
            let nodes = self.grid.nodes.iter().zip(&counterpart);
            let own_nodes = nodes.filter(|(_, other)| **other == u32::MAX);
            let turned = own_nodes.map(|(p, _)| -> Vector { p.x * e_x + p.y * e_y });
            whole.grid.nodes.extend(turned);
            let numbered = |nodes: &[u32]| -> Vec<u32> {
                nodes.iter().map(|node| number(sector, *node)).collect()
            };
            let renumbered = |element: &Element| element.renumbered(|node| number(sector, node));
            whole
                .grid
                .elements
                .extend(self.grid.elements.iter().map(renumbered));
            // The last of each is the first of the next sector.
            let (arc, bore) = (self.arc_nodes.len() - 1, self.bore_nodes.len() - 1);
            whole.arc_nodes.extend(numbered(&self.arc_nodes[..arc]));
            let angles = self.arc_angles[..arc].iter();
            whole.arc_angles.extend(angles.map(|angle| angle + turn));
            whole.bore_nodes.extend(numbered(&self.bore_nodes[..bore]));
            whole
                .hole_edges
                .extend(self.hole_edges.iter().map(|edge| numbered(edge)));
        }
        whole
    }
}
