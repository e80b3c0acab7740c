//! Evidence for a result: residuals, penetration, and the change by a finer run.

use super::Curve;
use crate::contact::MeshContact;

/// Estimate of the discretization error: the change by a finer run and the error of sampling, the largest over the torques.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorEstimate {
    /// In the mean of δ, in meters.
    pub mean: f64,
    /// In the peak-to-peak of δ, in meters.
    pub peak_to_peak: f64,
    /// In the mean tangent stiffness, in N/m.
    pub mean_stiffness: f64,
}

/// How well the equations that define the result are satisfied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Unknowns of both gears before condensation; zero for formulas.
    pub degrees_of_freedom: u64,
    /// The largest |T_2 by cross product − T|/T.
    pub equilibrium_residual: f64,
    /// The largest |p_j g_j|/(F δ_max).
    pub complementarity_residual: f64,
    /// The largest penetration left, in meters.
    pub largest_penetration: f64,
    /// Iterations of the contact solver over all positions and torques.
    pub contact_iterations: u64,
    /// The largest difference of the projected decomposition to exact solutions at a few positions of each torque where it is least
    /// sure, in meters; `None` for other methods.
    pub projection_error: Option<f64>,
    /// The largest difference of the decomposition to exact solutions where the turn of its holed blanks was sampled, in meters; `None` for other methods.
    pub decomposition_error: Option<f64>,
    /// The discretization error, where it was asked for.
    pub error_estimate: Option<ErrorEstimate>,
}

impl Evidence {
    /// Evidence of a model with the given number of unknowns, before anything is solved.
    pub(super) fn new(degrees_of_freedom: u64) -> Self {
        Self {
            degrees_of_freedom,
            equilibrium_residual: 0.0,
            complementarity_residual: 0.0,
            largest_penetration: 0.0,
            contact_iterations: 0,
            projection_error: None,
            decomposition_error: None,
            error_estimate: None,
        }
    }

    /// Adds that of `contacts`, solved under `load`.
    pub(super) fn gather(&mut self, contacts: &[MeshContact], load: f64) {
        let largest = contacts
            .iter()
            .map(|contact| contact.transmission_error.abs())
            .fold(f64::MIN_POSITIVE, f64::max);
        for contact in contacts {
            let complementarity = contact.complementarity / (load * largest);
            self.equilibrium_residual = self.equilibrium_residual.max(contact.equilibrium);
            self.complementarity_residual = self.complementarity_residual.max(complementarity);
            self.largest_penetration = self.largest_penetration.max(contact.penetration);
            self.contact_iterations += u64::from(contact.iterations);
        }
    }
}

impl ErrorEstimate {
    /// The largest differences between the curves of two grid levels, and their errors of sampling.
    pub(super) fn between(curves: &[Curve], others: &[Curve]) -> Self {
        let largest = |value: fn(&Curve) -> f64, open: fn(&Curve) -> f64| {
            let pairs = curves.iter().zip(others);
            let errors = pairs.map(|(a, b)| (value(a) - value(b)).abs() + open(a));
            errors.fold(0.0, f64::max)
        };
        Self {
            mean: largest(
                |curve| curve.transmission_error_statistics.mean,
                |curve| curve.sampling_error.mean,
            ),
            peak_to_peak: largest(
                |curve| curve.transmission_error_statistics.peak_to_peak,
                |curve| curve.sampling_error.peak_to_peak,
            ),
            mean_stiffness: largest(
                |curve| curve.mesh_stiffness_tangent_statistics.mean,
                |_| 0.0,
            ),
        }
    }
}
