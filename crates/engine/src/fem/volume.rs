//! A prism all through: displacements and stresses at heights across it, on elements in space.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::axial::AxialBasis;
use super::element::gradients;
use super::prism::{COMPONENTS, Law3, Prism};
use crate::gear::{Vector, radial, tangential};
use crate::grid::{Element, ElementKind};

/// Layers of elements across a prism, for each degree of its functions.
const LAYERS_PER_DEGREE: f64 = 0.5;

/// Second-order elements in space, and fields at their nodes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Volume {
    /// Where the nodes lie before loading, in meters.
    pub nodes: Vec<Vector3<f64>>,
    /// How each of them moves, in meters.
    pub displacements: Vec<Vector3<f64>>,
    /// The stresses at each in Pa: the mean of the elements that meet there.
    pub stresses: Vec<Matrix3<f64>>,
    /// The elements, on these nodes.
    pub elements: Vec<VolumeElement>,
}

/// An element of the section between two heights.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeElement {
    /// The shape of its section.
    pub kind: ElementKind,
    /// Its corners below, counter-clockwise, those above, the midsides after each of these below and above, and the middles between corners.
    pub nodes: Vec<u32>,
}

/// Where a prism stands: its axis, the angle of its x axis at its own height 0, and that height.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// Where its axis is.
    pub axis: Vector,
    /// The angle of its x axis.
    pub angle: f64,
    /// Its height 0.
    pub height: f64,
}

/// The derivatives of the shape functions of one element at each of its nodes.
type NodalGradients = Vec<Vec<(f64, f64)>>;

/// The nodes of a section at one height.
#[derive(Debug, Clone)]
pub struct Level {
    /// Where they lie before loading, in meters.
    pub nodes: Vec<Vector3<f64>>,
    /// How each of them moves, in meters.
    pub displacements: Vec<Vector3<f64>>,
    /// The stresses at each in Pa.
    pub stresses: Vec<Matrix3<f64>>,
}

impl Volume {
    /// Adds `prism` at `place`, whose nodes move by `unknowns`: node by node, in polar components, for each function along the axis.
    pub fn add(&mut self, prism: &Prism<'_>, unknowns: &[f64], place: Frame) {
        let grid = prism.grid;
        let mut is_corner = vec![false; grid.nodes.len()];
        for element in &grid.elements {
            for corner in &element.nodes()[..element.kind().corner_count()] {
                is_corner[*corner as usize] = true;
            }
        }
        let mut numbers = Vec::new();
        let levels = prism.levels(unknowns, &heights(prism.axial), place);
        for (number, level) in levels.into_iter().enumerate() {
            let mut of_level = vec![u32::MAX; grid.nodes.len()];
            for (node, of_node) in of_level.iter_mut().enumerate() {
                // Between two layers of nodes there are middles over the corners alone.
                if number % 2 == 0 || is_corner[node] {
                    *of_node = self.nodes.len() as u32;
                    self.nodes.push(level.nodes[node]);
                    self.displacements.push(level.displacements[node]);
                    self.stresses.push(level.stresses[node]);
                }
            }
            numbers.push(of_level);
        }
        for layer in numbers.windows(3).step_by(2) {
            self.elements.extend(grid.elements.iter().map(|element| {
                let (corners, midsides) = element.nodes().split_at(element.kind().corner_count());
                let of = |level: usize, nodes: &[u32]| -> Vec<u32> {
                    nodes.iter().map(|n| layer[level][*n as usize]).collect()
                };
                let nodes = [
                    of(0, corners),
                    of(2, corners),
                    of(0, midsides),
                    of(2, midsides),
                    of(1, corners),
                ];
                VolumeElement {
                    kind: element.kind(),
                    nodes: nodes.concat(),
                }
            }));
        }
    }
}

/// The von Mises stress of a stress tensor.
pub fn von_mises(stress: &Matrix3<f64>) -> f64 {
    let deviator = stress - Matrix3::identity() * (stress.trace() / 3.0);
    (1.5 * deviator.norm_squared()).sqrt()
}

