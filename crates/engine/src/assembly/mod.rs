//! From the drawings of two gears to a pair that is ready for contact.
//!
//! In reading order: `interface` (the circle on which teeth and blank meet), `teeth` (all teeth of a gear down to it), `blank` (their support), `gear`
//! (both joined), `pair_spec` and `pair` (two gears and the rules of their contact); along faces `face_compliance` (the parts under the teeth, and the effect of
//! holes: `stack`, `holed`, in the real amplitudes of a circle: `amplitudes`; fit of polynomials: `flank_fit`), `face_roots` and `face_holes` (stresses at
//! its roots and at its holes), `face_inside` (motion of all of it); beside them `cut` (a gear parted at that circle again), `inside` (the inside of a
//! gear whose flanks are loaded) and `spun` (of one that rotates).
//!
//! Each part is a pure function of its *spec*, a value that says all that the part depends on. Equal specs are equal parts;
//! who makes them, and whether anyone keeps them, is asked of [`Parts`].

mod amplitudes;
pub(crate) mod blank;
pub(crate) mod cut;
mod error;
pub(crate) mod face_compliance;
pub(crate) mod face_holes;
pub(crate) mod face_inside;
mod face_resolution;
pub(crate) mod face_roots;
mod flank_fit;
mod flank_forces;
pub(crate) mod gear;
mod holed;
pub(crate) mod inside;
pub(crate) mod interface;
mod pair;
pub(crate) mod pair_spec;
mod parts;
mod probes;
pub(crate) mod spun;
mod stack;
pub(crate) mod teeth;

pub use blank::BlankSpec;
pub use cut::CutGear;
pub use error::{AssemblyError, PartError};
pub use face_compliance::{FaceCompliance, FaceComplianceSpec, PlainFace};
pub use face_holes::FaceHoles;
pub use face_inside::FaceInside;
pub use face_resolution::FaceResolution;
pub use face_roots::FaceRoots;
pub use flank_forces::FlankForces;
pub use gear::{BlankUnderTeeth, Gear, GearGrids, GearSpec, PlainGearSpec, WantedGear};
pub use inside::Inside;
pub use pair_spec::{Blanks, ContactsSpec, FaceContactsSpec, FlanksSpec, Modeling, PairSpec};
pub use parts::{MakeAll, Parts, make_gears, make_spun};
pub use probes::Probes;
pub use spun::{InnerLoad, Spun, SpunSpec};
pub use stack::{NearHoles, Stack};
pub use teeth::{Teeth, TeethSpec};
