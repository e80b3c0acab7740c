//! The stiffness of one element in plane stress.

use nalgebra::{Matrix2, SMatrix};

use super::law::Law;
use crate::gear::{Material, Vector};
use crate::grid::ElementKind;
use crate::grid::element::MOST_NODES;

/// The components of the displacement of a node.
pub(crate) const COMPONENTS: usize = 2;

/// The stiffness of one element, in N/m: unknowns (u_x, u_y) node by node. A triangle fills the first 12 rows and columns.
pub type ElementStiffness = SMatrix<f64, 16, 16>;

/// The derivatives (∂N/∂x, ∂N/∂y) of the shape functions and the Jacobian's determinant at (ξ, η) of the element on `nodes`.
pub(crate) fn gradients(
    kind: ElementKind,
    nodes: &[Vector; MOST_NODES],
    xi: f64,
    eta: f64,
) -> ([(f64, f64); MOST_NODES], f64) {
    let local = kind.derivatives(xi, eta);
    let mut jacobian = Matrix2::zeros();
    for (node, (dxi, deta)) in nodes.iter().zip(local) {
        jacobian[(0, 0)] += dxi * node.x;
        jacobian[(0, 1)] += dxi * node.y;
        jacobian[(1, 0)] += deta * node.x;
        jacobian[(1, 1)] += deta * node.y;
    }
    let det = jacobian.determinant();
    let mut global = [(0.0, 0.0); MOST_NODES];
    for (g, (dxi, deta)) in global.iter_mut().zip(local) {
        *g = (
            (jacobian[(1, 1)] * dxi - jacobian[(0, 1)] * deta) / det,
            (jacobian[(0, 0)] * deta - jacobian[(1, 0)] * dxi) / det,
        );
    }
    (global, det)
}

