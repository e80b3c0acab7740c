//! Evidence for the numbers, and their meaning.

use std::borrow::Cow;

use meshwright_engine::analysis::Analysis;
use meshwright_engine::analysis::ErrorEstimate;
use serde_json::{Map, Value};

use super::all;
use super::unseen::{MODES_DO_NOT_SEE, does_not_see};
use crate::declare::document;
use crate::submission::{SOLVER_VERSION, Submission};
use crate::units::to_um;

document! {
    /// Residuals of the equations, the equations' models, and their limits.
    pub struct EvidenceDocument as Evidence, "Evidence"
    answer of (submission: &Submission, analysis: &Analysis) with {
        let evidence = &analysis.evidence;
        let mut unseen = does_not_see(submission.case(), submission.forces());
        if submission.modes().is_some() {
            unseen.extend(MODES_DO_NOT_SEE);
        }
    } {
        /// The version of the solver.
        solver_version: Cow<'static, str> = SOLVER_VERSION.into(),
        /// SHA-256 of all that decides the result: the filled-in submission without its tags, and the solver's version.
        input_hash: String = submission.input_hash(),
        /// Unknowns of both gears before condensation; zero for formulas.
        degrees_of_freedom: u64 = evidence.degrees_of_freedom,
        /// The largest difference between the output torque by cross products and the one asked for, over the latter.
        equilibrium_residual: f64 = evidence.equilibrium_residual,
        /// The largest product of contact force and gap, over load times largest transmission error.
        complementarity_residual: f64 = evidence.complementarity_residual,
        /// The largest penetration left, in um.
        largest_penetration_um: f64 = to_um(evidence.largest_penetration),
        /// Iterations of the contact solver over all positions and torques.
        contact_iterations: u64 = evidence.contact_iterations,
        /// The largest difference of the projected decomposition to exact solutions at a few positions of each torque where it is least
        /// sure, in um; absent for other methods.
        projection_error_um?: f64 = evidence.projection_error.map(to_um),
        /// The largest difference of the decomposition to exact solutions where the turn of its holed blanks was sampled, in um: what one harmonic leaves of it. Absent
        /// for other methods, and in results of versions before 0.6.
        decomposition_error_um?: f64 = evidence.decomposition_error.map(to_um),
        /// How the tangent stiffness was obtained.
        stiffness_rule: String = submission.resolution().stiffness_in_words(),
        /// How it was computed, with every default filled in.
        #[schema(value_type = crate::resolution::ResolutionDocument)]
        resolution: Map<String, Value> = resolution_of(submission),
        /// Meaning of the numbers.
        definitions: Vec<Definition> = all(&DEFINITIONS, Definition::of),
        /// Effects that the method leaves out.
        does_not_see: Vec<Cow<'static, str>> = unseen.into_iter().map(Cow::from).collect(),
        /// Change by a second grid level, if the submission asks for it.
        error_estimate?: ErrorEstimateDocument = evidence
            .error_estimate
            .as_ref()
            .map(ErrorEstimateDocument::of),
    }
}

/// The resolution as the submission echoes it, without the fields that are left to each gear's own default.
fn resolution_of(submission: &Submission) -> Map<String, Value> {
    fn leave_out_nulls(value: &mut Value) {
        if let Value::Object(fields) = value {
            fields.values_mut().for_each(leave_out_nulls);
            fields.retain(|_, value| !value.is_null());
        }
    }
    let mut resolution = serde_json::to_value(submission.resolution()).unwrap_or_default();
    leave_out_nulls(&mut resolution);
    match resolution {
        Value::Object(fields) => fields,
        _ => Map::new(),
    }
}

document! {
    /// A term and its meaning here.
    pub struct Definition as Definition, "Definition"
    answer of ((term, meaning): &(&'static str, &'static str)) {
        /// The term.
        term: Cow<'static, str> = Cow::from(*term),
        /// Meaning.
        meaning: Cow<'static, str> = Cow::from(*meaning),
    }
}

const DEFINITIONS: [(&str, &str); 7] = [
    (
        "transmission_error",
        "The driven base radius times the rotation of the driven hub away from its conjugate position, the driving hub held; positive when load makes the driven gear lag, zero for unmodified rigid involutes in contact.",
    ),
    (
        "mesh_stiffness_tangent",
        "dF/d delta at the load, eq. 3 of the paper; stiffness_rule says how it was obtained.",
    ),
    ("mesh_stiffness_secant", "F/delta."),
    (
        "mesh_position",
        "Counts mesh periods; at 0 the reference pair, tooth 0 of both gears, touches at the pitch point. Both gears have then turned by mesh_position times 2 pi/Z, rigidly.",
    ),
    (
        "statistics",
        "Over the span: mean, root mean square after the mean is removed, largest less smallest.",
    ),
    (
        "order",
        "Per revolution of the driven gear. Amplitudes are single-sided, y = sum of A cos(2 pi k j/n + phase), without window.",
    ),
    (
        "pair_offset",
        "n - floor(mesh_position) for the pair that passes the pitch point at mesh position n: 0 for the pair that passed it last, 1 for the next.",
    ),
];

document! {
    /// Change by a second grid level, the largest over the torques.
    pub struct ErrorEstimateDocument as ErrorEstimate, "Error estimate"
    answer of (estimate: &ErrorEstimate) {
        /// In the mean transmission error, in um.
        transmission_error_mean_um: f64 = to_um(estimate.mean),
        /// In the peak-to-peak transmission error, in um.
        transmission_error_peak_to_peak_um: f64 = to_um(estimate.peak_to_peak),
        /// In the mean tangent stiffness, in N/m.
        mesh_stiffness_tangent_mean_n_per_m: f64 = estimate.mean_stiffness,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{example, parse, with};

    #[test]
    fn what_is_left_to_a_gear_s_own_default_is_left_out_of_the_evidence() {
        let own = (
            "/resolution/interface_radius_mm/driving",
            serde_json::Value::Null,
        );
        let submission = parse(&with(example("interface-radii"), &[own])).expect("valid");
        let resolution = resolution_of(&submission);
        let radii = resolution["interface_radius_mm"]
            .as_object()
            .expect("an object");
        assert_eq!(radii.keys().collect::<Vec<_>>(), ["driven"]);
        assert_eq!(submission.case().resolution.interface_radii[0], None);
    }
}
