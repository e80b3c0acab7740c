//! Cost of a finer grid, and the differences that it makes.

use anyhow::Context;
use meshwright_engine::analysis::{Case, Curve};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;

use super::stopwatch::{answer, least};
use crate::reproduce::cases::example;
use crate::reproduce::computed::line;

/// The examples, and how the table calls them.
const PAIRS: [(&str, &str); 4] = [
    ("test-case-1", "case 1"),
    ("test-case-2", "case 2"),
    ("test-case-3", "case 3"),
    ("standard-pair", "standard pair"),
];

const LEVELS: [(GridLevel, &str); 3] = [
    (GridLevel::Coarse, "coarse"),
    (GridLevel::Standard, "standard"),
    (GridLevel::Fine, "fine"),
];

/// The first harmonics of the mesh.
const HARMONICS: [&str; 3] = ["H_Z2", "H_2Z2", "H_3Z2"];

/// The part of the largest mesh harmonic below which a harmonic is compared as a part of the largest one: where harmonics
/// nearly cancel, their own size says nothing of an error.
const SMALL_HARMONIC: f64 = 0.2;

/// One pair at one level, by the flexible method over the true period.
#[derive(Debug)]
pub(super) struct LevelRow {
    pub(super) pair: &'static str,
    pub(super) grid: &'static str,
    pub(super) degrees_of_freedom: u64,
    pub(super) seconds: f64,
    /// Differences from the fine level, relative; `None` at the fine level itself.
    pub(super) against_fine: Option<Differences>,
}

/// Relative differences of the flexible curves of two levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Differences {
    pub(super) mean: f64,
    pub(super) peak_to_peak: f64,
    pub(super) rms: f64,
    pub(super) mean_stiffness: f64,
    /// The largest of the first three harmonics of the mesh; those below a fifth of the largest harmonic relative to that.
    pub(super) mesh_harmonic: f64,
}

/// Measures them.
///
/// # Errors
///
/// If an example cannot be computed.
pub(super) fn measured() -> anyhow::Result<Vec<LevelRow>> {
    let mut rows = Vec::new();
    for (name, pair) in PAIRS {
        let mut at_levels = Vec::new();
        for (level, grid) in LEVELS {
            let mut case: Case = example(name)?;
            case.resolution.grid = level;
            let (seconds, analysis) = least(|| Ok(()), |()| answer(&case, &Library::default()))?;
            let degrees_of_freedom = analysis.evidence.degrees_of_freedom;
            let curve = analysis.curves.into_iter().next();
            let curve = curve.context("an example has a torque")?;
            at_levels.push((grid, degrees_of_freedom, seconds, curve));
        }
        let fine = at_levels.last().map(|(.., curve)| curve.clone());
        let fine = fine.context("there are levels")?;
        for (grid, degrees_of_freedom, seconds, curve) in at_levels {
            let differs = (grid != "fine").then(|| differences(&curve, &fine));
            rows.push(LevelRow {
                pair,
                grid,
                degrees_of_freedom,
                seconds,
                against_fine: differs.transpose()?,
            });
        }
    }
    Ok(rows)
}

fn differences(curve: &Curve, fine: &Curve) -> anyhow::Result<Differences> {
    let change = |value: fn(&Curve) -> f64| value(curve) / value(fine) - 1.0;
    let amplitudes = |curve: &Curve| -> anyhow::Result<Vec<f64>> {
        HARMONICS
            .iter()
            .map(|label| Ok(line(curve, label)?.0))
            .collect()
    };
    let (now, exact) = (amplitudes(curve)?, amplitudes(fine)?);
    let largest = exact.iter().copied().fold(0.0, f64::max);
    let mesh_harmonic = now
        .iter()
        .zip(&exact)
        .map(|(now, &exact)| {
            let against = if exact > SMALL_HARMONIC * largest {
                exact
            } else {
                largest
            };
            ((now - exact) / against).abs()
        })
        .fold(0.0, f64::max);
    Ok(Differences {
        mean: change(|curve| curve.transmission_error_statistics.mean),
        peak_to_peak: change(|curve| curve.transmission_error_statistics.peak_to_peak),
        rms: change(|curve| curve.transmission_error_statistics.rms),
        mean_stiffness: change(|curve| curve.mesh_stiffness_tangent_statistics.mean),
        mesh_harmonic,
    })
}
