//! The lists of a curve over its positions as columns of a table.

use super::curve::CurveDocument;
use super::stress::GearStressDocument;

impl CurveDocument {
    /// Its lists over mesh positions with the names of their columns; `None` where a value has no limit. A list that a version did not write is left out.
    pub fn columns(&self) -> Vec<(String, Vec<Option<f64>>)> {
        let pairs: Vec<f64> = self
            .pairs_in_contact
            .iter()
            .copied()
            .map(f64::from)
            .collect();
        let numbers = [
            ("mesh_position", &self.mesh_position),
            ("driving_angle_deg", &self.driving_angle_deg),
            ("driven_angle_deg", &self.driven_angle_deg),
            ("transmission_error_um", &self.transmission_error_um),
            (
                "mesh_stiffness_tangent_n_per_m",
                &self.mesh_stiffness_tangent_n_per_m,
            ),
            (
                "mesh_stiffness_secant_n_per_m",
                &self.mesh_stiffness_secant_n_per_m,
            ),
            ("driving_torque_n_m", &self.driving_torque_n_m),
            ("pairs_in_contact", &pairs),
        ];
        let numbers = numbers.map(|(name, list)| (name.to_owned(), known(list)));
        let pressures = self.peak_contact_pressure_mpa.clone();
        let gears = self
            .stress
            .iter()
            .flat_map(|stress| [("driving", &stress.driving), ("driven", &stress.driven)]);
        let stresses = gears.flat_map(|(gear, stress)| {
            let named =
                |(name, list): (&str, &Vec<f64>)| (format!("stress.{gear}.{name}"), known(list));
            stress.columns().map(named)
        });
        let shares = self.load_shares.iter();
        let shares = shares.map(|share| {
            (
                format!("load_share.{}", share.pair_offset),
                known(&share.share),
            )
        });
        let pressures = [("peak_contact_pressure_mpa".to_owned(), pressures)];
        let columns = numbers.into_iter().chain(pressures);
        let columns = columns.chain(stresses).chain(shares);
        columns.filter(|(_, list)| !list.is_empty()).collect()
    }
}

impl GearStressDocument {
    /// Its lists with their names.
    fn columns(&self) -> [(&'static str, &Vec<f64>); 12] {
        [
            ("root_mpa", &self.root_mpa),
            ("root_angle_deg", &self.root_angle_deg),
            ("root_z_mm", &self.root_z_mm),
            ("root_tension_mpa", &self.root_tension_mpa),
            ("root_tension_angle_deg", &self.root_tension_angle_deg),
            ("root_tension_z_mm", &self.root_tension_z_mm),
            ("root_compression_mpa", &self.root_compression_mpa),
            (
                "root_compression_angle_deg",
                &self.root_compression_angle_deg,
            ),
            ("root_compression_z_mm", &self.root_compression_z_mm),
            ("hole_mpa", &self.hole_mpa),
            ("hole_angle_deg", &self.hole_angle_deg),
            ("hole_z_mm", &self.hole_z_mm),
        ]
    }
}

fn known(list: &[f64]) -> Vec<Option<f64>> {
    list.iter().copied().map(Some).collect()
}
