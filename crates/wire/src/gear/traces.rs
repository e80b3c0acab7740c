//! Measured traces of single flanks: what each profile and each lead has beside the modifications of its gear.

use meshwright_engine::gear::{TablePlaces, ToothLeads, ToothProfiles};

use super::GearDocument;
use super::modification::{LEAST_ENTRIES, LEAST_STEP, entries, place_faults};
use crate::declare::{List, Number, document, list, number, or_else};
use crate::problem::{Code, FieldError};
use crate::units::{from_mm, from_um, plain};

/// The most that a flank deviates, in modules: a search among neighboring flanks means nothing beyond.
pub(super) const LARGEST: f64 = 0.25;

/// That the deviation at `pointer` is more than [`LARGEST`] allows, both in um.
pub(super) fn too_large(pointer: String, value: f64, most: f64) -> FieldError {
    let detail = format!(
        "{pointer} is {} um, more than a quarter of a module; at most {} um.",
        plain(value),
        plain(most)
    );
    let error = FieldError::new(pointer, Code::OutOfRange, detail);
    error.nearest(most.copysign(value))
}

document! {
    /// A measured trace of the profile of each loaded flank. It adds to the modifications of the gear.
    pub struct ProfileTracesDocument as "ProfileTraces", "Profile traces" {
        /// Where the entries of all traces stand, each larger than the one before: roll lengths, from the base circle along the path of contact.
        roll_length_mm: Option<Vec<f64>> =
            or_else(&["diameter_mm"], entries("Roll lengths", number("", "mm", 0.0, 20_000.0))),
        /// Where the entries of all traces stand, each larger than the one before: diameters, not below the base circle.
        diameter_mm: Option<Vec<f64>> =
            or_else(&["roll_length_mm"], entries("Diameters", number("", "mm", 0.1, 52_500.0))),
        /// One row a tooth, tooth 0 first: the material taken off its loaded flank at each entry, normal to the flank; linear between entries, the first and the
        /// last held beyond them. Negative adds.
        removed_um: Vec<Vec<f64>> = ROWS,
    }
}

document! {
    /// A measured trace of the lead of each loaded flank. It adds to the lead modifications of the gear.
    pub struct LeadTracesDocument as "LeadTraces", "Lead traces" {
        /// Where the entries of all traces stand, from the middle of the gear's own face, each larger than the one before.
        z_mm: Vec<f64> = entries("Heights", number("", "mm", -1_000.0, 1_000.0)),
        /// One row a tooth, tooth 0 first: the material taken off its loaded flank at each entry; linear between entries, the first and the last held beyond
        /// them. Negative adds.
        removed_um: Vec<Vec<f64>> = ROWS,
    }
}

/// A row of entries for each tooth. How many are needed depends on the gear and on the places, which say so.
const ROWS: List<List<Number>> = list(
    "Material removed",
    entries("Trace of a tooth", number("", "um", -1_000.0, 1_000.0)),
    GearDocument::tooth_count.spec.bounds.1 as usize,
);

/// What traces have in common.
struct Traces<'a> {
    /// The field of the places, and what stands there.
    places: (&'static str, &'a [f64]),
    /// The field of the rows, and what stands there.
    rows: (&'static str, &'a [Vec<f64>]),
}

impl ProfileTracesDocument {
    fn traces(&self) -> Traces<'_> {
        let places = match (&self.roll_length_mm, &self.diameter_mm) {
            (_, Some(diameters)) => (Self::diameter_mm.name, diameters.as_slice()),
            (lengths, None) => (
                Self::roll_length_mm.name,
                lengths.as_deref().unwrap_or_default(),
            ),
        };
        Traces {
            places,
            rows: (Self::removed_um.name, &self.removed_um),
        }
    }

    /// What is wrong with it at `pointer` on a gear of so many teeth and of `module` over the base circle, both in mm.
    pub(super) fn faults(
        &self,
        pointer: &str,
        (tooth_count, module): (u32, f64),
        base_radius: f64,
    ) -> Vec<FieldError> {
        let floor = match self.diameter_mm {
            None => 0.0,
            Some(_) => 2.0 * base_radius,
        };
        let traces = self.traces();
        let mut faults = traces.faults(pointer, tooth_count, module);
        faults.extend(place_faults(
            pointer,
            traces.places,
            LEAST_STEP * module,
            floor,
        ));
        faults
    }

    /// What the engine is told.
    pub(super) fn data(&self) -> ToothProfiles {
        let traces = self.traces();
        let places = traces.places.1.iter().copied().map(from_mm).collect();
        ToothProfiles {
            places: match self.diameter_mm {
                None => TablePlaces::RollLengths(places),
                Some(_) => TablePlaces::Diameters(places),
            },
            removed: traces.removed(),
        }
    }
}

