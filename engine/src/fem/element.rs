//! The 8-node serendipity quadrilateral in plane stress.

use nalgebra::{Matrix2, SMatrix};

use crate::gear::{Material, Vector};
use crate::quadrature::GAUSS_3;

/// The stiffness of one element: 16 x 16, unknowns (u_x, u_y) node by node.
pub type ElementStiffness = SMatrix<f64, 16, 16>;

/// The local coordinates (ξ, η) of the nodes: corners, then midsides.
pub const NODES: [(f64, f64); 8] = [
    (-1.0, -1.0),
    (1.0, -1.0),
    (1.0, 1.0),
    (-1.0, 1.0),
    (0.0, -1.0),
    (1.0, 0.0),
    (0.0, 1.0),
    (-1.0, 0.0),
];

/// The derivatives (∂N/∂ξ, ∂N/∂η) of the eight shape functions at (ξ, η).
pub fn shape_derivatives(xi: f64, eta: f64) -> [(f64, f64); 8] {
    let mut derivatives = [(0.0, 0.0); 8];
    for (derivative, (a, b)) in derivatives.iter_mut().zip(NODES) {
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

/// The derivatives (∂N/∂x, ∂N/∂y) and the Jacobian's determinant at (ξ, η) of the element on `nodes`.
pub fn gradients(nodes: &[Vector; 8], xi: f64, eta: f64) -> ([(f64, f64); 8], f64) {
    let local = shape_derivatives(xi, eta);
    let mut jacobian = Matrix2::zeros();
    for (node, (dxi, deta)) in nodes.iter().zip(local) {
        jacobian[(0, 0)] += dxi * node.x;
        jacobian[(0, 1)] += dxi * node.y;
        jacobian[(1, 0)] += deta * node.x;
        jacobian[(1, 1)] += deta * node.y;
    }
    let det = jacobian.determinant();
    let mut global = [(0.0, 0.0); 8];
    for (g, (dxi, deta)) in global.iter_mut().zip(local) {
        *g = (
            (jacobian[(1, 1)] * dxi - jacobian[(0, 1)] * deta) / det,
            (jacobian[(0, 0)] * deta - jacobian[(1, 0)] * dxi) / det,
        );
    }
    (global, det)
}

/// The stiffness of the element on `nodes`, of thickness `thickness`, by the 3 x 3 Gauss rule.
///
/// Plane stress: D = E/(1 − ν²) [[1, ν, 0], [ν, 1, 0], [0, 0, (1 − ν)/2]].
pub fn stiffness(nodes: &[Vector; 8], material: &Material, thickness: f64) -> ElementStiffness {
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let d = e / (1.0 - nu * nu);
    let g = e / (2.0 * (1.0 + nu));
    let mut k = ElementStiffness::zeros();
    for (xi, w_xi) in GAUSS_3 {
        for (eta, w_eta) in GAUSS_3 {
            let (gradient, det) = gradients(nodes, xi, eta);
            let weight = w_xi * w_eta * det * thickness;
            let (dd, dn, dg) = (d * weight, d * nu * weight, g * weight);
            for (j, &(xj, yj)) in gradient.iter().enumerate() {
                let (ddx, ddy, dnx, dny) = (dd * xj, dd * yj, dn * xj, dn * yj);
                let (dgx, dgy) = (dg * xj, dg * yj);
                for (i, &(xi, yi)) in gradient.iter().enumerate().take(j + 1) {
                    k[(2 * i, 2 * j)] += xi * ddx + yi * dgy;
                    k[(2 * i, 2 * j + 1)] += xi * dny + yi * dgx;
                    k[(2 * i + 1, 2 * j)] += yi * dnx + xi * dgy;
                    k[(2 * i + 1, 2 * j + 1)] += yi * ddy + xi * dgx;
                }
            }
        }
    }
    for j in 0..16 {
        for i in j + 1..16 {
            k[(i, j)] = k[(j, i)];
        }
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Material = Material {
        youngs_modulus: 210e9,
        poisson_ratio: 0.3,
        density: 7850.0,
    };

    /// A distorted element with curved sides.
    fn distorted() -> [Vector; 8] {
        let mut nodes = NODES.map(|(x, y)| {
            Vector::new(
                1e-3 * (x + 0.2 * y + 0.1 * x * y),
                1e-3 * (0.8 * y - 0.15 * x),
            )
        });
        nodes[4] += Vector::new(0.02e-3, -0.05e-3);
        nodes[6] += Vector::new(0.01e-3, 0.04e-3);
        nodes
    }

    #[test]
    fn a_rigid_motion_strains_nothing() {
        let nodes = distorted();
        let k = stiffness(&nodes, &STEEL, 20e-3);
        for motion in [
            |_: Vector| Vector::new(1.0, 0.0),
            |_| Vector::new(0.0, 1.0),
            |p: Vector| Vector::new(-p.y, p.x) * 1e3,
        ] {
            let u = SMatrix::<f64, 16, 1>::from_iterator(
                nodes.iter().flat_map(|&p| [motion(p).x, motion(p).y]),
            );
            assert!(
                (k * u).amax() < 1e-11 * k.amax(),
                "forces of a rigid motion vanish to rounding"
            );
        }
        assert!((k - k.transpose()).amax() == 0.0);
    }

    #[test]
    fn a_linear_field_has_the_energy_of_its_constant_stress() {
        // u = (a x, 0): energy = 1/2 E/(1-nu^2) a^2 V, with the area by the same isoparametric rule.
        let nodes = distorted();
        let k = stiffness(&nodes, &STEEL, 20e-3);
        let a = 1e-3;
        let u = SMatrix::<f64, 16, 1>::from_iterator(nodes.iter().flat_map(|p| [a * p.x, 0.0]));
        let area: f64 = GAUSS_3
            .iter()
            .flat_map(|&(x, wx)| GAUSS_3.iter().map(move |&(y, wy)| (x, y, wx * wy)))
            .map(|(x, y, w)| w * gradients(&nodes, x, y).1)
            .sum();
        let energy = 0.5 * 210e9 / (1.0 - 0.09) * a * a * area * 20e-3;
        assert!(((u.transpose() * k * u)[0] / 2.0 / energy - 1.0).abs() < 1e-12);
    }
}
