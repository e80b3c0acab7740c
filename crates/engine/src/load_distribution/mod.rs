//! The classical route: contact on the theoretical line of contact, compliances from formulas (eqs. 4-5 of the
//! paper).
//!
//! A loaded pair of teeth gives way in three places, and for each there is a closed form. Forces act along the line
//! of action, so compliances (m/N) add up in series over the two gears:
//!
//! | part | formula | file |
//! | --- | --- | --- |
//! | the tooth, a cantilever of varying section | Weber and Banaschek's integral over the true profile | `weber_banaschek` |
//! | the body under the tooth, as a ring on a rigid bore | Sainsot, Velex and Duverger | `sainsot` |
//! | the body under the tooth, as a half plane | Weber and Banaschek | `half_plane` |
//! | the flanks at the contact | Hertz, and Weber's approach of points at a depth | `approach` |
//! | all of it at once, per pair of teeth | ISO 6336-1, method B, single stiffness | `iso6336` |
//!
//! Reading order: `tooth_load` and `profile` (where the load line meets the tooth, and how thick it is), then the table from
//! top to bottom, `compliance` (which pairs touch, and their formulas), `sharing` (how they share the load) and `range`
//! (where formulas are used outside the range for which they were published: computed, and flagged).
//!
//! Where the face widths differ, each tooth and body yields by its own width, and the flanks touch on the common one; ISO's
//! stiffness is that of the common width.
//!
//! The formulas use the drawings of the gears and Hertz alone; `analysis::load_distribution` makes curves of them.
//!
//! Limits of this method: holes (a body is a ring or a half plane), and the body that neighboring pairs share - each pair has a body of its own, so that the
//! deflection of one tooth does not tilt the next. ISO's single stiffness depends neither on position nor on bore nor on load.

mod approach;
mod compliance;
mod half_plane;
mod iso6336;
mod profile;
mod range;
mod sainsot;
mod sharing;
mod tooth_load;
mod weber_banaschek;

pub use compliance::PairFormulas;
pub use range::{Formula, FormulaQuantity, FormulaRange};
pub use sharing::{LinePair, Shared, rise, share, touch};

use crate::gear::{GearPair, Member, PlaneState};
use sainsot::Ring;

/// The tooth compliance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ToothFormula {
    /// Bending, shear and compression of the true profile (Weber and Banaschek).
    WeberBanaschek,
    /// The theoretical single stiffness of ISO 6336-1, which contains body and local deformation.
    Iso6336,
}

/// The gear-body compliance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BodyFormula {
    /// Sainsot, Velex and Duverger (2004).
    Sainsot,
    /// The half plane of Weber and Banaschek.
    HalfPlane,
    /// No body compliance.
    Rigid,
}

/// The formulas that are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Formulas {
    /// The tooth's compliance.
    pub tooth: ToothFormula,
    /// The body's compliance.
    pub body: BodyFormula,
    /// The plane state of tooth, half plane and local deformation.
    pub plane_state: PlaneState,
}

/// Why the formulas say nothing of a position.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FormulaError {
    /// No pair of teeth is on the path of contact.
    #[error("no pair of teeth is on the path of contact at mesh position {mesh_position}")]
    NoContact {
        /// The mesh position η.
        mesh_position: f64,
    },
    /// A formula, far outside the range for which it was published, gives a pair of teeth no compliance.
    #[error("{formula} gives a pair of teeth the compliance {compliance} m/N")]
    NoCompliance {
        /// The formula.
        formula: Formula,
        /// The gear whose part it is; `None` for the pair.
        member: Option<Member>,
        /// Compliance in m/N: not positive, or not a number.
        compliance: f64,
    },
}

/// Values of `pair`, the least of whose output torques is `least_torque`, outside the ranges of `formulas`.
pub fn out_of_range(pair: &GearPair, formulas: Formulas, least_torque: f64) -> Vec<FormulaRange> {
    match (formulas.tooth, formulas.body) {
        (ToothFormula::Iso6336, _) => iso6336::out_of_range(pair, least_torque),
        (ToothFormula::WeberBanaschek, BodyFormula::Sainsot) => Member::BOTH
            .into_iter()
            .flat_map(|member| Ring::of(pair.gear(member)).out_of_range(member))
            .collect(),
        (ToothFormula::WeberBanaschek, BodyFormula::HalfPlane | BodyFormula::Rigid) => Vec::new(),
    }
}
