//! The contact at many mesh positions under one load, in parallel.

use rayon::prelude::*;

use super::{
    ContactCells, ContactSolution, MeshContact, PairModel, PositionError, Stage, WarmStart,
};
use crate::run::{Run, Stopped};

/// Stages that one thread solves in a row, each starting from the last; fixed, so that results do not depend on threads.
const CHUNK: usize = 5;

/// Fractions of the mesh period that differ by less are one: far above their rounding, far below any step.
const SAME_FRACTION: f64 = 1e-9;

/// Why the contacts of some positions could not be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PositionsError {
    /// One of them has no solution.
    #[error("the contact at mesh position {mesh_position} could not be found")]
    At {
        /// The mesh position η.
        mesh_position: f64,
        /// Why.
        #[source]
        error: PositionError,
    },
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// The contact of `model` at each of `positions` under `load`.
///
/// # Errors
///
/// [`PositionsError`].
pub fn contacts(
    model: &PairModel,
    load: f64,
    positions: &[f64],
    run: &Run,
) -> Result<Vec<MeshContact>, PositionsError> {
    contacts_keeping(model, load, positions, run, |_, _| ())
        .map(|contacts| contacts.into_iter().map(|(contact, ())| contact).collect())
}

/// As [`contacts`], with what `keep` takes of each beside.
///
/// # Errors
///
/// As [`contacts`].
pub fn contacts_keeping<T: Send>(
    model: &PairModel,
    load: f64,
    positions: &[f64],
    run: &Run,
    keep: impl Fn(&ContactCells<'_>, &ContactSolution) -> T + Sync,
) -> Result<Vec<(MeshContact, T)>, PositionsError> {
    let stages = stages(positions);
    let solved: Result<Vec<Vec<_>>, PositionsError> = stages
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut contacts = Vec::new();
            let mut first = WarmStart::default();
            for (fraction, places) in chunk {
                // Each stage starts from the one before it, and each further period of a stage from the last period.
                let at = |error, mesh_position| PositionsError::At {
                    mesh_position,
                    error,
                };
                let mut stage = Stage::new(model, *fraction, load)
                    .map_err(|error| at(error, positions[places[0]]))?;
                let mut warm = first.clone();
                for &place in places {
                    let eta = positions[place];
                    let contact = stage
                        .contact((eta - fraction).round() as i64, &mut warm, &keep)
                        .map_err(|error| at(error, eta))?;
                    contacts.push((place, contact));
                    run.reached(1)?;
                    if place == places[0] {
                        first = warm.clone();
                    }
                }
            }
            Ok(contacts)
        })
        .collect();
    let mut contacts: Vec<_> = solved?.into_iter().flatten().collect();
    contacts.sort_unstable_by_key(|&(place, _)| place);
    Ok(contacts.into_iter().map(|(_, contact)| contact).collect())
}

/// Positions by their fraction of the mesh period, rising, with the places of those that have it.
fn stages(positions: &[f64]) -> Vec<(f64, Vec<usize>)> {
    let fraction = |place: usize| positions[place] - positions[place].floor();
    let mut places: Vec<usize> = (0..positions.len()).collect();
    places.sort_by(|&a, &b| fraction(a).total_cmp(&fraction(b)));
    let mut stages: Vec<(f64, Vec<usize>)> = Vec::new();
    for place in places {
        match stages.last_mut() {
            Some((known, places)) if fraction(place) - *known < SAME_FRACTION => {
                places.push(place);
            }
            _ => stages.push((fraction(place), vec![place])),
        }
    }
    for (_, places) in &mut stages {
        places.sort_unstable();
    }
    stages
}
