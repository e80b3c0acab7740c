//! Quadratic elements divided into linear cells, for filters that take each cell as straight between its corners.

use std::collections::HashMap;

use meshwright_engine::grid::ElementKind;

pub use super::piece::Divided;
use super::piece::{Cell, HEXAHEDRON, MOST_CORNERS, Piece, QUAD, TRIANGLE, Values, WEDGE};

/// Linear cells along each side of an element in its section: a parabola is off a line over a quarter of it by a sixteenth of what it is off one over the whole.
const ALONG: u32 = 4;

/// A point by the corners of its element and their shares, so that neighbors find it alike: in whole numbers, by rising corner.
type Shares = [(u32, u32); MOST_CORNERS];

/// A place of an element: steps along its sides in the section, and across.
type Step = (u32, u32, u32);

impl Divided {
    /// The elements of `piece`, each divided four times along its sides, and twice across where it is a volume.
    pub fn of(piece: Piece<'_>) -> Self {
        let mut divided = Self::default();
        let mut known: HashMap<Shares, u32> = HashMap::new();
        for number in 0..piece.cells() {
            let (kind, layers) = piece.element(number);
            let nodes = piece.cell(number).1;
            let thickness = piece.thickness(number);
            let mut point = |step: Step| {
                let shares = shares(kind, layers, nodes, step);
                *known.entry(shares).or_insert_with(|| {
                    let values = values(kind, layers, step);
                    let mut sum = Values::default();
                    for (node, share) in nodes.iter().zip(values) {
                        sum.add(&piece.values(*node as usize), share);
                    }
                    divided.points.push(sum);
                    divided.points.len() as u32 - 1
                })
            };
            for below in 0..layers.max(1) {
                for outline in sections(kind) {
                    let mut corners = [0; MOST_CORNERS];
                    let heights = if layers == 0 {
                        0..=0
                    } else {
                        below..=below + 1
                    };
                    let steps = heights.flat_map(|k| outline.iter().map(move |(i, j)| (*i, *j, k)));
                    for (corner, step) in corners.iter_mut().zip(steps) {
                        *corner = point(step);
                    }
                    let shape = match (outline.len(), layers) {
                        (3, 0) => TRIANGLE,
                        (_, 0) => QUAD,
                        (3, _) => WEDGE,
                        _ => HEXAHEDRON,
                    };
                    divided.cells.push(Cell {
                        shape,
                        corners,
                        thickness,
                    });
                }
            }
        }
        divided
    }
}

/// The outlines of the cells of a section, counter-clockwise, by steps along the sides.
fn sections(kind: ElementKind) -> Vec<Vec<(u32, u32)>> {
    let mut outlines = Vec::new();
    for j in 0..ALONG {
        match kind {
            ElementKind::Quadrilateral => outlines
                .extend((0..ALONG).map(|i| vec![(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)])),
            ElementKind::Triangle => {
                for i in 0..ALONG - j {
                    outlines.push(vec![(i, j), (i + 1, j), (i, j + 1)]);
                    if i + j + 1 < ALONG {
                        outlines.push(vec![(i + 1, j), (i + 1, j + 1), (i, j + 1)]);
                    }
                }
            }
        }
    }
    outlines
}

/// The shares of the corners of a section at a step, over [`ALONG`] squared.
fn corner_shares(kind: ElementKind, (i, j): (u32, u32)) -> Vec<u32> {
    match kind {
        ElementKind::Quadrilateral => {
            let (a, b) = (ALONG - i, ALONG - j);
            vec![a * b, i * b, i * j, a * j]
        }
        ElementKind::Triangle => vec![(ALONG - i - j) * ALONG, i * ALONG, j * ALONG],
    }
}

/// The shares of the corners among `nodes` at a step.
fn shares(kind: ElementKind, layers: u32, nodes: &[u32], (i, j, k): Step) -> Shares {
    let below = corner_shares(kind, (i, j)).into_iter();
    let all: Vec<u32> = match layers {
        0 => below.collect(),
        _ => {
            let above = below.clone().map(|share| share * k);
            below
                .map(|share| share * (layers - k))
                .chain(above)
                .collect()
        }
    };
    let mut shares: Shares = [(u32::MAX, 0); MOST_CORNERS];
    let held = nodes.iter().zip(all).filter(|(_, share)| *share > 0);
    for (place, (node, share)) in shares.iter_mut().zip(held) {
        *place = (*node, share);
    }
    shares.sort_unstable();
    shares
}