/// The stiffness of the element on `nodes`, of thickness `thickness` in meters, by its rule of degree 5.
pub fn stiffness(
    kind: ElementKind,
    nodes: &[Vector; MOST_NODES],
    material: &Material,
    thickness: f64,
) -> ElementStiffness {
    let law = Law::plane_stress(material);
    let mut k = ElementStiffness::zeros();
    let count = kind.node_places().len();
    for &(xi, eta, w) in kind.rule() {
        let (gradient, det) = gradients(kind, nodes, xi, eta);
        let weight = w * det * thickness;
        let (dd, dn, dg) = (law.along * weight, law.across * weight, law.shear * weight);
        for (j, &(xj, yj)) in gradient.iter().enumerate().take(count) {
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

    const KINDS: [ElementKind; 2] = [ElementKind::Quadrilateral, ElementKind::Triangle];

    /// A distorted element with curved sides.
    fn distorted(kind: ElementKind) -> [Vector; MOST_NODES] {
        let mut nodes = [Vector::zeros(); MOST_NODES];
        for (node, (x, y)) in nodes.iter_mut().zip(kind.node_places()) {
            *node = Vector::new(
                1e-3 * (x + 0.2 * y + 0.1 * x * y),
                1e-3 * (0.8 * y - 0.15 * x),
            );
        }
        let corners = kind.corner_count();
        nodes[corners] += Vector::new(0.02e-3, -0.05e-3);
        nodes[corners + 2] += Vector::new(0.01e-3, 0.04e-3);
        nodes
    }

    /// A displacement of every node of the element.
    fn field(
        kind: ElementKind,
        nodes: &[Vector; MOST_NODES],
        u: impl Fn(Vector) -> Vector,
    ) -> SMatrix<f64, 16, 1> {
        let mut all = SMatrix::<f64, 16, 1>::zeros();
        for i in 0..kind.node_places().len() {
            let u = u(nodes[i]);
            (all[2 * i], all[2 * i + 1]) = (u.x, u.y);
        }
        all
    }

    #[test]
    fn a_rigid_motion_strains_nothing() {
        for kind in KINDS {
            let nodes = distorted(kind);
            let k = stiffness(kind, &nodes, &Material::STEEL, 20e-3);
            for motion in [
                |_: Vector| Vector::new(1.0, 0.0),
                |_| Vector::new(0.0, 1.0),
                |p: Vector| Vector::new(-p.y, p.x) * 1e3,
            ] {
                let u = field(kind, &nodes, motion);
                assert!(
                    (k * u).amax() < 1e-11 * k.amax(),
                    "forces of a rigid motion vanish to rounding"
                );
            }
            assert!((k - k.transpose()).amax() == 0.0);
        }
    }

    #[test]
    fn only_the_rigid_motions_strain_nothing() {
        for kind in KINDS {
            let unknowns = 2 * kind.node_places().len();
            let k = stiffness(kind, &distorted(kind), &Material::STEEL, 20e-3);
            let own = k.view((0, 0), (unknowns, unknowns)).clone_owned();
            let own = nalgebra::DMatrix::from_fn(unknowns, unknowns, |i, j| own[(i, j)]);
            let energies = own.symmetric_eigenvalues();
            let soft = energies.iter().filter(|e| **e < 1e-6 * k.amax()).count();
            assert_eq!(soft, 3, "{kind:?}: {energies}");
        }
    }

    #[test]
    fn a_linear_field_has_the_energy_of_its_constant_stress() {
        // u = (a x, 0): energy = 1/2 E/(1-nu^2) a^2 V, with the area by the same isoparametric rule.
        for kind in KINDS {
            let nodes = distorted(kind);
            let k = stiffness(kind, &nodes, &Material::STEEL, 20e-3);
            let a = 1e-3;
            let u = field(kind, &nodes, |p| Vector::new(a * p.x, 0.0));
            let area: f64 = kind
                .rule()
                .iter()
                .map(|&(xi, eta, w)| w * gradients(kind, &nodes, xi, eta).1)
                .sum();
            let energy = 0.5 * 210e9 / (1.0 - 0.09) * a * a * area * 20e-3;
            assert!(((u.transpose() * k * u)[0] / 2.0 / energy - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_curved_triangle_is_integrated_as_well_as_by_the_rule_on_its_parts() {
        // The rule on each of the 64 parts of the reference triangle; two sides bulge by a twentieth of their length.
        let kind = ElementKind::Triangle;
        let nodes = distorted(kind);
        let k = stiffness(kind, &nodes, &Material::STEEL, 20e-3);
        let u = field(kind, &nodes, |p| {
            Vector::new(1e3 * p.x * p.y, p.y - 2e3 * p.x * p.x)
        });
        let (e, nu) = (210e9, 0.3);
        let parts = 8;
        let mut energy = 0.0;
        for i in 0..parts {
            for j in 0..parts - i {
                for (flip, inside) in [(1.0, true), (-1.0, i + j + 1 < parts)] {
                    for &(xi, eta, w) in kind.rule().iter().filter(|_| inside) {
                        let part = 1.0 / parts as f64;
                        let base = if flip > 0.0 { 0.0 } else { 1.0 };
                        let x = part * (i as f64 + base + flip * xi);
                        let y = part * (j as f64 + base + flip * eta);
                        let (gradient, det) = gradients(kind, &nodes, x, y);
                        let mut strain = [0.0; 3];
                        for (node, (dx, dy)) in gradient.iter().enumerate() {
                            let (ux, uy) = (u[2 * node], u[2 * node + 1]);
                            strain[0] += dx * ux;
                            strain[1] += dy * uy;
                            strain[2] += dy * ux + dx * uy;
                        }
                        let [exx, eyy, gxy] = strain;
                        let stress = e / (1.0 - nu * nu)
                            * (exx * exx + eyy * eyy + 2.0 * nu * exx * eyy)
                            + e / (2.0 * (1.0 + nu)) * gxy * gxy;
                        energy += w * part * part * det * stress * 20e-3 / 2.0;
                    }
                }
            }
        }
        let found = (u.transpose() * k * u)[0] / 2.0;
        assert!(
            (found / energy - 1.0).abs() < 1e-4,
            "{}",
            found / energy - 1.0
        );
    }
}
