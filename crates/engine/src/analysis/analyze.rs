//! Computation of a case: the methods carry out their plan.

use super::case::{Case, Model, SectionHoles};
use super::evidence::{ErrorEstimate, Evidence};
use super::plan::{Pass, Plan};
use super::running::CurveRunning;
use super::setup::Setup;
use super::spun_pair::PairState;
use super::warning::warnings;
use super::{
    Analysis, AnalysisError, decomposition, flexible, light, load_distribution, projected,
    three_dimensional, windows,
};
use crate::assembly::{Blanks, Parts};
use crate::contact::PairModel;
use crate::gear::PairDeviations;
use crate::grid::GridLevel;
use crate::ring::teeth::FARTHEST_COUPLED;
use crate::run::Run;

/// How far apart, in teeth, loaded teeth are coupled at first; heavier loads bring more pairs into contact, and then this is
/// doubled.
const FIRST_COUPLED: usize = 4;

/// Computes `case` from the parts of `parts`, each of its windows by itself.
///
/// # Errors
///
/// [`AnalysisError`] says which position failed and why, or that `run` was stopped.
pub fn analyze(case: &Case, parts: &dyn Parts, run: &Run) -> Result<Analysis, AnalysisError> {
    let plans: Vec<Plan> = case.windowed().iter().map(Plan::of).collect();
    run.expect(plans.iter().map(Plan::solutions).sum());
    let answers = plans.iter().map(|plan| answered(plan, parts, run));
    let answers = answers.collect::<Result<Vec<_>, _>>()?;
    Ok(windows::joined(answers))
}

/// The answer to the case of `plan`, with the part of the holes alone where teeth deviate, and with the best turn of the holes of both gears.
pub(super) fn answered(
    plan: &Plan,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let faces = plan.case.faces();
    if faces.is_some_and(|faces| *faces.pair.section() != plan.case.pair) {
        return Err(AnalysisError::SectionDiffers);
    }
    let mut analysis = carried_out(plan, parts, run)?;
    tell_apart_from_rest(&mut analysis, plan, parts, run)?;
    if let Some(drawn) = plan.case.holes_alone() {
        let alone = carried_out(&Plan::of(&drawn), parts, &run.unwatched())?;
        for (curve, alone) in analysis.curves.iter_mut().zip(&alone.curves) {
            if let (Some(own), Some(alone)) = (&mut curve.spectrum, &alone.spectrum) {
                own.tell_holes_alone(alone);
            }
        }
    }
    if let Some(phase) = &plan.hole_phase {
        let (case, level) = (&plan.case, plan.case.resolution.grid);
        analysis.hole_phase = coupled_as_needed((case, None), level, parts, run, |setup| {
            phase.solve(setup, &analysis.curves)
        })?;
    }
    Ok(analysis)
}

/// Says in the curves of a case that runs how far its speed alone moves them at the orders of its holes.
fn tell_apart_from_rest(
    analysis: &mut Analysis,
    plan: &Plan,
    parts: &dyn Parts,
    run: &Run,
) -> Result<(), AnalysisError> {
    let Some(case) = plan.case.at_rest() else {
        return Ok(());
    };
    let at_rest = carried_out(&Plan::of(&case), parts, &run.unwatched())?;
    for (curve, at_rest) in analysis.curves.iter_mut().zip(&at_rest.curves) {
        let both = curve.spectrum.as_ref().zip(at_rest.spectrum.as_ref());
        let apart = both.and_then(|(one, other)| one.apart_at_hole_orders(other));
        if let Some(running) = &mut curve.running {
            running.hole_order = apart;
        }
    }
    Ok(())
}

