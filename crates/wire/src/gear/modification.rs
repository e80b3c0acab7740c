//! Profile modifications: material removed from the flanks beside the tip relief; several add up.

use meshwright_engine::gear::{ModificationData, TablePlaces};

use super::relief::{Relief, RootReliefDocument, TipReliefDocument};
use crate::declare::{List, Number, document, list, number, or_else, tagged};
use crate::problem::{Code, FieldError};
use crate::units::{Side, from_mm, from_um, plain, rounded_inward};

/// The most entries of a table.
pub(crate) const MOST_ENTRIES: usize = 1000;

/// The fewest entries of a table. Too few are told with the number that is needed.
const LEAST_ENTRIES: usize = 2;

/// The least step from entry to entry of a table, in modules: a shorter one is a step in the flank.
const LEAST_STEP: f64 = 1e-4;

tagged! {
    /// Material removed from every loaded flank, normal to it. Removed is positive.
    pub enum ModificationDocument as "ProfileModification", "Profile modification" {
        /// Grows from its start towards the tip circle.
        TipRelief(TipReliefDocument) = "tip_relief"
            as "TipReliefModification", "Tip relief modification",
        /// Grows from its start towards the form circle.
        RootRelief(RootReliefDocument) = "root_relief"
            as "RootReliefModification", "Root relief modification",
        /// A parabola in the roll length, nothing midway between form circle and tip circle.
        Crowning(CrowningDocument) = "crowning" as "CrowningModification", "Crowning modification",
        /// Linear in the roll length, nothing at the form circle.
        Slope(SlopeDocument) = "slope" as "SlopeModification", "Slope modification",
        /// Linear between entries, the first and the last held beyond them.
        Table(TableDocument) = "table" as "TableModification", "Table modification",
    }
}

document! {
    /// A parabola in the roll length.
    pub struct CrowningDocument as "Crowning", "Crowning" {
        /// The material taken off at the form circle and at the tip circle, normal to the flank; nothing is taken off midway between
        /// them. Negative adds.
        amount_um: f64 = number("Amount of profile crowning", "um", -1_000.0, 1_000.0),
    }
}

document! {
    /// In proportion to the roll length.
    pub struct SlopeDocument as "Slope", "Slope" {
        /// The material taken off at the tip circle, normal to the flank; nothing is taken off at the form circle. Negative adds.
        amount_um: f64 = number("Amount of the profile slope", "um", -1_000.0, 1_000.0),
    }
}

document! {
    /// Removed material at each place of the profile.
    pub struct TableDocument as "Table", "Table" {
        /// Where the entries of the table stand, each larger than the one before: roll lengths, from the base circle along the path of
        /// contact.
        roll_length_mm: Option<Vec<f64>> =
            or_else(&["diameter_mm"], entries("Roll lengths", number("", "mm", 0.0, 20_000.0))),
        /// Where the entries of the table stand, each larger than the one before: diameters, not below the base circle.
        diameter_mm: Option<Vec<f64>> =
            or_else(&["roll_length_mm"], entries("Diameters", number("", "mm", 0.1, 52_500.0))),
        /// The material taken off at each entry, normal to the flank; linear between entries, the first and the last held beyond them.
        /// Negative adds.
        removed_um: Vec<f64> = entries("Material removed", number("", "um", -1_000.0, 1_000.0)),
    }
}

/// Entries of a table, for each of which there is one in another list.
pub(super) const fn entries(title: &'static str, each: Number) -> List<Number> {
    list(title, each, MOST_ENTRIES)
}

impl ModificationDocument {
    /// The relief that it is, if it is one.
    pub(super) fn relief(&self) -> Option<Relief> {
        match self {
            Self::TipRelief(relief) => Some(relief.relief()),
            Self::RootRelief(relief) => Some(relief.relief()),
            _ => None,
        }
    }

    /// The table that it is, if it is one.
    pub(super) fn table(&self) -> Option<&TableDocument> {
        match self {
            Self::Table(table) => Some(table),
            _ => None,
        }
    }

