//! A blank by itself: an annulus with prescribed displacements of its outer circle, whose hub is free to turn (eqs. 11 and 12).

use faer::Mat;

use super::blank::BlankSubstructure;
use super::cyclic::Component;
use crate::fem::FemError;
use crate::fem::dense::Cholesky;

/// Components of the displacement of its circle that are imposed on an annulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Imposed {
    /// All of it, as eq. 12 has it.
    Whole,
    /// The tangential one; radially the circle is free of traction.
    Tangential,
}

/// An annulus from the rigid hub to the interface circle.
#[derive(Debug, Clone)]
pub struct Annulus {
    /// R_w.
    radius: f64,
    /// The amplitude of the axisymmetric tangential displacement.
    round: usize,
    /// The moment in N m about the axis that holds the circle when it moves by a unit amplitude, with the hub held.
    moments: Vec<f64>,
    /// The moment in N m that turns the hub by one radian, with the circle held.
    torsion: f64,
}

impl Annulus {
    /// The one that `blank` is with its hole 0 at `hole_angle`.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`].
    pub fn new(
        blank: &BlankSubstructure,
        hole_angle: f64,
        imposed: Imposed,
    ) -> Result<Self, FemError> {
        let (stiffness, radius) = (blank.stiffness_at(hole_angle), blank.interface_radius);
        let round = blank.harmonics.cosine(0, Component::Tangential);
        let mut moments: Vec<f64> = (0..stiffness.ncols())
            .map(|j| radius * stiffness[(round, j)])
            .collect();
        if imposed == Imposed::Tangential {
            // The circle moves radially until its force there is zero: its motion for a unit moment is subtracted.
            let radial: Vec<usize> = (0..moments.len()).filter(|i| i % 2 == 0).collect();
            let factor = Cholesky::new(Mat::from_fn(radial.len(), radial.len(), |i, j| {
                stiffness[(radial[i], radial[j])]
            }));
            let mut shares = Mat::from_fn(radial.len(), 1, |i, _| moments[radial[i]]);
            factor
                .ok_or(FemError::NotPositiveDefinite {
                    part: "the annulus",
                    unknowns: radial.len(),
                })?
                .solve_in_place(shares.as_mut());
            for (j, moment) in moments.iter_mut().enumerate() {
                for (i, row) in radial.iter().enumerate() {
                    *moment -= shares[(i, 0)] * stiffness[(*row, j)];
                }
            }
            for i in radial {
                moments[i] = 0.0;
            }
        }
        Ok(Self {
            radius,
            round,
            torsion: radius * moments[round],
            moments,
        })
    }

    /// Adds to the amplitudes `circle` those of a rotation of the circle by `angle`, counter-clockwise.
    pub fn turn(&self, circle: &mut [f64], angle: f64) {
        circle[self.round] += self.radius * angle;
    }

    /// The angle by which the hub turns, counter-clockwise, when the circle moves by the amplitudes `circle` and `torque` acts on
    /// the hub. Amplitudes beyond the harmonics of the blank do not reach it.
    pub fn hub_rotation(&self, circle: &[f64], torque: f64) -> f64 {
        let held: f64 = self.moments.iter().zip(circle).map(|(m, q)| m * q).sum();
        (held + torque) / self.torsion
    }
}
