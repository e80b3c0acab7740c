//! Loads inside the teeth, the same in all of them, such as the pull of rotation.

use faer::Mat;

use super::axes::tooth_angle;
use super::teeth::TeethRing;
use super::tooth::{ToothLoads, ToothRows, ToothSubstructure};
use crate::fem::FemError;
use crate::run::Run;

/// Loads that are the same in all teeth of a ring.
#[derive(Debug, Clone)]
pub(crate) struct TeethLoads {
    /// The forces that they exert on the harmonics of the interface circle, a load a column.
    pub forces: Mat<f64>,
    /// How they move the unknowns of every flank while that circle is held, a load a column.
    pub flank: Mat<f64>,
    /// The functionals of every tooth while that circle is held: one functional a row, one load a column.
    pub values: Mat<f64>,
}

impl TeethLoads {
    /// Transfers the `loads` of `tooth`, and the values of its `rows` under them, to the ring of such teeth on the harmonics of `ring`.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub(crate) fn new(
        tooth: &ToothSubstructure,
        (rows, loads): (&ToothRows, &ToothLoads),
        ring: &TeethRing,
        run: &Run,
    ) -> Result<Self, FemError> {
        let (sector, harmonics) = (&tooth.sector, &ring.harmonics);
        let on_circle = sector.ring_rows(&loads.on_interface, harmonics, run)?;
        let values = sector.under_equal_loads(&rows.by_interface, &loads.on_interface, run)?;
        // The modes do work on the interface as it moves.
        let modes = tooth.mode_forces.transpose().to_owned();
        let moved = sector.under_equal_loads(&modes, &loads.on_interface, run)?;
        Ok(Self {
            forces: harmonics.of_all_sectors(on_circle.as_ref(), sector.count),
            flank: &loads.flank + &tooth.modes * moved,
            values: &loads.values + values,
        })
    }
}

impl TeethRing {
    /// How the motion `q` of the interface circle moves the unknowns of the flank of tooth `i`, whose loading modes are `modes`.
    pub fn flank_moved(&self, modes: &Mat<f64>, i: usize, q: &[f64]) -> Vec<f64> {
        let orders: Vec<usize> = (0..=self.harmonics.largest).collect();
        let patterns = self.patterns_of_tooth_at(tooth_angle(i, self.tooth_count), &orders);
        let q = Mat::from_fn(q.len(), 1, |j, _| q[j]);
        let moved = modes * (self.pattern_shares.transpose() * (patterns.transpose() * q));
        moved.col_as_slice(0).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::interface::{default_interface_radius, harmonics};
    use crate::fem::recovery::{Functional, edge_stresses};
    use crate::gear::SpurGear;
    use crate::gear::spur::tests::paper_gear;
    use crate::grid::{GridLevel, ToothGrid};
    use crate::ring::teeth_recovery::TeethRecovery;
    use crate::ring::tooth::modal_loads;

    #[test]
    fn a_force_in_every_tooth_does_the_same_as_the_force_on_every_flank() {
        // 25 teeth, all of which are coupled with each other.
        let (teeth, level, run) = (25_usize, GridLevel::Coarse, Run::unattended());
        let gear = SpurGear::new(paper_gear(teeth as u32)).expect("can be made");
        let radius = default_interface_radius(&gear);
        let grid = ToothGrid::new(&gear, radius, level).expect("a sound grid");
        let orders = harmonics(&gear, radius, level);
        let place = grid.flank_nodes.len() / 2;
        let normal = gear.flank().normal(grid.flank_roll_lengths[place]);
        let load = Functional::displacement(grid.flank_nodes[place], normal);
        let asked = edge_stresses(&grid.grid, gear.material(), &grid.fillet_nodes, false);
        let made = ToothSubstructure::loaded(&gear, &grid, &asked, &[load]);
        let (tooth, rows, loads) = made.expect("a stiff tooth");
        let ring = TeethRing::new(&tooth, orders, &run).expect("a stiff ring");
        let found = TeethLoads::new(&tooth, (&rows, &loads), &ring, &run).expect("stiff");

        let mut force = vec![0.0; tooth.fixed_compliance.nrows()];
        force[2 * place] = 1.0;
        let modal = modal_loads(&tooth.modes, &force);
        let all: Vec<_> = (0..teeth).map(|j| (j, modal.clone())).collect();
        let recovery = TeethRecovery::new(&tooth, &rows, orders, &run).expect("stiff");
        let still = vec![0.0; orders.unknowns()];
        let expected = recovery.values(3, &force, &all, &still);
        let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        for (one, other) in expected.iter().zip(found.values.col_as_slice(0)) {
            assert!(
                (one - other).abs() < 1e-7 * most(&expected),
                "{one} {other}"
            );
        }

        let loads = Mat::from_fn(modal.len(), 1, |i, _| modal[i]);
        let shares = &ring.pattern_shares * &loads;
        let mut sum = Mat::<f64>::zeros(orders.unknowns(), 1);
        for j in 0..teeth {
            let angle = tooth_angle(j, teeth);
            sum += ring.forces_of_tooth_at(angle, shares.col_as_slice(0));
        }
        let apart = (&sum - &found.forces).norm_max();
        assert!(apart < 1e-7 * sum.norm_max(), "{apart:e}");

        let mut moved = ring.held_coupling[0].clone();
        for coupling in &ring.held_coupling[1..=teeth / 2] {
            moved += coupling + coupling.transpose();
        }
        let moved = &tooth.modes * (moved * loads);
        let largest = tooth.fixed_compliance[(2 * place, 2 * place)];
        for i in 0..force.len() {
            let expected = tooth.fixed_compliance[(i, 2 * place)] + moved[(i, 0)];
            let apart = (expected - found.flank[(i, 0)]).abs();
            assert!(apart < 1e-7 * largest, "{i}: {expected:e} {apart:e}");
        }
    }
}
