//! The contact at many mesh positions under one load, in parallel.

use rayon::prelude::*;

use super::{
    ContactCells, ContactSolution, DeviatingPair, MeshContact, MeshPhase, PositionError, WarmStart,
};
use crate::run::{Run, Stopped};

/// Stages that one thread solves in a row, each starting from the last; fixed, so that results do not depend on threads.
const CHUNK: usize = 5;

/// Fractions of the mesh period that differ by less are one: far above their rounding, far below any step.
const SAME_FRACTION: f64 = 1e-9;

/// Fractions are multiples of this, so that one has the same bits in all mesh periods and for all pairs that share their flanks. It moves δ by 1e-15 m at most.
const GRID: f64 = 1.0 / (1_u64 << 36) as f64;

/// A fraction of the mesh period, and the places of the positions that have it.
type Places = (f64, Vec<usize>);

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

impl PositionsError {
    /// The `error` of a mesh position.
    pub(super) fn at(error: PositionError, mesh_position: f64) -> Self {
        Self::At {
            mesh_position,
            error,
        }
    }
}

/// The contact of `deviating` at each of `positions` under `load`.
///
/// # Errors
///
/// [`PositionsError`].
pub fn contacts(
    deviating: DeviatingPair<'_>,
    load: f64,
    positions: &[f64],
    run: &Run,
) -> Result<Vec<MeshContact>, PositionsError> {
    contacts_keeping(deviating, load, positions, run, |_, _| ())
        .map(|contacts| contacts.into_iter().map(|(contact, ())| contact).collect())
}

/// As [`contacts`], with the value that `keep` takes of each.
///
/// # Errors
///
/// As [`contacts`].
pub fn contacts_keeping<T: Send>(
    deviating: DeviatingPair<'_>,
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
            chunk_of(
                deviating,
                load,
                positions,
                chunk,
                run,
                |place, contact, cells, solution| {
                    contacts.push((place, (contact, keep(cells, solution))));
                },
            )?;
            Ok(contacts)
        })
        .collect();
    let mut contacts: Vec<_> = solved?.into_iter().flatten().collect();
    contacts.sort_unstable_by_key(|&(place, _)| place);
    Ok(contacts.into_iter().map(|(_, contact)| contact).collect())
}

/// The contacts of `deviating` on a chunk of stages. Each is handed to `each`, with the place of its position.
fn chunk_of(
    deviating: DeviatingPair<'_>,
    load: f64,
    positions: &[f64],
    chunk: &[Places],
    run: &Run,
    mut each: impl FnMut(usize, MeshContact, &ContactCells<'_>, &ContactSolution),
) -> Result<(), PositionsError> {
    let mut first = WarmStart::default();
    for (fraction, places) in chunk {
        // Each phase starts from the one before it, and each further period of a phase from the last period.
        let mut phase = MeshPhase::new(deviating, *fraction, load)
            .map_err(|error| PositionsError::at(error, positions[places[0]]))?;
        let mut warm = first.clone();
        for &place in places {
            let eta = positions[place];
            let period = (eta - fraction).round() as i64;
            let solved = phase.contact_with(period, &mut warm, |contact, cells, solution| {
                each(place, contact, cells, solution);
            });
            solved.map_err(|error| PositionsError::at(error, eta))?;
            run.reached(1)?;
            if place == places[0] {
                first = warm.clone();
            }
        }
    }
    Ok(())
}

/// Positions by their fraction of the mesh period, rising, with the places of those that have it.
pub(crate) fn stages(positions: &[f64]) -> Vec<Places> {
    let fraction = |place: usize| {
        let fraction = positions[place] - positions[place].floor();
        (fraction / GRID).round() * GRID
    };
    let mut places: Vec<usize> = (0..positions.len()).collect();
    places.sort_by(|&a, &b| fraction(a).total_cmp(&fraction(b)));
    let mut stages: Vec<Places> = Vec::new();
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

#[cfg(test)]
mod tests {
    use super::stages;

    #[test]
    fn a_fraction_has_the_same_bits_in_all_mesh_periods() {
        for count in [7_u32, 20, 24, 160, 400] {
            for i in 0..count {
                let fraction = f64::from(i) / f64::from(count);
                let [first, others @ ..] = [0.0, 1.0, 37.0, 1234.0].map(|period| {
                    let stages = stages(&[period + fraction]);
                    stages[0].0
                });
                assert!((first - fraction).abs() < 1e-11);
                for other in others {
                    assert_eq!(first.to_bits(), other.to_bits(), "{i} of {count}");
                }
            }
        }
    }
}
