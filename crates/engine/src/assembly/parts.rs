//! Who provides the parts of a model.

use std::sync::Arc;

use super::carrier::Stack;
use super::face_holes::FaceHoles;
use super::face_roots::FaceRoots;
use super::face_yield::{FaceYield, FaceYieldSpec, PlainFace};
use super::{BlankSpec, Gear, PairSpec, Teeth, TeethSpec, WantedGear, make_gears};
use crate::contact::compliances::Compliances;
use crate::contact::drawn::DrawnFlanks;
use crate::contact::positions::{PositionsError, contacts};
use crate::contact::{MeshContact, PairModel};
use crate::fem::FemError;
use crate::gear::{GearPair, Member, PairDeviations};
use crate::grid::GridError;
use crate::ring::blank::BlankSubstructure;
use crate::run::{Run, Stopped};

/// Who provides parts: whoever makes them all ([`MakeAll`]), or keeps what others have made ([`crate::library::Library`]).
///
/// A part is a function of its spec: whoever provides it, it has the same bits. A provider overrides what it does better than
/// making the part anew.
pub trait Parts: Sync {
    /// The teeth of `spec`.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn teeth(&self, spec: &TeethSpec, run: &Run) -> Result<Arc<Teeth>, PartError> {
        spec.make(run).map(Arc::new)
    }

    /// The blank of `spec`.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn blank(&self, spec: &BlankSpec, run: &Run) -> Result<Arc<BlankSubstructure>, PartError> {
        spec.make(run).map(Arc::new)
    }

    /// The gears that are `wanted`, all unlike, in their order. They are asked for together, because they may share teeth and
    /// blanks.
    ///
    /// # Errors
    ///
    /// [`AssemblyError`].
    fn gears(&self, wanted: &[WantedGear], run: &Run) -> Result<Vec<Arc<Gear>>, AssemblyError> {
        make_gears(wanted, self, run)
    }

    /// What the flanks of a solid gear yield without holes.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn plain_face(&self, spec: &Stack, run: &Run) -> Result<Arc<PlainFace>, PartError> {
        PlainFace::new(spec, run).map(Arc::new)
    }

    /// What the flanks of a solid gear yield.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn face_yield(&self, spec: &FaceYieldSpec, run: &Run) -> Result<Arc<FaceYield>, PartError> {
        spec.make(self, run).map(Arc::new)
    }

    /// How the roots of a solid gear are stressed, of which `spec` says all but the holes.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn face_roots(&self, spec: &Stack, run: &Run) -> Result<Arc<FaceRoots>, PartError> {
        let plain = self.plain_face(spec, run)?;
        FaceRoots::new(spec, &plain, run).map(Arc::new)
    }

    /// How the edges of the holes of a solid gear are stressed; `None` if it has none.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn face_holes(
        &self,
        spec: &FaceYieldSpec,
        run: &Run,
    ) -> Result<Option<Arc<FaceHoles>>, PartError> {
        let made = spec
            .hole_orders()
            .map(|orders| FaceHoles::new(spec, orders, run));
        Ok(made.transpose()?.map(Arc::new))
    }

    /// What is known of the flanks of `spec`: a place for it, if nothing is.
    fn flanks(&self, _spec: &FlanksSpec) -> Arc<DrawnFlanks> {
        Arc::default()
    }

    /// What is known of compliances on the flanks of `spec`: a place for it, if nothing is.
    fn compliances(&self, _spec: &PairSpec) -> Arc<Compliances> {
        Arc::default()
    }

    /// The contacts of `spec`, of whose drawn pair `model` is the model.
    ///
    /// # Errors
    ///
    /// [`PositionsError`].
    fn contacts(
        &self,
        spec: &ContactsSpec,
        model: &PairModel,
        run: &Run,
    ) -> Result<Arc<Vec<MeshContact>>, PositionsError> {
        let made = model.made(&spec.deviations);
        contacts(made, spec.load, &spec.positions, run).map(Arc::new)
    }
}

/// Makes every part anew.
#[derive(Debug, Clone, Copy)]
pub struct MakeAll;

impl Parts for MakeAll {}

/// What the contact of flanks depends on, whatever carries their teeth and however each of these deviates.
#[derive(Debug, Clone, PartialEq)]
pub struct FlanksSpec {
    /// The pair as drawn, without its blanks.
    pub pair: GearPair,
    /// The teeth of the driving and of the driven gear.
    pub teeth: [TeethSpec; 2],
}

/// What the contacts of a pair at some positions depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactsSpec {
    /// The transmitted load F in N.
    pub load: f64,
    /// The mesh positions η.
    pub positions: Vec<f64>,
    /// The drawn pair.
    pub pair: PairSpec,
    /// What its teeth deviate by.
    pub deviations: PairDeviations,
}

/// Why a part could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PartError {
    /// Its grid could not be laid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// It could not be condensed.
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
