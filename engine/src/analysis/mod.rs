//! From a pair to its curves: the methods, their results and spectra.

pub mod case;
pub mod curve;
pub mod load_distribution;
pub mod spectrum;

pub use case::{
    BodyFormula, Case, ContactSolver, Formulas, Method, PlaneState, Resolution, StiffnessRule,
    ToothFormula,
};
pub use curve::{Analysis, Curve, Evidence, Statistics, Warning};

use crate::run::{Run, Stopped};

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
    /// No flanks come near each other at a position.
    #[error("no flanks come near each other at mesh position {mesh_position}")]
    NoContact {
        /// The mesh position η.
        mesh_position: f64,
    },
    /// A grid or a factorization failed.
    #[error("the {member} gear cannot be discretized: {reason}")]
    Discretization {
        /// The gear.
        member: crate::gear::Member,
        /// What failed, with its numbers.
        reason: String,
    },
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// What a case will cost, known before it is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Unknowns of both gears before condensation.
    pub degrees_of_freedom: u64,
    /// Memory in bytes.
    pub memory: u64,
    /// Time on one core in seconds.
    pub seconds: f64,
    /// Positions times torques.
    pub positions: u64,
}

/// Substructures that several cases share, kept within a bound; cloning shares it.
#[derive(Debug, Clone, Default)]
pub struct Library {}

impl Library {
    /// A library that keeps at most `bytes` of substructures.
    pub fn with_capacity(bytes: usize) -> Self {
        let _ = bytes;
        Self {}
    }
}

/// Computes `case`.
///
/// # Errors
///
/// [`AnalysisError`].
pub fn analyze(case: &Case, library: &Library, run: &Run) -> Result<Analysis, AnalysisError> {
    let _ = (case, library, run);
    Err(AnalysisError::Stopped(Stopped))
}

/// Estimates what `case` will cost.
pub fn estimate(case: &Case) -> Estimate {
    let _ = case;
    Estimate {
        degrees_of_freedom: 0,
        memory: 0,
        seconds: 0.0,
        positions: 0,
    }
}
