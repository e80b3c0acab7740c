//! From a pair to its curves: the methods, their results and spectra.
//!
//! Read in this order: [`case`] (what is asked), `setup` (what the methods work with), `flexible`, `rigid_blank`,
//! `decomposition`, `projected`, `three_dimensional` and `load_distribution` (the methods), `first_order` (what holes change, in the plane and along faces), `light` (torque 0, alike for all), [`stress`] (at roots and holes; along faces `face_stress`) and [`fields`] (everywhere; along faces [`face_fields`]), [`contact_pattern`] (over the flanks), `curve_parts` and [`curve`], [`evidence`], [`warning`],
//! [`error`] and [`spectrum`] (what comes out), `estimate` (what it costs); [`forces`] (tables of force, and motion at speed).

pub mod case;
pub mod contact_pattern;
pub mod curve;
mod curve_parts;
mod decomposition;
pub mod error;
mod estimate;
pub mod evidence;
pub mod face_fields;
mod face_stress;
pub mod fields;
mod first_order;
mod flexible;
pub mod forces;
mod light;
mod load_distribution;
mod orders;
mod projected;
mod rigid_blank;
mod setup;
pub mod spectrum;
pub mod stress;
mod three_dimensional;
pub mod warning;

pub use case::{Case, Faces, Method, Resolution, StiffnessRule};
pub use curve::{Analysis, Curve, FaceLoad, Statistics};
pub use error::AnalysisError;
pub use estimate::{Estimate, estimate};
pub use evidence::{ErrorEstimate, Evidence};
pub use orders::{OrderCause, OrderKind};
pub use warning::{PLANE_RIM, PLANE_WEB, Warning, warnings};

pub use crate::contact::ContactSolver;
use crate::gear::PairDeviations;
pub use crate::gear::PlaneState;
pub use crate::load_distribution::{
    BodyFormula, Formula, FormulaQuantity, FormulaRange, Formulas, ToothFormula,
};

use crate::assembly::{Blanks, Parts};
use crate::contact::PairModel;
use crate::grid::GridLevel;
use crate::ring::teeth::FARTHEST_COUPLED;
use crate::run::Run;
use setup::Setup;
use warning::warn_of_pressures;

/// How far apart, in teeth, loaded teeth are coupled at first; heavier loads bring more pairs into contact, and then this is
/// doubled.
const FIRST_COUPLED: usize = 4;

/// Computes `case` of what `parts` provides.
///
/// # Errors
///
/// [`AnalysisError`] says which position failed and why, or that `run` was stopped.
pub fn analyze(case: &Case, parts: &dyn Parts, run: &Run) -> Result<Analysis, AnalysisError> {
    // Threads work on different bodies and positions; inside one, faer is sequential.
    faer::set_global_parallelism(faer::Par::Seq);
    let level = case.resolution.grid;
    run.expect(expected(case));
    let loaded = light::without_torque_zero(case);
    if loaded.output_torques.is_empty() {
        return light::alone(case);
    }
    let mut analysis = analyze_at(&loaded, level, parts, run)?;
    if is_estimated(case) {
        let curves_only = Case {
            stress: false,
            ..loaded
        };
        let other = analyze_at(&curves_only, level.neighbor(), parts, run)?;
        let estimate = ErrorEstimate::between(&analysis.curves, &other.curves);
        analysis.evidence.error_estimate = Some(estimate);
    }
    analysis.curves = light::with_torque_zero(case, analysis.curves)?;
    Ok(analysis)
}

/// Computes `case` at one grid level, with teeth coupled as far apart as they turn out to be loaded together.
fn analyze_at(
    case: &Case,
    level: GridLevel,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let deviations = case.pair.deviations();
    let mut farthest = FIRST_COUPLED;
    loop {
        let setup = Setup::new((case, &deviations), level, farthest, parts, run);
        let answer = match case.method {
            Method::Flexible => flexible::solve(setup),
            Method::Decomposition => decomposition::solve(setup),
            Method::ProjectedDecomposition => projected::solve(setup),
            Method::ThreeDimensional | Method::ThreeDimensionalProjected => {
                three_dimensional::solve(case, level, parts, run)
            }
            Method::LoadDistribution => load_distribution::solve(case, run),
        };
        match answer {
            Err(AnalysisError::TooFarApart { .. }) if farthest < FARTHEST_COUPLED => farthest *= 2,
            Ok(mut analysis) => {
                warn_of_pressures(&mut analysis.warnings, case, &analysis.curves);
                return Ok(analysis);
            }
            error => return error,
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

/// Whether a second grid level tells the error of `case`. Formulas have no grid to refine.
fn is_estimated(case: &Case) -> bool {
    case.resolution.error_estimate && case.method != Method::LoadDistribution
}

/// Contact solutions that `case` needs.
fn expected(case: &Case) -> u64 {
    let levels = if is_estimated(case) { 2 } else { 1 };
    levels * expected_positions(case)
}

/// Contact solutions that `case` needs at one grid level.
fn expected_positions(case: &Case) -> u64 {
    let torques = case.output_torques.len() as u64;
    let solves = match case.resolution.stiffness {
        StiffnessRule::Tangent => 1,
        StiffnessRule::TorqueStep { .. } => 3,
    };
    let repeating = case.repeating_positions().len() as u64;
    match case.method {
        Method::Flexible | Method::ThreeDimensional => torques * solves * case.positions() as u64,
        Method::Decomposition => decomposition::expected_positions(case),
        Method::ProjectedDecomposition => projected::expected_positions(case),
        Method::ThreeDimensionalProjected => {
            torques * (solves * repeating + first_order::expected_checks(case))
        }
        Method::LoadDistribution => torques * repeating,
    }
}
