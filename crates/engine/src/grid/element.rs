//! The two elements of a grid, the 8-node quadrilateral and the 6-node triangle: nodes, shape functions, quadrature.

use crate::gear::Vector;
use crate::quadrature::GAUSS_3;

/// The most nodes that an element has.
pub const MOST_NODES: usize = 8;

/// A point of the reference element with its weight: (ξ, η, w).
pub type RulePoint = (f64, f64, f64);

/// The shape of an element. Nodes are its corners counter-clockwise, then the midside after each corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ElementKind {
    /// The 8-node serendipity quadrilateral on the square −1 ≤ ξ, η ≤ 1.
    Quadrilateral,
    /// The 6-node triangle on 0 ≤ ξ, η, ξ + η ≤ 1.
    Triangle,
}

impl ElementKind {
    /// The local coordinates (ξ, η) of the nodes.
    pub const fn node_places(self) -> &'static [(f64, f64)] {
        match self {
            Self::Quadrilateral => &QUADRILATERAL_NODES,
            Self::Triangle => &TRIANGLE_NODES,
        }
    }

    /// The number of corners; midsides are as many.
    pub const fn corner_count(self) -> usize {
        match self {
            Self::Quadrilateral => 4,
            Self::Triangle => 3,
        }
    }

    /// The quadrature rule, exact to degree 5: for the products of derivatives of an element with straight sides it has
    /// degrees to spare, which those with curved sides use.
    pub const fn rule(self) -> &'static [RulePoint] {
        match self {
            Self::Quadrilateral => &QUADRILATERAL_RULE,
            Self::Triangle => &TRIANGLE_RULE,
        }
    }

    /// The values of the shape functions at (ξ, η), node by node; zero beyond the nodes of a triangle.
    pub fn values(self, xi: f64, eta: f64) -> [f64; MOST_NODES] {
        let mut values = [0.0; MOST_NODES];
        match self {
            Self::Quadrilateral => {
                for (value, (a, b)) in values.iter_mut().zip(QUADRILATERAL_NODES) {
                    *value = if a != 0.0 && b != 0.0 {
                        (1.0 + a * xi) * (1.0 + b * eta) * (a * xi + b * eta - 1.0) / 4.0
                    } else if a == 0.0 {
                        (1.0 - xi * xi) * (1.0 + b * eta) / 2.0
                    } else {
                        (1.0 + a * xi) * (1.0 - eta * eta) / 2.0
                    };
                }
            }
            Self::Triangle => {
                let areas = [1.0 - xi - eta, xi, eta];
                for i in 0..3 {
                    values[i] = areas[i] * (2.0 * areas[i] - 1.0);
                    values[3 + i] = 4.0 * areas[i] * areas[(i + 1) % 3];
                }
            }
        }
        values
    }

    /// The derivatives (∂N/∂ξ, ∂N/∂η) of the shape functions at (ξ, η), node by node; zero beyond the nodes of a triangle.
    pub fn derivatives(self, xi: f64, eta: f64) -> [(f64, f64); MOST_NODES] {
        match self {
            Self::Quadrilateral => quadrilateral_derivatives(xi, eta),
            Self::Triangle => triangle_derivatives(xi, eta),
        }
    }
}

/// The local coordinates of the quadrilateral's nodes.
const QUADRILATERAL_NODES: [(f64, f64); 8] = [
    (-1.0, -1.0),
    (1.0, -1.0),
    (1.0, 1.0),
    (-1.0, 1.0),
    (0.0, -1.0),
    (1.0, 0.0),
    (0.0, 1.0),
    (-1.0, 0.0),
];

/// The local coordinates of the triangle's nodes.
const TRIANGLE_NODES: [(f64, f64); 6] = [
    (0.0, 0.0),
    (1.0, 0.0),
    (0.0, 1.0),
    (0.5, 0.0),
    (0.5, 0.5),
    (0.0, 0.5),
];

/// The 3 by 3 Gauss rule.
const QUADRILATERAL_RULE: [RulePoint; 9] = {
    let mut rule = [(0.0, 0.0, 0.0); 9];
    let mut i = 0;
    while i < 9 {
        let ((xi, w_xi), (eta, w_eta)) = (GAUSS_3[i / 3], GAUSS_3[i % 3]);
        rule[i] = (xi, eta, w_xi * w_eta);
        i += 1;
    }
    rule
};

/// The rule of seven points of Radon (1948) on the triangle: the center, and two rings of three on the medians at
/// (6 ∓ √15)/21 with the weights (155 ∓ √15)/2400.
const TRIANGLE_RULE: [RulePoint; 7] = {
    const NEAR: f64 = 0.101_286_507_323_456_34;
    const FAR: f64 = 0.470_142_064_105_115_1;
    const AT_NEAR: f64 = 0.062_969_590_272_413_58;
    const AT_FAR: f64 = 0.066_197_076_394_253_1;
    [
        (1.0 / 3.0, 1.0 / 3.0, 0.1125),
        (NEAR, NEAR, AT_NEAR),
        (1.0 - 2.0 * NEAR, NEAR, AT_NEAR),
        (NEAR, 1.0 - 2.0 * NEAR, AT_NEAR),
        (FAR, FAR, AT_FAR),
        (1.0 - 2.0 * FAR, FAR, AT_FAR),
        (FAR, 1.0 - 2.0 * FAR, AT_FAR),
    ]
};

