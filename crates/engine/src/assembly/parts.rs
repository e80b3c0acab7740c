//! Providers of the parts of a model.

use std::sync::Arc;

use rayon::prelude::*;

use super::face_compliance::{FaceCompliance, FaceComplianceSpec, PlainFace};
use super::face_holes::FaceHoles;
use super::face_roots::FaceRoots;
use super::pair_spec::{ContactsSpec, FaceContactsSpec, FlanksSpec, PairSpec};
use super::spun::{Spun, SpunSpec};
use super::stack::Stack;
use super::{
    AssemblyError, BlankSpec, Gear, PartError, PlainGearSpec, Teeth, TeethSpec, WantedGear,
};

use crate::contact::compliances::Compliances;
use crate::contact::drawn::DrawnFlanks;
use crate::contact::face::drawn::DrawnFaces;
use crate::contact::positions::{PositionsError, contacts};
use crate::contact::{MeshContact, PairModel};
use crate::gear::Member;
use crate::ring::blank::BlankSubstructure;
use crate::ring::plain::PlainGear;
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

    /// The gear without holes of `spec`, whose `teeth` and whose `blank` are those of the spec.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn plain_gear(
        &self,
        _spec: &PlainGearSpec,
        (teeth, blank): (&Teeth, &BlankSubstructure),
        run: &Run,
    ) -> Result<Arc<PlainGear>, PartError> {
        Ok(Arc::new(PlainGear::new(&teeth.ring, blank, run)?))
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

    /// Response of the gear of `spec` to its rotation.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn spun(&self, spec: &SpunSpec, run: &Run) -> Result<Arc<Spun>, PartError> {
        make_spun(spec, self, run).map(Arc::new)
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
    fn face_compliance(
        &self,
        spec: &FaceComplianceSpec,
        run: &Run,
    ) -> Result<Arc<FaceCompliance>, PartError> {
        let plain = self.plain_face(&spec.stack(), run)?;
        spec.make(plain, run).map(Arc::new)
    }

    /// Stresses at the roots of a solid gear, of which `spec` says all but the holes.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn face_roots(&self, spec: &Stack, run: &Run) -> Result<Arc<FaceRoots>, PartError> {
        let plain = self.plain_face(spec, run)?;
        FaceRoots::new(spec, &plain, run).map(Arc::new)
    }

    /// Stresses at the edges of the holes of a solid gear; `None` if it has none.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    fn face_holes(
        &self,
        spec: &FaceComplianceSpec,
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
    let specs_of_teeth: Vec<_> = wanted
        .iter()
        .map(|gear| (gear.member, gear.spec.teeth.clone()))
        .collect();
    let specs_of_plain: Vec<_> = wanted
        .iter()
        .filter_map(|gear| Some((gear.member, gear.spec.plain()?)))
        .collect();
    let of_plain = specs_of_plain.iter();
    let of_plain = of_plain.map(|(member, spec)| (*member, spec.blank.clone()));
    let holed = wanted
        .iter()
        .filter_map(|gear| Some((gear.member, gear.spec.holed()?.clone())));
    let specs_of_blanks: Vec<_> = of_plain.chain(holed).collect();
    // Neither needs the other. Teeth come first: they take longest.
    let (teeth, blanks) = rayon::join(
        || made(&specs_of_teeth, |spec| parts.teeth(spec, run)),
        || made(&specs_of_blanks, |spec| parts.blank(spec, run)),
    );
    let (teeth, blanks) = (teeth?, blanks?);
    let plain_gears = made(&specs_of_plain, |spec| {
        let teeth = found(&specs_of_teeth, &teeth, &spec.teeth);
        let blank = found(&specs_of_blanks, &blanks, &spec.blank);
        let teeth = teeth.map_or_else(|| parts.teeth(&spec.teeth, run), Ok)?;
        let blank = blank.map_or_else(|| parts.blank(&spec.blank, run), Ok)?;
        parts.plain_gear(spec, (&teeth, &blank), run)
    })?;
    (wanted, teeth)
        .into_par_iter()
        .with_max_len(1)
        .map(|(gear, teeth)| {
            let plain = gear.spec.plain();
            let plain = plain.and_then(|spec| found(&specs_of_plain, &plain_gears, &spec));
            let holed = gear.spec.holed();
            let holed = holed.and_then(|spec| found(&specs_of_blanks, &blanks, spec));
            let joined = gear
                .spec
                .join(&teeth, plain.as_deref(), holed.as_deref(), run);
            joined.map(Arc::new).map_err(|error| error.of(gear.member))
        })
        .collect()
}

/// The part of `spec` among the `parts` that were made for `wanted`.
fn found<S: PartialEq, P>(wanted: &[(Member, S)], parts: &[Arc<P>], spec: &S) -> Option<Arc<P>> {
    let place = wanted.iter().position(|(_, known)| known == spec);
    place.map(|place| Arc::clone(&parts[place]))
}

/// Makes the answer of a gear to its rotation from the parts of `parts`.
///
/// # Errors
///
/// [`PartError`].
pub fn make_spun<P: Parts + ?Sized>(
    spec: &SpunSpec,
    parts: &P,
    run: &Run,
) -> Result<Spun, PartError> {
    let teeth = parts.teeth(spec.teeth(), run)?;
    let plain = spec.plain();
    let blank = parts.blank(&plain.blank, run)?;
    let plain = parts.plain_gear(&plain, (&teeth, &blank), run)?;
    spec.make(&teeth, &plain, run)
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
