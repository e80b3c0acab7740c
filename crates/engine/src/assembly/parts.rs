//! Who provides the parts of a model.

use std::sync::Arc;

use rayon::prelude::*;

use super::face_holes::FaceHoles;
use super::face_roots::FaceRoots;
use super::face_yield::{FaceYield, FaceYieldSpec, PlainFace};
use super::pair_spec::{ContactsSpec, FaceContactsSpec, FlanksSpec, PairSpec};
use super::spun::{Spun, SpunSpec};
use super::stack::Stack;
use super::{AssemblyError, BlankSpec, Gear, PartError, Teeth, TeethSpec, WantedGear};

use crate::contact::compliances::Compliances;
use crate::contact::drawn::DrawnFlanks;
use crate::contact::face::drawn::DrawnFaces;
use crate::contact::positions::{PositionsError, contacts};
use crate::contact::{MeshContact, PairModel};
use crate::gear::Member;
use crate::ring::blank::BlankSubstructure;
use crate::run::Run;

/// Providers of parts: one that makes them all ([`MakeAll`]), and one that keeps parts made before ([`crate::library::Library`]).
///
/// A part is a function of its spec: from any provider it has the same bits. A provider overrides the parts that it has without making them anew.
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

    /// How the gear of `spec` answers to its rotation.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn spun(&self, spec: &SpunSpec, run: &Run) -> Result<Arc<Spun>, PartError> {
        let teeth = self.teeth(spec.teeth(), run)?;
        let solid = spec.solid().map(|solid| self.blank(&solid, run));
        spec.make(teeth, solid.transpose()?, run).map(Arc::new)
    }

    /// Compliance of a solid gear's flanks without holes.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn plain_face(&self, spec: &Stack, run: &Run) -> Result<Arc<PlainFace>, PartError> {
        PlainFace::new(spec, run).map(Arc::new)
    }

    /// Compliance of a solid gear's flanks.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn face_yield(&self, spec: &FaceYieldSpec, run: &Run) -> Result<Arc<FaceYield>, PartError> {
        let plain = self.plain_face(&spec.stack(), run)?;
        spec.make(plain, run).map(Arc::new)
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

    /// Store of the flanks of `spec`: an empty one, if nothing is known.
    fn flanks(&self, _spec: &FlanksSpec) -> Arc<DrawnFlanks> {
        Arc::default()
    }

    /// Store of the drawn contacts along faces of `spec`: an empty one, if nothing is known.
    fn drawn_faces(&self, _spec: &FaceContactsSpec) -> Arc<DrawnFaces> {
        Arc::default()
    }

    /// Store of compliances on the flanks of `spec`: an empty one, if nothing is known.
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
        let made = model.deviating(&spec.deviations);
        contacts(made, spec.load, &spec.positions, run).map(Arc::new)
    }
}

/// Makes every part anew.
#[derive(Debug, Clone, Copy)]
pub struct MakeAll;

impl Parts for MakeAll {}

/// Makes the `wanted` gears from the parts of `parts`, in parallel; a part that they share is made once.
///
/// # Errors
///
/// [`AssemblyError`].
pub fn make_gears<P: Parts + ?Sized>(
    wanted: &[WantedGear],
    parts: &P,
    run: &Run,
) -> Result<Vec<Arc<Gear>>, AssemblyError> {
    let teeth: Vec<_> = wanted
        .iter()
        .map(|gear| (gear.member, gear.spec.teeth.clone()))
        .collect();
    let blanks: Vec<_> = wanted
        .iter()
        .flat_map(|gear| {
            gear.spec
                .blanks()
                .into_iter()
                .map(|blank| (gear.member, blank))
        })
        .collect();
    // No part needs another. Teeth come first: they take longest.
    let (teeth, blanks) = rayon::join(
        || made(&teeth, |spec| parts.teeth(spec, run)),
        || made(&blanks, |spec| parts.blank(spec, run)),
    );
    let mut blanks = blanks?.into_iter();
    let blanks: Vec<Vec<_>> = wanted
        .iter()
        .map(|gear| blanks.by_ref().take(gear.spec.blanks().len()).collect())
        .collect();
    (wanted, teeth?, blanks)
        .into_par_iter()
        .with_max_len(1)
        .map(|(gear, teeth, blanks)| {
            let joined = gear.spec.join(&teeth, &blanks, run);
            joined.map(Arc::new).map_err(|error| error.of(gear.member))
        })
        .collect()
}

/// The parts of `wanted`, in its order, made by `make` in parallel; equal ones are made once, for the gear that comes first.
fn made<S: PartialEq + Sync, P: Send + Sync>(
    wanted: &[(Member, S)],
    make: impl Fn(&S) -> Result<Arc<P>, PartError> + Sync,
) -> Result<Vec<Arc<P>>, AssemblyError> {
    let mut distinct: Vec<&(Member, S)> = Vec::new();
    let mut places = Vec::with_capacity(wanted.len());
    for part in wanted {
        let known = distinct.iter().position(|known| known.1 == part.1);
        places.push(known.unwrap_or(distinct.len()));
        if known.is_none() {
            distinct.push(part);
        }
    }
    let parts: Vec<Arc<P>> = distinct
        .par_iter()
        .with_max_len(1)
        .map(|(member, spec)| make(spec).map_err(|error| error.of(*member)))
        .collect::<Result<_, _>>()?;
    Ok(places
        .into_iter()
        .map(|place| parts[place].clone())
        .collect())
}
