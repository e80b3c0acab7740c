//! Grids of second-order elements in the plane, and their quality.

use std::f64::consts::PI;

use super::element::{Element, ElementKind};
use crate::gear::Vector;

/// A grid of 8-node quadrilaterals and 6-node triangles, with coordinates in meters.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// The places of the nodes.
    pub nodes: Vec<Vector>,
    /// The elements.
    pub elements: Vec<Element>,
}

/// Distortion of the elements of a grid: the distance from parallelograms and from triangles with straight sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridQuality {
    /// The least ratio, over the elements, of the smallest to the largest Jacobian determinant at the quadrature points and
    /// the corners: 1 for a parallelogram or a straight triangle, not positive where an element is folded.
    pub smallest_jacobian: f64,
    /// The smallest angle between the curved sides of an element at a corner, in radians.
    pub smallest_angle: f64,
    /// The largest of these angles, in radians.
    pub largest_angle: f64,
}

impl Grid {
    /// The quality of the grid.
    pub fn quality(&self) -> GridQuality {
        let mut quality = GridQuality {
            smallest_jacobian: 1.0,
            smallest_angle: PI,
            largest_angle: 0.0,
        };
        for element in &self.elements {
            let [smallest, largest] = self.jacobian_range(element);
            // A negative largest determinant would turn the ratio positive again.
            let ratio = smallest / largest.abs();
            // Not `min`, which would pass over a ratio that is not a number.
            if ratio < quality.smallest_jacobian || ratio.is_nan() {
                quality.smallest_jacobian = ratio;
            }
            for angle in self.corner_angles(element) {
                quality.smallest_angle = quality.smallest_angle.min(angle);
                quality.largest_angle = quality.largest_angle.max(angle);
            }
        }
        quality
    }

    /// The area.
    pub fn area(&self) -> f64 {
        self.integral(|_| 1.0)
    }

    /// The area times the thickness of each element, as parts of the body's thickness.
    pub fn weighted_area(&self) -> f64 {
        self.integral(Element::thickness)
    }

    fn integral(&self, weight: impl Fn(&Element) -> f64) -> f64 {
        let mut sum = 0.0;
        for element in &self.elements {
            let share = weight(element);
            for &(xi, eta, w) in element.kind().rule() {
                sum += w * self.jacobian(element, xi, eta) * share;
            }
        }
        sum
    }

    /// The angles between the curved sides of an element at its corners.
    fn corner_angles(&self, element: &Element) -> impl Iterator<Item = f64> {
        let corners = &element.kind().node_places()[..element.kind().corner_count()];
        let count = corners.len();
        (0..count).map(move |i| {
            let (xi, eta) = corners[i];
            let [along_xi, along_eta] = self.tangents(element, xi, eta);
            let towards = |other: usize| {
                let (to_xi, to_eta) = corners[other % count];
                (to_xi - xi) * along_xi + (to_eta - eta) * along_eta
            };
            let (next, last) = (towards(i + 1), towards(i + count - 1));
            let cross = next.x * last.y - next.y * last.x;
            cross.atan2(next.dot(&last)).rem_euclid(2.0 * PI)
        })
    }