    /// Takes nothing off, if it is a table.
    pub(super) fn empty_table(&mut self) {
        if self.table().is_some() {
            *self = Self::Slope(SlopeDocument { amount_um: 0.0 });
        }
    }

    /// The profile modification of the engine.
    pub(super) fn data(&self) -> ModificationData {
        match self {
            Self::TipRelief(relief) => relief.relief().data(),
            Self::RootRelief(relief) => relief.relief().data(),
            Self::Crowning(crowning) => ModificationData::Crowning {
                amount: from_um(crowning.amount_um),
            },
            Self::Slope(slope) => ModificationData::Slope {
                amount: from_um(slope.amount_um),
            },
            Self::Table(table) => table.data(),
        }
    }
}

impl TableDocument {
    /// The field that has the places of the entries, and its values.
    fn places(&self) -> (&'static str, &[f64]) {
        match (&self.roll_length_mm, &self.diameter_mm) {
            (_, Some(diameters)) => (Self::diameter_mm.name, diameters),
            (lengths, None) => (
                Self::roll_length_mm.name,
                lengths.as_deref().unwrap_or_default(),
            ),
        }
    }

    /// Faults on a gear of `module` over the base circle, both in mm, whose list stands at `pointer`.
    pub(super) fn faults(&self, pointer: &str, module: f64, base_radius: f64) -> Vec<FieldError> {
        let length = self.length_fault(pointer);
        let places = self.place_faults(pointer, LEAST_STEP * module, base_radius);
        length.into_iter().chain(places).collect()
    }

    fn length_fault(&self, pointer: &str) -> Option<FieldError> {
        let (name, places) = (self.places().0, self.places().1.len());
        let (at, given, needed) = if places < LEAST_ENTRIES {
            (name, places, LEAST_ENTRIES)
        } else if self.removed_um.len() != places {
            (Self::removed_um.name, self.removed_um.len(), places)
        } else {
            return None;
        };
        let each = if at == name {
            "a table has at least so many"
        } else {
            "one for each place"
        };
        let pointer = format!("{pointer}/{at}");
        let detail = format!("{pointer} has {given} numbers; {needed} are needed, {each}.");
        Some(FieldError::new(pointer, Code::WrongLength, detail).nearest(needed as f64))
    }

    /// The first diameter below the base circle, where there is no flank, and each entry that is not beyond the one before it. Each comes with a
    /// value such that all of them together make a table.
    fn place_faults(&self, pointer: &str, step: f64, base_radius: f64) -> Vec<FieldError> {
        const ROUNDING: f64 = 1e-9;
        let (name, places) = self.places();
        let mut faults = Vec::new();
        let mut floor = match self.diameter_mm {
            None => 0.0,
            Some(_) => 2.0 * base_radius,
        };
        for (i, &value) in places.iter().enumerate() {
            if value >= floor * (1.0 - ROUNDING) {
                floor = value + step;
                continue;
            }
            let nearest = rounded_inward(floor, Side::AtLeast, 0);
            let pointer = format!("{pointer}/{name}/{i}");
            let (code, what) = if i == 0 {
                (
                    Code::OutOfRange,
                    "below the base circle, where there is no flank",
                )
            } else {
                (
                    Code::TableDoesNotRise,
                    "not beyond the entry before it by 0.0001 modules",
                )
            };
            let detail = format!(
                "{pointer} is {} mm, {what}; at least {} mm.",
                plain(value),
                plain(nearest)
            );
            faults.push(FieldError::new(pointer, code, detail).nearest(nearest));
            floor = nearest + step;
        }
        faults
    }

    fn data(&self) -> ModificationData {
        let places = self.places().1.iter().copied().map(from_mm).collect();
        ModificationData::Table {
            places: match self.diameter_mm {
                None => TablePlaces::RollLengths(places),
                Some(_) => TablePlaces::Diameters(places),
            },
            removed: self.removed_um.iter().copied().map(from_um).collect(),
        }
    }
}