impl LeadTracesDocument {
    fn traces(&self) -> Traces<'_> {
        Traces {
            places: (Self::z_mm.name, &self.z_mm),
            rows: (Self::removed_um.name, &self.removed_um),
        }
    }

    /// Whether any flank has something taken off.
    pub(super) fn deviates(&self) -> bool {
        self.removed_um
            .iter()
            .flatten()
            .any(|removed| *removed != 0.0)
    }

    /// What is wrong with it at `pointer` on a gear of so many teeth and of `module` mm.
    pub(super) fn faults(&self, pointer: &str, tooth_count: u32, module: f64) -> Vec<FieldError> {
        let traces = self.traces();
        let mut faults = traces.faults(pointer, tooth_count, module);
        let (name, places) = traces.places;
        let step = LEAST_STEP * module;
        let falls = places.windows(2).position(|two| two[1] < two[0] + step);
        faults.extend(falls.map(|before| {
            let pointer = format!("{pointer}/{name}/{}", before + 1);
            let least = places[before] + step;
            let detail = format!(
                "{pointer} is {} mm, not beyond the entry before it by 0.0001 modules; at least {} mm.",
                plain(places[before + 1]),
                plain(least)
            );
            FieldError::new(pointer, Code::TableDoesNotRise, detail).nearest(least)
        }));
        faults
    }

    /// What the engine is told.
    pub(super) fn data(&self) -> ToothLeads {
        ToothLeads {
            heights: self.z_mm.iter().copied().map(from_mm).collect(),
            removed: self.traces().removed(),
        }
    }
}

impl Traces<'_> {
    fn removed(&self) -> Vec<Vec<f64>> {
        let rows = self.rows.1.iter();
        rows.map(|row| row.iter().copied().map(from_um).collect())
            .collect()
    }

    /// Too few places, another number of rows than teeth, a row of another length than the places, and what is beyond a quarter of a module.
    fn faults(&self, pointer: &str, tooth_count: u32, module: f64) -> Vec<FieldError> {
        let ((at, places), (name, rows)) = (self.places, self.rows);
        let wrong_length = |pointer: String, given: usize, needed: usize, what: &str| {
            let detail = format!("{pointer} has {given} {what}");
            vec![FieldError::new(pointer, Code::WrongLength, detail).nearest(needed as f64)]
        };
        if places.len() < LEAST_ENTRIES {
            let what = format!("entries; a trace has at least {LEAST_ENTRIES}.");
            let pointer = format!("{pointer}/{at}");
            return wrong_length(pointer, places.len(), LEAST_ENTRIES, &what);
        }
        if rows.len() != tooth_count as usize {
            let what = format!("rows; {tooth_count} are needed, one for each tooth.");
            let pointer = format!("{pointer}/{name}");
            return wrong_length(pointer, rows.len(), tooth_count as usize, &what);
        }
        if let Some(i) = rows.iter().position(|row| row.len() != places.len()) {
            let needed = places.len();
            let what = format!("numbers; {needed} are needed, one for each entry of {at}.");
            return wrong_length(
                format!("{pointer}/{name}/{i}"),
                rows[i].len(),
                needed,
                &what,
            );
        }
        let most = 1e3 * LARGEST * module;
        let each = rows.iter().enumerate().flat_map(|(i, row)| {
            let row = row.iter().enumerate();
            row.map(move |(j, value)| ((i, j), *value))
        });
        let large = each.into_iter().find(|(_, value)| value.abs() > most);
        let large = large
            .map(|((i, j), value)| too_large(format!("{pointer}/{name}/{i}/{j}"), value, most));
        large.into_iter().collect()
    }
}
