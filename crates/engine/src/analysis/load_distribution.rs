//! The load distribution ([`crate::load_distribution`]) as a method: position by position, torque by torque.

use super::case::Case;
use super::found::Found;
use super::plan::{Pass, Sweep};
use super::under_load::curves;
use super::{Analysis, AnalysisError};
use crate::contact::{MeshContact, PairContact, PeakPlace};
use crate::gear::GearPair;
use crate::load_distribution::{Formulas, PairFormulas, Shared, rise, share, touch};
use crate::run::Run;

/// Computes `case` by the load distribution of these `formulas`.
pub(super) fn solve(
    case: &Case,
    formulas: Formulas,
    pass: &Pass,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let formulas = PairFormulas::new(&case.pair, formulas);
    let ends = ends_of_contact(&formulas, case);
    curves((case, pass), 0, run, |under| {
        let load = under.load;
        let find = |sweep: &Sweep, run: &Run| found((case, &formulas), sweep, load, run);
        let found = find(&pass.curve, run)?;
        Ok(under.parts(&found, &ends, find)?.0)
    })
}

/// The mesh positions just beside the begin and the end of the contact of a pair on the line of contact of `case`: those of one mesh period, or of the whole span
/// where teeth deviate.
pub(super) fn ends_of_contact(formulas: &PairFormulas, case: &Case) -> Vec<f64> {
    let periods = if case.pair.is_as_drawn() {
        1
    } else {
        case.span()
    };
    let first = |period: u32| case.resolution.first_position + f64::from(period);
    let of_period = |period: u32| formulas.ends_of_contact(first(period));
    (0..periods).flat_map(of_period).collect()
}

/// Load sharing of the pairs at the positions of `sweep`.
fn found(
    (case, formulas): (&Case, &PairFormulas),
    sweep: &Sweep,
    load: f64,
    run: &Run,
) -> Result<Found, AnalysisError> {
    let positions = sweep.positions.iter();
    let pairs = positions.clone().map(|&eta| formulas.pairs_at(eta));
    let pairs = pairs.collect::<Result<Vec<_>, _>>()?;
    let mut contacts = Vec::with_capacity(pairs.len());
    let module = case.pair.driving().data().rack.module;
    for (eta, pairs) in positions.zip(&pairs) {
        let contact = MeshContact {
            touch: touch(pairs).0,
            ..contact(&case.pair, *eta, &share(pairs, load), load)
        };
        let checked = contact.check(module);
        checked.map_err(|error| AnalysisError::at_position(error.into(), *eta))?;
        contacts.push(contact);
        run.reached(1)?;
    }
    let by_step = sweep.stiffness_by_step(load, |load| {
        run.reached(pairs.len() as u64)?;
        Ok(pairs.iter().map(|pairs| rise(pairs, load)).collect())
    })?;
    let of_contacts = || contacts.iter().map(|contact| contact.stiffness).collect();
    let stiffness = by_step.unwrap_or_else(of_contacts);
    Ok(Found::of_contacts((case, sweep), contacts, &stiffness))
}

/// The contact of `pair` at the mesh position `eta` that is `shared` so under `load`. All forces act along the theoretical line of contact.
fn contact(pair: &GearPair, eta: f64, shared: &Shared, load: f64) -> MeshContact {
    let number = |offset: i32| i64::from(offset) + eta.floor() as i64;
    let pairs = shared.loaded();
    let pairs = pairs.map(|(offset, force)| PairContact::of_share(number(offset), force / load));
    let heaviest = number(shared.peak_offset);
    let s = pair.roll_length_of(eta - heaviest as f64);
    MeshContact {
        transmission_error: shared.transmission_error,
        stiffness: shared.stiffness,
        driving_load: load,
        pairs: pairs.collect(),
        peak_pressure: Some(shared.peak_pressure),
        peak_place: Some(PeakPlace {
            pair: heaviest,
            roll_lengths: [s, pair.line_of_action() - s],
            z: None,
            // The pressure is Hertz's of unmodified flanks.
            half_width: 0.0,
        }),
        smooth_pressure: shared.peak_pressure,
        equilibrium: shared.residual,
        ..MeshContact::default()
    }
}

/// The contact of `formulas` at the mesh position `eta` as the load vanishes. Tips beside the line of contact, which this method does not have, do not touch
/// here either.
pub(super) fn light(formulas: &PairFormulas, eta: f64) -> Result<MeshContact, AnalysisError> {
    let (transmission_error, offsets) = touch(&formulas.pairs_at(eta)?);
    let pair = |offset: i32| (i64::from(offset) + eta.floor() as i64, None);
    let touching = offsets.into_iter().map(pair).collect();
    Ok(MeshContact::unloaded(transmission_error, touching))
}
