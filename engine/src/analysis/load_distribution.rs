//! The load distribution ([`crate::load_distribution`]) as a method: position by position, torque by torque.

use super::case::Case;
use super::curve::LoadShare;
use super::curve_parts::CurveParts;
use super::largest_where::LargestPressure;
use super::plan::Pass;
use super::warning::warnings;
use super::{Analysis, AnalysisError, Evidence};
use crate::contact::{MeshContact, PeakPlace};
use crate::load_distribution::{PairFormulas, Shared, rise, share, touch};
use crate::run::Run;

/// Computes `case` by the load distribution.
pub(super) fn solve(case: &Case, plan: &Pass, run: &Run) -> Result<Analysis, AnalysisError> {
    let formulas = PairFormulas::new(&case.pair, case.resolution.formulas);
    let told = &plan.told;
    let positions = told
        .positions
        .iter()
        .map(|&eta| formulas.pairs_at(eta))
        .collect::<Result<Vec<_>, _>>()?;
    let mut evidence = Evidence::new(0);
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let mut contacts = Vec::with_capacity(positions.len());
        for pairs in &positions {
            let contact = share(pairs, load);
            evidence.equilibrium_residual = evidence.equilibrium_residual.max(contact.residual);
            contacts.push(contact);
            run.reached(1)?;
        }
        let of_contacts = || contacts.iter().map(|contact| contact.stiffness).collect();
        let stiffness = told.stiffness(load, of_contacts, |load| {
            run.reached(positions.len() as u64)?;
            Ok(positions.iter().map(|pairs| rise(pairs, load)).collect())
        })?;
        let parts = curve_parts(case, (&told.positions, &contacts), stiffness, load);
        curves.push(parts.into_curve(case, output_torque));
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings: warnings(case),
    })
}

/// The contact of `formulas` at the mesh position `eta` as the load vanishes: what this route does not see of tips beside the line of contact does
/// not touch here either.
pub(super) fn light(formulas: &PairFormulas, eta: f64) -> Result<MeshContact, AnalysisError> {
    let (transmission_error, offsets) = touch(&formulas.pairs_at(eta)?);
    let pair = |offset: i32| (i64::from(offset) + eta.floor() as i64, None);
    let touching = offsets.into_iter().map(pair).collect();
    Ok(MeshContact::unloaded(transmission_error, touching))
}

fn curve_parts(
    case: &Case,
    (positions, contacts): (&[f64], &[Shared]),
    stiffness: Vec<f64>,
    load: f64,
) -> CurveParts {
    let all = |value: fn(&Shared) -> f64| case.repeated(contacts.iter().map(value));
    let pairs_in_contact = contacts
        .iter()
        .map(|contact| contact.loaded().count() as u32);
    let pressures = contacts.iter().map(|contact| Some(contact.peak_pressure));
    let largest = positions.iter().zip(contacts).map(|(eta, contact)| {
        let n = i64::from(contact.peak_offset) + eta.floor() as i64;
        let s = case.pair.roll_length_of(eta - n as f64);
        let place = PeakPlace {
            pair: n,
            roll_lengths: [s, case.pair.line_of_action() - s],
            z: None,
            // The pressure is Hertz's of unmodified flanks.
            half_width: 0.0,
        };
        (*eta, Some(contact.peak_pressure), Some(place))
    });
    CurveParts {
        transmission_error: all(|contact| contact.transmission_error),
        stiffness: case.repeated(stiffness.into_iter()),
        // All forces act along the theoretical line of contact.
        driving_load: case.repeated(contacts.iter().map(|_| load)),
        peak_contact_pressure: case.repeated(pressures),
        pairs_in_contact: case.repeated(pairs_in_contact),
        largest_pressure: LargestPressure::of(largest),
        load_shares: load_shares(case, contacts, load),
        decomposition: None,
        stresses: None,
        face: None,
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