    fn jacobian_range(&self, element: &Element) -> [f64; 2] {
        let kind: ElementKind = element.kind();
        let corners = &kind.node_places()[..kind.corner_count()];
        let points = kind.rule().iter().map(|&(xi, eta, _)| (xi, eta));
        points.chain(corners.iter().copied()).fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[low, high], (xi, eta)| {
                let j = self.jacobian(element, xi, eta);
                [low.min(j), high.max(j)]
            },
        )
    }

    fn jacobian(&self, element: &Element, xi: f64, eta: f64) -> f64 {
        let [a, b] = self.tangents(element, xi, eta);
        a.x * b.y - a.y * b.x
    }

    /// The derivatives of the place by ξ and by η.
    fn tangents(&self, element: &Element, xi: f64, eta: f64) -> [Vector; 2] {
        let mut tangents = [Vector::zeros(); 2];
        let derivatives = element.kind().derivatives(xi, eta);
        for (node, (by_xi, by_eta)) in element.nodes().iter().zip(derivatives) {
            let point = self.nodes[*node as usize];
            tangents[0] += by_xi * point;
            tangents[1] += by_eta * point;
        }
        tangents
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn single(corners: [(f64, f64); 4]) -> Grid {
        let c = corners.map(|(x, y)| Vector::new(x, y));
        let nodes = (0..4)
            .map(|i| c[i])
            .chain((0..4).map(|i| (c[i] + c[(i + 1) % 4]) / 2.0))
            .collect();
        Grid {
            nodes,
            elements: vec![Element::quadrilateral([0, 1, 2, 3, 4, 5, 6, 7])],
        }
    }

    #[test]
    fn a_parallelogram_has_its_own_angles_and_an_even_jacobian() {
        let grid = single([(0.0, 0.0), (2.0, 0.0), (3.0, 1.0), (1.0, 1.0)]);
        let quality = grid.quality();
        assert!((grid.area() - 2.0).abs() < 1e-14);
        assert!((quality.smallest_jacobian - 1.0).abs() < 1e-12);
        assert!((quality.smallest_angle - PI / 4.0).abs() < 1e-12);
        assert!((quality.largest_angle - 3.0 * PI / 4.0).abs() < 1e-12);
    }

    #[test]
    fn a_clockwise_or_folded_element_is_told_by_its_jacobian() {
        let clockwise = single([(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)]);
        assert!(clockwise.quality().smallest_jacobian < 0.0);
        let folded = single([(0.0, 0.0), (2.0, 0.0), (0.5, 0.5), (0.0, 2.0)]);
        assert!(folded.quality().smallest_jacobian < 0.0);
        assert!(folded.quality().largest_angle > PI);
    }

    #[test]
    fn a_disc_of_one_element_has_the_area_under_its_parabolic_sides() {
        // A square of side 2 with midsides raised by h gains 4 · (2/3) · 2 h.
        let mut grid = single([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]);
        for node in &mut grid.nodes[4..] {
            *node *= 1.2;
        }
        assert!((grid.area() - (4.0 + 16.0 / 3.0 * 0.2)).abs() < 1e-13);
    }

    #[test]
    fn a_triangle_has_its_own_angles_and_area_and_bulges_with_its_sides() {
        let c = [(0.0, 0.0), (2.0, 0.0), (0.5, 1.0)].map(|(x, y)| Vector::new(x, y));
        let middle = |i: usize| (c[i] + c[(i + 1) % 3]) / 2.0;
        let mut grid = Grid {
            nodes: vec![c[0], c[1], c[2], middle(0), middle(1), middle(2)],
            elements: vec![Element::triangle([0, 1, 2, 3, 4, 5])],
        };
        let quality = grid.quality();
        assert!((grid.area() - 1.0).abs() < 1e-14);
        assert!((quality.smallest_jacobian - 1.0).abs() < 1e-12);
        assert!((quality.smallest_angle - (1.0_f64 / 1.5).atan()).abs() < 1e-12);
        assert!(
            (quality.largest_angle - (PI - quality.smallest_angle - 2.0_f64.atan())).abs() < 1e-12
        );
        // A midside moved out by h adds the parabola's 2/3 of side times h; moved in far enough it folds the element.
        grid.nodes[3].y = -0.1;
        assert!((grid.area() - (1.0 + 2.0 / 3.0 * 2.0 * 0.1)).abs() < 1e-14);
        grid.nodes[3].y = 0.6;
        assert!(grid.quality().smallest_jacobian < 0.0);
    }

    #[test]
    fn thickness_weighs_the_area() {
        let mut grid = single([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]);
        assert_eq!(grid.weighted_area(), grid.area());
        grid.elements[0] = grid.elements[0].of_thickness(0.25);
        assert!((grid.weighted_area() - 0.5).abs() < 1e-15);
    }
}
