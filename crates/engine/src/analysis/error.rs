//! Why a case could not be computed.

use crate::assembly::AssemblyError;
use crate::contact::positions::PositionsError;
use crate::contact::{ContactError, Contradiction, PositionError};
use crate::dynamics::FallingRow;
use crate::gear::Member;
use crate::load_distribution::{Formula, FormulaError};
use crate::run::Stopped;

/// Why a case could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    /// The case is of another pair than its faces.
    #[error("the plane pair of the case is not the transverse section of the pair along its faces")]
    SectionDiffers,
    /// The contact solver gave up at a position.
    #[error(
        "the contact did not converge at mesh position {mesh_position}: residual gap {residual:.1e} m after {iterations} iterations"
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
    /// The contact that was found at a position contradicts its own evidence.
    #[error("the contact at mesh position {mesh_position} contradicts its own evidence")]
    Contradicted {
        /// The mesh position η.
        mesh_position: f64,
        /// The contradiction.
        #[source]
        error: Contradiction,
    },
    /// The driver does another work over a whole period than the driven gear gives off. The gears are then as they were before and have stored nothing.
    #[error(
        "under {output_torque} N m the driving torque is {mean} N m in the mean, and {expected} N m by the work of both torques"
    )]
    WorkDiffers {
        /// The output torque T_2, in N m.
        output_torque: f64,
        /// The mean driving torque, in N m.
        mean: f64,
        /// T_2 z_1/z_2, in N m.
        expected: f64,
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
        /// Compliance in m/N: not positive, or not a number.
        compliance: f64,
    },
    /// The rows of a force table do not rise: a mistake of the method.
    #[error(transparent)]
    RowFalls(#[from] FallingRow),
    /// Rotation and press fit stretch a gear beyond the strength of its material.
    #[error("the {member} gear is stretched by {stress} Pa where its material bears {strength} Pa")]
    RimBreaks {
        /// The gear.
        member: Member,
        /// The largest tension, in Pa, without load on the teeth.
        stress: f64,
        /// The tensile strength, in Pa.
        strength: f64,
        /// The speed of the driving gear that it bears, in revolutions per second; `None` if the press fit alone is too much.
        speed: Option<f64>,
    },
    /// The flanks have grown until the teeth have no room.
    #[error("the flanks that have grown leave a backlash of {backlash} m")]
    FlanksJam {
        /// The least backlash along the line of action, in meters, negative.
        backlash: f64,
    },
    /// A grid or a factorization failed.
    #[error("the {member} gear cannot be discretized: {reason}")]
    Discretization {
        /// The gear.
        member: Member,
        /// The failure, with its numbers.
        reason: String,
    },
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl From<AssemblyError> for AnalysisError {
    fn from(error: AssemblyError) -> Self {
        match error {
            AssemblyError::Part { member, error } => Self::Discretization {
                member,
                reason: error.to_string(),
            },
            AssemblyError::Stopped(stopped) => Self::Stopped(stopped),
        }
    }
}

impl From<PositionsError> for AnalysisError {
    fn from(error: PositionsError) -> Self {
        match error {
            PositionsError::At {
                mesh_position,
                error,
            } => Self::at_position(error, mesh_position),
            PositionsError::Stopped(stopped) => Self::Stopped(stopped),
        }
    }
}

impl From<FormulaError> for AnalysisError {
    fn from(error: FormulaError) -> Self {
        match error {
            FormulaError::NoContact { mesh_position } => Self::NoContact { mesh_position },
            FormulaError::NoCompliance {
                formula,
                member,
                compliance,
            } => Self::NoFormula {
                formula,
                member,
                compliance,
            },
        }
    }
}

impl AnalysisError {
    pub(super) fn at_position(error: PositionError, mesh_position: f64) -> Self {
        match error {
            PositionError::NoContact => Self::NoContact { mesh_position },
            PositionError::TooFarApart { apart, coupled } => Self::TooFarApart {
                mesh_position,
                apart,
                coupled,
            },
            PositionError::Contact(ContactError::Stopped(stopped)) => Self::Stopped(stopped),
            PositionError::Contact(ContactError::NotConverged {
                iterations, gap, ..
            }) => Self::NotConverged {
                mesh_position,
                residual: gap,
                iterations,
            },
            PositionError::Contact(error) => Self::ContactFailed {
                mesh_position,
                error,
            },
            PositionError::Contradicted(error) => Self::Contradicted {
                mesh_position,
                error,
            },
        }
    }
}
