//! The classical route: contact on the theoretical line of contact, compliances from formulas (eqs. 4-5 of the
//! paper).
//!
//! A loaded pair of teeth gives way in three places, and for each there is a closed form. Forces act along the line
//! of action, so compliances (m/N) add up in series over the two gears:
//!
//! | what gives way | formula | file |
//! | --- | --- | --- |
//! | the tooth, a cantilever of varying section | Weber and Banaschek's integral over the true profile | `weber_banaschek` |
//! | the body under the tooth, as a ring on a rigid bore | Sainsot, Velex and Duverger | `sainsot` |
//! | the body under the tooth, as a half plane | Weber and Banaschek | `half_plane` |
//! | the flanks at the contact | Hertz, and Weber's approach of points at a depth | `approach` |
//! | all of it at once, per pair of teeth | ISO 6336-1, method B, single stiffness | `iso6336` |
//!
//! Reading order: `tooth_load` and `profile` (where the load line meets the tooth, and how thick it is), then the table from
//! top to bottom, `compliance` (which pairs touch, and their formulas), `sharing` (how they share the load) and `range`
//! (where formulas are used outside the range for which they were published: computed, and flagged).
//!
//! Where the face widths differ, each tooth and body yields by its own width, and the flanks touch on the common one; ISO's
//! stiffness is that of the common width.
//!
//! What this route cannot see: holes (a body is a ring or a half plane), and the body that neighboring pairs share -
//! each pair carries a body of its own, so that the deflection of one tooth does not tilt the next. ISO's single
//! stiffness knows neither position nor bore nor load.

mod approach;
mod compliance;
mod half_plane;
mod iso6336;
mod profile;
mod range;
mod sainsot;
mod sharing;
mod tooth_load;
mod weber_banaschek;

pub use range::{Formula, FormulaQuantity, FormulaRange};

use super::case::{BodyFormula, Case, StiffnessRule, ToothFormula};
use super::curve::LoadShare;
use super::curve_parts::CurveParts;
use super::warning::warnings;
use super::{Analysis, AnalysisError, Evidence};
use crate::gear::Member;
use crate::run::Run;
use compliance::PairFormulas;
use sainsot::Ring;
use sharing::{LinePair, Shared, rise, share};

/// Computes `case` by the load distribution.
pub(super) fn distribute(case: &Case, run: &Run) -> Result<Analysis, AnalysisError> {
    let formulas = PairFormulas::new(&case.pair, case.resolution.formulas);
    let positions = case
        .repeating_positions()
        .into_iter()
        .map(|eta| formulas.pairs_at(eta))
        .collect::<Result<Vec<_>, _>>()?;
    let mut evidence = Evidence::new(0);
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let mut contacts = Vec::with_capacity(positions.len());
        for pairs in &positions {
            let contact = solved(pairs, load, case.resolution.stiffness);
            evidence.equilibrium_residual = evidence.equilibrium_residual.max(contact.residual);
            contacts.push(contact);
            run.reached(1)?;
        }
        let parts = curve_parts(case, &contacts, load);
        curves.push(parts.into_curve(case, output_torque));
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings: warnings(case),
    })
}

/// What of `case` lies outside the ranges of the formulas that it asks for.
pub(super) fn out_of_range(case: &Case) -> Vec<FormulaRange> {
    let (pair, formulas) = (&case.pair, case.resolution.formulas);
    match (formulas.tooth, formulas.body) {
        (ToothFormula::Iso6336, _) => {
            let torques = case.output_torques.iter().copied();
            iso6336::out_of_range(pair, torques.fold(f64::INFINITY, f64::min))
        }
        (ToothFormula::WeberBanaschek, BodyFormula::Sainsot) => Member::BOTH
            .into_iter()
            .flat_map(|member| Ring::of(pair.gear(member)).out_of_range(member))
            .collect(),
        (ToothFormula::WeberBanaschek, BodyFormula::HalfPlane | BodyFormula::Rigid) => Vec::new(),
    }
}

/// `load` shared among `pairs`, with the stiffness by `rule`.
fn solved(pairs: &[LinePair], load: f64, rule: StiffnessRule) -> Shared {
    let contact = share(pairs, load);
    match rule {
        StiffnessRule::Tangent => contact,
        StiffnessRule::TorqueStep { fraction } => {
            let more = rise(pairs, (1.0 + fraction) * load);
            let less = rise(pairs, (1.0 - fraction) * load);
            let stiffness = 2.0 * fraction * load / (more - less);
            Shared {
                stiffness,
                ..contact
            }
        }
    }
}

fn curve_parts(case: &Case, contacts: &[Shared], load: f64) -> CurveParts {
    let all = |value: fn(&Shared) -> f64| case.repeated(contacts.iter().map(value));
    let pairs_in_contact = contacts
        .iter()
        .map(|contact| contact.loaded().count() as u32);
    let pressures = contacts.iter().map(|contact| Some(contact.peak_pressure));
    CurveParts {
        transmission_error: all(|contact| contact.transmission_error),
        stiffness: all(|contact| contact.stiffness),
        peak_contact_pressure: case.repeated(pressures),
        pairs_in_contact: case.repeated(pairs_in_contact),
        load_shares: load_shares(case, contacts, load),
        decomposition: None,
        stresses: None,
    }
}

fn load_shares(case: &Case, contacts: &[Shared], load: f64) -> Vec<LoadShare> {
    let mut offsets: Vec<i32> = contacts
        .iter()
        .flat_map(|contact| contact.loaded().map(|force| force.0))
        .collect();
    offsets.sort_unstable();
    offsets.dedup();
    let share_of = |pair_offset: i32| LoadShare {
        pair_offset,
        share: case.repeated(
            contacts
                .iter()
                .map(|contact| contact.share(pair_offset, load)),
        ),
    };
    offsets.into_iter().map(share_of).collect()
}