impl Prism<'_> {
    /// Its sections at `heights`, at `place`, where its nodes move by `unknowns`, as for [`Volume::add`].
    pub fn levels(&self, unknowns: &[f64], heights: &[f64], place: Frame) -> Vec<Level> {
        let elements = self.grid.elements.iter();
        let gradients: Vec<_> = elements.map(|of| self.at_nodes_of(of)).collect();
        let level = |&z: &f64| {
            let [at, rise] = [self.axial.values(z), self.axial.slopes(z)]
                .map(|functions| self.in_section(unknowns, &functions));
            let stresses = self.stresses(&gradients, &at, &rise);
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), place.angle + self.twist * z);
            let axis = Vector3::new(place.axis.x, place.axis.y, place.height + z);
            let placed = |flat: &Vector| axis + turn * Vector3::new(flat.x, flat.y, 0.0);
            let turned = |stress: Matrix3<f64>| turn.matrix() * stress * turn.matrix().transpose();
            Level {
                nodes: self.grid.nodes.iter().map(placed).collect(),
                displacements: at.into_iter().map(|u| turn * u).collect(),
                stresses: stresses.into_iter().map(turned).collect(),
            }
        };
        heights.iter().map(level).collect()
    }

    fn at_nodes_of(&self, element: &Element) -> NodalGradients {
        let places = element.places(&self.grid.nodes);
        let kind = element.kind();
        kind.node_places()
            .iter()
            .map(|&(xi, eta)| {
                let (gradient, _) = gradients(kind, &places, xi, eta);
                gradient[..element.nodes().len()].to_vec()
            })
            .collect()
    }

    /// The sum over the `functions` along the axis of each node's values, in the axes of the section.
    fn in_section(&self, unknowns: &[f64], functions: &[f64]) -> Vec<Vector3<f64>> {
        let m = functions.len();
        let of_nodes = unknowns.chunks_exact(COMPONENTS * m).zip(&self.grid.nodes);
        of_nodes
            .map(|(unknowns, place)| {
                let [r, t, w] = std::array::from_fn(|c| {
                    let shares = unknowns[c * m..][..m].iter().zip(functions);
                    shares.map(|(u, f)| u * f).sum::<f64>()
                });
                let angle = place.y.atan2(place.x);
                let flat = r * radial(angle) + t * tangential(angle);
                Vector3::new(flat.x, flat.y, w)
            })
            .collect()
    }

    /// The stresses at all nodes at one height, in the axes of the section: where they move by `at`, and by `rise` for each unit of height.
    fn stresses(
        &self,
        gradients: &[NodalGradients],
        at: &[Vector3<f64>],
        rise: &[Vector3<f64>],
    ) -> Vec<Matrix3<f64>> {
        let law = Law3::new(self.material);
        let mut sums = vec![(Matrix3::zeros(), 0.0); at.len()];
        for (element, gradients) in self.grid.elements.iter().zip(gradients) {
            for (node, gradient) in element.nodes().iter().zip(gradients) {
                let node = *node as usize;
                let (mut by_x, mut by_y) = (Vector3::zeros(), Vector3::zeros());
                for (k, (dx, dy)) in element.nodes().iter().zip(gradient) {
                    by_x += *dx * at[*k as usize];
                    by_y += *dy * at[*k as usize];
                }
                // D_z of the section's own axes, which turn with it.
                let place = self.grid.nodes[node];
                let (u, around) = (at[node], place.x * by_y - place.y * by_x);
                let by_z = rise[node] + self.twist * (Vector3::new(-u.y, u.x, 0.0) - around);
                let [xx, yy, zz, xy, xz, yz] = law.stress([
                    by_x.x,
                    by_y.y,
                    by_z.z,
                    by_y.x + by_x.y,
                    by_x.z + by_z.x,
                    by_y.z + by_z.y,
                ]);
                let (sum, meeting) = &mut sums[node];
                *sum += Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
                *meeting += 1.0;
            }
        }
        sums.into_iter()
            .map(|(sum, meeting)| sum / f64::max(meeting, 1.0))
            .collect()
    }
}

/// The heights of the layers of nodes: both ends of each layer of elements, and its middle.
fn heights(axial: &AxialBasis) -> Vec<f64> {
    let layers = (LAYERS_PER_DEGREE * axial.degree() as f64).ceil().max(1.0) as usize;
    let steps = 2 * layers;
    let mut heights = vec![axial.heights()[0]];
    for ends in axial.breaks().windows(2) {
        let step = (ends[1] - ends[0]) / steps as f64;
        heights.extend((1..=steps).map(|i| ends[0] + i as f64 * step));
    }
    heights
}
