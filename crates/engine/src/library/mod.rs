//! Parts that several cases share: made once, kept within a bound.
//!
//! A layer around the mechanics: [`Library`] is one of those who provide [`Parts`]. It changes no result, only how often a
//! part is made.

mod shelf;

use std::sync::Arc;

pub use shelf::ShelfUsage;

use crate::assembly::{
    AssemblyError, BlankSpec, ContactsSpec, FaceCompliance, FaceComplianceSpec, FaceContactsSpec,
    FaceHoles, FaceRoots, FlanksSpec, Gear, GearSpec, PairSpec, PartError, Parts, PlainFace,
    PlainGearSpec, Spun, SpunSpec, Stack, Teeth, TeethSpec, WantedGear, make_gears, make_spun,
};
use crate::contact::compliances::Compliances;
use crate::contact::drawn::DrawnFlanks;
use crate::contact::face::drawn::DrawnFaces;
use crate::contact::positions::{PositionsError, contacts};
use crate::contact::{MeshContact, PairModel};
use crate::ring::blank::BlankSubstructure;
use crate::ring::plain::PlainGear;
use crate::run::Run;
use shelf::Shelf;

/// A bounded store of parts, shared between threads; cloning shares it.
#[derive(Debug, Clone)]
pub struct Library(Arc<Shelves>);

#[derive(Debug)]
struct Shelves {
    teeth: Shelf<TeethSpec, Teeth>,
    blanks: Shelf<BlankSpec, BlankSubstructure>,
    plain: Shelf<PlainGearSpec, PlainGear>,
    gears: Shelf<GearSpec, Gear>,
    spun: Shelf<SpunSpec, Spun>,
    flanks: Shelf<FlanksSpec, DrawnFlanks>,
    drawn_faces: Shelf<FaceContactsSpec, DrawnFaces>,
    compliances: Shelf<PairSpec, Compliances>,
    contacts: Shelf<ContactsSpec, Vec<MeshContact>>,
    faces: Shelf<Stack, PlainFace>,
    yields: Shelf<FaceComplianceSpec, FaceCompliance>,
    roots: Shelf<Stack, FaceRoots>,
    holes: Shelf<FaceComplianceSpec, FaceHoles>,
}

impl Default for Library {
    /// A library of 256 MB.
    fn default() -> Self {
        Self::with_capacity(256 << 20)
    }
}

impl Library {
    /// A library that keeps at most `bytes` of parts, of each kind the least recently used leaving first.
    pub fn with_capacity(bytes: usize) -> Self {
        Self(Arc::new(Shelves {
            teeth: Shelf::new(bytes / 8, bytes_of_teeth),
            blanks: Shelf::new(bytes / 16, bytes_of_blank),
            plain: Shelf::new(bytes / 64, |_, plain| size_of::<f64>() * plain.entries()),
            gears: Shelf::new(bytes / 8, bytes_of_gear),
            spun: Shelf::new(bytes / 64, |_, spun| size_of::<f64>() * spun.entries()),
            flanks: Shelf::new(bytes / 8, |_, flanks| flanks.bytes()),
            drawn_faces: Shelf::new(3 * bytes / 32, |_, faces| faces.bytes()),
            compliances: Shelf::new(bytes / 8, |_, compliances| compliances.bytes()),
            contacts: Shelf::new(bytes / 16, |spec, contacts| {
                bytes_of_contacts(spec, contacts)
            }),
            faces: Shelf::new(bytes / 16, |_, face| size_of::<f64>() * face.entries()),
            yields: Shelf::new(bytes / 16, |_, face| size_of::<f64>() * face.entries()),
            roots: Shelf::new(bytes / 16, |_, roots| size_of::<f64>() * roots.entries()),
            holes: Shelf::new(bytes / 16, |_, holes| size_of::<f64>() * holes.entries()),
        }))
    }

