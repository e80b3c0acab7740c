//! How a hub is carried: a shaft to the machine beside it, and a support of the whole gear body.
//!
//! The shaft twists between the hub and its far end, which turns evenly, at the angle at which the shaft carries the torque of F_0. The support is a stiffness
//! of the rigid body about the middle of its face, in a frame of the gear that stands still: x towards the mate, z along the axis. By it the body moves beside
//! its turn, and the teeth with it. Gyroscopic moments, and what displaced axes do to the contact itself, are left out.

use nalgebra::{Cholesky, DMatrix, Matrix6, SMatrix, SymmetricEigen};

/// Motions of a body beside its turn: along x, y and z, and about x and y.
pub const MOTIONS: usize = 5;

/// The place of the turn about z among the motions of a support's stiffness.
const TURN: usize = 5;

/// The part of the largest stiffness below which a motion counts as free.
const FREE: f64 = 1e-12;

/// The support of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// The stiffness to motions along x, y and z and about x, y and z, in N/m, N and N m.
    pub stiffness: Matrix6<f64>,
    /// Mass, its moment about the middle of the face, and inertia, for motions along x, y and z and about x and y, in kg, kg m and kg m².
    pub mass: SMatrix<f64, MOTIONS, MOTIONS>,
    /// By how much the teeth come nearer for each of these motions, along the transverse line of action.
    pub at_mesh: [f64; MOTIONS],
}

/// Support of a hub, beside the torque of its machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Mount {
    /// The torsional stiffness in N m/rad of the shaft; 0 without one.
    pub shaft: f64,
    /// The support; without one the axis stands still.
    pub support: Option<Support>,
}

impl Mount {
    /// An axis that stands still, and a torque that does not change.
    pub const NONE: Self = Self {
        shaft: 0.0,
        support: None,
    };

    /// True if it is more than that.
    pub fn is_elastic(&self) -> bool {
        self.shaft > 0.0 || self.support.is_some()
    }

    /// The number of motions beside the turn.
    pub(super) fn motions(&self) -> usize {
        self.support.as_ref().map_or(0, |_| MOTIONS)
    }

    /// Mass, stiffness and damping of a body with this polar inertia: of its turn first, then of its motions beside it. `sense` is 1 where the body turns
    /// about z, −1 where it turns against it. Each natural mode of the body on its mount alone has the damping ratio `damping`.
    pub(super) fn matrices(&self, inertia: f64, sense: f64, damping: f64) -> [DMatrix<f64>; 3] {
        let count = 1 + self.motions();
        let mut mass = DMatrix::from_element(1, 1, inertia).resize(count, count, 0.0);
        let mut stiffness = DMatrix::from_element(1, 1, self.shaft).resize(count, count, 0.0);
        if let Some(support) = &self.support {
            let of = &support.stiffness;
            stiffness[(0, 0)] += of[(TURN, TURN)];
            for i in 0..MOTIONS {
                stiffness[(0, 1 + i)] = sense * of[(TURN, i)];
                stiffness[(1 + i, 0)] = sense * of[(i, TURN)];
                for j in 0..MOTIONS {
                    stiffness[(1 + i, 1 + j)] = of[(i, j)];
                    mass[(1 + i, 1 + j)] = support.mass[(i, j)];
                }
            }
        }
        // With M = L Lᵀ the damping is 2 ζ L √(L⁻¹ K L⁻ᵀ) Lᵀ. Where M is none, the caller finds that out.
        let zero = DMatrix::zeros(count, count);
        let damper = Cholesky::new(mass.clone()).and_then(|factor| {
            let l = factor.l();
            let half = l.solve_lower_triangular(&stiffness)?;
            let whole = l.solve_lower_triangular(&half.transpose())?;
            let eigen = SymmetricEigen::new(0.5 * (&whole + whole.transpose()));
            let roots = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
            let root = &eigen.eigenvectors
                * DMatrix::from_diagonal(&roots)
                * eigen.eigenvectors.transpose();
            Some(2.0 * damping * &l * root * l.transpose())
        });
        [mass, stiffness, damper.unwrap_or(zero)]
    }
}

