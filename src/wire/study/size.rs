//! How large a study may be, found before anything of it is kept or expanded.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, SeqAccess, Visitor};

use super::{Plan, Study};
use crate::wire::problem::{Code, FieldError, Problem};
use crate::wire::size::{MOST_VALUES, refuse_many_values};
use crate::wire::tree::{Errors, Node};

/// The most designs of one study.
pub const MOST_DESIGNS: usize = 20_000;

/// The most values of the whole document: twenty thousand designs with a dozen changes each.
const MOST_VALUES_OF_ALL: u64 = 300_000;

/// The most values that are looked at when each design is checked against the base: twenty thousand designs of a base with one
/// thousand, or fewer of a larger one.
const MOST_WORK: u64 = 20_000_000;

/// Refuses a document with too many designs or values. It keeps none, so that ten million of them cost no memory.
pub(super) fn refuse_too_many(document: &[u8]) -> Result<(), Problem> {
    #[derive(Deserialize)]
    struct Counted {
        #[serde(default)]
        axes: Vec<CountedAxis>,
        #[serde(default)]
        designs: Count,
    }
    #[derive(Deserialize)]
    struct CountedAxis {
        #[serde(default)]
        values: Count,
    }

    // What is not of this form is told later, with its place.
    if let Ok(counted) = serde_json::from_slice::<Counted>(document) {
        let long = counted
            .axes
            .iter()
            .position(|axis| axis.values.0 > MOST_DESIGNS);
        let error = match long {
            Some(i) => Some(too_many(
                counted.axes.iter().fold(1, |total: u128, axis| {
                    total.saturating_mul(axis.values.0.max(1) as u128)
                }),
                &format!("/axes/{i}/values"),
            )),
            None if counted.designs.0 > MOST_DESIGNS => {
                Some(too_many(counted.designs.0 as u128, "/designs"))
            }
            None => None,
        };
        if let Some(error) = error {
            return Err(Problem::of_fields(vec![error]));
        }
    }
    refuse_many_values(document, MOST_VALUES_OF_ALL)
}

/// That so many designs are too many.
pub(super) fn too_many(total: u128, pointer: &str) -> FieldError {
    let detail = format!(
        "The study has {total} designs; at most {MOST_DESIGNS} are taken. Nothing was expanded."
    );
    FieldError::new(pointer, Code::TooLarge, detail).nearest(MOST_DESIGNS as f64)
}

impl Study {
    /// Refuses a base that is no submission for its size alone, or whose check in every design would take seconds.
    pub(super) fn refuse_work(&self, errors: &Errors) {
        let values = self.base.count();
        if values > MOST_VALUES {
            let detail = format!(
                "/base has {values} values; a submission has at most {MOST_VALUES}. Nothing was expanded."
            );
            let error = FieldError::new("/base", Code::TooLarge, detail);
            return errors.push(error.nearest(MOST_VALUES as f64));
        }
        let checked: usize = match &self.plan {
            Plan::Axes(axes) => axes.iter().map(|axis| axis.values.len()).sum(),
            Plan::Designs(designs) => designs.len(),
        };
        let variants = checked.max(self.total()) as u64;
        if values * variants > MOST_WORK {
            let fitting = MOST_WORK / values;
            let detail = format!(
                "/base has {values} values, which {variants} variants would repeat; with a base of this size at most {fitting} are taken. Nothing was expanded."
            );
            errors.push(FieldError::new("/base", Code::TooLarge, detail).nearest(fitting as f64));
        }
    }
}

impl Node {
    /// The number of values in it.
    fn count(&self) -> u64 {
        1 + match self {
            Self::List(items) => items.iter().map(Self::count).sum(),
            Self::Object(fields) => fields.iter().map(|(_, value)| value.count()).sum::<u64>(),
            Self::Null | Self::Bool(_) | Self::Number(_) | Self::Text(_) => 0,
        }
    }
}

/// The length of a list.
#[derive(Default)]
struct Count(usize);

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Counter;
        impl<'de> Visitor<'de> for Counter {
            type Value = Count;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Count, A::Error> {
                let mut count = 0;
                while items.next_element::<IgnoredAny>()?.is_some() {
                    count += 1;
                }
                Ok(Count(count))
            }
        }
        deserializer.deserialize_seq(Counter)
    }
}
