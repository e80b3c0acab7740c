//! Results in the form from which files for other programs are made.

use std::f64::consts::TAU;

use meshwright_engine::dynamics::{FlankRows, ForceTable};
use meshwright_exchange::force_table::MeshForces;
use meshwright_exchange::look_up::LookUp;

use super::{CurveDocument, Results};

impl Results {
    /// The force table with the lever arms that turn it into torques; `None` if there is none.
    pub fn mesh_forces(&self) -> Option<MeshForces> {
        let (pair, table) = (&self.pair, self.force_table.as_ref()?);
        let rows = |rows: &[Vec<f64>], convert: fn(f64) -> f64| {
            let row = |row: &Vec<f64>| row.iter().copied().map(convert).collect();
            rows.iter().map(row).collect::<Vec<Vec<f64>>>()
        };
        let flank = |delta: &[Vec<f64>], stiffness: &[Vec<f64>]| FlankRows {
            delta: rows(delta, |um| um * 1e-6),
            compliance: (!stiffness.is_empty())
                .then(|| rows(stiffness, |k| if k > 0.0 { 1.0 / k } else { 0.0 })),
        };
        let flanks = [
            flank(
                &table.transmission_error_um,
                &table.mesh_stiffness_tangent_n_per_m,
            ),
            flank(
                &table.other_flank_transmission_error_um,
                &table.other_flank_mesh_stiffness_tangent_n_per_m,
            ),
        ];
        let base_radii = self.base_radii();
        Some(MeshForces {
            table: ForceTable::new(pair.period_mesh_periods, table.load_n.clone(), flanks).ok()?,
            base_radii,
            tooth_count: self.tooth_counts()[0],
            method: self.method.to_string(),
        })
    }

    /// The teeth of the driving and the driven gear: their base circles over the base pitch.
    pub fn tooth_counts(&self) -> [f64; 2] {
        let pitch = self.pair.base_pitch_mm * 1e-3;
        self.base_radii()
            .map(|radius| (TAU * radius / pitch).round())
    }

    /// One curve of these results as a look-up table. `None` where it spans no whole true period: it could not be repeated.
    pub fn look_up<'a>(&'a self, curve: &'a CurveDocument) -> Option<LookUp<'a>> {
        let positions = &curve.mesh_position;
        let step = positions.get(1)? - positions.first()?;
        let periods = (step * positions.len() as f64).round();
        let true_period = f64::from(self.pair.period_mesh_periods);
        if true_period <= 0.0 || periods <= 0.0 || periods % true_period != 0.0 {
            return None;
        }
        Some(LookUp {
            method: &self.method,
            output_torque: curve.output_torque_n_m,
            load: curve.load_n,
            base_radii: self.base_radii(),
            periods,
            angles_deg: [&curve.driving_angle_deg, &curve.driven_angle_deg],
            stiffness: &curve.mesh_stiffness_tangent_n_per_m,
            transmission_error_um: &curve.transmission_error_um,
        })
    }

    /// In m, driving and driven.
    fn base_radii(&self) -> [f64; 2] {
        [&self.pair.driving, &self.pair.driven].map(|gear| gear.base_radius_mm * 1e-3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::STUB;

    #[test]
    fn a_span_that_cannot_be_repeated_has_no_table() {
        let mut results = Results::read(STUB).expect("a results document");
        results.curves[0].mesh_position = vec![0.0, 0.5, 1.0, 1.5];
        let has_one = |results: &Results| results.look_up(&results.curves[0]).is_some();
        for (period, expected) in [(2, true), (1, true), (5, false), (0, false)] {
            results.pair.period_mesh_periods = period;
            assert_eq!(has_one(&results), expected, "{period}");
        }
    }

    #[test]
    fn results_without_a_table_have_none() {
        let mut results = Results::read(STUB).expect("a results document");
        results.force_table = None;
        assert!(results.mesh_forces().is_none());
    }
}
