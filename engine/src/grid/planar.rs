//! Grids of 8-node quadrilaterals in the plane, and their quality.

use std::f64::consts::PI;

use crate::gear::Vector;
use crate::quadrature::GAUSS_3;

/// The corners of the reference square, counter-clockwise.
const CORNERS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

/// A grid of 8-node serendipity quadrilaterals, with coordinates in meters.
///
/// The nodes of an element are its corners 0 to 3 counter-clockwise, then its midsides 4 (between corners 0 and 1),
/// 5 (1, 2), 6 (2, 3) and 7 (3, 0).
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// The places of the nodes.
    pub nodes: Vec<Vector>,
    /// The node numbers of each element.
    pub elements: Vec<[u32; 8]>,
}

/// How far the elements of a grid are from parallelograms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridQuality {
    /// The least ratio, over the elements, of the smallest to the largest Jacobian determinant at the nine quadrature
    /// points and the corners: 1 for a parallelogram, not positive where an element is folded.
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
        for element in 0..self.elements.len() {
            let [smallest, largest] = self.jacobian_range(element);
            // A negative largest determinant would turn the ratio positive again.
            let ratio = smallest / largest.abs();
            // Not `min`, which would pass over a ratio that is not a number.
            if ratio < quality.smallest_jacobian || ratio.is_nan() {
                quality.smallest_jacobian = ratio;
            }
            for (xi, eta) in CORNERS {
                let [along_xi, along_eta] = self.tangents(element, xi, eta);
                // Towards the neighboring corners: inward from either end of each side.
                let (p, q) = (-xi * along_xi, -eta * along_eta);
                let cross = xi * eta * (p.x * q.y - p.y * q.x);
                let angle = cross.atan2(p.dot(&q)).rem_euclid(2.0 * PI);
                quality.smallest_angle = quality.smallest_angle.min(angle);
                quality.largest_angle = quality.largest_angle.max(angle);
            }
        }
        quality
    }

    /// The area by the 3 by 3 rule.
    pub fn area(&self) -> f64 {
        let mut area = 0.0;
        for element in 0..self.elements.len() {
            for (xi, w_xi) in GAUSS_3 {
                for (eta, w_eta) in GAUSS_3 {
                    area += w_xi * w_eta * self.jacobian(element, xi, eta);
                }
            }
        }
        area
    }

    fn jacobian_range(&self, element: usize) -> [f64; 2] {
        let points = GAUSS_3
            .into_iter()
            .flat_map(|(xi, _)| GAUSS_3.into_iter().map(move |(eta, _)| (xi, eta)))
            .chain(CORNERS);
        points.fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[low, high], (xi, eta)| {
                let j = self.jacobian(element, xi, eta);
                [low.min(j), high.max(j)]
            },
        )
    }

    fn jacobian(&self, element: usize, xi: f64, eta: f64) -> f64 {
        let [a, b] = self.tangents(element, xi, eta);
        a.x * b.y - a.y * b.x
    }

    /// The derivatives of the place by ξ and by η.
    fn tangents(&self, element: usize, xi: f64, eta: f64) -> [Vector; 2] {
        let mut tangents = [Vector::zeros(); 2];
        for (node, [by_xi, by_eta]) in self.elements[element].iter().zip(derivatives(xi, eta)) {
            let point = self.nodes[*node as usize];
            tangents[0] += by_xi * point;
            tangents[1] += by_eta * point;
        }
        tangents
    }
}

/// The derivatives by ξ and η of the eight serendipity functions: (1 + ξ ξ_i)(1 + η η_i)(ξ ξ_i + η η_i − 1)/4 at a
/// corner, (1 − ξ²)(1 + η η_i)/2 and (1 + ξ ξ_i)(1 − η²)/2 at the midsides.
fn derivatives(xi: f64, eta: f64) -> [[f64; 2]; 8] {
    let corner = |(x, y): (f64, f64)| {
        [
            x * (1.0 + eta * y) * (2.0 * xi * x + eta * y) / 4.0,
            y * (1.0 + xi * x) * (xi * x + 2.0 * eta * y) / 4.0,
        ]
    };
    let across = |y: f64| [-xi * (1.0 + eta * y), (1.0 - xi * xi) * y / 2.0];
    let along = |x: f64| [x * (1.0 - eta * eta) / 2.0, -eta * (1.0 + xi * x)];
    let [c_0, c_1, c_2, c_3] = CORNERS.map(corner);
    [
        c_0,
        c_1,
        c_2,
        c_3,
        across(-1.0),
        along(1.0),
        across(1.0),
        along(-1.0),
    ]
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
            elements: vec![[0, 1, 2, 3, 4, 5, 6, 7]],
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
}
