//! The common part of all methods: torque by torque they solve the positions of their plan and some more between them, and collect evidence.

use super::between::{PeakSearch, Sections};
use super::case::Case;
use super::curve_parts::CurveParts;
use super::evidence::Evidence;
use super::found::{Between, Found, Kept};
use super::plan::{Pass, Sweep};
use super::warning::{
    Warning, warn_of_decomposition, warn_of_positions, warn_of_pressures, warn_of_projection,
    warn_of_tips, warnings,
};
use super::{Analysis, AnalysisError};
use crate::run::Run;

/// The curve of `case` from the results `found` by `sweep` under `load`, and from further positions of `solve`: first at `kinks`, where the curve is known to
/// have some. Returns it with the further results.
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

/// One load of a case, and the evidence under it beside the curve.
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
    /// By how much δ of the decomposition is off where its blanks were sampled, in meters.
    decomposition_error: Option<f64>,
}

impl UnderLoad<'_> {
    /// As [`parts_of`], from the results `found` of the pass; the evidence of its contacts is noted.
    pub(super) fn parts<K: Kept>(
        &mut self,
        found: &Found<K>,
        kinks: &[f64],
        solve: impl Fn(&Sweep, &Run) -> Result<Found<K>, AnalysisError>,
    ) -> Result<(CurveParts, Between<K>), AnalysisError> {
        self.evidence.gather(&found.contacts, self.load);
        warn_of_tips(self.warnings, &found.contacts);
        let (case, sweep) = (self.case, &self.pass.curve);
        found.check(case, sweep)?;
        parts_of(
            (case, sweep, self.load),
            found,
            kinks,
            self.run,
            |sweep, run| {
                let further = solve(sweep, run)?;
                self.evidence.gather(&further.contacts, self.load);
                warn_of_tips(self.warnings, &further.contacts);
                further.check(case, sweep)?;
                Ok(further)
            },
        )
    }

    /// Notes that the rotations of holed blanks are fitted but for `remainder`, in meters.
    pub(super) fn fitted_but_for(&mut self, remainder: f64) {
        self.decomposition_error = Some(remainder);
    }

    /// Compares the results `found` by a projection with δ of `exact` solutions, at the positions at which it is least certain.
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

/// Refuses a curve over a whole period on which the driver does another work than the driven gear gives off.
fn check_work(case: &Case, output_torque: f64, sections: &Sections) -> Result<(), AnalysisError> {
    /// The part by which the work may differ. Contacts that lag stand off the line of action by a little, which leaves some ten-thousandths of the work;
    /// positions leave more.
    const MOST: f64 = 0.01;
    if !case.covers_whole_periods() {
        return Ok(());
    }
    // Work of a period is torque times angle, and z_2 teeth pass while z_1 do.
    let load = case.pair.load(output_torque);
    let mean = sections.mean_driving_load();
    if (mean - load).abs() <= MOST * load {
        return Ok(());
    }
    let torque = |load: f64| load * case.pair.driving().base_radius();
    Err(AnalysisError::WorkDiffers {
        output_torque,
        mean: torque(mean),
        expected: torque(load),
    })
}

/// The curves of `case` under its torques that are not 0: `solve` finds each. The model of the pair has the given number of unknowns.
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
            decomposition_error: None,
        };
        let parts = solve(&mut under)?;
        check_work(case, output_torque, &parts.sections)?;
        let (projection_error, decomposition_error) =
            (under.projection_error, under.decomposition_error);
        let curve = parts.into_curve(case, output_torque);
        warn_of_positions(under.warnings, case, &curve);
        if let Some(error) = decomposition_error {
            let known = evidence.decomposition_error.unwrap_or(0.0);
            evidence.decomposition_error = Some(error.max(known));
            warn_of_decomposition(&mut warnings, error, &curve.transmission_error_statistics);
        }
        if let Some(error) = projection_error {
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
        hole_phase: None,
        warnings,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::between::Sample;
    use crate::analysis::case::tests::plain;
    use crate::analysis::{Model, SectionHoles, analyze};
    use crate::contact::Contradiction;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{GearPair, HolePattern, PlaneState, SpurGear};
    use crate::library::Library;
    use crate::load_distribution::{BodyFormula, Formulas, ToothFormula};

    fn pair() -> GearPair {
        let gear = |teeth| SpurGear::new(paper_gear(teeth)).expect("can be made");
        GearPair::new(gear(30), gear(60), 90.2e-3).expect("meshes")
    }

    #[test]
    fn a_driver_that_does_another_work_than_the_driven_gear_ends_the_computation() {
        const TORQUE: f64 = 100.0;
        let case = plain(pair(), Model::Section(SectionHoles::Whole), TORQUE, 10);
        let load = case.pair.load(TORQUE);
        // Lines between samples, in closed form: `part` more at one place of ten.
        let sections = |part: f64| {
            let samples: Vec<Sample> = (0..10)
                .map(|i| Sample {
                    position: f64::from(i) / 10.0,
                    transmission_error: 1e-5,
                    stiffness: 1e8,
                    driving_load: if i == 3 { load * (1.0 + part) } else { load },
                    pairs: Vec::new(),
                })
                .collect();
            Sections::of(&case, &samples)
        };
        assert!((sections(0.5).mean_driving_load() / load - 1.05).abs() < 1e-12);
        assert_eq!(check_work(&case, TORQUE, &sections(0.099)), Ok(()));
        let found = check_work(&case, TORQUE, &sections(-0.101));
        let Err(AnalysisError::WorkDiffers { mean, expected, .. }) = found else {
            panic!("{found:?}");
        };
        // Of 60 teeth on 30.
        assert!((expected - 50.0).abs() < 1e-9 && (mean - 50.0 * (1.0 - 0.0101)).abs() < 1e-9);
        // A part of a period says nothing of the work over it.
        let mut part = case.clone();
        part.resolution.span_mesh_periods = Some(1);
        let mut driven = paper_gear(60);
        driven.blank.holes = HolePattern {
            count: 7,
            circle_radius: 40e-3,
            radius: 4e-3,
            phase: 0.0,
        }
        .holes();
        let driven = SpurGear::new(driven).expect("can be made");
        part.pair = GearPair::new(case.pair.driving().clone(), driven, 90.2e-3).expect("meshes");
        assert_eq!(check_work(&part, TORQUE, &sections(0.5)), Ok(()));
    }

    #[test]
    fn teeth_that_deflect_beyond_a_quarter_of_a_module_end_the_computation() {
        let formulas = Model::Formulas(Formulas {
            tooth: ToothFormula::WeberBanaschek,
            body: BodyFormula::Sainsot,
            plane_state: PlaneState::Stress,
        });
        for model in [Model::Section(SectionHoles::Whole), formulas] {
            let case = plain(pair(), model, 40_000.0, 8);
            let found = analyze(&case, &Library::default(), &Run::unattended());
            let Err(AnalysisError::Contradicted {
                mesh_position,
                error: Contradiction::Deflection { deflection, most },
            }) = found
            else {
                panic!("{:?}", found.map(|found| found.evidence));
            };
            assert!((0.0..1.0).contains(&mesh_position));
            assert!(deflection > most && most == 5e-4, "{deflection} {most}");
        }
    }
}
