//! The ring of all teeth of a gear on their interface circle.

use faer::{Mat, c64};

use super::cyclic::{Component, Harmonics};
use super::modes::compress;
use super::tooth::ToothSubstructure;
use crate::fem::FemError;
use crate::run::Run;

/// Largest distance, in teeth, of two teeth of one section that may be loaded together: several times the transverse contact ratio under the heaviest load of
/// any gear that can be drawn.
pub const FARTHEST_COUPLED: usize = 16;

/// The ring of all teeth of a gear, condensed to the harmonics of the interface circle.
#[derive(Debug, Clone)]
pub struct TeethRing {
    /// The harmonics.
    pub harmonics: Harmonics,
    /// The stiffness of all teeth together on the harmonics.
    pub stiffness: Mat<f64>,
    /// The forces on the harmonics that the unit modes of tooth 0 exert are G W: here G, real unknowns by the few patterns
    /// of which they consist.
    pub force_patterns: Mat<f64>,
    /// W: how much of each pattern a mode exerts.
    pub pattern_shares: Mat<f64>,
    /// The number Z of teeth.
    pub tooth_count: usize,
    /// X_d: the answer of tooth 0 to the modes of tooth d, with the interface circle held; d = 0 … [`FARTHEST_COUPLED`].
    pub held_coupling: Vec<Mat<f64>>,
}

impl TeethRing {
    /// Joins Z copies of `tooth`.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub fn new(
        tooth: &ToothSubstructure,
        harmonics: Harmonics,
        run: &Run,
    ) -> Result<Self, FemError> {
        let sector = &tooth.sector;
        let (z, r) = (sector.count, tooth.mode_count());
        let ns = 2 * sector.side_nodes;
        let forces = &tooth.mode_forces;
        let mut stiffness = Mat::zeros(harmonics.unknowns(), harmonics.unknowns());
        let mut tooth_forces = Mat::<f64>::zeros(harmonics.unknowns(), r);
        let mut class_compliance = Vec::with_capacity(z / 2 + 1);
        for class in 0..=z / 2 {
            let (condensed, solution) = sector.condense_class(class, &harmonics, run)?;
            sector.add_class(
                &mut stiffness,
                &harmonics,
                class,
                &condensed,
                &solution.orders,
            );

            // Work of the modes on the sides and on the arc, as amplitudes of this class.
            let turn = sector.turn(class, 1);
            let mut on_sides = Mat::<c64>::from_fn(ns, r, |i, j| {
                c64::new(forces[(i, j)], 0.0) + turn.conj() * forces[(ns + i, j)]
            });
            let arc = Mat::<c64>::from_fn(2 * sector.arc_angles.len(), r, |i, j| {
                c64::new(forces[(2 * ns + i, j)], 0.0)
            });
            let mut on_harmonics = sector.arc_of_harmonics(&solution.orders).adjoint() * arc;
            let loads = on_sides.clone();
            if let Some(sides) = &solution.sides {
                sides.solve_in_place(on_sides.as_mut());
                on_harmonics -= solution.sides_to_harmonics.adjoint() * &on_sides;
            }
            class_compliance.push(loads.adjoint() * &on_sides);
            add_forces(
                &mut tooth_forces,
                &harmonics,
                &on_harmonics,
                &solution.orders,
            );
        }
        let held_coupling = (0..=FARTHEST_COUPLED)
            .map(|d| held_coupling(&class_compliance, z, d))
            .collect();
        // Modes that hardly show at the flank need fewer digits, and on their way to the interface circle their fields grow
        // similar: they exert about half as many patterns as they are.
        let heights: Vec<f64> = tooth.modes.col_iter().map(|mode| mode.norm_l2()).collect();
        let seen = Mat::from_fn(tooth_forces.nrows(), r, |i, j| {
            tooth_forces[(i, j)] * heights[j]
        });
        let (force_patterns, shares) = compress(&seen).ok_or(FemError::NotPositiveDefinite {
            part: "the forces of the teeth",
            unknowns: r,
        })?;
        let pattern_shares = Mat::from_fn(shares.ncols(), r, |i, j| shares[(j, i)] / heights[j]);
        Ok(Self {
            harmonics,
            stiffness,
            force_patterns,
            pattern_shares,
            tooth_count: z,
            held_coupling,
        })
    }

    /// G on the harmonics of `orders`, order by order, for the tooth at `angle`.
    pub fn patterns_of_tooth_at(&self, angle: f64, orders: &[usize]) -> Mat<f64> {
        self.harmonics.rows_at(&self.force_patterns, angle, orders)
    }

    /// G f on all harmonics for the tooth at `angle` with the loads f on its patterns.
    pub fn forces_of_tooth_at(&self, angle: f64, loads: &[f64]) -> Mat<f64> {
        let loads = Mat::from_fn(loads.len(), 1, |i, _| loads[i]);
        let orders: Vec<usize> = (0..=self.harmonics.largest).collect();
        let forces = &self.force_patterns * loads;
        self.harmonics.rows_at(&forces, angle, &orders)
    }
}

