//! The paper's cases and the standard pair by every method, from nothing and with something known.

use anyhow::Context;
use meshwright_engine::analysis::{Analysis, Case, Method, analyze};
use meshwright_engine::gear::{GearPair, SpurGear};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use serde::Serialize;

use super::stopwatch::least;
use crate::reproduce::cases::{at_torques, by, example};
use crate::reproduce::computed::method_name;

/// The examples, and how the tables call them.
pub(super) const PAIRS: [(&str, &str); 4] = [
    ("test-case-1", "case 1"),
    ("test-case-2", "case 2"),
    ("test-case-3", "case 3"),
    ("standard-pair", "standard pair"),
];

const METHODS: [Method; 4] = [
    Method::Flexible,
    Method::Decomposition,
    Method::ProjectedDecomposition,
    Method::LoadDistribution,
];

/// How far the hole circle grows where holes are moved, in meters.
const MOVE: f64 = 0.1e-3;

/// What one pair takes by one method, in seconds.
#[derive(Debug, Serialize)]
pub(super) struct JobTime {
    pub(super) pair: &'static str,
    pub(super) method: &'static str,
    pub(super) positions: usize,
    /// With nothing computed before.
    pub(super) cold_seconds: f64,
    /// With everything but the holes as computed before; none for pairs without holes and methods that do not see them.
    pub(super) holes_moved_seconds: Option<f64>,
    /// At another torque on the pair computed before.
    pub(super) further_torque_seconds: f64,
}

/// Measures them.
///
/// # Errors
///
/// If an example cannot be computed.
pub(super) fn measured() -> anyhow::Result<Vec<JobTime>> {
    let mut times = Vec::new();
    for (name, pair) in PAIRS {
        let case = example(name)?;
        for method in METHODS {
            let case = by(&case, method);
            let known = || {
                let library = Library::default();
                answer(&case, &library).map(|_| library)
            };
            let torques = case.output_torques.iter().map(|torque| 0.9 * torque);
            let further = at_torques(&case, torques.collect());
            let moved = with_moved_holes(&case)?.filter(|_| method != Method::LoadDistribution);
            times.push(JobTime {
                pair,
                method: method_name(method),
                positions: case.positions(),
                cold_seconds: cold(&case)?,
                holes_moved_seconds: match moved {
                    Some(moved) => Some(least(known, |library| answer(&moved, &library))?.0),
                    None => None,
                },
                further_torque_seconds: least(known, |library| answer(&further, &library))?.0,
            });
        }
    }
    Ok(times)
}

/// The least time of `case` with nothing computed before.
pub(super) fn cold(case: &Case) -> anyhow::Result<f64> {
    Ok(least(|| Ok(()), |()| answer(case, &Library::default()))?.0)
}

/// The answer to `case`.
pub(super) fn answer(case: &Case, library: &Library) -> anyhow::Result<Analysis> {
    analyze(case, library, &Run::unattended())
        .with_context(|| format!("the {} method failed", method_name(case.method)))
}

/// `case` with its hole circles a little larger; nothing for a pair without holes.
fn with_moved_holes(case: &Case) -> anyhow::Result<Option<Case>> {
    let pair = &case.pair;
    if pair.driving().holes().is_empty() && pair.driven().holes().is_empty() {
        return Ok(None);
    }
    let moved = |gear: &SpurGear| {
        let mut data = gear.data().clone();
        for hole in &mut data.blank.holes {
            hole.circle_radius += MOVE;
        }
        SpurGear::new(data)
    };
    let (driving, driven) = (moved(pair.driving())?, moved(pair.driven())?);
    Ok(Some(Case {
        pair: GearPair::new(driving, driven, pair.center_distance())?,
        ..case.clone()
    }))
}
