//! Curves at torque 0: the limit as the load vanishes, in which nothing is elastic. All methods agree on it but the load distribution, which sees
//! contact on the line of contact alone.

use super::case::Model;
use rayon::prelude::*;

use super::between::{Refinement, Sample, Sections};
use super::case::Place;
use super::curve_parts::CurveParts;
use super::{AnalysisError, Case, Curve, load_distribution};
use crate::contact::face::FaceModel;
use crate::contact::{MeshContact, light_contact};
use crate::load_distribution::PairFormulas;

/// The `curves` of the loaded torques of `case`, and those of its torques of zero, in its order; `is_refined` says whether these are looked at
/// between their positions.
pub(super) fn with_torque_zero(
    case: &Case,
    is_refined: bool,
    curves: Vec<Curve>,
) -> Result<Vec<Curve>, AnalysisError> {
    let mut curves = curves.into_iter();
    let of = |torque: &f64| match *torque {
        0.0 => Some(curve(case, is_refined)),
        _ => curves.next().map(Ok),
    };
    case.output_torques.iter().filter_map(of).collect()
}

fn curve(case: &Case, is_refined: bool) -> Result<Curve, AnalysisError> {
    let deviations = case.pair.deviations();
    let formulas = match &case.model {
        Model::Formulas(formulas) => Some(PairFormulas::new(&case.pair, *formulas)),
        Model::Section(_) | Model::Faces(..) => None,
    };
    let rigid = case
        .faces()
        .map(|faces| FaceModel::rigid(faces.pair.clone(), faces.at(case.resolution.grid).slices));
    let contact = |&eta: &f64| -> Result<MeshContact, AnalysisError> {
        let contact = match (&formulas, &rigid) {
            (Some(formulas), _) => return load_distribution::light(formulas, eta),
            (None, Some(rigid)) => rigid.light_contact(eta),
            (None, None) => light_contact(&case.pair, &deviations, eta),
        };
        contact.map_err(|error| AnalysisError::at_position(error, eta))
    };
    let found = |positions: &[f64]| {
        let contacts: Vec<_> = positions.par_iter().map(contact).collect();
        let contacts = contacts.into_iter().collect::<Result<Vec<_>, _>>()?;
        let places = case.places(positions);
        let at = |place: &Place| &contacts[place.contact];
        let delta = places.iter().map(|place| at(place).transmission_error);
        let stiffness = places.iter().map(|place| at(place).stiffness);
        let curves: [Vec<f64>; 2] = [delta.collect(), stiffness.collect()];
        let samples = Sample::of(&places, &contacts, &curves[0], &curves[1]);
        Ok::<_, AnalysisError>((contacts, curves, samples))
    };
    let positions = case.repeating_positions();
    let (contacts, [transmission_error, stiffness], mut samples) = found(&positions)?;
    let sections = if is_refined {
        if let Some(formulas) = &formulas {
            let ends = load_distribution::ends_of_contact(formulas, case);
            samples.extend(found(&ends)?.2);
            samples.sort_by(|a, b| a.position.total_cmp(&b.position));
        }
        let refinement = Refinement::of(case, case.contacts_repeat_after(), positions.len());
        refinement.sections(samples, |further| Ok::<_, AnalysisError>(found(further)?.2))?
    } else {
        Sections::of(case, &samples)
    };
    let parts = CurveParts {
        transmission_error,
        stiffness,
        ..CurveParts::of_repeating(case, &contacts, sections)
    };
    Ok(parts.into_curve(case, 0.0))
}