/// Turns complex forces on the orders of one class, and their conjugates, into forces on a_n and b_n.
fn add_forces(
    forces: &mut Mat<f64>,
    harmonics: &Harmonics,
    on_harmonics: &Mat<c64>,
    orders: &[i64],
) {
    for (i, &n) in orders.iter().enumerate() {
        // Each order is visited once: its conjugate −n is either in the conjugate class or in this one.
        let conjugate_here = n != 0 && orders.contains(&-n);
        if conjugate_here && n < 0 {
            continue;
        }
        let sign = n.signum() as f64;
        for (c, component) in [Component::Radial, Component::Tangential]
            .into_iter()
            .enumerate()
        {
            let a = harmonics.cosine(n.unsigned_abs() as usize, component);
            for j in 0..forces.ncols() {
                let force = on_harmonics[(2 * i + c, j)];
                forces[(a, j)] += force.re;
                if n != 0 {
                    forces[(a + 2, j)] -= sign * force.im;
                }
            }
        }
    }
}

/// X_d = (1/Z) Σ_classes e^{−i class 2π d/Z} ĝᴴ K_s⁻¹ ĝ.
fn held_coupling(class_compliance: &[Mat<c64>], z: usize, d: usize) -> Mat<f64> {
    let r = class_compliance[0].nrows();
    let mut sum = Mat::<f64>::zeros(r, r);
    for (class, compliance) in class_compliance.iter().enumerate() {
        let weight = if (2 * class).is_multiple_of(z) {
            1.0
        } else {
            2.0
        } / z as f64;
        let (sin, cos) =
            (2.0 * std::f64::consts::PI * ((class * d) % z) as f64 / z as f64).sin_cos();
        let turn = c64::new(cos, -sin);
        for j in 0..r {
            for i in 0..r {
                sum[(i, j)] += weight * (turn * compliance[(i, j)]).re;
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::ring::cyclic::tests::{arc, assembled, sector};

    /// A tooth with only the data of the ring: a sector, and two loading modes on all its unknowns.
    fn tooth(count: usize, side_nodes: usize) -> ToothSubstructure {
        let sector = sector(count, side_nodes);
        let n = sector.stiffness.nrows();
        ToothSubstructure {
            fixed_compliance: Mat::zeros(0, 0),
            modes: Mat::identity(2, 2),
            roll_lengths: Vec::new(),
            flank_points: Vec::new(),
            grid_nodes: 0,
            mode_forces: Mat::from_fn(n, 2, |i, j| (2.0 + (3 * i + 7 * j) as f64).cos()),
            sector,
        }
    }

    #[test]
    fn forces_of_teeth_reach_the_harmonics_and_each_other_as_in_the_ring_assembled_sector_by_sector()
     {
        for (count, side_nodes, largest) in [(1, 2, 3), (3, 2, 7), (4, 1, 2), (4, 3, 9), (5, 2, 11)]
        {
            let (tooth, harmonics) = (tooth(count, side_nodes), Harmonics { largest });
            let ring = TeethRing::new(&tooth, harmonics, &Run::unattended()).expect("definite");
            let ns = 2 * side_nodes;
            let (sides, nq) = (ns * count, harmonics.unknowns());
            let whole = assembled(&tooth.sector, &harmonics);
            let held = whole
                .view((0, 0), (sides, sides))
                .clone_owned()
                .cholesky()
                .expect("definite");
            let coupling = whole.view((0, sides), (sides, nq)).clone_owned();
            let forces = DMatrix::from_fn(tooth.mode_forces.nrows(), 2, |i, j| {
                tooth.mode_forces[(i, j)]
            });
            let on_sides = |tooth: usize| {
                let mut loads = DMatrix::<f64>::zeros(sides, 2);
                for j in 0..2 {
                    for c in 0..ns {
                        loads[(tooth * ns + c, j)] += forces[(c, j)];
                        loads[((tooth + 1) % count * ns + c, j)] += forces[(ns + c, j)];
                    }
                }
                loads
            };
            for i in 0..count {
                // F = f_q − K_qs K_ss⁻¹ f_s, and X_d = f_s(0)ᵀ K_ss⁻¹ f_s(d).
                let solved = held.solve(&on_sides(i));
                let on_arc = forces.rows(2 * ns, forces.nrows() - 2 * ns);
                let expected = arc(&tooth.sector, &harmonics, i).transpose() * on_arc
                    - coupling.transpose() * &solved;
                let angle = 2.0 * std::f64::consts::PI * i as f64 / count as f64;
                let orders: Vec<usize> = (0..=largest).collect();
                let reached = ring.patterns_of_tooth_at(angle, &orders) * &ring.pattern_shares;
                for q in 0..nq {
                    for j in 0..2 {
                        let apart = (reached[(q, j)] - expected[(q, j)]).abs();
                        assert!(
                            apart < 1e-10 * expected.amax(),
                            "{count} sectors, tooth {i}, ({q}, {j}): {apart}"
                        );
                    }
                }
                let answer = on_sides(0).transpose() * &solved;
                for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let apart = (ring.held_coupling[i][(a, b)] - answer[(a, b)]).abs();
                    assert!(
                        apart < 1e-10 * answer.amax(),
                        "{count} sectors, neighbor {i}: {apart}"
                    );
                }
            }
        }
    }
}