/// Rows of a stiffness to motions along x, y and z and about them.
pub type Rows = [[f64; MOTIONS + 1]; MOTIONS + 1];

/// The least eigenvalue of a symmetric stiffness, and the largest, in its own units.
pub fn extremes(rows: &Rows) -> [f64; 2] {
    let values = Matrix6::from_fn(|i, j| rows[i][j]).symmetric_eigenvalues();
    [values.min(), values.max()]
}

/// The part of the mesh force, whose motions are `at_mesh`, that a support of this `stiffness` leaves without a reaction. A `length` in m makes angles
/// lengths. A torque about z has the machine beside the gear against it.
pub fn unheld(stiffness: &Matrix6<f64>, at_mesh: &[f64; MOTIONS], length: f64) -> f64 {
    let scale = |i: usize| if i < 3 { 1.0 } else { 1.0 / length };
    let scaled = Matrix6::from_fn(|i, j| scale(i) * stiffness[(i, j)] * scale(j));
    let eigen = SymmetricEigen::new(scaled);
    let force: Vec<f64> = (0..MOTIONS).map(|i| scale(i) * at_mesh[i]).collect();
    let whole = force.iter().map(|f| f * f).sum::<f64>().sqrt();
    let free = |j: usize| eigen.eigenvalues[j] <= FREE * eigen.eigenvalues.max();
    let along = |j: usize| -> f64 {
        let mode = eigen.eigenvectors.column(j);
        force.iter().zip(mode.iter()).map(|(f, v)| f * v).sum()
    };
    let left: f64 = (0..TURN + 1)
        .filter(|j| free(*j))
        .map(|j| along(j).powi(2))
        .sum();
    left.sqrt() / whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_spring_holds_is_the_part_of_the_force_along_it() {
        // A force at 30° to the y axis, with a spring along y alone: the sine is left. A turn about z needs none.
        let at_mesh = [0.5, 0.75_f64.sqrt(), 0.0, 0.0, 0.0];
        let mut stiffness = Matrix6::zeros();
        stiffness[(1, 1)] = 1e8;
        assert!((unheld(&stiffness, &at_mesh, 0.05) - 0.5).abs() < 1e-12);
        stiffness[(0, 0)] = 3e8;
        assert!(unheld(&stiffness, &at_mesh, 0.05) < 1e-12);
        assert!((unheld(&Matrix6::zeros(), &at_mesh, 0.05) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn each_mode_of_a_body_on_its_mount_has_the_damping_ratio() {
        // x and the turn about y coupled by a center of mass off the middle: vᵀ C v = 2 ζ ω for the modes of K v = ω² M v, and the shaft's 2 ζ √(k J).
        let mut mass = SMatrix::<f64, 5, 5>::identity() * 2.0;
        (mass[(3, 3)], mass[(4, 4)]) = (4e-3, 4e-3);
        (mass[(0, 4)], mass[(4, 0)]) = (0.02, 0.02);
        (mass[(1, 3)], mass[(3, 1)]) = (-0.02, -0.02);
        let stiffness = Matrix6::from_diagonal(&[1e8, 2e8, 3e7, 1e5, 2e5, 0.0].into());
        let support = Support {
            stiffness,
            mass,
            at_mesh: [0.3, 0.9, 0.0, 0.0, 0.0],
        };
        let mount = Mount {
            shaft: 5e3,
            support: Some(support),
        };
        let [m, k, c] = mount.matrices(3e-3, -1.0, 0.04);
        assert!((c[(0, 0)] / (0.08 * (5e3_f64 * 3e-3).sqrt()) - 1.0).abs() < 1e-12);
        let inverse = m.clone().try_inverse().expect("masses");
        // C M⁻¹ C = 4 ζ² K holds for this damping and no other that is symmetric and positive.
        let square = &c * inverse * &c;
        let error = (square - 4.0 * 0.04 * 0.04 * &k).norm() / (4.0 * 0.04 * 0.04 * k.norm());
        assert!(error < 1e-12, "{error}");
    }
}