    /// Use of each of its shelves, by name.
    pub fn usage(&self) -> [(&'static str, ShelfUsage); 13] {
        let Shelves {
            teeth,
            blanks,
            plain,
            gears,
            spun,
            flanks,
            drawn_faces,
            compliances,
            contacts,
            faces,
            yields,
            roots,
            holes,
        } = &*self.0;
        [
            ("teeth", teeth.usage()),
            ("blanks", blanks.usage()),
            ("plain_gears", plain.usage()),
            ("gears", gears.usage()),
            ("spun", spun.usage()),
            ("flanks", flanks.usage()),
            ("drawn_faces", drawn_faces.usage()),
            ("compliances", compliances.usage()),
            ("contacts", contacts.usage()),
            ("faces", faces.usage()),
            ("yields", yields.usage()),
            ("roots", roots.usage()),
            ("holes", holes.usage()),
        ]
    }
}

impl Parts for Library {
    fn teeth(&self, spec: &TeethSpec, run: &Run) -> Result<Arc<Teeth>, PartError> {
        run.check()?;
        self.0.teeth.made_once(spec, || spec.make(run))
    }

    fn blank(&self, spec: &BlankSpec, run: &Run) -> Result<Arc<BlankSubstructure>, PartError> {
        run.check()?;
        self.0.blanks.made_once(spec, || spec.make(run))
    }

    // Gears are joined, and contacts solved, by many threads together. Who waited for that might be the one that is waited
    // for, so that two who want the same at the same moment both make it, and get the same bits.

    fn gears(&self, wanted: &[WantedGear], run: &Run) -> Result<Vec<Arc<Gear>>, AssemblyError> {
        let shelf = &self.0.gears;
        let known: Vec<Option<Arc<Gear>>> =
            wanted.iter().map(|gear| shelf.find(&gear.spec)).collect();
        let unknown: Vec<WantedGear> = wanted
            .iter()
            .zip(&known)
            .filter(|(_, known)| known.is_none())
            .map(|(gear, _)| gear.clone())
            .collect();
        let mut made = make_gears(&unknown, self, run)?.into_iter();
        for (gear, part) in unknown.iter().zip(made.as_slice()) {
            shelf.keep(&gear.spec, part);
        }
        Ok(known
            .into_iter()
            .filter_map(|known| known.or_else(|| made.next()))
            .collect())
    }

    fn plain_gear(
        &self,
        spec: &PlainGearSpec,
        (teeth, blank): (&Teeth, &BlankSubstructure),
        run: &Run,
    ) -> Result<Arc<PlainGear>, PartError> {
        let make = || Ok(PlainGear::new(&teeth.ring, blank, run)?);
        self.0.plain.made_once(spec, make)
    }

    fn spun(&self, spec: &SpunSpec, run: &Run) -> Result<Arc<Spun>, PartError> {
        self.0.spun.made(spec, || make_spun(spec, self, run))
    }

    fn plain_face(&self, spec: &Stack, run: &Run) -> Result<Arc<PlainFace>, PartError> {
        self.0.faces.made(spec, || PlainFace::new(spec, run))
    }

    fn face_compliance(
        &self,
        spec: &FaceComplianceSpec,
        run: &Run,
    ) -> Result<Arc<FaceCompliance>, PartError> {
        self.0.yields.made(spec, || {
            spec.make(self.plain_face(&spec.stack(), run)?, run)
        })
    }

    fn face_roots(&self, spec: &Stack, run: &Run) -> Result<Arc<FaceRoots>, PartError> {
        self.0.roots.made(spec, || {
            FaceRoots::new(spec, &*self.plain_face(spec, run)?, run)
        })
    }

    fn face_holes(
        &self,
        spec: &FaceComplianceSpec,
        run: &Run,
    ) -> Result<Option<Arc<FaceHoles>>, PartError> {
        let made = spec.hole_orders().map(|orders| {
            let shelf = &self.0.holes;
            shelf.made(spec, || FaceHoles::new(spec, orders, run))
        });
        made.transpose()
    }

    fn flanks(&self, spec: &FlanksSpec) -> Arc<DrawnFlanks> {
        let shelf = &self.0.flanks;
        let flanks = shelf.find(spec).unwrap_or_default();
        shelf.keep_growing(spec, &flanks);
        flanks
    }

    fn drawn_faces(&self, spec: &FaceContactsSpec) -> Arc<DrawnFaces> {
        let shelf = &self.0.drawn_faces;
        let faces = shelf.find(spec).unwrap_or_default();
        shelf.keep_growing(spec, &faces);
        faces
    }

    fn compliances(&self, spec: &PairSpec) -> Arc<Compliances> {
        let shelf = &self.0.compliances;
        let compliances = shelf.find(spec).unwrap_or_default();
        shelf.keep_growing(spec, &compliances);
        compliances
    }

