//! From a pair to its curves: the methods, their results and spectra.
//!
//! Read in this order: [`case`] (what is asked), [`model`] and [`phase`] (the contact of a pair at one position), `flexible`,
//! `decomposition` and `load_distribution` (the methods), [`curve`] and [`spectrum`] (what comes out), [`library`]
//! (what cases share).

pub mod case;
pub mod curve;
mod decomposition;
mod estimate;
mod flexible;
pub mod library;
mod load_distribution;
mod orders;
mod shelf;
pub mod spectrum;

pub use case::{BodyFormula, Case, Formulas, Method, Resolution, StiffnessRule, ToothFormula};
pub use curve::{Analysis, Curve, ErrorEstimate, Evidence, Statistics, Warning};
pub use estimate::{Estimate, estimate};
pub use library::Library;
pub use load_distribution::{Formula, FormulaQuantity, FormulaRange};
pub use orders::{OrderCause, OrderKind};
pub use shelf::ShelfUsage;

pub use crate::contact::ContactSolver;
pub use crate::gear::PlaneState;

use crate::contact::{ContactError, PairModel};
use crate::fem::tooth::FARTHEST_COUPLED;
use crate::gear::{GearPair, Member};
use crate::grid::GridLevel;
use crate::run::{Run, Stopped};
use curve::{DecompositionParts, LoadShare};
use flexible::{Blanks, Solved};
use spectrum::Spectrum;

/// How far apart, in teeth, loaded teeth are coupled at first; heavier loads bring more pairs into contact, and then this is
/// doubled.
const FIRST_COUPLED: usize = 4;

/// Backlash below this, in modules, counts as none.
const NO_BACKLASH: f64 = 1e-6;

/// Beyond this ratio of the face widths a plane model is told to be doubtful: the load spreads over the wider gear's width by bending it, which
/// a plane does not see.
const LIKE_WIDTHS: f64 = 1.5;

/// Pressures beyond this part of Young's modulus strain a material by about as much: hardened steel yields near one percent, plastics bend
/// their curve at two.
const ELASTIC_STRAIN: f64 = 0.02;

/// Why a case could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    /// The contact solver gave up at a position.
    #[error(
        "the contact did not converge at mesh position {mesh_position}: residual gap {residual} m after {iterations} iterations"
    )]
    NotConverged {
        /// The mesh position η.
        mesh_position: f64,
        /// The gap left, in meters.
        residual: f64,
        /// The iterations spent.
        iterations: u32,
    },
    /// The contact problem at a position could not be stated.
    #[error("the contact at mesh position {mesh_position} failed")]
    ContactFailed {
        /// The mesh position η.
        mesh_position: f64,
        /// Why.
        #[source]
        error: ContactError,
    },
    /// No flanks come near each other at a position.
    #[error("no flanks come near each other at mesh position {mesh_position}")]
    NoContact {
        /// The mesh position η.
        mesh_position: f64,
    },
    /// Teeth touch that are too far apart for the model.
    #[error(
        "at mesh position {mesh_position} teeth touch that stand {apart} apart, and at most {coupled} can be coupled"
    )]
    TooFarApart {
        /// The mesh position η.
        mesh_position: f64,
        /// Teeth between the first and the last that touch.
        apart: usize,
        /// How far apart coupled teeth stand.
        coupled: usize,
    },
    /// A formula of the load distribution, far outside the range for which it was published, gives a pair of teeth no
    /// compliance.
    #[error("{formula} gives a pair of teeth the compliance {compliance} m/N")]
    NoFormula {
        /// The formula.
        formula: Formula,
        /// The gear whose part it is; `None` for the pair.
        member: Option<Member>,
        /// What it gives, in m/N: not positive, or no number.
        compliance: f64,
    },
    /// A grid or a factorization failed.
    #[error("the {member} gear cannot be discretized: {reason}")]
    Discretization {
        /// The gear.
        member: Member,
        /// What failed, with its numbers.
        reason: String,
    },
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Computes `case`, taking from `library` what other cases have computed before.
///
/// # Errors
///
/// [`AnalysisError`] says which position failed and why, or that `run` was stopped.
pub fn analyze(case: &Case, library: &Library, run: &Run) -> Result<Analysis, AnalysisError> {
    // Threads work on different bodies and positions; inside one, faer is sequential.
    faer::set_global_parallelism(faer::Par::Seq);
    let level = case.resolution.grid;
    // Formulas have no grid to refine.
    let with_estimate = case.resolution.error_estimate && case.method != Method::LoadDistribution;
    run.expect(if with_estimate { 2 } else { 1 } * expected_positions(case));
    let mut analysis = analyze_at(case, level, library, run)?;
    if with_estimate {
        let other = analyze_at(case, level.neighbor(), library, run)?;
        analysis.evidence.error_estimate = Some(difference(&analysis.curves, &other.curves));
    }
    Ok(analysis)
}

