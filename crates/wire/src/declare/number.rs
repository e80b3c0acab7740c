//! Numbers: bounds, units and defaults.

use serde::Serializer;
use serde_json::{Value, json};

use super::{Kind, Location, Node, ObjectReader};
use crate::problem::Code;
use crate::units::{plain, significant};

/// Default of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Preset {
    /// Nothing: it has to be given.
    Needed,
    /// This value.
    Value(f64),
    /// Multiple of the module of the same gear.
    Modules(f64),
}

/// Declaration of a number.
#[derive(Debug, Clone, Copy)]
pub struct Number {
    title: &'static str,
    /// "1" for a pure number; empty where there is nothing to say.
    pub unit: &'static str,
    /// The smallest and the largest value that are accepted, in its unit.
    pub bounds: (f64, f64),
    /// True if zero is accepted outside the bounds.
    or_zero: bool,
    preset: Preset,
    /// Makes a default go with the numbers that were read before it.
    fitted: Option<fn(f64, &ObjectReader<'_>) -> f64>,
    /// The number that another field of the object says in its place.
    by_another: Option<fn(&ObjectReader<'_>) -> Option<f64>>,
    /// How a value below zero is refused.
    negative: Code,
    /// Meaning of a value below zero in other programs, and the reason of the refusal.
    meaning: Option<&'static str>,
}

/// A number of a submission, within bounds, that has to be given.
pub const fn number(title: &'static str, unit: &'static str, least: f64, most: f64) -> Number {
    Number {
        title,
        unit,
        bounds: (least, most),
        or_zero: false,
        preset: Preset::Needed,
        fitted: None,
        by_another: None,
        negative: Code::OutOfRange,
        meaning: None,
    }
}

impl Number {
    /// Not given, it is this.
    pub const fn or(self, value: f64) -> Self {
        let preset = Preset::Value(value);
        Self { preset, ..self }
    }

    /// Not given, it is so many times the module of its gear.
    pub const fn or_modules(self, modules: f64) -> Self {
        let preset = Preset::Modules(modules);
        Self { preset, ..self }
    }

    /// Takes `fit` of the typed value and of the numbers before it as the value.
    pub const fn fitted(self, fit: fn(f64, &ObjectReader<'_>) -> f64) -> Self {
        let fitted = Some(fit);
        Self { fitted, ..self }
    }

    /// Not given, it is what another field of the object says, if one does.
    pub const fn by_another(self, find: fn(&ObjectReader<'_>) -> Option<f64>) -> Self {
        let by_another = Some(find);
        Self { by_another, ..self }
    }

    /// Zero is accepted beside the bounds.
    pub const fn or_zero(self) -> Self {
        let or_zero = true;
        Self { or_zero, ..self }
    }

    /// A value below zero is refused with a code of its own.
    pub const fn negative_is(self, negative: Code) -> Self {
        Self { negative, ..self }
    }

    /// Refuses a value below zero by its meaning in other programs.
    pub const fn negative_means(self, meaning: &'static str) -> Self {
        let meaning = Some(meaning);
        Self { meaning, ..self }
    }

    /// Default for a gear of `module`.
    pub fn preset(&self, module: Option<f64>) -> Option<f64> {
        match self.preset {
            Preset::Needed => None,
            Preset::Value(value) => Some(value),
            Preset::Modules(modules) => module.map(|module| significant(modules * module, 12)),
        }
    }

    /// Checks `value`, which stands at `place`: the code, a sentence with the numbers, and the nearest accepted value. There is no nearest value where a
    /// negative value has a meaning that is not supported.
    fn check(
        &self,
        value: f64,
        place: &str,
        whole: bool,
    ) -> Result<f64, (Code, String, Option<f64>)> {
        let (least, most) = self.bounds;
        let is_zero = self.or_zero && value == 0.0;
        if !is_zero && !(least..=most).contains(&value) {
            let code = if value < 0.0 {
                self.negative
            } else {
                Code::OutOfRange
            };
            let unit = match self.unit {
                "" | "1" => String::new(),
                unit => format!(" {unit}"),
            };
            let meant = self.meaning.filter(|_| value < 0.0);
            let meaning = meant.map_or(String::new(), |meaning| format!("{meaning}; "));
            let detail = format!(
                "{place} is {}{unit}; {meaning}it has to {}lie between {}{unit} and {}{unit}.",
                plain(value),
                if self.or_zero { "be 0 or " } else { "" },
                plain(least),
                plain(most),
            );
            let nearest = meant.is_none().then(|| self.nearest(value));
            return Err((code, detail, nearest));
        }
        if whole && value.fract() != 0.0 {
            let detail = format!("{place} is {}; a whole number is expected.", plain(value));
            return Err((Code::WrongType, detail, Some(value.round())));
        }
        // A negative zero is as good as zero, and is echoed as it.
        Ok(value + 0.0)
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

    fn read(&self, node: &Node, place: &Location<'_>, whole: bool) -> Option<f64> {
        let Node::Number(value) = node else {
            let meant = match node {
                Node::Text(text) => meant_by(text, self.unit),
                _ => None,
            };
            let meant = meant.filter(|value| self.check(*value, "", whole).is_ok());
            let number = meant.map_or(String::new(), |value| format!(": {value}, without quotes"));
            let detail = format!("{place} is {}; a number is expected{number}.", node.kind());
            return place.wrong(Code::WrongType, detail, meant);
        };
        match self.check(*value, &place.to_string(), whole) {
            Ok(value) => Some(value),
            Err((code, detail, nearest)) => place.wrong(code, detail, nearest),
        }
    }

    fn told_by_another(&self, reader: &ObjectReader<'_>) -> Option<f64> {
        self.by_another.and_then(|find| find(reader))
    }

    fn absent(&self, reader: &mut ObjectReader<'_>, name: &'static str) -> Option<f64> {
        if let Some(value) = self.told_by_another(reader) {
            return Some(value);
        }
        if self.preset == Preset::Needed {
            return reader.missing(name);
        }
        let preset = self.preset(reader.number("module_mm"))?;
        Some(self.fitted.map_or(preset, |fit| fit(preset, reader)))
    }

    fn read_field(
        &self,
        reader: &mut ObjectReader<'_>,
        name: &'static str,
        whole: bool,
    ) -> Option<f64> {
        let value = match reader.get(name) {
            Some(node) => self.read(node, &reader.place_of(name), whole),
            None => self.absent(reader, name),
        }?;
        reader.note(name, value);
        Some(value)
    }

    fn describe(&self, about: &str, whole: bool) -> Value {
        let literal = |value: f64| {
            let is_whole = value.fract() == 0.0 && value.abs() < 1e15;
            if whole || is_whole {
                json!(value as i64)
            } else {
                json!(value)
            }
        };
        let mut schema = json!({ "type": if whole { "integer" } else { "number" } });
        if !self.title.is_empty() {
            schema["title"] = json!(self.title);
        }
        let mut said = about.to_owned();
        if !about.is_empty() && !self.unit.is_empty() {
            said += &format!(" Unit: {}.", self.unit);
        }
        match self.preset {
            Preset::Needed => {}
            Preset::Value(value) => schema["default"] = literal(value),
            Preset::Modules(modules) => {
                schema["x-default-modules"] = literal(modules);
                said += &format!(" Default: {modules} modules.");
            }
        }
        if !said.is_empty() {
            schema["description"] = json!(said);
        }
        let (mut least, most) = self.bounds;
        if self.or_zero {
            least = least.min(0.0);
        }
        if least.is_finite() {
            schema["minimum"] = literal(least);
        }
        if most.is_finite() {
            schema["maximum"] = literal(most);
        }
        if !self.unit.is_empty() {
            schema["x-unit"] = json!(self.unit);
        }
        schema
    }
}

/// The number that a text means, which may have a decimal comma, thousands in groups of three, and the unit behind it. A lone comma or point is decimal.
pub fn meant_by(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let text = match unit {
        "" | "1" => text,
        unit => text.strip_suffix(unit).unwrap_or(text).trim_end(),
    };
    let is_sign = |letter: char| letter == ',' || letter == '.';
    let signs: Vec<&str> = text.matches(is_sign).collect();
    // The last sign is decimal unless it stands more than once; all others part thousands.
    let is_decimal = |last: &&&str| signs.iter().filter(|sign| sign == last).count() == 1;
    let decimal = signs
        .last()
        .filter(is_decimal)
        .and_then(|_| text.rfind(is_sign));
    let (whole, part) = decimal.map_or((text, ""), |at| (&text[..at], &text[at..]));
    let groups: Vec<&str> = whole.split(is_sign).collect();
    let is_whole = |group: &&str| group.len() == 3 && group.parse::<u32>().is_ok();
    let (first, others) = groups.split_first()?;
    let is_first = (1..=3).contains(&first.trim_start_matches('-').len());
    let is_well_parted = others.is_empty() || is_first && others.iter().all(is_whole);
    if !is_well_parted {
        return None;
    }
    let text = groups.concat() + &part.replace(',', ".");
    let number = text.parse().ok();
    number.filter(|value: &f64| value.is_finite())
}

/// Whole numbers are read as numbers, within the bounds that their type can hold.
macro_rules! numbers {
    ($($number:ty, $whole:literal, $write:ident;)*) => {$(
        impl Kind for $number {
            type Spec = Number;
            const MANY: [&'static str; 2] = ["numbers", "numbers"];

            fn read(node: &Node, place: &Location<'_>, spec: &Number) -> Option<Self> {
                spec.read(node, place, $whole).map(|value| value as Self)
            }

            fn read_field(reader: &mut ObjectReader<'_>, name: &'static str, spec: &Number) -> Option<Self> {
                spec.read_field(reader, name, $whole).map(|value| value as Self)
            }

            fn absent(reader: &mut ObjectReader<'_>, name: &'static str, spec: &Number) -> Option<Self> {
                spec.absent(reader, name).map(|value| value as Self)
            }

            fn by_another(reader: &ObjectReader<'_>, spec: &Number) -> Option<Self> {
                spec.told_by_another(reader).map(|value| value as Self)
            }

            fn is_needed(spec: &Number) -> bool {
                spec.preset == Preset::Needed
            }

            fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.$write(*self)
            }

            fn describe(about: &str, spec: &Number) -> Value {
                spec.describe(about, $whole)
            }
        }
    )*};
}

numbers! {
    f64, false, serialize_f64;
    u32, true, serialize_u32;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::GearDocument;
    use crate::submission::OUTPUT_TORQUE;
    use crate::testing::{example, parse, with};

    #[test]
    fn a_value_outside_its_bounds_is_answered_with_the_nearer_bound() {
        let teeth = GearDocument::tooth_count.spec;
        let (code, detail, nearest) = teeth.check(-3.0, "/z", true).expect_err("negative");
        // Another number of teeth would be another gear.
        assert_eq!((code, nearest), (Code::OutOfRange, None));
        assert!(
            detail.contains("-3") && detail.contains("internal gears are not computed"),
            "{detail}"
        );
        let (_, detail, nearest) = teeth.check(3.0, "/z", true).expect_err("three teeth");
        assert_eq!(nearest, Some(4.0));
        assert!(!detail.contains("internal"), "{detail}");
        let module = GearDocument::module_mm.spec;
        let (_, detail, nearest) = module.check(1e308, "/m", false).expect_err("enormous");
        assert_eq!(nearest, Some(50.0));
        assert!(detail.contains("1e308 mm"), "{detail}");
        let (code, _, nearest) = teeth.check(30.4, "/z", true).expect_err("a fraction");
        assert_eq!((code, nearest), (Code::WrongType, Some(30.0)));
    }

    #[test]
    fn a_number_as_text_is_refused_with_the_number_that_it_means() {
        for (text, number) in [
            ("100,5", Some(100.5)),
            ("100.5", Some(100.5)),
            (" 100,5 mm", Some(100.5)),
            ("1.234,5", Some(1234.5)),
            ("1,234.5", Some(1234.5)),
            ("1.234.567", Some(1_234_567.0)),
            ("1,005e2", Some(100.5)),
            ("-0,5", Some(-0.5)),
            ("50", Some(50.0)),
            ("1.23,5.6", None),
            ("12345.678,9", None),
            ("1,2,3", None),
            ("100,5 in", None),
            ("nan", None),
            ("inf", None),
            ("1e999", None),
            (",", None),
            ("", None),
            ("\u{663}", None),
        ] {
            assert_eq!(meant_by(text, "mm"), number, "{text}");
        }
        let refused = |changes: &[(&str, Value)]| {
            let problem = parse(&with(example("test-case-2"), changes)).expect_err("a text");
            let [error] = problem.errors.try_into().expect("one");
            (error.pointer, error.detail, error.nearest)
        };
        let (pointer, detail, nearest) = refused(&[("/pair/center_distance_mm", json!("100,5"))]);
        assert_eq!(
            (&*pointer, nearest),
            ("/pair/center_distance_mm", Some(100.5))
        );
        assert!(
            detail.ends_with("a number is expected: 100.5, without quotes."),
            "{detail}"
        );
        // Neither what is out of bounds nor a fraction of a tooth is offered.
        for text in ["-100,5", "hundred"] {
            assert_eq!(
                refused(&[("/pair/center_distance_mm", json!(text))]).2,
                None
            );
        }
        assert_eq!(
            refused(&[("/pair/driving/tooth_count", json!("50,5"))]).2,
            None
        );
        assert_eq!(
            refused(&[("/output_torques_n_m", json!(["115,5"]))]).2,
            Some(115.5)
        );
    }

    #[test]
    fn a_torque_is_none_or_one_that_loads_the_teeth() {
        let check = |torque| OUTPUT_TORQUE.check(torque, "/t", false);
        assert_eq!(check(0.0), Ok(0.0));
        assert!(check(-0.0).is_ok_and(f64::is_sign_positive));
        let (code, _, nearest) = check(-115.0).expect_err("reversed");
        assert_eq!((code, nearest), (Code::TorqueNotPositive, Some(0.0)));
        for (torque, nearer) in [(5e-324, 0.0), (9e-7, 1e-6), (1e9, 1e8)] {
            let (code, _, nearest) = check(torque).expect_err("out of range");
            assert_eq!(
                (code, nearest),
                (Code::OutOfRange, Some(nearer)),
                "{torque}"
            );
        }
    }
}
