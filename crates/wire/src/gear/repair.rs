//! The values that together would make a gear, where a submission's do not.

use meshwright_engine::gear::{Helix, SpurGear};

use super::GearDocument;
use super::faults::Fault;
use crate::problem::FieldError;
use crate::units::{Side, plain, rounded_inward};

impl GearDocument {
    /// The gear, or its transverse section, if it can be made.
    ///
    /// # Errors
    ///
    /// Every field that has to change, each with a value such that all these values together make a gear, where there
    /// are such values.
    pub fn to_gear(&self, pointer: &str, helix: Helix) -> Result<SpurGear, Vec<FieldError>> {
        let lists = self.list_faults(pointer);
        if lists.is_empty() {
            return self.with_numbers(pointer, helix);
        }
        // Other faults are reported together with those of the lists.
        let others = self.without_lists().with_numbers(pointer, helix).err();
        let others = others.into_iter().flatten();
        Err(lists.into_iter().chain(others).collect())
    }

    fn with_numbers(&self, pointer: &str, helix: Helix) -> Result<SpurGear, Vec<FieldError>> {
        const MOST_REPAIRS: usize = 12;
        let mut repaired = self.clone();
        let mut faults: Vec<Fault> = Vec::new();
        for _ in 0..MOST_REPAIRS {
            let mut fault = match repaired.made(helix) {
                Ok(gear) if faults.is_empty() => return Ok(gear),
                Ok(_) => return Err(Self::field_errors(pointer, faults)),
                Err(fault) => fault,
            };
            let index = faults
                .iter()
                .position(|known| known.field.pointer == fault.field.pointer);
            let steps = index.map_or(0, |index| faults[index].steps_after(&fault));
            let cure = fault
                .bound
                .map(|(bound, side)| rounded_inward(bound, side, steps));
            let cure = cure.filter(|&value| fault.field.accepts(value));
            match index {
                Some(index) => {
                    let known = &mut faults[index];
                    (known.cure, known.bound, known.steps) = (cure, fault.bound, steps);
                }
                None => {
                    fault.cure = cure;
                    faults.push(fault.clone());
                }
            }
            match cure.and_then(|value| repaired.with_value(&fault.field, value)) {
                Some(gear) => repaired = gear,
                None => break,
            }
        }
        // No set of values was found that works together, so none is promised for the last of them.
        if let Some(last) = faults.last_mut() {
            last.cure = None;
        }
        Err(Self::field_errors(pointer, faults))
    }

    /// `fault` with the nearest value that its field takes.
    pub(super) fn cured(fault: Fault) -> Fault {
        let bound = fault
            .bound
            .map(|(bound, side)| rounded_inward(bound, side, 0));
        let cure = bound.filter(|value| fault.field.accepts(*value));
        Fault { cure, ..fault }
    }

    pub(super) fn field_errors(pointer: &str, faults: Vec<Fault>) -> Vec<FieldError> {
        let errors = faults.into_iter().map(|fault| {
            let unit = fault.field.unit;
            let advice = fault.cure.map(|cure| {
                let cure = spoken(cure, unit);
                match fault.bound {
                    Some((_, Side::AtMost)) => format!(" The largest is {cure}."),
                    Some((_, Side::AtLeast)) => format!(" The least is {cure}."),
                    None => format!(" {cure} would do."),
                }
            });
            let detail = fault.detail + &advice.unwrap_or_default();
            let place = format!("{pointer}/{}", fault.field.pointer);
            FieldError::new(place, fault.code, detail).nearest(fault.cure)
        });
        errors.collect()
    }
}

/// A value with its unit, as a sentence begins with it.
fn spoken(value: f64, unit: &str) -> String {
    match unit {
        "1" => plain(value),
        unit => format!("{} {unit}", plain(value)),
    }
}
