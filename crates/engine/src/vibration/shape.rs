//! The shape of a mode on its grid, in space.

use std::f64::consts::TAU;

use faer::c64;
use nalgebra::Vector3;

use super::heights::Parity;
use super::mode::Mode;
use super::system::System;
use crate::fem::prism::COMPONENTS;
use crate::fem::volume::VolumeElement;
use crate::gear::{radial, tangential};
use crate::grid::Element;

/// Levels of nodes of a layer of elements: below, in the middle and above.
const LEVELS: usize = 3;

/// The shape of a mode on second-order elements in space, in the frame of its gear: z along the axis from the middle of the face, tooth 0 at the x axis.
///
/// Blank and teeth have grids of their own on both sides of the circle on which the teeth stand. Both have the same motion there.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeShape {
    /// The mode.
    pub mode: Mode,
    /// Where the nodes lie, in meters.
    pub nodes: Vec<Vector3<f64>>,
    /// How each of them moves in the cosine and in the sine of the mode, in kg^(−1/2). The sine of a single mode is zero.
    pub displacements: Vec<[Vector3<f64>; 2]>,
    /// The elements, on these nodes.
    pub elements: Vec<VolumeElement>,
}

/// The number of nodes and of elements of a shape.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ShapeSize {
    /// Nodes, at most.
    pub nodes: usize,
    /// Elements.
    pub elements: usize,
}

impl ShapeSize {
    /// The bytes of the shape, at most.
    pub fn bytes(self) -> usize {
        // Lists grow twofold.
        let node = 2 * (size_of::<Vector3<f64>>() + size_of::<[Vector3<f64>; 2]>());
        let element = 2 * size_of::<VolumeElement>() + 20 * size_of::<u32>();
        self.nodes * node + self.elements * element
    }

    /// Sizes of both together.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            nodes: self.nodes + other.nodes,
            elements: self.elements + other.elements,
        }
    }

    /// Size of a shape of `copies` of the section of `system`.
    pub(super) fn of(system: &System<'_>, copies: usize) -> Self {
        let halves = system.heights.copies() as usize;
        let layers = |element: usize| (system.part(element).count() - 1) / (LEVELS - 1);
        let count = system.section.grid.elements.len();
        let elements: usize = (0..count).map(layers).sum();
        let levels = halves * system.heights.nodes.len();
        Self {
            nodes: copies * levels * system.section.grid.nodes.len(),
            elements: copies * halves * elements,
        }
    }
}

impl ModeShape {
    /// The shape of `mode` without any part of the gear.
    pub(super) fn of(mode: Mode) -> Self {
        Self {
            mode,
            nodes: Vec::new(),
            displacements: Vec::new(),
            elements: Vec::new(),
        }
    }

    /// The largest displacement in kg^(−1/2), of its cosine and of its sine.
    pub fn largest(&self) -> f64 {
        let all = self.displacements.iter().flatten();
        all.map(|u| u.norm()).fold(0.0, f64::max)
    }

    /// Adds `copies` of the section of `system` around the axis, the first of which is turned by `first`. `moved` gives the displacement in a copy, by node,
    /// component and function along the axis; its real part is that of the cosine, its imaginary one that of the sine.
    pub(super) fn add(
        &mut self,
        system: &System<'_>,
        parity: Parity,
        (copies, first): (usize, f64),
        moved: impl Fn(usize, (u32, usize, usize)) -> c64,
    ) {
        for copy in 0..copies {
            let angle = first + TAU * copy as f64 / copies as f64;
            self.add_copy(system, parity, angle, |place| moved(copy, place));
        }
    }

    fn add_copy(
        &mut self,
        system: &System<'_>,
        parity: Parity,
        angle: f64,
        moved: impl Fn((u32, usize, usize)) -> c64,
    ) {
        let heights = system.heights;
        let (nodes, levels) = (&system.section.grid.nodes, heights.nodes.len());
        for half in 0..heights.copies() as usize {
            // Each half has nodes of its own on the middle plane.
            let mut numbers = vec![u32::MAX; levels * nodes.len()];
            let side = if half == 0 { 1.0 } else { -1.0 };
            let mut number = |shape: &mut Self, node: u32, level: usize| {
                let number = &mut numbers[level * nodes.len() + node as usize];
                if *number == u32::MAX {
                    *number = shape.nodes.len() as u32;
                    let turned = system.angles[node as usize] + angle;
                    let [out, along] = [radial(turned), tangential(turned)];
                    let u: [c64; COMPONENTS] = std::array::from_fn(|component| {
                        let is_opposite = half == 1 && heights.is_odd(parity, component);
                        let sign = if is_opposite { -1.0 } else { 1.0 };
                        moved((node, component, level)) * sign
                    });
                    let of = |part: fn(&c64) -> f64| {
                        let [r, t, z] = u.each_ref().map(part);
                        let flat = r * out + t * along;
                        Vector3::new(flat.x, flat.y, z)
                    };
                    let at = nodes[node as usize].norm() * out;
                    let z = side * heights.nodes[level];
                    shape.nodes.push(Vector3::new(at.x, at.y, z));
                    let is_double = shape.mode.is_double;
                    let sine = if is_double {
                        of(|u| u.im)
                    } else {
                        Vector3::zeros()
                    };
                    shape.displacements.push([of(|u| u.re), sine]);
                }
                *number
            };
            for (index, element) in system.section.grid.elements.iter().enumerate() {
                let part = system.part(index);
                for low in (part.first..part.first + part.count() - 1).step_by(LEVELS - 1) {
                    let mut levels: [usize; LEVELS] = std::array::from_fn(|i| low + i);
                    if half == 1 {
                        levels.reverse();
                    }
                    let nodes = layer(element, levels, |node, level| number(self, node, level));
                    self.elements.push(VolumeElement {
                        kind: element.kind(),
                        nodes,
                    });
                }
            }
        }
    }
}

/// The nodes of an element of the section between the outer of three `levels`, in the order of [`VolumeElement`].
fn layer(
    element: &Element,
    [below, middle, above]: [usize; LEVELS],
    mut number: impl FnMut(u32, usize) -> u32,
) -> Vec<u32> {
    let (corners, midsides) = element.nodes().split_at(element.kind().corner_count());
    let parts = [
        (corners, below),
        (corners, above),
        (midsides, below),
        (midsides, above),
        (corners, middle),
    ];
    let mut nodes = Vec::with_capacity(2 * element.nodes().len() + corners.len());
    for (of, level) in parts {
        nodes.extend(of.iter().map(|node| number(*node, level)));
    }
    nodes
}
