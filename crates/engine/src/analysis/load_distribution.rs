//! The load distribution ([`crate::load_distribution`]) as a method: position by position, torque by torque.

use super::between::{PairState, Sample, Sections};
use super::case::{Case, Place};
use super::curve::LoadShare;
use super::curve_parts::CurveParts;
use super::largest_where::LargestPressure;
use super::plan::{Pass, Sweep};
use super::warning::warnings;
use super::{Analysis, AnalysisError, Evidence};
use crate::contact::{MeshContact, PeakPlace};
use crate::load_distribution::{Formulas, PairFormulas, Shared, rise, share, touch};
use crate::run::Run;

/// Computes `case` by the load distribution of these `formulas`.
pub(super) fn solve(
    case: &Case,
    formulas: Formulas,
    plan: &Pass,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let formulas = PairFormulas::new(&case.pair, formulas);
    let told = &plan.told;
    let mut evidence = Evidence::new(0);
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let mut found = |sweep: &Sweep, run: &Run| {
            let found = Found::at(&formulas, sweep, load, run)?;
            for contact in &found.contacts {
                evidence.equilibrium_residual = evidence.equilibrium_residual.max(contact.residual);
            }
            Ok::<_, AnalysisError>(found)
        };
        let first = found(told, run)?;
        let mut samples = first.samples(case, told, load);
        if told.further > 0 {
            let ends = told.at(&ends_of_contact(&formulas, case));
            // They belong to the curve as its positions do, and nobody waits for them.
            samples.extend(found(&ends, &Run::unattended())?.samples(case, &ends, load));
            samples.sort_by(|a, b| a.position.total_cmp(&b.position));
        }
        let sections = told.sections(
            (case, case.contacts_repeat_after()),
            samples,
            run,
            |sweep| Ok(found(sweep, run)?.samples(case, sweep, load)),
        )?;
        let parts = curve_parts(case, (&told.positions, first), sections, load);
        curves.push(parts.into_curve(case, output_torque));
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings: warnings(case),
    })
}

/// The mesh positions just beside which a pair comes to the line of contact of `case` or leaves it: those of one mesh period, or of the whole span
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

/// How the pairs share a load at some positions.
struct Found {
    contacts: Vec<Shared>,
    stiffness: Vec<f64>,
}

impl Found {
    fn at(
        formulas: &PairFormulas,
        sweep: &Sweep,
        load: f64,
        run: &Run,
    ) -> Result<Self, AnalysisError> {
        let positions = sweep.positions.iter();
        let positions = positions.map(|&eta| formulas.pairs_at(eta));
        let positions = positions.collect::<Result<Vec<_>, _>>()?;
        let mut contacts = Vec::with_capacity(positions.len());
        for pairs in &positions {
            contacts.push(share(pairs, load));
            run.reached(1)?;
        }
        let of_contacts = || contacts.iter().map(|contact| contact.stiffness).collect();
        let stiffness = sweep.stiffness(load, of_contacts, |load| {
            run.reached(positions.len() as u64)?;
            Ok(positions.iter().map(|pairs| rise(pairs, load)).collect())
        })?;
        Ok(Self {
            contacts,
            stiffness,
        })
    }

    /// What is known at the places in the curve of `case` that the positions of `sweep` tell of.
    fn samples(&self, case: &Case, sweep: &Sweep, load: f64) -> Vec<Sample> {
        let places = case.places(&sweep.positions).into_iter();
        let sample = |place: Place| {
            let contact = &self.contacts[place.contact];
            let period = place.position.floor() as i64;
            let pairs = contact.loaded().map(|(offset, force)| PairState {
                pair: i64::from(offset) + period,
                share: force / load,
                clearance: None,
            });
            Sample {
                position: place.position,
                transmission_error: contact.transmission_error,
                stiffness: self.stiffness[place.contact],
                pairs: pairs.collect(),
            }
        };
        places.map(sample).collect()
    }
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
    (positions, found): (&[f64], Found),
    sections: Sections,
    load: f64,
) -> CurveParts {
    let Found {
        contacts,
        stiffness,
    } = found;
    let all = |value: fn(&Shared) -> f64| case.repeated(contacts.iter().map(value));
    let pairs_in_contact = contacts
        .iter()
        .map(|contact| contact.loaded().count() as u32);
    let pressures = contacts.iter().map(|contact| Some(contact.peak_pressure));
    let largest = positions.iter().zip(&contacts).map(|(eta, contact)| {
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
        sections,
        // All forces act along the theoretical line of contact.
        driving_load: case.repeated(contacts.iter().map(|_| load)),
        peak_contact_pressure: case.repeated(pressures),
        pairs_in_contact: case.repeated(pairs_in_contact),
        largest_pressure: LargestPressure::of(largest),
        load_shares: load_shares(case, &contacts, load),
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