    fn contacts(
        &self,
        spec: &ContactsSpec,
        model: &PairModel,
        run: &Run,
    ) -> Result<Arc<Vec<MeshContact>>, PositionsError> {
        let shelf = &self.0.contacts;
        if let Some(known) = shelf.find(spec) {
            run.reached(spec.positions.len() as u64)?;
            return Ok(known);
        }
        let made = Arc::new(contacts(
            model.deviating(&spec.deviations),
            spec.load,
            &spec.positions,
            run,
        )?);
        shelf.keep(spec, &made);
        Ok(made)
    }
}

fn bytes_of_teeth(_: &TeethSpec, teeth: &Teeth) -> usize {
    let ring = &teeth.ring;
    let (n, r) = (ring.harmonics.unknowns(), teeth.flank.mode_count());
    let couplings = 2 * teeth.on_rigid_blank.entries();
    let patterns = (n + r) * ring.force_patterns.ncols();
    size_of::<f64>() * (n * n + patterns + couplings + teeth.flank.entries())
}

fn bytes_of_blank(_: &BlankSpec, blank: &BlankSubstructure) -> usize {
    size_of::<f64>() * blank.harmonics.unknowns().pow(2)
}

/// A gear keeps its flank and its coupling even where the teeth have gone.
fn bytes_of_gear(_: &GearSpec, gear: &Gear) -> usize {
    size_of::<f64>() * (gear.model.coupling.entries() + gear.model.flank.entries())
}

fn bytes_of_contacts(spec: &ContactsSpec, contacts: &[MeshContact]) -> usize {
    let positions = size_of::<ContactsSpec>() + size_of_val(spec.positions.as_slice());
    positions + contacts.iter().map(MeshContact::bytes).sum::<usize>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::{FaceResolution, MakeAll};
    use crate::contact::face::NormalForce;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{Helix, HolePattern, SolidGear, Web};

    fn holed(radius: f64) -> SolidGear {
        let mut data = paper_gear(24);
        data.blank.bore_radius = 6e-3;
        data.blank.web = Some(Web {
            inner_radius: 6e-3,
            outer_radius: 18e-3,
            thickness: 6e-3,
        });
        data.blank.holes = HolePattern {
            count: 4,
            circle_radius: 13e-3,
            radius,
            phase: 0.2,
        }
        .holes();
        SolidGear::new(data, Helix::right(0.3), 0.0, None).expect("can be made")
    }

    #[test]
    #[ignore = "./test all"]
    fn another_hole_in_a_web_makes_no_tooth_anew_and_the_same_bits() {
        let (library, run) = (Library::default(), Run::unattended());
        let resolution = FaceResolution {
            face_order: 4,
            web_order: 2,
            web_harmonics: 6,
            sections: crate::grid::GridLevel::Standard,
        };
        let made_by = |parts: &dyn Parts, radius: f64| {
            let spec = FaceComplianceSpec::new(&holed(radius), resolution);
            let yields = parts.face_compliance(&spec, &run).expect("definite");
            let roots = parts.face_roots(&spec.stack(), &run).expect("definite");
            let holes = parts.face_holes(&spec, &run).expect("definite");
            let holes = holes.expect("it has holes");
            let loads = [roots.forces(
                3,
                [NormalForce {
                    roll_length: 9e-3,
                    z: 2e-3,
                    force: 100.0,
                }],
            )];
            let of_roots = roots.under(Some(&yields), &loads).stresses(4);
            let of_holes = holes.under(&yields, &loads).stresses();
            (yields.smooth(&[0, 1, 23]), of_roots, of_holes)
        };
        let radii = [3e-3, 3.02e-3];
        let alone = radii.map(|radius| made_by(&MakeAll, radius));
        for i in [0, 1, 0] {
            assert_eq!(made_by(&library, radii[i]), alone[i]);
        }
        let uses = library.usage();
        let used = |name| {
            let shelf = uses.iter().find(|(shelf, _)| *shelf == name);
            shelf.map(|(_, usage)| (usage.misses, usage.hits))
        };
        assert_eq!(used("faces"), Some((1, 2)));
        assert_eq!(used("yields"), Some((2, 1)));
        assert_eq!(used("roots"), Some((1, 2)));
        assert_eq!(used("holes"), Some((2, 1)));
    }
}
