//! Curves at torque 0: the limit as the load vanishes, in which nothing is elastic. All methods agree on it but the load distribution, which sees
//! contact on the line of contact alone.

use rayon::prelude::*;

use super::AnalysisError;
use super::case::{Case, Model};
use super::curve::Curve;
use super::found::Found;
use super::load_distribution::{ends_of_contact, light};
use super::plan::Sweep;
use super::spun_pair::PairState;
use super::under_load::parts_of;
use crate::contact::face::FaceFlanks;
use crate::contact::{MeshContact, PositionError, light_contact};
use crate::load_distribution::PairFormulas;
use crate::run::Run;

/// The contact of a case at a mesh position as its load vanishes.
type Light<'a> = Box<dyn Fn(f64) -> Result<MeshContact, AnalysisError> + Sync + 'a>;

/// The curve of `case` at torque 0, by contacts at the positions of `sweep`.
pub(super) fn curve(
    (case, state): (&Case, Option<&PairState>),
    sweep: &Sweep,
) -> Result<Curve, AnalysisError> {
    let mut kinks = Vec::new();
    let at = |eta, contact: Result<MeshContact, PositionError>| {
        contact.map_err(|error| AnalysisError::at_position(error, eta))
    };
    let drawn = || case.pair.deviations();
    let deviations = state.map_or_else(drawn, |state| state.deviations.clone());
    let contact: Light<'_> = match &case.model {
        Model::Section(_) => {
            Box::new(move |eta| at(eta, light_contact(&case.pair, &deviations, eta)))
        }
        Model::Faces(faces, _) => {
            let slices = faces.at(case.resolution.grid).slices;
            let flanks = FaceFlanks::new(faces.pair.clone(), slices).deviating(deviations);
            Box::new(move |eta| at(eta, flanks.light_contact(eta)))
        }
        Model::Formulas(formulas) => {
            let formulas = PairFormulas::new(&case.pair, *formulas);
            kinks = ends_of_contact(&formulas, case);
            Box::new(move |eta| light(&formulas, eta))
        }
    };
    let find = |sweep: &Sweep| -> Result<Found, AnalysisError> {
        let contacts = sweep.positions.par_iter().map(|&eta| contact(eta));
        // The error of the first position that has one.
        let contacts: Vec<_> = contacts.collect();
        let contacts = contacts.into_iter().collect::<Result<Vec<_>, _>>()?;
        let stiffness: Vec<f64> = contacts.iter().map(|contact| contact.stiffness).collect();
        Ok(Found::of_contacts((case, sweep), contacts, &stiffness))
    };
    let (found, run) = (find(sweep)?, Run::unattended());
    let (parts, _) = parts_of((case, sweep, 0.0), &found, &kinks, &run, |sweep, _| {
        find(sweep)
    })?;
    Ok(parts.into_curve(case, 0.0))
}
