//! Lead modifications: material removed from the loaded flanks along the face; several add up.

use meshwright_engine::gear::{FaceEnds, LeadError, LeadModification};

use crate::declare::{document, number, tagged, word, words};
use crate::problem::{Code, FieldError};
use crate::units::{Side, from_mm, from_um, plain, rounded_inward, to_mm};

use super::modification::entries;

words! {
    FaceEnds {
        Both = "both": "both ends of the face",
        Minus = "minus": "the end at -z",
        Plus = "plus":
            "the end at +z, from which the driving gear is seen to turn counter-clockwise",
    }
}

tagged! {
    /// Material removed from every loaded flank along the face, the same at each diameter: in the transverse section, along the base tangent. Removed is
    /// positive.
    pub enum LeadModificationDocument as "LeadModification", "Lead modification" {
        /// A parabola, nothing in the middle of the face.
        Crowning(LeadCrowningDocument) = "crowning"
            as "LeadCrowningModification", "Lead crowning modification",
        /// Linear along the face, nothing at the end at -z.
        Slope(LeadSlopeDocument) = "slope" as "LeadSlopeModification", "Lead slope modification",
        /// Linear from where it begins to an end of the face.
        EndRelief(EndReliefDocument) = "end_relief"
            as "EndReliefModification", "End relief modification",
        /// Linear between entries, the first and the last held beyond them.
        Table(LeadTableDocument) = "table" as "LeadTableModification", "Lead table modification",
    }
}

document! {
    /// A parabola along the face.
    pub struct LeadCrowningDocument as "LeadCrowning", "Lead crowning" {
        /// The material taken off at both ends of the face; nothing is taken off in its middle. Negative adds.
        amount_um: f64 = number("Amount of lead crowning", "um", -1_000.0, 1_000.0),
    }
}

document! {
    /// In proportion to the way along the face.
    pub struct LeadSlopeDocument as "LeadSlope", "Lead slope" {
        /// The material taken off at the end of the face at +z; nothing is taken off at the end at -z. Negative adds.
        amount_um: f64 = number("Amount of the lead slope", "um", -1_000.0, 1_000.0),
    }
}

document! {
    /// From a line across the flank to an end of the face.
    pub struct EndReliefDocument as "EndRelief", "End relief" {
        /// The material taken off at the end of the face.
        amount_um: f64 = number("Amount of the end relief", "um", 0.0, 1_000.0),
        /// How far from the end it begins: the face width at the most, or half of it where both ends are relieved.
        pub(super) length_mm: f64 = number("Length of the end relief", "mm", 0.001, 2_000.0),
        /// The ends that have it.
        side: FaceEnds = word("Side of the end relief").or(FaceEnds::Both),
    }
}

document! {
    /// Removed material at each place along the face.
    pub struct LeadTableDocument as "LeadTable", "Lead table" {
        /// Where the entries stand, from the middle of the gear's own face, each larger than the one before.
        z_mm: Vec<f64> = entries("Heights", number("", "mm", -1_000.0, 1_000.0)),
        /// The material taken off at each entry; linear between entries, the first and the last held beyond them. Negative adds.
        removed_um: Vec<f64> = entries("Material removed", number("", "um", -1_000.0, 1_000.0)),
    }
}

impl LeadModificationDocument {
    /// The lead modification of the engine.
    pub(crate) fn data(&self) -> LeadModification {
        match self {
            Self::Crowning(crowning) => LeadModification::Crowning {
                amount: from_um(crowning.amount_um),
            },
            Self::Slope(slope) => LeadModification::Slope {
                amount: from_um(slope.amount_um),
            },
            Self::EndRelief(relief) => LeadModification::EndRelief {
                amount: from_um(relief.amount_um),
                length: from_mm(relief.length_mm),
                ends: relief.side,
            },
            Self::Table(table) => LeadModification::Table {
                places: table.z_mm.iter().copied().map(from_mm).collect(),
                removed: table.removed_um.iter().copied().map(from_um).collect(),
            },
        }
    }

    /// Fault of one in the list at `pointer`, from the engine's error.
    pub(crate) fn fault(pointer: &str, error: &LeadError) -> FieldError {
        match *error {
            LeadError::EndReliefTooLong {
                modification,
                length,
                largest,
            } => {
                let pointer = format!(
                    "{pointer}/{modification}/{}",
                    EndReliefDocument::length_mm.name
                );
                let nearest = rounded_inward(to_mm(largest), Side::AtMost, 0);
                let detail = format!(
                    "{pointer} is {} mm; on this face it can be at most {} mm.",
                    plain(to_mm(length)),
                    plain(nearest)
                );
                FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest)
            }
            LeadError::TableDoesNotRise {
                modification,
                entry,
            } => {
                let pointer = format!("{pointer}/{modification}/{}", LeadTableDocument::z_mm.name);
                let detail = format!(
                    "{pointer}: entry {entry} is missing, has no value beside it, or does not stand beyond the one before it; a table has at least two entries, and a value for each."
                );
                FieldError::new(pointer, Code::TableDoesNotRise, detail)
            }
        }
    }
}