/// The curves of the case of `plan`.
pub(super) fn carried_out(
    plan: &Plan,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    // Threads work on different bodies and positions; inside one, faer is sequential.
    faer::set_global_parallelism(faer::Par::Seq);
    let case = &plan.case;
    let state = PairState::of(case, case.resolution.grid, parts, run)?;
    let state = state.as_ref();
    let mut passes = plan.passes.iter();
    let mut analysis = match passes.next() {
        Some(pass) => passed((case, state), pass, parts, run)?,
        None => Analysis {
            curves: Vec::new(),
            evidence: Evidence::new(0),
            hole_phase: None,
            warnings: warnings(case),
        },
    };
    if let Some(pass) = passes.next() {
        let other = passed((case, state), pass, parts, run)?;
        let estimate = ErrorEstimate::between(&analysis.curves, &other.curves);
        analysis.evidence.error_estimate = Some(estimate);
    }
    let mut loaded = analysis.curves.into_iter();
    let curve = |torque: &f64| match *torque {
        0.0 => Some(light::curve((case, state), &plan.light)),
        _ => loaded.next().map(Ok),
    };
    let torques = case.output_torques.iter();
    analysis.curves = torques.filter_map(curve).collect::<Result<_, _>>()?;
    if let Some(state) = state {
        analysis.warnings.extend(state.warnings.iter().copied());
        let turns = case
            .runs()
            .is_some_and(|running| running.driving_speed.0 != 0.0);
        for curve in &mut analysis.curves {
            let has_orders = !case.holed().is_empty() && curve.spectrum.is_some();
            curve.running = Some(CurveRunning {
                radial_growth: state.radial_growth,
                hole_order: (has_orders && !turns).then_some(0.0),
            });
        }
    }
    Ok(analysis)
}

/// Makes one `pass` over `case`.
fn passed(
    (case, state): (&Case, Option<&PairState>),
    pass: &Pass,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let in_plane = |solve: Solve| {
        coupled_as_needed((case, state), pass.level, parts, run, |setup| {
            solve(setup, pass)
        })
    };
    match &case.model {
        Model::Section(SectionHoles::Whole) => in_plane(flexible::solve),
        Model::Section(SectionHoles::Fitted) => in_plane(decomposition::solve),
        Model::Section(SectionHoles::FirstOrder) => in_plane(projected::solve),
        Model::Faces(faces, holes) => {
            let drawn = case.pair.deviations();
            let deviations = state.map_or(&drawn, |state| &state.deviations);
            let loads = state.map_or([None; 2], |state| state.loads);
            let of = (deviations, loads);
            three_dimensional::solve((case, faces, *holes), of, pass, parts, run)
        }
        Model::Formulas(formulas) => load_distribution::solve(case, *formulas, pass, run),
    }
}

/// Computation of a case by a plane method.
type Solve = fn(Setup<'_>, &Pass) -> Result<Analysis, AnalysisError>;

/// Result of `solve` for `case` in the plane at `level`, with teeth coupled as far apart as they turn out to be loaded together.
fn coupled_as_needed<T>(
    (case, state): (&Case, Option<&PairState>),
    level: GridLevel,
    parts: &dyn Parts,
    run: &Run,
    solve: impl Fn(Setup<'_>) -> Result<T, AnalysisError>,
) -> Result<T, AnalysisError> {
    let drawn = case.pair.deviations();
    let deviations = state.map_or(&drawn, |state| &state.deviations);
    let mut farthest = FIRST_COUPLED;
    loop {
        let setup = Setup {
            resting: state.map(|state| &state.stresses),
            ..Setup::new((case, deviations), level, farthest, parts, run)
        };
        match solve(setup) {
            Err(AnalysisError::TooFarApart { .. }) if farthest < FARTHEST_COUPLED => farthest *= 2,
            answer => return answer,
        }
    }
}

/// The model behind the flexible method for `case`, to be asked position by position, with as many pairs in contact as can be
/// followed. It is that of the drawn pair, whatever its teeth deviate by.
///
/// # Errors
///
/// [`AnalysisError::Discretization`], or [`AnalysisError::Stopped`].
pub fn pair_model(case: &Case, parts: &dyn Parts, run: &Run) -> Result<PairModel, AnalysisError> {
    faer::set_global_parallelism(faer::Par::Seq);
    let as_drawn = &PairDeviations::NONE;
    let level = case.resolution.grid;
    let setup = Setup::new((case, as_drawn), level, FARTHEST_COUPLED, parts, run);
    setup.model(Blanks::Flexible).map(|(model, _)| model)
}
