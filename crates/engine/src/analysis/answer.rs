//! The answer to a case: curves, evidence and warnings.

use super::curve::Curve;
use super::evidence::Evidence;
use super::hole_phase::HolePhase;
use super::warning::Warning;

/// The answer to a [`super::Case`].
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// One curve a torque, in the order of the case.
    pub curves: Vec<Curve>,
    /// How good it is.
    pub evidence: Evidence,
    /// How the holes of both gears stand best, where they excite one order together.
    pub hole_phase: Option<HolePhase>,
    /// Warnings for the reader.
    pub warnings: Vec<Warning>,
}
