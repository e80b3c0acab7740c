//! What all methods do alike: torque by torque they solve the positions of their plan and some more between them, and say how good that is.

use super::between::{PeakSearch, Sections};
use super::case::Case;
use super::curve_parts::CurveParts;
use super::evidence::Evidence;
use super::found::{Between, Found, Kept};
use super::plan::{Pass, Sweep};
use super::warning::{Warning, warn_of_pressures, warn_of_projection, warn_of_tips, warnings};
use super::{Analysis, AnalysisError};
use crate::run::Run;

/// The curve of `case` of what is `found` by `sweep` under `load`, and of what `solve` finds at further positions: at first at `kinks`, where the curve is known to
/// have some. With what is found there.
pub(super) fn parts_of<K: Kept>(
    (case, sweep, load): (&Case, &Sweep, f64),
    found: &Found<K>,
    kinks: &[f64],
    run: &Run,
    mut solve: impl FnMut(&Sweep, &Run) -> Result<Found<K>, AnalysisError>,
) -> Result<(CurveParts, Between<K>), AnalysisError> {
    let mut between = Between::nothing();
    let mut samples = found.samples(case, sweep);
    if sweep.further.most == 0 {
        let sections = Sections::of(case, &samples);
        return Ok((
            CurveParts::of((case, load), found, &between, sections),
            between,
        ));
    }
    let mut solve = |sweep: &Sweep, run: &Run| {
        let further = solve(sweep, run)?;
        let samples = further.samples(case, sweep);
        let watched = further.watched(&sweep.positions);
        between.add(&sweep.positions, further);
        Ok::<_, AnalysisError>((samples, watched))
    };
    let mut watched = found.watched(&sweep.positions);
    if !kinks.is_empty() {
        // They belong to the curve as its positions do, and do not count as progress.
        let (more, at_kinks) = solve(&sweep.at(kinks), &run.unwatched())?;
        samples.extend(more);
        samples.sort_by(|a, b| a.position.total_cmp(&b.position));
        watched.extend(at_kinks);
    }
    let sections = sweep.sections(case, samples, run, |further| {
        let (samples, more) = solve(further, run)?;
        watched.extend(more);
        Ok(samples)
    })?;
    if sweep.further.for_peaks > 0 {
        let search = PeakSearch::of(case, sweep.further.repeats_after);
        let solved = search.extend(watched, |positions| {
            Ok::<_, AnalysisError>(solve(&sweep.at(positions), run)?.1)
        })?;
        sweep.peaks_searched(solved, run)?;
    }
    Ok((
        CurveParts::of((case, load), found, &between, sections),
        between,
    ))
}

/// One load of a case, and what is learned under it beside the curve.
pub(super) struct UnderLoad<'a> {
    case: &'a Case,
    pass: &'a Pass,
    run: &'a Run,
    /// F = T/r_b2.
    pub(super) load: f64,
    evidence: &'a mut Evidence,
    pub(super) warnings: &'a mut Vec<Warning>,
    /// The largest difference to exact solutions, in meters, where there is one.
    projection_error: Option<f64>,
}

impl UnderLoad<'_> {
    /// As [`parts_of`], of what is `found` by the pass; what its contacts say of themselves is noted.
    pub(super) fn parts<K: Kept>(
        &mut self,
        found: &Found<K>,
        kinks: &[f64],
        solve: impl Fn(&Sweep, &Run) -> Result<Found<K>, AnalysisError>,
    ) -> Result<(CurveParts, Between<K>), AnalysisError> {
        self.evidence.gather(&found.contacts, self.load);
        warn_of_tips(self.warnings, &found.contacts);
        let sweep = &self.pass.curve;
        parts_of(
            (self.case, sweep, self.load),
            found,
            kinks,
            self.run,
            |sweep, run| {
                let further = solve(sweep, run)?;
                self.evidence.gather(&further.contacts, self.load);
                Ok(further)
            },
        )
    }

    /// Compares what is `found` by a projection with δ of `exact` solutions, at the positions at which it is least sure.
    pub(super) fn check<K>(
        &mut self,
        found: &Found<K>,
        exact: impl FnOnce(&[f64]) -> Result<Vec<f64>, AnalysisError>,
    ) -> Result<(), AnalysisError> {
        let round = found.contacts.iter().map(|contact| contact.stiffness);
        let places = self
            .pass
            .checks
            .places(self.case, &round.collect::<Vec<_>>());
        let all = self.case.mesh_positions();
        let positions: Vec<f64> = places.iter().map(|&place| all[place]).collect();
        let exact = exact(&positions)?;
        let apart = places.iter().zip(&exact);
        let apart = apart.map(|(&place, exact)| (found.transmission_error[place] - exact).abs());
        self.projection_error = Some(apart.fold(0.0, f64::max));
        Ok(())
    }
}

/// The curves of `case` under its torques that are not 0: `solve` finds each. The model of the pair has so many unknowns.
pub(super) fn curves(
    (case, pass): (&Case, &Pass),
    degrees_of_freedom: u64,
    run: &Run,
    mut solve: impl FnMut(&mut UnderLoad<'_>) -> Result<CurveParts, AnalysisError>,
) -> Result<Analysis, AnalysisError> {
    let mut evidence = Evidence::new(degrees_of_freedom);
    let mut warnings = warnings(case);
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for output_torque in case.loaded_torques() {
        let mut under = UnderLoad {
            case,
            pass,
            run,
            load: case.pair.load(output_torque),
            evidence: &mut evidence,
            warnings: &mut warnings,
            projection_error: None,
        };
        let parts = solve(&mut under)?;
        let error = under.projection_error;
        let curve = parts.into_curve(case, output_torque);
        if let Some(error) = error {
            let known = evidence.projection_error.unwrap_or(0.0);
            evidence.projection_error = Some(error.max(known));
            warn_of_projection(&mut warnings, error, &curve.transmission_error_statistics);
        }
        curves.push(curve);
    }
    warn_of_pressures(&mut warnings, case, &curves);
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}
