//! The reader's units at the edge: mm, um, degrees, GPa and MPa against SI, and numbers rounded for the wire.

use std::collections::BTreeMap;
use std::io;

pub use meshwright_exchange::significant;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Deserializer, Serialize as _};
use serde_json::Value;
use serde_json::ser::{CompactFormatter, Formatter};
use serde_json::value::RawValue;

/// Millimeters to meters. A division by a power of ten rounds once, so that 100.5 mm is the double nearest 0.1005 m.
pub fn from_mm(value: f64) -> f64 {
    value / 1e3
}

/// Micrometers to meters.
pub fn from_um(value: f64) -> f64 {
    value / 1e6
}

/// Gigapascals to pascals.
pub fn from_gpa(value: f64) -> f64 {
    value * 1e9
}

/// Megapascals to pascals.
pub fn from_mpa(value: f64) -> f64 {
    value * 1e6
}

/// Meters to millimeters.
pub fn to_mm(value: f64) -> f64 {
    value * 1e3
}

/// Meters to micrometers.
pub fn to_um(value: f64) -> f64 {
    value * 1e6
}

/// Newtons per meter to newtons per millimeter.
pub fn to_n_per_mm(value: f64) -> f64 {
    value / 1e3
}

/// Pascals to megapascals.
pub fn to_mpa(value: f64) -> f64 {
    value / 1e6
}

/// A number as people write it in a sentence: at most seven significant digits.
pub fn plain(value: f64) -> String {
    let value = significant(value, 7);
    if value != 0.0 && !(1e-4..1e9).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// The side on which a bound is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Values up to the bound work.
    AtMost,
    /// Values from the bound on work.
    AtLeast,
}

impl Side {
    /// The other side.
    pub fn other(self) -> Self {
        match self {
            Self::AtMost => Self::AtLeast,
            Self::AtLeast => Self::AtMost,
        }
    }
}

/// The value of five significant digits next to `bound` on its working side, `steps` units of the last digit further in.
pub fn rounded_inward(bound: f64, side: Side, steps: u32) -> f64 {
    if bound == 0.0 || !bound.is_finite() {
        return bound;
    }
    let unit_exponent = bound.abs().log10().floor() as i32 - 4;
    rounded_to_unit(bound, side, steps, unit_exponent)
}

/// The same of a value that is a whole number of 10 to the power `unit_exponent`.
pub fn rounded_to_unit(bound: f64, side: Side, steps: u32, unit_exponent: i32) -> f64 {
    let in_units = if unit_exponent < 0 {
        bound * 10_f64.powi(-unit_exponent)
    } else {
        bound / 10_f64.powi(unit_exponent)
    };
    // A bound that is a round number but for the last bits of its computation is taken as that number.
    let whole = if (in_units - in_units.round()).abs() < 1e-6 {
        in_units.round()
    } else {
        match side {
            Side::AtMost => in_units.floor(),
            Side::AtLeast => in_units.ceil(),
        }
    };
    let whole = match side {
        Side::AtMost => whole - f64::from(steps),
        Side::AtLeast => whole + f64::from(steps),
    };
    if unit_exponent < 0 {
        whole / 10_f64.powi(-unit_exponent)
    } else {
        whole * 10_f64.powi(unit_exponent)
    }
}

/// Writes `document` with every number rounded to ten significant digits.
///
/// Significant digits, not decimals, so that the small noise of a spectrum is kept; ten of them, so that the rounding of a spectrum stays a thousand times
/// below 1e-9 of the mean.
///
/// # Errors
///
/// A number that is not finite has no place in JSON and fails; so does an absent value, which has to be left out or
/// written by [`or_null`].
pub fn rounded_json(document: &impl serde::Serialize) -> serde_json::Result<String> {
    let mut text = Vec::new();
    let mut serializer = serde_json::Serializer::with_formatter(&mut text, RoundingFormatter);
    document.serialize(&mut serializer)?;
    String::from_utf8(text).map_err(serde::ser::Error::custom)
}

/// The values of a text like that of [`rounded_json`], in which values may be absent.
///
/// # Errors
///
/// A number that has to be there and is not finite.
pub fn rounded<T: serde::Serialize + DeserializeOwned>(exact: &T) -> serde_json::Result<T> {
    fn round(value: &mut Value) {
        match value {
            Value::Number(number) if number.is_f64() => {
                let rounded = number.as_f64().map(told);
                *value = rounded.into();
            }
            Value::Array(items) => items.iter_mut().for_each(round),
            Value::Object(members) => members.values_mut().for_each(round),
            _ => {}
        }
    }
    let mut value = serde_json::to_value(exact)?;
    round(&mut value);
    serde_json::from_value(value)
}

