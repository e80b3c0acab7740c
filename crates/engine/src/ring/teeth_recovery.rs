//! Response inside the teeth to loads on the flanks and to the motion of the interface circle.

use faer::{Mat, c64};

use super::cyclic::Harmonics;
use super::teeth::FARTHEST_COUPLED;
use super::tooth::{ToothRows, ToothSubstructure};
use crate::fem::FemError;
use crate::run::Run;

/// Functionals of one tooth, such as the stresses along its fillet, by loads on the ring of teeth.
///
/// The functionals of tooth i are R_p p_i + Σ_j R_{j−i} m_j + R_q q_i: p_i the forces on its own flank, m_j = Vᵀ p_j the modal
/// loads of tooth j ([`super::tooth::modal_loads`]), which reach it through the sides of the sectors between, and q_i the
/// amplitudes of the whole interface circle ([`super::motion::InterfaceMotion`]) seen from the tooth.
#[derive(Debug, Clone)]
pub struct TeethRecovery {
    harmonics: Harmonics,
    tooth_count: usize,
    /// R_p, by flank unknowns.
    by_flank: Mat<f64>,
    /// R_d, by the modes of the tooth d places counter-clockwise, for d from −reach to reach.
    by_modes: Vec<Mat<f64>>,
    /// R_q, by harmonics.
    by_harmonics: Mat<f64>,
}

impl TeethRecovery {
    /// Brings the functionals `rows` of `tooth` to the ring of Z such teeth on `harmonics`.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub fn new(
        tooth: &ToothSubstructure,
        rows: &ToothRows,
        harmonics: Harmonics,
        run: &Run,
    ) -> Result<Self, FemError> {
        let sector = &tooth.sector;
        let (z, r, ns) = (sector.count, tooth.mode_count(), 2 * sector.side_nodes);
        let (forces, rows_b) = (&tooth.mode_forces, &rows.by_interface);
        let reach = FARTHEST_COUPLED.min((z - 1) / 2);
        let mut by_harmonics = Mat::zeros(rows_b.nrows(), harmonics.unknowns());
        let mut by_modes = vec![Mat::<f64>::zeros(rows_b.nrows(), r); 2 * reach + 1];
        for class in 0..=z / 2 {
            let (_, solution) = sector.condense_class(class, &harmonics, run)?;
            let on_harmonics = sector.class_rows(rows_b, class, &solution);
            for (j, &n) in solution.orders.iter().enumerate() {
                harmonics.set_rows(&mut by_harmonics, n, on_harmonics.subcols(2 * j, 2));
            }
            let Some(sides) = &solution.sides else {
                continue;
            };
            // The sides of this class under unit modal loads.
            let turn = sector.turn(class, 1);
            let mut moved = Mat::<c64>::from_fn(ns, r, |i, j| {
                c64::new(forces[(i, j)], 0.0) + turn.conj() * forces[(ns + i, j)]
            });
            sides.solve_in_place(moved.as_mut());
            let answer = sector.side_rows(rows_b, class) * moved;
            let classes = if (2 * class).is_multiple_of(z) {
                1.0
            } else {
                2.0
            };
            for (place, rows) in by_modes.iter_mut().enumerate() {
                let distance = place + z - reach;
                let turn = sector.turn(class, distance).conj();
                for j in 0..r {
                    for i in 0..rows.nrows() {
                        rows[(i, j)] += classes / z as f64 * (turn * answer[(i, j)]).re;
                    }
                }
            }
        }
        Ok(Self {
            harmonics,
            tooth_count: z,
            by_flank: rows.by_flank.clone(),
            by_modes,
            by_harmonics,
        })
    }

    /// The number of functionals of a tooth.
    pub fn count(&self) -> usize {
        self.by_flank.nrows()
    }

    /// The functionals of tooth `tooth`.
    ///
    /// `flank_forces` are the forces on the unknowns of its own flank, in N; `modal_loads` those of every loaded tooth with its
    /// number, its own among them; `motion` are the amplitudes of the interface circle in the frame of the gear, in meters.
    /// Loads farther off than [`FARTHEST_COUPLED`] teeth reach it through the circle only.
    pub fn values(
        &self,
        tooth: usize,
        flank_forces: &[f64],
        modal_loads: &[(usize, Vec<f64>)],
        motion: &[f64],
    ) -> Vec<f64> {
        let z = self.tooth_count;
        let reach = self.by_modes.len() / 2;
        let seen = self
            .harmonics
            .turned(motion, super::axes::tooth_angle(tooth, z));
        let mut values = vec![0.0; self.count()];
        let mut add = |rows: &Mat<f64>, by: &[f64]| {
            for (j, by) in by.iter().enumerate().filter(|(_, by)| **by != 0.0) {
                for (value, row) in values.iter_mut().zip(rows.col_as_slice(j)) {
                    *value += row * by;
                }
            }
        };
        add(&self.by_flank, flank_forces);
        add(&self.by_harmonics, &seen);
        for (loaded, loads) in modal_loads {
            // How many places counter-clockwise of this tooth, the nearer way round.
            let ahead = (loaded + z - tooth % z) % z;
            let place = if 2 * ahead <= z {
                reach + ahead
            } else {
                (reach + ahead).wrapping_sub(z)
            };
            if let Some(rows) = self.by_modes.get(place) {
                add(rows, loads);
            }
        }
        values
    }
}