/// The shape functions of an element at a step, node by node: of a volume those of the element with twenty or fifteen nodes.
fn values(kind: ElementKind, layers: u32, (i, j, k): Step) -> Vec<f64> {
    let part = |step: u32| f64::from(step) / f64::from(ALONG);
    let (xi, eta) = match kind {
        ElementKind::Quadrilateral => (2.0 * part(i) - 1.0, 2.0 * part(j) - 1.0),
        ElementKind::Triangle => (part(i), part(j)),
    };
    let corners = kind.corner_count();
    let section = &kind.values(xi, eta)[..2 * corners];
    if layers == 0 {
        return section.to_vec();
    }
    let linear: Vec<f64> = corner_shares(kind, (i, j))
        .into_iter()
        .map(|share| f64::from(share) / f64::from(ALONG * ALONG))
        .collect();
    let zeta = 2.0 * f64::from(k) / f64::from(layers) - 1.0;
    let bubble = 1.0 - zeta * zeta;
    let ends = [0.5 * (1.0 - zeta), 0.5 * (1.0 + zeta)];
    let of_corners = ends.iter().flat_map(|end| {
        let each = section[..corners].iter().zip(&linear);
        each.map(move |(own, linear)| end * own - 0.5 * bubble * linear)
    });
    let of_midsides = ends
        .iter()
        .flat_map(|end| section[corners..].iter().map(move |own| end * own));
    let of_middles = linear.iter().map(|linear| bubble * linear);
    of_corners.chain(of_midsides).chain(of_middles).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use meshwright_engine::analysis::fields::GearField;
    use meshwright_engine::analysis::fields::{Volume, VolumeElement};
    use meshwright_engine::gear::{Vector, radial};
    use meshwright_engine::grid::Element;
    use nalgebra::{Matrix3, Vector3};

    use super::*;

    /// Two elements beside each other in a ring from 1 to 2, 45 degrees wide each, with a von Mises stress of r² (2 + cos 2φ) Pa, which no line follows.
    fn ring() -> GearField {
        let mut field = GearField::default();
        let number = |column: usize, row: usize| (3 * column + row) as u32;
        for column in 0..5 {
            for row in 0..3 {
                let (r, angle) = (1.0 + 0.5 * row as f64, FRAC_PI_2 * column as f64 / 4.0);
                field.nodes.push(r * radial(angle));
                field.displacements.push(Vector::zeros());
                field.stresses.push([0.0; 3]);
                field.von_mises.push(r * r * (2.0 + (2.0 * angle).cos()));
            }
        }
        for c in [0, 2] {
            field.elements.push(Element::quadrilateral([
                number(c, 0),
                number(c, 2),
                number(c + 2, 2),
                number(c + 2, 0),
                number(c, 1),
                number(c + 1, 2),
                number(c + 2, 1),
                number(c + 1, 0),
            ]));
            field.thicknesses.push(0.01);
        }
        field
    }

    /// The integral of the von Mises stress over straight triangles, as viewers take it, in MPa mm².
    fn integral(points: &[Values], triangles: impl Iterator<Item = [u32; 3]>) -> f64 {
        triangles
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| points[corner as usize]);
                let [u, v] = [b, c].map(|p| [0, 1].map(|k| p.place[k] - a.place[k]));
                let area = 0.5 * (u[0] * v[1] - u[1] * v[0]);
                area * (a.von_mises + b.von_mises + c.von_mises) / 3.0
            })
            .sum()
    }

    #[test]
    fn integrals_over_linear_cells_are_those_of_the_quadratic_elements_within_a_percent() {
        let field = ring();
        let divided = Divided::of(Piece::Plate(&field));
        let halves = divided.cells.iter().flat_map(|cell| {
            let [a, b, c, d] = *cell.corners() else {
                panic!("a quadrilateral")
            };
            [[a, b, c], [a, c, d]]
        });
        let found = integral(&divided.points, halves);
        // ∫∫ r² (2 + cos 2φ) r dr dφ = 15/4 · π over the quarter ring.
        let exact = 3.75 * 2.0 * FRAC_PI_2;
        assert!((found / exact - 1.0).abs() < 0.01, "{found} {exact}");
        // Lines between corners alone are off by 6 %.
        let piece = Piece::Plate(&field);
        let points: Vec<Values> = (0..field.nodes.len()).map(|i| piece.values(i)).collect();
        let coarse = field.elements.iter().flat_map(|element| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| element.nodes()[i]);
            [[a, b, c], [a, c, d]]
        });
        assert!((integral(&points, coarse) / exact - 1.0).abs() > 0.05);
        // Neighbors share the points between them.
        assert_eq!(divided.points.len(), 9 * 5);
        assert_eq!(divided.cells.len(), 32);
    }

    #[test]
    fn a_quadratic_field_of_a_volume_is_met_at_every_point_of_its_linear_cells() {
        // A unit cube and a wedge, each with its nodes where they belong.
        for kind in [ElementKind::Quadrilateral, ElementKind::Triangle] {
            let corners = kind.corner_count();
            let places = kind.node_places();
            let at = |i: usize, z: f64| Vector3::new(places[i].0, places[i].1, z);
            let section = |range: std::ops::Range<usize>, z: f64| range.map(move |i| at(i, z));
            let nodes: Vec<_> = section(0..corners, 0.0)
                .chain(section(0..corners, 1.0))
                .chain(section(corners..2 * corners, 0.0))
                .chain(section(corners..2 * corners, 1.0))
                .chain(section(0..corners, 0.5))
                .collect();
            let quadratic = |p: &Vector3<f64>| 1.0 + p.x * p.y + 2.0 * p.z * p.z - p.x * p.z + p.y;
            let volume = Volume {
                displacements: nodes
                    .iter()
                    .map(|p| Vector3::new(1e-6 * quadratic(p), 0.0, 0.0))
                    .collect(),
                stresses: vec![Matrix3::zeros(); nodes.len()],
                elements: vec![VolumeElement {
                    kind,
                    nodes: (0..nodes.len() as u32).collect(),
                }],
                nodes,
            };
            let divided = Divided::of(Piece::Volume(&volume));
            for point in &divided.points {
                let place = Vector3::from(point.place.map(|x| 1e-3 * x));
                assert!((point.displacement[0] - quadratic(&place)).abs() < 1e-12);
            }
            let of_section = (ALONG * ALONG) as usize;
            assert_eq!(divided.cells.len(), of_section * Divided::LAYERS as usize);
            let points = match kind {
                ElementKind::Quadrilateral => (ALONG + 1) * (ALONG + 1),
                ElementKind::Triangle => (ALONG + 1) * (ALONG + 2) / 2,
            };
            assert_eq!(divided.points.len() as u32, points * (Divided::LAYERS + 1));
        }
    }
}
