//! How good the numbers are, and what they mean.

use std::borrow::Cow;

use meshwright_engine::analysis::Analysis;
use meshwright_engine::analysis::ErrorEstimate;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

use super::unseen::does_not_see;
use crate::wire::submission::{SOLVER_VERSION, Submission};
use crate::wire::units::to_um;

/// How well the equations are satisfied, what they are, and what they leave out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Evidence, title = "Evidence")]
pub struct EvidenceDocument {
    /// The version of the solver.
    pub solver_version: Cow<'static, str>,
    /// SHA-256 of what decides the result: the filled-in submission without its tags, and the solver's version.
    pub input_hash: String,
    /// Unknowns of both gears before condensation; zero for formulas.
    pub degrees_of_freedom: u64,
    /// The largest difference between the output torque by cross products and the one asked for, over the latter.
    pub equilibrium_residual: f64,
    /// The largest product of contact force and gap, over load times largest transmission error.
    pub complementarity_residual: f64,
    /// The largest penetration left, in um.
    pub largest_penetration_um: f64,
    /// Iterations of the contact solver over all positions and torques.
    pub contact_iterations: u64,
    /// The largest difference of the projected decomposition to exact solutions at a few positions of each torque where it is least
    /// sure, in um; absent for other methods.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub projection_error_um: Option<f64>,
    /// How the tangent stiffness was obtained.
    pub stiffness_rule: String,
    /// How it was computed, with every default filled in.
    #[schema(value_type = crate::wire::resolution::ResolutionDocument)]
    pub resolution: Map<String, Value>,
    /// What the numbers mean.
    pub definitions: Vec<Definition>,
    /// What the method leaves out.
    pub does_not_see: Vec<Cow<'static, str>>,
    /// What a second grid level changes, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_estimate: Option<ErrorEstimateDocument>,
}

impl EvidenceDocument {
    pub(super) fn of(submission: &Submission, analysis: &Analysis) -> Self {
        let evidence = &analysis.evidence;
        let unseen = does_not_see(submission.case(), submission.forces());
        Self {
            solver_version: SOLVER_VERSION.into(),
            input_hash: submission.input_hash(),
            degrees_of_freedom: evidence.degrees_of_freedom,
            equilibrium_residual: evidence.equilibrium_residual,
            complementarity_residual: evidence.complementarity_residual,
            largest_penetration_um: to_um(evidence.largest_penetration),
            contact_iterations: evidence.contact_iterations,
            projection_error_um: evidence.projection_error.map(to_um),
            stiffness_rule: submission.resolution().stiffness_in_words(),
            resolution: resolution_of(submission),
            definitions: DEFINITIONS.map(Definition::of).into(),
            does_not_see: unseen.into_iter().map(Cow::from).collect(),
            error_estimate: evidence
                .error_estimate
                .as_ref()
                .map(ErrorEstimateDocument::of),
        }
    }
}

/// The resolution as the submission echoes it; what is left to each gear's own default is left out.
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

/// A term and what it means here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Definition")]
pub struct Definition {
    /// The term.
    pub term: Cow<'static, str>,
    /// What it means.
    pub meaning: Cow<'static, str>,
}

impl Definition {
    fn of((term, meaning): (&'static str, &'static str)) -> Self {
        let [term, meaning] = [term, meaning].map(Cow::from);
        Self { term, meaning }
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

/// What a second grid level changes, the largest over the torques.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = ErrorEstimate, title = "Error estimate")]
pub struct ErrorEstimateDocument {
    /// In the mean transmission error, in um.
    pub transmission_error_mean_um: f64,
    /// In the peak-to-peak transmission error, in um.
    pub transmission_error_peak_to_peak_um: f64,
    /// In the mean tangent stiffness, in N/m.
    pub mesh_stiffness_tangent_mean_n_per_m: f64,
}

impl ErrorEstimateDocument {
    fn of(estimate: &ErrorEstimate) -> Self {
        Self {
            transmission_error_mean_um: to_um(estimate.mean),
            transmission_error_peak_to_peak_um: to_um(estimate.peak_to_peak),
            mesh_stiffness_tangent_mean_n_per_m: estimate.mean_stiffness,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::examples;

    #[test]
    fn what_is_left_to_a_gear_s_own_default_is_left_out_of_the_evidence() {
        let mut examples = examples().iter();
        let example = examples.find(|example| example.name == "interface-radii");
        let mut document: Value = serde_json::from_str(example.expect("ships").json).expect("JSON");
        document["resolution"]["interface_radius_mm"]["driving"] = Value::Null;
        let submission = Submission::parse(document.to_string().as_bytes()).expect("valid");
        let resolution = resolution_of(&submission);
        let radii = resolution["interface_radius_mm"]
            .as_object()
            .expect("an object");
        assert_eq!(radii.keys().collect::<Vec<_>>(), ["driven"]);
        assert_eq!(submission.case().resolution.interface_radii[0], None);
    }
}
