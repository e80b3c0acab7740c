//! Plane-stress finite elements and exact substructuring.
//!
//! Read in this order: [`element`] (one element), [`condensation`] (a grid's stiffness on the unknowns that are kept),
//! [`recovery`] (displacements and stresses of the others),
//! [`harmonics`] (the unknowns of an interface circle), [`cyclic`] (N equal sectors joined into a ring on them), [`tooth`], [`teeth`] (the ring of them), [`blank`], and
//! [`body`], which joins them into the compliance of a whole gear. What happens inside: [`motion`]
//! (of the interface circle under loads), [`teeth_recovery`] and [`blank::BlankRecovery`], and [`prescribed`] (at every node). A blank by itself: [`annulus`]. Beside them: [`dense`] and `factor`
//! (factorizations), `axes` and `modes`.

pub mod annulus;
mod assembly;
mod axes;
pub mod blank;
pub mod body;
pub mod condensation;
pub mod cyclic;
pub mod dense;
pub mod element;
mod factor;
pub mod harmonics;
mod modes;
pub mod motion;
pub mod prescribed;
pub mod recovery;
pub mod teeth;
pub mod teeth_recovery;
pub mod tooth;

use crate::run::Stopped;

/// Why a substructure could not be condensed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FemError {
    /// The stiffness of the grid is not positive definite.
    #[error("the stiffness of {part} is not positive definite on {unknowns} unknowns")]
    NotPositiveDefinite {
        /// The part: tooth, blank, ring.
        part: &'static str,
        /// The number of unknowns.
        unknowns: usize,
    },
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The problem is too large for this machine's indices or memory.
    #[error("{part} with {unknowns} unknowns is too large to factorize")]
    TooLarge {
        /// The part.
        part: &'static str,
        /// The number of unknowns.
        unknowns: usize,
    },
}
