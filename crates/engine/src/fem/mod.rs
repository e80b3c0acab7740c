//! The kernel of finite elements: from the elements of a grid to its stiffness on some of its unknowns.
//!
//! Read in this order: [`law`] (stress from strain), [`element`] (one element), `sparse` (the matrix of a grid) and `factor`, [`condensation`] (a grid's
//! stiffness on the kept unknowns), [`recovery`] (displacements and stresses of the others), [`prescribed`] (at every node) and [`centrifugal`] (forces of
//! rotation); of bodies with an extent along an axis [`axial`], [`prism`], [`divided`], [`surface`]
//! and [`volume`]. Beside them: [`dense`]. It knows grids and materials,
//! and nothing of gears.

pub(crate) mod axial;
pub(crate) mod centrifugal;
pub(crate) mod condensation;
pub(crate) mod dense;
pub(crate) mod divided;
pub(crate) mod eigen;
pub(crate) mod element;
mod factor;
pub(crate) mod law;
pub(crate) mod prescribed;
pub(crate) mod prism;
pub(crate) mod recovery;
mod sparse;
pub(crate) mod surface;
pub(crate) mod volume;

pub use sparse::Followers;

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
