//! Curves at torque 0: the limit as the load vanishes, in which nothing is elastic. All methods agree on it but the load distribution, which sees
//! contact on the line of contact alone.

use rayon::prelude::*;

use super::AnalysisError;
use super::case::{Case, Model};
use super::curve::Curve;
use super::found::Found;
use super::load_distribution::{ends_of_contact, light};
use super::plan::Sweep;
use super::under_load::parts_of;
use crate::contact::face::FaceModel;
use crate::contact::{MeshContact, light_contact};
use crate::load_distribution::PairFormulas;
use crate::run::Run;

/// The curve of `case` at torque 0, by contacts at the positions of `sweep`.
pub(super) fn curve(case: &Case, sweep: &Sweep) -> Result<Curve, AnalysisError> {
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
            (Some(formulas), _) => return light(formulas, eta),
            (None, Some(rigid)) => rigid.light_contact(eta),
            (None, None) => light_contact(&case.pair, &deviations, eta),
        };
        contact.map_err(|error| AnalysisError::at_position(error, eta))
    };
    let find = |sweep: &Sweep| -> Result<Found, AnalysisError> {
        let contacts: Vec<_> = sweep.positions.par_iter().map(contact).collect();
        let contacts = contacts.into_iter().collect::<Result<Vec<_>, _>>()?;
        let stiffness: Vec<f64> = contacts.iter().map(|contact| contact.stiffness).collect();
        Ok(Found::of_contacts(
            (case, sweep),
            contacts,
            &stiffness,
            Vec::new(),
        ))
    };
    let ends = formulas
        .as_ref()
        .map(|formulas| ends_of_contact(formulas, case));
    let (found, run) = (find(sweep)?, Run::unattended());
    let kinks = ends.unwrap_or_default();
    let parts = parts_of((case, sweep), &found, &kinks, &run, |sweep, _| find(sweep))?;
    Ok(parts.into_curve(case, 0.0))
}