fn quadrilateral_derivatives(xi: f64, eta: f64) -> [(f64, f64); MOST_NODES] {
    let mut derivatives = [(0.0, 0.0); MOST_NODES];
    for (derivative, (a, b)) in derivatives.iter_mut().zip(QUADRILATERAL_NODES) {
        *derivative = if a != 0.0 && b != 0.0 {
            (
                a * (1.0 + b * eta) * (2.0 * a * xi + b * eta) / 4.0,
                b * (1.0 + a * xi) * (a * xi + 2.0 * b * eta) / 4.0,
            )
        } else if a == 0.0 {
            (-xi * (1.0 + b * eta), b * (1.0 - xi * xi) / 2.0)
        } else {
            (a * (1.0 - eta * eta) / 2.0, -eta * (1.0 + a * xi))
        };
    }
    derivatives
}

fn triangle_derivatives(xi: f64, eta: f64) -> [(f64, f64); MOST_NODES] {
    let rest = 1.0 - xi - eta;
    let mut derivatives = [(0.0, 0.0); MOST_NODES];
    let of_nodes = [
        (1.0 - 4.0 * rest, 1.0 - 4.0 * rest),
        (4.0 * xi - 1.0, 0.0),
        (0.0, 4.0 * eta - 1.0),
        (4.0 * (rest - xi), -4.0 * xi),
        (4.0 * eta, 4.0 * xi),
        (-4.0 * eta, 4.0 * (rest - eta)),
    ];
    derivatives[..6].copy_from_slice(&of_nodes);
    derivatives
}

/// One element of a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    kind: ElementKind,
    nodes: [u32; MOST_NODES],
    thickness: f64,
}

impl Element {
    /// A quadrilateral on `nodes`: corners counter-clockwise, then the midsides between corners 0 and 1, 1 and 2, 2 and 3,
    /// 3 and 0. As thick as the body.
    pub const fn quadrilateral(nodes: [u32; 8]) -> Self {
        Self {
            kind: ElementKind::Quadrilateral,
            nodes,
            thickness: 1.0,
        }
    }

    /// A triangle on `nodes`: corners counter-clockwise, then the midsides between corners 0 and 1, 1 and 2, 2 and 0. As
    /// thick as the body.
    pub const fn triangle(nodes: [u32; 6]) -> Self {
        let [a, b, c, ab, bc, ca] = nodes;
        Self {
            kind: ElementKind::Triangle,
            nodes: [a, b, c, ab, bc, ca, 0, 0],
            thickness: 1.0,
        }
    }

    /// The same element with the thickness `part`, as a part of the body's.
    pub const fn of_thickness(self, part: f64) -> Self {
        Self {
            thickness: part,
            ..self
        }
    }

    /// The same element with other numbers for its nodes.
    pub fn renumbered(mut self, number: impl Fn(u32) -> u32) -> Self {
        let count = self.nodes().len();
        for node in &mut self.nodes[..count] {
            *node = number(*node);
        }
        self
    }

    /// Its shape.
    pub const fn kind(&self) -> ElementKind {
        self.kind
    }

    /// Its nodes: corners, then midsides.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.kind.node_places().len()]
    }

    /// Its nodes in the order in which one meets them around it, counter-clockwise from corner 0.
    pub fn outline(&self) -> impl Iterator<Item = u32> {
        let corners = self.kind.corner_count();
        (0..corners).flat_map(move |i| [self.nodes[i], self.nodes[corners + i]])
    }

    /// Its thickness as a part of the body's, so that a part of the body's own thickness changes no digit.
    pub const fn thickness(&self) -> f64 {
        self.thickness
    }

    /// The places of its nodes among `all`; the origin beyond those of a triangle.
    pub fn places(&self, all: &[Vector]) -> [Vector; MOST_NODES] {
        let mut places = [Vector::zeros(); MOST_NODES];
        for (place, node) in places.iter_mut().zip(self.nodes()) {
            *place = all[*node as usize];
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [ElementKind; 2] = [ElementKind::Quadrilateral, ElementKind::Triangle];

    #[test]
    fn shape_functions_are_one_at_their_node_and_sum_to_one() {
        for kind in KINDS {
            for (i, (xi, eta)) in kind.node_places().iter().enumerate() {
                for (j, value) in kind.values(*xi, *eta).iter().enumerate() {
                    assert_eq!(*value, f64::from(u8::from(i == j)));
                }
            }
            let sum: f64 = kind.values(0.21, 0.43).iter().sum();
            assert!((sum - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        let step = 1e-6;
        for kind in KINDS {
            let (xi, eta) = (0.21, 0.43);
            let by = |d_xi: f64, d_eta: f64| {
                let (up, down) = (
                    kind.values(xi + d_xi, eta + d_eta),
                    kind.values(xi - d_xi, eta - d_eta),
                );
                std::array::from_fn::<_, MOST_NODES, _>(|i| (up[i] - down[i]) / (2.0 * step))
            };
            let (by_xi, by_eta) = (by(step, 0.0), by(0.0, step));
            for (i, (d_xi, d_eta)) in kind.derivatives(xi, eta).iter().enumerate() {
                // Central differences are exact for parabolas but for rounding, and to step² for the quadrilateral's cubics.
                assert!((d_xi - by_xi[i]).abs() < 1e-9 && (d_eta - by_eta[i]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn rules_are_exact_to_the_fifth_degree() {
        for a in 0..=5 {
            for b in 0..=5 - a {
                let sum = |kind: ElementKind| -> f64 {
                    let terms = kind.rule().iter();
                    terms.map(|(xi, eta, w)| w * xi.powi(a) * eta.powi(b)).sum()
                };
                let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
                let triangle = factorial(a) * factorial(b) / factorial(a + b + 2);
                assert!((sum(ElementKind::Triangle) - triangle).abs() < 1e-16);
                let line = |n: i32| {
                    if n % 2 == 0 {
                        2.0 / f64::from(n + 1)
                    } else {
                        0.0
                    }
                };
                assert!((sum(ElementKind::Quadrilateral) - line(a) * line(b)).abs() < 1e-15);
            }
        }
    }
}