/// A number as a document tells it.
pub fn told(exact: f64) -> f64 {
    significant(exact, DIGITS)
}

/// Writes numbers of which some are meant to be absent.
pub fn or_null<S: serde::Serializer>(
    values: &[Option<f64>],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(serde::Serialize)]
    struct One(#[serde(serialize_with = "one_or_null")] Option<f64>);
    serializer.collect_seq(values.iter().map(|value| One(*value)))
}

/// Writes numbers by their names, of which some may be meant to be absent.
pub fn named_or_null<S: serde::Serializer>(
    values: &Option<BTreeMap<String, Option<f64>>>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(serde::Serialize)]
    struct One(#[serde(serialize_with = "one_or_null")] Option<f64>);
    let values = values.iter().flatten();
    serializer.collect_map(values.map(|(name, value)| (name, One(*value))))
}

/// Writes a value that may be meant to be absent.
pub fn one_or_null<T: serde::Serialize, S: serde::Serializer>(
    value: &Option<T>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) => value.serialize(serializer),
        // As it stands, past the formatter, which takes a null for a number that went wrong.
        None => RawValue::from_string("null".to_owned())
            .map_err(serde::ser::Error::custom)?
            .serialize(serializer),
    }
}

/// Value of a number that a document of an earlier version lacks. It is never written.
pub fn not_a_number() -> f64 {
    f64::NAN
}

/// Reads those of a list that this version knows; a later one may have kinds of them that it does not.
pub fn known<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Maybe<T> {
        Known(T),
        Unknown(IgnoredAny),
    }
    let all: Vec<Maybe<T>> = Vec::deserialize(deserializer)?;
    let known = all.into_iter().filter_map(|item| match item {
        Maybe::Known(known) => Some(known),
        Maybe::Unknown(_) => None,
    });
    Ok(known.collect())
}

/// Documents have so many significant digits.
const DIGITS: usize = 10;

struct RoundingFormatter;

impl Formatter for RoundingFormatter {
    fn write_f64<W: io::Write + ?Sized>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        CompactFormatter.write_f64(writer, told(value))
    }

    /// A value that is not finite is written as null, so a null here is an invalid number.
    fn write_null<W: io::Write + ?Sized>(&mut self, _: &mut W) -> io::Result<()> {
        Err(io::Error::other("a result is not finite"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_absent_value_that_is_meant_is_null_and_one_that_went_wrong_is_not() {
        #[derive(serde::Serialize)]
        struct Pressures(#[serde(serialize_with = "or_null")] Vec<Option<f64>>);
        let written = |values: &[Option<f64>]| rounded_json(&Pressures(values.to_vec()));
        assert_eq!(
            written(&[Some(1.5), None]).expect("both are meant"),
            "[1.5,null]"
        );
        assert!(written(&[Some(f64::NAN)]).is_err());
    }

    #[test]
    fn lengths_in_mm_become_the_nearest_double_in_meters() {
        for (mm, m) in [
            (100.5, 0.1005),
            (1.75, 0.00175),
            (47.5, 0.0475),
            (0.76, 0.76e-3),
        ] {
            assert_eq!(from_mm(mm), m);
        }
        assert_eq!(from_um(5.0), 5e-6);
        assert_eq!(to_mpa(677e6), 677.0);
        assert_eq!(from_gpa(210.0), 210e9);
        assert!(
            (to_um(from_um(11.78)) - 11.78).abs() < 1e-12,
            "up to the last bits"
        );
    }

    #[test]
    fn bounds_are_rounded_to_the_side_that_works() {
        // Largest center distance of 29/85: 115.567 mm.
        assert_eq!(rounded_inward(115.567_123, Side::AtMost, 0), 115.56);
        assert_eq!(rounded_inward(115.567_123, Side::AtMost, 1), 115.55);
        assert_eq!(rounded_inward(0.298_123_4, Side::AtLeast, 0), 0.298_13);
        assert_eq!(rounded_inward(99.999_999_999_999, Side::AtLeast, 0), 100.0);
        assert_eq!(rounded_inward(-0.298_123_4, Side::AtLeast, 0), -0.298_12);
        assert_eq!(rounded_inward(1_234_567.0, Side::AtMost, 0), 1_234_500.0);
    }

    #[test]
    fn rounding_keeps_significant_digits_of_the_smallest_numbers() {
        let text =
            rounded_json(&[1.234_567_891_23e-14, 219_600_123.456_78, -0.0, 0.025]).expect("finite");
        assert_eq!(text, "[1.234567891e-14,219600123.5,0.0,0.025]");
        for wrong in [f64::NAN, f64::INFINITY] {
            assert!(rounded_json(&[1.0, wrong]).is_err());
        }
    }
}