/// How finely a model is made, and how far apart its teeth are coupled.
#[derive(Debug, Clone, Copy)]
struct Settings {
    level: GridLevel,
    farthest: usize,
}

fn analyze_at(
    case: &Case,
    level: GridLevel,
    library: &Library,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let mut farthest = FIRST_COUPLED;
    loop {
        let settings = Settings { level, farthest };
        let answer = match case.method {
            Method::Flexible => flexible(case, settings, library, run),
            Method::Decomposition => decomposition::decompose(case, settings, library, run),
            Method::ProjectedDecomposition => decomposition::project(case, settings, library, run),
            Method::LoadDistribution => load_distribution::distribute(case, run),
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

/// The model behind the flexible method for `case`, to be asked position by position, with as many pairs in contact as can be followed.
///
/// # Errors
///
/// [`AnalysisError::Discretization`], or [`AnalysisError::Stopped`].
pub fn pair_model(case: &Case, library: &Library, run: &Run) -> Result<PairModel, AnalysisError> {
    faer::set_global_parallelism(faer::Par::Seq);
    let settings = Settings {
        level: case.resolution.grid,
        farthest: FARTHEST_COUPLED,
    };
    flexible::model(case, Blanks::Flexible, settings, library, run).map(|(model, _)| model)
}

/// Contact solutions that `case` needs at one grid level.
fn expected_positions(case: &Case) -> u64 {
    let torques = case.output_torques.len() as u64;
    let solves = match case.resolution.stiffness {
        StiffnessRule::Tangent => 1,
        StiffnessRule::TorqueStep { .. } => 3,
    };
    let per_period = u64::from(case.resolution.positions_per_mesh_period);
    match case.method {
        Method::Flexible => torques * solves * case.positions() as u64,
        Method::Decomposition => decomposition::expected_positions(case),
        Method::ProjectedDecomposition => torques * (solves + 1) * per_period,
        Method::LoadDistribution => torques * per_period,
    }
}

fn flexible(
    case: &Case,
    settings: Settings,
    library: &Library,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let (model, degrees_of_freedom) =
        flexible::model(case, Blanks::Flexible, settings, library, run)?;
    let positions = mesh_positions(case);
    let mut evidence = Evidence::new(degrees_of_freedom);
    let mut warnings = warnings(case);
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let Solved {
            contacts,
            stiffness,
            ..
        } = flexible::solved(case, &model, load, &positions, run, |_, _| ())?;
        flexible::gather(&mut evidence, &contacts, load);
        flexible::warn_of_tips(&mut warnings, &contacts);
        let parts = CurveParts {
            transmission_error: contacts
                .iter()
                .map(|contact| contact.transmission_error)
                .collect(),
            stiffness,
            pairs_in_contact: contacts
                .iter()
                .map(|contact| contact.loaded_pairs())
                .collect(),
            peak_contact_pressure: contacts
                .iter()
                .map(|contact| contact.peak_pressure)
                .collect(),
            load_shares: flexible::load_shares(&positions, &contacts),
            decomposition: None,
        };
        curves.push(parts.into_curve(case, output_torque, positions.clone()));
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}

/// Warns of pressures that no material bears in proportion.
fn warn_of_pressures(warnings: &mut Vec<Warning>, case: &Case, curves: &[Curve]) {
    let moduli = Member::BOTH.map(|member| case.pair.gear(member).material().youngs_modulus);
    let youngs_modulus = moduli[0].min(moduli[1]);
    let pressures = curves.iter().flat_map(|curve| &curve.peak_contact_pressure);
    let pressure = pressures.flatten().copied().fold(0.0, f64::max);
    if pressure > ELASTIC_STRAIN * youngs_modulus {
        warnings.push(Warning::ContactBeyondElasticity {
            pressure,
            youngs_modulus,
        });
    }
}

/// What a method finds at each position of one torque.
struct CurveParts {
    transmission_error: Vec<f64>,
    stiffness: Vec<f64>,
    pairs_in_contact: Vec<u32>,
    peak_contact_pressure: Vec<Option<f64>>,
    load_shares: Vec<LoadShare>,
    decomposition: Option<DecompositionParts>,
}

impl CurveParts {
    fn into_curve(self, case: &Case, output_torque: f64, mesh_position: Vec<f64>) -> Curve {
        let load = case.pair.load(output_torque);
        let spectrum = case.covers_whole_periods().then(|| {
            Spectrum::of(
                &case.pair,
                case.span(),
                &self.transmission_error,
                &self.stiffness,
                case.driving_speed,
            )
        });
        Curve {
            output_torque,
            load,
            mesh_position,
            mesh_stiffness_secant: self
                .transmission_error
                .iter()
                .map(|delta| load / delta)
                .collect(),
            transmission_error_statistics: Statistics::of(&self.transmission_error),
            mesh_stiffness_tangent_statistics: Statistics::of(&self.stiffness),
            transmission_error: self.transmission_error,
            mesh_stiffness_tangent: self.stiffness,
            pairs_in_contact: self.pairs_in_contact,
            peak_contact_pressure: self.peak_contact_pressure,
            load_shares: self.load_shares,
            spectrum,
            decomposition: self.decomposition,
        }
    }
}

/// The mesh positions of one curve: the span in equal steps from 0, its end excluded.
fn mesh_positions(case: &Case) -> Vec<f64> {
    let steps = f64::from(case.resolution.positions_per_mesh_period);
    (0..case.positions()).map(|i| i as f64 / steps).collect()
}

/// Contact cells in one patch.
fn cells_per_patch(level: GridLevel) -> usize {
    match level {
        GridLevel::Coarse => 24,
        GridLevel::Standard => 40,
        GridLevel::Fine => 80,
    }
}

/// What a reader should know of a case before it is computed.
pub fn warnings(case: &Case) -> Vec<Warning> {
    let pair = &case.pair;
    let mut warnings = Vec::new();
    if pair.backlash() < NO_BACKLASH * pair.driving().data().rack.module {
        warnings.push(Warning::ZeroBacklash);
    }
    for member in Member::BOTH {
        let gear = pair.gear(member);
        if let Some(ligament) = gear
            .least_ligament()
            .filter(|&ligament| ligament < gear.data().rack.module)
        {
            warnings.push(Warning::ThinLigament { member, ligament });
        }
    }
    let widths = [pair.driving().face_width(), pair.driven().face_width()];
    let ratio = widths[0].max(widths[1]) / pair.common_face_width();
    if ratio > LIKE_WIDTHS {
        warnings.push(Warning::FaceWidthsDiffer { ratio });
    }
    if !case.covers_whole_periods() {
        warnings.push(Warning::PartialSpan {
            span: case.span(),
            period: pair.period(),
        });
    }
    if case.method == Method::LoadDistribution {
        if has_holes(pair) {
            warnings.push(Warning::HolesNotSeen);
        }
        let outside = load_distribution::out_of_range(case);
        warnings.extend(outside.into_iter().map(Warning::FormulaRange));
    }
    warnings
}

fn has_holes(pair: &GearPair) -> bool {
    pair.driving().holes().is_some() || pair.driven().holes().is_some()
}

impl Evidence {
    fn new(degrees_of_freedom: u64) -> Self {
        Self {
            degrees_of_freedom,
            equilibrium_residual: 0.0,
            complementarity_residual: 0.0,
            largest_penetration: 0.0,
            contact_iterations: 0,
            error_estimate: None,
        }
    }
}

/// The largest differences between the curves of two grid levels.
fn difference(curves: &[Curve], others: &[Curve]) -> ErrorEstimate {
    let largest = |value: fn(&Curve) -> f64| {
        curves
            .iter()
            .zip(others)
            .map(|(a, b)| (value(a) - value(b)).abs())
            .fold(0.0, f64::max)
    };
    ErrorEstimate {
        mean: largest(|curve| curve.transmission_error_statistics.mean),
        peak_to_peak: largest(|curve| curve.transmission_error_statistics.peak_to_peak),
        mean_stiffness: largest(|curve| curve.mesh_stiffness_tangent_statistics.mean),
    }
}
