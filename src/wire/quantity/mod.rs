//! Numbers of the submission: one table of titles, units, defaults and bounds, used by the check and by the schema.

mod blank;
mod flank;
mod gear;
mod load;

pub(super) use blank::*;
pub(super) use flank::*;
pub(super) use gear::*;
pub(super) use load::*;

use super::problem::Code;
use super::units::{plain, significant};

/// What stands for a number that is not given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Preset {
    /// Nothing: it has to be given.
    Needed,
    /// This value.
    Value(f64),
    /// So many times the module.
    Modules(f64),
    /// So many times the module, unless this other field stands in its place.
    ModulesUnless(f64, &'static str),
    /// Nothing, and that means something.
    Absent(&'static str),
}

/// A number of the submission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quantity {
    /// The field.
    pub(super) name: &'static str,
    /// Its title in a form.
    pub(super) title: &'static str,
    /// Its unit; "1" for a pure number.
    pub(super) unit: &'static str,
    /// What it is.
    pub(super) description: &'static str,
    /// The smallest and the largest value that are accepted, in its unit.
    pub(super) bounds: (f64, f64),
    /// Its default.
    pub(super) preset: Preset,
    /// Whether it counts.
    pub(super) whole: bool,
    /// Whether zero is accepted too where the bounds do not hold it.
    pub(super) or_zero: bool,
}

impl Quantity {
    /// Checks `value`, which stands at `place`.
    ///
    /// # Errors
    ///
    /// The code, a sentence with the numbers, and the nearest value that is accepted.
    pub(super) fn check(
        &self,
        value: f64,
        place: &str,
    ) -> Result<f64, (Code, String, Option<f64>)> {
        let (least, most) = self.bounds;
        let is_zero = self.or_zero && value == 0.0;
        if !is_zero && !(least..=most).contains(&value) {
            let code = if self.name == OUTPUT_TORQUE.name && value < 0.0 {
                Code::TorqueNotPositive
            } else {
                Code::OutOfRange
            };
            let detail = format!(
                "{place} is {}{unit}; it has to {}lie between {}{unit} and {}{unit}.",
                plain(value),
                if self.or_zero { "be 0 or " } else { "" },
                plain(least),
                plain(most),
                unit = self.spoken_unit()
            );
            return Err((code, detail, Some(self.nearest(value))));
        }
        if self.whole && value.fract() != 0.0 {
            let detail = format!("{place} is {}; a whole number is expected.", plain(value));
            return Err((Code::WrongType, detail, Some(value.round())));
        }
        // A negative zero is as good as zero, and is echoed as it.
        Ok(value + 0.0)
    }

    /// What stands for it where it is not given, for gears of `module`; `None` where nothing does.
    pub(super) fn preset_for(&self, module: Option<f64>) -> Option<f64> {
        match self.preset {
            Preset::Value(value) => Some(value),
            Preset::Modules(modules) | Preset::ModulesUnless(modules, _) => {
                module.map(|module| significant(modules * module, 12))
            }
            Preset::Needed | Preset::Absent(_) => None,
        }
    }

    /// The accepted value nearest to one that is not.
    fn nearest(&self, value: f64) -> f64 {
        let (least, most) = self.bounds;
        if self.or_zero && value < least / 2.0 {
            0.0
        } else {
            value.clamp(least, most)
        }
    }

    fn spoken_unit(&self) -> String {
        match self.unit {
            "1" => String::new(),
            unit => format!(" {unit}"),
        }
    }
}

const fn needed(
    name: &'static str,
    title: &'static str,
    unit: &'static str,
    bounds: (f64, f64),
    description: &'static str,
) -> Quantity {
    Quantity {
        name,
        title,
        unit,
        description,
        bounds,
        preset: Preset::Needed,
        whole: false,
        or_zero: false,
    }
}

impl Quantity {
    const fn or(self, preset: Preset) -> Self {
        Self { preset, ..self }
    }

    const fn counted(self) -> Self {
        Self {
            whole: true,
            ..self
        }
    }

    const fn or_zero(self) -> Self {
        Self {
            or_zero: true,
            ..self
        }
    }
}

/// The most output torques of one submission.
pub(super) const MOST_TORQUES: usize = 60;
/// The most positions times torques of one submission.
pub(super) const MOST_POSITIONS: u64 = 20_000;
/// The most profile modifications of one gear, beside its tip relief.
pub(super) const MOST_MODIFICATIONS: usize = 16;
/// The most entries of a profile table.
pub(super) const MOST_TABLE_ENTRIES: usize = 1000;
/// The most patterns of holes in one blank.
pub(super) const MOST_PATTERNS: usize = 12;
/// The most holes in one blank.
pub(super) const MOST_HOLES: usize = HOLE_COUNT.bounds.1 as usize;
/// The most tags, and the most characters of one.
pub(super) const MOST_TAGS: (usize, usize) = (16, 64);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_outside_its_bounds_is_answered_with_the_nearer_bound() {
        let (code, detail, nearest) = TOOTH_COUNT.check(-3.0, "/z").expect_err("negative");
        assert_eq!((code, nearest), (Code::OutOfRange, Some(5.0)));
        assert!(detail.contains("-3"), "{detail}");
        let (_, detail, nearest) = MODULE.check(1e308, "/m").expect_err("enormous");
        assert_eq!(nearest, Some(50.0));
        assert!(detail.contains("1e308 mm"), "{detail}");
        let (code, _, nearest) = TOOTH_COUNT.check(30.4, "/z").expect_err("a fraction");
        assert_eq!((code, nearest), (Code::WrongType, Some(30.0)));
    }

    #[test]
    fn a_torque_is_none_or_one_that_loads_the_teeth() {
        assert_eq!(OUTPUT_TORQUE.check(0.0, "/t"), Ok(0.0));
        assert!(
            OUTPUT_TORQUE
                .check(-0.0, "/t")
                .is_ok_and(f64::is_sign_positive)
        );
        let (code, _, nearest) = OUTPUT_TORQUE.check(-115.0, "/t").expect_err("reversed");
        assert_eq!((code, nearest), (Code::TorqueNotPositive, Some(0.0)));
        for (torque, nearer) in [(5e-324, 0.0), (9e-7, 1e-6), (1e9, 1e8)] {
            let (code, _, nearest) = OUTPUT_TORQUE.check(torque, "/t").expect_err("out of range");
            assert_eq!(
                (code, nearest),
                (Code::OutOfRange, Some(nearer)),
                "{torque}"
            );
        }
    }
}
