//! Curves at torque 0: the limit as the load vanishes, in which nothing is elastic. All methods agree on it but the load distribution, which sees
//! contact on the line of contact alone.

use rayon::prelude::*;

use super::curve_parts::CurveParts;
use super::{AnalysisError, Case, Curve, Method, load_distribution};
use crate::contact::face::FaceModel;
use crate::contact::{MeshContact, light_contact};
use crate::load_distribution::PairFormulas;

/// The `curves` of the loaded torques of `case`, and those of its torques of zero, in its order.
pub(super) fn with_torque_zero(
    case: &Case,
    curves: Vec<Curve>,
) -> Result<Vec<Curve>, AnalysisError> {
    let mut curves = curves.into_iter();
    let of = |torque: &f64| match *torque {
        0.0 => Some(curve(case)),
        _ => curves.next().map(Ok),
    };
    case.output_torques.iter().filter_map(of).collect()
}

fn curve(case: &Case) -> Result<Curve, AnalysisError> {
    let deviations = case.pair.deviations();
    let formulas = (case.method == Method::LoadDistribution)
        .then(|| PairFormulas::new(&case.pair, case.resolution.formulas));
    let rigid =
        (case.faces.as_ref()).map(|faces| FaceModel::rigid(faces.pair.clone(), faces.slices));
    let contacts: Vec<Result<MeshContact, AnalysisError>> = case
        .repeating_positions()
        .into_par_iter()
        .map(|eta| {
            let contact = match (&formulas, &rigid) {
                (Some(formulas), _) => return load_distribution::light(formulas, eta),
                (None, Some(rigid)) => rigid.light_contact(eta),
                (None, None) => light_contact(&case.pair, &deviations, eta),
            };
            contact.map_err(|error| AnalysisError::at_position(error, eta))
        })
        .collect();
    let contacts = contacts.into_iter().collect::<Result<Vec<_>, _>>()?;
    let each = contacts.iter();
    let parts = CurveParts {
        transmission_error: case.repeated(each.clone().map(|contact| contact.transmission_error)),
        stiffness: case.repeated(each.map(|contact| contact.stiffness)),
        ..CurveParts::of_repeating(case, &contacts)
    };
    Ok(parts.into_curve(case, 0.0))
}
