//! Why a part or a gear could not be made.

use crate::fem::FemError;
use crate::gear::Member;
use crate::grid::GridError;
use crate::run::Stopped;

/// Why a part could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PartError {
    /// Its grid could not be made.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The condensation failed.
    #[error(transparent)]
    Fem(#[from] FemError),
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Why a gear could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AssemblyError {
    /// A part of it could not.
    #[error("a part of the {member} gear could not be made")]
    Part {
        /// The gear.
        member: Member,
        /// Why.
        #[source]
        error: PartError,
    },
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl PartError {
    /// The same of `member`.
    pub(crate) fn of(self, member: Member) -> AssemblyError {
        match self {
            Self::Stopped(stopped) | Self::Fem(FemError::Stopped(stopped)) => {
                AssemblyError::Stopped(stopped)
            }
            error => AssemblyError::Part { member, error },
        }
    }
}
