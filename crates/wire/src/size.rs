//! How much a document holds, counted before anything of it is kept.

use std::cell::Cell;
use std::fmt;

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::problem::{Code, FieldError, Problem};

/// The most values of a submission: objects, lists, words and numbers. The richest has two gears with sixteen tables of a thousand
/// entries each.
pub const MOST_VALUES: u64 = 80_000;

/// Refuses a document of more than `most` values. A document that is not JSON is reported later, with its place.
///
/// # Errors
///
/// `too_large`, with the number.
pub fn refuse_many_values(document: &[u8], most: u64) -> Result<(), Problem> {
    let left = Cell::new(most);
    let mut deserializer = serde_json::Deserializer::from_slice(document);
    let read = Count { left: &left }.deserialize(&mut deserializer);
    if read.is_ok() || left.get() > 0 {
        return Ok(());
    }
    let detail = format!(
        "The document has more than {most} values, which is more than any that can be computed. It was not read further."
    );
    Err(Problem::of_fields(vec![
        FieldError::new("", Code::TooLarge, detail).nearest(most as f64),
    ]))
}

/// The number of values that stand somewhere, none of which is kept.
#[derive(Default)]
pub struct Values(pub u64);

impl<'de> Deserialize<'de> for Values {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let left = Cell::new(u64::MAX);
        Count { left: &left }.deserialize(deserializer)?;
        Ok(Self(u64::MAX - left.get()))
    }
}

/// Counts the values of a document down, and keeps none.
struct Count<'a> {
    left: &'a Cell<u64>,
}

impl Count<'_> {
    fn one<E: Error>(&self) -> Result<(), E> {
        match self.left.get() {
            0 => Err(E::custom("too many values")),
            left => {
                self.left.set(left - 1);
                Ok(())
            }
        }
    }
}

impl<'de> DeserializeSeed<'de> for Count<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Count<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.one()
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<(), E> {
        self.one()
    }

    fn visit_i64<E: Error>(self, _: i64) -> Result<(), E> {
        self.one()
    }

    fn visit_u64<E: Error>(self, _: u64) -> Result<(), E> {
        self.one()
    }

    fn visit_f64<E: Error>(self, _: f64) -> Result<(), E> {
        self.one()
    }

    fn visit_str<E: Error>(self, _: &str) -> Result<(), E> {
        self.one()
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        self.one()?;
        while items
            .next_element_seed(Count { left: self.left })?
            .is_some()
        {}
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        self.one()?;
        while entries.next_key::<IgnoredAny>()?.is_some() {
            entries.next_value_seed(Count { left: self.left })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_may_have_as_many_values_as_the_limit_and_no_more() {
        let list = br#"[1, "two", { "three": null }]"#;
        assert!(refuse_many_values(list, 5).is_ok());
        let problem = refuse_many_values(list, 4).unwrap_err();
        assert_eq!((problem.code, problem.status), (Code::TooLarge, 422));
        // A document that is not JSON passes here.
        assert!(refuse_many_values(b"[1, 2", 9).is_ok());
    }
}
